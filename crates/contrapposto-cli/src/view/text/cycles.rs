//! The part `cycles` of `assess.json`.

use contrapposto::assessment::{Curve, PERCENTS};
use contrapposto::model::{CoordinateKind, Model};
use serde::Serialize;

use crate::view::cycles::{CycleCurves, JointCurves};

/// Curves over the cycles of a motion.
#[derive(Serialize)]
pub(crate) struct CyclesText {
    /// The number of cycles, their length, and how they were found.
    sentence: String,
    count: usize,
    /// The start of every cycle, and the end of the last one.
    bounds_s: Vec<f64>,
    length_s: MeanText,
    /// Percents of a cycle, at which all curves are read.
    percent: Vec<usize>,
    coordinates: Vec<CoordinateText>,
}

#[derive(Serialize)]
struct MeanText {
    mean: f64,
    /// `null` of one cycle.
    deviation: Option<f64>,
}

#[derive(Serialize)]
struct CoordinateText {
    coordinate: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    angle_deg: Option<CurveText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_m: Option<CurveText>,
    /// N of a slide.
    external_nm: CurveText,
    active_nm: CurveText,
    /// Active torque over strength.
    load: CurveText,
}

#[derive(Serialize)]
struct CurveText {
    mean: Vec<f64>,
    /// Standard deviation; `null` of one cycle.
    deviation: Option<Vec<f64>>,
}

impl CyclesText {
    pub(crate) fn new(model: &Model, curves: &CycleCurves) -> Self {
        let (mean, deviation) = curves.cycles.length();
        Self {
            sentence: curves.in_words(model),
            count: curves.cycles.count(),
            bounds_s: curves.cycles.bounds.clone(),
            length_s: MeanText { mean, deviation },
            percent: (0..PERCENTS).collect(),
            coordinates: curves.joints.iter().map(|joint| CoordinateText::new(model, joint)).collect(),
        }
    }

    /// The number of cycles, their length, and how they were found.
    pub(crate) fn sentence(&self) -> &str {
        &self.sentence
    }
}

impl CoordinateText {
    fn new(model: &Model, joint: &JointCurves) -> Self {
        let coordinate = &model.coordinates()[joint.coordinate];
        let slides = coordinate.kind == CoordinateKind::Translation;
        let angle = || Some(CurveText::new(&joint.angle));
        Self {
            coordinate: coordinate.name.clone(),
            angle_deg: if slides { None } else { angle() },
            position_m: if slides { angle() } else { None },
            external_nm: CurveText::new(&joint.external),
            active_nm: CurveText::new(&joint.active),
            load: CurveText::new(&joint.load),
        }
    }
}

impl CurveText {
    fn new(curve: &Curve) -> Self {
        let deviation = (!curve.deviation.is_empty()).then(|| curve.deviation.clone());
        Self { mean: curve.mean.clone(), deviation }
    }
}
