//! What does a run show of one instant?

use nalgebra::Vector3;

use crate::hybrid::{Decision, Strategy};
use crate::model::Side;

/// One instant. Torques and decisions belong to the posture shown, which is the one before the step's motion.
#[derive(Debug)]
pub struct Sample<'a> {
    /// Time, s.
    pub time: f64,
    /// Value of every coordinate, rad or m.
    pub posture: &'a [f64],
    /// External torque of every coordinate, N m (N for slides). Depends on posture and loads.
    pub external: &'a [f64],
    /// Passive torque of every coordinate. Depends on posture.
    pub passive: &'a [f64],
    /// Active torque, `-(passive + external)` (Eq. 1).
    pub active: &'a [f64],
    /// |Active torque| over the strength of the group that works, of every coordinate; 0 where strength is not known.
    pub load: &'a [f64],
    /// Fatigue of the positive and negative group of every coordinate, 0..=1. Depends on the load so far.
    pub fatigue: &'a [[f64; 2]],
    /// The decision of every coordinate that asked for relief.
    pub decisions: &'a [Option<Decision>],
    /// The muscle group of every coordinate that asks for relief.
    pub asking: &'a [Option<Side>],
    /// What became of the relief of every coordinate that asked for it, in the step that led here.
    pub reliefs: &'a [Option<Relief>],
    /// How it stands, for a body with supports or tasks.
    pub standing: Option<&'a Standing>,
    /// Strategy of every coordinate.
    pub strategies: &'a [Strategy],
    /// Relief was asked for, and moves nothing any more.
    pub settled: bool,
}

/// What became of a relief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relief {
    /// It was carried out: the change of active torque that the decision foretold, and the real one, N m.
    Done {
        /// From the slope along the motion.
        predicted: f64,
        /// Computed in the posture that was reached.
        real: f64,
    },
    /// Something more important stood against it: supports, tasks above relief, or a more tired group.
    Deferred,
    /// It made its own torque larger than foretold, and the whole effort with it, and was taken back.
    TakenBack,
    /// The joint cannot move without what stands above relief.
    Blocked,
    /// It was taken back so often that it waits for the next recovery.
    GivenUp,
}

/// How a body stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// One a support, in the order of the scenario.
    pub contacts: Vec<Contact>,
    /// Length of the error of each task, in its units.
    pub errors: Vec<f64>,
    /// How far supports are off their places, m and rad together.
    pub slip: f64,
    /// Centre of mass, ground, m.
    pub center_of_mass: Vector3<f64>,
    /// `sum (active torque / strength)^2` over all coordinates with known strength.
    pub effort: f64,
}

/// What a support carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Force on the body, ground axes, N.
    pub force: Vector3<f64>,
    /// Its normal part as a share of body weight.
    pub share: f64,
    /// Where it acts, ground, m; `None` where nothing is carried.
    pub center_of_pressure: Option<Vector3<f64>>,
    /// The couple about that point (about the ground's origin where nothing is carried), ground axes, N m.
    pub couple: Vector3<f64>,
}
