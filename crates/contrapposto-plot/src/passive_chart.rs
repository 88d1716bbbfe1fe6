//! Draws the passive torque of one coordinate over its range, and below it the slope.
//!
//! The slope (`d tau_p / d theta`, stiffness with a minus sign) is what Table 1 of the paper compares with the slope
//! of the external torque; its flattest angle divides the range in two.

use crate::axes::{Frame, Range, degrees_text, drawable};
use crate::canvas::Canvas;
use crate::captions::{Mark, heading, legend};
use crate::figure::Figure;
use crate::shape::Align;
use crate::style::{
    BELOW_FRAME, FLAT_ZONE, FRAME_GAP, FRAME_LEFT, MARGIN, PASSIVE_PEN, QUIET_TEXT, SMALL_SIZE, TEXT, WIDTH,
};
use crate::tags::{Tag, draw_tags, draw_uprights, tags_height};
use crate::text::wrap;

const TORQUE_HEIGHT: f64 = 220.0;
const SLOPE_HEIGHT: f64 = 150.0;
/// Distance of two lines of the caption, px.
const CAPTION_LINE: f64 = 15.0;

/// The passive curve of one joint coordinate.
#[derive(Clone, Debug, Default)]
pub struct PassiveChart {
    /// Line above the chart.
    pub title: String,
    /// Label of the horizontal axis: coordinate, unit, which sense is positive, e.g. "elbow_flex_r, deg (flexion positive)".
    pub angle_label: String,
    /// Angles of the two curves, degrees, in increasing order.
    pub angles_deg: Vec<f64>,
    /// Passive torque at each angle, N m, positive in the direction of increasing angle.
    pub torque_nm: Vec<f64>,
    /// Slope of the passive torque at each angle, N m/rad.
    pub slope_nm_per_rad: Vec<f64>,
    /// Lower and upper limit of the coordinate, degrees.
    pub range_deg: (f64, f64),
    /// Angles between which the curve is flattest, degrees, from and to; both equal if there is a single one.
    pub flattest_deg: Option<(f64, f64)>,
    /// Source of the curve, as a caption below the chart; at most three lines are shown.
    pub source: String,
}

/// Draws passive torque and slope.
#[must_use]
pub fn passive_curve(chart: &PassiveChart) -> Figure {
    let mut canvas = Canvas::default();
    let tags = tags(chart);
    let top = heading(&mut canvas, FRAME_LEFT, &chart.title, "", MARGIN) + tags_height(&tags);

    let (low, high) = chart.range_deg;
    let angles = Range::around(chart.angles_deg.iter().copied().chain([low, high])).padded(0.02);
    let torque_range = values_in_range(chart, &chart.torque_nm);
    let torque = Frame::new(top, TORQUE_HEIGHT, angles, torque_range);
    let slope_range = values_in_range(chart, &chart.slope_nm_per_rad);
    let slope_top = torque.area.bottom() + FRAME_GAP;
    let slope = Frame::new(slope_top, SLOPE_HEIGHT, angles, slope_range);

    for frame in [&torque, &slope] {
        if let Some(zone) = chart.flattest_deg {
            frame.band(&mut canvas, zone, FLAT_ZONE);
        }
    }
    torque.axes(&mut canvas, None, "passive torque, N m");
    slope.axes(&mut canvas, Some(&chart.angle_label), "slope, N m/rad");
    draw_tags(&mut canvas, &torque, &tags);
    draw_uprights(&mut canvas, &torque, &tags);
    draw_uprights(&mut canvas, &slope, &tags);
    for (frame, values, label) in
        [(&torque, &chart.torque_nm, "passive torque"), (&slope, &chart.slope_nm_per_rad, "its slope")]
    {
        if frame.curve(&mut canvas, &chart.angles_deg, values, PASSIVE_PEN) {
            legend(&mut canvas, frame, &[(Mark::Line(PASSIVE_PEN), label)]);
        } else {
            frame.say_empty(&mut canvas);
        }
        frame.outline(&mut canvas);
    }

    let mut bottom = slope.area.bottom() + BELOW_FRAME;
    let caption_width = WIDTH - FRAME_LEFT - MARGIN;
    for line in wrap(&chart.source, SMALL_SIZE, caption_width, 3) {
        bottom += CAPTION_LINE;
        canvas.text((FRAME_LEFT, bottom), &line, SMALL_SIZE, Align::Left, QUIET_TEXT);
    }
    canvas.finish(bottom + MARGIN)
}

/// Notes above the chart: both limits, and the flattest angle or zone.
fn tags(chart: &PassiveChart) -> Vec<Tag<'static>> {
    let (low, high) = chart.range_deg;
    let mut tags = vec![
        Tag::note(low, format!("limit {}", degrees_text(low)), TEXT),
        Tag::note(high, format!("limit {}", degrees_text(high)), TEXT),
    ];
    if let Some((from, to)) = chart.flattest_deg {
        let label = if (to - from).abs() < 0.05 {
            format!("flattest {}", degrees_text(from))
        } else {
            format!("flattest {} to {}", degrees_text(from), degrees_text(to))
        };
        tags.push(Tag::note(0.5 * (from + to), label, TEXT));
    }
    tags
}

/// The vertical axis: values between the limits, because beyond them some curves grow without bound.
fn values_in_range(chart: &PassiveChart, values: &[f64]) -> Range {
    let (low, high) = chart.range_deg;
    let pairs = || chart.angles_deg.iter().zip(values);
    let between: Vec<f64> = pairs()
        .filter(|(angle, value)| (low..=high).contains(*angle) && drawable(**value))
        .map(|(_, value)| *value)
        .collect();
    if between.is_empty() {
        Range::around(values.iter().copied()).padded(0.08)
    } else {
        Range::around(between).padded(0.08)
    }
}
