//! Draws the forces of a muscle's fibres against their length, with the states that the muscle is in.

use crate::axes::{Frame, Range, drawable};
use crate::canvas::Canvas;
use crate::captions::{Mark, heading, legend};
use crate::figure::Figure;
use crate::style::{ACTIVE_PEN, BELOW_FRAME, EXTERNAL_PEN, FRAME_LEFT, GOAL, Ink, MARGIN, PASSIVE_PEN, START, TEXT};

/// Height of the frame, px.
const FORCE_FRAME_HEIGHT: f64 = 280.0;
/// Greatest force that the axis shows where no state lies above it, over the greatest isometric force: passive curves grow without end.
const SHOWN_FORCE: f64 = 1.6;
/// Radius of the dot of a state, px.
const STATE_RADIUS: f64 = 6.0;
/// Colours of the states, in their order.
const STATE_INKS: [Ink; 2] = [START, GOAL];

/// The forces of fibres, over their greatest isometric force, against their length over the optimal one.
#[derive(Clone, Debug, Default)]
pub struct ForceLength {
    /// First line above the chart.
    pub title: String,
    /// Second line above the chart; may be empty.
    pub subtitle: String,
    /// Lengths of the curves, in increasing order.
    pub lengths: Vec<f64>,
    /// Active force of full activation at each length.
    pub active: Vec<f64>,
    /// Passive force at each length.
    pub passive: Vec<f64>,
    /// States of the muscle: name, length and force of the fibres; two at most are drawn.
    pub states: Vec<(String, f64, f64)>,
}

/// Draws active force, passive force and their sum, and the states.
#[must_use]
pub fn force_length(chart: &ForceLength) -> Figure {
    let mut canvas = Canvas::default();
    let top = heading(&mut canvas, FRAME_LEFT, &chart.title, &chart.subtitle, MARGIN);
    let sums: Vec<f64> = chart.active.iter().zip(&chart.passive).map(|(active, passive)| active + passive).collect();
    let states = &chart.states[..chart.states.len().min(STATE_INKS.len())];
    let shown = sums.iter().map(|force| force.min(SHOWN_FORCE)).chain(states.iter().map(|(_, _, force)| *force));
    let frame = Frame::new(
        top,
        FORCE_FRAME_HEIGHT,
        Range::around(chart.lengths.iter().copied().chain(states.iter().map(|(_, length, _)| *length))).padded(0.02),
        Range::around(shown.chain([0.0])).padded(0.05),
    );
    frame.axes(&mut canvas, Some("fibre length / optimal length"), "force / greatest isometric");
    let mut entries = vec![];
    for (forces, pen, name) in
        [(&sums, EXTERNAL_PEN, "both"), (&chart.active, ACTIVE_PEN, "active"), (&chart.passive, PASSIVE_PEN, "passive")]
    {
        if frame.curve(&mut canvas, &chart.lengths, forces, pen) {
            entries.push((Mark::Line(pen), name));
        }
    }
    if entries.is_empty() {
        frame.say_empty(&mut canvas);
    }
    for ((name, length, force), fill) in states.iter().zip(STATE_INKS) {
        if drawable(*length) && drawable(*force) {
            frame.dot(&mut canvas, (*length, *force), STATE_RADIUS, fill, TEXT);
            entries.push((Mark::Dot { fill, rim: TEXT }, name));
        }
    }
    legend(&mut canvas, &frame, &entries);
    frame.outline(&mut canvas);
    canvas.finish(frame.area.bottom() + BELOW_FRAME + MARGIN)
}
