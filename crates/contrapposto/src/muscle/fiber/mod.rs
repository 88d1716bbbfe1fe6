//! Computes the forces of a muscle at rest: fibres of constant width beside each other, in series with a tendon.
//!
//! With fibre length `l`, pennation `sin(phi) = w / l`, activation `a` and path length `L`, forces over the greatest isometric force:
//! `(a active(l) + passive(l)) cos(phi) = tendon(L - l cos(phi))`. A rigid tendon has its slack length always.

mod curve;
mod equilibrium;
mod millard2012;
mod thelen2003;

pub use millard2012::{ActiveCurve, Millard2012, PassiveFiberCurve, PassiveShape, TendonCurve, TendonShape};
pub use thelen2003::Thelen2003;

use millard2012::Millard;

/// Force over the greatest isometric force, and its slope, against length over optimal (fibres) or slack length (tendon).
trait Curves {
    fn active(&self, length: f64) -> (f64, f64);
    fn passive(&self, length: f64) -> (f64, f64);
    fn tendon(&self, length: f64) -> (f64, f64);
}

/// The law of a muscle's fibres and tendon, by its publication.
#[derive(Clone, Debug, PartialEq)]
pub enum FiberLaw {
    /// Thelen 2003.
    Thelen2003(Thelen2003),
    /// Millard, Uchida, Seth & Delp 2013.
    Millard2012(Millard2012),
}

/// The numbers of a muscle.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleSpec {
    /// Its name.
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

/// Why numbers make no muscle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {value}; accepted: {accepted}")]
pub struct MuscleError {
    /// The number's name.
    pub what: &'static str,
    /// It.
    pub value: f64,
    /// The values that have a meaning.
    pub accepted: &'static str,
}

/// A muscle, ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    spec: MuscleSpec,
    curves: CurveSet,
    /// Width of the fibres' parallelogram, m.
    width: f64,
    /// Shortest length of the fibres, m.
    least_length: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum CurveSet {
    Thelen(Thelen2003),
    Millard(Box<Millard>),
}

/// A muscle in equilibrium at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FiberState {
    /// m.
    pub fiber_length: f64,
    /// Cosine of the angle between fibres and tendon.
    pub cos_pennation: f64,
    /// Force of the tendon, N.
    pub tendon_force: f64,
    /// Active force of the fibres along the tendon, N.
    pub active_force: f64,
    /// Passive force of the fibres along the tendon, N.
    pub passive_force: f64,
    /// Fibre force along the tendon less tendon force, over the greatest isometric force; zero but for rounding, unless the fibres are at
    /// their shortest length.
    pub imbalance: f64,
    /// The fibres are at their shortest length and carry nothing.
    pub shortest: bool,
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
        if !(spec.tendon_slack_length >= 0.0 && spec.tendon_slack_length <= crate::model::LARGEST) {
            return refuse("tendon_slack_length", spec.tendon_slack_length, "0 to 1e9");
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
        };
        let width = spec.optimal_fiber_length * spec.pennation.sin();
        let pennate = width / spec.max_pennation.sin();
        let least_length = match &curves {
            CurveSet::Thelen(_) => pennate,
            CurveSet::Millard(curves) => pennate.max(curves.least_length * spec.optimal_fiber_length),
        };
        Ok(Self { spec, curves, width, least_length })
    }

    /// Its numbers.
    pub fn spec(&self) -> &MuscleSpec {
        &self.spec
    }

    /// The equilibrium at rest at a path length (m) and an activation; activations below the least one count as that. Does not allocate.
    pub fn at_rest(&self, path_length: f64, activation: f64) -> FiberState {
        let activation = activation.max(self.spec.least_activation).min(1.0);
        match &self.curves {
            CurveSet::Thelen(curves) => equilibrium::solve(self, curves, path_length, activation),
            CurveSet::Millard(curves) => equilibrium::solve(self, &**curves, path_length, activation),
        }
    }

    /// Length of fibres whose extent along the tendon is given, m; the shortest where it is too small.
    fn length_of_extent(&self, extent: f64) -> f64 {
        let length = self.width.hypot(extent);
        if extent > 0.0 { length.max(self.least_length) } else { self.least_length }
    }

    /// Cosine of the pennation of fibres of a length.
    fn cos_pennation(&self, length: f64) -> f64 {
        let sin = self.width / length;
        ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt()
    }
}
