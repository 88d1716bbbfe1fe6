//! Computes the contact forces of least effort that keep a body in equilibrium in a posture.
//!
//! The unknowns are the forces at all corners, each as normal force and friction along two axes of its plane, in body weights. In
//! strict order of priority: friction stays inside its pyramid (and normal forces only push); the root is in equilibrium; no
//! support carries more than its share; muscles work least, `sum (tau_a / S)^2`; the forces are small. Of supports whose
//! friction has no limit the first row is left out. Strength `S` is that of the group that works, which depends on the answer:
//! the solution is repeated with the active sides of the last one until they are consistent.
//! At the very edge of the supports the equations have a slack (`edge.rs`).

use nalgebra::Vector3;

use super::Support;
use super::rows::{FORCES_PER_CORNER, Unknowns, bounds, friction_rows, share_row};
use super::support::{SupportError, rates_that_move, root_rates};
use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::statics::{FixedIn, Load, LoadKind};
use hierarchical_least_squares::{Level, Problem, Solver};

/// Whether the root is in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Balance {
    /// To rounding.
    Held,
    /// No forces that the supports can give hold the body in this posture.
    Short {
        /// Missing force along the root's slides, N.
        force: f64,
        /// Missing torque about the root's hinges, N m.
        moment: f64,
    },
}

/// Greatest residual of the root's equations in equilibrium, in body weights (times 1 m).
pub(super) const HELD: f64 = 1e-9;
/// Level of the root's equilibrium.
pub(super) const ROOT: usize = 1;
/// Level of the shares.
pub(super) const SHARE: usize = 2;
/// Level of effort.
pub(super) const EFFORT: usize = 3;
/// Greatest number of times that signs of active torque are put right.
const SIGNS: usize = 12;

/// Contact forces in a posture. Depends on posture, loads and passive torque; filled by [`ContactForces::update`].
#[derive(Clone, Debug)]
pub struct ContactForces {
    supports: Vec<Support>,
    /// Rates that only supports can hold.
    root: Vec<usize>,
    /// Coordinates whose effort depends on contact forces, and their rates.
    working: Vec<(usize, usize)>,
    sides: Vec<Side>,
    /// Weight of the body, N; 1 for a body without weight.
    weight: f64,
    /// One a corner, world-fixed.
    loads: Vec<Load>,
    axes: Vec<[Vector3<f64>; 3]>,
    /// By unknown, in body weights.
    forces: Vec<f64>,
    /// Torque of every rate about its axis at one body weight of each unknown, N m: one row an unknown.
    columns: Vec<f64>,
    /// Torque of every rate about its axis by all of them, N m.
    torques: Vec<f64>,
    jacobian: Vec<f64>,
    row: Vec<f64>,
    pub(super) problem: Problem,
    pub(super) solver: Solver,
    balance: Balance,
    /// Whether each rate is an angle.
    turning: Vec<bool>,
}

impl ContactForces {
    /// Ready for `model` on its supports.
    ///
    /// # Errors
    /// [`SupportError`] when a support does not fit the model.
    pub fn new(model: &Model, supports: Vec<Support>) -> Result<Self, SupportError> {
        supports.iter().try_for_each(|support| support.check(model))?;
        Ok(Self::build(model, supports, root_rates(model)))
    }

    /// No forces, for a part of a body that moves no support: the rest of the body holds its root.
    pub(crate) fn without_supports(model: &Model) -> Self {
        Self::build(model, vec![], vec![])
    }

    fn build(model: &Model, supports: Vec<Support>, root: Vec<usize>) -> Self {
        let mut loads = vec![];
        let mut axes = vec![];
        for support in &supports {
            for &point in &support.corners {
                let kind = LoadKind::Force(Vector3::zeros(), FixedIn::World);
                loads.push(Load { segment: support.segment, point, kind });
                axes.push(support.axes());
            }
        }
        let n = model.rates().len();
        let unknowns = FORCES_PER_CORNER * loads.len();
        let mut problem = Problem::new(unknowns);
        for i in 0..unknowns {
            (problem.lower[i], problem.upper[i]) = bounds(i);
        }
        let weight = model.mass() * model.gravity().norm();
        let moves = rates_that_move(model, &supports);
        let coordinates = model.coordinates().iter().enumerate();
        let working = coordinates.filter(|(i, c)| c.groups.is_some() && !model.is_dependent(*i));
        let working = working.filter_map(|(i, c)| Some((i, c.rate?))).filter(|(_, rate)| moves[*rate]);
        let working: Vec<(usize, usize)> = working.collect();
        let mut forces = Self {
            sides: vec![Side::Positive; working.len()],
            working,
            root,
            weight: if weight > 0.0 { weight } else { 1.0 },
            loads,
            axes,
            forces: vec![0.0; unknowns],
            columns: vec![0.0; unknowns * n],
            torques: vec![0.0; n],
            jacobian: vec![0.0; 3 * n],
            row: vec![0.0; unknowns],
            problem,
            solver: Solver::new(),
            balance: Balance::Held,
            turning: model.rates().iter().map(|rate| rate.rotational).collect(),
            supports,
        };
        forces.problem.levels.resize(5, Level::default());
        forces
    }

    /// Supports need not hold the root at a rate: it is locked.
    pub(crate) fn hold_root(&mut self, rate: usize) {
        self.root.retain(|own| *own != rate);
    }

    /// From now on the forces keep the body in equilibrium and are as small as they can be, whatever muscles work.
    pub(crate) fn leave_effort_out(&mut self) {
        self.working.clear();
        self.sides.clear();
    }

    /// Forgets what earlier postures have shown: the next answer is that of new forces, to the bit.
    pub fn forget(&mut self) {
        self.solver.forget();
        self.sides.fill(Side::Positive);
        self.forces.fill(0.0);
    }

    /// Finds the forces in a posture. `kinematics` are those of the body with balls ([`Model::by_axes`]), `angles` those about the
    /// axes of all coordinates, rad; `required` is the active torque of every rate about its axis that would be needed without
    /// contact forces, dependent coordinates folded into independent ones, N m. Does not allocate once it has solved.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics, angles: &[f64], required: &[f64]) -> Balance {
        self.gather(model.by_axes(), kinematics);
        self.hard_levels(required);
        for _ in 0..SIGNS {
            self.effort_level(model, angles, required);
            if self.solve().is_err() {
                return self.give_up();
            }
            self.forces.copy_from_slice(self.solver.solution());
            self.sum();
            if !self.turn_sides(model, angles, required) {
                break;
            }
        }
        self.balance = self.judge();
        self.write_loads();
        self.balance
    }

    /// Given torques that are no numbers, or too large: nothing holds.
    fn give_up(&mut self) -> Balance {
        self.forces.fill(0.0);
        self.sum();
        self.write_loads();
        self.balance = Balance::Short { force: f64::INFINITY, moment: f64::INFINITY };
        self.balance
    }

    /// Torque of every unknown force.
    fn gather(&mut self, model: &Model, kinematics: &Kinematics) {
        let n = model.rates().len();
        for (i, (load, axes)) in self.loads.iter().zip(&self.axes).enumerate() {
            kinematics.point_jacobian(model, load.segment, load.point, &mut self.jacobian);
            let (x, rest) = self.jacobian.split_at(n);
            let (y, z) = rest.split_at(n);
            let columns = &mut self.columns[FORCES_PER_CORNER * i * n..FORCES_PER_CORNER * (i + 1) * n];
            for (column, axis) in columns.chunks_exact_mut(n.max(1)).zip(axes) {
                let force = self.weight * axis;
                for (((torque, x), y), z) in column.iter_mut().zip(x).zip(y).zip(z) {
                    *torque = force.x * x + force.y * y + force.z * z;
                }
            }
        }
    }

    /// The row of a rate's torque, over all unknowns, divided by `size`.
    fn fill_row(&mut self, rate: usize, size: f64) {
        let n = self.torques.len();
        for (j, entry) in self.row.iter_mut().enumerate() {
            *entry = self.columns[j * n + rate] / size;
        }
    }

    /// Friction, equilibrium of the root, shares, and small forces.
    fn hard_levels(&mut self, required: &[f64]) {
        self.problem.levels.iter_mut().for_each(Level::clear);
        let unknowns = Unknowns { first: 0, now: None };
        let mut corner = 0;
        for support in &self.supports {
            let corners = corner..corner + support.corners.len();
            corner = corners.end;
            friction_rows(&mut self.problem.levels[0], &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.problem.levels[SHARE], &mut self.row, support, corners, unknowns);
        }
        for i in 0..self.root.len() {
            let rate = self.root[i];
            self.fill_row(rate, self.weight);
            let rest = required[rate] / self.weight;
            self.problem.levels[ROOT].push(&self.row, rest, rest);
        }
        for i in 0..self.row.len() {
            self.row.fill(0.0);
            self.row[i] = 1.0;
            self.problem.levels[4].push(&self.row, 0.0, 0.0);
        }
        self.problem.levels[0].hard = true;
        self.problem.levels[ROOT].hard = true;
    }

    fn effort_level(&mut self, model: &Model, angles: &[f64], required: &[f64]) {
        self.problem.levels[EFFORT].clear();
        for i in 0..self.working.len() {
            let (coordinate, rate) = self.working[i];
            let Some(groups) = &model.coordinates()[coordinate].groups else { continue };
            let strength = groups[self.sides[i].index()].strength.torque(angles[coordinate]);
            self.fill_row(rate, strength);
            let rest = required[rate] / strength;
            self.problem.levels[EFFORT].push(&self.row, rest, rest);
        }
    }

    /// Torques by all forces.
    fn sum(&mut self) {
        self.torques.fill(0.0);
        for (column, force) in self.columns.chunks_exact(self.torques.len().max(1)).zip(&self.forces) {
            self.torques.iter_mut().zip(column).for_each(|(torque, entry)| *torque += entry * force);
        }
    }

    /// Puts the sides right on which muscles work; `false` if that changes no strength.
    fn turn_sides(&mut self, model: &Model, angles: &[f64], required: &[f64]) -> bool {
        let mut turned = false;
        for (side, &(coordinate, rate)) in self.sides.iter_mut().zip(&self.working) {
            let now = Side::of(required[rate] - self.torques[rate]);
            if now != *side
                && let Some(groups) = &model.coordinates()[coordinate].groups
            {
                let [before, after] = [*side, now].map(|side| groups[side.index()].strength.torque(angles[coordinate]));
                turned |= before != after;
            }
            *side = now;
        }
        turned
    }

    fn judge(&self) -> Balance {
        if self.is_near(ROOT) {
            return Balance::Held;
        }
        let residual = self.solver.residual(ROOT);
        let mut missing = [0.0; 2];
        for (left, &rate) in residual.iter().zip(&self.root) {
            missing[usize::from(self.turning[rate])] += (left * self.weight).powi(2);
        }
        Balance::Short { force: missing[0].sqrt(), moment: missing[1].sqrt() }
    }

    fn write_loads(&mut self) {
        for ((load, axes), force) in
            self.loads.iter_mut().zip(&self.axes).zip(self.forces.chunks_exact(FORCES_PER_CORNER))
        {
            let force: Vector3<f64> = axes.iter().zip(force).map(|(axis, share)| *share * *axis).sum();
            load.kind = LoadKind::Force(self.weight * force, FixedIn::World);
        }
    }

    /// The supports.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }

    /// Rates that only supports can hold.
    pub(crate) fn root(&self) -> &[usize] {
        &self.root
    }

    /// Result of the last update.
    pub fn balance(&self) -> Balance {
        self.balance
    }

    /// Weight of the body, N, which forces are counted in; 1 for a body without weight.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// One world-fixed force a corner, in the order of the supports: what a statics with contact takes as loads.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// Torque of every rate about its axis by all contact forces, N m.
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// Friction, equilibrium of the root and what else was asked in the last update.
    pub(super) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// By corner: the directions of its three forces, ground axes.
    pub(crate) fn axes(&self) -> &[[Vector3<f64>; FORCES_PER_CORNER]] {
        &self.axes
    }

    /// By corner: normal force and friction along the two axes of the plane, in body weights.
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// Torque of every rate about its axis at one body weight of each of [`ContactForces::forces`], N m: one row an unknown.
    pub fn columns(&self) -> &[f64] {
        &self.columns
    }

    /// Corners of a support, as places in [`ContactForces::loads`].
    pub fn corners(&self, support: usize) -> std::ops::Range<usize> {
        let start = self.supports[..support].iter().map(|support| support.corners.len()).sum();
        start..start + self.supports[support].corners.len()
    }

    /// Whole force on the body at a support, ground axes, N.
    pub fn force(&self, support: usize) -> Vector3<f64> {
        self.loads[self.corners(support)].iter().map(force_of).sum()
    }

    /// Normal force at a support as a share of body weight.
    pub fn share(&self, support: usize) -> f64 {
        self.corners(support).map(|corner| self.forces[FORCES_PER_CORNER * corner]).sum()
    }

    /// Normal forces beyond the greatest shares of the supports, as a share of body weight.
    pub(crate) fn beyond_shares(&self) -> f64 {
        let supports = self.supports.iter().enumerate();
        supports.map(|(i, support)| (self.share(i) - support.share_max).max(0.0)).sum()
    }

    /// Point at which the normal force of a support acts, ground, m; `None` where the support carries nothing.
    pub fn center_of_pressure(&self, model: &Model, kinematics: &Kinematics, support: usize) -> Option<Vector3<f64>> {
        let share = self.share(support);
        let sum: Vector3<f64> = self
            .corners(support)
            .map(|corner| {
                let load = &self.loads[corner];
                self.forces[FORCES_PER_CORNER * corner] * kinematics.station(model, load.segment, load.point)
            })
            .sum();
        (share > 1e-9).then(|| sum / share)
    }
}

fn force_of(load: &Load) -> Vector3<f64> {
    if let LoadKind::Force(force, _) = load.kind { force } else { Vector3::zeros() }
}
