//! Draws external, passive and active torque against the angle, in the style of the paper's Figures 1 and 7-14.
//!
//! Where minus the passive torque (blue) crosses the external torque (red), the active torque (brown) is zero:
//! `tau_a = -(tau_p + tau_e)`, Eq. 1 and 2.

use crate::axes::{Frame, Range, degrees_text, drawable, extreme, number_text};
use crate::canvas::Canvas;
use crate::captions::{Mark, heading, legend};
use crate::figure::Figure;
use crate::style::{
    ACTIVE, ACTIVE_PEN, BELOW_FRAME, EXTERNAL, EXTERNAL_PEN, FRAME_LEFT, GOAL, MARGIN, MINUS_ACTIVE_PEN, PAPER,
    PASSIVE_PEN, PATH_PEN, START, TOLERANCE_PEN,
};
use crate::tags::{MOST_TAGS, PostureSketch, SketchRole, Tag, draw_tags, draw_uprights, tags_height};

const FRAME_HEIGHT: f64 = 320.0;
/// End of the vertical axis, as a multiple of the greatest external torque: the passive torque grows steeply towards
/// the limits and is cut at the frame, so that the middle of the range stays readable.
const HEADROOM: f64 = 1.6;
/// The tolerance is drawn if it is at least this far from its curve, px; closer it would hide in the line.
const LEAST_TOLERANCE: f64 = 1.2;

/// One panel: torques of a joint coordinate against its angle, and how the active torque was reduced.
#[derive(Clone, Debug, Default)]
pub struct TorqueBalance {
    /// First line above the panel.
    pub title: String,
    /// Second line above the panel, e.g. "cases 3.2 ×30, 2.1 ×1"; may be empty.
    pub subtitle: String,
    /// Label of the horizontal axis: coordinate, unit, which sense is positive, e.g. "elbow_flex_r, deg (flexion positive)".
    pub angle_label: String,
    /// Angles of the three curves, degrees, in increasing order.
    pub angles_deg: Vec<f64>,
    /// External torque at each angle, N m.
    pub external_nm: Vec<f64>,
    /// Red path with a point at its end: angle, degrees, and external torque, N m, of every step, where it is known only there; may
    /// be empty.
    pub external_path: Vec<(f64, f64)>,
    /// Minus the passive torque at each angle, N m.
    pub minus_passive_nm: Vec<f64>,
    /// Active torque at each angle, N m; its opposite is drawn too.
    pub active_nm: Vec<f64>,
    /// Tolerance on the active torque, N m: two dotted lines beside minus the passive torque (the paper's Figure 2),
    /// where they are far enough from it to be seen. 0 for none.
    pub tolerance_nm: f64,
    /// Black point: angle, degrees, and active torque, N m, at the beginning; of a single posture (one point in
    /// [`TorqueBalance::path`], no goal) its active torque.
    pub start: Option<(f64, f64)>,
    /// Yellow path: angle, degrees, and active torque, N m, of every step.
    pub path: Vec<(f64, f64)>,
    /// Green point: angle, degrees, and active torque, N m, at the end.
    pub goal: Option<(f64, f64)>,
    /// Angles without active torque, degrees.
    pub zero_torque_deg: Vec<f64>,
    /// Drawings of the posture above the panel; the first five are shown.
    pub postures: Vec<PostureSketch>,
}

/// Draws the panels, one below the other.
#[must_use]
pub fn torque_balance(panels: &[TorqueBalance]) -> Figure {
    let mut canvas = Canvas::default();
    let mut top = MARGIN;
    for panel in panels {
        top = draw_panel(&mut canvas, panel, top) + MARGIN;
    }
    if panels.is_empty() {
        let range = Range::around([]);
        let frame = Frame::new(top, FRAME_HEIGHT, range, range);
        frame.outline(&mut canvas);
        frame.say_empty(&mut canvas);
        top = frame.area.bottom() + MARGIN;
    }
    canvas.finish(top)
}

/// Draws one panel below `top`; returns where it ends.
fn draw_panel(canvas: &mut Canvas, panel: &TorqueBalance, top: f64) -> f64 {
    let text_top = heading(canvas, FRAME_LEFT, &panel.title, &panel.subtitle, top);
    let tags = tags(panel);
    let frame_top = text_top + tags_height(&tags);
    let frame = Frame::new(frame_top, FRAME_HEIGHT, angles(panel), torques(panel));
    frame.axes(canvas, Some(&panel.angle_label), "joint torque, N m");
    draw_tags(canvas, &frame, &tags);
    draw_uprights(canvas, &frame, &tags);
    draw_curves(canvas, &frame, panel);
    frame.outline(canvas);
    draw_points(canvas, &frame, panel);
    frame.area.bottom() + BELOW_FRAME
}

/// Drawings of postures, and the angles without active torque that no drawing shows.
fn tags(panel: &TorqueBalance) -> Vec<Tag<'_>> {
    let drawn = |angle: f64| {
        let mut sketches = panel.postures.iter();
        sketches.any(|s| s.role != SketchRole::Start && (s.angle_deg - angle).abs() < 0.5)
    };
    let sketches = panel.postures.iter().map(Tag::sketch);
    let zeros = panel.zero_torque_deg.iter().filter(|zero| !drawn(**zero));
    let notes = zeros.map(|&zero| Tag::note(zero, degrees_text(zero), ACTIVE));
    sketches.chain(notes).collect()
}

fn angles(panel: &TorqueBalance) -> Range {
    let points = panel.start.iter().chain(&panel.path).chain(&panel.external_path).chain(&panel.goal);
    let marked = points.map(|point| point.0);
    Range::around(panel.angles_deg.iter().copied().chain(marked))
}

fn torques(panel: &TorqueBalance) -> Range {
    let points = panel.start.iter().chain(&panel.path).chain(&panel.external_path).chain(&panel.goal);
    let marked = points.map(|point| point.1);
    let mut most = extreme(panel.external_nm.iter().copied().chain(marked));
    if most == 0.0 {
        most = extreme(panel.minus_passive_nm.iter().copied());
    }
    Range::around([-HEADROOM * most, HEADROOM * most])
}

fn draw_curves(canvas: &mut Canvas, frame: &Frame, panel: &TorqueBalance) {
    let mut entries: Vec<(Mark, &str)> = Vec::new();
    let angles = &panel.angles_deg;

    let (path_angles, path_torques): (Vec<f64>, Vec<f64>) = panel.path.iter().copied().unzip();
    let path_drawn = frame.curve(canvas, &path_angles, &path_torques, PATH_PEN);

    if frame.curve(canvas, angles, &panel.minus_passive_nm, PASSIVE_PEN) {
        entries.push((Mark::Line(PASSIVE_PEN), "\u{2212}passive"));
    }
    let tolerance_label = number_text(&format!("\u{2212}passive ±{}", panel.tolerance_nm));
    if panel.tolerance_nm * frame.pixels_per_unit() >= LEAST_TOLERANCE {
        let shifted = |shift: f64| -> Vec<f64> {
            let torques = panel.minus_passive_nm.iter();
            torques.map(|torque| torque + shift).collect()
        };
        let drawn = [panel.tolerance_nm, -panel.tolerance_nm]
            .map(|shift| frame.curve(canvas, angles, &shifted(shift), TOLERANCE_PEN));
        if drawn.contains(&true) {
            entries.push((Mark::Line(TOLERANCE_PEN), &tolerance_label));
        }
    }
    let (path_angles, path_torques): (Vec<f64>, Vec<f64>) = panel.external_path.iter().copied().unzip();
    let external = frame.curve(canvas, &path_angles, &path_torques, EXTERNAL_PEN);
    if frame.curve(canvas, angles, &panel.external_nm, EXTERNAL_PEN) || external {
        entries.push((Mark::Line(EXTERNAL_PEN), "external"));
    }
    let minus_active: Vec<f64> = panel.active_nm.iter().map(|torque| -torque).collect();
    frame.curve(canvas, angles, &minus_active, MINUS_ACTIVE_PEN);
    if frame.curve(canvas, angles, &panel.active_nm, ACTIVE_PEN) {
        entries.push((Mark::Line(ACTIVE_PEN), "active"));
        entries.push((Mark::Line(MINUS_ACTIVE_PEN), "\u{2212}active"));
    }
    if path_drawn {
        entries.push((Mark::Line(PATH_PEN), "path of active"));
    }
    if entries.is_empty() {
        frame.say_empty(canvas);
    }

    // A single posture has no path.
    let single = panel.goal.is_none() && panel.path.len() == 1;
    let external_point = !external && panel.external_nm.is_empty() && !panel.external_path.is_empty();
    let marks = [
        (external_point, EXTERNAL, PAPER, "external"),
        (panel.start.is_some(), START, PAPER, if single { "active" } else { "start" }),
        (panel.goal.is_some(), GOAL, PAPER, "goal"),
        (!panel.zero_torque_deg.is_empty(), PAPER, ACTIVE, "active = 0"),
    ];
    for (present, fill, rim, label) in marks {
        if present {
            entries.push((Mark::Dot { fill, rim }, label));
        }
    }
    legend(canvas, frame, &entries);
}

fn draw_points(canvas: &mut Canvas, frame: &Frame, panel: &TorqueBalance) {
    for &zero in panel.zero_torque_deg.iter().filter(|zero| drawable(**zero)).take(MOST_TAGS) {
        frame.dot(canvas, (zero, 0.0), 4.0, PAPER, ACTIVE);
    }
    if let Some(end) = panel.external_path.last() {
        frame.dot(canvas, *end, 4.5, EXTERNAL, PAPER);
    }
    if let Some(start) = panel.start {
        frame.dot(canvas, start, 6.0, START, PAPER);
    }
    if let Some(goal) = panel.goal {
        frame.dot(canvas, goal, 5.5, GOAL, PAPER);
    }
}
