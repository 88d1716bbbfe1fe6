//! Holds every colour, pen and size of the pictures.
//!
//! The colours are the paper's: passive torque blue, external torque red, active torque brown (its opposite dotted),
//! path yellow, start black, goal green.

/// A colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ink(pub(crate) u8, pub(crate) u8, pub(crate) u8);

pub(crate) const PASSIVE: Ink = Ink(0x1f, 0x5f, 0xbf);
pub(crate) const EXTERNAL: Ink = Ink(0xcc, 0x22, 0x22);
pub(crate) const ACTIVE: Ink = Ink(0x85, 0x4a, 0x1e);
pub(crate) const PATH: Ink = Ink(0xf7, 0xc4, 0x2e);
pub(crate) const START: Ink = Ink(0x11, 0x11, 0x11);
pub(crate) const GOAL: Ink = Ink(0x1e, 0x96, 0x46);
/// Fatigue of the muscle groups for positive and negative torque.
pub(crate) const POSITIVE: Ink = Ink(0xd0, 0x6f, 0x1c);
pub(crate) const NEGATIVE: Ink = Ink(0x6a, 0x4f, 0xa3);

pub(crate) const TEXT: Ink = Ink(0x22, 0x22, 0x22);
pub(crate) const QUIET_TEXT: Ink = Ink(0x5c, 0x5c, 0x5c);
pub(crate) const FRAME: Ink = Ink(0x55, 0x55, 0x55);
pub(crate) const GRID: Ink = Ink(0xea, 0xea, 0xea);
pub(crate) const LEADER: Ink = Ink(0xb4, 0xb4, 0xb4);
pub(crate) const TRUNK: Ink = Ink(0xb0, 0xb0, 0xb0);
/// The zone in which a passive curve is flattest.
pub(crate) const FLAT_ZONE: Ink = Ink(0xe6, 0xee, 0xf9);
pub(crate) const PAPER: Ink = Ink(0xff, 0xff, 0xff);

/// Bodies: colours of the report's page.
const LOAD: [[f64; 3]; 4] = [[0.98, 0.93, 0.76], [0.98, 0.72, 0.34], [0.86, 0.36, 0.13], [0.52, 0.08, 0.12]];
pub(crate) const UNKNOWN: Ink = Ink(0xb9, 0xbf, 0xc9);
pub(crate) const FORCE: Ink = Ink(0x00, 0x9e, 0x73);
pub(crate) const HELD: Ink = Ink(0x6a, 0x2c, 0x91);
pub(crate) const SURFACE: Ink = Ink(0xa0, 0x7a, 0x4c);
pub(crate) const THING: Ink = Ink(0x5f, 0x76, 0x90);
pub(crate) const CENTER: Ink = Ink(0x1b, 0x1f, 0x26);
pub(crate) const GHOST: Ink = Ink(0xec, 0xee, 0xf1);
pub(crate) const GHOST_EDGE: Ink = Ink(0xb4, 0xbb, 0xc6);
pub(crate) const GROUND: Ink = Ink(0xf5, 0xf6, 0xf8);

/// The colour of a load, as a share of the end of the scale; shares below 0 count as 0, above 1 as 1.
pub(crate) fn load_ink(share: f64) -> Ink {
    let place = share.clamp(0.0, 1.0) * (LOAD.len() - 1) as f64;
    let below = (place.floor() as usize).min(LOAD.len() - 2);
    let [red, green, blue] = [0, 1, 2].map(|k| {
        let (a, b) = (LOAD[below][k], LOAD[below + 1][k]);
        (255.0 * (a + (b - a) * (place - below as f64))).round() as u8
    });
    Ink(red, green, blue)
}

/// Sizes of text, px.
pub(crate) const TITLE_SIZE: u32 = 15;
pub(crate) const LABEL_SIZE: u32 = 12;
pub(crate) const SMALL_SIZE: u32 = 11;

/// Width of every figure, px.
pub(crate) const WIDTH: f64 = 800.0;
/// Left edge of the frames: room for the tick labels and the vertical axis label.
pub(crate) const FRAME_LEFT: f64 = 80.0;
/// Width of the frames; the legend stands to the right of them.
pub(crate) const FRAME_WIDTH: f64 = 568.0;
/// Left edge of the legend.
pub(crate) const LEGEND_LEFT: f64 = FRAME_LEFT + FRAME_WIDTH + 16.0;
/// Space between two frames of one chart.
pub(crate) const FRAME_GAP: f64 = 18.0;
/// Room below a frame for the numbers and the label of its horizontal axis.
pub(crate) const BELOW_FRAME: f64 = 44.0;
/// Free space around the whole figure.
pub(crate) const MARGIN: f64 = 16.0;

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) ink: Ink,
    /// Line width, px.
    pub(crate) width: f64,
    /// Lengths of a dash and of the gap after it, px; none for a solid line.
    pub(crate) dash: Option<(f64, f64)>,
}

impl Pen {
    pub(crate) const fn solid(ink: Ink, width: f64) -> Self {
        Self { ink, width, dash: None }
    }

    pub(crate) const fn dashed(ink: Ink, width: f64, dash: f64, gap: f64) -> Self {
        Self { ink, width, dash: Some((dash, gap)) }
    }
}

pub(crate) const PASSIVE_PEN: Pen = Pen::solid(PASSIVE, 1.6);
pub(crate) const TOLERANCE_PEN: Pen = Pen::dashed(PASSIVE, 0.9, 2.0, 3.0);
pub(crate) const EXTERNAL_PEN: Pen = Pen::solid(EXTERNAL, 2.0);
pub(crate) const ACTIVE_PEN: Pen = Pen::solid(ACTIVE, 2.0);
pub(crate) const MINUS_ACTIVE_PEN: Pen = Pen::dashed(ACTIVE, 1.6, 2.0, 4.0);
pub(crate) const PATH_PEN: Pen = Pen::solid(PATH, 7.0);
pub(crate) const ANGLE_PEN: Pen = Pen::solid(TEXT, 2.0);
pub(crate) const POSITIVE_PEN: Pen = Pen::solid(POSITIVE, 2.0);
pub(crate) const NEGATIVE_PEN: Pen = Pen::solid(NEGATIVE, 2.0);
pub(crate) const CRITICAL_PEN: Pen = Pen::dashed(TEXT, 1.2, 7.0, 4.0);
pub(crate) const RECOVERY_PEN: Pen = Pen::dashed(TEXT, 1.2, 2.0, 3.0);
pub(crate) const FRAME_PEN: Pen = Pen::solid(FRAME, 1.0);
pub(crate) const GRID_PEN: Pen = Pen::solid(GRID, 1.0);
pub(crate) const ZERO_PEN: Pen = Pen::solid(LEADER, 1.0);
pub(crate) const LEADER_PEN: Pen = Pen::dashed(LEADER, 1.0, 3.0, 3.0);
pub(crate) const OUTLINE_PEN: Pen = Pen::solid(Ink(0x45, 0x4b, 0x55), 0.8);
pub(crate) const SURFACE_PEN: Pen = Pen::solid(SURFACE, 1.0);
pub(crate) const THING_PEN: Pen = Pen::solid(THING, 1.0);
pub(crate) const GROUND_PEN: Pen = Pen::solid(LEADER, 1.0);
pub(crate) const PLUMB_PEN: Pen = Pen::dashed(CENTER, 1.2, 4.0, 3.0);
pub(crate) const TARGET_PEN: Pen = Pen::solid(EXTERNAL, 2.4);
pub(crate) const GAZE_PEN: Pen = Pen::dashed(PASSIVE, 1.2, 5.0, 4.0);
