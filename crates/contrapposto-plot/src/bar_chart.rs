//! Draws shares as horizontal bars, some beside each other in every row, each with its percentage as text.

use crate::axes::{drawable, number_text};
use crate::canvas::Canvas;
use crate::captions::heading;
use crate::figure::Figure;
use crate::shape::Align;
use crate::style::{GRID, LABEL_SIZE, MARGIN, QUIET_TEXT, SERIES_PENS, SMALL_SIZE, TEXT, WIDTH};
use crate::text::{fit, text_width};

/// Left edge of the bars, px: their names stand before it.
const BARS_LEFT: f64 = 270.0;
/// Length of a bar of 100 %, px.
const WHOLE: f64 = 450.0;
/// Height of a bar, and the space between two rows, px.
const BAR: f64 = 14.0;
const ROW_GAP: f64 = 9.0;
/// Height of the legend, px.
const LEGEND: f64 = 22.0;
/// Most rows.
const MOST_BAR_ROWS: usize = 40;

/// Shares as bars.
#[derive(Clone, Debug, Default)]
pub struct BarChart {
    /// First line above the chart.
    pub title: String,
    /// Second line above the chart; may be empty.
    pub subtitle: String,
    /// Names of the bars of a row. Those from the third on have the colour of the second; the name of a single one is not written.
    pub series: Vec<String>,
    /// Name of each row, and its shares, 0 to 1, in the order of `series`.
    pub rows: Vec<(String, Vec<f64>)>,
}

/// Draws the chart.
#[must_use]
pub fn bar_chart(chart: &BarChart) -> Figure {
    let mut canvas = Canvas::default();
    let mut top = heading(&mut canvas, MARGIN, &chart.title, &chart.subtitle, MARGIN);
    if chart.series.len() > 1 {
        draw_legend(&mut canvas, chart, top);
        top += LEGEND;
    }
    for (name, shares) in chart.rows.iter().take(MOST_BAR_ROWS) {
        let shares = &shares[..shares.len().min(chart.series.len())];
        let height = BAR * shares.len() as f64;
        let name = fit(name, LABEL_SIZE, BARS_LEFT - 8.0 - MARGIN);
        canvas.text((BARS_LEFT - 8.0, top + height / 2.0 + 4.0), &name, LABEL_SIZE, Align::Right, TEXT);
        canvas.block((BARS_LEFT, top), WHOLE, height, GRID);
        for (i, share) in shares.iter().enumerate() {
            let length = if drawable(*share) { WHOLE * share.clamp(0.0, 1.0) } else { 0.0 };
            let place = top + BAR * i as f64;
            canvas.block((BARS_LEFT, place + 1.0), length, BAR - 2.0, ink(i));
            let words =
                if drawable(*share) { number_text(&format!("{:.0} %", 100.0 * share)) } else { "unknown".to_owned() };
            canvas.text((BARS_LEFT + length + 5.0, place + BAR - 3.0), &words, SMALL_SIZE, Align::Left, TEXT);
        }
        top += height + ROW_GAP;
    }
    if chart.rows.is_empty() {
        canvas.text((BARS_LEFT, top + BAR), "nothing to draw", LABEL_SIZE, Align::Left, QUIET_TEXT);
        top += BAR + ROW_GAP;
    }
    canvas.finish(top + MARGIN)
}

/// A square and a name for each bar of a row.
fn draw_legend(canvas: &mut Canvas, chart: &BarChart, top: f64) {
    let mut left = BARS_LEFT;
    for (i, name) in chart.series.iter().enumerate() {
        let name = fit(name, SMALL_SIZE, (WIDTH - left - MARGIN - 20.0).max(0.0));
        canvas.block((left, top + 2.0), 10.0, 10.0, ink(i));
        canvas.text((left + 15.0, top + 11.0), &name, SMALL_SIZE, Align::Left, TEXT);
        left += 30.0 + text_width(&name, SMALL_SIZE);
    }
}

fn ink(series: usize) -> crate::style::Ink {
    SERIES_PENS[series.min(SERIES_PENS.len() - 1)].ink
}
