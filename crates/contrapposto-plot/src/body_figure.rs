//! What do bodies look like, and where do their muscles work? Solid parts in the colours of the report's page, from three sides,
//! all in one scale: one posture in a row, or several in columns, to be compared.

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

/// Most postures; more would not be readable.
const MOST_POSTURES: usize = 5;
/// Most lines of text above a posture.
const MOST_NOTES: usize = 6;
/// Greatest height of a body that stands alone, and of one in columns, px.
const HEIGHT: [f64; 2] = [400.0, 290.0];
/// Space between two columns, and above every row for the name of its view, px.
const BETWEEN: f64 = 22.0;
const NAME: f64 = 27.0;
/// Height of a line of text, px.
const LINE: f64 = 15.0;
/// Length of an arrow that carries the whole weight, m.
const WEIGHT: f64 = 0.45;

/// Draws all postures.
#[must_use]
pub fn body_figure(picture: &BodyFigure) -> Figure {
    let mut canvas = Canvas::default();
    let top = heading(&mut canvas, MARGIN, &picture.title, &picture.subtitle, MARGIN);
    let postures = &picture.postures[..picture.postures.len().min(MOST_POSTURES)];
    // Of one posture the views are the columns.
    let alone = postures.len() <= 1;
    let columns = if alone { VIEWS.len() } else { postures.len() };
    let width = (WIDTH - 2.0 * MARGIN - BETWEEN * (columns - 1) as f64) / columns as f64;
    let column = |i: usize| MARGIN + i as f64 * (width + BETWEEN);

    let carried = |posture: &BodyPosture| posture.forces.iter().take(MOST_PARTS).map(BodyForce::size).sum::<f64>();
    let weight = postures.iter().map(carried).fold(0.0, f64::max);
    let reach = if weight > 0.0 { WEIGHT / weight } else { 0.0 };
    let cells: Vec<Vec<Bounds>> =
        VIEWS.iter().map(|view| postures.iter().map(|p| Bounds::of(p, view, reach)).collect()).collect();
    let rows: Vec<Bounds> = cells.iter().map(|row| row.iter().fold(Bounds::NOTHING, |all, b| all.with(b))).collect();
    let widest = cells.iter().flatten().map(|b| b.size()[0]).fold(1e-6, f64::max);
    let tallest = rows.iter().map(|b| b.size()[1]).fold(1e-6, f64::max);
    let scale = (width / widest).min(HEIGHT[usize::from(!alone)] / tallest);

    let mut top = top + 6.0;
    let texts = postures.iter().enumerate().map(|(i, posture)| {
        let (width, left, align) = match alone {
            true => (WIDTH - 2.0 * MARGIN, MARGIN, Align::Left),
            false => (width, column(i) + 0.5 * width, Align::Middle),
        };
        said(&mut canvas, posture, (left, top), width, align)
    });
    top = texts.fold(top, f64::max) + 4.0;
    let largest = postures.iter().flat_map(|p| &p.parts).filter_map(|part| part.load).fold(0.0, f64::max);
    let (scale_end, mut outside) = (scale_end(largest), 0);
    for (k, view) in VIEWS.iter().enumerate() {
        // All bodies of a row stand on the same ground.
        let height = scale * rows[k].size()[1];
        let first = if alone { k } else { 0 };
        let at = (column(first), top + LINE + 4.0);
        canvas.text(at, &fit(view.label, LABEL_SIZE, width), LABEL_SIZE, Align::Left, QUIET_TEXT);
        for (i, posture) in postures.iter().enumerate() {
            let middle = [cells[k][i].middle()[0], rows[k].middle()[1]];
            let center = (column(first + i) + 0.5 * width, top + NAME + 0.5 * height);
            let paper = Paper { view, center, middle, scale, reach, scale_end };
            outside = outside.max(paper.draw(&mut canvas, posture, &cells[k][i]));
        }
        if !alone {
            top += NAME + height;
        }
    }
    if alone {
        top += NAME + scale * tallest;
    }
    if rows.iter().all(Bounds::is_empty) {
        canvas.text((0.5 * WIDTH, top + LINE), "nothing to draw", LABEL_SIZE, Align::Middle, QUIET_TEXT);
        return canvas.finish(top + 2.0 * LINE + MARGIN);
    }
    let bottom =
        legend(&mut canvas, top + 2.0 * BETWEEN, picture, postures, [scale, reach * scale, scale_end], outside);
    canvas.finish(bottom + MARGIN)
}

/// Title and key numbers; gives where they end.
fn said(canvas: &mut Canvas, posture: &BodyPosture, (x, top): (f64, f64), width: f64, align: Align) -> f64 {
    let mut y = top;
    if !posture.title.is_empty() {
        // Bold letters are a tenth wider.
        for line in wrap(&posture.title, LABEL_SIZE, 0.9 * width, 2) {
            y += LINE + 1.0;
            canvas.heading((x, y), &line, LABEL_SIZE, align);
        }
    }
    for line in posture.notes.iter().take(MOST_NOTES).flat_map(|note| wrap(note, SMALL_SIZE, width, 2)) {
        y += LINE;
        canvas.text((x, y), &line, SMALL_SIZE, align, TEXT);
    }
    y
}

/// The scale of loads ends at the next round number above the largest, as on the report's page.
fn scale_end(largest: f64) -> f64 {
    const ROUND: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0];
    ROUND.into_iter().find(|end| largest <= *end).unwrap_or(1.0)
}
