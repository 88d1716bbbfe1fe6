//! Checks that tasks share, and the error of a task that does not fit the model.

use nalgebra::Vector3;

use crate::model::{LARGEST, Model};
use crate::posture::PostureError;

/// A part of a task; prints as its name with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskPart {
    /// Point of the segment.
    Point,
    /// Point of the first segment of a distance.
    PointA,
    /// Point of the second segment of a distance.
    PointB,
    /// Place to be reached.
    Target,
    /// Length of a vector or quaternion; must be 1.
    TargetQuaternion,
    /// Origin of the gaze.
    Eye,
    /// Length of a vector or quaternion; must be 1.
    Direction,
    /// Length of a wanted direction; must be 1.
    TargetDirection,
    /// Least distance.
    LowerLimit,
    /// Greatest distance.
    UpperLimit,
    /// Distance from the edges of the polygon.
    Margin,
    /// Offset of an edge of the polygon.
    EdgeOffset,
    /// Length of a vector or quaternion; must be 1.
    EdgeNormal,
    /// Weight of a coordinate.
    Weight,
    /// Least strength of a muscle group over all angles.
    LeastStrength,
    /// Limited components.
    Limit,
    /// Ground axes asked for.
    Axis,
    /// Edges of the polygon.
    Edge,
    /// Coordinates asked for.
    Coordinate,
    /// Coordinates with a weight above 0.
    WeightedCoordinate,
    /// Pairs that are kept apart.
    Pair,
    /// Distance from which on a pair has no row.
    Activation,
    /// End of a capsule's line.
    CapsuleEnd,
    /// Radius of a capsule.
    Radius,
    /// Length of a vector or quaternion; must be 1.
    SurfaceNormal,
    /// Offset of a half-space.
    SurfaceOffset,
    /// Middle of a block.
    BlockMiddle,
    /// Half the length of a block.
    BlockLength,
}

impl std::fmt::Display for TaskPart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Point | Self::PointA | Self::PointB => "point (m)",
            Self::Target => "target (m)",
            Self::TargetQuaternion => "length of the target's quaternion",
            Self::Eye => "eye (m)",
            Self::Direction => "length of the direction",
            Self::TargetDirection => "length of the wanted direction",
            Self::LowerLimit => "lower limit (m)",
            Self::UpperLimit => "upper limit (m)",
            Self::Margin => "margin (m)",
            Self::EdgeOffset => "offset of an edge (m)",
            Self::EdgeNormal => "length of an edge's normal",
            Self::Weight => "weight",
            Self::LeastStrength => "least strength (N m)",
            Self::Limit => "limit",
            Self::Axis => "axis",
            Self::Edge => "edge of a polygon",
            Self::Coordinate => "coordinate",
            Self::WeightedCoordinate => "coordinate (all weights are 0)",
            Self::Pair => "pair",
            Self::Activation => "activation distance (m)",
            Self::CapsuleEnd => "end of a capsule (m)",
            Self::Radius => "radius of a capsule (m)",
            Self::SurfaceNormal => "length of the normal of a surface",
            Self::SurfaceOffset => "offset of a surface (m)",
            Self::BlockMiddle => "middle of a block (m)",
            Self::BlockLength => "half length of a block (m)",
        })
    }
}

/// The reason for which a task was refused.
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
        /// Number of segments or coordinates of the model.
        count: usize,
    },
    /// A number without meaning.
    #[error("{task} task: {part} is {value}; it must be {accepted}")]
    Number {
        /// Kind of the task.
        task: &'static str,
        /// The quantity.
        part: TaskPart,
        /// The value.
        value: f64,
        /// Accepted values.
        accepted: &'static str,
    },
    /// The task asks for nothing.
    #[error("{task} task: it asks for no {part}; it must ask for one at least")]
    Empty {
        /// Kind of the task.
        task: &'static str,
        /// The list that has no entry.
        part: TaskPart,
    },
    /// A list has another length than the model needs.
    #[error("{task} task: {given} {what}; the model needs {needed}")]
    Length {
        /// Kind of the task.
        task: &'static str,
        /// The contents of the list.
        what: &'static str,
        /// Length of the list.
        given: usize,
        /// The length it must have.
        needed: usize,
    },
    /// The wanted posture does not fit the model.
    #[error("posture task: {0}")]
    Posture(#[from] PostureError),
    /// The body cannot carry out the task.
    #[error("{task} task: `{name}` {problem}")]
    Unable {
        /// Kind of the task.
        task: &'static str,
        /// Coordinate, rate or model.
        name: String,
        /// The reason.
        problem: &'static str,
    },
}

/// A task of this kind is checked against this model.
pub(super) struct Check<'a> {
    pub(super) task: &'static str,
    pub(super) model: &'a Model,
}

impl Check<'_> {
    pub(super) fn segment(&self, index: usize) -> Result<(), TaskError> {
        let count = self.model.segments().len();
        if index < count { Ok(()) } else { Err(TaskError::Index { task: self.task, what: "segment", index, count }) }
    }

    pub(super) fn number(&self, part: TaskPart, value: f64) -> Result<(), TaskError> {
        if value.abs() <= LARGEST { Ok(()) } else { self.refuse(part, value, "finite and at most 1e9 in size") }
    }

    pub(super) fn vector(&self, part: TaskPart, v: &Vector3<f64>) -> Result<(), TaskError> {
        v.iter().try_for_each(|&value| self.number(part, value))
    }

    /// Lengths that must be one.
    pub(super) fn unit(&self, part: TaskPart, length: f64) -> Result<(), TaskError> {
        if (length - 1.0).abs() <= 1e-6 { Ok(()) } else { self.refuse(part, length, "1") }
    }

    pub(super) fn some(&self, part: TaskPart, any: bool) -> Result<(), TaskError> {
        if any { Ok(()) } else { Err(TaskError::Empty { task: self.task, part }) }
    }

    pub(super) fn refuse(&self, part: TaskPart, value: f64, accepted: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Number { task: self.task, part, value, accepted })
    }

    pub(super) fn unable(&self, name: &str, problem: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Unable { task: self.task, name: name.to_owned(), problem })
    }
}
