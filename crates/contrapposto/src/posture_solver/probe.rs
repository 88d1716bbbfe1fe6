//! How does a torque change when one joint moves and the rest follows?

use super::EngineError;
use crate::contact::ContactForces;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::Load;
use hierarchical_least_squares::{Level, Problem, Solver};

/// How far the joint moves to either side for the difference, rad or m.
const MOVE: f64 = 1e-4;
/// A joint that moves less when it is asked for 1 is held fast.
const BLOCKED: f64 = 0.999;

/// A second body to try motions on. Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    /// Level 0 is to be filled with what holds; bounds with what may move.
    pub(super) problem: Problem,
    solver: Solver,
    moved: Posture,
    step: Vec<f64>,
    row: Vec<f64>,
    torques: JointTorques,
    contact: ContactForces,
}

impl Probe {
    pub(super) fn new(model: &Model, contact: &ContactForces) -> Self {
        let n = model.rates().len();
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
            moved: model.default_posture(),
            step: vec![0.0; n],
            row: vec![0.0; n],
            torques: JointTorques::new(model),
            contact: contact.clone(),
        }
    }

    /// Forgets what was active.
    pub(super) fn forget(&mut self) {
        self.solver.forget();
        self.contact.forget();
    }

    /// `d_l = P e_l / (e_l^T P e_l)`, with `P` the projection on what level 0 leaves free, is the least motion with
    /// `e_l . d = 1`: one lexicographic problem. The slope is a central difference along it, of external torque and of what the
    /// joint's neighbours do to its passive torque.
    pub(super) fn slope(
        &mut self,
        model: &Model,
        posture: &Posture,
        rate: usize,
        loads: &[Load],
    ) -> Result<Option<f64>, EngineError> {
        self.row.fill(0.0);
        self.row[rate] = 1.0;
        self.problem.levels[1].clear();
        self.problem.levels[1].push(&self.row, 1.0, 1.0);
        self.solver.solve_next(&self.problem)?;
        if self.solver.solution()[rate] < BLOCKED {
            return Ok(None);
        }
        let mut slope = 0.0;
        for sign in [1.0, -1.0] {
            for (step, along) in self.step.iter_mut().zip(self.solver.solution()) {
                *step = sign * MOVE * along;
            }
            self.moved.values_mut().copy_from_slice(posture.values());
            self.moved.displace(model, &self.step);
            match self.torques.update(model, &self.moved, loads, Quantities::TORQUES) {
                // A law may be no number a little beyond a range, and needs not be one.
                Err(JointTorquesError::Passive(_)) => return Ok(None),
                updated => updated?,
            }
            self.contact.update(model, self.torques.kinematics(), self.torques.active_torque());
            let external = self.torques.external_torque().torques()[rate] + self.contact.torques()[rate];
            slope += sign * external / (2.0 * MOVE);
            let Some(own) = model.rates()[rate].coordinate else { continue };
            let Some(law) = &model.coordinates()[own].passive else { continue };
            slope += sign * law.torque(own, self.moved.values()) / (2.0 * MOVE);
            self.moved.values_mut().copy_from_slice(posture.values());
            self.moved.values_mut()[own] += sign * MOVE;
            slope -= sign * law.torque(own, self.moved.values()) / (2.0 * MOVE);
        }
        Ok(Some(slope))
    }
}
