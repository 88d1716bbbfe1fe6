//! Measures text and gives the outlines of its letters, from the fonts in `vendor/dejavu`.
//!
//! Letters stand one after the other by their advance widths: no kerning, no ligatures, no right-to-left order.

use tiny_skia::PathBuilder;
use ttf_parser::{Face, FaceParsingError, GlyphId, OutlineBuilder};

const REGULAR: &[u8] = include_bytes!("../vendor/dejavu/DejaVuSans.ttf");
const BOLD: &[u8] = include_bytes!("../vendor/dejavu/DejaVuSans-Bold.ttf");

/// One font.
pub(crate) struct Font {
    face: Face<'static>,
}

/// Both fonts of the pictures.
pub(crate) struct Fonts {
    pub(crate) regular: Font,
    pub(crate) bold: Font,
}

impl Fonts {
    /// Reads the tables of the fonts.
    pub(crate) fn read() -> Result<Self, FaceParsingError> {
        let font = |bytes| Face::parse(bytes, 0).map(|face| Font { face });
        Ok(Self { regular: font(REGULAR)?, bold: font(BOLD)? })
    }
}

impl Font {
    /// Width of a text whose em is `size` long.
    pub(crate) fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(self.glyph(c), size)).sum()
    }

    /// Adds the outlines of a text to a path; its baseline begins at the point.
    pub(crate) fn outline(&self, text: &str, size: f32, (x, y): (f32, f32), path: &mut PathBuilder) {
        let mut letter = Letter { path, x, y, scale: self.scale(size) };
        for c in text.chars() {
            let glyph = self.glyph(c);
            // A letter without outline, a space, has no bounding box either.
            let _ = self.face.outline_glyph(glyph, &mut letter);
            letter.x += self.advance(glyph, size);
        }
    }

    /// The letter's glyph, or the one that stands for missing letters.
    fn glyph(&self, c: char) -> GlyphId {
        self.face.glyph_index(c).unwrap_or(GlyphId(0))
    }

    fn advance(&self, glyph: GlyphId, size: f32) -> f32 {
        f32::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)) * self.scale(size)
    }

    fn scale(&self, size: f32) -> f32 {
        size / f32::from(self.face.units_per_em())
    }
}

/// Writes one letter into a path: the font's y axis points up, the sheet's down.
struct Letter<'a> {
    path: &'a mut PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Letter<'_> {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + self.scale * x, self.y - self.scale * y)
    }
}

impl OutlineBuilder for Letter<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let [(x1, y1), (x2, y2), (x, y)] = [self.place(x1, y1), self.place(x2, y2), self.place(x, y)];
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use sha2::{Digest, Sha256};

    use super::*;

    #[test]
    fn the_fonts_are_the_files_that_their_readme_names() {
        let readme = include_str!("../vendor/dejavu/README.md");
        for (name, bytes) in [("DejaVuSans.ttf", REGULAR), ("DejaVuSans-Bold.ttf", BOLD)] {
            let digest: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
            assert!(readme.contains(&format!("| `{name}` | `{digest}` |")), "{name}: {digest}");
        }
    }

    #[test]
    fn widths_are_the_advances_of_dejavu_sans() {
        let fonts = Fonts::read().unwrap();
        // hmtx, units of 1/2048 em: i 569, M 1767, bold M 2038.
        assert_eq!(fonts.regular.width("iM", 2048.0), 569.0 + 1767.0);
        assert_eq!(fonts.bold.width("M", 2048.0), 2038.0);
    }

    #[test]
    fn a_letter_stands_on_its_baseline() {
        let mut path = PathBuilder::new();
        Fonts::read().unwrap().regular.outline(" H", 100.0, (10.0, 50.0), &mut path);
        let bounds = path.finish().unwrap().bounds();
        assert_eq!(bounds.bottom(), 50.0);
        assert!((bounds.top() - (50.0 - 72.9)).abs() < 0.1, "{bounds:?}");
        assert!(bounds.left() > 10.0 + 31.0, "{bounds:?}");
    }
}
