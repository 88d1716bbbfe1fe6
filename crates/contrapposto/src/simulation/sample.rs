//! Holds what a run shows of one instant.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::muscle_outcome::MuscleSummary;
use crate::contact::Slip;
use crate::hybrid::{Decision, Strategy};
use crate::model::Side;

/// One instant. Torques and decisions belong to the posture shown, which is the one before the step's motion.
#[derive(Debug)]
pub struct Sample<'a> {
    /// Time, s.
    pub time: f64,
    /// Value of every coordinate, rad or m.
    pub posture: &'a [f64],
    /// Angle that the torques of every coordinate belong to, rad or m: of a three-axis joint those about the axes that stand for its coordinates,
    /// else the value.
    pub angles: &'a [f64],
    /// External torque of every coordinate, N m (N for slides). Depends on posture and loads.
    pub external: &'a [f64],
    /// Passive torque of every coordinate. Depends on posture.
    pub passive: &'a [f64],
    /// Active torque, `-(passive + external)` (Eq. 1).
    pub active: &'a [f64],
    /// |Active torque| over the strength of the group that works, of every coordinate; 0 where strength is not known.
    pub load: &'a [f64],
    /// Relative load by which the positive and negative group of every coordinate tires: `load` of the group that works, or where muscles tire one by
    /// one the torque over the greatest one that rested muscles give beside all others.
    pub group_load: &'a [[f64; 2]],
    /// Fatigue of the positive and negative group of every coordinate, 0..=1. Depends on the load so far.
    pub fatigue: &'a [[f64; 2]],
    /// Every muscle of a body whose muscles tire one by one; none of another body. Depends on the load so far.
    pub muscles: &'a [MuscleSummary],
    /// Whether the positive and negative group of every coordinate can no longer hold their load.
    pub exhausted: &'a [[bool; 2]],
    /// For how long the positive and negative group of every coordinate could go on to hold their present load, s; infinite for ever.
    pub seconds_left: &'a [[f64; 2]],
    /// A support is being put elsewhere: weight is shifted for it, or it is in the air. Such a second or two is a motion, whose torques
    /// at rest say little.
    pub stepping: bool,
    /// The decision of every coordinate that requests relief.
    pub decisions: &'a [Option<Decision>],
    /// The muscle group of every coordinate that requests relief.
    pub asking: &'a [Option<Side>],
    /// The attempts by which relief is sought for these groups.
    pub attempts: &'a [Option<Attempt>],
    /// The outcome of the relief of every coordinate, in the step that led here.
    pub reliefs: &'a [Option<Relief>],
    /// Contact forces, task errors and effort of a body with supports or tasks.
    pub standing: Option<&'a Standing>,
    /// Strategy of every coordinate.
    pub strategies: &'a [Strategy],
    /// Relief was requested, and moves nothing any more.
    pub settled: bool,
}

/// The parts of a sample that no later step needs.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) angles: Vec<f64>,
    pub(super) external: Vec<f64>,
    pub(super) passive: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) group_load: Vec<[f64; 2]>,
    pub(super) exhausted: Vec<[bool; 2]>,
    pub(super) seconds_left: Vec<[f64; 2]>,
    pub(super) stepping: bool,
    pub(super) asking: Vec<Option<Side>>,
    pub(super) attempts: Vec<Option<Attempt>>,
    pub(super) reliefs: Vec<Option<Relief>>,
    pub(super) standing: Standing,
    pub(super) settled: bool,
    /// Work of all searches before this time step.
    pub(super) searched_before: usize,
}

impl Record {
    /// Space for `n` coordinates.
    pub(super) fn new(n: usize) -> Self {
        Self {
            angles: vec![0.0; n],
            external: vec![0.0; n],
            passive: vec![0.0; n],
            load: vec![0.0; n],
            group_load: vec![[0.0; 2]; n],
            exhausted: vec![[false; 2]; n],
            seconds_left: vec![[f64::INFINITY; 2]; n],
            stepping: false,
            asking: vec![None; n],
            attempts: vec![None; n],
            reliefs: vec![None; n],
            standing: Standing::default(),
            settled: false,
            searched_before: 0,
        }
    }
}

/// The outcome of a relief in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relief {
    /// The motion was carried out: predicted and actual change of active torque, N m.
    Done {
        /// From the slope along the motion.
        predicted: f64,
        /// Computed in the posture that was reached.
        actual: f64,
    },
    /// Supports, tasks above relief or the relief of a more fatigued group did not allow the motion.
    Deferred,
    /// The motion raised the joint's own torque above its predicted peak, or cost too much effort, and was taken back.
    TakenBack,
}

/// Way in which relief is sought for a tired muscle group. Each attempt follows on the one above it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Attempt {
    /// The group's joint moves to a goal of the strategy that the scenario gives.
    #[default]
    Strategy,
    /// The group's joint moves to a goal of the other strategy.
    OtherStrategy,
    /// Another joint moves, by which the torque of its joint falls.
    OtherJoint {
        /// The coordinate that moves.
        coordinate: usize,
        /// Positive: upward.
        direction: Side,
    },
    /// Nothing is left to try in the present recovery.
    GivenUp,
}

/// Contact forces, task errors and effort of a body with supports or tasks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// One a support, in the order of the scenario.
    pub contacts: Vec<Contact>,
    /// Length of the error of each task, in its units.
    pub errors: Vec<f64>,
    /// Distance of the supports from their places.
    pub slip: Slip,
    /// Centre of mass, ground, m.
    pub center_of_mass: Vector3<f64>,
    /// Sum of the squared relative loads: see [`crate::joint_torques::effort`].
    pub effort: f64,
}

/// The force at a support.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Force on the body, ground axes, N.
    pub force: Vector3<f64>,
    /// Normal part of the force as a share of body weight.
    pub share: f64,
    /// Point at which the force acts, ground, m; `None` where nothing is carried.
    pub center_of_pressure: Option<Vector3<f64>>,
    /// The couple about that point (about the ground's origin where nothing is carried), ground axes, N m.
    pub couple: Vector3<f64>,
}

/// Way in which the body changes what carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepKind {
    /// A support is put elsewhere on its plane.
    Elsewhere,
    /// A support that was not in use is put on its plane.
    PutDown,
    /// A support is taken off its plane.
    TakenOff,
}

impl StepKind {
    /// `elsewhere`, `put_down` or `taken_off`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Elsewhere => "elsewhere",
            Self::PutDown => "put_down",
            Self::TakenOff => "taken_off",
        }
    }
}

/// A support that was put elsewhere, put on its plane or taken off it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FootStep {
    /// Index of the support.
    pub support: usize,
    /// The change.
    pub kind: StepKind,
    /// The coordinate whose relief asked for it, and its tired group; `None` of a hand that was taken up because it kept the body from a task.
    pub relieves: Option<(usize, Side)>,
    /// Times at which the body began to shift its weight, and at which it had taken the new posture, s.
    pub time: (f64, f64),
    /// Middle of the patch before and after, ground, m.
    pub place: ([f64; 3], [f64; 3]),
    /// Effort before and after.
    pub effort: (f64, f64),
}
