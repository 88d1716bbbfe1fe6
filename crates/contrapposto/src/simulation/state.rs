//! Holds the state of a simulation: all that one step hands to the next one.

use std::fmt;

use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::Event;
use super::approach::Approach;
use super::easiest::Eased;
use super::goal::Goal;
use super::group_state::GroupState;
use super::muscle_course::MuscleState;
use super::path::Path;
use super::sample::FootStep;
use crate::constraint::HalfSpace;
use crate::hybrid::{Decision, Strategy};
use crate::model::Side;
use crate::posture::Posture;

/// Everything that one step hands to the next. All other fields of a simulation are computed from the state, or make the simulation faster.
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
    /// Of the last sample: active torque (N m), fatigue, effort, decisions. The effort is none from an event to the next sample of
    /// a whole body: the effort before the event is no measure of whether the next step is worth its cost.
    pub(super) active: Vec<f64>,
    pub(super) fatigue: Vec<[f64; 2]>,
    pub(super) effort: Option<f64>,
    /// Effort of the body when the first of the present recoveries requested relief; none where an event made it unknown.
    pub(super) effort_at_start: Option<f64>,
    #[serde(deserialize_with = "decisions")]
    pub(super) decisions: Vec<Option<Decision>>,
    /// By coordinate.
    pub(super) requests: Vec<Request>,
    /// Some relief asks for motion, not only for a half-space to be kept.
    pub(super) reliefs_move: bool,
    /// Posture in which the supports are at their places, once one of them has been put elsewhere.
    pub(super) placed_at: Option<Posture>,
    /// Numbers of the supports in use, ascending.
    pub(super) in_use: Vec<usize>,
    /// The way that the body follows.
    pub(super) path: Option<Path>,
    /// Supports put elsewhere so far; the way follows the last one until it has an end.
    pub(super) foot_steps: Vec<FootStep>,
    /// By coordinate: a step was looked for in its present recovery.
    pub(super) step_tried: Vec<bool>,
    /// Work of all searches so far.
    pub(super) searched: usize,
    /// A search ended at its budget, or was not begun since that of the run is spent.
    pub(super) search_cut: bool,
    /// The body has not moved since the last search.
    pub(super) searched_here: bool,
    /// The posture in which the last search at rest found nothing easier, since tasks, loads and supports are as they are.
    pub(super) eased: Option<Eased>,
    /// Local minima that an earlier search passed, since loads, tasks and supports are as they are.
    pub(super) minima: Vec<Posture>,
    /// Progress of the body toward its tasks while a hand rests.
    pub(super) approach: Approach,
    /// State of the muscles of a run in which they tire one by one.
    pub(super) muscles: Option<MuscleState>,
}

/// The constraint that the relief of one coordinate puts on the posture, and what its decision predicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Request {
    /// The half-space; the whole space where no relief is requested.
    pub(super) half_space: HalfSpace,
    /// The half-space is kept for as long as the recovery lasts.
    pub(super) in_force: bool,
    /// The muscle group that requested relief last in the present recovery.
    pub(super) side: Option<Side>,
    /// The decision that is followed, the goal that was taken up last, and decisions in a row for another one.
    pub(super) followed: Option<Decision>,
    pub(super) goal: Option<Goal>,
    pub(super) contrary: u32,
    /// The step that the last decision requested, rad; `None` where it requested no relief.
    pub(super) step: Option<f64>,
    /// Change of active torque predicted for the next step, N m.
    pub(super) predicted_change: f64,
    /// Greatest size of active torque predicted on the way to the goal, N m.
    pub(super) predicted_peak: f64,
}

/// Rules by which a new decision is followed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Following {
    /// A goal that is no farther away counts as reached, rad.
    pub(super) reach: f64,
    /// A goal that has been left is not taken up again.
    pub(super) remember: bool,
    /// Another goal is taken up only when its decision is repeated.
    pub(super) confirm: bool,
}

/// Another goal is taken up after more than so many contrary decisions in a row. The slope that a decision extrapolates jumps where
/// an edge of a foot begins or ends to carry weight.
const CONTRARY_DECISIONS: u32 = 30;

/// Most decisions of a snapshot (assumed: more coordinates than any body has). A text of 5 bytes stands for the memory of a whole decision.
const MOST_DECISIONS: usize = 1 << 16;

/// Reads decisions, one a coordinate.
fn decisions<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Option<Decision>>, D::Error> {
    struct Decisions;

    impl<'de> Visitor<'de> for Decisions {
        type Value = Vec<Option<Decision>>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a list of decisions")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Self::Value, A::Error> {
            let mut all = vec![];
            while let Some(decision) = from.next_element()? {
                if all.len() == MOST_DECISIONS {
                    return Err(A::Error::custom(format!(
                        "more than {MOST_DECISIONS} decisions; one a coordinate is accepted"
                    )));
                }
                all.push(decision);
            }
            Ok(all)
        }
    }

    from.deserialize_seq(Decisions)
}

impl State {
    /// At the start, on so many supports.
    pub(super) fn new(posture: Posture, strategies: Vec<Strategy>, supports: usize) -> Self {
        let n = strategies.len();
        let request = Request {
            half_space: HalfSpace::new(n),
            in_force: false,
            side: None,
            followed: None,
            goal: None,
            contrary: 0,
            step: None,
            predicted_change: 0.0,
            predicted_peak: 0.0,
        };
        Self {
            steps: 0,
            posture,
            groups: vec![[GroupState::default(); 2]; n],
            next_event: 0,
            strategies,
            active: vec![0.0; n],
            fatigue: vec![[0.0; 2]; n],
            effort: Some(0.0),
            effort_at_start: Some(0.0),
            decisions: vec![None; n],
            requests: vec![request; n],
            reliefs_move: false,
            placed_at: None,
            in_use: (0..supports).collect(),
            path: None,
            foot_steps: vec![],
            step_tried: vec![false; n],
            searched: 0,
            search_cut: false,
            searched_here: true,
            eased: None,
            minima: vec![],
            approach: Approach::default(),
            muscles: None,
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
            && self.in_use.is_sorted_by(|a, b| a < b)
            && self.in_use.last().is_none_or(|last| *last < supports)
            && self.effort.is_none_or(f64::is_finite)
            && self.effort_at_start.is_none_or(f64::is_finite)
            && self.active.iter().chain(self.fatigue.iter().flatten()).all(|v| v.is_finite())
            && self.requests.iter().all(Request::is_finite)
            && self.approach.is_finite()
            && self.path.as_ref().is_none_or(|path| path.fits(n, supports))
            && self.eased.as_ref().is_none_or(|eased| eased.asked.len() == n)
    }

    /// Applies what an event changes of the strategies, and ends the recoveries that it makes obsolete.
    pub(super) fn apply(&mut self, event: &Event) {
        let elsewhere = event.loads.is_some() || !event.tasks.is_empty();
        let strategies = event.strategies.as_ref().unwrap_or(&self.strategies).clone();
        for (i, &strategy) in strategies.iter().enumerate() {
            let changed = strategy != self.strategies[i];
            // Another strategy, load or target begins a new search for relief: what was left or cost too much may pay now.
            if changed || elsewhere {
                self.groups[i].iter_mut().for_each(GroupState::restart);
                self.requests[i].restart();
            }
        }
        self.strategies = strategies;
        if elsewhere {
            self.effort = None;
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

    /// The decision that coordinate `i` follows: the new one if it goes to the goal that was taken up last or to one that may be
    /// taken up now, else the last one as long as its goal lies ahead, else none: the coordinate stays.
    pub(super) fn follow(&mut self, i: usize, side: Side, decision: Decision, angle: f64, how: Following) -> Decision {
        let goal = Goal::of(&decision, angle, how.reach);
        let request = &mut self.requests[i];
        let followed = match goal {
            Some(goal) if how.remember && request.goal != Some(goal) => {
                let may = !self.groups[i].iter().any(|group| group.left.contains(goal));
                request.contrary = if may { request.contrary + 1 } else { 0 };
                let confirmed = request.goal.is_none() || !how.confirm || request.contrary > CONTRARY_DECISIONS;
                let last = request.followed.filter(|last| may && Goal::of(last, angle, how.reach) == request.goal);
                if may && confirmed {
                    self.take_up(i, goal);
                    decision
                } else {
                    last.unwrap_or(decision.staying(angle))
                }
            }
            _ => {
                request.contrary = 0;
                decision
            }
        };
        self.requests[i].followed = Some(followed);
        self.groups[i][side.index()].accept(followed.outcome);
        followed
    }

    /// Coordinate `i` leaves its goal for another one.
    pub(super) fn take_up(&mut self, i: usize, goal: Goal) {
        self.leave_goal(i);
        self.requests[i].goal = Some(goal);
    }

    /// Coordinate `i` leaves its goal, for as long as its groups recover.
    pub(super) fn leave_goal(&mut self, i: usize) {
        let request = &mut self.requests[i];
        request.contrary = 0;
        let Some(left) = request.goal.take() else { return };
        self.groups[i].iter_mut().filter(|group| group.recovering).for_each(|group| group.left.insert(left));
    }

    /// Whether coordinate `i` may take up a goal that is not its present one.
    pub(super) fn is_new(&self, i: usize, goal: Goal) -> bool {
        self.requests[i].goal != Some(goal) && !self.groups[i].iter().any(|group| group.left.contains(goal))
    }
}

impl Request {
    /// Ends the request when no group of its coordinate recovers.
    pub(super) fn end(&mut self) {
        self.restart();
        self.in_force = false;
    }

    /// Forgets what was decided; the half-space stays until the next decision.
    fn restart(&mut self) {
        (self.side, self.followed, self.goal, self.contrary) = (None, None, None, 0);
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.half_space.offset, self.predicted_change, self.predicted_peak];
        let step = self.step.as_slice();
        numbers.iter().chain(step).chain(&self.half_space.normal).all(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::hybrid::{Case, Outcome};
    use crate::passive::SlopeAngles;

    const BODY: Following = Following { reach: 0.01, remember: true, confirm: true };

    /// One coordinate at 0 whose groups both recover.
    fn state() -> State {
        let mut state = State::new(Posture::new(vec![0.0]), vec![Strategy::Passive], 0);
        state.groups[0].iter_mut().for_each(|group| group.recovering = true);
        state
    }

    fn decision(outcome: Outcome, goal: f64) -> Decision {
        let slope_angles = SlopeAngles { lower: None, upper: None };
        Decision { outcome, goal: Some(goal), ..Decision::without_goal(Case::C34, 1.0, slope_angles) }
    }

    /// The goal that is followed after `count` decisions for `outcome` at `goal`.
    fn after(state: &mut State, count: u32, outcome: Outcome, goal: f64) -> (Outcome, f64) {
        let mut followed = None;
        for _ in 0..count {
            followed = Some(state.follow(0, Side::Positive, decision(outcome, goal), 0.0, BODY));
        }
        followed.map(|followed| (followed.outcome, followed.goal.unwrap())).unwrap()
    }

    #[test]
    fn the_31st_contrary_decision_in_a_row_is_followed() {
        let mut state = state();
        assert_eq!(after(&mut state, 1, Outcome::Passive, 0.5), (Outcome::Passive, 0.5));
        assert_eq!(after(&mut state, 30, Outcome::Passive, -0.5), (Outcome::Passive, 0.5));
        assert_eq!(after(&mut state, 1, Outcome::Passive, -0.5), (Outcome::Passive, -0.5));
    }

    #[test]
    fn a_decision_for_the_present_goal_ends_the_count_of_contrary_ones() {
        let mut state = state();
        after(&mut state, 1, Outcome::Passive, 0.5);
        after(&mut state, 30, Outcome::Passive, -0.5);
        assert_eq!(after(&mut state, 1, Outcome::AtLimit, 0.6), (Outcome::AtLimit, 0.6), "the same kind and side");
        assert_eq!(after(&mut state, 30, Outcome::Passive, -0.5), (Outcome::AtLimit, 0.6));
    }

    #[test]
    fn a_goal_that_was_left_is_not_taken_up_again_until_its_group_has_rested() {
        let mut state = state();
        after(&mut state, 1, Outcome::Passive, 0.5);
        after(&mut state, 31, Outcome::Passive, -0.5);
        assert_eq!(after(&mut state, 100, Outcome::Passive, 0.5), (Outcome::Stay, 0.0));
        assert_eq!(after(&mut state, 1, Outcome::Passive, -0.4), (Outcome::Passive, -0.4), "the present goal");
        state.groups[0][0].set_recovering(false, 0.0);
        assert_eq!(
            after(&mut state, 100, Outcome::Passive, 0.5),
            (Outcome::Stay, 0.0),
            "the other group has not rested"
        );
        state.groups[0][1].set_recovering(false, 0.0);
        assert_eq!(after(&mut state, 31, Outcome::Passive, 0.5), (Outcome::Passive, 0.5));
    }

    #[test]
    fn another_load_allows_every_goal() {
        let mut state = state();
        after(&mut state, 1, Outcome::Passive, 0.5);
        after(&mut state, 31, Outcome::Passive, -0.5);
        state.apply(&Event { loads: Some(vec![]), ..Event::default() });
        assert_eq!(after(&mut state, 1, Outcome::Passive, 0.5), (Outcome::Passive, 0.5));
    }

    #[test]
    fn a_goal_within_reach_is_followed_on_either_side() {
        let mut state = state();
        after(&mut state, 1, Outcome::Passive, 0.5);
        assert_eq!(after(&mut state, 1, Outcome::Passive, -0.009), (Outcome::Passive, -0.009));
        assert_eq!(after(&mut state, 1, Outcome::Passive, 0.5), (Outcome::Passive, 0.5));
    }

    #[test]
    fn a_joint_that_others_moved_past_its_goal_stays_until_another_goal_is_confirmed() {
        let mut state = state();
        after(&mut state, 1, Outcome::Passive, 0.5);
        let followed = state.follow(0, Side::Positive, decision(Outcome::Active, 0.2), 0.8, BODY);
        assert_eq!((followed.outcome, followed.goal), (Outcome::Stay, Some(0.8)));
    }

    /// Of one coordinate and two supports, with one event.
    #[test]
    fn a_state_with_an_entry_too_few_or_too_many_or_a_number_that_is_none_does_not_fit() {
        let fresh = || State::new(Posture::new(vec![0.0]), vec![Strategy::Passive], 2);
        assert!(fresh().fits(1, 2, 1));
        assert!(State { effort: None, effort_at_start: None, next_event: 1, ..fresh() }.fits(1, 2, 1));
        type Spoil = (&'static str, fn(&mut State));
        let spoils: [Spoil; 19] = [
            ("groups", |state| state.groups.clear()),
            ("strategies", |state| state.strategies.push(Strategy::Active)),
            ("active torques", |state| state.active.clear()),
            ("fatigue", |state| state.fatigue.push([0.0; 2])),
            ("decisions", |state| state.decisions.clear()),
            ("requests", |state| state.requests.clear()),
            ("steps tried", |state| state.step_tried.push(false)),
            ("a half-space", |state| state.requests[0].half_space.normal.push(0.0)),
            ("events", |state| state.next_event = 2),
            ("the order of supports", |state| state.in_use = vec![1, 0]),
            ("a support twice", |state| state.in_use = vec![1, 1]),
            ("a support that is not there", |state| state.in_use = vec![0, 2]),
            ("effort", |state| state.effort = Some(f64::NAN)),
            ("effort at the start", |state| state.effort_at_start = Some(f64::INFINITY)),
            ("an active torque", |state| state.active[0] = f64::INFINITY),
            ("a fatigue", |state| state.fatigue[0][1] = f64::NAN),
            ("a prediction", |state| state.requests[0].predicted_peak = f64::NAN),
            ("a step", |state| state.requests[0].step = Some(f64::NAN)),
            ("an error", |state| _ = state.approach.stalls(&[f64::NAN], 0, 1.0)),
        ];
        for (what, spoil) in spoils {
            let mut state = fresh();
            spoil(&mut state);
            assert!(!state.fits(1, 2, 1), "{what}");
        }
    }
}
