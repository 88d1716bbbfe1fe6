//! What must be remembered for a run to go on?

use serde::{Deserialize, Serialize};

use super::group::GroupState;
use crate::constraint::HalfSpace;
use crate::hybrid::{Decision, Strategy};
use crate::posture::Posture;

/// Everything that one step hands to the next. What else a simulation holds is computed from it, or helps to compute faster.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    /// Steps made.
    pub(super) steps: u64,
    pub(super) posture: Posture,
    pub(super) groups: Vec<[GroupState; 2]>,
    /// Events that have happened.
    pub(super) next_event: usize,
    /// Strategy of every coordinate.
    pub(super) strategies: Vec<Strategy>,
    /// What the last sample showed: active torque, fatigue, effort, decisions.
    pub(super) active: Vec<f64>,
    pub(super) fatigue: Vec<[f64; 2]>,
    pub(super) effort: f64,
    pub(super) decisions: Vec<Option<Decision>>,
    /// By coordinate.
    pub(super) requests: Vec<Request>,
    /// Some relief asks for motion.
    pub(super) pressing: bool,
}

/// What the relief of one coordinate asks for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Request {
    /// The half-space; the whole space where nothing is asked.
    pub(super) constraint: HalfSpace,
    /// The relief of this recovery has led somewhere, and holds.
    pub(super) held: bool,
    /// The decision that is being followed.
    pub(super) followed: Option<Decision>,
    /// Change of active torque that it foretold for the next step, N m.
    pub(super) predicted: f64,
    /// Largest active torque that it foretold on the way to its goal, N m.
    pub(super) foretold: f64,
    /// Effort when the present recovery first asked for relief.
    pub(super) effort_at_trip: f64,
}

impl State {
    /// `n` coordinates at the start.
    pub(super) fn new(posture: Posture, strategies: Vec<Strategy>) -> Self {
        let n = strategies.len();
        let request = Request {
            constraint: HalfSpace::new(n),
            held: false,
            followed: None,
            predicted: 0.0,
            foretold: 0.0,
            effort_at_trip: 0.0,
        };
        Self {
            steps: 0,
            posture,
            groups: vec![[GroupState::default(); 2]; n],
            next_event: 0,
            strategies,
            active: vec![0.0; n],
            fatigue: vec![[0.0; 2]; n],
            effort: 0.0,
            decisions: vec![None; n],
            requests: vec![request; n],
            pressing: false,
        }
    }

    /// Is there one entry a coordinate, and is every number one?
    pub(super) fn fits(&self, n: usize, events: usize) -> bool {
        let counts = [
            self.groups.len(),
            self.strategies.len(),
            self.active.len(),
            self.fatigue.len(),
            self.decisions.len(),
            self.requests.len(),
        ];
        let sizes = self.requests.iter().map(|request| request.constraint.normal.len());
        counts.into_iter().chain(sizes).all(|count| count == n)
            && self.next_event <= events
            && self.effort.is_finite()
            && self.active.iter().chain(self.fatigue.iter().flatten()).all(|v| v.is_finite())
            && self.requests.iter().all(Request::is_finite)
    }
}

impl Request {
    fn is_finite(&self) -> bool {
        let numbers = [self.constraint.offset, self.predicted, self.foretold, self.effort_at_trip];
        numbers.iter().chain(&self.constraint.normal).all(|v| v.is_finite())
    }
}
