//! One step of posture and contact forces, and steps until effort falls no more.
//!
//! Effort is a sum of squares under constraints that bend, so this is a Gauss-Newton method within a largest step. A step
//! counts if it lowers `|e|^2/2 + price sum |errors of the levels above|`, the price above every multiplier; else it is taken
//! back and the largest step shrinks (Nocedal & Wright 2006, "Numerical Optimization", ch. 18). `rows.rs` writes the problem of a
//! step, `merit.rs` judges it, `down.rs` leaves the way down to [`crate::effort::basin_hopping`].

mod curvature;
mod down;
mod merit;
mod rows;

use curvature::Curvature;
use nalgebra::Vector3;

use super::probe::Probe;
use super::{EngineError, LevelError, Options, Reason, SolvedPosture, Step};
use crate::contact::{ContactForces, Support};
use crate::effort::basin_hopping::BasinHopping;
use crate::effort::hessian::HessianModel;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::Load;
use crate::tasks::PriorityLevel;
use crate::tasks::{Placement, Task, TaskError};
use hierarchical_least_squares::{Level, Problem, Solver};

/// Levels before the goals: contact and equilibrium, supports, shares.
const BEFORE: usize = 3;

/// Brings a body on its supports toward goals, least effort among them.
#[derive(Clone, Debug)]
pub struct Engine<'a> {
    model: &'a Model,
    goals: Vec<PriorityLevel>,
    places: PriorityLevel,
    loads: Vec<Load>,
    options: Options,
    locked: Vec<bool>,
    body: JointTorques,
    contact: ContactForces,
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
    /// What the last step left of each level.
    unreached: Vec<f64>,
    curvature: Curvature,
    valleys: BasinHopping,
    /// All rates, and those that move.
    rates: Vec<usize>,
    free: Vec<usize>,
    reach: f64,
    last: Posture,
    largest: f64,
}

impl<'a> Engine<'a> {
    /// Checks supports and goals, the most important first. Supports stay where they are in `start`.
    ///
    /// # Errors
    /// [`EngineError`] names the first thing that does not fit the model.
    pub fn new(
        model: &'a Model,
        start: &Posture,
        supports: Vec<Support>,
        goals: Vec<PriorityLevel>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, EngineError> {
        let fits = |level: usize, task: &Task| {
            task.check(model).map_err(|error: TaskError| EngineError::Task { level, error })
        };
        for (level, goal) in goals.iter().enumerate() {
            for task in &goal.tasks {
                fits(level, task)?;
            }
        }
        for load in loads {
            load.check(model).map_err(JointTorquesError::from)?;
        }
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, start).map_err(JointTorquesError::from)?;
        let mut places = PriorityLevel::default();
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
            body: JointTorques::new(model),
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
            unreached: vec![],
            curvature: Curvature::new(model, unknowns),
            valleys: BasinHopping::new(model),
            rates: (0..rates).collect(),
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

    /// It is to pass over dips in which there is little to be found ([`HessianModel::Partial`]).
    pub(crate) fn scout(&mut self) {
        self.curvature.sight = HessianModel::Partial;
    }

    /// The goals, to move targets between steps. What is changed must still fit the model; effort must stay where it is.
    pub fn levels_mut(&mut self) -> &mut [PriorityLevel] {
        &mut self.goals
    }

    /// Other loads from now on.
    ///
    /// # Errors
    /// [`JointTorquesError::Load`] for a load that does not fit the model; nothing is changed then.
    pub fn set_loads(&mut self, loads: &[Load]) -> Result<(), EngineError> {
        loads.iter().try_for_each(|load| load.check(self.model)).map_err(JointTorquesError::from)?;
        self.loads = loads.to_vec();
        self.seen = false;
        Ok(())
    }

    /// Passive torque of every rate in the posture that was looked at last, followers folded in, N m.
    pub fn passive(&self) -> &[f64] {
        self.body.passive_torque().torques()
    }

    /// The contact forces of the posture where the last step began, or of the last report.
    pub fn contact(&self) -> &ContactForces {
        &self.contact
    }

    /// The body in that posture; its external torque includes contact forces.
    pub fn body(&self) -> &JointTorques {
        &self.body
    }

    /// One step: moves `posture` by what the goals ask for.
    ///
    /// # Errors
    /// [`EngineError`] when the posture does not fit the model; it is not moved then.
    pub fn step(&mut self, posture: &mut Posture) -> Result<Step, EngineError> {
        self.evaluate(posture)?;
        self.build();
        let rejected_previous = self.went_wrong();
        if rejected_previous {
            posture.values_mut().copy_from_slice(self.last.values());
            self.evaluate(posture)?;
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
        Ok(Step { largest: self.largest, rejected_previous, status, changes: self.solver.changes() })
    }

    /// Lets the next step be as long as ever: something new is asked.
    pub fn widen_trust_region(&mut self) {
        self.reach = self.options.max_step;
        self.errors[0].fill(f64::INFINITY);
    }

    /// Forgets what earlier steps have shown.
    pub fn restart(&mut self) {
        self.errors.iter_mut().for_each(|errors| errors.fill(f64::INFINITY));
        self.effort = [f64::INFINITY; 2];
        self.price = 0.0;
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
    pub fn solve(&mut self, start: &Posture) -> Result<SolvedPosture, EngineError> {
        self.restart();
        let mut posture = start.clone();
        let (settled, mut steps) = self.look_into_valleys(&mut posture)?;
        let mut idle = if settled { 3 } else { 0 };
        let most = steps + self.options.max_steps;
        while steps < most && idle < 3 {
            let step = self.step(&mut posture)?;
            steps += 1;
            let gained = self.merit(1) - self.merit(0);
            let little =
                gained.abs() <= self.options.merit_tolerance * self.merit(0) && step.largest < 0.9 * self.reach;
            idle = if step.largest <= self.options.step_tolerance {
                3
            } else if little && !step.rejected_previous {
                idle + 1
            } else {
                0
            };
        }
        self.evaluate(&posture)?;
        self.build();
        if self.went_wrong() {
            posture.values_mut().copy_from_slice(self.last.values());
            self.evaluate(&posture)?;
            self.build();
        }
        let levels: Vec<LevelError> =
            self.goals.iter().map(|level| LevelError::of(level, self.model, &self.body)).collect();
        let reason = if levels.iter().all(|level| level.length <= self.options.level_tolerance) {
            Reason::Reached
        } else if steps < most {
            Reason::Converged
        } else {
            Reason::StepLimit
        };
        Ok(SolvedPosture {
            effort: 2.0 * self.effort[0],
            levels,
            slip: self.slip(),
            balance: self.contact.balance(),
            reason,
            steps,
            posture,
        })
    }

    /// Computes everything that depends on the posture, contact forces included.
    ///
    /// # Errors
    /// [`EngineError::Body`] when the posture does not fit the model, or a passive law gives no torque in it.
    pub fn evaluate(&mut self, posture: &Posture) -> Result<(), EngineError> {
        if self.seen && self.body.posture() == posture {
            return Ok(());
        }
        self.seen = false;
        self.body.update_with_contact(self.model, posture, &self.loads, &mut self.contact, Quantities::ALL)?;
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
    /// [`EngineError`] when the posture does not fit the model.
    pub fn slope_along(&mut self, posture: &Posture, rate: usize, above: usize) -> Result<Option<f64>, EngineError> {
        self.evaluate(posture)?;
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

fn length(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
