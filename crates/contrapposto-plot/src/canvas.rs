//! How does a shape reach the paper? This file alone speaks to the drawing library `kuva` (with `figure.rs`, which renders).
//!
//! Coordinates are SVG units (px), x right, y down. Dashes are cut here into separate lines, because the library
//! starts the dash pattern anew at every point in PNG but not in SVG: cut lines look the same in both.
//! (All the dashes of a line are one path of the SVG.)

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor, TextSpan};

use crate::figure::Figure;
use crate::geometry::{Point, dashes};
use crate::style::{Ink, Pen, TEXT, WIDTH};

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Align {
    Left,
    Middle,
    Right,
}

/// A sheet of fixed width that grows downwards until [`Canvas::finish`].
pub(crate) struct Canvas {
    scene: Scene,
}

impl Canvas {
    pub(crate) fn new() -> Self {
        let mut scene = Scene::new(WIDTH, 0.0);
        scene.font_family = Some("'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif".to_owned());
        Self { scene }
    }

    /// Cuts the sheet at `height` and hands it over as a figure.
    pub(crate) fn finish(mut self, height: f64) -> Figure {
        self.scene.height = height.ceil();
        Figure::new(self.scene)
    }

    /// A line through points; of fewer than two points, nothing.
    pub(crate) fn line(&mut self, points: &[Point], pen: Pen) {
        if points.len() < 2 {
            return;
        }
        let stroke = color(pen.ink);
        let Some((dash, gap)) = pen.dash else {
            return self.scene.add(Primitive::PolyLine {
                points: points.to_vec(),
                stroke,
                stroke_width: pen.width,
                stroke_dasharray: None,
            });
        };
        self.scene.add(Primitive::Path(Box::new(PathData {
            d: path_data(&dashes(points, dash, gap)),
            fill: None,
            stroke,
            stroke_width: pen.width,
            opacity: None,
            stroke_dasharray: None,
        })));
    }

    /// A round dot with a thin rim.
    pub(crate) fn dot(&mut self, center: Point, radius: f64, fill: Ink, rim: Ink) {
        self.scene.add(Primitive::Circle {
            cx: center.0,
            cy: center.1,
            r: radius,
            fill: color(fill),
            fill_opacity: None,
            stroke: Some(color(rim)),
            stroke_width: Some(1.5),
        });
    }

    /// A filled rectangle without outline, from its top left corner.
    pub(crate) fn block(&mut self, corner: Point, width: f64, height: f64, fill: Ink) {
        self.scene.add(Primitive::Rect {
            x: corner.0,
            y: corner.1,
            width,
            height,
            fill: color(fill),
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
    }

    /// A filled shape with an outline, as SVG path data that ends in `Z`.
    pub(crate) fn shape(&mut self, d: String, fill: Ink, pen: Pen) {
        self.scene.add(Primitive::Path(Box::new(PathData {
            d,
            fill: Some(color(fill)),
            stroke: color(pen.ink),
            stroke_width: pen.width,
            opacity: None,
            stroke_dasharray: None,
        })));
    }

    /// A filled polygon with an outline; of fewer than three points, nothing.
    pub(crate) fn polygon(&mut self, corners: &[Point], fill: Ink, pen: Pen) {
        if corners.len() > 2 {
            self.shape(path_data(&[corners.to_vec()]) + "Z", fill, pen);
        }
    }

    /// One line of text; `at` is on its baseline.
    pub(crate) fn text(&mut self, at: Point, content: &str, size: u32, align: Align, ink: Ink) {
        self.spans(at, TextSpan::plain(printable(content)), size, align, ink);
    }

    /// One line of bold text, in the colour of text.
    pub(crate) fn heading(&mut self, at: Point, content: &str, size: u32, align: Align) {
        let mut span = TextSpan::plain(printable(content));
        span.bold = true;
        self.spans(at, span, size, align, TEXT);
    }

    /// One line of text that reads upwards, centred on `at`.
    pub(crate) fn upward_text(&mut self, at: Point, content: &str, size: u32) {
        self.scene.add(Primitive::Text {
            x: at.0,
            y: at.1,
            // The library reads $...$ as mathematics here; a backslash makes the dollar a plain one.
            content: printable(content).replace('$', "\\$"),
            size,
            anchor: TextAnchor::Middle,
            rotate: Some(-90.0),
            bold: false,
            color: Some(color(TEXT)),
        });
    }

    fn spans(&mut self, at: Point, span: TextSpan, size: u32, align: Align, ink: Ink) {
        self.scene.add(Primitive::RichText {
            x: at.0,
            y: at.1,
            spans: vec![span],
            size,
            anchor: match align {
                Align::Left => TextAnchor::Start,
                Align::Middle => TextAnchor::Middle,
                Align::Right => TextAnchor::End,
            },
            color: Some(color(ink)),
        });
    }
}

/// Several lines as one SVG path.
fn path_data(lines: &[Vec<Point>]) -> String {
    let mut data = String::new();
    for (i, (x, y)) in lines.iter().flat_map(|line| line.iter().enumerate()) {
        let command = if i == 0 { 'M' } else { 'L' };
        data.push_str(&format!("{command}{x:.2} {y:.2}"));
    }
    data
}

fn color(ink: Ink) -> Color {
    Color::Rgb(ink.0, ink.1, ink.2)
}

/// The text without the characters that XML forbids (the library escapes the rest).
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}

/// Width of a text in px, slightly too large rather than too small (advances of DejaVu Sans).
pub(crate) fn text_width(text: &str, size: u32) -> f64 {
    let ems: f64 = text.chars().map(advance).sum();
    ems * f64::from(size)
}

fn advance(c: char) -> f64 {
    match c {
        ' ' | 'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' => 0.34,
        'f' | 'r' | 't' | 'I' | '(' | ')' | '[' | ']' | '!' | '-' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 1.0,
        'A'..='Z' | '&' => 0.76,
        '\u{1100}'.. => 1.0,
        _ => 0.65,
    }
}

/// The text, or as much of its beginning as fits into `width` px, ended by an ellipsis.
pub(crate) fn fit(text: &str, size: u32, width: f64) -> String {
    // No glyph is narrower than 0.34 em, so texts of megabytes need not be measured to their end.
    let longest = (width / (0.34 * f64::from(size))) as usize + 1;
    let beginning: String = text.chars().take(longest + 1).collect();
    if text_width(&beginning, size) <= width {
        return beginning;
    }
    let room = width - text_width("…", size);
    let mut used = 0.0;
    let mut kept: String = beginning
        .chars()
        .take_while(|&c| {
            used += advance(c) * f64::from(size);
            used <= room
        })
        .collect();
    kept.truncate(kept.trim_end().len());
    kept.push('…');
    kept
}

/// The text in at most `max_lines` lines of `width` px each; what does not fit ends in an ellipsis.
pub(crate) fn wrap(text: &str, size: u32, width: f64, max_lines: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let last_line = lines.len() == max_lines;
        match lines.last_mut() {
            Some(line) if last_line || text_width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fit(line, size, width)).collect()
}
