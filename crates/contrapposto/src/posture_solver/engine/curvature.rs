//! Which rows does the effort level have when it is to bend as effort does?
//!
//! The second derivative of the Lagrangian ([`crate::effort::hessian`]) as rows `R` with `R^T R` equal to it. The multipliers of
//! the levels above are those of the present posture ([`Hold`]); for scouts they are those of the last step, which carry them
//! over dips. Contact forces, of which effort is a quadratic function, are found anew in every posture (Kaufman 1975, "A
//! variable projection method for solving separable nonlinear least squares problems"); here they are unknowns, and with their
//! mixed second derivatives the step is Newton's on both.

use super::BEFORE;
use crate::effort::hessian::{FirstOrder, Hessian, HessianModel};
use crate::effort::problem::EffortProblem;
use crate::joint_torques::JointTorques;
use crate::model::Model;
use crate::posture_solver::inverse_kinematics::hold::Hold;
use crate::statics::Load;
use crate::tasks::PriorityLevel;
use crate::tasks::Task;
use hierarchical_least_squares::linalg::{add_outer_product, add_scaled, cholesky};
use hierarchical_least_squares::{Level, Multipliers, Problem};

/// Weight of rows above, against the largest diagonal entry: what levels above hold fast must not look as if it bent down.
const FAST: f64 = 10.0;
/// Share of the largest diagonal entry below which a direction counts as flat and is left to the levels below.
const FLAT: f64 = 1e-9;

/// Second derivatives, and rows made of them. Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Curvature {
    hessian: Hessian,
    pub(super) sight: HessianModel,
    hold: Hold,
    /// Of the root's equilibrium and of the tasks above.
    multipliers: Vec<f64>,
    errors: Vec<f64>,
    matrix: Vec<f64>,
    factor: Vec<f64>,
    /// What is added to the diagonal of the posture.
    shift: f64,
    slope: Vec<f64>,
    row: Vec<f64>,
    /// The level as it was before its rows were replaced.
    level: Level,
}

impl Curvature {
    /// Space for `model` and so many unknowns.
    pub(super) fn new(model: &Model, unknowns: usize) -> Self {
        Self {
            hessian: Hessian::new(model),
            sight: HessianModel::Full,
            hold: Hold::new(unknowns, unknowns),
            multipliers: vec![],
            errors: vec![],
            matrix: vec![0.0; unknowns * unknowns],
            factor: vec![0.0; unknowns * unknowns],
            shift: 0.0,
            slope: vec![0.0; unknowns],
            row: vec![0.0; unknowns],
            level: Level::default(),
        }
    }

    /// Replaces the rows of the effort level by those of the whole second derivative in the posture of `body` under `loads`,
    /// those of the scenario and of contact. All rates are free in `ask`; `last` are the effort level's multipliers of the last
    /// step.
    pub(super) fn bend(
        &mut self,
        ask: &EffortProblem<'_>,
        body: &JointTorques,
        loads: &[Load],
        problem: &mut Problem,
        last: Multipliers<'_>,
    ) {
        let (k, m) = (BEFORE + ask.above.len(), problem.unknowns());
        self.level.clone_from(&problem.levels[k]);
        self.errors.clear();
        self.errors.extend(self.level.upper.iter().map(|upper| -upper));
        self.slope.fill(0.0);
        for (row, error) in self.level.matrix.chunks_exact(m).zip(&self.errors) {
            add_scaled(&mut self.slope, *error, row);
        }
        self.hold.estimate(problem, &problem.levels[..k], last, &self.slope);
        if self.sight == HessianModel::Partial {
            self.hold.keep(last);
        }
        self.gather(ask, &problem.levels[..k]);
        self.matrix.fill(0.0);
        let seen = FirstOrder {
            body,
            loads,
            columns: ask.contact.columns(),
            residual: &self.errors,
            jacobian: &self.level.matrix,
            support_rows: &problem.levels[1].matrix,
        };
        self.hessian.add_second_derivative(ask, &seen, &self.multipliers, self.sight, &mut self.matrix);
        for row in self.level.matrix.chunks_exact(m) {
            add_outer_product(&mut self.matrix, row, 1.0);
        }
        let size = (0..m).fold(0.0, |size: f64, i| size.max(self.matrix[i * m + i].abs()));
        for above in &problem.levels[..k] {
            for (i, row) in above.matrix.chunks_exact(m).enumerate().filter(|(i, _)| above.lower[*i] == above.upper[*i])
            {
                let square: f64 = row.iter().map(|a| a * a).sum();
                if square > 0.0 {
                    let weight = FAST * size / square;
                    add_outer_product(&mut self.matrix, row, weight);
                    add_scaled(&mut self.slope, -weight * above.upper[i], row);
                }
            }
        }
        self.factorise(ask.free.len(), m, &mut problem.levels[k]);
        problem.levels[k].hard = self.level.hard;
    }

    /// The multipliers that bend: those of the root's equilibrium, the last rows of the first level, and of tasks.
    fn gather(&mut self, ask: &EffortProblem<'_>, above: &[Level]) {
        self.multipliers.clear();
        let mut rest = &self.hold.multipliers[..];
        for (k, level) in above.iter().enumerate() {
            let (own, below) = rest.split_at(level.rows());
            rest = below;
            let tasks = |goal: &PriorityLevel| ..goal.tasks.iter().map(Task::rows).sum();
            match k {
                0 => self.multipliers.extend_from_slice(&own[own.len() - ask.contact.root().len()..]),
                1 => self.multipliers.extend_from_slice(own),
                _ if k < BEFORE => {}
                _ => self.multipliers.extend_from_slice(&own[tasks(&ask.above[k - BEFORE])]),
            }
        }
    }

    /// Rows `R p = -R^-T g` with `R^T R` the matrix, and as much on the diagonal of the posture, its first `n` entries, as makes it
    /// positive, `shift` at least.
    fn factorise(&mut self, n: usize, m: usize, level: &mut Level) {
        let largest =
            |range: std::ops::Range<usize>| range.fold(0.0, |most: f64, i| most.max(self.matrix[i * m + i].abs()));
        let (posture, forces) = (largest(0..n), largest(n..m));
        let most = 10.0 * posture.max(1e-12);
        if !most.is_finite() {
            return; // first derivatives alone
        }
        loop {
            self.factor.copy_from_slice(&self.matrix);
            for i in 0..n {
                self.factor[i * m + i] += self.shift + FLAT * posture;
            }
            for i in n..m {
                self.factor[i * m + i] += FLAT * forces;
            }
            if cholesky(&mut self.factor, m) {
                break;
            }
            if self.shift > most {
                return; // first derivatives alone
            }
            self.shift = (4.0 * self.shift).max(1e-4 * posture);
        }
        level.clear();
        for r in 0..m {
            let row = &self.factor[r * m..(r + 1) * m];
            self.row[..r].fill(0.0);
            self.row[r..].copy_from_slice(&row[r..]);
            if row[r] <= 0.0 {
                continue;
            }
            let c = -self.slope[r] / row[r];
            add_scaled(&mut self.slope[r..], c, &row[r..]);
            level.push(&self.row, c, c);
        }
    }

    /// What is added to the diagonal.
    pub(super) fn shift(&mut self) -> &mut f64 {
        &mut self.shift
    }
}
