//! One step of posture and contact forces, and steps until effort falls no more.
//!
//! Effort is a sum of squares under constraints that bend, so this is a Gauss-Newton method within a largest step. A step
//! counts if it lowers `|e|^2/2 + price sum |errors of the levels above|`, the price above every multiplier; else it is taken
//! back and the largest step shrinks (Nocedal & Wright 2006, "Numerical Optimization", ch. 18).

use nalgebra::Vector3;

use super::curvature::Curvature;
use super::probe::Probe;
use super::site::Ask;
use super::valleys::Valleys;
use crate::contact::{Balance, ContactForces, Support, SupportError, Unknowns, bounds, friction_rows, share_row};
use crate::ik::body::{Body, BodyError, Needs};
use crate::ik::task::{Effort, Placement, Task, TaskError, share_of_strength};
use crate::ik::{Goal, GoalError};
use crate::kinematics::Kinematics;
use crate::math::lexicographic::{Level, Problem, ProblemError, Solver, Status};
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Load, PassiveTorque};

/// How far a step may go, and when steps end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest change of any rate in one step, rad or m.
    pub max_step: f64,
    /// Largest number of steps of [`Engine::solve`].
    pub max_steps: usize,
    /// Steps end when no rate would change by more than this, rad or m.
    pub still: f64,
    /// Steps end when several in a row lower the merit by less than this share of it.
    pub gain: f64,
    /// Steps that made things worse are taken back; without it every step counts, and the next one is shorter.
    pub guarded: bool,
    /// Valleys of effort that [`Engine::solve`] looks into before its steps: 1 for the nearest one, more for others beside it; 0
    /// for steps alone, which stay nearest to the start.
    pub valleys: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_step: 0.3, max_steps: 200, still: 1e-9, gain: 1e-9, guarded: true, valleys: 12 }
    }
}

/// Why a body, its supports or its goals were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RelaxError {
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A goal does not fit the model.
    #[error(transparent)]
    Goal(#[from] GoalError),
    /// The posture or a load does not fit the model.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// Numbers so large that the rows of a task are not finite.
    #[error("the goals have no finite rows in this posture: {0}")]
    Rows(#[from] ProblemError),
}

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Largest change of any rate, rad or m.
    pub largest: f64,
    /// The step before this one made things worse and was taken back.
    pub taken_back: bool,
    /// What the solver says of the linearised problem.
    pub status: Status,
}

/// Why [`Engine::solve`] ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Nothing moves any more, or nothing is gained.
    Settled,
    /// The largest number of steps was made.
    Steps,
}

/// Where [`Engine::solve`] came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed {
    /// All coordinates.
    pub posture: Posture,
    /// Sum of squares of the effort level, 0 without one.
    pub effort: f64,
    /// Length of the error of each goal, in its units.
    pub errors: Vec<f64>,
    /// How far supports are off their places: lengths of the errors in m and rad together.
    pub slip: f64,
    /// Is the root in equilibrium?
    pub balance: Balance,
    /// Why it ended there.
    pub reason: Reason,
    /// Steps made.
    pub steps: usize,
}

/// Largest error of a level above effort that one step takes on, in its units: on the way to a far goal the body stays where
/// effort is little, and so comes into the valleys that lead on.
const PACE: f64 = 0.15;

/// Levels before the goals: contact and equilibrium, supports, shares.
const BEFORE: usize = 3;

/// Brings a body on its supports toward goals, least effort among them.
#[derive(Clone, Debug)]
pub struct Engine<'a> {
    model: &'a Model,
    goals: Vec<Goal>,
    places: Goal,
    loads: Vec<Load>,
    options: Options,
    locked: Vec<bool>,
    body: Body,
    kinematics: Kinematics,
    external: ExternalTorque,
    passive: PassiveTorque,
    contact: ContactForces,
    /// Loads of the scenario, then contact forces.
    all_loads: Vec<Load>,
    /// What was computed belongs to the posture in `body`.
    seen: bool,
    probe: Probe,
    problem: Problem,
    solver: Solver,
    /// Rows over the rates only.
    narrow: Level,
    row: Vec<f64>,
    /// Sum of sizes of the errors of each level of the problem, now and before the last step.
    errors: [Vec<f64>; 2],
    /// Half the sum of squares of the effort level, likewise.
    effort: [f64; 2],
    /// Place of the effort level among the goals.
    effort_goal: Option<usize>,
    price: f64,
    /// Of the rows above the effort level, from the last step, and where those of each level begin.
    multipliers: Vec<f64>,
    starts: Vec<usize>,
    /// What the last step left of each level.
    unreached: Vec<f64>,
    curvature: Curvature,
    valleys: Valleys,
    /// Rates that move.
    free: Vec<usize>,
    reach: f64,
    last: Posture,
    largest: f64,
}

impl<'a> Engine<'a> {
    /// Checks supports and goals, the most important first. Supports stay where they are in `start`.
    ///
    /// # Errors
    /// [`RelaxError`] names the first thing that does not fit the model.
    pub fn new(
        model: &'a Model,
        start: &Posture,
        supports: Vec<Support>,
        goals: Vec<Goal>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, RelaxError> {
        let mut needs = Needs { torque: true, center_of_mass: true };
        let fits =
            |level: usize, task: &Task| task.check(model).map_err(|error: TaskError| GoalError::Task { level, error });
        for (level, goal) in goals.iter().enumerate() {
            for task in &goal.tasks {
                fits(level, task)?;
                needs = needs.with(task.needs());
            }
        }
        for load in loads {
            load.check(model).map_err(BodyError::from)?;
        }
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, start).map_err(BodyError::from)?;
        let mut places = Goal::default();
        for support in &supports {
            support.check(model)?;
            if !places.tasks.iter().any(|task| matches!(task, Task::Placement(p) if p.segment == support.segment)) {
                let target = kinematics.placement(model, support.segment);
                let point = Vector3::zeros();
                places.tasks.push(Task::Placement(Placement { segment: support.segment, point, target }));
            }
        }
        let contact = ContactForces::new(model, supports)?;
        let rates = model.rates().len();
        let unknowns = rates + contact.forces().len();
        let mut problem = Problem::new(unknowns);
        problem.levels.resize(BEFORE + goals.len(), Level::default());
        let all_loads = loads.iter().chain(contact.loads()).copied().collect();
        let locked = model
            .rates()
            .iter()
            .map(|rate| rate.coordinate.is_some_and(|c| model.coordinates()[c].locked || model.is_dependent(c)));
        let effort_goal = goals.iter().position(|goal| goal.tasks.iter().any(|task| matches!(task, Task::Effort(_))));
        let errors = vec![f64::INFINITY; problem.levels.len()];
        Ok(Self {
            model,
            places,
            loads: loads.to_vec(),
            options,
            locked: locked.collect(),
            body: Body::new(model),
            kinematics,
            external: ExternalTorque::new(model),
            passive: PassiveTorque::new(model),
            all_loads,
            seen: false,
            probe: Probe::new(model, &contact),
            contact,
            problem,
            solver: Solver::new(),
            narrow: Level::default(),
            row: vec![0.0; unknowns],
            errors: [errors.clone(), errors],
            effort: [f64::INFINITY; 2],
            effort_goal,
            price: 0.0,
            multipliers: vec![],
            starts: vec![],
            unreached: vec![],
            curvature: Curvature::new(model, unknowns),
            valleys: Valleys::new(model),
            free: vec![],
            reach: options.max_step,
            last: start.clone(),
            largest: f64::INFINITY,
            goals,
        })
    }

    /// Rates that do not move, besides those of locked coordinates.
    pub fn lock(&mut self, rate: usize) {
        self.locked[rate] = true;
    }

    /// The goals, to move targets between steps. What is changed must still fit the model; effort must stay where it is.
    pub fn goals_mut(&mut self) -> &mut [Goal] {
        &mut self.goals
    }

    /// Other loads from now on.
    ///
    /// # Errors
    /// [`BodyError::Load`] for a load that does not fit the model; nothing is changed then.
    pub fn set_loads(&mut self, loads: &[Load]) -> Result<(), RelaxError> {
        loads.iter().try_for_each(|load| load.check(self.model)).map_err(BodyError::from)?;
        self.loads = loads.to_vec();
        self.all_loads = loads.iter().chain(self.contact.loads()).copied().collect();
        self.seen = false;
        Ok(())
    }

    /// Passive torque of every rate in the posture that was looked at last, followers folded in, N m.
    pub fn passive(&self) -> &[f64] {
        self.passive.torques()
    }

    /// The contact forces of the posture where the last step began, or of the last report.
    pub fn contact(&self) -> &ContactForces {
        &self.contact
    }

    /// The body in that posture; its external torque includes contact forces.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// One step: moves `posture` by what the goals ask for.
    ///
    /// # Errors
    /// [`RelaxError`] when the posture does not fit the model; it is not moved then.
    pub fn step(&mut self, posture: &mut Posture) -> Result<Step, RelaxError> {
        self.see(posture)?;
        self.build();
        let taken_back = self.went_wrong();
        if taken_back {
            posture.values_mut().copy_from_slice(self.last.values());
            self.see(posture)?;
            self.build();
        }
        self.bound(posture);
        self.pace();
        self.bend();
        self.last.values_mut().copy_from_slice(posture.values());
        let status = self.solver.solve_next(&self.problem)?;
        let rates = self.model.rates().len();
        let step = &self.solver.solution()[..rates];
        self.largest = step.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        posture.displace(self.model, step);
        self.keep_ranges(posture);
        self.raise_price();
        self.unreached.clear();
        self.unreached.extend((0..self.problem.levels.len()).map(|k| self.solver.residual_norm(k)));
        Ok(Step { largest: self.largest, taken_back, status })
    }

    /// Lets the next step be as long as ever: something new is asked.
    pub fn hurry(&mut self) {
        self.reach = self.options.max_step;
        self.errors[0].fill(f64::INFINITY);
    }

    /// Forgets what earlier steps have shown.
    pub fn restart(&mut self) {
        self.errors.iter_mut().for_each(|errors| errors.fill(f64::INFINITY));
        self.effort = [f64::INFINITY; 2];
        self.price = 0.0;
        self.multipliers.clear();
        self.unreached.clear();
        self.reach = self.options.max_step;
        *self.curvature.shift() = 0.0;
        self.seen = false;
        self.solver.forget();
        self.contact.forget();
        self.probe.forget();
    }

    /// Steps until nothing moves or nothing is gained.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn solve(&mut self, start: &Posture) -> Result<Relaxed, RelaxError> {
        self.restart();
        let mut posture = start.clone();
        let (settled, mut steps) = self.look_into_valleys(&mut posture)?;
        let mut idle = if settled { 3 } else { 0 };
        let most = steps + self.options.max_steps;
        while steps < most && idle < 3 {
            let step = self.step(&mut posture)?;
            steps += 1;
            let gained = self.merit(1) - self.merit(0);
            let little = gained.abs() <= self.options.gain * self.merit(0) && step.largest < 0.9 * self.reach;
            idle = if step.largest <= self.options.still {
                3
            } else if little && !step.taken_back {
                idle + 1
            } else {
                0
            };
        }
        self.see(&posture)?;
        self.build();
        if self.went_wrong() {
            posture.values_mut().copy_from_slice(self.last.values());
            self.see(&posture)?;
            self.build();
        }
        let reason = if steps < most { Reason::Settled } else { Reason::Steps };
        Ok(Relaxed {
            effort: 2.0 * self.effort[0],
            errors: (0..self.goals.len()).map(|goal| self.error(goal)).collect(),
            slip: self.slip(),
            balance: self.contact.balance(),
            reason,
            steps,
            posture,
        })
    }

    /// Moves to the lowest bottom of the valleys; is that the answer, and after how many steps?
    fn look_into_valleys(&mut self, posture: &mut Posture) -> Result<(bool, usize), RelaxError> {
        let Some(goal) = self.effort_goal.filter(|_| self.options.valleys > 0) else { return Ok((false, 0)) };
        self.free.clear();
        self.free.extend((0..self.locked.len()).filter(|rate| !self.locked[*rate]));
        let effort = &self.goals[goal];
        let alone = effort.half_spaces.is_empty() && effort.tasks.iter().all(|task| matches!(task, Task::Effort(_)));
        if self.free.is_empty() || !alone {
            return Ok((false, 0));
        }
        self.see(posture)?;
        let effort = &self.goals[goal];
        let ask = Ask {
            model: self.model,
            places: &self.places,
            above: &self.goals[..goal],
            effort,
            loads: &self.loads,
            free: &self.free,
            contact: &self.contact,
        };
        let Some(bottom) = self.valleys.find(&ask, posture, self.options.valleys)? else { return Ok((false, 0)) };
        self.see(posture)?;
        let held = self.contact.balance() == Balance::Held;
        Ok((bottom.settled && held && goal + 1 == self.goals.len(), bottom.steps))
    }

    /// Computes everything that depends on the posture, contact forces included.
    ///
    /// # Errors
    /// [`RelaxError::Body`] when the posture does not fit the model.
    pub fn see(&mut self, posture: &Posture) -> Result<(), RelaxError> {
        if self.seen && self.body.posture() == posture {
            return Ok(());
        }
        self.seen = false;
        self.kinematics.update(self.model, posture).map_err(BodyError::from)?;
        self.external.update(self.model, &self.kinematics, &self.loads).map_err(BodyError::from)?;
        self.passive.update(self.model, &self.kinematics);
        self.contact.update(self.model, &self.kinematics, self.external.torques(), self.passive.torques());
        self.all_loads[self.loads.len()..].copy_from_slice(self.contact.loads());
        let needs = Needs { torque: true, center_of_mass: true };
        self.body.update(self.model, posture, &self.all_loads, needs)?;
        self.seen = true;
        Ok(())
    }

    /// Length of the error of a goal in the posture that was looked at last, in its units.
    pub fn error(&self, goal: usize) -> f64 {
        let goal = &self.goals[goal];
        let mut errors = vec![];
        goal.tasks.iter().for_each(|task| task.residual(self.model, &self.body, &mut errors));
        let values = self.body.posture().values();
        errors.extend(goal.half_spaces.iter().map(|space| space.violation(values).max(0.0)));
        length(&errors)
    }

    /// How far supports are off their places: lengths of the errors in m and rad together.
    pub fn slip(&self) -> f64 {
        let mut slip = vec![];
        self.places.tasks.iter().for_each(|task| task.residual(self.model, &self.body, &mut slip));
        length(&slip)
    }

    /// How the body must move for `rate` to change by 1 while supports stay where they are and the first `above` goals keep
    /// their values, other joints as little as may be; and the slope of that rate's external torque on the way, contact forces
    /// found anew, N m/rad. `None` where the rate cannot move so.
    ///
    /// # Errors
    /// [`RelaxError`] when the posture does not fit the model.
    pub fn slope_along(&mut self, posture: &Posture, rate: usize, above: usize) -> Result<Option<f64>, RelaxError> {
        self.see(posture)?;
        let level = &mut self.probe.problem.levels[0];
        level.clear();
        for goal in std::iter::once(&self.places).chain(&self.goals[..above]) {
            for task in &goal.tasks {
                if !matches!(task, Task::Effort(_)) {
                    task.evaluate(self.model, &self.body, level);
                }
            }
        }
        // What holds is kept as it is; inequalities that hold do not bind.
        for (lower, upper) in level.lower.iter_mut().zip(&mut level.upper) {
            (*lower, *upper) = if lower == upper { (0.0, 0.0) } else { (lower.min(0.0), upper.max(0.0)) };
        }
        for (i, locked) in self.locked.iter().enumerate() {
            let free = if *locked { 0.0 } else { f64::INFINITY };
            (self.probe.problem.lower[i], self.probe.problem.upper[i]) = (-free, free);
        }
        self.probe.slope(self.model, posture, rate, &self.loads)
    }

    /// Rows of all levels.
    fn build(&mut self) {
        self.errors.swap(0, 1);
        self.effort[1] = self.effort[0];
        self.effort[0] = 0.0;
        self.problem.levels.iter_mut().for_each(Level::clear);
        self.contact_rows();
        for k in 0..=self.goals.len() {
            let level = if k == 0 { 1 } else { BEFORE + k - 1 };
            let goal = if k == 0 { &self.places } else { &self.goals[k - 1] };
            for task in &goal.tasks {
                self.narrow.clear();
                task.evaluate(self.model, &self.body, &mut self.narrow);
                let effort = if let Task::Effort(effort) = task { Some(effort) } else { None };
                widen(&self.narrow, &mut self.problem.levels[level], &mut self.row, |row, i| {
                    if let Some(effort) = effort {
                        fill_forces(self.model, &self.body, &self.contact, effort, row, i);
                    }
                });
            }
            for space in &goal.half_spaces {
                self.row.fill(0.0);
                for (rate, entry) in self.model.rates().iter().zip(&mut self.row) {
                    *entry = rate.coordinate.map_or(0.0, |c| space.normal[c]);
                }
                let value = space.violation(self.body.posture().values());
                self.problem.levels[level].push(&self.row, f64::NEG_INFINITY, -value);
            }
            self.problem.levels[level].hard = k == 0 || goal.hard;
        }
        for (k, level) in self.problem.levels.iter().enumerate() {
            let missing = level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
            if self.effort_goal.is_some_and(|goal| k == BEFORE + goal) {
                self.effort[0] = 0.5 * missing.map(|m| m * m).sum::<f64>();
                self.errors[0][k] = 0.0;
            } else {
                self.errors[0][k] = missing.map(f64::abs).sum();
            }
        }
        self.damp();
    }

    /// Friction and equilibrium of the root; shares.
    fn contact_rows(&mut self) {
        let rates = self.model.rates().len();
        let unknowns = Unknowns { first: rates, now: Some(self.contact.forces()) };
        for (i, support) in self.contact.supports().iter().enumerate() {
            let corners = self.contact.corners(i);
            friction_rows(&mut self.problem.levels[0], &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.problem.levels[2], &mut self.row, support, corners, unknowns);
        }
        let weight = self.contact.weight();
        for &rate in self.contact.root() {
            let (by_rates, by_forces) = self.row.split_at_mut(rates);
            for (entry, slope) in by_rates.iter_mut().zip(self.body.gradient().row(rate)) {
                *entry = slope / weight;
            }
            for (entry, column) in by_forces.iter_mut().zip(self.contact.columns().chunks_exact(rates)) {
                *entry = column[rate] / weight;
            }
            let rest = -(self.body.external_torque().torques()[rate] + self.passive.torques()[rate]) / weight;
            self.problem.levels[0].push(&self.row, rest, rest);
        }
        self.problem.levels[0].hard = true;
    }

    /// Ranges, largest step, and forces that only push.
    fn bound(&mut self, posture: &Posture) {
        let most = self.reach;
        for (i, rate) in self.model.rates().iter().enumerate() {
            let (lower, upper) = match rate.coordinate {
                _ if self.locked[i] => (0.0, 0.0),
                Some(c) => {
                    let (lower, upper) = self.model.coordinates()[c].range;
                    let value = posture.values()[c];
                    ((lower - value).clamp(-most, most), (upper - value).clamp(-most, most))
                }
                None => (-most, most),
            };
            (self.problem.lower[i], self.problem.upper[i]) = (lower.min(upper), upper);
        }
        let rates = self.model.rates().len();
        for (i, force) in self.contact.forces().iter().enumerate() {
            let (lower, upper) = bounds(i);
            self.problem.lower[rates + i] = (lower - force).min(0.0);
            self.problem.upper[rates + i] = (upper - force).max(0.0);
        }
    }

    /// Levels above effort that cannot be reached, as far as the last step showed, are damped.
    fn damp(&mut self) {
        let last = self.effort_goal.map_or(self.problem.levels.len(), |goal| BEFORE + goal);
        for k in BEFORE..last {
            let unreached = self.unreached.get(k).copied().unwrap_or(0.0);
            let level = &mut self.problem.levels[k];
            level.damping = if level.hard { 0.0 } else { 2.0 * unreached.min(1.0) };
        }
    }

    /// No level above effort takes on more than [`PACE`].
    fn pace(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        for level in &mut self.problem.levels[BEFORE..BEFORE + goal] {
            let missing = level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
            let length = missing.map(|m| m * m).sum::<f64>().sqrt();
            if length > PACE {
                level.lower.iter_mut().chain(&mut level.upper).for_each(|limit| *limit *= PACE / length);
            }
        }
    }

    /// Merit of the present posture (0) or of the one before the last step (1).
    fn merit(&self, when: usize) -> f64 {
        let last = self.effort_goal.map_or(0, |goal| BEFORE + goal);
        let errors = &self.errors[when];
        if errors.is_empty() || !errors[0].is_finite() {
            return f64::INFINITY;
        }
        self.effort[when] + self.price * errors[..last].iter().sum::<f64>()
    }

    /// Did the last step make things worse?
    fn went_wrong(&mut self) -> bool {
        if self.effort_goal.is_none() || !self.merit(1).is_finite() {
            return false;
        }
        let wrong = self.merit(0) > self.merit(1) * (1.0 + 1e-12) && self.largest > 1e-10;
        let shift = self.curvature.shift();
        *shift = if wrong { (4.0 * *shift).max(1e-3) } else { 0.25 * *shift };
        if *shift < 1e-6 {
            *shift = 0.0;
        }
        self.reach = if wrong { 0.3 * self.largest } else { (2.0 * self.reach).min(self.options.max_step) };
        if wrong && self.options.guarded {
            // What was before is now again.
            self.errors.swap(0, 1);
            self.effort[0] = self.effort[1];
        }
        wrong && self.options.guarded
    }

    /// Gives the effort level its second derivative.
    fn bend(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let k = BEFORE + goal;
        let mut start = 0;
        self.starts.clear();
        for level in &self.problem.levels[..=k] {
            self.starts.push(start);
            start += level.rows();
        }
        if self.multipliers.len() != self.starts[k] {
            self.multipliers.clear();
            self.multipliers.resize(self.starts[k], 0.0);
        }
        let weights = self.curvature.weights();
        weights.fill(0.0);
        let root = self.contact.root();
        for (rate, y) in root.iter().zip(&self.multipliers[self.starts[1] - root.len()..]) {
            weights[*rate] = y / self.contact.weight();
        }
        for task in &self.goals[goal].tasks {
            let Task::Effort(effort) = task else { continue };
            for &coordinate in &effort.coordinates {
                let Some(rate) = self.model.coordinates()[coordinate].rate else { continue };
                let active = -(self.body.external_torque().torques()[rate] + self.passive.torques()[rate]);
                let share = share_of_strength(self.model, &self.body, coordinate);
                weights[rate] = -active * share * share;
            }
        }
        let (multipliers, starts) = (&self.multipliers, &self.starts);
        let places = std::iter::once((&self.places, &multipliers[starts[1]..starts[2]]));
        let goals = self.goals[..goal].iter().enumerate();
        let goals = goals.map(|(i, goal)| (goal, &multipliers[starts[BEFORE + i]..starts[BEFORE + i + 1]]));
        let goals = places.chain(goals);
        self.curvature.bend(self.model, &self.body, &self.all_loads, goals, &mut self.problem, k);
    }

    fn raise_price(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let rows = self.solver.multipliers(BEFORE + goal).rows;
        self.multipliers.clear();
        self.multipliers.extend_from_slice(rows);
        let most = rows.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        self.price = (0.7 * self.price).max(1.5 * most);
    }

    fn keep_ranges(&self, posture: &mut Posture) {
        for (i, rate) in self.model.rates().iter().enumerate() {
            if let (Some(c), false) = (rate.coordinate, self.locked[i]) {
                let (lower, upper) = self.model.coordinates()[c].range;
                let value = &mut posture.values_mut()[c];
                let near = value.clamp(lower, upper);
                if (*value - near).abs() < 1e-9 {
                    *value = near;
                }
            }
        }
    }
}

/// Copies rows over the rates into a level over all unknowns; `fill` completes them.
fn widen(narrow: &Level, wide: &mut Level, row: &mut [f64], fill: impl Fn(&mut [f64], usize)) {
    let Some(n) = narrow.matrix.len().checked_div(narrow.rows()) else { return };
    for i in 0..narrow.rows() {
        row.fill(0.0);
        row[..n].copy_from_slice(&narrow.matrix[i * n..(i + 1) * n]);
        fill(row, i);
        wide.push(row, narrow.lower[i], narrow.upper[i]);
    }
}

/// What contact forces do to row `i` of an effort task.
fn fill_forces(model: &Model, body: &Body, contact: &ContactForces, effort: &Effort, row: &mut [f64], i: usize) {
    let coordinate = effort.coordinates[i];
    let Some(rate) = model.coordinates()[coordinate].rate else { return };
    let share = share_of_strength(model, body, coordinate);
    let rates = model.rates().len();
    for (entry, column) in row[rates..].iter_mut().zip(contact.columns().chunks_exact(rates)) {
        *entry = -column[rate] * share;
    }
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
