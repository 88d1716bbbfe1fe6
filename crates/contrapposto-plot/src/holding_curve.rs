//! Draws the share of people who still hold a posture against time, one curve for each group of people.

use crate::axes::{Frame, Range, drawable};
use crate::canvas::Canvas;
use crate::captions::{Mark, heading, legend};
use crate::figure::Figure;
use crate::style::{BELOW_FRAME, FRAME_LEFT, MARGIN, SERIES_PENS};

/// Height of the frame, px.
const SHARE_FRAME_HEIGHT: f64 = 240.0;
/// Share of its height that stays free above and below the curves.
const FREE: f64 = 0.04;

/// The share of people who still hold it.
#[derive(Clone, Debug, Default)]
pub struct HoldingCurve {
    /// First line above the chart.
    pub title: String,
    /// Second line above the chart; may be empty.
    pub subtitle: String,
    /// End of the time axis, min.
    pub end_min: f64,
    /// Groups of people: name, and the time of each person, min; infinite for no limit. Groups from the third on have the pen of the second.
    pub groups: Vec<(String, Vec<f64>)>,
}

/// Draws the chart.
#[must_use]
pub fn holding_curve(chart: &HoldingCurve) -> Figure {
    let mut canvas = Canvas::default();
    let top = heading(&mut canvas, FRAME_LEFT, &chart.title, &chart.subtitle, MARGIN);
    let end = if drawable(chart.end_min) && chart.end_min > 0.0 { chart.end_min } else { 1.0 };
    let frame = Frame::new(
        top,
        SHARE_FRAME_HEIGHT,
        Range { low: 0.0, high: end },
        Range { low: 0.0, high: 100.0 }.padded(FREE),
    );
    frame.axes(&mut canvas, Some("time, min"), "still hold it, %");
    let mut entries = vec![];
    for (i, (name, times)) in chart.groups.iter().enumerate() {
        let pen = SERIES_PENS[i.min(SERIES_PENS.len() - 1)];
        let (xs, ys) = steps(times, end);
        if frame.curve(&mut canvas, &xs, &ys, pen) {
            entries.push((Mark::Line(pen), name.as_str()));
        }
    }
    if entries.is_empty() {
        frame.say_empty(&mut canvas);
    }
    legend(&mut canvas, &frame, &entries);
    frame.outline(&mut canvas);
    canvas.finish(frame.area.bottom() + BELOW_FRAME + MARGIN)
}

/// Corners of the falling steps: time, and percent of people whose time is greater.
fn steps(times: &[f64], end: f64) -> (Vec<f64>, Vec<f64>) {
    let mut times: Vec<f64> = times.iter().copied().filter(|time| !time.is_nan()).map(|time| time.max(0.0)).collect();
    times.sort_by(f64::total_cmp);
    if times.is_empty() {
        return (vec![], vec![]);
    }
    let share = |left: usize| 100.0 * left as f64 / times.len() as f64;
    let mut corners = vec![(0.0, 100.0)];
    for (i, &time) in times.iter().enumerate().take_while(|(_, time)| **time < end) {
        corners.extend([(time, share(times.len() - i)), (time, share(times.len() - i - 1))]);
    }
    corners.push((end, corners.last().map_or(100.0, |(_, share)| *share)));
    corners.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::steps;

    #[test]
    fn the_curve_falls_by_the_share_of_a_person_at_the_time_of_each() {
        let (xs, ys) = steps(&[3.0, f64::INFINITY, 0.0, 10.0], 10.0);
        assert_eq!(xs, [0.0, 0.0, 0.0, 3.0, 3.0, 10.0]);
        assert_eq!(ys, [100.0, 100.0, 75.0, 75.0, 50.0, 50.0]);
        assert_eq!(steps(&[f64::NAN], 10.0), (vec![], vec![]));
    }
}
