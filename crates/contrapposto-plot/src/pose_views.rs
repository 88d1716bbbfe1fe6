//! What does a posture look like from several sides? Stick figures side by side in one scale: the start pale, the result
//! dark, targets as crosses, the centre of mass as a dot, on a grid in metres.

use crate::axes::{drawable, number_text};
use crate::canvas::{Align, Canvas, fit, text_width};
use crate::captions::heading;
use crate::figure::Figure;
use crate::geometry::{Point, Rect, clip};
use crate::style::{
    ACTIVE, EXTERNAL, FRAME_LEFT, FRAME_PEN, GRID_PEN, LABEL_SIZE, LEADER, MARGIN, PAPER, PASSIVE, Pen, QUIET_TEXT,
    SMALL_SIZE, TEXT, TRUNK, WIDTH,
};

/// Height of a view, px.
const VIEW_HEIGHT: f64 = 440.0;
/// Space between two views, px: room for the numbers of the second.
const BETWEEN: f64 = 48.0;
/// Space between the figures and the edge of their view, px.
pub(crate) const PADDING: f64 = 22.0;
/// Most lines of a figure that are drawn.
const MOST_LINES: usize = 5_000;
/// Most views; more would not be readable.
const MOST_VIEWS: usize = 4;
/// Least distance of two grid lines, px.
const LEAST_GRID: f64 = 44.0;
/// Half the width of a cross, px.
const CROSS: f64 = 6.0;

const START_PEN: Pen = Pen::solid(TRUNK, 3.0);
const END_PEN: Pen = Pen::solid(TEXT, 4.0);
const TARGET_PEN: Pen = Pen::solid(EXTERNAL, 2.4);
const GAZE_PEN: Pen = Pen::dashed(PASSIVE, 1.2, 5.0, 4.0);

/// A posture and where it began, seen from several sides.
#[derive(Clone, Debug, Default)]
pub struct PoseViews {
    /// Above the picture.
    pub title: String,
    /// Below the title.
    pub subtitle: String,
    /// The sides, from left to right; the first four are drawn.
    pub views: Vec<PoseView>,
}

/// One side. All points in m: x right, y up.
#[derive(Clone, Debug, Default)]
pub struct PoseView {
    /// Above the view, e.g. "from the front".
    pub label: String,
    /// Lines of the body at the start.
    pub start: Vec<Vec<[f64; 2]>>,
    /// Lines of the body as it ends.
    pub end: Vec<Vec<[f64; 2]>>,
    /// What points should reach.
    pub targets: Vec<[f64; 2]>,
    /// Lines of sight: eye, and what it should meet.
    pub gazes: Vec<[[f64; 2]; 2]>,
    /// Centre of mass of the end.
    pub center_of_mass: Option<[f64; 2]>,
}

/// Draws the views side by side.
#[must_use]
pub fn pose_views(picture: &PoseViews) -> Figure {
    let mut canvas = Canvas::new();
    let top = heading(&mut canvas, &picture.title, &picture.subtitle, MARGIN) + 22.0;
    let views = &picture.views[..picture.views.len().min(MOST_VIEWS)];
    let count = views.len().max(1) as f64;
    let left = FRAME_LEFT;
    let width = (WIDTH - left - MARGIN - BETWEEN * (count - 1.0)) / count;
    let boxes: Vec<Bounds> = views.iter().map(Bounds::of).collect();
    let scale = boxes.iter().map(|b| b.scale(width, VIEW_HEIGHT)).fold(f64::INFINITY, f64::min);
    // All views stand on the same ground.
    let (low, high) = boxes
        .iter()
        .filter(|b| b.low[1] <= b.high[1])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), b| (low.min(b.low[1]), high.max(b.high[1])));
    let scale = if low <= high { scale.min((VIEW_HEIGHT - 2.0 * PADDING) / (high - low).max(1e-6)) } else { scale };
    let mut outside = 0;
    for (i, (view, bounds)) in views.iter().zip(&boxes).enumerate() {
        let area = Rect { left: left + i as f64 * (width + BETWEEN), top, width, height: VIEW_HEIGHT };
        let middle = if low <= high { 0.5 * (low + high) } else { 0.0 };
        let paper =
            Paper { area, middle: [bounds.middle(), middle], scale: if scale.is_finite() { scale } else { 100.0 } };
        outside = outside.max(paper.draw(&mut canvas, view));
    }
    let bottom = top + VIEW_HEIGHT + 34.0;
    legend(&mut canvas, (left, bottom), views, "target", outside);
    canvas.finish(bottom + MARGIN)
}

/// The smallest box around the figures, and targets that are not too far off.
pub(crate) struct Bounds {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Bounds {
    pub(crate) fn of(view: &PoseView) -> Self {
        let mut bounds = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        points(&view.start).chain(points(&view.end)).chain(view.center_of_mass).for_each(|point| bounds.take(point));
        let size = (0..2).map(|k| bounds.high[k] - bounds.low[k]).fold(0.0, f64::max);
        let (low, high) = (bounds.low, bounds.high);
        for &target in &view.targets {
            if (0..2).all(|k| target[k] >= low[k] - size && target[k] <= high[k] + size) {
                bounds.take(target);
            }
        }
        bounds
    }

    fn take(&mut self, point: [f64; 2]) {
        if point.into_iter().all(drawable) {
            for (k, value) in point.into_iter().enumerate() {
                self.low[k] = self.low[k].min(value);
                self.high[k] = self.high[k].max(value);
            }
        }
    }

    pub(crate) fn middle(&self) -> f64 {
        if self.low[0] <= self.high[0] { 0.5 * (self.low[0] + self.high[0]) } else { 0.0 }
    }

    /// Pixels a metre that let it fit.
    pub(crate) fn scale(&self, width: f64, height: f64) -> f64 {
        if self.low[0] > self.high[0] {
            return f64::INFINITY;
        }
        let fit = |k: usize, room: f64| (room - 2.0 * PADDING) / (self.high[k] - self.low[k]).max(1e-6);
        fit(0, width).min(fit(1, height))
    }
}

fn points(lines: &[Vec<[f64; 2]>]) -> impl Iterator<Item = [f64; 2]> + '_ {
    lines.iter().take(MOST_LINES).flatten().copied()
}

/// Where metres stand in one view.
pub(crate) struct Paper {
    pub(crate) area: Rect,
    pub(crate) middle: [f64; 2],
    pub(crate) scale: f64,
}

impl Paper {
    fn place(&self, [x, y]: [f64; 2]) -> Point {
        (
            self.area.left + 0.5 * self.area.width + self.scale * (x - self.middle[0]),
            self.area.top + 0.5 * self.area.height - self.scale * (y - self.middle[1]),
        )
    }

    /// Draws the view; gives the number of targets outside of it.
    pub(crate) fn draw(&self, canvas: &mut Canvas, view: &PoseView) -> usize {
        let area = self.area;
        let label = fit(&view.label, LABEL_SIZE, area.width);
        canvas.text((area.left, area.top - 7.0), &label, LABEL_SIZE, Align::Left, TEXT);
        self.grid(canvas);
        for (lines, pen) in [(&view.start, START_PEN), (&view.end, END_PEN)] {
            lines.iter().take(MOST_LINES).for_each(|line| self.line(canvas, line, pen));
        }
        view.gazes.iter().take(MOST_LINES).for_each(|gaze| self.line(canvas, gaze, GAZE_PEN));
        let inside =
            |point: [f64; 2]| point.into_iter().all(drawable).then(|| self.place(point)).filter(|p| area.contains(*p));
        if let Some(at) = view.center_of_mass.and_then(inside) {
            canvas.dot(at, 5.5, ACTIVE, PAPER);
        }
        let mut outside = 0;
        for &target in view.targets.iter().take(MOST_LINES) {
            match inside(target) {
                Some(at) => cross(canvas, at),
                None => outside += 1,
            }
        }
        let corners = [
            (area.left, area.top),
            (area.right(), area.top),
            (area.right(), area.bottom()),
            (area.left, area.bottom()),
            (area.left, area.top),
        ];
        canvas.line(&corners, FRAME_PEN);
        outside
    }

    fn line(&self, canvas: &mut Canvas, line: &[[f64; 2]], pen: Pen) {
        let placed: Vec<Point> =
            line.iter().filter(|point| point.iter().all(|v| drawable(*v))).map(|point| self.place(*point)).collect();
        clip(&placed, self.area).iter().for_each(|part| canvas.line(part, pen));
    }

    /// Lines at round metres, with their numbers.
    fn grid(&self, canvas: &mut Canvas) {
        let area = self.area;
        let rough = LEAST_GRID / self.scale;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0].map(|f| f * power).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * power);
        let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
        let text = |value: f64| number_text(&format!("{:.decimals$}", if value == 0.0 { 0.0 } else { value }));
        let half = [0.5 * area.width / self.scale, 0.5 * area.height / self.scale];
        for k in 0..2 {
            let first = ((self.middle[k] - half[k]) / step).ceil();
            let last = ((self.middle[k] + half[k]) / step).floor();
            let values = (0..=60).map(|i| (first + f64::from(i), step)).take_while(|(n, _)| *n <= last);
            for value in values.map(|(n, step)| n * step) {
                let mut at = self.middle;
                at[k] = value;
                let (x, y) = self.place(at);
                // The ground is a darker line.
                let pen = if k == 1 && value == 0.0 { Pen::solid(LEADER, 1.6) } else { GRID_PEN };
                if k == 0 {
                    canvas.line(&[(x, area.top), (x, area.bottom())], pen);
                    canvas.text((x, area.bottom() + 15.0), &text(value), SMALL_SIZE, Align::Middle, QUIET_TEXT);
                } else {
                    canvas.line(&[(area.left, y), (area.right(), y)], pen);
                    canvas.text((area.left - 6.0, y + 4.0), &text(value), SMALL_SIZE, Align::Right, QUIET_TEXT);
                }
            }
        }
    }
}

fn cross(canvas: &mut Canvas, (x, y): Point) {
    for slope in [-1.0, 1.0] {
        canvas.line(&[(x - CROSS, y - slope * CROSS), (x + CROSS, y + slope * CROSS)], TARGET_PEN);
    }
}

/// One line below the views: what lines, crosses and dots are.
pub(crate) fn legend(canvas: &mut Canvas, (left, y): Point, views: &[PoseView], target: &str, outside: usize) {
    const SAMPLE: f64 = 22.0;
    let any = |test: &dyn Fn(&PoseView) -> bool| views.iter().any(test);
    let mut x = left;
    let mut say = |canvas: &mut Canvas, label: &str, mark: &dyn Fn(&mut Canvas, f64)| {
        mark(canvas, x);
        canvas.text((x + SAMPLE + 7.0, y + 4.0), label, SMALL_SIZE, Align::Left, TEXT);
        x += SAMPLE + 7.0 + text_width(label, SMALL_SIZE) + 18.0;
    };
    let line = |pen: Pen| move |canvas: &mut Canvas, x: f64| canvas.line(&[(x, y), (x + SAMPLE, y)], pen);
    if any(&|view| !view.start.is_empty()) {
        say(canvas, "start", &line(START_PEN));
    }
    if any(&|view| !view.end.is_empty()) {
        say(canvas, "result", &line(END_PEN));
    }
    if any(&|view| view.center_of_mass.is_some()) {
        say(canvas, "centre of mass", &|canvas, x| canvas.dot((x + SAMPLE / 2.0, y), 5.5, ACTIVE, PAPER));
    }
    if any(&|view| !view.targets.is_empty()) {
        let label = match outside {
            0 => target.to_owned(),
            n => format!("{target} ({n} outside the picture)"),
        };
        say(canvas, &label, &|canvas, x| cross(canvas, (x + SAMPLE / 2.0, y)));
    }
    if any(&|view| !view.gazes.is_empty()) {
        say(canvas, "gaze", &line(GAZE_PEN));
    }
    canvas.text((x, y + 4.0), "grid in m", SMALL_SIZE, Align::Left, QUIET_TEXT);
}
