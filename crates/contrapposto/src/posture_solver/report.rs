//! The result of a solve: a posture, the error of every level, and why the steps ended there.

use super::Reason;
use super::tolerances::NEARER;
use crate::contact::{Balance, Slip};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use crate::posture::Posture;
use crate::tasks::{PriorityLevel, Unit};

/// The posture that a solve came to.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedPosture {
    /// All coordinates.
    pub posture: Posture,
    /// Errors by level.
    pub levels: Vec<LevelError>,
    /// Sum of squares of the effort level, as shares of strength; 0 without one.
    pub effort: f64,
    /// Distance of the supports from their places; 0 without supports.
    pub slip: Slip,
    /// Equilibrium of the root; [`Balance::Held`] without supports.
    pub balance: Balance,
    /// The reason for which the steps ended.
    pub reason: Reason,
    /// Number of steps of all starts.
    pub steps: usize,
}

impl SolvedPosture {
    /// Whether the first level that differs noticeably is nearer than that of the `other` posture.
    pub(super) fn is_nearer_than(&self, other: &Self) -> bool {
        let [own, other] = [self, other].map(|posture| posture.levels.iter().map(|level| level.length));
        first_difference(own, other, NEARER) < 0.0
    }
}

/// Difference of the errors of the first level that differ by more than `noticeable`, less than 0 where it is nearer than in `other`; 0 where none
/// does.
pub(crate) fn first_difference(
    own: impl Iterator<Item = f64>,
    other: impl Iterator<Item = f64>,
    noticeable: f64,
) -> f64 {
    let mut differences = own.zip(other).map(|(own, other)| own - other);
    differences.find(|difference| difference.abs() > noticeable).unwrap_or(0.0)
}

/// Error of one level in a posture.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelError {
    /// Errors of its tasks, one after the other, then of its half-spaces.
    pub rows: Vec<RowError>,
    /// Length of all of them; rows keep the scale of their units.
    pub length: f64,
}

/// Error of one row of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowError {
    /// Present less wanted, in `unit`; 0 where an inequality holds.
    pub value: f64,
    /// Unit of `value`.
    pub unit: Unit,
}

impl LevelError {
    /// Computes the error of `level` in the posture of `body`.
    pub(super) fn of(level: &PriorityLevel, model: &Model, body: &JointTorques) -> Self {
        let mut rows = vec![];
        let mut errors = vec![];
        for task in &level.tasks {
            errors.clear();
            task.residual(model, body, &mut errors);
            rows.extend(errors.iter().enumerate().map(|(i, &value)| RowError { value, unit: task.unit(model, i) }));
        }
        let values = body.posture().values();
        rows.extend(level.half_spaces.iter().map(|space| {
            let coordinate = space.normal.iter().position(|entry| *entry != 0.0);
            let rate = coordinate.and_then(|c| model.coordinates()[c].rate);
            let unit = rate.map_or(Unit::Radian, |rate| Unit::of(&model.rates()[rate]));
            RowError { value: space.violation(values).max(0.0), unit }
        }));
        let length = rows.iter().map(|row| row.value * row.value).sum::<f64>().sqrt();
        Self { rows, length }
    }

    /// Lengths and angles of the rows, apart: the slip of a level that holds places of supports.
    pub fn slip(&self) -> Slip {
        let length = |angles: bool| {
            let rows = self.rows.iter().filter(|row| (row.unit == Unit::Radian) == angles);
            rows.map(|row| row.value * row.value).sum::<f64>().sqrt()
        };
        Slip { distance: length(false), angle: length(true) }
    }

    /// Sum of squares of the shares of strength among the rows.
    pub(super) fn effort(&self) -> f64 {
        let shares = self.rows.iter().filter(|row| row.unit == Unit::ShareOfStrength);
        shares.fold(0.0, |sum, row| sum + row.value * row.value)
    }
}
