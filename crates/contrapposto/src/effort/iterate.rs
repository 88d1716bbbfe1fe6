//! What do effort, contact forces and goals look like in one posture with given forces?

use nalgebra::Vector3;

use super::hessian::FirstOrder;
use super::problem::{EffortProblem, contact_columns, fill_force_columns};
use super::qp::QuadraticProgram;
use crate::contact::{Unknowns, friction_rows, share_row};
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{FixedIn, Load, LoadKind, PassiveTorque};
use crate::tasks::Task;
use crate::tasks::body::{Body, BodyError, Needs};
use hierarchical_least_squares::Level;
use hierarchical_least_squares::linalg::{add_outer_products, add_scaled};

/// Posture, forces, and all that follows from them. Keeps its space.
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    pub(crate) posture: Posture,
    /// As [`ContactForces::forces`].
    pub(crate) forces: Vec<f64>,
    pub(crate) body: Body,
    /// Of a body with a root that supports must hold.
    passive: PassiveTorque,
    /// Loads of the scenario, then one a corner.
    pub(crate) loads: Vec<Load>,
    /// As [`ContactForces::columns`].
    pub(crate) columns: Vec<f64>,
    /// Errors of the effort level, and their rows over the unknowns.
    pub(crate) errors: Vec<f64>,
    pub(crate) slopes: Vec<f64>,
    /// Half the sum of squares of the errors.
    pub(crate) effort: f64,
    /// Rows of what must hold: the root's equilibrium, goals, half-spaces, friction and shares.
    pub(crate) rows: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    narrow: Level,
    row: Vec<f64>,
    jacobian: Vec<f64>,
}

impl Iterate {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            posture: model.default_posture(),
            forces: vec![],
            body: Body::new(model),
            passive: PassiveTorque::new(model),
            loads: vec![],
            columns: vec![],
            errors: vec![],
            slopes: vec![],
            effort: 0.0,
            rows: vec![],
            lower: vec![],
            upper: vec![],
            narrow: Level::default(),
            row: vec![],
            jacobian: vec![0.0; 3 * model.rates().len()],
        }
    }

    /// Sum of sizes of what does not hold.
    pub(crate) fn violation(&self) -> f64 {
        self.lower.iter().zip(&self.upper).map(|(lower, upper)| lower.max(0.0) - upper.min(0.0)).sum()
    }

    /// Computes everything for `posture` and `forces`.
    pub(crate) fn see(&mut self, ask: &EffortProblem<'_>) -> Result<(), BodyError> {
        let (model, contact) = (ask.model, ask.contact);
        self.loads.clear();
        self.loads.extend_from_slice(ask.loads);
        for ((load, axes), shares) in contact.loads().iter().zip(contact.axes()).zip(self.forces.chunks_exact(3)) {
            let force: Vector3<f64> = axes.iter().zip(shares).map(|(axis, share)| *share * *axis).sum();
            let kind = LoadKind::Force(contact.weight() * force, FixedIn::World);
            self.loads.push(Load { kind, ..*load });
        }
        let needs = Needs { torque: true, center_of_mass: false };
        let needs = ask.goals().flat_map(|goal| &goal.tasks).fold(needs, |needs, task| needs.with(task.needs()));
        self.body.update(model, &self.posture, &self.loads, needs)?;
        if !contact.root().is_empty() {
            self.passive.update(model, self.body.kinematics())?;
        }
        contact_columns(ask, &self.body, &mut self.jacobian, &mut self.columns);
        self.effort_rows(ask);
        self.rows.clear();
        self.lower.clear();
        self.upper.clear();
        self.root_rows(ask);
        self.goal_rows(ask);
        self.force_rows(ask);
        Ok(())
    }

    /// What a second derivative needs of it.
    pub(crate) fn seen(&self, ask: &EffortProblem<'_>) -> FirstOrder<'_> {
        let (n, root) = (ask.unknowns(), ask.contact.root().len());
        FirstOrder {
            body: &self.body,
            loads: &self.loads,
            columns: &self.columns,
            errors: &self.errors,
            slopes: &self.slopes,
            places: &self.rows[root * n..(root + ask.places.rows()) * n],
        }
    }

    fn effort_rows(&mut self, ask: &EffortProblem<'_>) {
        let n = ask.model.rates().len();
        self.errors.clear();
        self.slopes.clear();
        for task in &ask.effort.tasks {
            self.narrow.clear();
            task.evaluate(ask.model, &self.body, &mut self.narrow);
            for (i, row) in self.narrow.matrix.chunks_exact(n).enumerate() {
                self.errors.push(-self.narrow.upper[i]);
                self.slopes.extend(ask.free.iter().map(|rate| row[*rate]));
                let start = self.slopes.len();
                self.slopes.resize(start + self.forces.len(), 0.0);
                if let (Task::Effort(effort), false) = (task, self.forces.is_empty()) {
                    let to = &mut self.slopes[start..];
                    let (coordinate, error) = (effort.coordinates[i], -self.narrow.upper[i]);
                    fill_force_columns(ask.model, &self.body, &self.columns, coordinate, error, to);
                }
            }
        }
        self.effort = 0.5 * self.errors.iter().map(|e| e * e).sum::<f64>();
    }

    fn root_rows(&mut self, ask: &EffortProblem<'_>) {
        let (n, weight) = (ask.model.rates().len(), ask.contact.weight());
        for &rate in ask.contact.root() {
            let slopes = self.body.gradient().row(rate);
            self.rows.extend(ask.free.iter().map(|by| slopes[*by] / weight));
            self.rows.extend(self.columns.chunks_exact(n).map(|column| column[rate] / weight));
            let rest = -(self.body.external_torque().torques()[rate] + self.passive.torques()[rate]) / weight;
            self.lower.push(rest);
            self.upper.push(rest);
        }
    }

    fn goal_rows(&mut self, ask: &EffortProblem<'_>) {
        let n = ask.model.rates().len();
        let forces = self.forces.len();
        for goal in ask.goals() {
            for task in &goal.tasks {
                self.narrow.clear();
                task.evaluate(ask.model, &self.body, &mut self.narrow);
                for row in self.narrow.matrix.chunks_exact(n) {
                    self.rows.extend(ask.free.iter().map(|rate| row[*rate]));
                    self.rows.resize(self.rows.len() + forces, 0.0);
                }
                self.lower.extend_from_slice(&self.narrow.lower);
                self.upper.extend_from_slice(&self.narrow.upper);
            }
        }
        for space in ask.goals().flat_map(|goal| &goal.half_spaces) {
            let rates = ask.model.rates();
            self.rows.extend(ask.free.iter().map(|rate| rates[*rate].coordinate.map_or(0.0, |c| space.normal[c])));
            self.rows.resize(self.rows.len() + forces, 0.0);
            self.lower.push(f64::NEG_INFINITY);
            self.upper.push(-space.violation(self.posture.values()));
        }
    }

    fn force_rows(&mut self, ask: &EffortProblem<'_>) {
        self.narrow.clear();
        self.row.resize(ask.unknowns(), 0.0);
        let unknowns = Unknowns { first: ask.free.len(), now: Some(&self.forces) };
        for (i, support) in ask.contact.supports().iter().enumerate() {
            let corners = ask.contact.corners(i);
            friction_rows(&mut self.narrow, &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.narrow, &mut self.row, support, corners, unknowns);
        }
        self.rows.extend_from_slice(&self.narrow.matrix);
        self.lower.extend_from_slice(&self.narrow.lower);
        self.upper.extend_from_slice(&self.narrow.upper);
    }

    /// Gives `problem` the rows, taken on by `share`, and what effort bends by first derivatives; returns the largest diagonal
    /// entry of the posture.
    pub(crate) fn write(&self, share: f64, problem: &mut QuadraticProgram) -> f64 {
        let n = problem.n;
        problem.rows.clone_from(&self.rows);
        problem.lower.clear();
        problem.upper.clear();
        for (lower, upper) in self.lower.iter().zip(&self.upper) {
            // Only what does not hold is taken on by and by; equations keep being equations.
            let (below, above) = (lower.max(0.0), upper.min(0.0));
            let missing = below + above;
            let rest = (share - 1.0) * missing;
            problem.lower.push(if missing != 0.0 { lower + rest } else { *lower });
            problem.upper.push(if missing != 0.0 { upper + rest } else { *upper });
        }
        problem.matrix.clear();
        problem.matrix.resize(n * n, 0.0);
        problem.slope.clear();
        problem.slope.resize(n, 0.0);
        add_outer_products(&mut problem.matrix, n, &self.slopes, |_| 1.0);
        for (row, error) in self.slopes.chunks_exact(n).zip(&self.errors) {
            add_scaled(&mut problem.slope, *error, row);
        }
        (0..problem.shifted).fold(0.0, |size: f64, i| size.max(problem.matrix[i * n + i]))
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::standing_adult::{StandingAdult, alike, moved};

    const SEED: u64 = 29;
    /// Step of the difference, rad, m or body weights.
    const STEP: f64 = 1e-5;

    /// Rows of effort and of what must hold along a motion of posture and forces, and along forces alone.
    #[test]
    fn rows_are_the_derivatives_of_what_they_belong_to() {
        let ground = StandingAdult::new();
        let (mut worst, mut compared) = ([0f64; 2], 0);
        ground.each(&mut Pcg64Mcg::new(SEED.into()), 40, |random, ask, site| {
            let n = ask.unknowns();
            for (kind, worst) in worst.iter_mut().enumerate() {
                let mut step: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
                if kind == 1 {
                    step[..ask.free.len()].fill(0.0);
                }
                let [before, after] = [-STEP, STEP].map(|by| moved(site, ask, &step, by));
                if !alike(&before, &after) {
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
                compare(&site.slopes, &before.errors, &after.errors, 1.0);
                compare(&site.rows, &before.lower, &after.lower, -1.0);
                compare(&site.rows, &before.upper, &after.upper, -1.0);
            }
        });
        println!("seed {SEED}: {compared} motions, off by {:.1e} at most, by forces alone {:.1e}", worst[0], worst[1]);
        assert!(compared > 60 && worst[0] < 1e-6 && worst[1] < 1e-8, "{worst:?} {compared}");
    }
}
