//! Names the condition of equilibrium that a body without balance violates, and by how many newtons or metres.
//!
//! The answer comes from up to three more problems of contact forces. In the first one, supports on a common plane may also give a couple: about the
//! normal as it comes (friction does not matter here), about the axes of the plane as small as possible. Such a couple `M` beside
//! a normal force `N` is that force acting farther out by `n x M / N` (`n` the normal): so if this holds the root, weight and
//! loads act that far outside the hull of all corners. In the second one nothing slips. Where neither holds, both together are tried.

use std::fmt;

use nalgebra::Vector3;

use super::forces::{Balance, ContactForces, HELD};
use super::rows::FORCES_PER_CORNER;
use crate::kinematics::Kinematics;
use crate::model::Model;
use hierarchical_least_squares::{Level, Problem, Solver, Status};

/// Corners count as one plane if their heights over it differ by no more, m.
const SAME_PLANE: f64 = 0.01;
/// Normals count as one if the cosine between them is no farther from 1.
const PARALLEL: f64 = 1e-6;
/// A line of action no farther outside of the supports is not reported, m.
const LEAST_LEAN: f64 = 1e-6;
/// Unknown couples: about the normal and two axes of the plane.
const COUPLES: usize = 3;

/// Force and torque that supports do not give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missing {
    /// Missing force along the root's slides, N.
    pub force: f64,
    /// Missing torque about the root's hinges, N m.
    pub moment: f64,
    /// The reason.
    pub condition: Condition,
}

/// The reason why supports do not hold a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// There is none.
    NoSupport,
    /// Weight and loads act outside of what is between the supports: so far and in this direction beyond the nearest point of
    /// it, ground axes, m. Only known where all supports push on one plane.
    Beyond(Vector3<f64>),
    /// The supports would hold if nothing could slip.
    Friction,
    /// The supports slip, and even if nothing could slip, weight and loads would act so far outside, as in [`Condition::Beyond`].
    FrictionBeyond(Vector3<f64>),
    /// None of these.
    Other,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { force, moment, condition } = self;
        match condition {
            Condition::Beyond(lean) => write!(f, "{}; ", beyond_in_words(lean))?,
            Condition::FrictionBeyond(lean) => {
                write!(
                    f,
                    "they slip, and with more friction {}; ",
                    beyond_in_words(lean).replacen(" act", " still act", 1)
                )?;
            }
            Condition::NoSupport => f.write_str("there are none, and its root is free to fall; ")?,
            Condition::Friction => f.write_str("they slip, and with more friction they would hold it; ")?,
            Condition::Other => {}
        }
        let small = |part: f64| part < 0.5;
        match (small(*force), small(*moment)) {
            (true, true) => write!(f, "{force:.3} N and {moment:.3} N m are missing"),
            (false, true) => write!(f, "{force:.0} N are missing"),
            (true, false) => write!(f, "{moment:.0} N m are missing"),
            (false, false) => write!(f, "{force:.0} N and {moment:.0} N m are missing"),
        }
    }
}

/// `weight and loads act 0.181 m beyond the supports, toward x +0.181 (ground axes, m)`.
fn beyond_in_words(lean: &Vector3<f64>) -> String {
    let mut parts = vec![];
    for (along, axis) in lean.iter().zip(["x", "y", "z"]) {
        if along.abs() > 0.02 * lean.norm() {
            parts.push(format!("{axis} {along:+.3}"));
        }
    }
    let toward = parts.join(", ");
    format!("weight and loads act {:.3} m beyond the supports, toward {toward} (ground axes, m)", lean.norm())
}

impl ContactForces {
    /// Missing force and torque after an update in the posture of `kinematics`; `None` in equilibrium.
    pub fn missing(&self, model: &Model, kinematics: &Kinematics) -> Option<Missing> {
        let Balance::Short { force, moment } = self.balance() else { return None };
        let condition = match self.beyond(model, kinematics, true) {
            _ if self.supports().is_empty() => Condition::NoSupport,
            Some(lean) => Condition::Beyond(lean),
            None if self.holds_without_slipping() => Condition::Friction,
            None => self.beyond(model, kinematics, false).map_or(Condition::Other, Condition::FrictionBeyond),
        };
        Some(Missing { force, moment, condition })
    }

    /// Distance and direction by which weight and loads act outside of the supports, which may slip or not, ground axes, m; `None` where
    /// this is not the fault, or the supports do not share a plane.
    fn beyond(&self, model: &Model, kinematics: &Kinematics, slips: bool) -> Option<Vector3<f64>> {
        let axes = *self.axes().first()?;
        let one_way = self.supports().iter().all(|support| support.normal.dot(&axes[0]) >= 1.0 - PARALLEL);
        let heights = self.loads().iter();
        let heights = heights.map(|load| kinematics.station(model, load.segment, load.point).dot(&axes[0]));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        if !one_way || high - low > SAME_PLANE {
            return None;
        }
        let turns = self.turns(model, kinematics)?;
        let (friction, root) = (&self.problem().levels[0], &self.problem().levels[1]);
        let n = self.forces().len();
        let mut problem = Problem::new(n + COUPLES);
        problem.lower[..n].copy_from_slice(&self.problem().lower);
        problem.upper[..n].copy_from_slice(&self.problem().upper);
        let couples = turns.iter().map(|turn| axes.map(|axis| turn.dot(&axis)));
        problem.levels = vec![
            if slips { wider(friction, n, std::iter::repeat([0.0; COUPLES])) } else { Level::default() },
            wider(root, n, couples),
            wider(&Level::default(), n, std::iter::empty()),
        ];
        for i in 1..COUPLES {
            let mut row = vec![0.0; n + COUPLES];
            row[n + i] = 1.0;
            problem.levels[2].push(&row, 0.0, 0.0);
        }
        let solver = holds(&problem)?;
        let (forces, couple) = solver.solution().split_at(n);
        let normal: f64 = forces.iter().step_by(FORCES_PER_CORNER).sum();
        let lean = axes[0].cross(&(couple[1] * axes[1] + couple[2] * axes[2])) / normal;
        (normal > HELD && lean.norm() > LEAST_LEAN).then_some(lean)
    }

    /// Angular velocity of the supports by each of the root's rates, ground; `None` if the supports do not turn all alike.
    fn turns(&self, model: &Model, kinematics: &Kinematics) -> Option<Vec<Vector3<f64>>> {
        let n = model.rates().len();
        let mut rows = vec![0.0; 3 * n];
        let mut found: Option<Vec<Vector3<f64>>> = None;
        for support in self.supports() {
            kinematics.rotation_jacobian(model, support.segment, &mut rows);
            let turn = |rate: &usize| Vector3::new(rows[*rate], rows[n + rate], rows[2 * n + rate]);
            let turns = self.root().iter().map(turn).collect();
            if found.as_ref().is_some_and(|known| *known != turns) {
                return None;
            }
            found = Some(turns);
        }
        found
    }

    fn holds_without_slipping(&self) -> bool {
        let mut problem = self.problem().clone();
        problem.levels.truncate(2);
        problem.levels[0].clear();
        holds(&problem).is_some()
    }
}

/// Level 1 solved to rounding, or nothing.
fn holds(problem: &Problem) -> Option<Solver> {
    let mut solver = Solver::new();
    let solved = matches!(solver.solve(problem), Ok(Status::Solved | Status::Infeasible { .. }));
    (solved && solver.residual(1).iter().all(|left| left.abs() <= HELD)).then_some(solver)
}

/// The rows of a level, each with an entry more for every couple.
fn wider(level: &Level, n: usize, more: impl Iterator<Item = [f64; COUPLES]>) -> Level {
    let mut wide = Level { hard: level.hard, ..Level::default() };
    let limits = level.lower.iter().zip(&level.upper);
    for ((row, (lower, upper)), more) in level.matrix.chunks_exact(n).zip(limits).zip(more) {
        wide.push(&[row, &more].concat(), *lower, *upper);
    }
    wide
}
