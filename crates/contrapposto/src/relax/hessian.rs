//! How does effort bend along posture and contact forces? The second derivative of the Lagrangian of a descent.
//!
//! As in [`super::curvature`], with forces as unknowns of their own: `sum_i w_i tau_i''` is how the gradient matrix changes when
//! the body moves along `w`, and its mixed part how the torques of each force change, since these too are gradients of a
//! potential (the work of a force fixed in the ground). One difference gives both.
//!
//! Forces that cancel each other within one support do no work while it stays; their mixed part lies in the motions that turn
//! the support. These are taken out of the mixed part, which changes the multipliers of the supports and nothing else: else the
//! matrix would bend down where no step may go.

use nalgebra::Vector3;

use super::quadratic::{Quadratic, add, dot};
use super::site::{Ask, Site, columns};
use crate::ik::body::{Body, Needs};
use crate::ik::task::{Task, share_of_strength};
use crate::model::Model;
use crate::passive::PassiveLaw;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load};

/// How far the body moves along `w` for the difference, rad or m.
const MOVE: f64 = 1e-5;
/// The same for passive torque.
const MOVE_JOINT: f64 = 1e-4;
/// What is left of a row, relative to it, when it says nothing new.
const NEW: f64 = 1e-6;

/// Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Hessian {
    weightless: Model,
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
    pub(super) fn new(model: &Model) -> Self {
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
            columns: vec![],
            jacobian: vec![0.0; 3 * n],
            basis: vec![],
            mixed: vec![],
        }
    }

    /// Adds to the upper triangle of the problem's matrix what goes beyond first derivatives, with the multipliers of the rows.
    pub(super) fn bend(&mut self, ask: &Ask<'_>, at: &Site, multipliers: &[f64], problem: &mut Quadratic) {
        self.weigh(ask, at, multipliers);
        self.bend_of_tasks(ask, at, multipliers, problem);
        self.bend_of_torques(ask, at, problem);
    }

    fn weigh(&mut self, ask: &Ask<'_>, at: &Site, multipliers: &[f64]) {
        self.weights.fill(0.0);
        for (rate, y) in ask.contact.root().iter().zip(multipliers) {
            self.weights[*rate] = y / ask.contact.weight();
        }
        let mut errors = at.errors.iter();
        for task in &ask.effort.tasks {
            let Task::Effort(effort) = task else { return };
            for (&coordinate, error) in effort.coordinates.iter().zip(&mut errors) {
                let Some(rate) = ask.model.coordinates()[coordinate].rate else { continue };
                self.weights[rate] = -error * share_of_strength(ask.model, &at.body, coordinate);
            }
        }
    }

    fn bend_of_tasks(&mut self, ask: &Ask<'_>, at: &Site, multipliers: &[f64], problem: &mut Quadratic) {
        let Some(mut multipliers) = multipliers.get(ask.contact.root().len()..) else { return };
        self.loads.clear();
        for task in ask.goals().flat_map(|goal| &goal.tasks) {
            let Some((own, rest)) = multipliers.split_at_checked(task.rows()) else { return };
            task.pull(&self.weightless, own, &mut self.loads);
            multipliers = rest;
        }
        // Loads beyond what the model accepts leave the matrix without them.
        if self.pulls.update(&self.weightless, at.body.kinematics(), &self.loads).is_err() {
            return;
        }
        self.pulls.gradient(&self.weightless, at.body.kinematics(), &mut self.gradient);
        for (i, a) in ask.free.iter().enumerate() {
            let row = self.gradient.row(*a);
            for (j, b) in ask.free.iter().enumerate().skip(i) {
                problem.matrix[i * problem.n + j] += 0.5 * (row[*b] + self.gradient.get(*b, *a));
            }
        }
    }

    fn bend_of_torques(&mut self, ask: &Ask<'_>, at: &Site, problem: &mut Quadratic) {
        let (model, n) = (ask.model, problem.n);
        let size = self.weights.iter().fold(0.0, |size: f64, w| size.max(w.abs()));
        if size.is_nan() || size <= 0.0 {
            return;
        }
        let h = MOVE / size;
        self.step.iter_mut().zip(&self.weights).for_each(|(step, w)| *step = h * w);
        self.moved.values_mut().copy_from_slice(at.posture.values());
        self.moved.displace(model, &self.step);
        let needs = Needs { torque: true, center_of_mass: false };
        if self.body.update(model, &self.moved, &at.loads, needs).is_err() {
            return;
        }
        let share = 0.5 / h;
        let (before, after) = (at.body.gradient(), self.body.gradient());
        for (i, &a) in ask.free.iter().enumerate() {
            let (from, to) = (before.row(a), after.row(a));
            for (j, &b) in ask.free.iter().enumerate().skip(i) {
                let other = after.get(b, a) - before.get(b, a);
                problem.matrix[i * n + j] += share * (to[b] - from[b] + other);
            }
            let Some(c) = model.rates()[a].coordinate else { continue };
            if let Some(PassiveLaw::Curve(curve)) = &model.coordinates()[c].passive {
                let slope = |h: f64| curve.torque_and_slope(at.posture.values()[c] + h).1;
                let bend = (slope(MOVE_JOINT) - slope(-MOVE_JOINT)) / (2.0 * MOVE_JOINT);
                problem.matrix[i * n + i] += self.weights[a] * bend;
            }
        }
        self.bend_of_forces(ask, at, h, problem);
    }

    fn bend_of_forces(&mut self, ask: &Ask<'_>, at: &Site, h: f64, problem: &mut Quadratic) {
        if at.forces.is_empty() {
            return;
        }
        let (rates, n, k) = (ask.model.rates().len(), problem.n, ask.free.len());
        columns(ask, &self.body, &mut self.jacobian, &mut self.columns);
        self.basis.clear();
        let first = ask.contact.root().len();
        let places: usize = ask.places.tasks.iter().map(Task::rows).sum();
        self.mixed.resize(k, 0.0);
        for row in first..first + places {
            let row = &at.rows[row * n..row * n + k];
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
                problem.matrix[i * n + k + force] += entry;
            }
        }
    }
}

/// Takes the part along each row of an orthonormal basis away.
fn remove(v: &mut [f64], basis: &[f64]) {
    for row in basis.chunks_exact(v.len()) {
        let along = dot(row, v);
        add(v, row, -along);
    }
}
