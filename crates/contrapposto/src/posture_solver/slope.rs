//! Computes the slope of a joint's torque along the least motion that moves the joint while supports and tasks stay.
//!
//! `d = P e / (e^T P e)`, with `P` the projection on the motions that the constraints leave free and `e` the unit
//! vector of the rate (for a three-axis joint the row that gives its rotation about the axis of the coordinate, `A^T e_k`), is the
//! least motion with `e^T d = 1`: the solution of one lexicographic problem. The slope is a
//! central difference along `d`, of external torque and of the neighbours' part in the joint's passive torque; contact
//! forces are solved anew on both sides.

use super::error::EngineError;
use super::iterate::Iterate;
use super::settings::Settings;
use super::tolerances::{FREE_MOTION, SLOPE_STEP};
use crate::contact::ContactForces;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::posture::Posture;
use crate::tasks::Task;
use hierarchical_least_squares::{Level, Problem, Solver};

/// Workspace of slopes: a second body to move.
#[derive(Clone, Debug)]
pub(super) struct SlopeAlongMotion {
    /// Level 0 keeps the constraints, level 1 moves the joint, level 2 asks for the least motion.
    problem: Problem,
    solver: Solver,
    moved: Posture,
    step: Vec<f64>,
    row: Vec<f64>,
    torques: JointTorques,
    contact: ContactForces,
}

impl SlopeAlongMotion {
    pub(super) fn new(settings: &Settings<'_>, contact: &ContactForces) -> Self {
        let n = settings.model.rates().len();
        let mut problem = Problem::new(n);
        problem.levels.resize(3, Level::default());
        for i in 0..n {
            let mut row = vec![0.0; n];
            row[i] = 1.0;
            problem.levels[2].push(&row, 0.0, 0.0);
        }
        Self {
            problem,
            solver: Solver::new(),
            moved: settings.model.default_posture(),
            step: vec![0.0; n],
            row: vec![0.0; n],
            torques: JointTorques::new(&settings.model),
            contact: contact.clone(),
        }
    }

    /// Supports need not hold the root at a rate.
    pub(super) fn hold_root(&mut self, rate: usize) {
        self.contact.hold_root(rate);
    }

    /// Forgets the motions so far.
    pub(super) fn forget(&mut self) {
        self.solver.forget();
        self.contact.forget();
    }

    /// Slope of the external torque of `rate` at the iterate, N m/rad, while supports and the first `above` levels keep
    /// their values; `None` where the rate cannot move so.
    pub(super) fn slope(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        rate: usize,
        above: usize,
    ) -> Result<Option<f64>, EngineError> {
        self.write_constraints(settings, iterate, above);
        self.row.fill(0.0);
        self.row[rate] = 1.0;
        iterate.torques.fold_axes(&settings.model, &mut self.row);
        self.problem.levels[1].clear();
        self.problem.levels[1].push(&self.row, 1.0, 1.0);
        self.solver.solve_next(&self.problem)?;
        let moved: f64 = self.row.iter().zip(self.solver.solution()).map(|(by, along)| by * along).sum();
        if moved < FREE_MOTION {
            return Ok(None);
        }
        let mut slope = 0.0;
        for sign in [1.0, -1.0] {
            let Some(torque) = self.torque_after(settings, iterate, rate, sign * SLOPE_STEP)? else { return Ok(None) };
            slope += sign * torque / (2.0 * SLOPE_STEP);
        }
        Ok(Some(slope))
    }

    /// Rows of everything that keeps its value; inequalities that hold do not bind, and other rates are free.
    fn write_constraints(&mut self, settings: &Settings<'_>, iterate: &Iterate, above: usize) {
        let level = &mut self.problem.levels[0];
        level.clear();
        let levels = settings.placements.iter().chain([&settings.limits]).chain(&settings.levels[..above]);
        for task in levels.flat_map(|level| &level.tasks) {
            if !matches!(task, Task::Effort(_)) {
                task.evaluate(&settings.model, &iterate.torques, level);
            }
        }
        for (lower, upper) in level.lower.iter_mut().zip(&mut level.upper) {
            (*lower, *upper) = if lower == upper { (0.0, 0.0) } else { (lower.min(0.0), upper.max(0.0)) };
        }
        for (i, locked) in settings.locked().iter().enumerate() {
            let free = if *locked { 0.0 } else { f64::INFINITY };
            (self.problem.lower[i], self.problem.upper[i]) = (-free, free);
        }
    }

    /// External torque, contact included, after `length` of the motion, and the neighbours' part in the passive torque.
    /// `None` where a passive law gives no number: a little beyond a range it need not.
    fn torque_after(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        rate: usize,
        length: f64,
    ) -> Result<Option<f64>, EngineError> {
        let (model, start) = (&settings.model, iterate.torques.posture());
        for (step, along) in self.step.iter_mut().zip(self.solver.solution()) {
            *step = length * along;
        }
        self.moved.values_mut().copy_from_slice(start.values());
        self.moved.displace(model, &self.step);
        match self.torques.update(model, &self.moved, &settings.loads, Quantities::TORQUES) {
            Err(JointTorquesError::Passive(_)) => return Ok(None),
            updated => updated?,
        }
        let body = &self.torques;
        self.contact.update(model, body.kinematics_by_axes(), body.angles(), body.active_torque());
        let torque = body.external_about_axes()[rate] + self.contact.torques()[rate];
        let Some(own) = model.rates()[rate].coordinate else { return Ok(Some(torque)) };
        let together = body.passive_torque().law_about_axis(model, own);
        let alone = iterate.torques.passive_torque().torque_after_turn(
            (model, iterate.torques.kinematics()),
            own,
            length,
            self.moved.values_mut(),
        );
        Ok(Some(torque + together - alone))
    }
}
