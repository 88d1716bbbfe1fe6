//! Finds where a body begins and where it may go: the start, easier postures, ways to them, and supports put elsewhere.

use std::cell::Cell;

use super::ScenarioError;
use super::body_motion::{BodyMotion, engine, is_effort};
use super::easiest::{
    Budget, MOST_SLIP, Now, SEARCH_BUDGET_OF_STEP, Searched, UNREACHED, WORTH_NEARING, easiest, first_difference,
    is_better, search,
};
use super::offer::Offer;
use super::path::{Path, Planner, greatest_load};
use super::sample::StepKind;
use crate::contact::{Balance, Place, Support};
use crate::equilibria::{Aim, SCATTERED_STARTS};
use crate::joint_torques::JointTorquesError;
use crate::kinematics::Kinematics;
use crate::posture::Posture;
use crate::posture_solver::{Engine, Options, SolvedPosture};
use crate::tasks::{PriorityLevel, Task, held_place};

/// Scattered starts of the search for the start: a quarter of the usual number, for time.
const SCATTERED_AT_THE_START: usize = SCATTERED_STARTS / 4;
/// Greatest change of a joint in the search for the start, rad or m.
const START_MAX_STEP: f64 = 0.1;

impl BodyMotion<'_> {
    /// The posture nearest to the scenario's start in which the supports hold the body and its tasks are done; what carries nothing
    /// takes the posture of least effort that a search finds, and the whole body the local minimum near that.
    pub(super) fn start(&mut self) -> Result<Searched<Posture>, ScenarioError> {
        let scenario = self.scenario;
        let mut solved = self.solved(&scenario.start, 0)?;
        let missed = self.misses(&solved);
        if missed {
            let other = self.solved(&self.without_effort()?, 0)?;
            let errors: Vec<f64> = solved.levels.iter().map(|level| level.length).collect();
            let levels = other.levels.iter().map(|level| level.length);
            if other.balance == Balance::Held && first_difference(levels, &errors) < 0.0 {
                solved = other;
            }
        }
        let mut posture = solved.posture;
        // A body whose weight acts at the very edge of its supports may be off balance by rounding.
        if let Some(missing) = self.recover_balance(&mut posture)? {
            let stands = self.standing(&posture);
            self.forget();
            return stands.ok_or(ScenarioError::CannotStand(missing));
        }
        // A task that is missed may need legs that stand in another way: with all joints free a search takes longer.
        let work = SEARCH_BUDGET_OF_STEP * if missed { 2 } else { 1 };
        let budget = Budget { scattered: SCATTERED_AT_THE_START, work, carriers_stay: !missed };
        let Searched { found, minima, work, cut } = self.easiest(&posture, &[], budget)?;
        let (mut found, steps) = self.settled(found.unwrap_or_else(|| posture.clone()))?;
        // A search that ends at its budget may end in a posture that supports do not hold to the last digit.
        if self.recover_balance(&mut found)?.is_some() {
            found = posture;
        }
        self.forget();
        Ok(Searched { found, minima, work: work + steps, cut })
    }

    /// The local minimum of effort near a posture, all joints free, where that is worth a motion, else the posture itself; and the number of steps.
    /// The search leaves the joints that move a support as they were; with another trunk and other arms another angle of them is easiest.
    fn settled(&mut self, posture: Posture) -> Result<(Posture, usize), ScenarioError> {
        if !self.engine.levels().iter().any(is_effort) {
            return Ok((posture, 0));
        }
        self.engine.evaluate(&posture)?;
        let settled = self.solved(&posture, 1)?;
        let better =
            settled.balance == Balance::Held && is_better(&settled, self.effort(), &self.errors_above_effort());
        Ok((if better { settled.posture } else { posture }, settled.steps))
    }

    /// Solves all levels from a posture, on the supports as the start has them, and compares so many local minima of effort. The engine is dropped
    /// afterwards: with many tasks engines are large.
    fn solved(&self, from: &Posture, local_minima: usize) -> Result<SolvedPosture, ScenarioError> {
        let options = Options { max_step: START_MAX_STEP, local_minima, ..Options::least_effort() };
        let (levels, start) = (self.levels().cloned().collect(), &self.scenario.start);
        let supports = (&self.supports[..], &self.limits[..]);
        Ok(engine((self.scenario, self.model.clone()), start, supports, levels, options)?.solve(from)?)
    }

    /// The posture of least effort in which the supports hold the body, of those that a search with all joints free finds from `fallen`; `None`
    /// where it finds none.
    fn standing(&mut self, fallen: &Posture) -> Option<Searched<Posture>> {
        let levels: Vec<PriorityLevel> = self.levels().cloned().collect();
        let now = Now {
            model: &self.model,
            posture: fallen,
            levels: &levels,
            loads: self.engine.loads(),
            effort: f64::INFINITY,
            aim: Aim::Least(&[]),
        };
        let locked: Vec<usize> = self.scenario.locked_rates().collect();
        // An eighth of the usual work (assumed): a scenario that cannot stand is answered within a second.
        let work = SEARCH_BUDGET_OF_STEP / 8;
        let budget = Budget { scattered: SCATTERED_AT_THE_START, work, carriers_stay: false };
        let Searched { found, minima, work, cut } =
            search(self.scenario, now, (&self.supports, &self.limits), &locked, budget).ok()?;
        let stands = found.into_iter().find(|found| found.relaxed.slip.length() <= MOST_SLIP)?;
        Some(Searched { found: stands.relaxed.posture, minima, work, cut })
    }

    /// Errors of the levels above effort that ask for something, in the posture of the last update.
    fn errors_above_effort(&self) -> Vec<f64> {
        let levels = self.engine.levels().iter().enumerate().take_while(|(_, level)| !is_effort(level));
        levels.filter(|(_, level)| level.asks()).map(|(i, _)| self.engine.error(i)).collect()
    }

    /// Errors of the tasks above effort and above limbs that hang, the reliefs left out, where one of them is so great that a posture nearer to
    /// it is worth a motion. These levels stay the same when a rest is put down or taken off.
    pub(super) fn missed(&self) -> Option<Vec<f64>> {
        let hangs = |goal: &PriorityLevel| goal.tasks.iter().any(|task| task.hangs(&self.model));
        let hanging = self.levels_of_goals().filter(|(goal, _)| hangs(goal)).map(|(_, level)| level).min();
        let levels = self.engine.levels().iter().enumerate().take_while(|(_, level)| !is_effort(level));
        let above = levels.take_while(|(i, _)| hanging.is_none_or(|hanging| *i < hanging));
        let tasks = above.filter(|(_, level)| level.asks() && level.half_spaces.is_empty());
        let errors: Vec<f64> = tasks.map(|(i, _)| self.engine.error(i)).collect();
        errors.iter().any(|error| *error > WORTH_NEARING).then_some(errors)
    }

    /// Whether a solve of all levels leaves one above effort unreached.
    fn misses(&self, solved: &SolvedPosture) -> bool {
        let above = self.levels().take_while(|level| !is_effort(level)).count();
        solved.levels[..above].iter().any(|level| level.length > UNREACHED)
    }

    /// The posture nearest to the tasks above effort, by the step rule of strict priorities, whether the supports hold the body in it or not.
    fn without_effort(&self) -> Result<Posture, ScenarioError> {
        let scenario = self.scenario;
        let mut at_start = Kinematics::new(&self.model);
        at_start.update(&self.model, &scenario.start).map_err(JointTorquesError::from)?;
        let places = self.supports.iter().map(|support| held_place(support, &self.model, &at_start)).collect();
        let level = |tasks: Vec<Task>, hard: bool| PriorityLevel { tasks, hard, ..PriorityLevel::default() };
        let fixed = [level(places, true), level(self.limits.clone(), false)];
        let tasks = self.levels().take_while(|level| !is_effort(level)).cloned();
        let levels = fixed.into_iter().filter(|level| !level.tasks.is_empty()).chain(tasks).collect();
        let options = Options::inverse_kinematics();
        let mut engine = Engine::new(self.model.clone(), levels, &scenario.loads, options)?;
        scenario.locked_rates().for_each(|rate| engine.lock(rate));
        Ok(engine.solve(&scenario.start)?.posture)
    }

    /// A posture of less effort that the body can take without moving a support, if `budget` shows one worth a motion; `known` are local
    /// minima of earlier searches.
    pub(super) fn easiest(
        &mut self,
        posture: &Posture,
        known: &[Posture],
        budget: Budget,
    ) -> Result<Searched<Option<Posture>>, ScenarioError> {
        if !self.engine.levels().iter().any(is_effort) {
            return Ok(Searched::default());
        }
        self.engine.evaluate(posture)?;
        let effort = self.effort();
        let levels: Vec<PriorityLevel> = self.levels().cloned().collect();
        let errors = self.errors_above_effort();
        let loads = self.engine.loads();
        let now = Now { model: &self.model, posture, levels: &levels, loads, effort, aim: Aim::Least(known) };
        // A search that finds nothing leaves the body as it is.
        Ok(easiest(self.scenario, now, &errors, (&self.supports, &self.limits), budget).unwrap_or_default())
    }

    /// The way to `to`, with a change of a support, if any; `None` where there is none, where a law gives no numbers on it, or where
    /// `budget` of work, which becomes less, shows none.
    pub(super) fn way(&self, from: &Posture, to: &Posture, change: Option<Offer>, budget: &mut usize) -> Option<Path> {
        let (numbers, supports) = self.with_change(change);
        // On its way to a rest, and back, a limb does not hang.
        let levels = if change.is_some() { self.levels_with(&numbers) } else { self.levels().cloned().collect() };
        // A step may leave what reliefs ask for at the old place.
        let for_a_task = change.is_some_and(|offer| offer.for_a_task);
        let keeps = |level: &PriorityLevel| change.is_none() || !for_a_task && level.half_spaces.is_empty();
        let load_now = greatest_load(&self.model, self.torques());
        let levels: Vec<PriorityLevel> =
            levels.into_iter().take_while(|level| !is_effort(level)).filter(keeps).collect();
        let planner = Planner {
            scenario: self.scenario,
            model: &self.model,
            supports: &supports,
            numbers: &numbers,
            limits: &self.scenario.limits_with(&numbers),
            levels: &levels,
            loads: self.engine.loads(),
            most_load: if for_a_task { load_now.max(1.0) } else { 1.0 },
            left: Cell::new(*budget),
        };
        let planned = match change {
            Some(offer) => planner.step(from, to, offer),
            None => planner.way(from, to),
        };
        *budget = planner.left.get();
        planned.ok().flatten()
    }

    /// Numbers and supports in use, and the one that is put down.
    pub(super) fn with_change(&self, change: Option<Offer>) -> (Vec<usize>, Vec<Support>) {
        let (mut numbers, mut supports) = (self.in_use.clone(), self.supports.clone());
        if let Some(Offer { number, kind: StepKind::PutDown, .. }) = change {
            let place = numbers.partition_point(|known| *known < number);
            numbers.insert(place, number);
            let support = Support { place: Place::Fixed, ..self.scenario.supports[number].clone() };
            supports.insert(place, support);
        }
        (numbers, supports)
    }

    /// The number of the support that is in the air from now on.
    pub(super) fn lift(&mut self, support: Option<usize>) -> Result<(), ScenarioError> {
        let Some(lifted) = support.filter(|lifted| self.in_use.contains(lifted)) else {
            self.lifted = None;
            return Ok(());
        };
        if self.lifted.as_ref().is_none_or(|(known, _)| *known != lifted) {
            let others = self.in_use.iter().zip(&self.supports).filter(|(number, _)| **number != lifted);
            let others: Vec<Support> = others.map(|(_, support)| support.clone()).collect();
            let levels = self.engine.levels().to_vec();
            let options = Options::least_effort();
            let mut engine =
                engine((self.scenario, self.model.clone()), &self.placed_at, (&others, &self.limits), levels, options)?;
            engine.set_loads(self.engine.loads())?;
            self.lifted = Some((lifted, engine));
        }
        Ok(())
    }

    /// Stands on the supports `in_use` as they are in `posture`: one has been put elsewhere, put down or taken off.
    pub(super) fn place_again(&mut self, posture: &Posture, in_use: &[usize]) -> Result<(), ScenarioError> {
        let (goals, loads) = (std::mem::take(&mut self.goals), self.engine.loads().to_vec());
        *self = Self::new(self.scenario, self.model.clone(), posture, in_use)?;
        goals.iter().enumerate().for_each(|(task, goal)| self.set_task(task, goal));
        Ok(self.engine.set_loads(&loads)?)
    }
}
