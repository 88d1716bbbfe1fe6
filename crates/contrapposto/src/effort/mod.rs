//! Solves for the posture and the contact forces of least effort under constraints, by sequential quadratic programming and
//! basin hopping.

pub(crate) mod basin_hopping;
pub(crate) mod hessian;
mod iterate;
pub(crate) mod problem;
mod qp;
mod reduced_problem;
mod sqp;
#[cfg(test)]
mod standing_adult;
mod weld;
