//! Evaluates objective and constraints of a problem of least effort, with first derivatives, in a posture with given contact forces.
//!
//! The objective is `1/2 |r|^2` with `r_i = tau_a,i / S_i`; a constraint is a row `a` with `lower <= a . d <= upper` for the change
//! `d` of the unknowns: equilibrium of the root, placements and levels above effort, half-spaces, friction, shares of supports.

use nalgebra::Vector3;

use super::hessian::FirstOrder;
use super::problem::{EffortProblem, fill_force_columns};
use super::qp::QuadraticProgram;
use crate::contact::{Unknowns, friction_rows, share_row};
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{FixedIn, Load, LoadKind};
use crate::tasks::{PriorityLevel, Task};
use hierarchical_least_squares::Level;
use hierarchical_least_squares::linalg::{add_outer_products, add_scaled};

/// Posture and forces, and what follows from them.
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    pub(crate) posture: Posture,
    /// As [`crate::contact::ContactForces::forces`].
    pub(crate) forces: Vec<f64>,
    pub(crate) body: JointTorques,
    /// Loads of the scenario, then one a corner.
    pub(crate) loads: Vec<Load>,
    /// As [`crate::contact::ContactForces::columns`].
    pub(crate) columns: Vec<f64>,
    /// Relative loads, and their derivatives by the unknowns, row after row.
    pub(crate) residual: Vec<f64>,
    pub(crate) jacobian: Vec<f64>,
    /// Half the sum of squares of the residual.
    pub(crate) objective: f64,
    /// Rows of the constraints, and their limits.
    pub(crate) constraints: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    // Scratch.
    level: Level,
    row: Vec<f64>,
    point_jacobian: Vec<f64>,
}

impl Iterate {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            posture: model.default_posture(),
            forces: vec![],
            body: JointTorques::new(model),
            loads: vec![],
            columns: vec![],
            residual: vec![],
            jacobian: vec![],
            objective: 0.0,
            constraints: vec![],
            lower: vec![],
            upper: vec![],
            level: Level::default(),
            row: vec![],
            point_jacobian: vec![0.0; 3 * model.rates().len()],
        }
    }

    /// Sum of the violations of all constraints.
    pub(crate) fn violation(&self) -> f64 {
        self.lower.iter().zip(&self.upper).map(|(lower, upper)| lower.max(0.0) - upper.min(0.0)).sum()
    }

    /// The errors of the tasks and half-spaces above effort, by row of the constraint levels; 0 for supports and limits, which have to hold.
    pub(crate) fn shortfall(&self, problem: &EffortProblem<'_>) -> Vec<f64> {
        let first = problem.contact.root().len();
        let held = first + problem.places.rows() + problem.limits.rows();
        let end = first + problem.constraint_levels().map(PriorityLevel::rows).sum::<usize>();
        let missed = |row: usize| if row < held { 0.0 } else { self.lower[row].max(0.0) + self.upper[row].min(0.0) };
        (first..end).map(missed).collect()
    }

    /// Computes everything for `posture` and `forces`.
    pub(crate) fn evaluate(&mut self, problem: &EffortProblem<'_>) -> Result<(), JointTorquesError> {
        let (model, contact) = (problem.model, problem.contact);
        self.loads.clear();
        self.loads.extend_from_slice(problem.loads);
        for ((load, axes), shares) in contact.loads().iter().zip(contact.axes()).zip(self.forces.chunks_exact(3)) {
            let force: Vector3<f64> = axes.iter().zip(shares).map(|(axis, share)| *share * *axis).sum();
            let kind = LoadKind::Force(contact.weight() * force, FixedIn::World);
            self.loads.push(Load { kind, ..*load });
        }
        let tasks = problem.constraint_levels().flat_map(|level| &level.tasks);
        let needs = Quantities { gradient: true, passive_torque: true, ..Quantities::default() };
        let needs = tasks.fold(needs, |needs, task| needs.with(task.quantities()));
        self.body.update(model, &self.posture, &self.loads, needs)?;
        problem.contact_columns(self.body.kinematics_by_axes(), &mut self.point_jacobian, &mut self.columns);
        self.evaluate_residual(problem);
        self.constraints.clear();
        self.lower.clear();
        self.upper.clear();
        self.add_equilibrium_rows(problem);
        self.add_level_rows(problem);
        self.add_force_rows(problem);
        Ok(())
    }

    /// The quantities that the second derivative needs.
    pub(crate) fn first_order(&self, problem: &EffortProblem<'_>) -> FirstOrder<'_> {
        let (n, root) = (problem.unknowns(), problem.contact.root().len());
        FirstOrder {
            body: &self.body,
            loads: &self.loads,
            columns: &self.columns,
            residual: &self.residual,
            jacobian: &self.jacobian,
            support_rows: &self.constraints[root * n..(root + problem.places.rows()) * n],
        }
    }

    fn evaluate_residual(&mut self, problem: &EffortProblem<'_>) {
        let n = problem.model.rates().len();
        self.residual.clear();
        self.jacobian.clear();
        for task in &problem.effort.tasks {
            self.level.clear();
            task.evaluate(problem.model, &self.body, &mut self.level);
            for (i, row) in self.level.matrix.chunks_exact(n).enumerate() {
                let residual = -self.level.upper[i];
                self.residual.push(residual);
                self.jacobian.extend(problem.free.iter().map(|rate| row[*rate]));
                let start = self.jacobian.len();
                self.jacobian.resize(start + self.forces.len(), 0.0);
                if let (Task::Effort(effort), false) = (task, self.forces.is_empty()) {
                    let to = &mut self.jacobian[start..];
                    let coordinate = effort.coordinates[i];
                    fill_force_columns(problem.model, &self.body, &self.columns, coordinate, residual, to);
                }
            }
        }
        self.objective = 0.5 * self.residual.iter().map(|r| r * r).sum::<f64>();
    }

    fn add_equilibrium_rows(&mut self, problem: &EffortProblem<'_>) {
        let (n, weight) = (problem.model.rates().len(), problem.contact.weight());
        for &rate in problem.contact.root() {
            let slopes = self.body.gradient().row(rate);
            self.constraints.extend(problem.free.iter().map(|by| slopes[*by] / weight));
            self.constraints.extend(self.columns.chunks_exact(n).map(|column| column[rate] / weight));
            let missing = self.body.active_torque()[rate] / weight;
            self.lower.push(missing);
            self.upper.push(missing);
        }
    }

    /// Rows of the supports' placements and of the levels above effort, all of one rank, zero in the forces. The tasks of all
    /// levels come first, placements foremost: [`Iterate::first_order`] and the multipliers of the Hessian rely on that order.
    fn add_level_rows(&mut self, problem: &EffortProblem<'_>) {
        let (rates, forces) = (problem.model.rates(), self.forces.len());
        for task in problem.constraint_levels().flat_map(|level| &level.tasks) {
            self.level.clear();
            task.evaluate(problem.model, &self.body, &mut self.level);
            for row in self.level.matrix.chunks_exact(rates.len()) {
                self.constraints.extend(problem.free.iter().map(|rate| row[*rate]));
                self.constraints.resize(self.constraints.len() + forces, 0.0);
            }
            self.lower.extend_from_slice(&self.level.lower);
            self.upper.extend_from_slice(&self.level.upper);
        }
        for space in problem.constraint_levels().flat_map(|level| &level.half_spaces) {
            let entry = |rate: &usize| rates[*rate].coordinate.map_or(0.0, |c| space.normal[c]);
            self.constraints.extend(problem.free.iter().map(entry));
            self.constraints.resize(self.constraints.len() + forces, 0.0);
            self.lower.push(f64::NEG_INFINITY);
            self.upper.push(-space.violation(self.posture.values()));
        }
        let limits = self.lower.iter_mut().zip(&mut self.upper).skip(problem.contact.root().len());
        for ((lower, upper), missed) in limits.zip(problem.shortfall) {
            *lower -= missed;
            *upper -= missed;
        }
    }

    fn add_force_rows(&mut self, problem: &EffortProblem<'_>) {
        self.level.clear();
        self.row.resize(problem.unknowns(), 0.0);
        let unknowns = Unknowns { first: problem.free.len(), now: Some(&self.forces) };
        for (i, support) in problem.contact.supports().iter().enumerate() {
            let corners = problem.contact.corners(i);
            friction_rows(&mut self.level, &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.level, &mut self.row, support, corners, unknowns);
        }
        self.constraints.extend_from_slice(&self.level.matrix);
        self.lower.extend_from_slice(&self.level.lower);
        self.upper.extend_from_slice(&self.level.upper);
    }

    /// Writes the Gauss-Newton program of the next step, which corrects the share `share` of each violation; returns the largest
    /// diagonal entry among the rates.
    pub(crate) fn write(&self, share: f64, program: &mut QuadraticProgram) -> f64 {
        let n = program.n;
        program.rows.clone_from(&self.constraints);
        program.lower.clear();
        program.upper.clear();
        for (lower, upper) in self.lower.iter().zip(&self.upper) {
            // Only violated rows are scaled; equations remain equations.
            let violation = lower.max(0.0) + upper.min(0.0);
            let rest = (share - 1.0) * violation;
            program.lower.push(if violation != 0.0 { lower + rest } else { *lower });
            program.upper.push(if violation != 0.0 { upper + rest } else { *upper });
        }
        program.matrix.clear();
        program.matrix.resize(n * n, 0.0);
        program.gradient.clear();
        program.gradient.resize(n, 0.0);
        add_outer_products(&mut program.matrix, n, &self.jacobian, |_| 1.0);
        for (row, residual) in self.jacobian.chunks_exact(n).zip(&self.residual) {
            add_scaled(&mut program.gradient, *residual, row);
        }
        (0..program.rates).fold(0.0, |size: f64, i| size.max(program.matrix[i * n + i]))
    }

    /// Moves posture and forces by `length` times the step. A coordinate does not leave its range: corrections do not know of it.
    pub(super) fn displace(&mut self, problem: &EffortProblem<'_>, step: &[f64], length: f64, by_rate: &mut [f64]) {
        by_rate.fill(0.0);
        for (rate, d) in problem.free.iter().zip(step) {
            by_rate[*rate] = length * d;
        }
        let outside = |posture: &Posture, rate: usize, change: f64| {
            let c = problem.model.rates()[rate].coordinate?;
            let ((lower, upper), after) = (problem.model.coordinates()[c].range, posture.values()[c]);
            let before = after - change;
            let kept = after.clamp(lower.min(before), upper.max(before));
            (kept != after).then_some((c, kept))
        };
        self.posture.displace(problem.model, by_rate);
        let mut left = false;
        for rate in problem.free {
            if let Some((c, kept)) = outside(&self.posture, *rate, by_rate[*rate]) {
                self.posture.values_mut()[c] = kept;
                left = true;
            }
        }
        if left {
            // Coordinates that follow others are set anew.
            by_rate.fill(0.0);
            self.posture.displace(problem.model, by_rate);
        }
        for (force, d) in self.forces.iter_mut().zip(&step[problem.free.len()..]) {
            *force += length * d;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::qp::QuadraticProgram;
    use super::super::standing_adult::{StandingAdult, displaced, same_groups};

    const SEED: u64 = 29;
    /// Step of the difference, rad, m or body weights.
    const STEP: f64 = 1e-5;

    /// The Jacobian and the constraint rows along random motions of posture and forces, and along forces alone, are the central
    /// differences of residual and limits.
    #[test]
    fn rows_along_random_motions_are_central_differences() {
        let adult = StandingAdult::new();
        let (mut worst, mut compared) = ([0f64; 2], 0);
        adult.each_posture(&mut Pcg64Mcg::new(SEED.into()), 40, |random, problem, iterate| {
            let n = problem.unknowns();
            for (kind, worst) in worst.iter_mut().enumerate() {
                let mut step: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
                if kind == 1 {
                    step[..problem.free.len()].fill(0.0);
                }
                let [before, after] = [-STEP, STEP].map(|by| displaced(iterate, problem, &step, by));
                if !same_groups(&before, &after) {
                    continue;
                }
                compared += 1;
                let mut compare = |rows: &[f64], before: &[f64], after: &[f64], sign: f64| {
                    for ((row, before), after) in rows.chunks_exact(n).zip(before).zip(after) {
                        let exact: f64 = row.iter().zip(&step).map(|(a, d)| a * d).sum();
                        let numeric = sign * (after - before) / (2.0 * STEP);
                        // A row without a lower limit has none to compare.
                        if numeric.is_finite() {
                            *worst = worst.max((numeric - exact).abs() / (1.0 + exact.abs()));
                        }
                    }
                };
                compare(&iterate.jacobian, &before.residual, &after.residual, 1.0);
                compare(&iterate.constraints, &before.lower, &after.lower, -1.0);
                compare(&iterate.constraints, &before.upper, &after.upper, -1.0);
            }
        });
        println!("seed {SEED}: {compared} motions, off by {:.1e} at most, by forces alone {:.1e}", worst[0], worst[1]);
        assert!(compared > 60 && worst[0] < 1e-6 && worst[1] < 1e-8, "{worst:?} {compared}");
    }

    #[test]
    fn the_size_of_a_program_is_the_largest_sum_of_squares_of_a_column_of_the_jacobian_among_the_rates() {
        StandingAdult::new().each_posture(&mut Pcg64Mcg::new(SEED.into()), 5, |_, problem, iterate| {
            let (n, rates) = (problem.unknowns(), problem.free.len());
            let mut program = QuadraticProgram::default();
            (program.n, program.rates) = (n, rates);
            let size = iterate.write(1.0, &mut program);
            let column = |i: usize| iterate.jacobian.iter().skip(i).step_by(n).map(|entry| entry * entry).sum::<f64>();
            let largest = (0..rates).map(column).fold(0.0, f64::max);
            assert!(largest > 0.0 && (size - largest).abs() < 1e-12 * largest, "{size} for {largest}");
        });
    }
}
