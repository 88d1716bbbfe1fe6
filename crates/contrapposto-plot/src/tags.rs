//! Draws short notes and small drawings of the posture above a frame, each near its place on the horizontal axis, with a thin line
//! that leads there.

use crate::axes::{Frame, drawable};
use crate::canvas::Canvas;
use crate::geometry::{Point, Slot, spread};
use crate::shape::Align;
use crate::style::{ACTIVE, GOAL, Ink, LEADER, Pen, SMALL_SIZE, START, TRUNK};
use crate::text::{fit, text_width};

/// Size of a drawing of a posture, px.
const SKETCH_WIDTH: f64 = 100.0;
const SKETCH_HEIGHT: f64 = 80.0;
/// Height of the line of text below a drawing, px.
const TEXT_HEIGHT: f64 = 15.0;
/// Height of the leading lines between the notes and the frame, px.
const LEADER_HEIGHT: f64 = 14.0;
/// Longest text of a note without drawing, px.
const NOTE_WIDTH: f64 = 200.0;
/// Greatest number of notes of one frame with an upright line.
pub(crate) const MOST_TAGS: usize = 60;
/// Greatest number of drawings above one frame; more would not be readable.
const MOST_SKETCHES: usize = 5;

/// The posture that a drawing shows; it decides the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SketchRole {
    /// The posture at the start of the path: black.
    Start,
    /// The posture at its end: green.
    Goal,
    /// A posture without active torque: brown, like the curve of the active torque.
    Zero,
}

impl SketchRole {
    fn ink(self) -> Ink {
        match self {
            Self::Start => START,
            Self::Goal => GOAL,
            Self::Zero => ACTIVE,
        }
    }
}

/// A small drawing of the posture, in the place of the photographs of the paper's Figure 1.
#[derive(Clone, Debug)]
pub struct PostureSketch {
    /// Text below the drawing, e.g. "goal 4.3°"; cut beyond about 16 characters.
    pub label: String,
    /// Angle of the posture on the horizontal axis, degrees.
    pub angle_deg: f64,
    /// Stick segments in the plane of the picture, m: x right, y up. The first line is drawn pale (the trunk, which
    /// does not move), the others in the colour of the role. All drawings of a panel share one scale and one origin.
    pub polylines: Vec<Vec<[f64; 2]>>,
    /// The posture that is shown.
    pub role: SketchRole,
}

/// A note above a frame.
pub(crate) struct Tag<'a> {
    /// Value on the horizontal axis.
    pub(crate) at: f64,
    pub(crate) label: String,
    pub(crate) ink: Ink,
    pub(crate) sketch: Option<&'a PostureSketch>,
}

impl<'a> Tag<'a> {
    pub(crate) fn note(at: f64, label: impl Into<String>, ink: Ink) -> Self {
        Self { at, label: label.into(), ink, sketch: None }
    }

    pub(crate) fn sketch(sketch: &'a PostureSketch) -> Self {
        Self { at: sketch.angle_deg, label: sketch.label.clone(), ink: sketch.role.ink(), sketch: Some(sketch) }
    }

    /// Width of the note with some air around it, px.
    fn width(&self) -> f64 {
        let text = text_width(&self.shown_label(), SMALL_SIZE) + 10.0;
        match self.sketch {
            Some(_) => text.max(SKETCH_WIDTH),
            None => text,
        }
    }

    fn shown_label(&self) -> String {
        let most = match self.sketch {
            Some(_) => SKETCH_WIDTH,
            None => NOTE_WIDTH,
        };
        fit(&self.label, SMALL_SIZE, most)
    }
}

/// Height that [`draw_tags`] needs above the frame, px.
pub(crate) fn tags_height(tags: &[Tag]) -> f64 {
    let sketch = tags.iter().any(|tag| tag.sketch.is_some());
    LEADER_HEIGHT
        + match (tags.is_empty(), sketch) {
            (true, _) => 0.0,
            (false, false) => TEXT_HEIGHT,
            (false, true) => TEXT_HEIGHT + SKETCH_HEIGHT,
        }
}

/// Draws a faint upright line in the frame for every note.
pub(crate) fn draw_uprights(canvas: &mut Canvas, frame: &Frame, tags: &[Tag]) {
    for tag in tags.iter().take(MOST_TAGS) {
        frame.upright(canvas, tag.at);
    }
}

/// Draws the notes above the frame. Notes outside the axis are left out, and so are those for which there is no room:
/// the last ones, and drawings beyond the fifth.
pub(crate) fn draw_tags(canvas: &mut Canvas, frame: &Frame, tags: &[Tag]) {
    let mut room = frame.area.width;
    let mut sketches = 0;
    let mut shown: Vec<&Tag> = tags
        .iter()
        .filter(|tag| drawable(tag.at) && frame.spans(tag.at))
        .filter(|tag| {
            sketches += usize::from(tag.sketch.is_some());
            tag.sketch.is_none() || sketches <= MOST_SKETCHES
        })
        .take_while(|tag| {
            room -= tag.width();
            room >= 0.0
        })
        .collect();
    shown.sort_by(|a, b| a.at.total_cmp(&b.at));

    let slots: Vec<Slot> = shown.iter().map(|tag| Slot { wanted: frame.across(tag.at), width: tag.width() }).collect();
    let centers = spread(&slots, frame.area.left, frame.area.right());
    let scale = Scale::around(shown.iter().filter_map(|tag| tag.sketch));
    let text_bottom = frame.area.top - LEADER_HEIGHT;
    for (tag, center) in shown.iter().zip(centers) {
        let label = tag.shown_label();
        let at = (center, text_bottom - 4.0);
        canvas.text(at, &label, SMALL_SIZE, Align::Middle, tag.ink);
        let foot = (frame.across(tag.at), frame.area.top);
        canvas.line(&[(center, text_bottom), foot], Pen::solid(LEADER, 1.0));
        if let Some(sketch) = tag.sketch {
            let middle = (center, text_bottom - TEXT_HEIGHT - SKETCH_HEIGHT / 2.0);
            draw_sketch(canvas, sketch, &scale, middle);
        }
    }
}

fn draw_sketch(canvas: &mut Canvas, sketch: &PostureSketch, scale: &Scale, middle: Point) {
    for (i, line) in sketch.polylines.iter().enumerate() {
        let ink = if i == 0 { TRUNK } else { sketch.role.ink() };
        let points: Vec<Point> = drawable_points(line).map(|point| scale.place(point, middle)).collect();
        canvas.line(&points, Pen::solid(ink, 4.0));
    }
}

fn drawable_points(line: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + '_ {
    line.iter().copied().filter(|[x, y]| drawable(*x) && drawable(*y)).take(1_000)
}

/// The map from metres to pixels, the same for all drawings of a panel.
struct Scale {
    /// Middle of all drawings together, m.
    middle: [f64; 2],
    pixels_per_metre: f64,
}

impl Scale {
    fn around<'a>(sketches: impl Iterator<Item = &'a PostureSketch>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in sketches.flat_map(|sketch| &sketch.polylines).flat_map(|line| drawable_points(line)) {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-6));
        let room = [SKETCH_WIDTH - 8.0, SKETCH_HEIGHT - 8.0];
        Self {
            middle: [0, 1].map(|axis| (low[axis] + high[axis]) / 2.0),
            pixels_per_metre: (room[0] / size[0]).min(room[1] / size[1]),
        }
    }

    fn place(&self, [x, y]: [f64; 2], middle: Point) -> Point {
        (
            middle.0 + self.pixels_per_metre * (x - self.middle[0]),
            middle.1 - self.pixels_per_metre * (y - self.middle[1]),
        )
    }
}
