//! How does effort bend? The second derivative of the Lagrangian of a least-effort posture.
//!
//! `L = |e|^2/2 + sum y_r c_r` with the errors `c_r` of all rows above and their multipliers. Its second derivative is `J^T J`,
//! what the tasks above add (`sum y_r c_r''`, the gradient of external torque under pulls, see [`Task::pull`]), and
//! `sum_i w_i tau_i''` with `w_i = -e_i / S_i` for muscles and `w_r = y_r` for the root's equilibrium. External torque, contact
//! forces included, is the gradient of a potential, whose third derivatives are symmetric: so the last sum is how the gradient
//! matrix changes when the body moves along `w`, and one difference of two gradients gives all of it. Where laws have no
//! potential, for the change of strength with angle, and for contact forces (of which effort is a quadratic function, found
//! anew in every posture: Kaufman 1975, "A variable projection method for solving separable nonlinear least squares problems")
//! the first derivatives alone count; that costs steps, not exactness.

use nalgebra::Vector3;

use crate::ik::Goal;
use crate::ik::body::{Body, Needs};
use crate::math::lexicographic::{Level, Problem, add_scaled, add_square};
use crate::model::Model;
use crate::passive::PassiveLaw;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load};

/// How far the body moves along `w` for the difference, rad or m.
const MOVE: f64 = 1e-4;
/// Weight of rows above, against the largest diagonal entry: what levels above hold fast must not look as if it bent down.
const FAST: f64 = 10.0;
/// Share of the largest diagonal entry below which a direction counts as flat and is left to the levels below.
const FLAT: f64 = 1e-9;

/// Second derivatives, and rows made of them. Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Curvature {
    weightless: Model,
    pulls: ExternalTorque,
    gradient: Gradient,
    loads: Vec<Load>,
    moved: Posture,
    body: Body,
    /// `w`, by rate.
    weights: Vec<f64>,
    step: Vec<f64>,
    matrix: Vec<f64>,
    factor: Vec<f64>,
    /// What is added to the diagonal of the posture.
    shift: f64,
    slope: Vec<f64>,
    row: Vec<f64>,
    level: Level,
}

impl Curvature {
    /// Space for `model` and so many unknowns.
    pub(super) fn new(model: &Model, unknowns: usize) -> Self {
        let n = model.rates().len();
        Self {
            weightless: model.clone().with_gravity(Vector3::zeros()),
            pulls: ExternalTorque::new(model),
            gradient: Gradient::new(model),
            loads: vec![],
            moved: model.default_posture(),
            body: Body::new(model),
            weights: vec![0.0; n],
            step: vec![0.0; n],
            matrix: vec![0.0; unknowns * unknowns],
            factor: vec![0.0; unknowns * unknowns],
            shift: 0.0,
            slope: vec![0.0; unknowns],
            row: vec![0.0; unknowns],
            level: Level::default(),
        }
    }

    /// Replaces the rows of the effort level `k` by those of the whole second derivative. `weights` of the root's rates and
    /// of working coordinates must stand in [`Curvature::weights`]; `goals` are those of the levels above, each with the
    /// multipliers of its tasks' rows.
    pub(super) fn bend<'g>(
        &mut self,
        model: &Model,
        body: &Body,
        loads: &[Load],
        goals: impl Iterator<Item = (&'g Goal, &'g [f64])>,
        problem: &mut Problem,
        k: usize,
    ) {
        let m = problem.unknowns();
        self.matrix.fill(0.0);
        self.bend_of_tasks(body, goals, m);
        self.bend_of_torques(model, body, loads, m);
        self.level.clone_from(&problem.levels[k]);
        self.slope.fill(0.0);
        for (row, upper) in self.level.matrix.chunks_exact(m).zip(&self.level.upper) {
            add_square(&mut self.matrix, row, 1.0);
            add_scaled(&mut self.slope, -upper, row);
        }
        let size = (0..m).fold(0.0, |size: f64, i| size.max(self.matrix[i * m + i].abs()));
        for above in &problem.levels[..k] {
            for (i, row) in above.matrix.chunks_exact(m).enumerate().filter(|(i, _)| above.lower[*i] == above.upper[*i])
            {
                let square: f64 = row.iter().map(|a| a * a).sum();
                if square > 0.0 {
                    let weight = FAST * size / square;
                    add_square(&mut self.matrix, row, weight);
                    add_scaled(&mut self.slope, -weight * above.upper[i], row);
                }
            }
        }
        self.factorise(m, &mut problem.levels[k]);
        problem.levels[k].hard = self.level.hard;
    }

    /// `w` of [`Curvature::bend`], to be filled.
    pub(super) fn weights(&mut self) -> &mut [f64] {
        &mut self.weights
    }

    fn bend_of_tasks<'g>(&mut self, body: &Body, goals: impl Iterator<Item = (&'g Goal, &'g [f64])>, m: usize) {
        self.loads.clear();
        for (goal, mut multipliers) in goals {
            for task in &goal.tasks {
                if multipliers.len() < task.rows() {
                    break;
                }
                let (own, rest) = multipliers.split_at(task.rows());
                task.pull(&self.weightless, own, &mut self.loads);
                multipliers = rest;
            }
        }
        let n = self.weights.len();
        // Loads beyond what the model accepts leave the matrix without them.
        if self.pulls.update(&self.weightless, body.kinematics(), &self.loads).is_ok() {
            self.pulls.gradient(&self.weightless, body.kinematics(), &mut self.gradient);
            for i in 0..n {
                for j in 0..n {
                    self.matrix[i * m + j] += 0.5 * (self.gradient.get(i, j) + self.gradient.get(j, i));
                }
            }
        }
    }

    fn bend_of_torques(&mut self, model: &Model, body: &Body, loads: &[Load], m: usize) {
        let n = self.weights.len();
        let size = self.weights.iter().fold(0.0, |size: f64, w| size.max(w.abs()));
        if size.is_nan() || size <= 0.0 {
            return;
        }
        for sign in [1.0, -1.0] {
            let h = sign * MOVE / size;
            for (step, w) in self.step.iter_mut().zip(&self.weights) {
                *step = h * w;
            }
            self.moved.values_mut().copy_from_slice(body.posture().values());
            self.moved.displace(model, &self.step);
            let needs = Needs { torque: true, center_of_mass: false };
            if self.body.update(model, &self.moved, loads, needs).is_err() {
                continue;
            }
            let share = 0.5 / h;
            for i in 0..n {
                for (j, slope) in self.body.gradient().row(i).iter().enumerate() {
                    self.matrix[i * m + j] += 0.5 * share * slope;
                    self.matrix[j * m + i] += 0.5 * share * slope;
                }
            }
        }
        for (c, coordinate) in model.coordinates().iter().enumerate() {
            let (Some(rate), Some(PassiveLaw::Curve(curve))) = (coordinate.rate, &coordinate.passive) else { continue };
            let q = body.kinematics().values()[c];
            let slope = |h: f64| curve.torque_and_slope(q + h).1;
            self.matrix[rate * m + rate] += self.weights[rate] * (slope(MOVE) - slope(-MOVE)) / (2.0 * MOVE);
        }
    }

    /// Rows `R p = -R^-T g` with `R^T R` the matrix, and as much on the diagonal of the posture as makes it positive, `shift`
    /// at least.
    fn factorise(&mut self, m: usize, level: &mut Level) {
        let n = self.weights.len();
        let largest =
            |range: std::ops::Range<usize>| range.fold(0.0, |most: f64, i| most.max(self.matrix[i * m + i].abs()));
        let (posture, forces) = (largest(0..n), largest(n..m));
        let most = 10.0 * posture.max(1e-12);
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

/// Replaces the upper triangle by `R` with `R^T R` the matrix; `false` where it is not positive.
fn cholesky(a: &mut [f64], m: usize) -> bool {
    for r in 0..m {
        let (upper, lower) = a.split_at_mut((r + 1) * m);
        let row = &mut upper[r * m..];
        if row[r].is_nan() || row[r] <= 0.0 {
            return false;
        }
        let root = row[r].sqrt();
        row[r..].iter_mut().for_each(|entry| *entry /= root);
        for (i, target) in lower.chunks_exact_mut(m).enumerate() {
            let i = r + 1 + i;
            let factor = row[i];
            if factor != 0.0 {
                target[i..].iter_mut().zip(&row[i..]).for_each(|(entry, by)| *entry -= factor * by);
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::ik::task::{Point, Task};
    use crate::model::{Adult, adult};
    use crate::statics::{FixedIn, LoadKind};

    /// The matrix along a direction against second differences of a weighted sum of torques and errors.
    #[test]
    fn the_second_derivative_is_that_of_the_lagrangian() {
        let mut random = Pcg64Mcg::new(5);
        let mut model = adult(&Adult::default()).unwrap();
        for i in 0..model.coordinates().len() {
            if matches!(model.coordinates()[i].passive, Some(PassiveLaw::Coupled(_))) {
                model = model.with_passive_law(i, None);
            }
        }
        let n = model.rates().len();
        let (hand, foot) = (model.segment("hand_r").unwrap(), model.segment("calcn_r").unwrap());
        let push = Vector3::new(100.0, 700.0, -50.0);
        let kind = LoadKind::Force(push, FixedIn::World);
        let loads = [Load { segment: foot, point: Vector3::new(0.1, -0.05, 0.02), kind }];
        let mut worst = 0f64;
        for _ in 0..20 {
            let mut posture = model.default_posture();
            for (value, coordinate) in posture.values_mut().iter_mut().zip(model.coordinates()) {
                *value += random.random_range(-0.3..0.3) * (coordinate.range.1 - coordinate.range.0).min(1.0);
            }
            let mut random = |k: usize| (0..k).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
            let (weights, pull, turn) = (random(n), random(3), random(n));
            let task = Task::Point(Point {
                segment: hand,
                point: Vector3::new(0.01, -0.1, 0.02),
                target: Vector3::zeros(),
                axes: [true; 3],
            });
            let goal: Goal = task.clone().into();
            // Sum of weighted torques and errors, linear in both: its second derivative is what the sums of both add up to.
            let mut body = Body::new(&model);
            let needs = Needs { torque: true, center_of_mass: true };
            let mut along = |h: f64| {
                let mut moved = posture.clone();
                moved.displace(&model, &turn.iter().map(|d| d * h).collect::<Vec<_>>());
                body.update(&model, &moved, &loads, needs).unwrap();
                let mut errors = vec![];
                task.residual(&model, &body, &mut errors);
                let mut sum: f64 = errors.iter().zip(&pull).map(|(e, w)| e * w).sum();
                for (c, coordinate) in model.coordinates().iter().enumerate() {
                    let passive = coordinate.passive.as_ref().map_or(0.0, |law| law.torque(c, moved.values()));
                    let rate = coordinate.rate.unwrap();
                    sum += weights[rate] * (body.external_torque().torques()[rate] + passive);
                }
                sum
            };
            let h = 3e-4;
            let (a, b, c) = (along(-h), along(h), along(0.0));
            let numeric = (a + b - 2.0 * c) / (h * h);
            let mut curvature = Curvature::new(&model, n);
            curvature.weights().copy_from_slice(&weights);
            curvature.bend_of_tasks(&body, std::iter::once((&goal, &pull[..])), n);
            curvature.bend_of_torques(&model, &body, &loads, n);
            let exact: f64 = (0..n * n).map(|e| turn[e / n] * curvature.matrix[e] * turn[e % n]).sum();
            worst = worst.max((numeric - exact).abs() / (1.0 + exact.abs()));
        }
        assert!(worst < 1e-4, "{worst}");
    }
}
