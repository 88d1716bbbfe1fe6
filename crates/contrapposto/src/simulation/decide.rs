//! Decides how every tired muscle group seeks relief, by Tables 1 and 2, and requests the next step.
//!
//! A group that the goal of its strategy does not let rest tries the other strategy, then another joint that takes torque off its
//! joint, by the row of Eq. 7. A goal that has been left is not taken up again in the same recovery (docs/deviations.md, D4).

use super::goal::Goal;
use super::group_state::GroupState;
use super::prediction::Prediction;
use super::sample::{Attempt, Relief};
use super::state::{Following, State};
use super::step::{SMALLEST_STEP, Simulation};
use super::{ScenarioError, Tables};
use crate::constraint::relief_step;
use crate::hybrid::{Decision, Problem, Strategy, minimise, minimise_literal};
use crate::model::{Model, Side};

/// An attempt ends after so many motions that were taken back,
const MOST_REJECTIONS: u32 = 3;
/// or after more than so many decisions in a row without progress in a posture in which the group does not rest.
const STALLED_DECISIONS: u32 = 30;
/// A step of relief is progress above this size, rad.
const PROGRESS_STEP: f64 = 1e-3;

impl Simulation<'_> {
    /// Decides anew for every free coordinate whose working group recovers ([`super::state::State::requesting_side`]), and notes
    /// whether any relief still moves. The others have no decision; a request ends only when no group of its coordinate recovers.
    pub(super) fn decide(&mut self) -> Result<(), ScenarioError> {
        let (mut decided, mut moves) = (false, false);
        self.record.searched_before = self.state.searched;
        self.changes = None;
        for i in 0..self.state.decisions.len() {
            if !self.state.groups[i].iter().any(|group| group.recovering) {
                self.state.requests[i].end();
                self.state.step_tried[i] = false;
            }
        }
        if self.state.requests.iter().all(|request| request.side.is_none()) {
            self.state.effort_at_start = self.state.effort;
        }
        for i in 0..self.state.decisions.len() {
            self.state.decisions[i] = None;
            // While the body follows a way, no relief is requested.
            let side = self.requesting_side(i).filter(|_| self.state.path.is_none());
            let step = match side {
                Some(side) => self.decide_for(i, side)?,
                None => None,
            };
            self.record.asking[i] = side;
            self.record.attempts[i] = side.map(|side| self.state.groups[i][side.index()].attempt);
            self.state.requests[i].step = step;
            decided |= step.is_some();
            moves |= step.is_some_and(|step| step.abs() > SMALLEST_STEP);
            if let (Some(side), Some(decision)) = (side, self.state.decisions[i]) {
                self.look_for_step(i, side, &decision)?;
            }
        }
        self.state.reliefs_move = moves;
        self.state.searched_here &= !moves;
        self.look_for_reach()?;
        self.look_for_ease()?;
        let still = self.state.path.is_none() && self.motion.is_at_rest();
        self.record.settled = decided && !moves && still;
        Ok(())
    }

    /// The group that requests relief of a coordinate that is free and has a passive law.
    fn requesting_side(&self, i: usize) -> Option<Side> {
        let coordinate = &self.scenario.model.coordinates()[i];
        let may = coordinate.passive.is_some() && coordinate.rate.is_some() && self.scenario.free[i];
        self.state.requesting_side(i, self.scenario.relief.torque_tolerance).filter(|_| may)
    }

    /// Requests the step of one group, which the next time step carries out. Gives that step, rad, zero without a goal; `None` where
    /// nothing is requested: the joint cannot move, its passive law has no falling curve, or nothing is left to try.
    fn decide_for(&mut self, i: usize, side: Side) -> Result<Option<f64>, ScenarioError> {
        let other_side = self.state.requests[i].side.is_some_and(|last| last != side);
        self.state.requests[i].side = Some(side);
        self.next_attempt(i, side, other_side)?;
        match self.state.groups[i][side.index()].attempt {
            Attempt::GivenUp => Ok(None),
            Attempt::OtherJoint { coordinate, direction } => Ok(Some(self.unload(i, coordinate, direction))),
            Attempt::Strategy | Attempt::OtherStrategy => self.relieve(i, side),
        }
    }

    /// Ends an attempt of a body that does not let its group rest, and begins the next one; with the printed tables there is none.
    /// `other_side`: the other group of the coordinate has requested relief in between.
    fn next_attempt(&mut self, i: usize, side: Side, other_side: bool) -> Result<(), ScenarioError> {
        let (is_body, total) = (self.motion.body().is_some(), self.scenario.relief.tables == Tables::Total);
        let stalls = !self.makes_progress(i, side);
        let group = &mut self.state.groups[i][side.index()];
        group.stalled = if stalls { group.stalled + 1 } else { 0 };
        let (rejected, stalled) = (group.rejections >= MOST_REJECTIONS, group.stalled > STALLED_DECISIONS);
        let attempt = group.attempt;
        let joint_is_tired = |joint: usize| self.state.groups[joint].iter().any(|group| group.recovering);
        let ended = match attempt {
            Attempt::GivenUp => false,
            Attempt::OtherJoint { coordinate, .. } if other_side || joint_is_tired(coordinate) => true,
            _ => is_body && (rejected || (stalled && total)),
        };
        if !ended {
            return Ok(());
        }
        let next = match attempt {
            _ if !total => Attempt::GivenUp,
            Attempt::Strategy if self.takes_up_the_other_strategy(i, side)? => Attempt::OtherStrategy,
            Attempt::Strategy | Attempt::OtherStrategy => self.joint_that_unloads(i)?.unwrap_or(Attempt::GivenUp),
            // Another support would be tried here. A step is looked for with the first decision.
            Attempt::OtherJoint { .. } | Attempt::GivenUp => Attempt::GivenUp,
        };
        if next != Attempt::OtherStrategy {
            self.state.leave_goal(i);
        }
        if next == Attempt::GivenUp {
            self.keep_or_let_go(i, side);
        }
        self.state.groups[i][side.index()].begin(next);
        Ok(())
    }

    /// After the last attempt: the relief that was reached is kept if the load of its group has fallen by a larger share than the
    /// effort of the body has risen, else the half-space is let go.
    fn keep_or_let_go(&mut self, i: usize, side: Side) {
        let load = self.record.group_load[i][side.index()];
        let State { groups, requests, posture, effort, effort_at_start, .. } = &mut self.state;
        let request = &mut requests[i];
        let before = groups[i][side.index()].load_at_start;
        let pays = effort.zip(*effort_at_start).is_some_and(|(effort, at_start)| load * effort < before * at_start);
        request.in_force &= pays;
        request.half_space.hold(posture.values());
    }

    /// Whether the group rests in the posture reached, or the last motion of its attempt brought it nearer to that.
    fn makes_progress(&self, i: usize, side: Side) -> bool {
        let (coordinate, relief) = (&self.scenario.model.coordinates()[i], &self.scenario.relief);
        let (request, group) = (&self.state.requests[i], &self.state.groups[i][side.index()]);
        let load = self.record.group_load[i][side.index()];
        let rests = coordinate.groups.as_ref().is_some_and(|groups| {
            let judged = load.max(group.load_at_start);
            groups[side.index()].fatigue.rests(self.scenario.hysteresis.recovery_level, load, judged)
        });
        if rests || self.state.active[i].abs() <= relief.torque_tolerance {
            return true;
        }
        let done = matches!(self.record.reliefs[i], Some(Relief::Done { .. }));
        done && request.step.is_some_and(|step| step.abs() > PROGRESS_STEP)
    }

    /// Follows the tables for one group (on a body the last decision until another one is confirmed).
    fn relieve(&mut self, i: usize, side: Side) -> Result<Option<f64>, ScenarioError> {
        let (scenario, is_body) = (self.scenario, self.motion.body().is_some());
        let strategy = self.state.strategies[i];
        let how = Following {
            reach: scenario.relief.max_step,
            remember: scenario.relief.tables == Tables::Total,
            confirm: is_body,
        };
        let prediction = self.with_problem(i, side, strategy, |state, problem, decision| {
            let followed = state.follow(i, side, decision, problem.angle, how);
            state.decisions[i] = Some(followed);
            let rejections = state.groups[i][side.index()].rejections;
            Prediction::new(problem, &followed, state.active[i], &scenario.relief, rejections)
        })?;
        let Some(prediction) = prediction else { return Ok(None) };
        self.request(i, i, &prediction, is_body);
        Ok(Some(prediction.step))
    }

    /// Takes up the goal of the other strategy if that may be taken up now and promises to remove the least share of torque, `R_min`.
    fn takes_up_the_other_strategy(&mut self, i: usize, side: Side) -> Result<bool, ScenarioError> {
        let Self { scenario, state, .. } = self;
        let other = match state.groups[i][side.index()].accepted.unwrap_or(state.strategies[i]) {
            Strategy::Active => Strategy::Passive,
            Strategy::Passive => Strategy::Active,
        };
        let (reach, least) = (scenario.relief.max_step, scenario.strategy.minimum_decrease_ratio);
        let before = state.groups[i][side.index()].accepted.replace(other);
        let taken = self.with_problem(i, side, other, |state, problem, decision| {
            let removed = decision.active_torque_at_goal.map(|torque| 1.0 - (torque / decision.active_torque).abs());
            let goal = Goal::of(&decision, problem.angle, reach).filter(|goal| state.is_new(i, *goal));
            let goal = goal.filter(|_| removed.is_some_and(|removed| removed >= least));
            goal.inspect(|goal| state.take_up(i, *goal)).is_some()
        })?;
        let taken = taken.unwrap_or(false);
        if !taken {
            self.state.groups[i][side.index()].accepted = before;
        }
        Ok(taken)
    }

    /// The decision of the tables for one group, and what `then` makes of it. `None` where the joint cannot move, or where its passive
    /// law has no falling curve.
    fn with_problem<T>(
        &mut self,
        i: usize,
        side: Side,
        strategy: Strategy,
        then: impl FnOnce(&mut State, &Problem<'_>, Decision) -> T,
    ) -> Result<Option<T>, ScenarioError> {
        let (relief, model) = (&self.scenario.relief, self.model.clone());
        let model: &Model = &model;
        let coordinate = &model.coordinates()[i];
        let Some(rate) = coordinate.rate else { return Ok(None) };
        let Some(external_slope) = self.motion.external_slope(&self.state.posture, i, rate)? else { return Ok(None) };
        let (passive_torque, kinematics) = (self.motion.torques().passive_torque(), self.motion.torques().kinematics());
        let Some(curve) = passive_torque.curve_about_axis(model, kinematics, i, coordinate.range) else {
            return Ok(None);
        };
        let problem = Problem {
            curve: &curve,
            angle: passive_torque.angles()[i],
            external_torque: self.record.external[i],
            external_slope,
            strategy,
            minimum_decrease_ratio: self.scenario.strategy.minimum_decrease_ratio,
            torque_tolerance: relief.torque_tolerance,
            accepted: self.state.groups[i][side.index()].accepted,
        };
        let decision = match relief.tables {
            Tables::Total => minimise(&problem),
            Tables::Literal => minimise_literal(&problem),
        };
        // Every number was checked with the scenario, and the posture is clamped to its ranges.
        Ok(decision.ok().map(|decision| then(&mut self.state, &problem, decision)))
    }

    /// The joint that takes most torque off coordinate `i` in one step, by the row of Eq. 7: one with muscles none of which is tired,
    /// that what stands above relief lets move, and that moves for no other coordinate.
    fn joint_that_unloads(&mut self, i: usize) -> Result<Option<Attempt>, ScenarioError> {
        let joints: Vec<usize> = (0..self.state.groups.len()).filter(|&joint| self.may_unload(i, joint)).collect();
        let mut promised: Vec<_> = joints
            .into_iter()
            .map(|joint| (joint, self.unloading(i, joint)))
            .filter(|(_, prediction)| prediction.step.abs() > PROGRESS_STEP)
            .collect();
        promised.sort_by(|a, b| b.1.change.abs().total_cmp(&a.1.change.abs()));
        for (joint, prediction) in promised {
            let Some(rate) = self.scenario.model.coordinates()[joint].rate else { continue };
            if self.motion.external_slope(&self.state.posture, joint, rate)?.is_some() {
                let direction = Side::of(prediction.step);
                return Ok(Some(Attempt::OtherJoint { coordinate: joint, direction }));
            }
        }
        Ok(None)
    }

    fn may_unload(&self, i: usize, joint: usize) -> bool {
        let coordinate = &self.scenario.model.coordinates()[joint];
        let moves_for_another =
            |group: &GroupState| matches!(group.attempt, Attempt::OtherJoint { coordinate, .. } if coordinate == joint);
        joint != i
            && self.scenario.free[joint]
            && coordinate.rate.is_some()
            && coordinate.groups.is_some()
            && !self.state.groups[joint].iter().any(|group| group.recovering)
            && !self.state.groups.iter().flatten().any(moves_for_another)
    }

    /// The step of `joint` toward the angle at which it would leave coordinate `i` without active torque, if all else stayed.
    fn unloading(&self, i: usize, joint: usize) -> Prediction {
        let (coordinates, relief) = (self.scenario.model.coordinates(), &self.scenario.relief);
        let (torques, active) = (self.motion.torques(), self.state.active[i]);
        let slope = match (coordinates[i].rate, coordinates[joint].rate) {
            (Some(row), Some(column)) => torques.gradient_about_axes().get(row, column),
            _ => 0.0,
        };
        let (angle, range) = (torques.angles()[joint], coordinates[joint].range);
        let goal = if slope == 0.0 { angle } else { (angle + active / slope).clamp(range.0, range.1) };
        let step = relief_step(goal, angle, relief.step_gain, relief.max_step);
        Prediction { step, change: -slope * step, peak: active.abs() }
    }

    /// Requests the step of `joint` that unloads coordinate `i`, in one direction only. Gives that step, rad.
    fn unload(&mut self, i: usize, joint: usize, direction: Side) -> f64 {
        let mut prediction = self.unloading(i, joint);
        if Side::of(prediction.step) != direction {
            (prediction.step, prediction.change) = (0.0, 0.0);
        }
        self.request(i, joint, &prediction, true);
        prediction.step
    }

    /// Requests the step of a prediction for coordinate `i`, by a motion of `joint`.
    fn request(&mut self, i: usize, joint: usize, prediction: &Prediction, is_body: bool) {
        let request = &mut self.state.requests[i];
        (request.predicted_change, request.predicted_peak) = (prediction.change, prediction.peak);
        // On a body a half-space stays as long as its group recovers, whatever less important tasks ask for.
        if !is_body || !request.in_force || prediction.step.abs() > SMALLEST_STEP {
            let model = &self.scenario.model;
            self.motion.torques().write_turn(model, joint, prediction.step, &mut self.relief_step);
            request.in_force = request.half_space.ask_for(self.state.posture.values(), &self.relief_step);
        }
    }
}
