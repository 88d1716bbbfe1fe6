//! What do colours, arrows, dots and crosses of bodies mean, and how large is what? Entries in a row, and in further rows where they
//! would not fit.

use crate::axes::number_text;
use crate::body::{BodyFigure, BodyPosture};
use crate::body_paper::{arrow, cross};
use crate::canvas::Canvas;
use crate::geometry::Point;
use crate::shape::Align;
use crate::style::{
    CENTER, FORCE, GAZE_PEN, GHOST, GHOST_EDGE, MARGIN, OUTLINE_PEN, PAPER, Pen, SMALL_SIZE, TEXT, UNKNOWN, WIDTH,
    load_ink,
};
use crate::text::{fit, text_width};

/// Length of a sample, of the scale of colours, and their height, px.
const SAMPLE: f64 = 20.0;
const SCALE: f64 = 120.0;
const HIGH: f64 = 11.0;
/// Pieces of the scale of colours.
const SHADES: u32 = 60;
/// Space before the next entry, and from row to row, px.
const BETWEEN: f64 = 20.0;
const ROW: f64 = 22.0;

struct Row<'a> {
    canvas: &'a mut Canvas,
    at: Point,
}

impl Row<'_> {
    /// A sample of some width, drawn from its left end on the middle of the row, and what it means.
    fn say(&mut self, before: &str, width: f64, label: &str, draw: impl FnOnce(&mut Canvas, Point)) {
        let label = fit(label, SMALL_SIZE, WIDTH - 2.0 * MARGIN - width - 7.0);
        let lead = if before.is_empty() { 0.0 } else { text_width(before, SMALL_SIZE) + 7.0 };
        let whole = lead + width + 7.0 + text_width(&label, SMALL_SIZE);
        if self.at.0 > MARGIN && self.at.0 + whole > WIDTH - MARGIN {
            self.at = (MARGIN, self.at.1 + ROW);
        }
        let (x, y) = self.at;
        self.canvas.text((x, y + 4.0), before, SMALL_SIZE, Align::Left, TEXT);
        draw(self.canvas, (x + lead, y));
        self.canvas.text((x + lead + width + 7.0, y + 4.0), &label, SMALL_SIZE, Align::Left, TEXT);
        self.at.0 += whole + BETWEEN;
    }
}

/// Draws the legend below `top`; gives where it ends. `scales`: px of a metre, px of a newton, load of the darkest colour.
pub(crate) fn legend(
    canvas: &mut Canvas,
    top: f64,
    picture: &BodyFigure,
    postures: &[BodyPosture],
    [metre, newton, scale_end]: [f64; 3],
    outside: usize,
) -> f64 {
    let any = |test: &dyn Fn(&BodyPosture) -> bool| postures.iter().any(test);
    let mut row = Row { canvas, at: (MARGIN, top) };
    if any(&|posture| posture.parts.iter().any(|part| part.load.is_some())) {
        let over = any(&|posture| posture.parts.iter().any(|part| part.load.is_some_and(|load| load > scale_end)));
        let end = format!("{:.0} % of strength{}", 100.0 * scale_end, if over { " or more" } else { "" });
        row.say("muscle load: 0 %", SCALE, &end, |canvas, (x, y)| {
            let step = SCALE / f64::from(SHADES);
            for shade in 0..SHADES {
                let ink = load_ink((f64::from(shade) + 0.5) / f64::from(SHADES));
                // Pieces overlap, so that no seam shows; the last one does not stand out.
                let wide = if shade + 1 < SHADES { 1.5 * step } else { step };
                canvas.block((x + f64::from(shade) * step, y - 0.5 * HIGH), wide, HIGH, ink);
            }
        });
        if any(&|posture| posture.parts.iter().any(|part| part.load.is_none())) {
            row.say("", HIGH, "load not known", |canvas, (x, y)| swatch(canvas, x, y, UNKNOWN, OUTLINE_PEN));
        }
    }
    if any(&|posture| !posture.start.is_empty()) {
        row.say("", HIGH, "start", |canvas, (x, y)| swatch(canvas, x, y, GHOST, Pen::solid(GHOST_EDGE, 1.0)));
    }
    if newton > 0.0 && any(&|posture| !posture.forces.is_empty()) {
        let size = round(34.0 / newton);
        let length = size * newton;
        let label = format!("contact force, {}", amount(size, "N"));
        row.say("", length, &label, |canvas, (x, y)| arrow(canvas, (x, y), (x + length, y), FORCE));
    }
    if any(&|posture| posture.center_of_mass.is_some()) {
        row.say("", HIGH, "centre of mass", |canvas, (x, y)| canvas.dot((x + 0.5 * HIGH, y), 5.0, CENTER, PAPER));
    }
    if any(&|posture| !posture.targets.is_empty()) {
        let label = match outside {
            0 => picture.target.clone(),
            n => format!("{} ({n} outside the picture)", picture.target),
        };
        row.say("", HIGH, &label, |canvas, (x, y)| cross(canvas, (x + 0.5 * HIGH, y)));
    }
    if any(&|posture| !posture.gazes.is_empty()) {
        row.say("", SAMPLE, "gaze", |canvas, (x, y)| canvas.line(&[(x, y), (x + SAMPLE, y)], GAZE_PEN));
    }
    let size = round(60.0 / metre);
    let length = size * metre;
    row.say("", length, &amount(size, "m"), |canvas, (x, y)| {
        let pen = Pen::solid(TEXT, 1.4);
        canvas.line(&[(x, y), (x + length, y)], pen);
        [x, x + length].into_iter().for_each(|x| canvas.line(&[(x, y - 4.0), (x, y + 4.0)], pen));
    });
    row.at.1 + 0.5 * ROW
}

fn swatch(canvas: &mut Canvas, x: f64, y: f64, fill: crate::style::Ink, pen: Pen) {
    let half = 0.5 * HIGH;
    canvas.polygon(&[(x, y - half), (x + HIGH, y - half), (x + HIGH, y + half), (x, y + half)], fill, pen);
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a positive number.
fn round(most: f64) -> f64 {
    let power = 10_f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0].map(|factor| factor * power).into_iter().find(|value| *value <= most * 1.000_001).unwrap_or(power)
}

/// `0.5 m`; a round number needs no more digits than its first.
fn amount(value: f64, unit: &str) -> String {
    if !(1e-3..1e5).contains(&value) {
        return number_text(&format!("{value:.0e} {unit}"));
    }
    let decimals = (-value.log10() - 1e-9).ceil().max(0.0) as usize;
    number_text(&format!("{value:.decimals$} {unit}"))
}
