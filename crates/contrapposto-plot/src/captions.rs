//! Draws the words that explain a frame: a heading above it, and to its right the legend, where no curve can run into it.

use crate::axes::Frame;
use crate::canvas::Canvas;
use crate::shape::Align;
use crate::style::{Ink, LABEL_SIZE, LEGEND_LEFT, MARGIN, Pen, QUIET_TEXT, SMALL_SIZE, TEXT, TITLE_SIZE, WIDTH};
use crate::text::fit;

/// Vertical distance of two entries, px.
const LINE_HEIGHT: f64 = 19.0;
/// Length of the sample of a line, px.
const LINE_SAMPLE: f64 = 22.0;

/// Writes title and subtitle; returns where they end.
pub(crate) fn heading(canvas: &mut Canvas, left: f64, title: &str, subtitle: &str, top: f64) -> f64 {
    let width = WIDTH - left - MARGIN;
    let mut bottom = top;
    if !title.is_empty() {
        bottom += 18.0;
        // Bold letters are a tenth wider.
        let title = fit(title, TITLE_SIZE, 0.9 * width);
        canvas.heading((left, bottom - 4.0), &title, TITLE_SIZE, Align::Left);
    }
    if !subtitle.is_empty() {
        bottom += 18.0;
        let at = (left, bottom - 4.0);
        let subtitle = fit(subtitle, LABEL_SIZE, width);
        canvas.text(at, &subtitle, LABEL_SIZE, Align::Left, QUIET_TEXT);
    }
    bottom + 4.0
}

/// The sample that an entry explains.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Mark {
    Line(Pen),
    Dot { fill: Ink, rim: Ink },
}

/// The entries, from the upper edge of the frame downwards.
pub(crate) fn legend(canvas: &mut Canvas, frame: &Frame, entries: &[(Mark, &str)]) {
    let text_left = LEGEND_LEFT + LINE_SAMPLE + 9.0;
    for (i, (mark, label)) in entries.iter().enumerate() {
        let y = frame.area.top + 8.0 + LINE_HEIGHT * i as f64;
        match *mark {
            Mark::Line(pen) => canvas.line(&[(LEGEND_LEFT, y), (LEGEND_LEFT + LINE_SAMPLE, y)], pen),
            Mark::Dot { fill, rim } => canvas.dot((LEGEND_LEFT + LINE_SAMPLE / 2.0, y), 5.0, fill, rim),
        }
        let label = fit(label, SMALL_SIZE, WIDTH - MARGIN / 2.0 - text_left);
        canvas.text((text_left, y + 4.0), &label, SMALL_SIZE, Align::Left, TEXT);
    }
}
