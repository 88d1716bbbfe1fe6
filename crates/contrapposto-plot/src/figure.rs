//! What does a finished picture offer? SVG text and PNG bytes of one and the same scene.

use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::render::Scene;

/// Image pixels for one unit of the SVG: a figure 800 units wide becomes 1600 pixels wide.
const PNG_SCALE: f32 = 2.0;

/// Greatest height of a PNG in SVG units; beyond it the pixels would fill too much memory.
const MAX_PNG_HEIGHT: f64 = 8_000.0;

/// Why a picture could not be made.
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
    scene: Scene,
}

impl Figure {
    pub(crate) fn new(scene: Scene) -> Self {
        Self { scene }
    }

    /// The picture as SVG text: self-contained, the same for the same input, scaling with the page it stands on.
    #[must_use]
    pub fn svg(&self) -> String {
        let (width, height) = (self.scene.width, self.scene.height);
        // Round ends and joints are what the PNG renderer draws.
        let round = r#"stroke-linecap="round" stroke-linejoin="round""#;
        let opening = format!(r#"<svg viewBox="0 0 {width} {height}" {round} "#);
        SvgBackend::new().with_pretty(true).render_scene(&self.scene).replacen("<svg ", &opening, 1)
    }

    /// The picture as the bytes of a PNG file, 1600 pixels wide, drawn with bundled fonts.
    ///
    /// # Errors
    ///
    /// [`PlotError::TooTall`] if the figure has too many panels for one image; [`PlotError::Encode`] if encoding fails.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        if self.scene.height > MAX_PNG_HEIGHT {
            return Err(PlotError::TooTall { height: self.scene.height, limit: MAX_PNG_HEIGHT });
        }
        PngBackend::new().with_scale(PNG_SCALE).render_scene(&self.scene).map_err(PlotError::Encode)
    }
}
