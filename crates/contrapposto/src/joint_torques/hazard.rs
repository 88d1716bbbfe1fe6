//! Finds coordinates that ligaments and relaxed muscles carry at an angle where that is a hazard (`data/hazards.toml`).

use crate::model::data::{HazardRow, library};
use crate::model::{Coordinate, Model};

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

/// `low back bent forward by 30°`: a coordinate for which a hazard is known, at an angle, rad.
pub(crate) fn posture_in_words(coordinate: &str, angle: f64) -> String {
    let mut rows = library().hazards().iter();
    let row = rows.find(|row| row.concerns(coordinate));
    row.map_or_else(|| coordinate.to_owned(), |row| row.posture_in_words(coordinate, angle))
}

/// Parts of a body whose hazards are judged: their coordinates have the senses of the rows, and passive torque.
pub(crate) fn judged_parts(model: &Model) -> Vec<&'static str> {
    let mut parts: Vec<&str> = vec![];
    for row in library().hazards() {
        let judged = |c: &Coordinate| row.sense(c).is_some() && c.passive.is_some();
        if model.coordinates().iter().any(judged) && !parts.contains(&row.part.as_str()) {
            parts.push(&row.part);
        }
    }
    parts
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

    /// `low back bent forward by 60°`.
    pub fn posture_in_words(&self, model: &Model) -> String {
        self.row.posture_in_words(&model.coordinates()[self.coordinate].name, self.angle)
    }

    /// `low back bent forward by 60°: ligaments carry 74 % of its torque of 165 N m`, `...: ligaments carry its whole torque of 37 N m`.
    pub fn in_words(&self, model: &Model) -> String {
        let percent = (100.0 * self.carried()).round();
        let share = if percent < 100.0 { format!("{percent:.0}\u{a0}% of its") } else { "its whole".to_owned() };
        let posture = self.posture_in_words(model);
        format!("{posture}: ligaments carry {share} torque of {:.0}\u{a0}N\u{a0}m", self.external.abs())
    }
}

/// Equal coordinates, angles, torques and kinds of hazard.
impl PartialEq for Hazard {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |hazard: &Self| (hazard.coordinate, [hazard.angle, hazard.external, hazard.passive]);
        numbers(self) == numbers(other) && std::ptr::eq(self.row, other.row)
    }
}
