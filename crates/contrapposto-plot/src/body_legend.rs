//! Draws the legend of a body figure: colours, arrows, dots, crosses and a scale of length, in as many rows as the entries need.

use crate::axes::number_text;
use crate::body::{BodyFigure, BodyPosture};
use crate::body_paper::{GLASS, arrow, cross};
use crate::canvas::Canvas;
use crate::geometry::Point;
use crate::shape::Align;
use crate::style::{
    CENTER, FORCE, GAZE_PEN, GHOST, GHOST_EDGE, HAZARD, HELD, Ink, LOAD_BANDS, MARGIN, OUTLINE_PEN, PAPER, Pen,
    SMALL_SIZE, SURFACE_PEN, TEXT, THING_PEN, UNKNOWN, WIDTH, load_ink,
};
use crate::text::{fit, text_width};

/// Length of the sample of a line of sight, px.
const GAZE_SAMPLE: f64 = 20.0;
/// Width of a band of load, and space beside the bound between two bands, px.
const BAND: f64 = 24.0;
const BOUND_GAP: f64 = 4.0;
/// Height of a sample, and width of a square one, px.
const SAMPLE_HEIGHT: f64 = 11.0;
/// Pieces of a band.
const SHADES: u32 = 12;
/// Space between two entries, px.
const ENTRY_GAP: f64 = 20.0;
/// Distance of two rows, px.
const ROW_HEIGHT: f64 = 22.0;

struct Row<'a> {
    canvas: &'a mut Canvas,
    at: Point,
}

impl Row<'_> {
    /// One entry: a sample `width` px wide, drawn from its left end on the middle of the row, and its meaning.
    fn entry(&mut self, before: &str, width: f64, label: &str, draw: impl FnOnce(&mut Canvas, Point)) {
        let label = fit(label, SMALL_SIZE, WIDTH - 2.0 * MARGIN - width - 7.0);
        let lead = if before.is_empty() { 0.0 } else { text_width(before, SMALL_SIZE) + 7.0 };
        let whole = lead + width + 7.0 + text_width(&label, SMALL_SIZE);
        if self.at.0 > MARGIN && self.at.0 + whole > WIDTH - MARGIN {
            self.at = (MARGIN, self.at.1 + ROW_HEIGHT);
        }
        let (x, y) = self.at;
        self.canvas.text((x, y + 4.0), before, SMALL_SIZE, Align::Left, TEXT);
        draw(self.canvas, (x + lead, y));
        self.canvas.text((x + lead + width + 7.0, y + 4.0), &label, SMALL_SIZE, Align::Left, TEXT);
        self.at.0 += whole + ENTRY_GAP;
    }
}

/// Draws the legend below `top`; returns where it ends. The scales: px per metre, px per newton.
pub(crate) fn legend(
    canvas: &mut Canvas,
    top: f64,
    picture: &BodyFigure,
    postures: &[BodyPosture],
    [metre, newton]: [f64; 2],
    outside: usize,
) -> f64 {
    let any = |test: &dyn Fn(&BodyPosture) -> bool| postures.iter().any(test);
    let mut row = Row { canvas, at: (MARGIN, top) };
    load_entries(&mut row, postures);
    if any(&|posture| !posture.start.is_empty()) {
        row.entry("", SAMPLE_HEIGHT, "start", |canvas, (x, y)| {
            swatch(canvas, x, y, GHOST, Pen::solid(GHOST_EDGE, 1.0))
        });
    }
    force_entries(&mut row, postures, newton);
    if any(&|posture| posture.center_of_mass.is_some()) {
        row.entry("", SAMPLE_HEIGHT, "centre of mass", |canvas, (x, y)| {
            canvas.dot((x + 0.5 * SAMPLE_HEIGHT, y), 5.0, CENTER, PAPER)
        });
    }
    box_entries(&mut row, postures);
    if any(&|posture| !posture.targets.is_empty()) {
        let label = match outside {
            0 => picture.target.clone(),
            n => format!("{} ({n} outside the picture)", picture.target),
        };
        row.entry("", SAMPLE_HEIGHT, &label, |canvas, (x, y)| cross(canvas, (x + 0.5 * SAMPLE_HEIGHT, y)));
    }
    if any(&|posture| !posture.gazes.is_empty()) {
        row.entry("", GAZE_SAMPLE, "gaze", |canvas, (x, y)| canvas.line(&[(x, y), (x + GAZE_SAMPLE, y)], GAZE_PEN));
    }
    let size = round(60.0 / metre);
    let length = size * metre;
    row.entry("", length, &amount(size, "m"), |canvas, (x, y)| {
        let pen = Pen::solid(TEXT, 1.4);
        canvas.line(&[(x, y), (x + length, y)], pen);
        [x, x + length].into_iter().for_each(|x| canvas.line(&[(x, y - 4.0), (x, y + 4.0)], pen));
    });
    row.at.1 + 0.5 * ROW_HEIGHT
}

/// Draws samples of contact forces and loads; `newton` in px.
fn force_entries(row: &mut Row<'_>, postures: &[BodyPosture], newton: f64) {
    let contact = postures.iter().any(|posture| !posture.forces.is_empty());
    let held = postures.iter().any(|posture| !posture.loads.is_empty());
    if newton > 0.0 {
        let size = round(34.0 / newton);
        let length = size * newton;
        for (name, ink, _) in [("contact force", FORCE, contact), ("load", HELD, held)].into_iter().filter(|e| e.2) {
            let label = format!("{name}, {}", amount(size, "N"));
            row.entry("", length, &label, |canvas, (x, y)| arrow(canvas, (x, y), (x + length, y), ink));
        }
    }
}

/// Draws samples of surfaces and things.
fn box_entries(row: &mut Row<'_>, postures: &[BodyPosture]) {
    if postures.iter().any(|posture| !posture.surfaces.is_empty()) {
        row.entry("", SAMPLE_HEIGHT, "seat, table, step or wall", |canvas, (x, y)| glass(canvas, x, y, SURFACE_PEN));
    }
    let mut names: Vec<&str> = vec![];
    for thing in postures.iter().flat_map(|posture| &posture.things) {
        if !names.contains(&thing.label.as_str()) {
            names.push(&thing.label);
        }
    }
    if !names.is_empty() {
        row.entry("", SAMPLE_HEIGHT, &names.join(", "), |canvas, (x, y)| glass(canvas, x, y, THING_PEN));
    }
}

/// Draws the bands of muscle load with their bounds, the same in every figure, and the colour of parts whose load is not known.
fn load_entries(row: &mut Row<'_>, postures: &[BodyPosture]) {
    let any = |test: &dyn Fn(&BodyPosture) -> bool| postures.iter().any(test);
    let muscles = any(&|posture| !posture.muscles.is_empty());
    if !muscles && !any(&|posture| posture.parts.iter().any(|part| part.load.is_some())) {
        return;
    }
    let bounds: Vec<String> = LOAD_BANDS[1..].iter().map(|(from, ..)| format!("{:.0}", 100.0 * from)).collect();
    let widths: Vec<f64> = bounds.iter().map(|bound| text_width(bound, SMALL_SIZE) + 2.0 * BOUND_GAP).collect();
    let width = BAND * LOAD_BANDS.len() as f64 + widths.iter().sum::<f64>();
    let (name, unit) = if muscles { ("activation of muscles:", "%") } else { ("muscle load:", "% of strength") };
    row.entry(name, width, unit, |canvas, (mut x, y)| {
        for (k, (from, ..)) in LOAD_BANDS.iter().enumerate() {
            let to = LOAD_BANDS.get(k + 1).map_or(from + 1.0, |(to, ..)| *to);
            shades(canvas, (x, y), [*from, to]);
            x += BAND;
            if let (Some(bound), Some(width)) = (bounds.get(k), widths.get(k)) {
                canvas.text((x + 0.5 * width, y + 4.0), bound, SMALL_SIZE, Align::Middle, TEXT);
                x += width;
            }
        }
    });
    if !muscles && any(&|posture| posture.parts.iter().any(|part| part.load.is_none())) {
        row.entry("", SAMPLE_HEIGHT, "load not known", |canvas, (x, y)| swatch(canvas, x, y, UNKNOWN, OUTLINE_PEN));
    }
    if any(&|posture| posture.parts.iter().any(|part| part.hazard)) {
        row.entry("", SAMPLE_HEIGHT, "held by ligaments: hazard", |canvas, (x, y)| {
            swatch(canvas, x, y, HAZARD, OUTLINE_PEN)
        });
    }
}

/// The colours of a band of loads.
fn shades(canvas: &mut Canvas, (x, y): Point, [from, to]: [f64; 2]) {
    let step = BAND / f64::from(SHADES);
    for shade in 0..SHADES {
        let ink = load_ink(from + (to - from) * (f64::from(shade) + 0.5) / f64::from(SHADES));
        // Pieces overlap, so that no seam shows; the last one does not stand out.
        let wide = if shade + 1 < SHADES { 1.5 * step } else { step };
        canvas.block((x + f64::from(shade) * step, y - 0.5 * SAMPLE_HEIGHT), wide, SAMPLE_HEIGHT, ink);
    }
}

fn glass(canvas: &mut Canvas, x: f64, y: f64, pen: Pen) {
    let half = 0.5 * SAMPLE_HEIGHT;
    let corners = [(x, y - half), (x + SAMPLE_HEIGHT, y - half), (x + SAMPLE_HEIGHT, y + half), (x, y + half)];
    canvas.glass(&corners, pen.ink, GLASS);
    canvas.line(&[corners[0], corners[1], corners[2], corners[3], corners[0]], pen);
}

fn swatch(canvas: &mut Canvas, x: f64, y: f64, fill: Ink, pen: Pen) {
    let half = 0.5 * SAMPLE_HEIGHT;
    canvas.polygon(
        &[(x, y - half), (x + SAMPLE_HEIGHT, y - half), (x + SAMPLE_HEIGHT, y + half), (x, y + half)],
        fill,
        pen,
    );
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a positive number.
fn round(most: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(most).floor());
    [5.0, 2.0, 1.0].map(|factor| factor * power).into_iter().find(|value| *value <= most * 1.000_001).unwrap_or(power)
}

/// A round number with its unit, e.g. `0.5 m`: its first digit only.
fn amount(value: f64, unit: &str) -> String {
    if !(1e-3..1e5).contains(&value) {
        return number_text(&format!("{value:.0e} {unit}"));
    }
    let decimals = (-libm::log10(value) - 1e-9).ceil().max(0.0) as usize;
    number_text(&format!("{value:.decimals$} {unit}"))
}
