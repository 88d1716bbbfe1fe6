//! Draws one body in one view: its parts from the farthest to the nearest, then the marks on them.

use crate::axes::drawable;
use crate::body::{BodyMuscle, BodyPart, BodyPosture, Corners};
use crate::body_view::{Bounds, MOST_MUSCLES, MOST_PARTS, View, balls};
use crate::canvas::Canvas;
use crate::depth::{Solid, order};
use crate::geometry::{Point, Rect, clip, clip_polygon};
use crate::path::Path;
use crate::style::{
    CENTER, FORCE, GAZE_PEN, GHOST, GHOST_EDGE, GROUND, GROUND_PEN, HAZARD, HELD, Ink, OUTLINE_PEN, PAPER, PLUMB_PEN,
    Pen, SURFACE_PEN, TARGET_PEN, THING_PEN, UNDER_MUSCLES, UNKNOWN, load_ink,
};

/// Half the width of a cross, px.
const CROSS: f64 = 5.0;
/// Length and half the width of the head of an arrow, px.
const HEAD: (f64, f64) = (9.0, 4.0);
/// Shorter arrows are not drawn, px.
const SHORTEST_ARROW: f64 = 2.0;
/// Least and greatest width of a muscle, and width of its rim on both sides together, px.
const THINNEST_MUSCLE: f64 = 0.8;
const THICKEST_MUSCLE: f64 = 30.0;
const MUSCLE_RIM: f64 = 0.6;
/// Opacity of surfaces and things.
pub(crate) const GLASS: f64 = 0.3;
/// A target farther than this beyond the bounds, m, is outside.
const BOUNDS_TOLERANCE: f64 = 1e-9;

/// Place and scale of a body on the sheet.
pub(crate) struct Paper<'a> {
    pub(crate) view: &'a View,
    /// The point of the sheet, px, where the point `middle` of the view, m, is drawn.
    pub(crate) center: Point,
    pub(crate) middle: [f64; 2],
    /// Scale, px/m.
    pub(crate) scale: f64,
    /// Length of the arrow of a force, m/N.
    pub(crate) length_per_newton: f64,
}

impl Paper<'_> {
    /// Place on the sheet and height above it towards the viewer, px.
    fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.view.project(point);
        let across = self.center.0 + self.scale * (x - self.middle[0]);
        [across, self.center.1 - self.scale * (y - self.middle[1]), self.scale * z]
    }

    /// Place on the sheet, px; `None` where it cannot be drawn.
    pub(crate) fn point(&self, point: [f64; 3]) -> Option<Point> {
        let [x, y, _] = self.place(point);
        point.into_iter().all(drawable).then_some((x, y))
    }

    /// Draws a posture; returns the number of targets outside of `bounds`, which are not drawn.
    pub(crate) fn draw(&self, canvas: &mut Canvas, posture: &BodyPosture, bounds: &Bounds) -> usize {
        if let Some(square) = posture.ground_square() {
            let corners: Vec<Point> = square.into_iter().filter_map(|corner| self.point(corner)).collect();
            canvas.polygon(&corners, GROUND, GROUND_PEN);
        }
        self.ghost(canvas, &posture.start);
        self.solids_in_order(canvas, posture, bounds);
        self.muscles(canvas, &posture.muscles);
        for gaze in posture.gazes.iter().take(MOST_PARTS) {
            let points: Vec<Point> =
                gaze.iter().filter(|p| within(bounds, self.view, **p)).filter_map(|p| self.point(*p)).collect();
            canvas.line(&points, GAZE_PEN);
        }
        for force in posture.forces.iter().take(MOST_PARTS) {
            self.force(canvas, (force.at, force.tip(self.length_per_newton)), FORCE);
        }
        for load in posture.loads.iter().take(MOST_PARTS) {
            self.force(canvas, (load.at, load.tip_of_load(self.length_per_newton)), HELD);
        }
        if let Some((center, at)) = posture.center_of_mass.and_then(|center| Some((center, self.point(center)?))) {
            if let Some(foot) = posture.ground.and_then(|ground| self.point([center[0], ground, center[2]])) {
                canvas.line(&[at, foot], PLUMB_PEN);
                canvas.dot(foot, 2.0, CENTER, CENTER);
            }
            canvas.dot(at, 5.0, CENTER, PAPER);
        }
        let targets = posture.targets.iter().take(MOST_PARTS);
        let mut outside = 0;
        for target in targets {
            match self.point(*target).filter(|_| within(bounds, self.view, *target)) {
                Some(at) => cross(canvas, at),
                None => outside += 1,
            }
        }
        outside
    }

    /// Muscles from the farthest to the nearest, each with a thin dark rim.
    fn muscles(&self, canvas: &mut Canvas, muscles: &[BodyMuscle]) {
        let depth = |muscle: &BodyMuscle| {
            let points = muscle.lines.iter().flatten();
            points.clone().map(|point| self.place(*point)[2]).sum::<f64>() / points.count().max(1) as f64
        };
        let mut order: Vec<(f64, &BodyMuscle)> =
            muscles.iter().filter(|muscle| drawable(muscle.radius)).take(MOST_MUSCLES).map(|m| (depth(m), m)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, muscle) in order {
            let width = (2.0 * self.scale * muscle.radius).clamp(THINNEST_MUSCLE, THICKEST_MUSCLE);
            let lines = muscle.lines.iter().map(|line| line.iter().filter_map(|p| self.point(*p)).collect());
            for line in lines.collect::<Vec<Vec<Point>>>() {
                canvas.line(&line, Pen::solid(OUTLINE_PEN.ink, width + MUSCLE_RIM));
                canvas.line(&line, Pen::solid(load_ink(muscle.activation), width));
            }
        }
    }

    /// Parts that are seen, each with its colour.
    fn solids(&self, parts: &[BodyPart]) -> Vec<(Solid, Ink)> {
        let ball = |[x, y, z, r]: [f64; 4]| {
            let [x, y, z] = self.place([x, y, z]);
            [x, y, z, self.scale * r]
        };
        let parts = parts.iter().take(MOST_PARTS);
        let seen = parts.map(|part| (balls(part).map(ball).collect::<Vec<_>>(), ink(part)));
        seen.filter(|(balls, _)| !balls.is_empty()).map(|(balls, ink)| (Solid::new(&balls), ink)).collect()
    }

    /// One outline about all parts together.
    fn ghost(&self, canvas: &mut Canvas, parts: &[BodyPart]) {
        let paths: Vec<Path> = self.solids(parts).iter().map(|(solid, _)| solid.outline.path()).collect();
        for (fill, pen) in [(GHOST_EDGE, Pen::solid(GHOST_EDGE, 2.0)), (GHOST, Pen::solid(GHOST, 0.4))] {
            paths.iter().for_each(|path| canvas.shape(path.clone(), fill, pen));
        }
    }

    /// Parts of the body, which hide what is behind them, and surfaces and things, which do not.
    fn solids_in_order(&self, canvas: &mut Canvas, posture: &BodyPosture, bounds: &Bounds) {
        let (mut solids, mut inks): (Vec<Solid>, Vec<Ink>) = self.solids(&posture.parts).into_iter().unzip();
        let is_pale = !posture.muscles.is_empty();
        let pen = if is_pale { Pen::solid(UNKNOWN, OUTLINE_PEN.width) } else { OUTLINE_PEN };
        if is_pale {
            inks.iter_mut().filter(|ink| **ink != HAZARD).for_each(|ink| *ink = UNDER_MUSCLES);
        }
        let boxes: Vec<(Corners, bool)> = posture.boxes().collect();
        for (corners, _) in &boxes {
            let points = corners.map(|corner| self.place(corner)).map(|[x, y, z]| [x, y, z, 0.0]);
            solids.push(Solid::new(&points));
        }
        for i in order(&solids) {
            match inks.get(i) {
                Some(ink) => canvas.shape(solids[i].outline.path(), *ink, pen),
                None => {
                    let (corners, is_thing) = &boxes[i - inks.len()];
                    let pen = if *is_thing { THING_PEN } else { SURFACE_PEN };
                    self.glass_box(canvas, corners, &solids[i], pen, bounds);
                }
            }
        }
    }

    /// A box through which the marks behind it are seen, as far as it is within the bounds.
    fn glass_box(&self, canvas: &mut Canvas, corners: &Corners, solid: &Solid, pen: Pen, bounds: &Bounds) {
        if bounds.is_empty() {
            return;
        }
        let [width, height] = bounds.size().map(|size| self.scale * size);
        let [left, top] = [bounds.low[0], bounds.high[1]];
        let left = self.center.0 + self.scale * (left - self.middle[0]);
        let top = self.center.1 - self.scale * (top - self.middle[1]);
        let window = Rect { left, top, width, height };
        canvas.glass(&clip_polygon(solid.outline.corners(), window), pen.ink, GLASS);
        for i in 0..corners.len() {
            for k in [1, 2, 4].map(|bit| i | bit).into_iter().filter(|k| *k != i) {
                let ends: Vec<Point> = [i, k].into_iter().filter_map(|end| self.point(corners[end])).collect();
                clip(&ends, window).iter().for_each(|part| canvas.line(part, pen));
            }
        }
    }

    fn force(&self, canvas: &mut Canvas, (foot, tip): ([f64; 3], [f64; 3]), ink: Ink) {
        if let (Some(foot), Some(tip)) = (self.point(foot), self.point(tip)) {
            arrow(canvas, foot, tip, ink);
        }
    }
}

/// The colour of a part.
fn ink(part: &BodyPart) -> Ink {
    let known = part.load.filter(|load| !load.is_nan());
    if part.hazard { HAZARD } else { known.map_or(UNKNOWN, load_ink) }
}

fn within(bounds: &Bounds, view: &View, point: [f64; 3]) -> bool {
    let [x, y, _] = view.project(point);
    [x, y]
        .into_iter()
        .enumerate()
        .all(|(k, v)| v >= bounds.low[k] - BOUNDS_TOLERANCE && v <= bounds.high[k] + BOUNDS_TOLERANCE)
}

/// An arrow with a thin white rim, so that it stands out from the parts below it.
pub(crate) fn arrow(canvas: &mut Canvas, foot: Point, tip: Point, ink: Ink) {
    let length = libm::hypot(tip.0 - foot.0, tip.1 - foot.1);
    if length < SHORTEST_ARROW {
        return;
    }
    let (x, y) = ((tip.0 - foot.0) / length, (tip.1 - foot.1) / length);
    let head = HEAD.0.min(length);
    let neck = (tip.0 - head * x, tip.1 - head * y);
    let half = HEAD.1 * head / HEAD.0;
    let corners = [tip, (neck.0 - half * y, neck.1 + half * x), (neck.0 + half * y, neck.1 - half * x)];
    for (ink, rim) in [(PAPER, 2.0), (ink, 0.0)] {
        canvas.line(&[foot, neck], Pen::solid(ink, 2.2 + rim));
        canvas.polygon(&corners, ink, Pen::solid(ink, 0.4 + rim));
    }
}

pub(crate) fn cross(canvas: &mut Canvas, (x, y): Point) {
    for slope in [-1.0, 1.0] {
        canvas.line(&[(x - CROSS, y - slope * CROSS), (x + CROSS, y + slope * CROSS)], TARGET_PEN);
    }
}
