//! Finds coordinates that ligaments and relaxed muscles carry at an angle where that is a hazard (`data/hazards.toml`).

use crate::model::data::{HazardRow, library};
use crate::model::{Coordinate, Model, plain_name};

/// External torque below which no hazard is reported, whatever tissue carries it, N m. Assumed.
const SMALL_TORQUE: f64 = 0.5;

/// A coordinate that passive tissue carries at an angle where that is a hazard.
#[derive(Clone, Copy, Debug)]
pub struct Hazard {
    /// The coordinate.
    pub coordinate: usize,
    /// Angle of the coordinate, rad.
    pub angle: f64,
    /// External torque, N m.
    pub external: f64,
    /// Passive torque, N m.
    pub passive: f64,
    /// The kind of hazard, with its finding and sources.
    pub row: &'static HazardRow,
}

/// Share of an external torque that passive tissue carries, 0..=1; `None` below 0.5 N m.
pub fn carried(external: f64, passive: f64) -> Option<f64> {
    (external.abs() > SMALL_TORQUE).then(|| (-passive / external).clamp(0.0, 1.0))
}

impl Hazard {
    /// The hazard of a coordinate at an angle (rad) under these torques, N m.
    pub fn at(coordinate: &Coordinate, angle: f64, external: f64, passive: f64) -> Option<&'static HazardRow> {
        let share = carried(external, passive)?;
        library().hazards().iter().find(|row| row.applies(coordinate, angle, share))
    }

    /// The hazards among all coordinates, with their angles (rad), external and passive torques (N m).
    pub fn all(model: &Model, angles: &[f64], external: &[f64], passive: &[f64]) -> Vec<Self> {
        let torques = external.iter().zip(passive);
        let all = model.coordinates().iter().zip(angles).zip(torques).enumerate();
        all.filter_map(|(i, ((coordinate, angle), (external, passive)))| {
            let row = Self::at(coordinate, *angle, *external, *passive)?;
            Some(Self { coordinate: i, angle: *angle, external: *external, passive: *passive, row })
        })
        .collect()
    }

    /// The hazards in a posture (values of all coordinates, rad or m): the angles of a joint of three axes are those about its axes, as its
    /// torques are.
    pub fn of_posture(model: &Model, posture: &[f64], external: &[f64], passive: &[f64]) -> Vec<Self> {
        let mut angles = posture.to_vec();
        for joint in model.three_axis_joints() {
            let about_axes = joint.orientation(posture).angles.values;
            joint.coordinates.into_iter().zip(about_axes).for_each(|(i, angle)| angles[i] = angle);
        }
        Self::all(model, &angles, external, passive)
    }

    /// Share of the external torque that passive tissue carries, 0..=1.
    pub fn carried(&self) -> f64 {
        carried(self.external, self.passive).unwrap_or_default()
    }

    /// `lumbar extension at −60.0° (74 % of the torque of 165 N m there)`, `left knee at −5.0° (the whole torque of 37 N m there)`.
    pub fn in_words(&self, model: &Model) -> String {
        let name = plain_name(&model.coordinates()[self.coordinate].name);
        let angle = format!("{:.1}°", self.angle.to_degrees()).replace('-', "\u{2212}");
        let percent = (100.0 * self.carried()).round();
        let share = if percent < 100.0 { format!("{percent:.0}\u{a0}% of the") } else { "the whole".to_owned() };
        format!("{name} at {angle} ({share} torque of {:.0} N m there)", self.external.abs())
    }
}

/// Equal coordinates, angles, torques and kinds of hazard.
impl PartialEq for Hazard {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |hazard: &Self| (hazard.coordinate, [hazard.angle, hazard.external, hazard.passive]);
        numbers(self) == numbers(other) && std::ptr::eq(self.row, other.row)
    }
}
