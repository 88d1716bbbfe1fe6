//! Computes the forces of a muscle at rest: fibres of constant width beside each other, in series with a tendon.
//!
//! With fibre length `l`, pennation `sin(phi) = w / l`, activation `a` and path length `L`, forces over the greatest isometric force:
//! `(a active(l) + passive(l)) cos(phi) = tendon(L - l cos(phi))`. A rigid tendon has its slack length always.

mod curve;
mod curves;
mod degroote_fregly2016;
mod equilibrium;
mod millard2012;
mod mujoco;
mod schutte1993;
mod thelen2003;

pub use curves::MuscleError;
pub use degroote_fregly2016::DeGrooteFregly2016;
pub use equilibrium::FiberState;
pub use millard2012::{ActiveCurve, Millard2012, PassiveFiberCurve, PassiveShape, TendonCurve, TendonShape};
pub use mujoco::MujocoMuscle;
pub use schutte1993::Schutte1993;
pub use thelen2003::Thelen2003;

use equilibrium::Fibers;
use millard2012::Millard;

/// Shortest fibre length over optimal length of laws that have none; that at which De Groote's passive force is zero.
const LEAST_LENGTH: f64 = 0.2;

/// The law of a muscle's fibres and tendon, by its publication.
#[derive(Clone, Debug, PartialEq)]
pub enum FiberLaw {
    /// Thelen 2003.
    Thelen2003(Thelen2003),
    /// Millard, Uchida, Seth & Delp 2013.
    Millard2012(Millard2012),
    /// De Groote, Kinney, Rao & Fregly 2016.
    DeGrooteFregly2016(DeGrooteFregly2016),
    /// Schutte 1993.
    Schutte1993(Schutte1993),
    /// MuJoCo's muscle.
    Mujoco(MujocoMuscle),
}

/// The numbers of a muscle.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleSpec {
    /// Name of the muscle.
    pub name: String,
    /// Index of its path.
    pub path: usize,
    /// Greatest force of its fibres at optimal length, N.
    pub max_isometric_force: f64,
    /// m.
    pub optimal_fiber_length: f64,
    /// m.
    pub tendon_slack_length: f64,
    /// Angle between fibres and tendon at optimal length, rad.
    pub pennation: f64,
    /// Greatest such angle, rad.
    pub max_pennation: f64,
    /// Activation that is always there, 0 to 1.
    pub least_activation: f64,
    /// The tendon does not stretch.
    pub rigid_tendon: bool,
    /// Law of fibres and tendon.
    pub law: FiberLaw,
}

/// A muscle, ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    spec: MuscleSpec,
    curves: CurveSet,
    fibers: Fibers,
}

#[derive(Clone, Debug, PartialEq)]
enum CurveSet {
    Thelen(Thelen2003),
    Millard(Box<Millard>),
    DeGrooteFregly(DeGrooteFregly2016),
    Schutte(Box<Schutte1993>),
    Mujoco(MujocoMuscle),
}

impl Muscle {
    /// Checks the numbers and prepares the curves.
    ///
    /// # Errors
    /// [`MuscleError`] names the number.
    pub fn new(spec: MuscleSpec) -> Result<Self, MuscleError> {
        let refuse = |what, value, accepted| Err(MuscleError { what, value, accepted });
        for (what, value) in
            [("max_isometric_force", spec.max_isometric_force), ("optimal_fiber_length", spec.optimal_fiber_length)]
        {
            if !(value > 0.0 && value <= crate::model::LARGEST) {
                return refuse(what, value, "above 0 and at most 1e9");
            }
        }
        // MuJoCo's lengths begin anywhere: those of a muscle on a joint are angles.
        let least_slack = if let FiberLaw::Mujoco(_) = spec.law { -crate::model::LARGEST } else { 0.0 };
        if !(least_slack..=crate::model::LARGEST).contains(&spec.tendon_slack_length) {
            return refuse("tendon_slack_length", spec.tendon_slack_length, "0 to 1e9 (MuJoCo's muscles: -1e9 to 1e9)");
        }
        if !(0.0..=1.0).contains(&spec.least_activation) {
            return refuse("minimum_activation", spec.least_activation, "0 to 1");
        }
        let right = std::f64::consts::FRAC_PI_2;
        if !(spec.pennation >= 0.0 && spec.pennation < right) {
            return refuse("pennation_angle_at_optimal", spec.pennation, "0 up to a right angle");
        }
        if !(spec.max_pennation > 0.0 && spec.max_pennation <= right) {
            return refuse("maximum_pennation_angle", spec.max_pennation, "above 0, up to a right angle");
        }
        let curves = match &spec.law {
            FiberLaw::Thelen2003(law) => CurveSet::Thelen(law.checked()?),
            FiberLaw::Millard2012(law) => CurveSet::Millard(Box::new(law.curves()?)),
            FiberLaw::DeGrooteFregly2016(law) => CurveSet::DeGrooteFregly(law.checked()?),
            FiberLaw::Schutte1993(law) => CurveSet::Schutte(Box::new(law.clone())),
            FiberLaw::Mujoco(law) => CurveSet::Mujoco(law.checked()?),
        };
        let width = spec.optimal_fiber_length * libm::sin(spec.pennation);
        let pennate = width / libm::sin(spec.max_pennation);
        // Shortest length over optimal length, beside that of the greatest pennation.
        let least = match &curves {
            CurveSet::Thelen(_) | CurveSet::DeGrooteFregly(_) | CurveSet::Mujoco(_) => 0.0,
            CurveSet::Millard(curves) => curves.least_length,
            CurveSet::Schutte(_) => LEAST_LENGTH,
        };
        let least_length = pennate.max(least * spec.optimal_fiber_length);
        let fibers = Fibers {
            width,
            least_length,
            optimal_length: spec.optimal_fiber_length,
            slack_length: spec.tendon_slack_length,
            rigid: spec.rigid_tendon || spec.tendon_slack_length <= 0.0,
            max_isometric_force: spec.max_isometric_force,
        };
        Ok(Self { spec, curves, fibers })
    }

    /// Numbers of the muscle.
    pub fn spec(&self) -> &MuscleSpec {
        &self.spec
    }

    /// The muscle on the path with the index that `place` gives for its own.
    pub(crate) fn on_path(mut self, place: &mut impl FnMut(usize) -> usize) -> Self {
        self.spec.path = place(self.spec.path);
        self
    }

    /// The equilibrium at rest at a path length (m) and an activation; activations below the least one count as that. Does not allocate.
    pub fn at_rest(&self, path_length: f64, activation: f64) -> FiberState {
        self.solve(&self.fibers, path_length, activation)
    }

    /// As [`Muscle::at_rest`], as if the tendon did not stretch. Does not allocate.
    pub fn at_rest_on_rigid_tendon(&self, path_length: f64, activation: f64) -> FiberState {
        self.solve(&Fibers { rigid: true, ..self.fibers }, path_length, activation)
    }

    fn solve(&self, fibers: &Fibers, path_length: f64, activation: f64) -> FiberState {
        let activation = activation.max(self.spec.least_activation).min(1.0);
        match &self.curves {
            CurveSet::Thelen(curves) => fibers.solve(curves, path_length, activation),
            CurveSet::Millard(curves) => fibers.solve(&**curves, path_length, activation),
            CurveSet::DeGrooteFregly(curves) => fibers.solve(curves, path_length, activation),
            CurveSet::Schutte(curves) => fibers.solve(&**curves, path_length, activation),
            CurveSet::Mujoco(curves) => fibers.solve(curves, path_length, activation),
        }
    }

    /// The forces at rest of fibres of a length (m) that need not be in equilibrium with the tendon: [`FiberState::imbalance`] says how far
    /// they are from it. Does not allocate.
    pub fn at_fiber_length(&self, path_length: f64, fiber_length: f64, activation: f64) -> FiberState {
        let (length, activation) =
            (fiber_length.max(self.fibers.least_length), activation.max(self.spec.least_activation).min(1.0));
        match &self.curves {
            CurveSet::Thelen(curves) => self.fibers.at(curves, path_length, activation, length),
            CurveSet::Millard(curves) => self.fibers.at(&**curves, path_length, activation, length),
            CurveSet::DeGrooteFregly(curves) => self.fibers.at(curves, path_length, activation, length),
            CurveSet::Schutte(curves) => self.fibers.at(&**curves, path_length, activation, length),
            CurveSet::Mujoco(curves) => self.fibers.at(curves, path_length, activation, length),
        }
    }
}
