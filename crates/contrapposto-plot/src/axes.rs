//! Maps values to the sheet: ranges, tick marks, and the frame in which curves are drawn.

use crate::canvas::Canvas;
use crate::geometry::{Point, Rect, clip};
use crate::shape::Align;
use crate::style::{
    FRAME_LEFT, FRAME_PEN, FRAME_WIDTH, GRID_PEN, Ink, LABEL_SIZE, LEADER_PEN, PAPER, Pen, QUIET_TEXT, SMALL_SIZE,
    TEXT, ZERO_PEN,
};
use crate::text::fit;

/// Largest size of a number that is drawn; a larger number counts as missing.
const LARGEST: f64 = 1e9;

/// Most points drawn of one curve, several for every pixel of the frame; of longer curves every n-th point is drawn.
const MOST_POINTS: usize = 4_000;

/// Whether a number can be drawn.
pub(crate) fn drawable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Greatest size of the numbers that can be drawn, 0 if there is none.
pub(crate) fn extreme(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().filter(|v| drawable(*v)).fold(0.0, |most, v| most.max(v.abs()))
}

/// The interval of values that an axis shows; never empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Range {
    /// The smallest range around all values that can be drawn; 0 to 1 if there is none.
    pub(crate) fn around(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = values
            .into_iter()
            .filter(|v| drawable(*v))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        // Values that are (almost) equal still need an axis of some length.
        let least_span = 1e-6 * low.abs().max(high.abs()).max(1e-3);
        if high - low < least_span {
            let half = (0.1 * low.abs().max(high.abs())).max(0.5);
            return Self { low: low - half, high: high + half };
        }
        Self { low, high }
    }

    /// The range made longer at both ends by a share of its length.
    pub(crate) fn padded(self, share: f64) -> Self {
        let extra = share * (self.high - self.low);
        Self { low: self.low - extra, high: self.high + extra }
    }

    /// About `count` round values inside the range: multiples of 1, 2 or 5 times a power of ten.
    fn ticks(self, count: f64) -> Ticks {
        let rough = (self.high - self.low) / count;
        let power = libm::pow(10.0, libm::log10(rough).floor());
        let step = [1.0, 2.0, 5.0]
            .map(|factor| factor * power)
            .into_iter()
            .find(|step| *step >= 0.999 * rough)
            .unwrap_or(10.0 * power);
        let first = (self.low / step - 1e-6).ceil();
        let last = (self.high / step + 1e-6).floor();
        let values = (0..=50).map(|i| first + f64::from(i)).take_while(|n| *n <= last).map(|n| n * step).collect();
        Ticks { step, values }
    }
}

struct Ticks {
    step: f64,
    values: Vec<f64>,
}

impl Ticks {
    fn label(&self, value: f64) -> String {
        if value == 0.0 {
            return "0".to_owned();
        }
        let decimals = (-libm::log10(self.step).floor()).clamp(0.0, 9.0) as usize;
        if value.abs() >= 1e5 || decimals > 4 {
            number_text(&format!("{value:.2e}"))
        } else {
            number_text(&format!("{value:.decimals$}"))
        }
    }
}

/// A number as printed in figures: with a true minus sign.
pub(crate) fn number_text(digits: &str) -> String {
    digits.replace('-', "\u{2212}")
}

/// An angle in degrees with at most one decimal, e.g. "4.3°" or "150°".
pub(crate) fn degrees_text(angle: f64) -> String {
    let digits = format!("{angle:.1}");
    let digits = digits.strip_suffix(".0").unwrap_or(&digits);
    number_text(&format!("{digits}°"))
}

/// A rectangle on the sheet with a horizontal and a vertical axis.
pub(crate) struct Frame {
    pub(crate) area: Rect,
    x: Range,
    y: Range,
}

impl Frame {
    pub(crate) fn new(top: f64, height: f64, x: Range, y: Range) -> Self {
        let area = Rect { left: FRAME_LEFT, top, width: FRAME_WIDTH, height };
        Self { area, x, y }
    }

    /// Horizontal place of a value, px.
    pub(crate) fn across(&self, x: f64) -> f64 {
        self.area.left + self.area.width * (x - self.x.low) / (self.x.high - self.x.low)
    }

    /// Vertical place of a value, px.
    fn up(&self, y: f64) -> f64 {
        self.area.bottom() - self.area.height * (y - self.y.low) / (self.y.high - self.y.low)
    }

    /// Vertical pixels for one unit of the vertical axis.
    pub(crate) fn pixels_per_unit(&self) -> f64 {
        self.area.height / (self.y.high - self.y.low)
    }

    /// Whether a value lies on the horizontal axis.
    pub(crate) fn spans(&self, x: f64) -> bool {
        (self.x.low..=self.x.high).contains(&x)
    }

    /// Grid, frame, numbers and axis labels. Without `x_label` the horizontal axis has no numbers either: a frame
    /// below, with the same axis, carries them.
    pub(crate) fn axes(&self, canvas: &mut Canvas, x_label: Option<&str>, y_label: &str) {
        let Rect { left, top, .. } = self.area;
        let (right, bottom) = (self.area.right(), self.area.bottom());
        let x_ticks = self.x.ticks(8.0);
        let y_ticks = self.y.ticks((self.area.height / 40.0).max(2.0));

        for &value in &x_ticks.values {
            let x = self.across(value);
            canvas.line(&[(x, top), (x, bottom)], GRID_PEN);
            if x_label.is_some() {
                let at = (x, bottom + 16.0);
                canvas.text(at, &x_ticks.label(value), SMALL_SIZE, Align::Middle, TEXT);
            }
        }
        for &value in &y_ticks.values {
            let y = self.up(value);
            let pen = if value == 0.0 { ZERO_PEN } else { GRID_PEN };
            canvas.line(&[(left, y), (right, y)], pen);
            let at = (left - 6.0, y + 4.0);
            canvas.text(at, &y_ticks.label(value), SMALL_SIZE, Align::Right, TEXT);
        }
        if let Some(label) = x_label {
            let label = fit(label, LABEL_SIZE, self.area.width);
            let at = (left + self.area.width / 2.0, bottom + 36.0);
            canvas.text(at, &label, LABEL_SIZE, Align::Middle, TEXT);
        }
        let label = fit(y_label, LABEL_SIZE, self.area.height);
        canvas.upward_text((20.0, top + self.area.height / 2.0), &label, LABEL_SIZE);
    }

    /// The outline, drawn after the curves so that their ends are neat.
    pub(crate) fn outline(&self, canvas: &mut Canvas) {
        let Rect { left, top, .. } = self.area;
        let (right, bottom) = (self.area.right(), self.area.bottom());
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        canvas.line(&corners, FRAME_PEN);
    }

    /// A curve, cut at the frame, with gaps where a number cannot be drawn. Returns whether anything could be drawn.
    pub(crate) fn curve(&self, canvas: &mut Canvas, xs: &[f64], ys: &[f64], pen: Pen) -> bool {
        let count = xs.len().min(ys.len());
        let stride = count.div_ceil(MOST_POINTS).max(1);
        let points: Vec<(f64, f64)> =
            (0..count).filter(|i| i % stride == 0 || i + 1 == count).map(|i| (xs[i], ys[i])).collect();
        let mut any = false;
        for run in points.split(|(x, y)| !(drawable(*x) && drawable(*y))) {
            let run: Vec<Point> = run.iter().map(|&(x, y)| self.place(x, y)).collect();
            for part in clip(&run, self.area) {
                canvas.line(&part, pen);
                any = true;
            }
        }
        any
    }

    /// A dot at a value, if it lies in the frame.
    pub(crate) fn dot(&self, canvas: &mut Canvas, at: (f64, f64), radius: f64, fill: Ink, rim: Ink) {
        if drawable(at.0) && drawable(at.1) && self.area.contains(self.place(at.0, at.1)) {
            canvas.dot(self.place(at.0, at.1), radius, fill, rim);
        }
    }

    /// A straight level line at height `y`.
    pub(crate) fn level(&self, canvas: &mut Canvas, y: f64, pen: Pen) {
        self.curve(canvas, &[self.x.low, self.x.high], &[y, y], pen);
    }

    /// A faint upright line at `x`.
    pub(crate) fn upright(&self, canvas: &mut Canvas, x: f64) {
        self.curve(canvas, &[x, x], &[self.y.low, self.y.high], LEADER_PEN);
    }

    /// A filled band between two values of the horizontal axis.
    pub(crate) fn band(&self, canvas: &mut Canvas, (from, to): (f64, f64), fill: Ink) {
        if !(drawable(from) && drawable(to)) {
            return;
        }
        let place = |x: f64| self.across(x).clamp(self.area.left, self.area.right());
        let (from, to) = (place(from.min(to)), place(from.max(to)));
        canvas.block((from, self.area.top), to - from, self.area.height, fill);
    }

    /// Writes "nothing to draw" in the middle of the frame.
    pub(crate) fn say_empty(&self, canvas: &mut Canvas) {
        let (x, y) = (self.area.left + self.area.width / 2.0, self.area.top + self.area.height / 2.0);
        canvas.block((x - 60.0, y - 14.0), 120.0, 20.0, PAPER);
        canvas.text((x, y), "nothing to draw", LABEL_SIZE, Align::Middle, QUIET_TEXT);
    }

    fn place(&self, x: f64, y: f64) -> Point {
        (self.across(x), self.up(y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_from_minus_to_plus_4_64_has_ticks_at_even_numbers() {
        let ticks = Range { low: -4.64, high: 4.64 }.ticks(7.5);
        assert_eq!(ticks.values, [-4.0, -2.0, 0.0, 2.0, 4.0]);
        assert_eq!(ticks.label(-4.0), "\u{2212}4");
        let fine = Range { low: 0.0, high: 1.0 }.ticks(5.0);
        assert_eq!(fine.label(fine.values[1]), "0.2");
    }

    #[test]
    fn a_range_around_no_or_equal_values_is_not_empty() {
        for values in [vec![], vec![f64::NAN], vec![3.0], vec![-1e9, -1e9], vec![1e300]] {
            let range = Range::around(values.clone());
            assert!(range.low < range.high, "{values:?}");
            assert!(!range.ticks(6.0).values.is_empty(), "{values:?}");
        }
    }
}
