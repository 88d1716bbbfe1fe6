//! Follows a planned way sample by sample, and looks for one: a step that relieves a tired group, a hand taken up that keeps the body from a task,
//! or an easier posture at rest.

use super::approach::Approach;
use super::body_motion::BodyMotion;
use super::easiest::{Budget, Eased, SEARCH_BUDGET, SEARCH_BUDGET_OF_STEP, Searched};
use super::foot_step::{Changes, PlannedStep, Purpose, Tired, plan_step, search_changes};
use super::{FootStep, ScenarioError, Simulation, StepKind};
use crate::hybrid::Decision;
use crate::model::Side;

impl Simulation<'_> {
    /// The steps that have been taken, without one that is under way.
    pub(super) fn foot_steps(&self) -> &[FootStep] {
        let stepping = self.state.path.as_ref().is_some_and(|path| path.has_step());
        let steps = &self.state.foot_steps;
        &steps[..steps.len() - usize::from(stepping)]
    }

    /// Takes the next posture of the way, if there is one, and computes all torques in it; returns whether it did.
    pub(super) fn follow_path(&mut self) -> Result<bool, ScenarioError> {
        let Some(path) = &mut self.state.path else { return Ok(false) };
        let was_lifted = path.lifted().is_some();
        if let Some(posture) = path.take() {
            self.state.posture.values_mut().copy_from_slice(posture.values());
        }
        let (lifted, is_over, has_step) = (path.lifted(), path.is_over(), path.has_step());
        let Some(body) = self.motion.body_mut() else { return Ok(false) };
        let lands = (was_lifted && lifted.is_none()) || (is_over && has_step);
        body.lift(if is_over { None } else { lifted })?;
        if lands {
            let in_use = &mut self.state.in_use;
            match self.state.foot_steps.last() {
                Some(step) if step.kind == StepKind::PutDown && !in_use.contains(&step.support) => {
                    in_use.push(step.support);
                    in_use.sort_unstable();
                }
                Some(step) if step.kind == StepKind::TakenOff => in_use.retain(|number| *number != step.support),
                _ => {}
            }
            body.place_again(&self.state.posture, in_use)?;
            self.state.placed_at = Some(self.state.posture.clone());
            self.state.eased = None;
            self.state.minima.clear();
        }
        if is_over {
            body.restart_convergence();
        }
        let effort = self.evaluate()?;
        if is_over {
            self.end_path(effort, has_step);
        }
        (self.record.standing.effort, self.state.effort) = (effort, Some(effort));
        if let Some(body) = self.motion.body() {
            body.write_standing(&mut self.record.standing);
        }
        Ok(true)
    }

    /// Ends the way before an event: a support in the air is put down at its new place within the same time step, any other motion
    /// stops where it is.
    pub(super) fn end_path_at_once(&mut self) -> Result<(), ScenarioError> {
        self.state.searched_here = false;
        self.state.eased = None;
        self.state.minima.clear();
        self.state.step_tried.fill(false);
        self.state.approach = Approach::default();
        let Some(path) = &mut self.state.path else { return Ok(()) };
        if path.has_step() {
            path.skip_to_end();
            self.follow_path()?;
        } else {
            self.state.path = None;
        }
        Ok(())
    }

    /// Ends the way: reliefs of an old place are asked for anew, and every goal may be taken up.
    fn end_path(&mut self, effort: f64, has_step: bool) {
        self.state.path = None;
        let time = self.state.steps as f64 * self.scenario.run.step;
        if let (Some(step), true) = (self.state.foot_steps.last_mut(), has_step) {
            (step.time.1, step.effort.1) = (time, effort);
            self.state.requests.iter_mut().for_each(super::state::Request::end);
            self.state.groups.iter_mut().flatten().for_each(super::group_state::GroupState::restart);
        }
    }

    /// Looks for a step that relieves the tired group of coordinate `i`, once in a recovery.
    pub(super) fn look_for_step(&mut self, i: usize, side: Side, decision: &Decision) -> Result<(), ScenarioError> {
        let Some(goal) = decision.goal else { return Ok(()) };
        let toward = goal - self.motion.torques().angles()[i];
        if self.state.step_tried[i] || self.state.path.is_some() {
            return Ok(());
        }
        let tired = Tired { coordinate: i, side, load: self.record.load[i], toward };
        let known = self.changes.take();
        let Some((planned, changes)) = self.planned_step(Purpose::Relief(tired), known)? else { return Ok(()) };
        self.changes = Some(changes);
        self.state.step_tried[i] = true;
        self.state.approach.is_over |= planned.is_some();
        self.begin(planned);
        Ok(())
    }

    /// The step that serves a purpose, of the changes that are `known` from a search in this time step, or of those that a search finds; with these
    /// changes. `None` where the budget of searches is used up.
    fn planned_step(
        &mut self,
        purpose: Purpose<'_>,
        known: Option<Changes>,
    ) -> Result<Option<(Option<PlannedStep>, Changes)>, ScenarioError> {
        let Some(budget) = self.search_budget() else { return Ok(None) };
        let Some(body) = self.motion.body() else { return Ok(None) };
        let changes = match known {
            Some(found) => Searched { found, ..Searched::default() },
            None => search_changes(body, &self.state.posture, purpose, budget)?,
        };
        let left = budget.saturating_sub(changes.work);
        let planned = plan_step(body, &self.state.posture, purpose, &changes.found, left)?;
        self.count_search(changes.work + planned.work, changes.cut || planned.cut);
        Ok(Some((planned.found, changes.found)))
    }

    /// Looks for a hand at rest to take up, once in an event: where the body is as near to its tasks as it comes with the hand there and one of
    /// them is missed. A hand that a relief has put down since the event stays.
    pub(super) fn look_for_reach(&mut self) -> Result<(), ScenarioError> {
        let rests = |number: &usize| self.scenario.rests.iter().any(|rest| rest.support == *number);
        if self.state.approach.is_over || self.state.path.is_some() || !self.state.in_use.iter().any(rests) {
            return Ok(());
        }
        let Some(errors) = self.motion.body().and_then(BodyMotion::missed) else { return Ok(()) };
        let stalls = self.state.approach.stalls(&errors, self.state.steps, self.scenario.run.step);
        if !stalls && !self.motion.is_at_rest() {
            return Ok(());
        }
        let Some((planned, _)) = self.planned_step(Purpose::Reach(&errors), None)? else { return Ok(()) };
        self.state.approach = Approach::default();
        self.state.approach.is_over = planned.is_none();
        self.begin(planned);
        Ok(())
    }

    /// Begins the step that a search has found, if any.
    fn begin(&mut self, planned: Option<PlannedStep>) {
        if let Some(PlannedStep { path, mut step }) = planned {
            step.time.0 = self.state.steps as f64 * self.scenario.run.step;
            self.state.foot_steps.push(step);
            self.state.path = Some(path);
        }
    }

    /// Looks for an easier posture once the body has come to rest.
    pub(super) fn look_for_ease(&mut self) -> Result<(), ScenarioError> {
        if self.state.path.is_some() || !self.motion.is_at_rest() {
            return Ok(());
        }
        if self.state.searched_here || self.motion.body_mut().is_none() {
            return Ok(());
        }
        let asked: Vec<bool> = self.state.requests.iter().map(|request| request.in_force).collect();
        let here = Eased { posture: self.state.posture.clone(), asked };
        if self.state.eased.as_ref().is_some_and(|eased| eased.is_like(&here, &self.scenario.model)) {
            self.state.searched_here = true;
            return Ok(());
        }
        let Some(mut budget) = self.search_budget() else { return Ok(()) };
        let Some(body) = self.motion.body_mut() else { return Ok(()) };
        self.state.searched_here = true;
        let budget_of_search = Budget { scattered: 0, work: budget, carriers_stay: true };
        let Searched { found, minima, work, cut } =
            body.easiest(&self.state.posture, &self.state.minima, budget_of_search)?;
        if self.state.minima.is_empty() {
            self.state.minima = minima;
        }
        let all = budget;
        budget = budget.saturating_sub(work);
        self.state.eased = found.is_none().then_some(here);
        if let Some(better) = found {
            self.state.path = body.way(&self.state.posture, &better, None, &mut budget);
        }
        self.count_search(all - budget, cut || budget == 0);
        Ok(())
    }

    /// Work that the next search of this time step may do; `None` where the budget of the step or of the run is used up, which is noted.
    fn search_budget(&mut self) -> Option<usize> {
        let in_step = self.state.searched.saturating_sub(self.record.searched_before);
        let of_step = SEARCH_BUDGET_OF_STEP.saturating_sub(in_step);
        let budget = of_step.min(SEARCH_BUDGET.saturating_sub(self.state.searched));
        self.state.search_cut |= budget == 0;
        (budget > 0).then_some(budget)
    }

    fn count_search(&mut self, work: usize, cut: bool) {
        self.state.searched += work;
        self.state.search_cut |= cut;
    }
}
