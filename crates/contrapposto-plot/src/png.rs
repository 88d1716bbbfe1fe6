//! Draws a picture as pixels and writes them as PNG.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::font::{Font, Fonts};
use crate::path::{Path, Step};
use crate::shape::{Align, Shape, Text};
use crate::style::{Ink, WIDTH};

/// Image pixels for one unit of the SVG: a figure 800 units wide becomes 1600 pixels wide.
const PIXELS_PER_UNIT: f32 = 2.0;

/// The bytes of the PNG file of a picture of the given height; an error as text.
pub(crate) fn png(height: f64, shapes: &[Shape]) -> Result<Vec<u8>, String> {
    let fonts = Fonts::read().map_err(|error| error.to_string())?;
    let pixels = |length: f64| (length as f32 * PIXELS_PER_UNIT).ceil() as u32;
    let pixmap = Pixmap::new(pixels(WIDTH), pixels(height)).ok_or("the picture has no height")?;
    let mut sheet = Sheet { pixmap, fonts };
    sheet.pixmap.fill(Color::WHITE);
    for shape in shapes {
        sheet.draw(shape);
    }
    sheet.pixmap.encode_png().map_err(|error| error.to_string())
}

/// The pixels drawn so far.
struct Sheet {
    pixmap: Pixmap,
    fonts: Fonts,
}

impl Sheet {
    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Path { path, fill, stroke, width } => {
                let path = outline(path);
                if let Some((fill, opacity)) = fill {
                    self.fill(path.as_ref(), paint(*fill, *opacity), Transform::identity());
                }
                self.stroke(path.as_ref(), *stroke, *width);
            }
            Shape::Circle { center, radius, fill, rim, rim_width } => {
                let circle = PathBuilder::from_circle(center.0 as f32, center.1 as f32, *radius as f32);
                self.fill(circle.as_ref(), paint(*fill, 1.0), Transform::identity());
                self.stroke(circle.as_ref(), *rim, *rim_width);
            }
            Shape::Block { area, fill } => {
                let [left, top, width, height] = [area.left, area.top, area.width, area.height].map(|v| v as f32);
                let block = tiny_skia::Rect::from_xywh(left, top, width, height).map(PathBuilder::from_rect);
                self.fill(block.as_ref(), paint(*fill, 1.0), Transform::identity());
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn text(&mut self, text: &Text) {
        let font: &Font = if text.bold { &self.fonts.bold } else { &self.fonts.regular };
        let (x, y, size) = (text.at.0 as f32, text.at.1 as f32, text.size as f32);
        let width = font.width(&text.content, size);
        let left = match text.align {
            Align::Left => x,
            Align::Middle => x - 0.5 * width,
            Align::Right => x - width,
        };
        let mut letters = PathBuilder::new();
        font.outline(&text.content, size, (left, y), &mut letters);
        let turn = if text.upward { Transform::from_rotate_at(-90.0, x, y) } else { Transform::identity() };
        self.fill(letters.finish().as_ref(), paint(text.ink, 1.0), turn);
    }

    /// A path without points, or with one that is not a number, is not drawn.
    fn fill(&mut self, path: Option<&tiny_skia::Path>, paint: Paint, turn: Transform) {
        if let Some(path) = path {
            let transform = turn.post_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT);
            self.pixmap.fill_path(path, &paint, FillRule::Winding, transform, None);
        }
    }

    fn stroke(&mut self, path: Option<&tiny_skia::Path>, ink: Ink, width: f64) {
        let round =
            Stroke { width: width as f32, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = path {
            self.pixmap.stroke_path(
                path,
                &paint(ink, 1.0),
                &round,
                Transform::from_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT),
                None,
            );
        }
    }
}

fn outline(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for step in &path.0 {
        match *step {
            Step::Move((x, y)) => builder.move_to(x as f32, y as f32),
            Step::Line((x, y)) => builder.line_to(x as f32, y as f32),
            Step::Curve(a, b, end) => {
                let [x1, y1, x2, y2, x, y] = [a.0, a.1, b.0, b.1, end.0, end.1].map(|v| v as f32);
                builder.cubic_to(x1, y1, x2, y2, x, y);
            }
            Step::Close => builder.close(),
        }
    }
    builder.finish()
}

fn paint(ink: Ink, opacity: f64) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(ink.0, ink.1, ink.2, (255.0 * opacity).round() as u8);
    paint
}
