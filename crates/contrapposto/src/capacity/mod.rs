//! Computes the greatest force that a body can exert at a point in every direction without leaving its posture.
//!
//! A linear program for each direction `d` (unit length, ground axes); the body pushes with `s d` and is pushed back with `-s d`:
//!
//! ```text
//! greatest s   subject to   a + C f - s J^T d = -(tau_e + tau_p)     at every rate
//!                           -S- <= a <= S+                           at joints, 0 at the root of a body on supports
//!                           f inside patches and pyramids of friction
//! ```
//!
//! with active torque `a`, contact forces `f`, the Jacobian `J` of the point, external torque `tau_e` of weight and loads, passive torque
//! `tau_p`, and the strengths `S` of both muscle groups at the present angle, those of three-axis joints about their axes. A force that is
//! held for a time has strengths that last so long ([`Demand`]). All forces that can be exerted are a convex solid; each program gives a
//! point of its surface and a plane that the whole solid is behind ([`GreatestForce::normal`]).
//!
//! Friction is the pyramid of [`crate::contact`], which lies inside the cone: along the two axes of a plane it is `1 / sqrt(2)` of the cone's, so
//! a force limited by friction is at most 29 % below that of the cone, and never above. `share_max` of a support is a preference and limits no force.
//! Coordinates of unknown strength limit nothing.
//!
//! Muscles that give joints their strength ([`Situation::muscles`]) share the torques: there `a = sum_m R_m F_m x_m`, with moment arms `R`,
//! tension `F` at full activation beyond that of passive fibres, and `0 <= x_m <= c_m`, where the capacity `c` is 1 or what fatigue leaves of it.
//! All such torques are a zonotope. A two-joint muscle that helps at one joint may be in the way at the other.

mod available;
mod direction;
mod program;
mod pulls;
mod situation;
mod solid;
mod tolerances;

pub use available::{Demand, People};
pub use direction::{GreatestForce, Limit, Limiter};
pub use situation::{CapacityError, Situation, Station};
pub use solid::{Solid, directions};

use nalgebra::Vector3;

use program::Program;

/// The forces that a body can exert at a point in a posture.
#[derive(Clone, Debug)]
pub struct Capacity {
    /// With the basis of the last direction.
    program: Program,
    /// With the basis of no force.
    at_rest: Program,
}

impl Capacity {
    /// Of a body in a posture; `None` where it cannot be held without a force either.
    ///
    /// # Errors
    /// [`CapacityError`] names the first thing that does not fit.
    pub fn new(situation: &Situation<'_>, station: Station, demand: Demand) -> Result<Option<Self>, CapacityError> {
        let program = Program::new(situation, station, demand)?;
        Ok(program.map(|program| Self { at_rest: program.clone(), program }))
    }

    /// Point at which the force acts, ground, m.
    pub fn place(&self) -> Vector3<f64> {
        self.program.place
    }
}
