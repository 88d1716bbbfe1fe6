//! How far is the body from what it should do, and how does that change with every rate?
//!
//! Every kind of task has an error and its derivative by the rates, in its own unit. An equation asks for error zero: its rows
//! are `J step = -error`. An inequality allows a range: `lower - value <= J step <= upper - value`. To first order a step that
//! keeps the rows reaches the goal; rows keep the scale of their unit (1 m against 1 rad).

mod center_of_mass;
mod distance;
mod effort;
mod look_at;
mod orientation;
mod placement;
mod point;
mod polygon;
mod posture;
mod priority_level;
mod pull;
mod unit;

pub use center_of_mass::{CenterOfMass, CenterOfMassGoal};
pub use distance::Distance;
pub use effort::Effort;
pub(crate) use effort::{passive_row, share_of_strength};
pub use look_at::LookAt;
pub use orientation::Orientation;
pub use placement::Placement;
pub use point::Point;
pub use polygon::{HalfPlane, half_planes};
pub use posture::Posture;
pub use priority_level::PriorityLevel;
pub use unit::Unit;

use nalgebra::{Matrix3, Vector3};

use crate::joint_torques::{JointTorques, Quantities};
use crate::model::{LARGEST, Model};
use crate::posture::PostureError;
use hierarchical_least_squares::Level;

/// Something the body should do.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// A point of a segment at a place in ground.
    Point(Point),
    /// A segment turned as wanted.
    Orientation(Orientation),
    /// Both.
    Placement(Placement),
    /// A direction of a segment toward a place in ground.
    LookAt(LookAt),
    /// Two points within a range of distances.
    Distance(Distance),
    /// The centre of mass at a place, or over a polygon.
    CenterOfMass(CenterOfMass),
    /// Coordinates at wanted values.
    Posture(Posture),
    /// Little muscle torque.
    Effort(Effort),
}

/// Why a task was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// There is no such segment or coordinate.
    #[error("{task} task: {what} number {index}; the model has {count}")]
    Index {
        /// Kind of the task.
        task: &'static str,
        /// Segment or coordinate.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A number without meaning.
    #[error("{task} task: {what} is {value}; it must be {accepted}")]
    Number {
        /// Kind of the task.
        task: &'static str,
        /// The quantity with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// What would be accepted.
        accepted: &'static str,
    },
    /// It asks for nothing.
    #[error("{task} task: it asks for no {what}; it must ask for one at least")]
    Empty {
        /// Kind of the task.
        task: &'static str,
        /// What there should be one of.
        what: &'static str,
    },
    /// A list has another length than the model needs.
    #[error("{task} task: {given} {what}; the model needs {needed}")]
    Length {
        /// Kind of the task.
        task: &'static str,
        /// What the list holds.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length it must have.
        needed: usize,
    },
    /// The wanted posture does not fit the model.
    #[error("posture task: {0}")]
    Posture(#[from] PostureError),
    /// The body cannot do that.
    #[error("{task} task: `{name}` {problem}")]
    Unable {
        /// Kind of the task.
        task: &'static str,
        /// Coordinate, rate or model.
        name: String,
        /// Why not.
        problem: &'static str,
    },
}

impl Task {
    /// What [`JointTorques::update`] must compute for it.
    pub fn quantities(&self) -> Quantities {
        match self {
            Self::CenterOfMass(_) => Quantities { center_of_mass: true, ..Quantities::default() },
            Self::Effort(_) => Quantities { gradient: true, ..Quantities::default() },
            _ => Quantities::default(),
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Self::Point(task) => task.axes.iter().filter(|asked| **asked).count(),
            Self::Orientation(_) => 3,
            Self::Placement(_) => 6,
            Self::LookAt(_) => 2,
            Self::Distance(_) => 1,
            Self::CenterOfMass(task) => task.rows(),
            Self::Posture(task) => task.weights.iter().filter(|weight| **weight > 0.0).count(),
            Self::Effort(task) => task.coordinates.len(),
        }
    }

    /// Its kind as scenarios write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point(_) => "point",
            Self::Orientation(_) => "orientation",
            Self::Placement(_) => "placement",
            Self::LookAt(_) => "look_at",
            Self::Distance(_) => "distance",
            Self::CenterOfMass(_) => "center_of_mass",
            Self::Posture(_) => "posture",
            Self::Effort(_) => "effort",
        }
    }

    /// Gives it another place to reach, ground, m; `false` for a task that has none.
    pub fn retarget(&mut self, to: Vector3<f64>) -> bool {
        match self {
            Self::Point(task) => task.target = to,
            Self::Placement(task) => task.target.translation.vector = to,
            Self::LookAt(task) => task.target = to,
            Self::CenterOfMass(CenterOfMass { goal: CenterOfMassGoal::At { target, .. } }) => *target = to,
            _ => return false,
        }
        true
    }

    /// Its kind and what it moves, e.g. `point hand_r`. The task must have passed [`Task::check`].
    pub fn label(&self, model: &Model) -> String {
        let name = |segment: usize| &model.segments()[segment].name;
        let kind = self.kind();
        match self {
            Self::Point(Point { segment, .. })
            | Self::Orientation(Orientation { segment, .. })
            | Self::Placement(Placement { segment, .. })
            | Self::LookAt(LookAt { segment, .. }) => format!("{kind} {}", name(*segment)),
            Self::Distance(task) => format!("{kind} {} {}", name(task.a.0), name(task.b.0)),
            Self::CenterOfMass(_) | Self::Posture(_) | Self::Effort(_) => kind.to_owned(),
        }
    }

    /// Unit of the error of a row.
    ///
    /// # Panics
    /// Unless `row` is less than [`Task::rows`].
    pub fn unit(&self, model: &Model, row: usize) -> Unit {
        assert!(row < self.rows(), "row {row} of {}", self.rows());
        match self {
            Self::Point(_) | Self::Distance(_) | Self::CenterOfMass(_) => Unit::Metre,
            Self::Orientation(_) | Self::LookAt(_) => Unit::Radian,
            Self::Placement(_) => [Unit::Metre, Unit::Radian][row / 3],
            Self::Posture(task) => task.unit(model, row),
            Self::Effort(_) => Unit::ShareOfStrength,
        }
    }

    /// Adds its rows to `level`, whose unknowns are the model's rates. Does not allocate once the level has had the space. The
    /// task must have passed [`Task::check`].
    ///
    /// # Panics
    /// When `body` was not updated with what [`Task::needs`] says.
    pub fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        match self {
            Self::Point(task) => task.evaluate(model, body, level),
            Self::Orientation(task) => task.evaluate(model, body, level),
            Self::Placement(task) => task.evaluate(model, body, level),
            Self::LookAt(task) => task.evaluate(model, body, level),
            Self::Distance(task) => task.evaluate(model, body, level),
            Self::CenterOfMass(task) => task.evaluate(model, body, level),
            Self::Posture(task) => task.evaluate(model, body, level),
            Self::Effort(task) => task.evaluate(model, body, level),
        }
    }

    /// Adds its true errors, one a row, to `out`: present less wanted, in the row's unit; 0 where an inequality holds, and without
    /// the weights of a posture task.
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
            Self::CenterOfMass(task) => task.residual(body, out),
            Self::Posture(task) => task.residual(model, body, out),
            Self::Effort(task) => task.residual(model, body, out),
        }
    }

    /// Does it fit `model`?
    ///
    /// # Errors
    /// [`TaskError`] names the first thing that does not.
    pub fn check(&self, model: &Model) -> Result<(), TaskError> {
        let check = Check { task: self.kind(), model };
        match self {
            Self::Point(task) => task.check(&check),
            Self::Orientation(task) => task.check(&check),
            Self::Placement(task) => task.check(&check),
            Self::LookAt(task) => task.check(&check),
            Self::Distance(task) => task.check(&check),
            Self::CenterOfMass(task) => task.check(&check),
            Self::Posture(task) => task.check(&check),
            Self::Effort(task) => task.check(&check),
        }
    }
}

/// The entries of the asked axes.
fn chosen(axes: [bool; 3], v: Vector3<f64>) -> impl Iterator<Item = f64> {
    (0..3).filter(move |&k| axes[k]).map(move |k| v[k])
}

/// `count` more rows of zeros at the end of a level's matrix, to be filled; their limits are still to come.
fn append<'a>(level: &'a mut Level, model: &Model, count: usize) -> &'a mut [f64] {
    let start = level.matrix.len();
    level.matrix.resize(start + count * model.rates().len(), 0.0);
    &mut level.matrix[start..]
}

/// Limits of an equation for the row last appended: `row . step = -error`.
fn equation(level: &mut Level, error: f64) {
    level.lower.push(-error);
    level.upper.push(-error);
}

/// Three equations from the three rows last appended, of which those of the axes that are not asked go away.
fn equations(level: &mut Level, model: &Model, axes: [bool; 3], error: Vector3<f64>) {
    let n = model.rates().len();
    let start = level.matrix.len() - 3 * n;
    let mut end = start;
    for k in (0..3).filter(|&k| axes[k]) {
        level.matrix.copy_within(start + k * n..start + (k + 1) * n, end);
        end += n;
        equation(level, error[k]);
    }
    level.matrix.truncate(end);
}

/// Three rows, each replaced by what `matrix` makes of them.
fn multiply(matrix: &Matrix3<f64>, rows: &mut [f64], n: usize) {
    let (x, rest) = rows.split_at_mut(n);
    let (y, z) = rest.split_at_mut(n);
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let column = matrix * Vector3::new(*x, *y, *z);
        (*x, *y, *z) = (column.x, column.y, column.z);
    }
}

/// Adds `v . rows` of three rows, one after the other, to one row.
fn add_along(row: &mut [f64], v: &Vector3<f64>, rows: &[f64]) {
    let (x, rest) = rows.split_at(row.len());
    let (y, z) = rest.split_at(row.len());
    for (((entry, x), y), z) in row.iter_mut().zip(x).zip(y).zip(z) {
        *entry += v.x * x + v.y * y + v.z * z;
    }
}

/// What the checks of all kinds share.
struct Check<'a> {
    task: &'static str,
    model: &'a Model,
}

impl Check<'_> {
    fn segment(&self, index: usize) -> Result<(), TaskError> {
        let count = self.model.segments().len();
        if index < count { Ok(()) } else { Err(TaskError::Index { task: self.task, what: "segment", index, count }) }
    }

    fn number(&self, what: &'static str, value: f64) -> Result<(), TaskError> {
        if value.abs() <= LARGEST { Ok(()) } else { self.refuse(what, value, "finite and at most 1e9 in size") }
    }

    fn vector(&self, what: &'static str, v: &Vector3<f64>) -> Result<(), TaskError> {
        v.iter().try_for_each(|&value| self.number(what, value))
    }

    /// Lengths that must be one.
    fn unit(&self, what: &'static str, length: f64) -> Result<(), TaskError> {
        if (length - 1.0).abs() <= 1e-6 { Ok(()) } else { self.refuse(what, length, "1") }
    }

    fn some(&self, what: &'static str, any: bool) -> Result<(), TaskError> {
        if any { Ok(()) } else { Err(TaskError::Empty { task: self.task, what }) }
    }

    fn refuse(&self, what: &'static str, value: f64, accepted: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Number { task: self.task, what, value, accepted })
    }

    fn unable(&self, name: &str, problem: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Unable { task: self.task, name: name.to_owned(), problem })
    }
}
