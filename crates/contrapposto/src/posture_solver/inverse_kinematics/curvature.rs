//! How does the reach of a body bend? Second derivatives for goals that cannot be met.
//!
//! Rows of a level are first derivatives. Where a level keeps an error `r`, they are not enough: its best point is that of
//! `L = |r|^2 / 2 + sum lambda . r_above`, with the multipliers of the levels above, and steps that know only `J^T J` creep
//! toward it or swing around it. Here the level is given the rows `R` of the whole second derivative,
//! `R^T R = J^T J + sum r_i r_i'' + sum lambda_i r_i''` (Newton's method on the level, as Pfeiffer, Escande & Rapoport 2018,
//! "Singularity resolution in equality and inequality constrained hierarchical task-space control by adaptive nonlinear
//! least squares", do with another approximation).
//!
//! The sum of second derivatives needs nothing new: pull at every point with the force `r_i` (or `lambda_i`), and how the
//! generalised forces change with the posture is that matrix. It is the gradient of external torque (Eqs. 7, 8).

use super::hold::Hold;
use crate::joint_torques::JointTorques;
use crate::model::Model;
use crate::statics::{ExternalTorque, Gradient, Load};
use crate::tasks::PriorityLevel;
use hierarchical_least_squares::linalg::{SymmetricEigen, add_outer_product, add_scaled, pivoted_cholesky};
use hierarchical_least_squares::{Level, Problem, Solver};

/// Weight of directions that levels above hold fast, against the largest entry of the second derivative: large enough that
/// what is bent there does not matter.
const FAST: f64 = 1e2;
/// Share of the largest diagonal entry below which a direction counts as flat and is left to the levels below.
const FLAT: f64 = 1e-6;
/// Share of the level's error, squared, that a motion must gain where the level bends little (`SOFT`, a share of the largest
/// diagonal entry): long motions for nothing would never come to rest.
const GAIN: f64 = 1e-12;
const SOFT: f64 = 1e-3;

/// Second derivatives of the goals, and who needs them. Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Curvature {
    pulls: ExternalTorque,
    gradient: Gradient,
    loads: Vec<Load>,
    matrix: Vec<f64>,
    factor: Vec<f64>,
    order: Vec<usize>,
    /// How many unknowns of `order` are pivots.
    pivots: usize,
    left: SymmetricEigen,
    /// Axes of what is left, times the root of how they bend.
    axes: Vec<f64>,
    slope: Vec<f64>,
    row: Vec<f64>,
    residual: Vec<f64>,
    hold: Hold,
    /// The level as it was before its rows were replaced.
    level: Level,
}

impl Curvature {
    /// Space for `model` and levels of these goals.
    pub(super) fn new(model: &Model, goals: &[PriorityLevel]) -> Self {
        let n = model.rates().len();
        let rows = goals.iter().map(PriorityLevel::rows).max().unwrap_or(0);
        // A task pulls at two places at most, or at all segments.
        let tasks: usize = goals.iter().map(|goal| goal.tasks.len()).sum();
        Self {
            pulls: ExternalTorque::new(model),
            gradient: Gradient::new(model),
            loads: Vec::with_capacity(tasks * (2 + model.segments().len())),
            matrix: vec![0.0; n * n],
            factor: vec![0.0; n * n],
            order: Vec::with_capacity(n),
            pivots: 0,
            left: SymmetricEigen::new(n),
            axes: Vec::with_capacity(n * n),
            slope: vec![0.0; n],
            row: vec![0.0; n],
            residual: Vec::with_capacity(rows),
            hold: Hold::new(goals.iter().map(PriorityLevel::rows).sum(), n),
            level: Level::with_capacity(rows.max(n) + 3, n),
        }
    }

    /// Replaces the rows of level `k` by those of its second derivative.
    pub(super) fn bend(
        &mut self,
        model: &Model,
        goals: &[PriorityLevel],
        body: &JointTorques,
        problem: &mut Problem,
        solver: &Solver,
        k: usize,
    ) {
        let n = problem.unknowns();
        std::mem::swap(&mut self.level, &mut problem.levels[k]);
        self.residual.clear();
        let missing = |(lower, upper): (&f64, &f64)| -lower.max(0.0) - upper.min(0.0);
        self.residual.extend(self.level.lower.iter().zip(&self.level.upper).map(missing));
        // J^T r and J^T J.
        self.slope.fill(0.0);
        for (row, r) in self.level.matrix.chunks_exact(n).zip(&self.residual) {
            add_scaled(&mut self.slope, *r, row);
        }
        let last = solver.multipliers(k);
        self.hold.estimate(problem, &problem.levels[..k], last, &self.slope);
        self.second_derivative(model, goals, body, k);
        for row in self.level.matrix.chunks_exact(n) {
            add_outer_product(&mut self.matrix, row, 1.0);
        }
        let size = (0..n).fold(0.0, |size: f64, i| size.max(self.matrix[i * n + i].abs()));
        // What is held fast: equations above, and ranges that the level presses against.
        let mut rows = self.hold.multipliers.iter();
        for above in &problem.levels[..k] {
            for (i, row) in above.matrix.chunks_exact(n).enumerate() {
                let multiplier = rows.next().copied().unwrap_or(0.0);
                let square: f64 = row.iter().map(|a| a * a).sum();
                if square > 0.0 && (multiplier != 0.0 || above.lower[i] == above.upper[i]) {
                    add_outer_product(&mut self.matrix, row, FAST * size / square);
                    if above.lower[i] == above.upper[i] {
                        add_scaled(&mut self.slope, multiplier, row);
                    }
                }
            }
        }
        for (i, bound) in last.bounds.iter().enumerate() {
            if *bound != 0.0 {
                self.matrix[i * n + i] += FAST * size;
            }
        }
        self.factorise(n, size);
        let error: f64 = self.residual.iter().map(|r| r * r).sum();
        self.write_rows(n, &mut problem.levels[k], 2.0 * GAIN * error, SOFT * size);
        problem.levels[k].hard = self.level.hard;
    }

    /// `sum r_i r_i'' + sum lambda_i r_i''` into `matrix`.
    fn second_derivative(&mut self, model: &Model, goals: &[PriorityLevel], body: &JointTorques, k: usize) {
        self.loads.clear();
        let mut multipliers = &self.hold.multipliers[..];
        for goal in &goals[..k] {
            for task in &goal.tasks {
                let (own, rest) = multipliers.split_at(task.rows().min(multipliers.len()));
                task.pull(model, own, &mut self.loads);
                multipliers = rest;
            }
            multipliers = &multipliers[goal.half_spaces.len().min(multipliers.len())..];
        }
        let mut residual = &self.residual[..];
        for task in &goals[k].tasks {
            let (own, rest) = residual.split_at(task.rows().min(residual.len()));
            task.pull(model, own, &mut self.loads);
            residual = rest;
        }
        let n = self.slope.len();
        self.matrix.fill(0.0);
        // Loads beyond what the model accepts (errors of 1e9) leave the matrix without them.
        if self.pulls.update_weightless(model, body.kinematics(), &self.loads).is_ok() {
            self.pulls.gradient(model, body.kinematics(), &mut self.gradient);
            for i in 0..n {
                for j in 0..n {
                    self.matrix[i * n + j] = 0.5 * (self.gradient.get(i, j) + self.gradient.get(j, i));
                }
            }
        }
    }

    /// Cholesky factor of the matrix with the largest pivots first, rows in `order`, in place, as far as it bends up. Flat
    /// directions get no row and are left to the levels below.
    fn factorise(&mut self, n: usize, size: f64) {
        let flat = FLAT * size;
        self.factor.copy_from_slice(&self.matrix);
        self.pivots = pivoted_cholesky(&mut self.factor, n, &mut self.order, flat);
        let a = &self.factor;
        // What is left bends down or is flat: its own axes, walked as steeply as they bend.
        self.axes.clear();
        let left = &self.order[self.pivots..];
        if left.is_empty() {
            return;
        }
        self.left.decompose(left.len(), |i, j| a[left[i] * n + left[j]]);
        for (bend, axis) in self.left.iter() {
            if bend.abs() > 10.0 * flat {
                self.axes.extend(axis.iter().map(|x| x * bend.abs().sqrt()));
            }
        }
    }

    /// Rows `R p = -R^-T g`.
    fn write_rows(&mut self, n: usize, level: &mut Level, gain: f64, soft: f64) {
        level.clear();
        let worth = |c: f64, bend: f64| if bend < soft && c * c < gain { 0.0 } else { c };
        for r in 0..self.pivots {
            let p = self.order[r];
            self.row.fill(0.0);
            for &j in &self.order[r..] {
                self.row[j] = self.factor[p * n + j];
            }
            let c = -self.slope[p] / self.row[p];
            add_scaled(&mut self.slope, c, &self.row);
            let c = worth(c, self.row[p] * self.row[p]);
            level.push(&self.row, c, c);
        }
        let left = &self.order[self.pivots..];
        for axis in self.axes.chunks_exact(left.len().max(1)) {
            self.row.fill(0.0);
            let (mut along, mut square) = (0.0, 0.0);
            for (&j, x) in left.iter().zip(axis) {
                self.row[j] = *x;
                along += x * self.slope[j];
                square += x * x;
            }
            // |row|^2 is how much the axis bends; half the right-hand side squared what it would gain.
            let c = worth(-along / square, square);
            level.push(&self.row, c, c);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::joint_torques::Quantities;
    use crate::model::{Adult, adult};
    use crate::tasks::{self, Task};

    /// `sum w_i r_i''` along a direction against second differences of `sum w_i r_i`, where the turns' errors are zero.
    #[test]
    fn second_derivatives_are_those_of_the_errors() {
        let mut random = Pcg64Mcg::new(11);
        let model = adult(&Adult::default()).unwrap();
        let n = model.rates().len();
        let mut worst = 0f64;
        for _ in 0..20 {
            let mut posture = model.default_posture();
            for (value, coordinate) in posture.values_mut().iter_mut().zip(model.coordinates()) {
                *value += random.random_range(-0.3..0.3) * (coordinate.range.1 - coordinate.range.0).min(1.0);
            }
            let mut body = JointTorques::new(&model);
            let needs = Quantities { center_of_mass: true, ..Quantities::default() };
            body.update(&model, &posture, &[], needs).unwrap();
            let hand = model.segment("hand_r").unwrap();
            let foot = model.segment("calcn_l").or_else(|| model.segment("foot_l")).unwrap();
            let tasks = [
                Task::Point(tasks::Point {
                    segment: hand,
                    point: Vector3::new(0.01, -0.1, 0.02),
                    target: Vector3::new(1.0, 2.0, 0.5),
                    axes: [true, false, true],
                }),
                Task::Placement(tasks::Placement {
                    segment: foot,
                    point: Vector3::zeros(),
                    target: body.kinematics().placement(&model, foot),
                }),
                Task::CenterOfMass(tasks::CenterOfMass {
                    goal: tasks::CenterOfMassGoal::At { target: Vector3::zeros(), axes: [true, false, true] },
                }),
                Task::Orientation(tasks::Orientation {
                    segment: hand,
                    target: UnitQuaternion::from(body.kinematics().placement(&model, hand).rotation),
                }),
            ];
            let goals: Vec<PriorityLevel> = vec![PriorityLevel { tasks: tasks.to_vec(), ..PriorityLevel::default() }];
            let mut curvature = Curvature::new(&model, &goals);
            curvature.residual =
                (0..tasks.iter().map(Task::rows).sum()).map(|_| random.random_range(-1.0..1.0)).collect();
            let direction: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut along = |h: f64| {
                let mut moved = posture.clone();
                moved.displace(&model, &direction.iter().map(|d| d * h).collect::<Vec<_>>());
                body.update(&model, &moved, &[], needs).unwrap();
                let mut errors = vec![];
                tasks.iter().for_each(|task| task.residual(&model, &body, &mut errors));
                errors.iter().zip(&curvature.residual).map(|(e, w)| e * w).sum::<f64>()
            };
            let h = 1e-3;
            let (a, c, b) = (along(-h), along(h), along(0.0));
            let numeric = (a - 2.0 * b + c) / (h * h);
            curvature.second_derivative(&model, &goals, &body, 0);
            let exact: f64 = (0..n)
                .map(|i| (0..n).map(|j| direction[i] * curvature.matrix[i * n + j] * direction[j]).sum::<f64>())
                .sum();
            worst = worst.max((numeric - exact).abs() / (1.0 + exact.abs()));
        }
        assert!(worst < 1e-4, "{worst}");
    }
}
