//! Error and Jacobian of a direction of a segment toward a place in ground, or along a direction of ground.
//!
//! `g` is the gaze, `d` the unit line from the eye to the target or the wanted direction, both in ground. The error is the rotation vector that
//! would turn the gaze onto the target, `a (g x d) / |g x d|` with `a` the angle between them; it has no part along the
//! gaze, so two rows, along `u` and `v`, say it all: axes of the segment with `u, v, g` right-handed. With `d = x u + y
//! v + z g`, `s = sqrt(x^2 + y^2)` and `f = a / s` it is `f (-y, x)`, rad.
//!
//! Turning the segment by `w` and moving the eye by `e` change `d`, seen from the segment, by
//! `d x w - (e - d (d . e)) / L`, `L` the distance, infinite for a direction; `df = h (x dx + y dy) - dz`,
//! `h = (z s - a) / s^3`.

use nalgebra::{UnitVector3, Vector3};

use super::check::{Check, TaskError, TaskPart};
use super::rows::{add_along, append, equation};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// The wanted end of the gaze.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LookAtGoal {
    /// A point that the gaze should meet, in ground, m.
    Place(Vector3<f64>),
    /// A direction along which the gaze should point, in ground.
    Direction(UnitVector3<f64>),
}

/// A direction of a segment toward a place, or along a direction of ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAt {
    /// Index of the segment.
    pub segment: usize,
    /// Origin of the gaze, in the segment's frame, m; for a direction any point.
    pub eye: Vector3<f64>,
    /// The gaze, in the segment's frame.
    pub direction: UnitVector3<f64>,
    /// Goal of the gaze.
    pub goal: LookAtGoal,
}

/// m. An eye nearer to its target than this meets the target with any gaze.
const TOUCHING: f64 = 1e-9;

/// rad. A target nearer than this to straight behind can be met either way round; one way is taken.
const BEHIND: f64 = 1e-6;

/// Gaze and target of one posture.
struct Sight {
    /// Axes across the gaze, and the gaze, in ground.
    axes: [Vector3<f64>; 3],
    /// The line to the target in ground, of unit length.
    line: Vector3<f64>,
    /// Distance of the target, m; `None` for a direction.
    distance: Option<f64>,
    /// `x`, `y` and `z` of the line in these axes, and `s`.
    across: [f64; 2],
    along: f64,
    sine: f64,
}

impl Sight {
    /// `f` and the error.
    fn error(&self) -> (f64, [f64; 2]) {
        let angle = libm::atan2(self.sine, self.along);
        let f = if self.sine > 0.0 { angle / self.sine } else { 1.0 };
        let [x, y] = self.across;
        (f, [-f * y, f * x])
    }

    /// Derivatives of either row by the line.
    fn slopes(&self) -> [Vector3<f64>; 2] {
        let ([x, y], [u, v, gaze], s) = (self.across, self.axes, self.sine);
        let square = s * s;
        let h = if s < 0.02 && self.along > 0.0 {
            // z s - a loses digits here; the series is good to 1e-15.
            -2.0 / 3.0 - square * (1.0 / 5.0 + square * (3.0 / 28.0 + square * (5.0 / 72.0)))
        } else {
            (self.along * s - libm::atan2(s, self.along)) / (square * s)
        };
        let (f, _) = self.error();
        let df = h * (x * u + y * v) - gaze;
        [-f * v - y * df, f * u + x * df]
    }
}

impl LookAt {
    /// `None` when the eye is at the target.
    fn sight(&self, model: &Model, body: &JointTorques) -> Option<Sight> {
        let kinematics = body.kinematics();
        let (line, distance) = match self.goal {
            LookAtGoal::Direction(line) => (line.into_inner(), None),
            LookAtGoal::Place(target) => {
                let line = target - kinematics.station(model, self.segment, self.eye);
                let distance = line.norm();
                if distance < TOUCHING {
                    return None;
                }
                (line / distance, Some(distance))
            }
        };
        // Fixed in the segment, so that the rows change smoothly.
        let axes = self.axes().map(|axis| kinematics.direction(model, self.segment, axis));
        let [mut x, mut y, along] = axes.map(|axis| axis.dot(&line));
        let mut sine = libm::hypot(x, y);
        if sine < BEHIND && along < 0.0 {
            (x, y) = if sine > 0.0 { (x / sine * BEHIND, y / sine * BEHIND) } else { (BEHIND, 0.0) };
            sine = BEHIND;
        }
        Some(Sight { axes, line, distance, across: [x, y], along, sine })
    }

    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> [f64; 2] {
        self.sight(model, body).map_or([0.0; 2], |sight| sight.error().1)
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let n = model.rates().len();
        // Two rows, then the six of eye and segment that they are made of, which are removed again.
        let (rows, jacobians) = append(level, model, 8).split_at_mut(2 * n);
        let mut error = [0.0; 2];
        if let Some(sight) = self.sight(model, body) {
            error = sight.error().1;
            let (eye, turn) = jacobians.split_at_mut(3 * n);
            body.kinematics().point_jacobian(model, self.segment, self.eye, eye);
            body.kinematics().rotation_jacobian(model, self.segment, turn);
            let (first, second) = rows.split_at_mut(n);
            for (row, w) in [first, second].into_iter().zip(sight.slopes()) {
                if let Some(distance) = sight.distance {
                    add_along(row, &((sight.line * sight.line.dot(&w) - w) / distance), eye);
                }
                add_along(row, &w.cross(&sight.line), turn);
            }
        }
        level.matrix.truncate(level.matrix.len() - 6 * n);
        error.into_iter().for_each(|error| equation(level, error));
    }

    /// Axes `u` and `v` of the segment's frame across the gaze, and the gaze, right-handed.
    pub(super) fn axes(&self) -> [Vector3<f64>; 3] {
        let direction = self.direction.into_inner();
        let first = direction.cross(&Vector3::ith(direction.iamin(), 1.0)).normalize();
        [first, direction.cross(&first), direction]
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.segment(self.segment)?;
        check.vector(TaskPart::Eye, &self.eye)?;
        check.unit(TaskPart::Direction, self.direction.norm())?;
        match self.goal {
            LookAtGoal::Place(target) => check.vector(TaskPart::Target, &target),
            LookAtGoal::Direction(wanted) => check.unit(TaskPart::TargetDirection, wanted.norm()),
        }
    }
}
