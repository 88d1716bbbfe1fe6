//! Holds the state of a simulation: all that one step hands to the next one.

use serde::{Deserialize, Serialize};

use super::Event;
use super::group_state::GroupState;
use super::path::Path;
use super::sample::FootStep;
use crate::constraint::HalfSpace;
use crate::hybrid::{Decision, Strategy};
use crate::model::Side;
use crate::posture::Posture;

/// Everything that one step hands to the next. Whatever else a simulation holds is computed from it, or makes it faster.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    /// Steps made.
    pub(super) steps: u64,
    pub(super) posture: Posture,
    pub(super) groups: Vec<[GroupState; 2]>,
    /// Number of events that have been applied.
    pub(super) next_event: usize,
    /// Strategy of every coordinate.
    pub(super) strategies: Vec<Strategy>,
    /// Of the last sample: active torque (N m), fatigue, effort, decisions.
    pub(super) active: Vec<f64>,
    pub(super) fatigue: Vec<[f64; 2]>,
    pub(super) effort: f64,
    pub(super) decisions: Vec<Option<Decision>>,
    /// By coordinate.
    pub(super) requests: Vec<Request>,
    /// Some relief asks for motion, not only for a half-space to be kept.
    pub(super) reliefs_move: bool,
    /// Where the supports stand, once one of them has been put elsewhere.
    pub(super) placed_at: Option<Posture>,
    /// The way that the body follows.
    pub(super) path: Option<Path>,
    /// Supports put elsewhere so far; the way follows the last one until it has an end.
    pub(super) foot_steps: Vec<FootStep>,
    /// By coordinate: a step was looked for in its present recovery.
    pub(super) step_tried: Vec<bool>,
    /// Solver steps of all searches so far.
    pub(super) searched: usize,
    /// The body has not moved since the last search.
    pub(super) searched_here: bool,
}

/// The constraint that the relief of one coordinate puts on the posture, and what its decision predicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Request {
    /// The half-space; the whole space where no relief is requested.
    pub(super) half_space: HalfSpace,
    /// The half-space is kept for as long as the recovery lasts.
    pub(super) in_force: bool,
    /// The decision that is followed.
    pub(super) followed: Option<Decision>,
    /// Change of active torque predicted for the next step, N m.
    pub(super) predicted_change: f64,
    /// Greatest size of active torque predicted on the way to the goal, N m.
    pub(super) predicted_peak: f64,
    /// Effort when the present recovery first requested relief.
    pub(super) effort_at_start: f64,
}

impl State {
    /// `n` coordinates at the start.
    pub(super) fn new(posture: Posture, strategies: Vec<Strategy>) -> Self {
        let n = strategies.len();
        let request = Request {
            half_space: HalfSpace::new(n),
            in_force: false,
            followed: None,
            predicted_change: 0.0,
            predicted_peak: 0.0,
            effort_at_start: 0.0,
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
            reliefs_move: false,
            placed_at: None,
            path: None,
            foot_steps: vec![],
            step_tried: vec![false; n],
            searched: 0,
            searched_here: true,
        }
    }

    /// Whether there is one entry a coordinate, and every number is finite.
    pub(super) fn fits(&self, n: usize, supports: usize, events: usize) -> bool {
        let counts = [
            self.groups.len(),
            self.strategies.len(),
            self.active.len(),
            self.fatigue.len(),
            self.decisions.len(),
            self.requests.len(),
            self.step_tried.len(),
        ];
        let sizes = self.requests.iter().map(|request| request.half_space.normal.len());
        counts.into_iter().chain(sizes).all(|count| count == n)
            && self.next_event <= events
            && self.effort.is_finite()
            && self.active.iter().chain(self.fatigue.iter().flatten()).all(|v| v.is_finite())
            && self.requests.iter().all(Request::is_finite)
            && self.path.as_ref().is_none_or(|path| path.fits(n, supports))
    }

    /// Applies what an event changes of the strategies, and ends the recoveries that it makes obsolete.
    pub(super) fn apply(&mut self, event: &Event) {
        let elsewhere = event.loads.is_some() || !event.tasks.is_empty();
        let strategies = event.strategies.as_ref().unwrap_or(&self.strategies).clone();
        for (i, &strategy) in strategies.iter().enumerate() {
            let changed = strategy != self.strategies[i];
            // Another strategy begins a new recovery; with another load or target a relief that cost too much may pay.
            for group in &mut self.groups[i] {
                if changed {
                    group.forget_strategy();
                }
                if changed || elsewhere {
                    group.rejections = 0;
                }
            }
            if changed || elsewhere {
                self.requests[i].followed = None;
            }
        }
        self.strategies = strategies;
        if elsewhere {
            // The effort before the event does not tell whether the next step is worth its cost.
            self.effort = f64::INFINITY;
        }
    }

    /// Coordinates whose half-space is to be kept, the most fatigued first.
    pub(super) fn requested(&self) -> Vec<usize> {
        let requested = |i: &usize| self.decisions[*i].is_some() || self.requests[*i].in_force;
        let mut list: Vec<usize> = (0..self.decisions.len()).filter(requested).collect();
        let fatigue = |i: &usize| self.fatigue[*i][0].max(self.fatigue[*i][1]);
        list.sort_by(|a, b| fatigue(b).total_cmp(&fatigue(a)));
        list
    }

    /// The muscle group of a coordinate that requests relief: the one that gives the active torque if it recovers. Within the
    /// tolerance neither group gives torque, and either may request.
    pub(super) fn requesting_side(&self, coordinate: usize, torque_tolerance: f64) -> Option<Side> {
        let within = self.active[coordinate].abs() <= torque_tolerance;
        let working = Side::of(self.active[coordinate]);
        let requests = |side: &Side| self.groups[coordinate][side.index()].recovering && (within || *side == working);
        [working, Side::BOTH[1 - working.index()]].into_iter().find(requests)
    }

    /// The decision that coordinate `i` follows: the new one, or with `hysteresis` the last one until the new one is confirmed.
    pub(super) fn follow(&mut self, i: usize, side: Side, decision: Decision, hysteresis: bool) -> Decision {
        let (request, group) = (&mut self.requests[i], &mut self.groups[i][side.index()]);
        let mut followed = decision;
        if let (Some(last), true) = (request.followed, hysteresis) {
            group.count(decision.outcome);
            if !group.is_confirmed() {
                followed = last;
            }
        }
        if request.followed.is_none() {
            request.effort_at_start = self.effort;
        }
        request.followed = Some(followed);
        group.accept(followed.outcome);
        followed
    }
}

impl Request {
    /// Ends the request when no group of its coordinate recovers.
    pub(super) fn end(&mut self) {
        (self.in_force, self.followed) = (false, None);
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.half_space.offset, self.predicted_change, self.predicted_peak, self.effort_at_start];
        numbers.iter().chain(&self.half_space.normal).all(|v| v.is_finite())
    }
}
