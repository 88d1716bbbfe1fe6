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

/// Bodies: bands of load, each with the share of strength from which on it is in force, and its colours at that share and at the
/// end of the band; as on the report's page. Every colour is darker than those before it, so that the order is seen without colours.
///
/// Bounds: 8 and 14 % are the endurance limits of an hour of sustained (7.9 %) and of intermittent (14.0 %) holding (Björkstén &
/// Jonsson 1977, Scand. J. Work Environ. Health 3:23-27, abstract: measured); 50 % is Jonsson's limit of peak loads (1978, J. Hum.
/// Ergol. 7: recalled); 100 % is the strength itself (derived).
pub(crate) const LOAD_BANDS: [(f64, Ink, Ink); 5] = [
    (0.0, Ink(0xe2, 0xf5, 0xd3), Ink(0xbf, 0xe3, 0x9f)),
    (0.08, Ink(0xef, 0xcf, 0x3a), Ink(0xe3, 0xb5, 0x16)),
    (0.14, Ink(0xe8, 0x94, 0x2a), Ink(0xcf, 0x6a, 0x12)),
    (0.5, Ink(0xb5, 0x30, 0x1f), Ink(0x8c, 0x14, 0x18)),
    (1.0, Ink(0x3d, 0x0a, 0x1e), Ink(0x3d, 0x0a, 0x1e)),
];
pub(crate) const UNKNOWN: Ink = Ink(0xb9, 0xbf, 0xc9);
pub(crate) const FORCE: Ink = Ink(0x00, 0x9e, 0x73);
pub(crate) const HELD: Ink = Ink(0x6a, 0x2c, 0x91);
/// Parts that hang on ligaments where that is a hazard.
pub(crate) const HAZARD: Ink = Ink(0xc2, 0x18, 0x8f);
pub(crate) const SURFACE: Ink = Ink(0xa0, 0x7a, 0x4c);
pub(crate) const THING: Ink = Ink(0x5f, 0x76, 0x90);
pub(crate) const CENTER: Ink = Ink(0x1b, 0x1f, 0x26);
pub(crate) const GHOST: Ink = Ink(0xec, 0xee, 0xf1);
pub(crate) const GHOST_EDGE: Ink = Ink(0xb4, 0xbb, 0xc6);
/// Parts of a body under its muscles: darker than a body at the start.
pub(crate) const UNDER_MUSCLES: Ink = Ink(0xd3, 0xd8, 0xdf);
pub(crate) const GROUND: Ink = Ink(0xf5, 0xf6, 0xf8);

/// Limits of a force, as on the report's page (Okabe & Ito's colours, recalled); the last stands for all others.
pub(crate) const LIMITS: [Ink; 8] = [
    Ink(0xe6, 0x9f, 0x00),
    Ink(0x56, 0xb4, 0xe9),
    Ink(0x00, 0x9e, 0x73),
    Ink(0xd5, 0x5e, 0x00),
    Ink(0x00, 0x72, 0xb2),
    Ink(0xcc, 0x79, 0xa7),
    Ink(0x7a, 0x5c, 0x2e),
    Ink(0x88, 0x88, 0x88),
];

/// Red, green and blue of a load, a share of strength, on the fixed scale of all pictures.
pub fn load_color(load: f64) -> [u8; 3] {
    let Ink(red, green, blue) = load_ink(load);
    [red, green, blue]
}

/// The colour of a load, a share of strength; below 0 it counts as 0.
pub(crate) fn load_ink(load: f64) -> Ink {
    let band = LOAD_BANDS.iter().rposition(|(from, ..)| *from <= load + SHARE_TOLERANCE).unwrap_or(0);
    let (from, low, high) = LOAD_BANDS[band];
    let to = LOAD_BANDS.get(band + 1).map_or(from + 1.0, |(to, ..)| *to);
    let place = ((load - from) / (to - from)).clamp(0.0, 1.0);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * place).round() as u8;
    Ink(mix(low.0, high.0), mix(low.1, high.1), mix(low.2, high.2))
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

/// A load so little below a bound, as a share of strength, is in the band above it.
const SHARE_TOLERANCE: f64 = 1e-9;

/// Colour, width and dashes of a line.
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

/// Curves and bars of groups of people, told apart by colour and dashes.
pub(crate) const SERIES_PENS: [Pen; 2] = [Pen::solid(LIMITS[3], 2.2), Pen::dashed(LIMITS[4], 2.2, 7.0, 4.0)];

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour (IEC 61966-2-1).
    fn luminance(Ink(red, green, blue): Ink) -> f64 {
        let linear = |v: u8| {
            let v = f64::from(v) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
        };
        0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
    }

    #[test]
    fn a_greater_load_has_a_darker_colour_and_each_band_its_own() {
        let loads: Vec<f64> = (0..=120).map(|percent| f64::from(percent) / 100.0).collect();
        for pair in loads.windows(2) {
            let [before, after] = [pair[0], pair[1]].map(|load| luminance(load_ink(load)));
            assert!(after <= before, "{pair:?}: {before} {after}");
        }
        for (k, (from, low, high)) in LOAD_BANDS.iter().enumerate() {
            assert_eq!(load_ink(*from), *low);
            if let Some((to, next, _)) = LOAD_BANDS.get(k + 1) {
                assert_eq!(load_ink(to - 1e-6), *high);
                let contrast = (luminance(*high) + 0.05) / (luminance(*next) + 0.05);
                assert!(contrast > 1.1 || k == 0, "{to}: {contrast}");
            }
        }
        assert_eq!(load_ink(-1.0), load_ink(0.0));
        assert_eq!(load_ink(7.0), load_ink(1.0));
    }
}
