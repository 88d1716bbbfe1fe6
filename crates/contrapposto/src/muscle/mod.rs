//! Computes what a body's muscles do at rest: paths with their lengths and moment arms, forces of fibres and tendons, and the passive
//! torque and strength that follow.
//!
//! [`Musculature`] is given and does not change; [`PathGeometry`] and [`FiberState`] depend on the posture. Paths follow one of two rules
//! ([`PathRule`]): shortest lines, whose moment arms are minus the derivatives of the length, or OpenSim's. Tendons of MuJoCo
//! ([`Tendon`]) have MuJoCo's rule always.

mod bushing;
mod coupled_strength;
mod drawn_line;
mod fatigue;
mod fiber;
mod geometry;
mod hold;
mod ligament;
mod path;
mod routing;
mod rule;
mod shared_torques;
mod static_optimisation;
mod tendon;
mod tolerances;
mod torque;
mod wrap;

pub use bushing::{Band, Bushing, bushing_torque};
pub use coupled_strength::{CoupledStrength, coupled_strength};
pub use drawn_line::DrawnPoint;
pub use fatigue::{MuscleFatigue, SharingError};
pub use fiber::{
    ActiveCurve, DeGrooteFregly2016, FiberLaw, FiberState, Millard2012, MujocoMuscle, Muscle, MuscleError, MuscleSpec,
    PassiveFiberCurve, PassiveShape, Schutte1993, TendonCurve, TendonShape, Thelen2003,
};
pub(crate) use geometry::Line;
pub use geometry::{PathCorner, PathGeometry, PathPull};
pub use hold::{MuscleHold, hold, hold_on, hold_with_breaks};
pub use ligament::{Ligament, LigamentLaw};
pub use path::{Location, MovingPoint, Path, PathPoint, PathWrap, Paths};
pub use routing::CornerOrigin;
pub(crate) use routing::Node;
pub use rule::{PathRule, WrapMethod};
pub use shared_torques::{SharedTorques, TorqueLimit};
pub use static_optimisation::{Recruitment, Sharing, StaticOptimisation};
pub use tendon::{Around, RoundShape, SidePoint, Tendon, TendonGeom, TendonPart};
pub use torque::{Tension, passive_fiber_torque, passive_tensions, passive_torque, strength};
pub(crate) use wrap::Spread;
pub use wrap::{Quadrant, WrapObject, WrapShape};

/// The muscles of a body, with its ligaments and springs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Musculature {
    /// Paths of muscles and ligaments, and the surfaces that the paths wrap over.
    pub paths: Paths,
    /// The muscles, in the file's order.
    pub muscles: Vec<Muscle>,
    /// Ligaments and springs along paths.
    pub ligaments: Vec<Ligament>,
    /// Springs and bands between frames.
    pub bushings: Vec<Bushing>,
    /// The measure by which the muscles share torques.
    pub sharing: Sharing,
}

impl Musculature {
    /// The same without paths that no muscle or ligament has.
    #[must_use]
    pub(crate) fn with_used_paths(mut self) -> Self {
        let mut used = vec![];
        let mut place = |path: usize| {
            used.iter().position(|other| *other == path).unwrap_or_else(|| {
                used.push(path);
                used.len() - 1
            })
        };
        self.muscles = self.muscles.into_iter().map(|muscle| muscle.on_path(&mut place)).collect();
        self.ligaments.iter_mut().for_each(|ligament| ligament.path = place(ligament.path));
        self.paths.paths = used.iter().map(|path| self.paths.paths[*path].clone()).collect();
        self
    }
}
