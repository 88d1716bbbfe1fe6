//! Names the marks of which a picture consists; `svg` writes them, `png` draws them.
//!
//! Coordinates and sizes are SVG units (px), x right, y down. Lines have round ends and round joins.

use crate::geometry::{Point, Rect};
use crate::path::Path;
use crate::style::Ink;

/// Position of a text relative to its point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Align {
    Left,
    Middle,
    Right,
}

/// One line of text; `at` is on its baseline.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub(crate) at: Point,
    pub(crate) content: String,
    pub(crate) size: u32,
    pub(crate) align: Align,
    pub(crate) bold: bool,
    /// Whether it reads upwards, turned by a quarter about `at`.
    pub(crate) upward: bool,
    pub(crate) ink: Ink,
}

/// One mark.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// A path drawn with a pen; with `fill`, its inside is filled first, opaque at 1 and not at all at 0.
    Path {
        path: Path,
        fill: Option<(Ink, f64)>,
        stroke: Ink,
        width: f64,
    },
    /// A filled circle with a rim.
    Circle {
        center: Point,
        radius: f64,
        fill: Ink,
        rim: Ink,
        rim_width: f64,
    },
    /// A filled rectangle without outline.
    Block {
        area: Rect,
        fill: Ink,
    },
    Text(Text),
}
