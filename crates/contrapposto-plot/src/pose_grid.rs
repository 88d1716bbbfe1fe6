//! Which postures are there to choose from? Each is a column of stick figures, one below the other from several sides, all in
//! one scale and on one ground.

use crate::canvas::Canvas;
use crate::captions::heading;
use crate::figure::Figure;
use crate::geometry::Rect;
use crate::pose_views::{Bounds, PADDING, Paper, PoseView, legend};
use crate::style::{FRAME_LEFT, MARGIN, WIDTH};

/// Height of a view, px.
const HEIGHT: f64 = 330.0;
/// Space between two columns and two rows, px: room for numbers and labels.
const BETWEEN: [f64; 2] = [44.0, 46.0];
/// Most columns and rows; more would not be readable.
const MOST: [usize; 2] = [5, 4];

/// Postures side by side.
#[derive(Clone, Debug, Default)]
pub struct PoseGrid {
    /// Above the picture.
    pub title: String,
    /// Below the title.
    pub subtitle: String,
    /// What crosses stand for.
    pub target: String,
    /// From left to right; the first five are drawn.
    pub columns: Vec<PoseColumn>,
}

/// One posture.
#[derive(Clone, Debug, Default)]
pub struct PoseColumn {
    /// Its sides, from top to bottom; the first four are drawn.
    pub views: Vec<PoseView>,
}

/// Draws all postures.
#[must_use]
pub fn pose_grid(picture: &PoseGrid) -> Figure {
    let mut canvas = Canvas::new();
    let top = heading(&mut canvas, &picture.title, &picture.subtitle, MARGIN) + 22.0;
    let columns = &picture.columns[..picture.columns.len().min(MOST[0])];
    let count = columns.len().max(1) as f64;
    let width = (WIDTH - FRAME_LEFT - MARGIN - BETWEEN[0] * (count - 1.0)) / count;
    let views: Vec<(usize, usize, &PoseView)> = columns
        .iter()
        .enumerate()
        .flat_map(|(i, column)| column.views.iter().take(MOST[1]).enumerate().map(move |(k, view)| (i, k, view)))
        .collect();
    let boxes: Vec<Bounds> = views.iter().map(|(_, _, view)| Bounds::of(view)).collect();
    let scale = boxes.iter().map(|b| b.scale(width, HEIGHT)).fold(f64::INFINITY, f64::min);
    let (low, high) = boxes
        .iter()
        .filter(|b| b.low[1] <= b.high[1])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), b| (low.min(b.low[1]), high.max(b.high[1])));
    let known = low <= high;
    let scale = if known { scale.min((HEIGHT - 2.0 * PADDING) / (high - low).max(1e-6)) } else { 100.0 };
    let (mut outside, mut bottom) = (0, top);
    for ((i, k, view), bounds) in views.iter().zip(&boxes) {
        let left = FRAME_LEFT + *i as f64 * (width + BETWEEN[0]);
        let area = Rect { left, top: top + *k as f64 * (HEIGHT + BETWEEN[1]), width, height: HEIGHT };
        bottom = bottom.max(area.bottom());
        let middle = [bounds.middle(), if known { 0.5 * (low + high) } else { 0.0 }];
        outside = outside.max(Paper { area, middle, scale }.draw(&mut canvas, view));
    }
    bottom += 34.0;
    let views: Vec<PoseView> = views.into_iter().map(|(_, _, view)| view.clone()).collect();
    legend(&mut canvas, (FRAME_LEFT, bottom), &views, &picture.target, outside);
    canvas.finish(bottom + MARGIN)
}
