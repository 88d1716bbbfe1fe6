//! Draws a body with the names of its joints, coordinates and segments: from the front every joint with its coordinates and the sense
//! in which each grows, from the right every segment's frame and the patches that can rest on things.

use crate::body::{BodyPart, BodyPosture};
use crate::body_paper::Paper;
use crate::body_view::{Bounds, MOST_PARTS, VIEWS};
use crate::canvas::Canvas;
use crate::captions::heading;
use crate::figure::Figure;
use crate::geometry::Point;
use crate::shape::Align;
use crate::style::{
    CENTER, EXTERNAL, FORCE, Ink, LEADER, MARGIN, PAPER, PASSIVE, Pen, QUIET_TEXT, SMALL_SIZE, TEXT, WIDTH,
};
use crate::text::fit;

/// Height of the body, px.
const MAP_HEIGHT: f64 = 620.0;
/// Greatest width of the body, px.
const MAP_WIDTH: f64 = 300.0;
/// Height of a line of a label, px.
const MAP_LINE: f64 = 14.0;
/// Space between two labels, px.
const LABEL_GAP: f64 = 7.0;
/// Width of a label, px.
const LABEL_WIDTH: f64 = 225.0;
/// Length of the axes of a frame, m.
const AXIS: f64 = 0.07;

/// A body, its joints and its frames. Axes: x forward, y up, z to the right; m.
#[derive(Clone, Debug, Default)]
pub struct BodyMap {
    /// First line above the picture.
    pub title: String,
    /// Second line above the picture; may be empty.
    pub subtitle: String,
    /// Parts of the body.
    pub parts: Vec<BodyPart>,
    /// Joints, seen from the front.
    pub joints: Vec<MapJoint>,
    /// Frames of segments, seen from the right.
    pub frames: Vec<MapFrame>,
    /// Patches, seen from the right.
    pub patches: Vec<Vec<[f64; 3]>>,
}

/// A joint and what is written about it.
#[derive(Clone, Debug, Default)]
pub struct MapJoint {
    /// Place of the joint.
    pub at: [f64; 3],
    /// Name of the joint.
    pub name: String,
    /// A line for each coordinate.
    pub lines: Vec<String>,
}

/// The frame of a segment.
#[derive(Clone, Debug, Default)]
pub struct MapFrame {
    /// Name of the segment.
    pub name: String,
    /// Origin of the frame.
    pub at: [f64; 3],
    /// Directions of its axes x, y and z.
    pub axes: [[f64; 3]; 3],
}

/// Draws the body from the front and from the right.
#[must_use]
pub fn body_map(map: &BodyMap) -> Figure {
    let mut canvas = Canvas::default();
    let mut top = heading(&mut canvas, MARGIN, &map.title, &map.subtitle, MARGIN) + 6.0;
    let posture = BodyPosture { parts: map.parts.clone(), ..BodyPosture::default() };
    for (view, frames) in [(0, false), (1, true)] {
        let bounds = Bounds::of(&posture, &VIEWS[view], 0.0);
        let [width, height] = bounds.size().map(|size| size.max(1e-6));
        let paper = Paper {
            view: &VIEWS[view],
            center: (0.5 * WIDTH, top + MAP_LINE + 10.0 + 0.5 * MAP_HEIGHT),
            middle: bounds.middle(),
            scale: (MAP_HEIGHT / height).min(MAP_WIDTH / width),
            length_per_newton: 0.0,
        };
        let name =
            if frames { "from the right: segments and patches" } else { "from the front: joints and coordinates" };
        canvas.text((MARGIN, top + MAP_LINE), name, SMALL_SIZE, Align::Left, QUIET_TEXT);
        paper.draw(&mut canvas, &posture, &bounds);
        let labels = if frames { segments(&mut canvas, &paper, map) } else { joints(&paper, map) };
        let bottom = write(&mut canvas, labels, top + 2.0 * MAP_LINE + 10.0);
        top = bottom.max(top + MAP_HEIGHT + 2.0 * MAP_LINE) + 24.0;
    }
    let y = top - 8.0;
    let explained = [
        (EXTERNAL, "x of the segment's frame"),
        (FORCE, "y"),
        (PASSIVE, "z, toward the reader"),
        (CENTER, "patch that can rest on things"),
    ];
    let mut left = MARGIN;
    for (ink, text) in explained {
        canvas.line(&[(left, y - 4.0), (left + 20.0, y - 4.0)], Pen::solid(ink, 2.5));
        canvas.text((left + 26.0, y), text, SMALL_SIZE, Align::Left, TEXT);
        left += 44.0 + 6.6 * text.len() as f64;
    }
    canvas.finish(y + MARGIN)
}

/// A label beside the body.
struct Label {
    at: Point,
    name: String,
    lines: Vec<String>,
    on_left: bool,
}

impl Label {
    fn height(&self) -> f64 {
        MAP_LINE * (1 + self.lines.len()) as f64 + LABEL_GAP
    }
}

fn joints(paper: &Paper<'_>, map: &BodyMap) -> Vec<Label> {
    let label = |joint: &MapJoint| {
        let at = paper.point(joint.at)?;
        // Those of the body's right side are on the left of the sheet, those of the trunk on the right.
        let on_left = at.0 < 0.5 * WIDTH - 2.0;
        Some(Label { at, name: joint.name.clone(), lines: joint.lines.clone(), on_left })
    };
    map.joints.iter().take(MOST_PARTS).filter_map(label).collect()
}

fn segments(canvas: &mut Canvas, paper: &Paper<'_>, map: &BodyMap) -> Vec<Label> {
    for patch in map.patches.iter().take(MOST_PARTS) {
        let mut corners: Vec<Point> = patch.iter().filter_map(|corner| paper.point(*corner)).collect();
        corners.extend(corners.first().copied());
        canvas.line(&corners, Pen::solid(CENTER, 3.0));
        if patch.len() == 1 {
            corners.first().iter().for_each(|at| canvas.dot(**at, 3.5, CENTER, PAPER));
        }
    }
    let mut labels = vec![];
    for (i, frame) in map.frames.iter().take(MOST_PARTS).enumerate() {
        let Some(at) = paper.point(frame.at) else { continue };
        let inks: [Ink; 3] = [EXTERNAL, FORCE, PASSIVE];
        for (axis, ink) in frame.axes.iter().zip(inks) {
            let tip = [0, 1, 2].map(|k| frame.at[k] + AXIS * axis[k]);
            canvas.line(&paper.point(tip).map_or(vec![], |tip| vec![at, tip]), Pen::solid(ink, 1.8));
        }
        labels.push(Label { at, name: frame.name.clone(), lines: vec![], on_left: i % 2 == 0 });
    }
    labels
}

/// Writes labels on both sides of the body from above to below, without overlap; returns where the lower one ends.
fn write(canvas: &mut Canvas, mut labels: Vec<Label>, top: f64) -> f64 {
    labels.sort_by(|a, b| a.at.1.total_cmp(&b.at.1));
    let mut bottoms = [top; 2];
    for label in &labels {
        let bottom = &mut bottoms[usize::from(label.on_left)];
        let y = (label.at.1 - 0.5 * label.height()).max(*bottom);
        let (edge, align, inner) = if label.on_left {
            (MARGIN, Align::Left, MARGIN + LABEL_WIDTH)
        } else {
            (WIDTH - MARGIN, Align::Right, WIDTH - MARGIN - LABEL_WIDTH)
        };
        let widest = label.lines.iter().chain([&label.name]).map(|line| 6.2 * line.chars().count() as f64);
        let reach = widest.fold(0.0, f64::max).min(LABEL_WIDTH) + 6.0;
        let near = if label.on_left { edge + reach } else { edge - reach };
        let middle = y + 0.5 * label.height() - 2.0;
        canvas.line(
            &[(near, middle), (if label.on_left { near.max(inner) } else { near.min(inner) }, middle), label.at],
            Pen::solid(LEADER, 1.0),
        );
        canvas.dot(label.at, 3.5, PAPER, CENTER);
        let name = fit(&label.name, SMALL_SIZE, LABEL_WIDTH);
        canvas.heading((edge, y + MAP_LINE - 2.0), &name, SMALL_SIZE, align);
        for (i, line) in label.lines.iter().enumerate() {
            let at = (edge, y + MAP_LINE * (i + 2) as f64 - 2.0);
            canvas.text(at, &fit(line, SMALL_SIZE, LABEL_WIDTH), SMALL_SIZE, align, TEXT);
        }
        *bottom = y + label.height();
    }
    bottoms[0].max(bottoms[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_joints_stand_in_the_picture_and_odd_numbers_leave_them_out() {
        let part = BodyPart { balls: vec![[0.0, 0.0, 0.0, 0.1], [0.0, 1.0, 0.0, 0.1]], load: None, hazard: false };
        let joint =
            |at, name: &str| MapJoint { at, name: name.to_owned(), lines: vec!["hip_flexion_r: flexion".to_owned()] };
        let joints = vec![joint([0.0, 0.5, 0.1], "hip_r"), joint([f64::NAN, 0.0, 0.0], "odd")];
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let frames = vec![MapFrame { name: "femur_r".to_owned(), at: [0.0, 0.5, 0.1], axes }];
        let patches = vec![vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]], vec![], vec![[f64::INFINITY; 3]]];
        let map =
            BodyMap { title: "Body".to_owned(), parts: vec![part], joints, frames, patches, ..BodyMap::default() };
        let svg = body_map(&map).svg();
        assert!(svg.contains("hip_r") && svg.contains("hip_flexion_r: flexion") && svg.contains("femur_r"));
        assert!(!svg.contains("odd") && !svg.contains("NaN"));
        assert!(!body_map(&BodyMap::default()).svg().contains("NaN"));
    }
}
