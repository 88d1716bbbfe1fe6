//! Computes the second derivative of the Lagrangian of a problem of least effort, by posture and contact forces.
//!
//! `L = 1/2 |r|^2 + sum_k y_k c_k` with the relative loads `r`, the errors `c_k` of all constraints and their multipliers `y_k`.
//! Beyond `J^T J` its second derivative has `sum_k y_k c_k''` of the tasks ([`ErrorHessian`]) and `sum_i w_i tau_i''` with
//! `w_i = -r_i / S_i` for muscles and `w_k = y_k / W` for the root's equilibrium, whose rows are shares of body weight `W`.
//! External torque about axes is the derivative of a potential by rotations about them: that sum is the change of the gradient
//! matrix when the body moves along `w`, and its mixed part is the change of the torques of each contact force, since these too are
//! derivatives of a potential, both with the terms of rotations that do not commute ([`SecondByAxes`]). One difference gives both.
//! Passive laws, of the angles about axes, and strength that changes with an angle have closed forms but for the third derivatives of
//! those angles, which are a difference along `w`, too.
//!
//! Exploratory solves omit forces, coupled laws and strength ([`HessianModel::Partial`]), to escape shallow minima.
//!
//! Forces that cancel each other within one support do no work while it stays; their mixed part lies in the motions that turn the
//! support. These are projected out of the mixed part, which changes only the multipliers of the supports: otherwise the matrix
//! would have negative curvature in directions in which no step may go.

use super::passive_hessian::add_passive;
use super::problem::EffortProblem;
use super::second_by_axes::{SecondByAxes, rates, turned_axes};
use super::tolerances::{DIFFERENCE_STEP, INDEPENDENT_ROW};
use crate::joint_torques::{AboutAxes, JointTorques};
use crate::model::{Model, Side};
use crate::statics::{Gradient, Load};
use crate::tasks::{ErrorHessian, Task, for_each_angle_slope, share_of_strength};
use hierarchical_least_squares::linalg::{add_scaled, dot};

/// Body, loads and first derivatives at the iterate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstOrder<'a> {
    pub(crate) body: &'a JointTorques,
    /// Loads of the scenario, then one a corner.
    pub(crate) loads: &'a [Load],
    /// As [`crate::contact::ContactForces::columns`].
    pub(crate) columns: &'a [f64],
    /// Relative loads, and their derivatives by the unknowns, row after row.
    pub(crate) residual: &'a [f64],
    pub(crate) jacobian: &'a [f64],
    /// Rows of the supports' placements over the unknowns.
    pub(crate) support_rows: &'a [f64],
}

/// Terms of the second derivative that count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HessianModel {
    /// All; only the passive laws of dependent coordinates are left out.
    Full,
    /// Tasks, weight, loads, and passive torque of single joints.
    Partial,
}

/// Workspace of the second derivative.
#[derive(Clone, Debug)]
pub(crate) struct Hessian {
    errors: ErrorHessian,
    /// The body moved along `w`.
    moved: AboutAxes,
    /// `w`, by rate.
    weights: Vec<f64>,
    step: Vec<f64>,
    columns: Vec<f64>,
    jacobian: Vec<f64>,
    basis: Vec<f64>,
    mixed: Vec<f64>,
    row: Vec<f64>,
    by_axes: SecondByAxes,
}

impl Hessian {
    pub(crate) fn new(model: &Model) -> Self {
        let n = model.rates().len();
        Self {
            errors: ErrorHessian::new(model, std::iter::empty()),
            moved: AboutAxes::new(model),
            weights: vec![0.0; n],
            step: vec![0.0; n],
            columns: vec![],
            jacobian: vec![0.0; 3 * n],
            basis: vec![],
            mixed: vec![],
            row: vec![0.0; n],
            by_axes: SecondByAxes::new(n),
        }
    }

    /// Adds to the upper triangle of `matrix` the terms beyond `J^T J`, with the multipliers of the root's equilibrium and of the
    /// constraint levels.
    pub(crate) fn add_second_derivative(
        &mut self,
        problem: &EffortProblem<'_>,
        at: &FirstOrder<'_>,
        multipliers: &[f64],
        terms: HessianModel,
        matrix: &mut [f64],
    ) {
        self.weigh(problem, at, multipliers);
        self.add_tasks(problem, at, multipliers, matrix);
        self.by_axes.clear();
        self.add_gradient_about_axes(problem, at);
        let moved = self.add_torques(problem, at);
        add_passive(problem.model, at.body, &self.weights, terms == HessianModel::Full, &mut self.by_axes);
        if terms == HessianModel::Full {
            if let Some(moved) = moved {
                self.add_forces(problem, at, moved, matrix);
            }
            self.add_strength(problem, at, matrix);
        }
        self.by_axes.fold(problem.model, at.body);
        self.by_axes.add_to(problem.free, problem.unknowns(), matrix);
    }

    /// Sets `w`.
    fn weigh(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>, multipliers: &[f64]) {
        self.weights.fill(0.0);
        for (rate, y) in problem.contact.root().iter().zip(multipliers) {
            self.weights[*rate] = y / problem.contact.weight();
        }
        for (coordinate, rate, residual, _) in relative_loads(problem, at) {
            self.weights[rate] = -residual * share_of_strength(problem.model, at.body, coordinate, residual);
        }
    }

    /// Adds `sum_k y_k c_k''` of the tasks.
    fn add_tasks(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>, multipliers: &[f64], matrix: &mut [f64]) {
        let Some(mut multipliers) = multipliers.get(problem.contact.root().len()..) else { return };
        self.errors.clear();
        for task in problem.constraint_levels().flat_map(|level| &level.tasks) {
            let Some((own, rest)) = multipliers.split_at_checked(task.rows()) else { return };
            self.errors.add(problem.model, at.body.kinematics(), task, own);
            multipliers = rest;
        }
        if let Some(hessian) = self.errors.evaluate(problem.model, at.body.kinematics()) {
            add_gradient(problem, hessian, matrix);
        }
    }

    /// Adds `E_l sum_i w_i (tau_e,i + tau_p,i)` at the axes of three-axis joints.
    fn add_gradient_about_axes(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>) {
        let model = problem.model;
        if model.three_axis_joints().is_empty() {
            return;
        }
        for (rate, weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            self.row.fill(0.0);
            if let Some(coordinate) = model.rates()[rate].coordinate {
                let body = at.body;
                body.passive_torque().add_row_about_axis(model, body.kinematics(), coordinate, &mut self.row);
            }
            add_scaled(&mut self.by_axes.gradient, *weight, &self.row);
            add_scaled(&mut self.by_axes.gradient, *weight, at.body.gradient_about_axes().row(rate));
        }
    }

    /// Adds the change of the torque gradient along `w`; returns how far along `w` the body has moved for the difference.
    fn add_torques(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>) -> Option<f64> {
        let model = problem.model;
        let size = self.weights.iter().fold(0.0, |size: f64, w| size.max(w.abs()));
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        let h = DIFFERENCE_STEP / size;
        self.step.iter_mut().zip(&self.weights).for_each(|(step, w)| *step = h * w);
        self.moved.update_displaced(model, at.body.posture(), &self.step, at.loads).ok()?;
        let (now, after) = (at.body.gradient_about_axes(), self.moved.gradient());
        self.by_axes.add_along(model, &self.weights, h, |row| now.row(row), |row| after.row(row));
        Some(h)
    }

    /// Adds `(J^T k + k^T J) r - r^2 S''/S` at each joint whose strength `S` changes with the angle `x` about its axis, where `J` is
    /// the row of the relative load `r` and `k = -S'/S`; derivatives by the posture are those by the angle times `dx/dq`, and
    /// `- r^2 (S'/S) x''`.
    fn add_strength(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>, matrix: &mut [f64]) {
        let (model, n) = (problem.model, problem.unknowns());
        for (coordinate, _, residual, row) in relative_loads(problem, at) {
            let Some(groups) = &model.coordinates()[coordinate].groups else { continue };
            let strength = &groups[Side::of(residual).index()].strength;
            let angle = at.body.angles()[coordinate];
            let ((torque, slope), curvature) = (strength.torque_and_slope(angle), strength.curvature(angle));
            if slope == 0.0 && curvature == 0.0 {
                continue;
            }
            self.add_second_of_angle(model, at.body, coordinate, -residual * residual * slope / torque);
            self.row.fill(0.0);
            for_each_angle_slope(model, at.body, coordinate, |rate, slope| self.row[rate] = slope);
            at.body.fold_axes(model, &mut self.row);
            let by = -residual * slope / torque;
            for (own, rate) in problem.free.iter().enumerate().filter(|(_, rate)| self.row[**rate] != 0.0) {
                let share = self.row[*rate];
                for (other, entry) in row.iter().enumerate() {
                    let twice = if other == own { 2.0 } else { 1.0 };
                    matrix[own.min(other) * n + own.max(other)] += twice * by * share * entry;
                }
                for (other, rate) in problem.free.iter().enumerate().skip(own) {
                    matrix[own * n + other] -= residual * residual * curvature / torque * share * self.row[*rate];
                }
            }
        }
    }

    /// Adds `share` times the second derivative of the angle about the axis of a coordinate.
    fn add_second_of_angle(&mut self, model: &Model, body: &JointTorques, coordinate: usize, share: f64) {
        let Some((joint, place)) = model.three_axis_joint_of(coordinate) else { return };
        let angles = &body.passive_torque().orientations()[joint].angles;
        let rates = rates(model, &model.three_axis_joints()[joint]);
        for (m, by) in rates.into_iter().enumerate() {
            self.by_axes.gradient[by] += share * angles.first[(place, m)];
            for (l, other) in rates.into_iter().enumerate() {
                self.by_axes.add(by, other, share * angles.second[place][(m, l)]);
            }
        }
    }

    /// Adds the mixed second derivatives of posture and contact forces.
    fn add_forces(&mut self, problem: &EffortProblem<'_>, at: &FirstOrder<'_>, h: f64, matrix: &mut [f64]) {
        if at.columns.is_empty() {
            return;
        }
        let (model, n, k) = (problem.model, problem.unknowns(), problem.free.len());
        problem.contact_columns(self.moved.kinematics(), &mut self.jacobian, &mut self.columns);
        self.basis.clear();
        self.mixed.resize(k, 0.0);
        for row in at.support_rows.chunks_exact(n) {
            let row = &row[..k];
            self.mixed.copy_from_slice(row);
            project_out(&mut self.mixed, &self.basis);
            let left = dot(&self.mixed, &self.mixed).sqrt();
            if left > INDEPENDENT_ROW * dot(row, row).sqrt() {
                self.basis.extend(self.mixed.iter().map(|entry| entry / left));
            }
        }
        let rates_of_body = model.rates().len();
        let columns = self.columns.chunks_exact(rates_of_body).zip(at.columns.chunks_exact(rates_of_body));
        for (force, (to, from)) in columns.enumerate() {
            self.row.iter_mut().zip(to.iter().zip(from)).for_each(|(entry, (to, from))| *entry = (to - from) / h);
            for joint in model.three_axis_joints() {
                let (rates, turned) = (rates(model, joint), turned_axes(model, joint, &self.weights));
                for (m, by) in rates.into_iter().enumerate() {
                    self.row[by] += (0..3).map(|n| turned[(m, n)] * from[rates[n]]).sum::<f64>();
                }
            }
            at.body.fold_axes(model, &mut self.row);
            self.mixed.iter_mut().zip(problem.free).for_each(|(entry, rate)| *entry = self.row[*rate]);
            project_out(&mut self.mixed, &self.basis);
            for (i, entry) in self.mixed.iter().enumerate() {
                matrix[i * n + k + force] += entry;
            }
        }
    }
}

/// Adds the symmetric part of a gradient.
fn add_gradient(problem: &EffortProblem<'_>, of: &Gradient, matrix: &mut [f64]) {
    let n = problem.unknowns();
    for (i, &a) in problem.free.iter().enumerate() {
        let row = of.row(a);
        let to = &mut matrix[i * n + i..i * n + problem.free.len()];
        for (entry, &b) in to.iter_mut().zip(&problem.free[i..]) {
            *entry += if of.is_symmetric() { row[b] } else { 0.5 * (row[b] + of.get(b, a)) };
        }
    }
}

/// Every effort coordinate with its rate, its relative load and the row of the Jacobian.
fn relative_loads<'a>(
    problem: &'a EffortProblem<'_>,
    at: &FirstOrder<'a>,
) -> impl Iterator<Item = (usize, usize, f64, &'a [f64])> {
    let effort =
        problem.effort.tasks.iter().map_while(|task| if let Task::Effort(effort) = task { Some(effort) } else { None });
    let rows = at.residual.iter().zip(at.jacobian.chunks_exact(problem.unknowns()));
    let coordinates = effort.flat_map(|effort| &effort.coordinates).zip(rows);
    coordinates.filter_map(|(&c, (residual, row))| Some((c, problem.model.coordinates()[c].rate?, *residual, row)))
}

/// Projects the rows of an orthonormal basis out of `v`.
fn project_out(v: &mut [f64], basis: &[f64]) {
    for row in basis.chunks_exact(v.len()) {
        let along = dot(row, v);
        add_scaled(v, -along, row);
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::iterate::Iterate;
    use super::super::qp::QuadraticProgram;
    use super::super::standing_adult::{StandingAdult, displaced, same_groups};
    use super::*;
    use crate::tasks::PriorityLevel;

    const SEED: u64 = 23;
    /// Step of the second difference, rad, m or body weights.
    const STEP: f64 = 2e-4;

    /// The matrix along random motions that leave the feet in place is the second difference of the Lagrangian, relative to the
    /// terms beyond `J^T J`.
    #[test]
    fn matrix_along_random_motions_is_the_second_difference_of_the_lagrangian() {
        let adult = StandingAdult::new();
        let mut hessian = Hessian::new(&adult.model);
        let (mut worst, mut compared) = (0f64, 0);
        adult.each_posture(&mut Pcg64Mcg::new(SEED.into()), 40, |random, problem, iterate| {
            let (n, k, root) = (problem.unknowns(), problem.free.len(), problem.contact.root().len());
            let multipliers: Vec<f64> = iterate.lower.iter().map(|_| random.random_range(-0.3..0.3)).collect();
            let mut direction: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut basis: Vec<f64> = vec![];
            for row in iterate.constraints.chunks_exact(n).skip(root).take(problem.places.rows()) {
                let mut row = row[..k].to_vec();
                project_out(&mut row, &basis);
                let length = dot(&row, &row).sqrt();
                basis.extend(row.iter().map(|entry| entry / length));
            }
            project_out(&mut direction[..k], &basis);

            let mut program = QuadraticProgram::default();
            (program.n, program.rates) = (n, k);
            iterate.write(1.0, &mut program);
            let along = |matrix: &[f64]| -> f64 {
                let upper = |i: usize, j: usize| matrix[i.min(j) * n + i.max(j)];
                (0..n * n).map(|e| direction[e / n] * upper(e / n, e % n) * direction[e % n]).sum()
            };
            let squares = along(&program.matrix);
            hessian.add_second_derivative(
                problem,
                &iterate.first_order(problem),
                &multipliers,
                HessianModel::Full,
                &mut program.matrix,
            );
            let exact = along(&program.matrix);

            let equations = root + problem.constraint_levels().map(PriorityLevel::rows).sum::<usize>();
            let lagrangian = |at: &Iterate| {
                let rows = multipliers.iter().zip(&at.lower).take(equations);
                at.objective - rows.map(|(y, rest)| y * rest).sum::<f64>()
            };
            let [before, after] = [-STEP, STEP].map(|h| displaced(iterate, problem, &direction, h));
            if same_groups(iterate, &before) && same_groups(iterate, &after) {
                let numeric = (lagrangian(&before) + lagrangian(&after) - 2.0 * lagrangian(iterate)) / (STEP * STEP);
                worst = worst.max((numeric - exact).abs() / (1.0 + (numeric - squares).abs()));
                compared += 1;
            }
        });
        println!("seed {SEED}: {compared} postures, off by {worst:.1e} at most");
        assert!(compared > 20 && worst < 1e-4, "{worst} {compared}");
    }
}
