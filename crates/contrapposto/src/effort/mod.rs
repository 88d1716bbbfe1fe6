//! Solves for the posture and the contact forces of least effort under constraints, by sequential quadratic programming and
//! basin hopping.

pub(crate) mod descent;
#[cfg(test)]
mod ground;
pub(crate) mod hessian;
mod limbs;
mod quadratic;
pub(crate) mod site;
pub(crate) mod symmetric;
pub(crate) mod valleys;
mod weld;
