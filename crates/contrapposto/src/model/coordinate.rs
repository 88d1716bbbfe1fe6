//! Defines a coordinate: its range, its passive law and the two muscle groups that move it.

use crate::fatigue::FatigueLaw;
use crate::passive::{PassiveCurve, PassiveLaw};
use crate::strength::Strength;
use serde::{Deserialize, Serialize};

/// Meaning of the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateKind {
    /// An angle, rad.
    Rotation,
    /// A distance, m.
    Translation,
    /// One component of a unit quaternion.
    Quaternion,
}

/// The two senses of a coordinate: the sign of the active torque that the group gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Side {
    /// Torque of the group increases the coordinate.
    Positive,
    /// Torque of the group decreases the coordinate.
    Negative,
}

impl Side {
    /// Both, positive first.
    pub const BOTH: [Self; 2] = [Self::Positive, Self::Negative];

    /// Index into pairs that hold the positive group first.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The group that gives a torque of this sign; positive for zero.
    pub fn of(torque: f64) -> Self {
        if torque < 0.0 { Self::Negative } else { Self::Positive }
    }

    /// `positive` or `negative`, as in output columns.
    pub fn word(self) -> &'static str {
        if self == Self::Positive { "positive" } else { "negative" }
    }
}

/// One sense of one coordinate (the paper's half-joint).
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleGroup {
    /// Movement of the group in clinical words, e.g. `elbow flexion`.
    pub name: String,
    /// Greatest voluntary torque against angle.
    pub strength: Strength,
    /// Law by which the group tires and recovers.
    pub fatigue: FatigueLaw,
}

/// One generalised coordinate of a model.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// Unique name, e.g. `elbow_flex_r`.
    pub name: String,
    /// Angle, distance or quaternion component.
    pub kind: CoordinateKind,
    /// Range of motion, lower limit first, rad or m.
    pub range: (f64, f64),
    /// Default value, inside the range.
    pub default: f64,
    /// The positive direction in clinical words, e.g. `flexion`.
    pub positive: String,
    /// Passive torque, if known.
    pub passive: Option<PassiveLaw>,
    /// The muscle groups of the positive and negative sense, if known.
    pub groups: Option<[MuscleGroup; 2]>,
    /// Rate of the coordinate, for angles and distances.
    pub rate: Option<usize>,
    /// The file that described it locks it: it is not meant to move.
    pub locked: bool,
}

impl Coordinate {
    /// Whether its passive torque is a curve, which relief needs.
    pub fn can_be_relieved(&self) -> bool {
        matches!(self.passive, Some(PassiveLaw::Curve(_) | PassiveLaw::Coupled(_) | PassiveLaw::Slice(_)))
    }

    /// The falling passive curve that relief can be found on, where the law is one.
    pub fn curve(&self) -> Option<&PassiveCurve> {
        self.passive.as_ref().and_then(PassiveLaw::curve)
    }
}

/// A coordinate as it is given to the builder.
#[derive(Clone, Debug)]
pub struct CoordinateSpec {
    /// Unique name.
    pub name: String,
    /// Range of motion, rad or m.
    pub range: (f64, f64),
    /// Default value.
    pub default: f64,
    /// The positive direction in clinical words; may be empty.
    pub positive: String,
    /// Passive torque, if known.
    pub passive: Option<PassiveLaw>,
    /// Positive and negative muscle group, if known.
    pub groups: Option<[MuscleGroup; 2]>,
    /// Angle or distance, for joints driven by functions; the motion decides elsewhere.
    pub kind: CoordinateKind,
    /// Whether the coordinate keeps its default.
    pub locked: bool,
}

impl CoordinateSpec {
    /// A coordinate with a name and a range; default 0 or the limit nearest to it, nothing else known.
    pub fn new(name: &str, range: (f64, f64)) -> Self {
        let default = 0f64.max(range.0).min(range.1);
        Self {
            name: name.to_owned(),
            range,
            default,
            positive: String::new(),
            passive: None,
            groups: None,
            kind: CoordinateKind::Rotation,
            locked: false,
        }
    }
}
