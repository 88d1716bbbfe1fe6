//! The strength of the two muscle groups of a coordinate, with its sources.

use contrapposto::model::MuscleGroup;
use serde::Serialize;

use super::super::sources::{Known, Source};

#[derive(Serialize)]
pub(super) struct StrengthText<'a> {
    positive: GroupStrengthText<'a>,
    negative: GroupStrengthText<'a>,
}

#[derive(Serialize)]
struct GroupStrengthText<'a> {
    name: &'a str,
    /// Greatest torque at any angle, and the angle.
    peak_nm: f64,
    at_rad: f64,
    /// Angles of the measurement; outside of them the torque at the nearer end is held (extrapolated).
    tested_rad: Option<[f64; 2]>,
    source: Option<Source>,
    /// Of the dependence on the angle.
    angle_source: Option<Source>,
}

impl<'a> StrengthText<'a> {
    pub(super) fn new([positive, negative]: &'a [MuscleGroup; 2], known: &Known) -> Self {
        let of = |group: &'a MuscleGroup, side: usize| {
            let strength = &group.strength;
            let (least, greatest) = strength.tested;
            GroupStrengthText {
                name: &group.name,
                peak_nm: strength.greatest(),
                at_rad: strength.best.clamp(least, greatest),
                tested_rad: Some([least, greatest]).filter(|[least, greatest]| (least - greatest).is_finite()),
                source: known.strength.get(side).or(known.strength.first()).cloned(),
                angle_source: known.shapes.as_ref().map(|shapes| shapes[side].clone()),
            }
        };
        Self { positive: of(positive, 0), negative: of(negative, 1) }
    }
}
