//! Draws angle, torques and fatigue of one coordinate against time, one frame below the other.
//!
//! Fatigue is drawn for both muscle groups of the coordinate, one for each sign of the active torque (the paper's
//! half-joints). Relief begins when a group passes the critical level and ends at the lower recovery level.

use crate::axes::{Frame, Range, drawable};
use crate::canvas::Canvas;
use crate::captions::{Mark, heading, legend};
use crate::figure::Figure;
use crate::style::{
    ACTIVE_PEN, ANGLE_PEN, BELOW_FRAME, CRITICAL_PEN, EXTERNAL_PEN, FRAME_GAP, FRAME_LEFT, MARGIN, NEGATIVE_PEN,
    PASSIVE_PEN, POSITIVE_PEN, Pen, RECOVERY_PEN, TEXT,
};
use crate::tags::{Tag, draw_tags, draw_uprights, tags_height};

/// One coordinate through time.
#[derive(Clone, Debug, Default)]
pub struct TimeLine {
    /// First line above the chart.
    pub title: String,
    /// Second line above the chart; may be empty.
    pub subtitle: String,
    /// Name of the coordinate, for the legend.
    pub coordinate: String,
    /// Times of all curves, s, in increasing order.
    pub time_s: Vec<f64>,
    /// Angle at each time, degrees.
    pub angle_deg: Vec<f64>,
    /// External torque at each time, N m.
    pub external_nm: Vec<f64>,
    /// Passive torque at each time, N m (its own sign, not the opposite).
    pub passive_nm: Vec<f64>,
    /// Active torque at each time, N m.
    pub active_nm: Vec<f64>,
    /// Fatigue of the muscle group that produces positive torque, 0 to 1, at each time; may be empty.
    pub fatigue_positive: Vec<f64>,
    /// Fatigue of the muscle group that produces negative torque, 0 to 1, at each time; may be empty.
    pub fatigue_negative: Vec<f64>,
    /// Fatigue at which relief begins, 0 to 1; NaN if there is none.
    pub critical_level: f64,
    /// Fatigue at which relief ends, 0 to 1; NaN if there is none.
    pub recovery_level: f64,
    /// Changes of case: time, s, and a short label, e.g. "3.2". Every event has an upright line (the first 60), and a
    /// label as long as there is room.
    pub events: Vec<(f64, String)>,
}

/// A frame of the chart: its vertical axis and its curves.
struct Part<'a> {
    height: f64,
    y_label: &'a str,
    range: Range,
    curves: Vec<(&'a [f64], Pen, &'a str)>,
    levels: Vec<(f64, Pen, &'a str)>,
}

/// Draws the chart.
#[must_use]
pub fn time_line(line: &TimeLine) -> Figure {
    let mut canvas = Canvas::default();
    let tags: Vec<Tag> = line.events.iter().map(|(time, label)| Tag::note(*time, label.as_str(), TEXT)).collect();
    let mut top = heading(&mut canvas, FRAME_LEFT, &line.title, &line.subtitle, MARGIN) + tags_height(&tags);
    let times = Range::around(line.time_s.iter().copied());

    let parts = parts(line);
    for (i, part) in parts.iter().enumerate() {
        let frame = Frame::new(top, part.height, times, part.range);
        let time_label = (i + 1 == parts.len()).then_some("time, s");
        frame.axes(&mut canvas, time_label, part.y_label);
        if i == 0 {
            draw_tags(&mut canvas, &frame, &tags);
        }
        draw_uprights(&mut canvas, &frame, &tags);
        draw_part(&mut canvas, &frame, part, &line.time_s);
        frame.outline(&mut canvas);
        top = frame.area.bottom() + FRAME_GAP;
    }
    canvas.finish(top - FRAME_GAP + BELOW_FRAME + MARGIN)
}

fn parts(line: &TimeLine) -> [Part<'_>; 3] {
    let angle = Part {
        height: 130.0,
        y_label: "angle, deg",
        range: Range::around(line.angle_deg.iter().copied()).padded(0.08),
        curves: vec![(&line.angle_deg, ANGLE_PEN, line.coordinate.as_str())],
        levels: vec![],
    };
    let torques = [&line.external_nm, &line.passive_nm, &line.active_nm];
    let torque = Part {
        height: 170.0,
        y_label: "joint torque, N m",
        range: Range::around(torques.into_iter().flatten().copied()).padded(0.08),
        curves: vec![
            (&line.external_nm, EXTERNAL_PEN, "external"),
            (&line.passive_nm, PASSIVE_PEN, "passive"),
            (&line.active_nm, ACTIVE_PEN, "active"),
        ],
        levels: vec![],
    };
    let fatigues = [&line.fatigue_positive, &line.fatigue_negative];
    let fatigue_values = fatigues.into_iter().flatten().copied();
    let fatigue = Part {
        height: 130.0,
        y_label: "fatigue, 0 to 1",
        range: Range::around(fatigue_values.chain([0.0, 1.0])).padded(0.04),
        curves: vec![
            (&line.fatigue_positive, POSITIVE_PEN, "positive group"),
            (&line.fatigue_negative, NEGATIVE_PEN, "negative group"),
        ],
        levels: vec![
            (line.critical_level, CRITICAL_PEN, "critical level"),
            (line.recovery_level, RECOVERY_PEN, "recovery level"),
        ],
    };
    [angle, torque, fatigue]
}

fn draw_part(canvas: &mut Canvas, frame: &Frame, part: &Part, times: &[f64]) {
    let mut entries: Vec<(Mark, &str)> = Vec::new();
    for &(level, pen, label) in part.levels.iter().filter(|(level, ..)| drawable(*level)) {
        frame.level(canvas, level, pen);
        entries.push((Mark::Line(pen), label));
    }
    let mut empty = true;
    for &(values, pen, label) in &part.curves {
        if frame.curve(canvas, times, values, pen) {
            empty = false;
            entries.push((Mark::Line(pen), label));
        }
    }
    if empty {
        frame.say_empty(canvas);
    }
    legend(canvas, frame, &entries);
}
