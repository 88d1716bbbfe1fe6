//! Draws the greatest forces at a point of a body in three sections: from the right, from the front and from above.
//!
//! Each section is the outline of all forces in the plane of the paper, drawn from the point at so many metres a newton, coloured by the
//! thing that limits the force in each direction; circles mark equal forces.

use crate::axes::drawable;
use crate::body::{BodyPart, BodyPosture};
use crate::body_paper::Paper;
use crate::body_view::{ABOVE, Bounds, VIEWS, View};
use crate::canvas::Canvas;
use crate::captions::heading;
use crate::figure::Figure;
use crate::geometry::{Point, Rect, clip};
use crate::shape::Align;
use crate::style::{LABEL_SIZE, LEADER, LIMITS, MARGIN, PAPER, Pen, QUIET_TEXT, SMALL_SIZE, START, TEXT, WIDTH};
use crate::text::{fit, text_width};

/// Height of a panel and the space between two, px.
const PANEL_HEIGHT: f64 = 430.0;
const PANEL_GAP: f64 = 10.0;
/// Radius of the largest force, m.
const LARGEST_RADIUS: f64 = 0.5;
/// Room for the numbers around a section, m.
const NUMBER_ROOM: f64 = 0.12;
/// Parts of a circle.
const CIRCLE_PARTS: usize = 72;
/// Most spokes of a section.
const MOST_SPOKES: usize = 1000;
/// Opacity of a section.
const SECTION_GLASS: f64 = 0.45;
/// Distance of two lines of the legend, px.
const LEGEND_LINE: f64 = 17.0;

/// The greatest forces at a point of a body. Axes: x forward, y up, z to the right; m, N.
#[derive(Clone, Debug, Default)]
pub struct ForceFigure {
    /// First line above the picture.
    pub title: String,
    /// Second line above the picture; may be empty.
    pub subtitle: String,
    /// The body with its surroundings.
    pub body: BodyPosture,
    /// The point where the force is exerted.
    pub at: [f64; 3],
    /// Spokes in order around the sections seen from the right, from the front and from above.
    pub sections: [Vec<Spoke>; 3],
    /// Names of the limits; those from the eighth on share the last colour.
    pub limits: Vec<String>,
}

/// The greatest force in a direction of a section.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spoke {
    /// The direction, of length 1.
    pub direction: [f64; 3],
    /// The force, N; one that is not finite is drawn as the largest finite one.
    pub force: f64,
    /// Index of its limit in [`ForceFigure::limits`].
    pub limit: usize,
    /// Whether its number is written.
    pub marked: bool,
}

/// Draws the three sections.
#[must_use]
pub fn force_figure(figure: &ForceFigure) -> Figure {
    let mut canvas = Canvas::default();
    let top = heading(&mut canvas, MARGIN, &figure.title, &figure.subtitle, MARGIN) + 6.0;
    let forces = || figure.sections.iter().flatten().map(|spoke| spoke.force).filter(|force| drawable(*force));
    let largest = forces().fold(0.0, f64::max);
    if largest <= 0.0 || !figure.at.into_iter().all(drawable) {
        canvas.text((MARGIN, top + LEGEND_LINE), "there are no forces", LABEL_SIZE, Align::Left, QUIET_TEXT);
        return canvas.finish(top + 2.0 * LEGEND_LINE + MARGIN);
    }
    let views = [&VIEWS[1], &VIEWS[0], &ABOVE];
    let radius = LARGEST_RADIUS / largest;
    let bounds = [0, 1, 2].map(|k| bounds(figure, views[k], &figure.sections[k], radius, largest));
    let width = (WIDTH - 2.0 * MARGIN - 2.0 * PANEL_GAP) / 3.0;
    let scales = bounds.iter().map(|bounds| {
        let [across, high] = bounds.size().map(|size| size.max(1e-6));
        (width / across).min(PANEL_HEIGHT / high)
    });
    let scale = scales.fold(f64::INFINITY, f64::min);
    for (k, bounds) in bounds.iter().enumerate() {
        let left = MARGIN + k as f64 * (width + PANEL_GAP);
        canvas.text((left, top + 14.0), views[k].label, LABEL_SIZE, Align::Left, TEXT);
        let paper = Paper {
            view: views[k],
            center: (left + 0.5 * width, top + 24.0 + 0.5 * PANEL_HEIGHT),
            middle: bounds.middle(),
            scale,
            length_per_newton: 0.0,
        };
        paper.draw(&mut canvas, &figure.body, bounds);
        let window = Rect { left, top: top + 24.0, width, height: PANEL_HEIGHT };
        section(&mut canvas, &paper, figure, &figure.sections[k], &Scale { radius, largest, window });
    }
    let bottom = legend(&mut canvas, figure, top + PANEL_HEIGHT + 24.0 + LEGEND_LINE, largest);
    canvas.finish(bottom + MARGIN)
}

/// Bounds of the body and of the section with its numbers.
fn bounds(figure: &ForceFigure, view: &View, section: &[Spoke], radius: f64, largest: f64) -> Bounds {
    let at = |spoke: &Spoke| -> [f64; 4] {
        let length = radius * shown(spoke.force, largest);
        let [x, y, z] = [0, 1, 2].map(|k| figure.at[k] + length * spoke.direction[k]);
        [x, y, z, NUMBER_ROOM]
    };
    let parts =
        section.iter().take(MOST_SPOKES).map(|spoke| BodyPart { balls: vec![at(spoke)], ..BodyPart::default() });
    let forces = parts.map(|part| Bounds::of(&BodyPosture { parts: vec![part], ..BodyPosture::default() }, view, 0.0));
    forces.fold(Bounds::of(&figure.body, view, 0.0), |all, one| all.with(&one))
}

/// A force as it is drawn.
fn shown(force: f64, largest: f64) -> f64 {
    if drawable(force) { force.max(0.0) } else { largest }
}

/// Distance of two circles, N: 1, 2 or 5 times a power of ten, two to five circles in all.
fn ring(largest: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(largest / 2.0).floor());
    let fits = [5.0, 2.0, 1.0].into_iter().find(|step| step * power <= largest / 2.0);
    fits.unwrap_or(1.0) * power
}

/// Length of forces on the paper.
struct Scale {
    /// m/N.
    radius: f64,
    /// N.
    largest: f64,
    /// The panel.
    window: Rect,
}

fn section(canvas: &mut Canvas, paper: &Paper<'_>, figure: &ForceFigure, spokes: &[Spoke], scale: &Scale) {
    let Scale { radius, largest, window } = *scale;
    let along = |direction: [f64; 3], length: f64| paper.point([0, 1, 2].map(|k| figure.at[k] + length * direction[k]));
    let Some(center) = along([0.0; 3], 0.0) else { return };
    let step = ring(largest);
    let own = spokes.iter().map(|spoke| shown(spoke.force, largest)).fold(0.0, f64::max);
    for k in 1..=(own / step).ceil() as usize {
        let size = paper.scale * radius * step * k as f64;
        let circle = (0..=CIRCLE_PARTS).map(|part| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * part as f64 / CIRCLE_PARTS as f64);
            (center.0 + size * cos, center.1 + size * sin)
        });
        for part in clip(&circle.collect::<Vec<Point>>(), window) {
            canvas.line(&part, Pen::dashed(LEADER, 0.8, 2.0, 3.0));
        }
    }
    let tips: Vec<(Point, &Spoke)> = spokes
        .iter()
        .take(MOST_SPOKES)
        .filter(|spoke| spoke.direction.into_iter().all(drawable))
        .filter_map(|spoke| Some((along(spoke.direction, radius * shown(spoke.force, largest))?, spoke)))
        .collect();
    let next = |i: usize| &tips[(i + 1) % tips.len()].0;
    let ink = |spoke: &Spoke| LIMITS[spoke.limit.min(LIMITS.len() - 1)];
    // Neighbours of one limit are one piece.
    let mut piece = vec![];
    for (i, (tip, spoke)) in tips.iter().enumerate() {
        piece.push(*tip);
        if tips.get(i + 1).is_none_or(|(_, other)| ink(other) != ink(spoke)) {
            canvas.glass(&[&[center], &piece[..], &[*next(i)]].concat(), ink(spoke), SECTION_GLASS);
            piece.clear();
        }
    }
    for (i, (tip, spoke)) in tips.iter().enumerate() {
        canvas.line(&[*tip, *next(i)], Pen::solid(ink(spoke), 2.0));
    }
    canvas.dot(center, 3.0, START, PAPER);
    for (tip, spoke) in tips.iter().filter(|(_, spoke)| spoke.marked) {
        number(canvas, center, *tip, spoke, paper);
    }
}

/// The number of a spoke beyond its tip.
fn number(canvas: &mut Canvas, center: Point, tip: Point, spoke: &Spoke, paper: &Paper<'_>) {
    let [x, y, _] = paper.view.project(spoke.direction);
    let text = if drawable(spoke.force) { format!("{:.0} N", spoke.force) } else { "no limit".to_owned() };
    let width = text_width(&text, SMALL_SIZE);
    let beyond = if x.abs() > y.abs() { 6.0 + 0.5 * width } else { 12.0 };
    let at = (tip.0 + beyond * x, tip.1 - beyond * y + 4.0);
    canvas.line(&[center, tip], Pen::solid(START, 0.8));
    canvas.block((at.0 - 0.5 * width - 2.0, at.1 - 10.0), width + 4.0, 13.0, PAPER);
    canvas.text(at, &text, SMALL_SIZE, Align::Middle, TEXT);
}

/// The colours with the names of the limits, and the meaning of the circles; returns where it ends.
fn legend(canvas: &mut Canvas, figure: &ForceFigure, top: f64, largest: f64) -> f64 {
    let explained = format!(
        "Dashed circles: every {} N from the hand. The line around it: the greatest force, its colour what limits it.",
        ring(largest)
    );
    canvas.text((MARGIN, top), &fit(&explained, SMALL_SIZE, WIDTH - 2.0 * MARGIN), SMALL_SIZE, Align::Left, QUIET_TEXT);
    let column = (WIDTH - 2.0 * MARGIN) / 3.0;
    let mut names: Vec<String> = figure.limits.iter().take(LIMITS.len()).cloned().collect();
    if let (true, Some(last)) = (figure.limits.len() > LIMITS.len(), names.last_mut()) {
        "others".clone_into(last);
    }
    for (i, name) in names.iter().enumerate() {
        let (left, y) = (MARGIN + (i % 3) as f64 * column, top + LEGEND_LINE * (1 + i / 3) as f64);
        canvas.block((left, y - 9.0), 16.0, 10.0, LIMITS[i]);
        canvas.text((left + 22.0, y), &fit(name, SMALL_SIZE, column - 28.0), SMALL_SIZE, Align::Left, TEXT);
    }
    top + LEGEND_LINE * names.len().div_ceil(3) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round(force: impl Fn(usize) -> f64) -> Vec<Spoke> {
        let spoke = |k: usize| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / 12.0);
            Spoke { direction: [cos, sin, 0.0], force: force(k), limit: k, marked: k.is_multiple_of(3) }
        };
        (0..12).map(spoke).collect()
    }

    #[test]
    fn forces_and_limits_stand_in_the_picture_and_odd_numbers_do_not() {
        let sections = [round(|k| 100.0 + k as f64), round(|_| f64::INFINITY), vec![]];
        let limits: Vec<String> = (0..12).map(|k| format!("limit {k}")).collect();
        let figure = ForceFigure { title: "Hand".to_owned(), sections, limits, ..ForceFigure::default() };
        let svg = force_figure(&figure).svg();
        for text in ["from above", "103 N", "no limit", "limit 3", "others", "every 50 N"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf\""));
        let nothing = [round(|_| f64::NAN), vec![], vec![]];
        for figure in [ForceFigure::default(), ForceFigure { sections: nothing, ..ForceFigure::default() }] {
            assert!(force_figure(&figure).svg().contains("there are no forces"));
        }
    }

    #[test]
    fn circles_are_two_to_five() {
        for largest in [1.0, 3.0, 7.3, 10.0, 99.0, 100.0, 333.0, 1234.0] {
            let count = (largest / ring(largest)) as usize;
            assert!((2..=5).contains(&count), "{largest}: {count}");
        }
    }
}
