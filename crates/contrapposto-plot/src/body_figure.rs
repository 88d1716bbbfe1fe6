//! Draws bodies and the load of their muscles: solid parts in the colours of the report's page, seen from three sides, all in one
//! scale; one posture in a row, or several postures in columns.

use crate::body::{BodyFigure, BodyForce, BodyPosture};
use crate::body_legend::legend;
use crate::body_paper::Paper;
use crate::body_view::{Bounds, MOST_PARTS, VIEWS};
use crate::canvas::Canvas;
use crate::captions::heading;
use crate::figure::Figure;
use crate::shape::Align;
use crate::style::{LABEL_SIZE, MARGIN, QUIET_TEXT, SMALL_SIZE, TEXT, WIDTH};
use crate::text::{fit, wrap};

/// Greatest number of postures; more would not be readable.
const MOST_POSTURES: usize = 5;
/// Greatest number of notes above a posture.
const MOST_NOTES: usize = 6;
/// Greatest height of a single body, and of one in columns, px.
const BODY_HEIGHT: [f64; 2] = [400.0, 290.0];
/// Space between two columns, px.
const COLUMN_GAP: f64 = 22.0;
/// Space above every row for the name of its view, px.
const VIEW_NAME_HEIGHT: f64 = 27.0;
/// Height of a line of text, px.
const TEXT_LINE: f64 = 15.0;
/// Length of the arrow of a force as large as all contact forces together, m.
const WEIGHT_ARROW: f64 = 0.45;

/// Draws all postures.
#[must_use]
pub fn body_figure(picture: &BodyFigure) -> Figure {
    let mut canvas = Canvas::default();
    let top = heading(&mut canvas, MARGIN, &picture.title, &picture.subtitle, MARGIN) + 6.0;
    let postures = &picture.postures[..picture.postures.len().min(MOST_POSTURES)];
    let layout = Layout::of(postures);
    let top = layout.draw_texts(&mut canvas, postures, top) + 4.0;
    let (bottom, outside) = layout.draw_bodies(&mut canvas, postures, top);
    if layout.rows.iter().all(Bounds::is_empty) {
        canvas.text((0.5 * WIDTH, bottom + TEXT_LINE), "nothing to draw", LABEL_SIZE, Align::Middle, QUIET_TEXT);
        return canvas.finish(bottom + 2.0 * TEXT_LINE + MARGIN);
    }
    let scales = [layout.scale, layout.length_per_newton * layout.scale];
    let bottom = legend(&mut canvas, bottom + 2.0 * COLUMN_GAP, picture, postures, scales, outside);
    canvas.finish(bottom + MARGIN)
}

/// Places and scales of all bodies of a figure. A row is a view and a column a posture; with a single posture the views are the
/// columns of one row.
struct Layout {
    single: bool,
    /// Width of a column, px.
    width: f64,
    /// Bounds of every posture by view, m.
    cells: Vec<Vec<Bounds>>,
    /// Bounds of all postures by view, m.
    rows: Vec<Bounds>,
    /// Scale of all bodies, px/m.
    scale: f64,
    /// Length of the arrow of a force, m/N.
    length_per_newton: f64,
}

impl Layout {
    fn of(postures: &[BodyPosture]) -> Self {
        let single = postures.len() <= 1;
        let columns = if single { VIEWS.len() } else { postures.len() };
        let width = (WIDTH - 2.0 * MARGIN - COLUMN_GAP * (columns - 1) as f64) / columns as f64;
        // Loads of a body without contacts have arrows as long as its contact forces would have.
        let carried = |posture: &BodyPosture| {
            let sum = |forces: &[BodyForce]| forces.iter().take(MOST_PARTS).map(BodyForce::size).sum::<f64>();
            if posture.forces.is_empty() { sum(&posture.loads) } else { sum(&posture.forces) }
        };
        let weight = postures.iter().map(carried).fold(0.0, f64::max);
        let length_per_newton = if weight > 0.0 { WEIGHT_ARROW / weight } else { 0.0 };
        let bounds = |view| postures.iter().map(|p| Bounds::of(p, view, length_per_newton)).collect();
        let cells: Vec<Vec<Bounds>> = VIEWS.iter().map(bounds).collect();
        let rows: Vec<Bounds> =
            cells.iter().map(|row| row.iter().fold(Bounds::NOTHING, |all, b| all.with(b))).collect();
        let widest = cells.iter().flatten().map(|b| b.size()[0]).fold(1e-6, f64::max);
        let tallest = rows.iter().map(|b| b.size()[1]).fold(1e-6, f64::max);
        let scale = (width / widest).min(BODY_HEIGHT[usize::from(!single)] / tallest);
        Self { single, width, cells, rows, scale, length_per_newton }
    }

    /// Left end of a column, px.
    fn column(&self, i: usize) -> f64 {
        MARGIN + i as f64 * (self.width + COLUMN_GAP)
    }

    /// Writes the texts above the bodies; returns where the longest ends.
    fn draw_texts(&self, canvas: &mut Canvas, postures: &[BodyPosture], top: f64) -> f64 {
        let texts = postures.iter().enumerate().map(|(i, posture)| {
            let (width, left, align) = match self.single {
                true => (WIDTH - 2.0 * MARGIN, MARGIN, Align::Left),
                false => (self.width, self.column(i) + 0.5 * self.width, Align::Middle),
            };
            posture_text(canvas, posture, (left, top), width, align)
        });
        texts.fold(top, f64::max)
    }

    /// Draws the bodies in all views; returns where they end, and the greatest number of targets outside of a view's bounds.
    fn draw_bodies(&self, canvas: &mut Canvas, postures: &[BodyPosture], mut top: f64) -> (f64, usize) {
        let (mut outside, mut tallest) = (0, 1e-6_f64);
        for (k, view) in VIEWS.iter().enumerate() {
            // All bodies of a row stand on the same ground.
            let row = self.rows[k];
            let height = self.scale * row.size()[1];
            let first = if self.single { k } else { 0 };
            let at = (self.column(first), top + TEXT_LINE + 4.0);
            canvas.text(at, &fit(view.label, LABEL_SIZE, self.width), LABEL_SIZE, Align::Left, QUIET_TEXT);
            for (i, posture) in postures.iter().enumerate() {
                let paper = Paper {
                    view,
                    center: (self.column(first + i) + 0.5 * self.width, top + VIEW_NAME_HEIGHT + 0.5 * height),
                    middle: [self.cells[k][i].middle()[0], row.middle()[1]],
                    scale: self.scale,
                    length_per_newton: self.length_per_newton,
                };
                outside = outside.max(paper.draw(canvas, posture, &self.cells[k][i]));
            }
            tallest = tallest.max(row.size()[1]);
            if !self.single {
                top += VIEW_NAME_HEIGHT + height;
            }
        }
        if self.single {
            top += VIEW_NAME_HEIGHT + self.scale * tallest;
        }
        (top, outside)
    }
}

/// Writes title and key numbers; returns where they end.
fn posture_text(canvas: &mut Canvas, posture: &BodyPosture, (x, top): (f64, f64), width: f64, align: Align) -> f64 {
    let mut y = top;
    if !posture.title.is_empty() {
        // Bold letters are a tenth wider.
        for line in wrap(&posture.title, LABEL_SIZE, 0.9 * width, 2) {
            y += TEXT_LINE + 1.0;
            canvas.heading((x, y), &line, LABEL_SIZE, align);
        }
    }
    for line in posture.notes.iter().take(MOST_NOTES).flat_map(|note| wrap(note, SMALL_SIZE, width, 2)) {
        y += TEXT_LINE;
        canvas.text((x, y), &line, SMALL_SIZE, align, TEXT);
    }
    y
}
