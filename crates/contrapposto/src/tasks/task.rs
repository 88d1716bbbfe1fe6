//! The closed set of tasks: dispatches to the file of each kind.

use nalgebra::Vector3;

use super::bounds::{Bounds, Carried, Component};
use super::center_of_mass::{CenterOfMass, CenterOfMassGoal};
use super::check::{Check, TaskError};
use super::clearance::Clearance;
use super::distance::Distance;
use super::effort::Effort;
use super::height::Height;
use super::look_at::{LookAt, LookAtGoal};
use super::orientation::Orientation;
use super::placement::Placement;
use super::point::Point;
use super::posture::Posture;
use super::rows::chosen;
use super::unit::Unit;
use crate::joint_torques::{JointTorques, Quantities};
use crate::model::Model;
use hierarchical_least_squares::Level;

/// rad. A direction this near to straight up is called upright.
const UPRIGHT: f64 = 1e-6;

/// A task of the body.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// A point of a segment at a place in ground.
    Point(Point),
    /// A segment turned as wanted.
    Orientation(Orientation),
    /// A point and the rotation of a segment, both as wanted.
    Placement(Placement),
    /// A direction of a segment toward a place, or along a direction of ground.
    LookAt(LookAt),
    /// Two points within a range of distances.
    Distance(Distance),
    /// A point at a height above another segment's origin, along an axis of that segment.
    Height(Height),
    /// Parts of the body apart from each other and from things.
    Clearance(Clearance),
    /// The centre of mass at a place, or over a polygon.
    CenterOfMass(CenterOfMass),
    /// Components of points and directions of a segment within limits.
    Bounds(Bounds),
    /// Coordinates at wanted values.
    Posture(Posture),
    /// Little muscle torque for strength.
    Effort(Effort),
}

impl Task {
    /// The quantities that [`JointTorques::update`] must compute for the task.
    pub fn quantities(&self) -> Quantities {
        match self {
            Self::CenterOfMass(_) => Quantities { center_of_mass: true, ..Quantities::default() },
            Self::Effort(_) => Quantities { gradient: true, passive_torque: true, ..Quantities::default() },
            _ => Quantities::default(),
        }
    }

    /// Whether the task wants a place, a rotation or a direction of a segment.
    pub fn wants(&self, segment: usize) -> bool {
        match self {
            Self::Point(task) => task.segment == segment,
            Self::Orientation(task) => task.segment == segment,
            Self::Placement(task) => task.segment == segment,
            Self::LookAt(task) => task.segment == segment,
            Self::Bounds(task) => task.segment == segment,
            Self::Distance(task) => task.a.0 == segment || task.b.0 == segment,
            Self::Height(_) | Self::Posture(_) | Self::CenterOfMass(_) | Self::Clearance(_) | Self::Effort(_) => false,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Self::Point(task) => task.axes.iter().filter(|asked| **asked).count(),
            Self::Orientation(_) => 3,
            Self::Placement(_) => 6,
            Self::LookAt(_) => 2,
            Self::Distance(_) | Self::Height(_) => 1,
            Self::Clearance(task) => task.pairs.len(),
            Self::CenterOfMass(task) => task.rows(),
            Self::Bounds(task) => task.components.len(),
            Self::Posture(task) => task.weights.iter().filter(|weight| **weight > 0.0).count(),
            Self::Effort(task) => task.coordinates.len(),
        }
    }

    /// The kind as scenarios write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point(_) => "point",
            Self::Orientation(_) => "orientation",
            Self::Placement(_) => "placement",
            Self::LookAt(_) => "look_at",
            Self::Distance(_) => "distance",
            Self::Height(_) => "height",
            Self::Clearance(_) => "clearance",
            Self::CenterOfMass(_) => "center_of_mass",
            Self::Bounds(_) => "bounds",
            Self::Posture(_) => "posture",
            Self::Effort(_) => "effort",
        }
    }

    /// Replaces the target, ground, m; returns `false` for a task without one.
    pub fn retarget(&mut self, to: Vector3<f64>) -> bool {
        match self {
            Self::Point(task) => task.target = to,
            Self::Placement(task) => task.target.translation.vector = to,
            Self::LookAt(LookAt { goal: LookAtGoal::Place(target), .. }) => *target = to,
            Self::CenterOfMass(CenterOfMass { goal: CenterOfMassGoal::At { target, .. } }) => *target = to,
            _ => return false,
        }
        true
    }

    /// The kind and the segments that it moves, e.g. `point hand_r`; `head upright` for a direction of the head against gravity, `head
    /// level` for one that has to be square to another, `humerus_l hangs` for one that has to point down, `humerus_l rhythm` for a height
    /// above another segment. The task must have passed [`Task::check`].
    pub fn label(&self, model: &Model) -> String {
        let name = |segment: usize| &model.segments()[segment].name;
        let kind = self.kind();
        match self {
            Self::LookAt(LookAt { segment, goal: LookAtGoal::Direction(wanted), .. }) => {
                let upright = (wanted.into_inner() + model.gravity().normalize()).norm() < UPRIGHT;
                if upright { format!("{} upright", name(*segment)) } else { format!("direction {}", name(*segment)) }
            }
            Self::Bounds(Bounds { segment, components }) if components.iter().all(Component::is_level) => {
                format!("{} level", name(*segment))
            }
            Self::Bounds(Bounds { segment, .. }) if self.hangs(model) => format!("{} hangs", name(*segment)),
            Self::Point(Point { segment, .. })
            | Self::Orientation(Orientation { segment, .. })
            | Self::Placement(Placement { segment, .. })
            | Self::LookAt(LookAt { segment, .. })
            | Self::Bounds(Bounds { segment, .. }) => format!("{kind} {}", name(*segment)),
            Self::Height(Height { segment, .. }) => format!("{} rhythm", name(*segment)),
            Self::Distance(task) => format!("{kind} {} {}", name(task.a.0), name(task.b.0)),
            Self::Clearance(_) | Self::CenterOfMass(_) | Self::Posture(_) | Self::Effort(_) => kind.to_owned(),
        }
    }

    /// Whether the task asks nothing but that a segment points down, to within an angle less than 90 degrees: a limb without work.
    pub fn hangs(&self, model: &Model) -> bool {
        let Self::Bounds(Bounds { components, .. }) = self else { return false };
        let down = model.gravity().try_normalize(0.0);
        down.is_some_and(|down| components.iter().all(|component| component.hangs(down)))
    }

    /// Whether the task asks something of a segment by itself: of its place, its turn, or of a coordinate of its joint.
    pub fn concerns(&self, model: &Model, segment: usize) -> bool {
        match self {
            Self::Point(Point { segment: of, .. })
            | Self::Orientation(Orientation { segment: of, .. })
            | Self::Placement(Placement { segment: of, .. })
            | Self::LookAt(LookAt { segment: of, .. })
            | Self::Bounds(Bounds { segment: of, .. }) => *of == segment,
            Self::Distance(task) => [task.a.0, task.b.0].contains(&segment),
            Self::Posture(task) => {
                let rates = model.segments()[segment].mobility.map(|mobility| model.rates_of(mobility));
                rates.into_iter().flatten().any(|rate| task.weights[rate] > 0.0)
            }
            Self::Height(_) | Self::Clearance(_) | Self::CenterOfMass(_) | Self::Effort(_) => false,
        }
    }

    /// Unit of the error of a row.
    ///
    /// # Panics
    /// Unless `row` is less than [`Task::rows`].
    pub fn unit(&self, model: &Model, row: usize) -> Unit {
        assert!(row < self.rows(), "row {row} of {}", self.rows());
        match self {
            Self::Point(_) | Self::Distance(_) | Self::Height(_) | Self::Clearance(_) | Self::CenterOfMass(_) => {
                Unit::Metre
            }
            Self::Orientation(_) | Self::LookAt(_) => Unit::Radian,
            Self::Placement(_) => [Unit::Metre, Unit::Radian][row / 3],
            Self::Bounds(task) => match task.components[row].of {
                Carried::Point(_) => Unit::Metre,
                Carried::Direction(_) => Unit::Radian,
            },
            Self::Posture(task) => task.unit(model, row),
            Self::Effort(_) => Unit::ShareOfStrength,
        }
    }

    /// Adds the rows of the task to `level`, whose unknowns are the model's rates. Does not allocate once the level has
    /// had the space. The task must have passed [`Task::check`].
    ///
    /// # Panics
    /// When `body` was not updated with [`Task::quantities`].
    pub fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        match self {
            Self::Point(task) => task.evaluate(model, body, level),
            Self::Orientation(task) => task.evaluate(model, body, level),
            Self::Placement(task) => task.evaluate(model, body, level),
            Self::LookAt(task) => task.evaluate(model, body, level),
            Self::Distance(task) => task.evaluate(model, body, level),
            Self::Height(task) => task.evaluate(model, body, level),
            Self::Bounds(task) => task.evaluate(model, body, level),
            Self::Clearance(task) => task.evaluate(model, body, level),
            Self::CenterOfMass(task) => task.evaluate(model, body, level),
            Self::Posture(task) => task.evaluate(model, body, level),
            Self::Effort(task) => task.evaluate(model, body, level),
        }
    }

    /// Adds the true errors of the task, one a row, to `out`: present less wanted, in the row's unit; 0 where an
    /// inequality holds, and without the weights of a posture task.
    ///
    /// # Panics
    /// As [`Task::evaluate`].
    pub fn residual(&self, model: &Model, body: &JointTorques, out: &mut Vec<f64>) {
        match self {
            Self::Point(task) => out.extend(chosen(task.axes, task.error(model, body))),
            Self::Orientation(task) => out.extend_from_slice(task.error(model, body).as_slice()),
            Self::Placement(task) => out.extend(task.error(model, body)),
            Self::LookAt(task) => out.extend(task.error(model, body)),
            Self::Distance(task) => out.push(task.error(model, body)),
            Self::Height(task) => out.push(task.error(model, body)),
            Self::Bounds(task) => task.residual(model, body, out),
            Self::Clearance(task) => task.residual(model, body, out),
            Self::CenterOfMass(task) => task.residual(body, out),
            Self::Posture(task) => task.residual(model, body, out),
            Self::Effort(task) => task.residual(model, body, out),
        }
    }

    /// Checks that the task fits `model`.
    ///
    /// # Errors
    /// [`TaskError`] names the first thing that does not fit.
    pub fn check(&self, model: &Model) -> Result<(), TaskError> {
        let check = Check { task: self.kind(), model };
        match self {
            Self::Point(task) => task.check(&check),
            Self::Orientation(task) => task.check(&check),
            Self::Placement(task) => task.check(&check),
            Self::LookAt(task) => task.check(&check),
            Self::Distance(task) => task.check(&check),
            Self::Height(task) => task.check(&check),
            Self::Bounds(task) => task.check(&check),
            Self::Clearance(task) => task.check(&check),
            Self::CenterOfMass(task) => task.check(&check),
            Self::Posture(task) => task.check(&check),
            Self::Effort(task) => task.check(&check),
        }
    }
}
