//! Passive torque of a posture, built-in curves inside the range that they are meant for only.
//!
//! Published exponentials reach 10^15 N m at angles that no joint has and published models allow. Beyond the range of the
//! built-in coordinate its torque stays what it is at the limit.

use contrapposto::model::Model;

use super::{Opened, Origin};

/// Farther beyond a limit is worth a word, rad.
const SLACK: f64 = 1e-3;

/// Passive torque of a posture.
pub(crate) struct Tissue {
    /// By coordinate: where its built-in curve is meant for.
    ranges: Vec<Option<(f64, f64)>>,
    /// Values, held inside these ranges.
    held: Vec<f64>,
}

impl Tissue {
    pub(crate) fn new(opened: &Opened) -> Self {
        let ranges = opened.origins.iter().zip(opened.model.coordinates()).map(|(origins, coordinate)| {
            // Whoever lays a range over the model says what the curve is good for.
            let meant = if origins.range == Origin::Overlay { Some(coordinate.range) } else { origins.meant };
            meant.filter(|_| origins.passive == Origin::Library && coordinate.passive.is_some())
        });
        Self { ranges: ranges.collect(), held: vec![] }
    }

    /// By coordinate: the range outside of which its passive torque stays what it is at the limit, rad.
    pub(crate) fn ranges(&self) -> &[Option<(f64, f64)>] {
        &self.ranges
    }

    /// Takes the values of all coordinates, those that follow others filled in.
    pub(crate) fn place(&mut self, values: &[f64]) {
        let clamp =
            |(value, range): (&f64, &Option<(f64, f64)>)| range.map_or(*value, |(min, max)| value.max(min).min(max));
        self.held.clear();
        self.held.extend(values.iter().zip(&self.ranges).map(clamp));
    }

    /// Passive torque of a coordinate, N m; 0 without a law.
    pub(crate) fn torque(&self, model: &Model, index: usize) -> f64 {
        model.coordinates()[index].passive.as_ref().map_or(0.0, |law| law.torque(index, &self.held))
    }

    /// Does the value lie beyond what the curve of the coordinate is meant for?
    pub(crate) fn holds(&self, index: usize, value: f64) -> bool {
        self.ranges[index].is_some_and(|(min, max)| value < min - SLACK || value > max + SLACK)
    }
}
