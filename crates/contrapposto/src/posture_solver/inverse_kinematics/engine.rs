//! One step toward the goals, and steps until nothing moves.

use super::curvature::Curvature;
use crate::contact::Balance;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::model::Model;
use crate::posture::Posture;
use crate::posture_solver::{EngineError, LevelError, Options, Reason, SolvedPosture, Step};
use crate::statics::Load;
use crate::tasks::PriorityLevel;
use hierarchical_least_squares::{Level, Multipliers, Problem, Solver};

/// Brings a body toward goals. Nothing is allocated after the first step.
#[derive(Clone, Debug)]
pub struct Engine<'a> {
    model: &'a Model,
    goals: Vec<PriorityLevel>,
    loads: Vec<Load>,
    options: Options,
    needs: Quantities,
    /// Rates that do not move.
    locked: Vec<bool>,
    body: JointTorques,
    problem: Problem,
    solver: Solver,
    restorer: Solver,
    /// Length of the error of each level at the last posture, and at the one before.
    errors: Vec<f64>,
    before: Vec<f64>,
    /// Both, set aside for a while.
    kept: Vec<f64>,
    kept_before: Vec<f64>,
    /// Steps that brought a level no nearer, in a row.
    stalls: Vec<usize>,
    curvature: Curvature,
    /// The level whose second derivative is used.
    bent: Option<usize>,
    /// Levels below a bent one wait for it.
    waiting: bool,
    /// Largest change that is allowed now.
    reach: f64,
    /// Largest change that is ever allowed; falls toward the end of [`Engine::solve`].
    ceiling: f64,
    /// The posture before the last step.
    last: Posture,
    /// Largest change of the last step and of the one before.
    largest: [f64; 2],
    row: Vec<f64>,
}

impl<'a> Engine<'a> {
    /// Checks the goals, the most important first. Coordinates that are locked or follow others do not move on their own.
    ///
    /// # Errors
    /// [`EngineError`] names the first thing that does not fit the model.
    pub fn new(
        model: &'a Model,
        goals: Vec<PriorityLevel>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, EngineError> {
        for (what, value) in [
            ("max_step (rad, m)", options.max_step),
            ("step_tolerance (rad, m)", options.step_tolerance),
            ("level_tolerance", options.level_tolerance),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(EngineError::Option { what, value, accepted: "greater than 0 and finite" });
            }
        }
        let mut needs = Quantities::default();
        for (level, goal) in goals.iter().enumerate() {
            for task in &goal.tasks {
                task.check(model).map_err(|error| EngineError::Task { level, error })?;
                needs = needs.with(task.quantities());
            }
            for space in &goal.half_spaces {
                check_half_space(model, space).map_err(|problem| EngineError::HalfSpace { level, problem })?;
            }
        }
        for load in loads {
            load.check(model).map_err(JointTorquesError::from)?;
        }
        let locked = model
            .rates()
            .iter()
            .map(|rate| rate.coordinate.is_some_and(|c| model.coordinates()[c].locked || model.is_dependent(c)));
        let mut problem = Problem::new(model.rates().len());
        // Second derivatives and staying where it is give a level a row for every rate.
        let n = model.rates().len();
        let room = |rows: usize| rows.max(n) + 3;
        problem.levels.extend(goals.iter().map(|goal| Level::with_capacity(room(goal.rows()), n)));
        let most = goals.iter().map(PriorityLevel::rows).max().map_or(n, room);
        let all = goals.iter().map(|goal| room(goal.rows())).sum();
        let solver = || Solver::with_capacity(n, goals.len(), most, all);
        Ok(Self {
            model,
            locked: locked.collect(),
            loads: loads.to_vec(),
            options,
            needs,
            body: JointTorques::new(model),
            problem,
            solver: solver(),
            restorer: solver(),
            errors: vec![f64::INFINITY; goals.len()],
            before: vec![f64::INFINITY; goals.len()],
            kept: vec![0.0; goals.len()],
            kept_before: vec![0.0; goals.len()],
            stalls: vec![0; goals.len()],
            curvature: Curvature::new(model, &goals),
            bent: None,
            waiting: true,
            reach: options.max_step,
            ceiling: options.max_step,
            last: model.default_posture(),

            largest: [f64::INFINITY; 2],
            row: vec![0.0; model.rates().len()],
            goals,
        })
    }

    /// Rates that do not move, besides those of locked coordinates.
    pub fn lock(&mut self, rate: usize) {
        self.locked[rate] = true;
    }

    /// The goals, to move targets between steps. What is changed must still fit the model.
    pub fn levels_mut(&mut self) -> &mut [PriorityLevel] {
        &mut self.goals
    }

    /// The body at the posture of the last step's start.
    pub fn body(&self) -> &JointTorques {
        &self.body
    }

    /// What the last step's levels cost each other and gain from ranges and largest steps; see [`Multipliers`].
    pub fn multipliers(&self, level: usize) -> Multipliers<'_> {
        self.solver.multipliers(level)
    }

    /// Length of the error of each level at the posture where the last step began.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// One step: moves `posture` by what the goals ask for, within ranges and `max_step`.
    ///
    /// # Errors
    /// [`EngineError`] when the posture does not fit the model; it is not moved then.
    pub fn step(&mut self, posture: &mut Posture) -> Result<Step, EngineError> {
        self.linearise(posture)?;
        let rejected_previous = self.went_wrong();
        if rejected_previous {
            posture.values_mut().copy_from_slice(self.last.values());
            self.linearise(posture)?;
        }
        self.choose_bent();
        self.damp();
        if let Some(k) = self.bent {
            self.curvature.bend(self.model, &self.goals, &self.body, &mut self.problem, &self.solver, k);
        }
        self.hold_levels_below();
        self.last.values_mut().copy_from_slice(posture.values());
        let status = self.solver.solve_next(&self.problem)?;
        posture.displace(self.model, self.solver.solution());
        self.keep_ranges(posture);
        let largest = self.solver.solution().iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        if let Some(k) = self.bent {
            self.restore(posture, k)?;
        }
        self.largest = [largest, self.largest[0]];
        Ok(Step { largest, rejected_previous, status, changes: self.solver.changes() })
    }

    /// Forgets what earlier steps have shown: the next one starts afresh.
    pub fn restart(&mut self) {
        self.errors.fill(f64::INFINITY);
        self.bent = None;
        self.waiting = true;
        self.stalls.fill(0);
        self.restorer.forget();
        self.reach = self.options.max_step;
        self.ceiling = self.options.max_step;
        self.largest = [f64::INFINITY; 2];
        self.solver.forget();
    }

    /// Steps until nothing moves. After a third of the largest number of steps the largest step shrinks, so that the body
    /// comes to rest whatever it is asked.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn solve(&mut self, start: &Posture) -> Result<SolvedPosture, EngineError> {
        self.solve_watched(start, |_, _| {})
    }

    /// As [`Engine::solve`]; `watch` sees every step and the posture after it.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn solve_watched(
        &mut self,
        start: &Posture,
        mut watch: impl FnMut(&Step, &Posture),
    ) -> Result<SolvedPosture, EngineError> {
        let mut posture = start.clone();
        self.restart();
        let most = self.options.max_steps;
        let warm = most / 3;
        let cooling =
            (0.1 * self.options.step_tolerance / self.options.max_step).powf(1.0 / (most - warm).max(1) as f64);
        let mut steps = 0;
        let mut still = false;
        while steps < most && !still {
            let step = self.step(&mut posture)?;
            watch(&step, &posture);
            steps += 1;
            still = step.largest <= self.options.step_tolerance;
            if steps > warm {
                self.ceiling *= cooling;
            }
        }
        let levels = self.report(&posture)?;
        let reached = levels.iter().all(|level| level.length <= self.options.level_tolerance);
        let reason = if reached {
            Reason::Reached
        } else if still {
            Reason::Converged
        } else {
            Reason::StepLimit
        };
        Ok(SolvedPosture { posture, levels, effort: 0.0, slip: 0.0, balance: Balance::Held, reason, steps })
    }

    /// What is left of each level at a posture.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn report(&mut self, posture: &Posture) -> Result<Vec<LevelError>, EngineError> {
        self.body.update(self.model, posture, &self.loads, self.needs)?;
        Ok(self.goals.iter().map(|level| LevelError::of(level, self.model, &self.body)).collect())
    }

    /// Rows of all levels and bounds of the step, at a posture.
    fn linearise(&mut self, posture: &Posture) -> Result<(), EngineError> {
        self.body.update(self.model, posture, &self.loads, self.needs)?;
        self.before.copy_from_slice(&self.errors);
        for (k, goal) in self.goals.iter().enumerate() {
            let level = &mut self.problem.levels[k];
            level.clear();
            level.hard = goal.hard;
            for task in &goal.tasks {
                task.evaluate(self.model, &self.body, level);
            }
            for space in &goal.half_spaces {
                for (rate, entry) in self.model.rates().iter().zip(&mut self.row) {
                    *entry = rate.coordinate.map_or(0.0, |c| space.normal[c]);
                }
                level.push(&self.row, f64::NEG_INFINITY, -space.violation(posture.values()));
            }
            let missing = level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
            self.errors[k] = missing.map(|m| m * m).sum::<f64>().sqrt();
        }
        let most = self.reach.min(self.ceiling);
        let Problem { lower, upper, .. } = &mut self.problem;
        bound_rates(self.model, &self.locked, posture, most, lower, upper);
        Ok(())
    }

    /// Did the last step of a bent level make things worse? Then it is taken back, and the next is shorter. Things are the
    /// level's error and, with a price above their multipliers, the errors above it.
    fn went_wrong(&mut self) -> bool {
        let Some(k) = self.bent else { return false };
        let price = |rows: &[f64], error: f64| {
            1.0 + 2.0 * rows.iter().fold(0.0, |most: f64, m| most.max(m.abs())) / error.max(1e-6)
        };
        let price = price(self.solver.multipliers(k).rows, self.before[k]);
        let merit = |errors: &[f64]| errors[k] + price * errors[..k].iter().sum::<f64>();
        let (now, then) = (merit(&self.errors), merit(&self.before));
        let wrong = now > then + 1e-12 && self.largest[0] > 1e-7;
        self.reach = if wrong { 0.25 * self.largest[0] } else { (2.0 * self.reach).min(self.options.max_step) };
        wrong
    }

    /// The first level that no longer comes nearer though all above it do is bent; or the last one, when steps no longer
    /// shrink. One at a time: the rows of a bent level have no second derivative of their own.
    fn choose_bent(&mut self) {
        let last = self.goals.len().saturating_sub(1);
        if let Some(k) = self.bent {
            if self.errors[k] <= self.options.level_tolerance {
                self.bent = None;
            }
            return;
        }
        let mut above = 0.0;
        for k in 0..last {
            let error = self.errors[k];
            let stalls =
                above < 0.05 && error > 0.8 * self.before[k] && self.solver.residual_norm(k) > 0.5 * self.before[k];
            self.stalls[k] = if stalls && error > self.options.level_tolerance { self.stalls[k] + 1 } else { 0 };
            if self.stalls[k] >= STALLS {
                self.bent = Some(k);
                return;
            }
            above += error;
        }
        // Long swings keep the levels above from being met: those are waited for a little longer.
        let swings = above < 0.05 && self.largest[0] > 0.5 * self.largest[1] && !self.goals.is_empty();
        self.stalls[last] = if swings { self.stalls[last] + 1 } else { 0 };
        if self.stalls[last] >= if above < 1e-3 { STALLS / 2 } else { STALLS } {
            self.bent = Some(last);
        }
    }

    /// A long step of a bent level leaves errors above it that grow with its square: takes them back with the least motion.
    fn restore(&mut self, posture: &mut Posture, k: usize) -> Result<(), EngineError> {
        if k == 0 {
            return Ok(());
        }
        self.kept.copy_from_slice(&self.errors);
        self.kept_before.copy_from_slice(&self.before);
        let reach = std::mem::replace(&mut self.reach, self.options.max_step);
        self.linearise(posture)?;
        self.reach = reach;
        self.problem.levels[k..].iter_mut().for_each(Level::clear);
        self.stay();
        self.restorer.solve_next(&self.problem)?;
        posture.displace(self.model, self.restorer.solution());
        self.keep_ranges(posture);
        self.errors.copy_from_slice(&self.kept);
        self.before.copy_from_slice(&self.kept_before);
        Ok(())
    }

    /// The last level only asks the body to move little.
    fn stay(&mut self) {
        if let Some(last) = self.problem.levels.last_mut() {
            last.clear();
            for i in 0..self.row.len() {
                self.row.fill(0.0);
                self.row[i] = 1.0;
                last.push(&self.row, 0.0, 0.0);
            }
        }
    }

    /// While a bent level is still on its way, the levels below it only ask the body to move little.
    fn hold_levels_below(&mut self) {
        let Some(k) = self.bent else { return };
        self.waiting = self.largest[0] > if self.waiting { SETTLED } else { 100.0 * SETTLED };
        if !self.waiting || k + 1 >= self.goals.len() {
            return;
        }
        self.problem.levels[k + 1..].iter_mut().for_each(Level::clear);
        self.stay();
    }

    /// Levels are damped by what is still missing at them and above: far from the goal a row says little about where to go.
    /// The last level is not: nothing below it could suffer.
    fn damp(&mut self) {
        let mut missing = 0.0;
        let last = self.goals.len().saturating_sub(1);
        for (k, level) in self.problem.levels.iter_mut().enumerate() {
            missing += if self.bent == Some(k) { 0.0 } else { self.errors[k] };
            level.damping =
                if k == last || self.bent == Some(k) || self.goals[k].hard { 0.0 } else { DAMPING * missing.min(MOST) };
        }
    }

    /// Rounding must not carry a coordinate out of its range.
    fn keep_ranges(&self, posture: &mut Posture) {
        for (i, rate) in self.model.rates().iter().enumerate() {
            if let (Some(c), false) = (rate.coordinate, self.locked[i]) {
                let (lower, upper) = self.model.coordinates()[c].range;
                let bound = &mut posture.values_mut()[c];
                if (*bound > upper && self.problem.upper[i] + 1e-9 >= 0.0) || *bound < lower {
                    let near = bound.clamp(lower, upper);
                    if (*bound - near).abs() < 1e-9 {
                        *bound = near;
                    }
                }
            }
        }
    }
}

/// So many steps in a row that hardly bring a level nearer show that its goal is out of reach.
const STALLS: usize = 6;
/// A bent level has settled when no rate changes by more, rad or m.
const SETTLED: f64 = 1e-4;
/// Damping for an error of 1.
const DAMPING: f64 = 2.0;
/// Largest error that damping knows of.
const MOST: f64 = 1.0;

/// Bounds of every rate in one step: its range, and `most` at most. What is `locked` does not move; a posture outside its range
/// comes back with a step.
pub(crate) fn bound_rates(
    model: &Model,
    locked: &[bool],
    posture: &Posture,
    most: f64,
    lower: &mut [f64],
    upper: &mut [f64],
) {
    for (i, rate) in model.rates().iter().enumerate() {
        let (least, greatest) = match rate.coordinate {
            _ if locked[i] => (0.0, 0.0),
            Some(c) => {
                let (lower, upper) = model.coordinates()[c].range;
                let value = posture.values()[c];
                ((lower - value).clamp(-most, most), (upper - value).clamp(-most, most))
            }
            None => (-most, most),
        };
        (lower[i], upper[i]) = (least.min(greatest), greatest);
    }
}

fn check_half_space(model: &Model, space: &crate::constraint::HalfSpace) -> Result<(), String> {
    let (given, needed) = (space.normal.len(), model.coordinates().len());
    if given != needed {
        return Err(format!("has {given} entries; the model has {needed} coordinates"));
    }
    let finite = |v: &f64| v.abs() <= crate::model::LARGEST;
    if !(space.normal.iter().all(finite) && finite(&space.offset)) {
        return Err("has a number that is not finite, or beyond 1e9".to_owned());
    }
    let moves = |c: usize| model.coordinates()[c].rate.is_some();
    match (0..needed).find(|&c| space.normal[c] != 0.0 && !moves(c)) {
        Some(c) => Err(format!("is on `{}`, which is no angle or distance", model.coordinates()[c].name)),
        None => Ok(()),
    }
}
