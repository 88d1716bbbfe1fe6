//! Computes the geodesic of a surface that continues as straight tangents to two points outside.
//!
//! Geodesics that start as a tangent from the first point are a family of one parameter; the second unknown is the extent at which the
//! geodesic ends. Residuals at its end, with p the second point, x the end, n the unit normal and v the direction there: n (p - x) and
//! (n x v) (p - x), which are zero where the tangent leads to p. Newton's method; near the solution the first residual alone changes
//! with the extent, by the distance of p times the normal curvature. The geodesic is integrated by Gragg's midpoint rule,
//! extrapolated over fixed numbers of parts of sections so short that the length is a smooth function of the points to rounding.

use nalgebra::Vector3;

use super::contact::Contact;
use crate::muscle::tolerances::{
    GEODESIC_FOUND, GEODESIC_NUDGE, GEODESIC_PARTS, GEODESIC_SECTION, GEODESIC_SECTIONS, GEODESIC_SMALL,
    GEODESIC_STEPS, GEODESIC_TURN,
};

type V = Vector3<f64>;

/// A point of a curve on a surface, its direction, and the length up to there.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) place: V,
    pub(super) direction: V,
    pub(super) length: f64,
}

impl State {
    /// This state moved by rates for an extent.
    fn moved(&self, rates: &Self, extent: f64) -> Self {
        Self {
            place: self.place + extent * rates.place,
            direction: self.direction + extent * rates.direction,
            length: self.length + extent * rates.length,
        }
    }

    /// A combination of two states.
    fn combined(&self, share: f64, other: &Self, other_share: f64) -> Self {
        Self {
            place: share * self.place + other_share * other.place,
            direction: share * self.direction + other_share * other.direction,
            length: share * self.length + other_share * other.length,
        }
    }
}

/// A smooth surface with its geodesics, in coordinates in which straight lines are straight.
pub(super) trait Surface {
    /// State where the line from a point outside touches the surface; a number tells these places apart.
    fn tangent(&self, from: &V, number: f64) -> Option<State>;
    /// Rates of the state by the extent.
    fn rates(&self, state: &State) -> State;
    /// Extent of about one radian.
    fn radius(&self) -> f64;
    /// Unit normal, outward.
    fn normal(&self, place: &V) -> V;
}

/// A geodesic between tangents from two points.
pub(super) struct Geodesic {
    first: State,
    extent: f64,
    second: State,
}

impl Geodesic {
    /// The place half way of its extent.
    pub(super) fn middle(&self, surface: &impl Surface) -> V {
        integrated(surface, self.first, 0.5 * self.extent).place
    }

    pub(super) fn contact(&self) -> Contact {
        Contact { first: self.first.place, second: self.second.place, length: self.second.length }
    }
}

/// The geodesic near a first guess of its number and its extent; `None` where the search does not end, or ends at a geodesic whose tangent
/// leads away from the second point.
pub(super) fn find(surface: &impl Surface, from: &V, to: &V, guess: (f64, f64)) -> Option<Geodesic> {
    let (mut number, mut extent) = guess;
    let longest = 2.0 * extent.abs() + 1.0;
    let (mut turn, mut slopes) = (f64::INFINITY, [0.0; 2]);
    for _ in 0..GEODESIC_STEPS {
        let first = surface.tangent(from, number)?;
        let second = integrated(surface, first, extent);
        let residual = residual(surface, &second, to);
        if turn.abs() > GEODESIC_SMALL {
            let nudged = integrated(surface, surface.tangent(from, number + GEODESIC_NUDGE)?, extent);
            let beside = self::residual(surface, &nudged, to);
            slopes = [0, 1].map(|i| (beside[i] - residual[i]) / GEODESIC_NUDGE);
        }
        let rates = surface.rates(&second);
        let curvature = -surface.normal(&second.place).dot(&rates.direction);
        let by_extent = second.direction.dot(&(to - second.place)) * curvature;
        turn = -residual[1] / slopes[1];
        let mut more = -(residual[0] + slopes[0] * turn) / by_extent;
        let furthest = (0.5 * extent).max(GEODESIC_TURN / curvature.abs());
        let scale = (GEODESIC_TURN / turn.abs()).min(furthest / more.abs()).min(1.0);
        (turn, more) = (scale * turn, scale * more);
        if !turn.is_finite() || !more.is_finite() {
            return None;
        }
        if turn.abs() < GEODESIC_FOUND && more.abs() < GEODESIC_FOUND {
            let ahead = second.direction.dot(&(to - second.place)) >= 0.0;
            return ahead.then_some(Geodesic { first, extent, second });
        }
        (number, extent) = (number + turn, (extent + more).clamp(0.0, longest));
    }
    None
}

fn residual(surface: &impl Surface, end: &State, to: &V) -> [f64; 2] {
    let normal = surface.normal(&end.place);
    let ahead = to - end.place;
    [normal.dot(&ahead), normal.cross(&end.direction).dot(&ahead)]
}

/// The state at an extent from a first one.
fn integrated(surface: &impl Surface, first: State, extent: f64) -> State {
    let sections = ((extent / (GEODESIC_SECTION * surface.radius())).ceil() as usize).clamp(1, GEODESIC_SECTIONS);
    let section = extent / sections as f64;
    (0..sections).fold(first, |state, _| extrapolated(surface, &state, section))
}

/// One section, extrapolated to parts of no extent.
fn extrapolated(surface: &impl Surface, first: &State, section: f64) -> State {
    let start = surface.rates(first);
    // Column by column of Neville's table: `row[k]` is the last value of column k.
    let mut row = [*first; GEODESIC_PARTS.len()];
    for (i, &parts) in GEODESIC_PARTS.iter().enumerate() {
        let step = section / f64::from(parts);
        let (mut before, mut here) = (*first, first.moved(&start, step));
        for _ in 1..parts {
            (before, here) = (here, before.moved(&surface.rates(&here), 2.0 * step));
        }
        let mut value = before.combined(0.5, &here, 0.5).moved(&surface.rates(&here), 0.5 * step);
        for column in 0..i {
            let ratio = (f64::from(parts) / f64::from(GEODESIC_PARTS[i - 1 - column])).powi(2) - 1.0;
            let next = value.combined(1.0 + 1.0 / ratio, &row[column], -1.0 / ratio);
            (row[column], value) = (value, next);
        }
        row[i] = value;
    }
    row[GEODESIC_PARTS.len() - 1]
}
