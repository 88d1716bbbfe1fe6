//! Collects the marks of a picture on a sheet of fixed width that grows downwards.
//!
//! Coordinates are SVG units (px), x right, y down. Dashed lines become one path of separate lines, so that SVG and PNG show the
//! same dashes.

use crate::figure::Figure;
use crate::geometry::{Point, Rect, dashes};
use crate::path::Path;
use crate::shape::{Align, Shape, Text};
use crate::style::{Ink, Pen, TEXT};

/// Width of the rim of a dot, px.
const RIM: f64 = 1.5;

/// The sheet; [`Canvas::finish`] cuts it.
#[derive(Default)]
pub(crate) struct Canvas {
    shapes: Vec<Shape>,
}

impl Canvas {
    /// Cuts the sheet at `height` and hands it over as a figure.
    pub(crate) fn finish(self, height: f64) -> Figure {
        Figure::new(height.ceil(), self.shapes)
    }

    /// A line through points; of fewer than two points, nothing.
    pub(crate) fn line(&mut self, points: &[Point], pen: Pen) {
        if points.len() < 2 {
            return;
        }
        let path = match pen.dash {
            Some((dash, gap)) => Path::lines(&dashes(points, dash, gap)),
            None => Path::lines(&[points.to_vec()]),
        };
        self.shapes.push(Shape::Path { path, fill: None, stroke: pen.ink, width: pen.width });
    }

    /// A filled closed path with a solid outline.
    pub(crate) fn shape(&mut self, path: Path, fill: Ink, pen: Pen) {
        self.shapes.push(Shape::Path { path, fill: Some((fill, 1.0)), stroke: pen.ink, width: pen.width });
    }

    /// A polygon through which the marks below it are seen, without an outline; of fewer than three points, nothing.
    pub(crate) fn glass(&mut self, corners: &[Point], fill: Ink, opacity: f64) {
        if corners.len() > 2 {
            let path = Path::polygon(corners);
            self.shapes.push(Shape::Path { path, fill: Some((fill, opacity)), stroke: fill, width: 0.0 });
        }
    }

    /// A filled polygon with an outline; of fewer than three points, nothing.
    pub(crate) fn polygon(&mut self, corners: &[Point], fill: Ink, pen: Pen) {
        if corners.len() > 2 {
            self.shape(Path::polygon(corners), fill, pen);
        }
    }

    /// A round dot with a thin rim.
    pub(crate) fn dot(&mut self, center: Point, radius: f64, fill: Ink, rim: Ink) {
        self.shapes.push(Shape::Circle { center, radius, fill, rim, rim_width: RIM });
    }

    /// A filled rectangle without outline, from its top left corner.
    pub(crate) fn block(&mut self, (left, top): Point, width: f64, height: f64, fill: Ink) {
        self.shapes.push(Shape::Block { area: Rect { left, top, width, height }, fill });
    }

    /// One line of text; `at` is on its baseline.
    pub(crate) fn text(&mut self, at: Point, content: &str, size: u32, align: Align, ink: Ink) {
        let content = printable(content);
        self.shapes.push(Shape::Text(Text { at, content, size, align, bold: false, upward: false, ink }));
    }

    /// One line of bold text, in the colour of text.
    pub(crate) fn heading(&mut self, at: Point, content: &str, size: u32, align: Align) {
        let content = printable(content);
        self.shapes.push(Shape::Text(Text { at, content, size, align, bold: true, upward: false, ink: TEXT }));
    }

    /// One line of text that reads upwards, centred on `at`.
    pub(crate) fn upward_text(&mut self, at: Point, content: &str, size: u32) {
        let (content, align) = (printable(content), Align::Middle);
        self.shapes.push(Shape::Text(Text { at, content, size, align, bold: false, upward: true, ink: TEXT }));
    }
}

/// The text without the characters that XML forbids.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}
