//! Offers a finished picture as SVG text and as the bytes of a PNG file, both of the same shapes.

use crate::png::png;
use crate::shape::Shape;
use crate::svg::svg;

/// Greatest height of a PNG in SVG units; beyond it the pixels would fill too much memory.
const MAX_PNG_HEIGHT: f64 = 8_000.0;

/// The reason for which a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The figure is too tall for a PNG; its SVG still works.
    #[error(
        "a figure {height:.0} px tall is too large for a PNG (limit {limit:.0} px): draw fewer panels at once, or use SVG"
    )]
    TooTall {
        /// Height of this figure, in SVG units (px).
        height: f64,
        /// Greatest height accepted, in SVG units (px).
        limit: f64,
    },
    /// The PNG encoder failed; the text says why.
    #[error("the PNG encoder failed: {0}")]
    Encode(String),
}

/// A finished picture, 800 SVG units wide.
pub struct Figure {
    height: f64,
    shapes: Vec<Shape>,
}

impl Figure {
    pub(crate) fn new(height: f64, shapes: Vec<Shape>) -> Self {
        Self { height, shapes }
    }

    /// The picture as SVG text: self-contained, the same for the same input, scaling with the page it stands on.
    #[must_use]
    pub fn svg(&self) -> String {
        svg(self.height, &self.shapes)
    }

    /// The picture as the bytes of a PNG file, 1600 pixels wide, drawn with vendored fonts.
    ///
    /// # Errors
    ///
    /// [`PlotError::TooTall`] if the figure has too many panels for one image; [`PlotError::Encode`] if encoding fails.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        if self.height > MAX_PNG_HEIGHT {
            return Err(PlotError::TooTall { height: self.height, limit: MAX_PNG_HEIGHT });
        }
        png(self.height, &self.shapes).map_err(PlotError::Encode)
    }
}
