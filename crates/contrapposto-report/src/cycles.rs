//! Holds the mean and the spread of the joints over the cycles of a motion, and writes them for the page's script.

use serde_json::{Value, json};

use crate::column::{DEGREES, LOAD, METRES, TORQUE, column};

/// Cycles of a motion.
#[derive(Clone, Debug, Default)]
pub struct Cycles {
    /// The number of cycles, their length, and how they were found, a sentence.
    pub text: String,
    /// Curves of each joint of the report, in the same order; over time from one bound to the next.
    pub joints: Vec<CycleCurves>,
}

/// Curves of a joint over the percents of a cycle.
#[derive(Clone, Debug, Default)]
pub struct CycleCurves {
    /// Value, degrees (m for slides).
    pub angle: Band,
    /// External torque, N m.
    pub external: Band,
    /// Active torque, N m.
    pub active: Band,
    /// |Active torque| over strength.
    pub load: Band,
}

/// Mean and standard deviation at equal steps from the start of the cycle to its end.
#[derive(Clone, Debug, Default)]
pub struct Band {
    /// Mean over the cycles.
    pub mean: Vec<f64>,
    /// Standard deviation; empty of one cycle.
    pub deviation: Vec<f64>,
}

/// The cycles for the script; `slides` tells of each joint whether it is a slide.
pub(crate) fn data(cycles: &Cycles, slides: impl Iterator<Item = bool>) -> Value {
    let list = |values: &[f64], step: f64| column(values.iter().copied(), values.len(), step);
    let band = |band: &Band, step: f64| {
        let deviation = (!band.deviation.is_empty()).then(|| list(&band.deviation, step));
        json!({ "count": band.mean.len(), "mean": list(&band.mean, step), "deviation": deviation })
    };
    let of_joint = |(curves, slides): (&CycleCurves, bool)| {
        json!({
            "angle": band(&curves.angle, if slides { METRES } else { DEGREES }),
            "external": band(&curves.external, TORQUE),
            "active": band(&curves.active, TORQUE),
            "load": band(&curves.load, LOAD),
        })
    };
    json!({ "text": cycles.text, "joints": cycles.joints.iter().zip(slides).map(of_joint).collect::<Value>() })
}
