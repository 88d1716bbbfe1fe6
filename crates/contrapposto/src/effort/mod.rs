//! Solves for the posture and the contact forces of least effort under constraints, by sequential quadratic programming and
//! basin hopping.
//!
//! Effort is the sum of squares of relative loads, `sum_i (tau_a,i / S_i)^2`; half of it is the objective. [`problem`] states the
//! problem, [`iterate`] evaluates objective and constraints in a posture with given forces, [`hessian`] computes second
//! derivatives, [`qp`] solves for one step ([`qp_working_set`] and [`dual_active_set`] find the constraints that are active), [`sqp`] descends to a local minimum, and [`basin_hopping`] searches for lower ones,
//! in a [`reduced_problem`] and by [`decoupled_subtrees`] where the body allows. All constants stand in [`tolerances`].

pub(crate) mod basin_hopping;
mod decoupled_subtrees;
mod dual_active_set;
pub(crate) mod hessian;
mod iterate;
mod passive_hessian;
pub(crate) mod problem;
mod qp;
mod qp_working_set;
mod reduced_problem;
mod second_by_axes;
pub(crate) mod sqp;
#[cfg(test)]
mod standing_adult;
mod tolerances;
