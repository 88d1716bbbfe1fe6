//! How does effort bend along posture and contact forces? The second derivative of the Lagrangian of a least-effort posture.
//!
//! `L = |e|^2/2 + sum y_r c_r` with the errors `c_r` of all rows above and their multipliers. Beside `J^T J` its second
//! derivative has what the tasks above add (`sum y_r c_r''`, the gradient of external torque under pulls, see [`Task::pull`])
//! and `sum_i w_i tau_i''` with `w_i = -e_i / S_i` for muscles and `w_r = y_r` for the root's equilibrium. External torque is the
//! gradient of a potential, whose third derivatives are symmetric: so that sum is how the gradient matrix changes when the body
//! moves along `w`, and its mixed part how the torques of each force change, since these too are gradients of a potential (the
//! work of a force fixed in the ground). One difference gives both. Coupled laws, which have no potential, and strength that
//! changes with the angle have closed forms of their own.
//!
//! Scouts that look for valleys are to pass over dips (an arm that balances overhead costs no muscle anything): they know of
//! tasks, weight, loads and single joints' passive torque only ([`HessianModel::Partial`]).
//!
//! Forces that cancel each other within one support do no work while it stays; their mixed part lies in the motions that turn
//! the support. These are taken out of the mixed part, which changes the multipliers of the supports and nothing else: else the
//! matrix would bend down where no step may go.

use super::problem::{EffortProblem, contact_columns};
use crate::model::{Model, Side};
use crate::passive::PassiveLaw;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load};
use crate::tasks::body::{Body, Needs};
use crate::tasks::{Task, share_of_strength};
use hierarchical_least_squares::linalg::{add_scaled, dot};

/// How far the body moves along `w` for the difference, rad or m.
const MOVE: f64 = 1e-5;
/// The same for passive torque.
const MOVE_JOINT: f64 = 1e-4;
/// What is left of a row, relative to it, when it says nothing new.
const NEW: f64 = 1e-6;

/// What is known of the posture and the forces in which effort bends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstOrder<'a> {
    pub(crate) body: &'a Body,
    /// Loads of the scenario, then one a corner.
    pub(crate) loads: &'a [Load],
    /// As [`crate::contact::ContactForces::columns`].
    pub(crate) columns: &'a [f64],
    /// Errors of the effort level, and their rows over the unknowns.
    pub(crate) errors: &'a [f64],
    pub(crate) slopes: &'a [f64],
    /// Rows of the supports' places over the unknowns.
    pub(crate) places: &'a [f64],
}

/// How much of that is to be seen?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HessianModel {
    /// All.
    Full,
    /// Tasks, weight, loads and single joints.
    Partial,
}

/// Keeps its space.
#[derive(Clone, Debug)]
pub(crate) struct Hessian {
    pulls: ExternalTorque,
    gradient: Gradient,
    loads: Vec<Load>,
    moved: Posture,
    body: Body,
    /// `w`, by rate.
    weights: Vec<f64>,
    step: Vec<f64>,
    columns: Vec<f64>,
    jacobian: Vec<f64>,
    basis: Vec<f64>,
    mixed: Vec<f64>,
}

impl Hessian {
    pub(crate) fn new(model: &Model) -> Self {
        let n = model.rates().len();
        Self {
            pulls: ExternalTorque::new(model),
            gradient: Gradient::new(model),
            loads: vec![],
            moved: model.default_posture(),
            body: Body::new(model),
            weights: vec![0.0; n],
            step: vec![0.0; n],
            columns: vec![],
            jacobian: vec![0.0; 3 * n],
            basis: vec![],
            mixed: vec![],
        }
    }

    /// Adds to the upper triangle of `matrix` what goes beyond first derivatives, with the multipliers of the root's equilibrium
    /// and of the tasks above effort.
    pub(crate) fn bend(
        &mut self,
        ask: &EffortProblem<'_>,
        at: &FirstOrder<'_>,
        multipliers: &[f64],
        sight: HessianModel,
        matrix: &mut [f64],
    ) {
        self.weigh(ask, at, multipliers);
        self.bend_of_tasks(ask, at, multipliers, matrix);
        let moved = self.bend_of_torques(ask, at, matrix);
        self.bend_of_passive(ask, at, matrix);
        if sight == HessianModel::Full {
            if let Some(moved) = moved {
                self.bend_of_forces(ask, at, moved, matrix);
            }
            self.bend_of_coupled(ask, at, matrix);
            self.bend_of_strength(ask, at, matrix);
        }
    }

    fn weigh(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, multipliers: &[f64]) {
        self.weights.fill(0.0);
        for (rate, y) in ask.contact.root().iter().zip(multipliers) {
            self.weights[*rate] = y / ask.contact.weight();
        }
        for (coordinate, rate, error, _) in efforts(ask, at) {
            self.weights[rate] = -error * share_of_strength(ask.model, at.body, coordinate, error);
        }
    }

    fn bend_of_tasks(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, multipliers: &[f64], matrix: &mut [f64]) {
        let Some(mut multipliers) = multipliers.get(ask.contact.root().len()..) else { return };
        self.loads.clear();
        for task in ask.goals().flat_map(|goal| &goal.tasks) {
            let Some((own, rest)) = multipliers.split_at_checked(task.rows()) else { return };
            task.pull(ask.model, own, &mut self.loads);
            multipliers = rest;
        }
        // Loads beyond what the model accepts leave the matrix without them.
        if self.pulls.update_weightless(ask.model, at.body.kinematics(), &self.loads).is_err() {
            return;
        }
        self.pulls.gradient(ask.model, at.body.kinematics(), &mut self.gradient);
        add_gradient(ask, 1.0, &self.gradient, None, matrix);
    }

    /// Gives how far along `w` the body has moved for it.
    fn bend_of_torques(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, matrix: &mut [f64]) -> Option<f64> {
        let model = ask.model;
        let size = self.weights.iter().fold(0.0, |size: f64, w| size.max(w.abs()));
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        let h = MOVE / size;
        self.step.iter_mut().zip(&self.weights).for_each(|(step, w)| *step = h * w);
        self.moved.values_mut().copy_from_slice(at.body.posture().values());
        self.moved.displace(model, &self.step);
        let needs = Needs { torque: true, center_of_mass: false };
        if self.body.update(model, &self.moved, at.loads, needs).is_err() {
            return None;
        }
        add_gradient(ask, 1.0 / h, self.body.gradient(), Some(at.body.gradient()), matrix);
        Some(h)
    }

    /// `sum_i w_i tau_p,i''` of joints whose passive torque depends on their own angle.
    fn bend_of_passive(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, matrix: &mut [f64]) {
        let (model, n, values) = (ask.model, ask.unknowns(), at.body.kinematics().values());
        for (i, &rate) in ask.free.iter().enumerate() {
            let Some(own) = model.rates()[rate].coordinate else { continue };
            let slope = |slope: &dyn Fn(f64) -> f64| {
                (slope(values[own] + MOVE_JOINT) - slope(values[own] - MOVE_JOINT)) / (2.0 * MOVE_JOINT)
            };
            let bend = match &model.coordinates()[own].passive {
                Some(PassiveLaw::Curve(curve)) => slope(&|q| curve.torque_and_slope(q).1),
                Some(PassiveLaw::Sum(terms)) => slope(&|q| terms.iter().map(|term| term.torque_and_slope(q).1).sum()),
                _ => 0.0,
            };
            matrix[i * n + i] += self.weights[rate] * bend;
        }
    }

    /// The same of coupled laws.
    fn bend_of_coupled(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, matrix: &mut [f64]) {
        let (model, n, values) = (ask.model, ask.unknowns(), at.body.kinematics().values());
        for (own, coordinate) in model.coordinates().iter().enumerate() {
            let (Some(PassiveLaw::Coupled(law)), Some(rate)) = (&coordinate.passive, coordinate.rate) else { continue };
            if model.is_dependent(own) {
                continue;
            }
            let places = law.neighbours.map(|n| {
                let rate = model.coordinates()[n?.0].rate?;
                ask.free.iter().position(|free| *free == rate)
            });
            for (a, row) in places.into_iter().zip(law.curvature(values)) {
                for (b, entry) in places.into_iter().zip(row) {
                    if let (Some(a), Some(b)) = (a, b)
                        && a <= b
                    {
                        matrix[a * n + b] += self.weights[rate] * entry;
                    }
                }
            }
        }
    }

    /// Strength changes with the angle. With `e = tau_a / S` this adds `(J^T k + k^T J) e - e^2 S''/S` at the joint, where `J` is
    /// the row of `e` and `k = -S'/S`.
    fn bend_of_strength(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, matrix: &mut [f64]) {
        let n = ask.unknowns();
        for (coordinate, rate, error, row) in efforts(ask, at) {
            let Some(groups) = &ask.model.coordinates()[coordinate].groups else { continue };
            let strength = &groups[Side::of(error).index()].strength;
            let angle = at.body.kinematics().values()[coordinate];
            let ((torque, slope), curvature) = (strength.torque_and_slope(angle), strength.curvature(angle));
            if slope == 0.0 && curvature == 0.0 {
                continue;
            }
            let Some(own) = ask.free.iter().position(|free| *free == rate) else { continue };
            let by = -error * slope / torque;
            for (other, entry) in row.iter().enumerate() {
                matrix[own.min(other) * n + own.max(other)] += by * entry;
            }
            matrix[own * n + own] += by * row[own] - error * error * curvature / torque;
        }
    }

    fn bend_of_forces(&mut self, ask: &EffortProblem<'_>, at: &FirstOrder<'_>, h: f64, matrix: &mut [f64]) {
        if at.columns.is_empty() {
            return;
        }
        let (rates, n, k) = (ask.model.rates().len(), ask.unknowns(), ask.free.len());
        contact_columns(ask, &self.body, &mut self.jacobian, &mut self.columns);
        self.basis.clear();
        self.mixed.resize(k, 0.0);
        for row in at.places.chunks_exact(n) {
            let row = &row[..k];
            self.mixed.copy_from_slice(row);
            remove(&mut self.mixed, &self.basis);
            let left = dot(&self.mixed, &self.mixed).sqrt();
            if left > NEW * dot(row, row).sqrt() {
                self.basis.extend(self.mixed.iter().map(|entry| entry / left));
            }
        }
        for (force, (to, from)) in self.columns.chunks_exact(rates).zip(at.columns.chunks_exact(rates)).enumerate() {
            self.mixed.iter_mut().zip(ask.free).for_each(|(entry, rate)| *entry = (to[*rate] - from[*rate]) / h);
            remove(&mut self.mixed, &self.basis);
            for (i, entry) in self.mixed.iter().enumerate() {
                matrix[i * n + k + force] += entry;
            }
        }
    }
}

/// Adds `share` times the symmetric part of a gradient, less that of another one.
fn add_gradient(ask: &EffortProblem<'_>, share: f64, of: &Gradient, less: Option<&Gradient>, matrix: &mut [f64]) {
    let n = ask.unknowns();
    let symmetric = of.is_symmetric() && less.is_none_or(Gradient::is_symmetric);
    for (i, &a) in ask.free.iter().enumerate() {
        let (row, rest) = (of.row(a), less.map(|less| less.row(a)));
        let to = &mut matrix[i * n + i..i * n + ask.free.len()];
        for (entry, &b) in to.iter_mut().zip(&ask.free[i..]) {
            let mut sum = row[b] - rest.map_or(0.0, |rest| rest[b]);
            if !symmetric {
                sum = 0.5 * (sum + of.get(b, a) - less.map_or(0.0, |less| less.get(b, a)));
            }
            *entry += share * sum;
        }
    }
}

/// Of every coordinate whose effort counts: its rate, its error and the row of that.
fn efforts<'a>(
    ask: &'a EffortProblem<'_>,
    at: &FirstOrder<'a>,
) -> impl Iterator<Item = (usize, usize, f64, &'a [f64])> {
    let effort =
        ask.effort.tasks.iter().map_while(|task| if let Task::Effort(effort) = task { Some(effort) } else { None });
    let rows = at.errors.iter().zip(at.slopes.chunks_exact(ask.unknowns()));
    let coordinates = effort.flat_map(|effort| &effort.coordinates).zip(rows);
    coordinates.filter_map(|(&c, (error, row))| Some((c, ask.model.coordinates()[c].rate?, *error, row)))
}

/// Takes the part along each row of an orthonormal basis away.
fn remove(v: &mut [f64], basis: &[f64]) {
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
    use super::super::standing_adult::{StandingAdult, alike, moved};
    use super::*;
    use crate::tasks::PriorityLevel;

    const SEED: u64 = 23;
    /// Step of the second difference, rad, m or body weights.
    const STEP: f64 = 2e-4;

    /// The matrix along a motion that leaves the feet where they are, against second differences of the Lagrangian along it,
    /// relative to what lies beyond first derivatives.
    #[test]
    fn the_matrix_is_the_second_derivative_of_the_lagrangian() {
        let ground = StandingAdult::new();
        let mut hessian = Hessian::new(&ground.model);
        let (mut worst, mut compared) = (0f64, 0);
        ground.each(&mut Pcg64Mcg::new(SEED.into()), 40, |random, ask, site| {
            let (n, k, root) = (ask.unknowns(), ask.free.len(), ask.contact.root().len());
            let multipliers: Vec<f64> = site.lower.iter().map(|_| random.random_range(-0.3..0.3)).collect();
            let mut direction: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut basis: Vec<f64> = vec![];
            for row in site.rows.chunks_exact(n).skip(root).take(ask.places.rows()) {
                let mut row = row[..k].to_vec();
                remove(&mut row, &basis);
                let length = dot(&row, &row).sqrt();
                basis.extend(row.iter().map(|entry| entry / length));
            }
            remove(&mut direction[..k], &basis);

            let mut problem = QuadraticProgram::default();
            (problem.n, problem.shifted) = (n, k);
            site.write(1.0, &mut problem);
            let along = |matrix: &[f64]| -> f64 {
                let upper = |i: usize, j: usize| matrix[i.min(j) * n + i.max(j)];
                (0..n * n).map(|e| direction[e / n] * upper(e / n, e % n) * direction[e % n]).sum()
            };
            let squares = along(&problem.matrix);
            hessian.bend(ask, &site.seen(ask), &multipliers, HessianModel::Full, &mut problem.matrix);
            let exact = along(&problem.matrix);

            let equations = root + ask.goals().map(PriorityLevel::rows).sum::<usize>();
            let lagrangian = |site: &Iterate| {
                let rows = multipliers.iter().zip(&site.lower).take(equations);
                site.effort - rows.map(|(y, rest)| y * rest).sum::<f64>()
            };
            let [before, after] = [-STEP, STEP].map(|h| moved(site, ask, &direction, h));
            if alike(site, &before) && alike(site, &after) {
                let numeric = (lagrangian(&before) + lagrangian(&after) - 2.0 * lagrangian(site)) / (STEP * STEP);
                worst = worst.max((numeric - exact).abs() / (1.0 + (numeric - squares).abs()));
                compared += 1;
            }
        });
        println!("seed {SEED}: {compared} postures, off by {worst:.1e} at most");
        assert!(compared > 20 && worst < 1e-4, "{worst} {compared}");
    }
}
