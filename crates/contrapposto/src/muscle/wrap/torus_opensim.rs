//! Computes a line over a torus as OpenSim 4 does: as over the inner half of a straight tube along the tangent of the torus's circle, at
//! the point of the circle that is nearest to the straight line.
//!
//! The rule was learnt from the behaviour and the source of OpenSim (opensim-core, `WrapTorus`), which searches that point from either end
//! by a damped Newton method of MINPACK (`lmdif`, one unknown) to a limited accuracy.

use nalgebra::{Matrix3, Vector3};

use super::contact::{Contact, Quadrant, Wrapping};
use super::{cylinder, cylinder_opensim};
use crate::muscle::tolerances::{TORUS_ACCURACY, TORUS_FIRST_STEP, TORUS_NUDGE, TORUS_STEPS, TORUS_TUBE};

type V = Vector3<f64>;

/// Lays the straight line between two points over a torus about z.
pub(super) fn wrap(tube: f64, circle: f64, quadrant: Quadrant, from: &V, to: &V, single: bool) -> Wrapping {
    laid(circle, quadrant, from, to, |p1, p2| cylinder_opensim::wrap(tube, TORUS_TUBE, INNER, p1, p2, single))
}

/// The shortest line over the tube.
pub(super) fn over_tube(tube: f64, circle: f64, quadrant: Quadrant, from: &V, to: &V) -> Wrapping {
    laid(circle, quadrant, from, to, |p1, p2| cylinder::wrap(tube, TORUS_TUBE, INNER, p1, p2))
}

/// The half of the tube that is towards the middle of the torus.
const INNER: Quadrant = Quadrant::Half { axis: 0, positive: true };

/// A line over the tube, in whose frame `wrap` lays it.
fn laid(circle: f64, quadrant: Quadrant, from: &V, to: &V, wrap: impl Fn(&V, &V) -> Wrapping) -> Wrapping {
    let Some((axes, at)) = tube_frame(circle, quadrant, from, to) else { return Wrapping::Free };
    match wrap(&(axes * (from - at)), &(axes * (to - at))) {
        Wrapping::Touches(contact) | Wrapping::Crosses(contact) => {
            let [first, second] = [contact.first, contact.second].map(|p| axes.tr_mul(&p) + at);
            Wrapping::Touches(Contact { first, second, length: contact.length })
        }
        Wrapping::Inside | Wrapping::Free | Wrapping::WithoutLine => Wrapping::WithoutLine,
    }
}

/// Frame of the tube: rows are its axes (x to the middle of the torus, z along the tube), and its origin. `None` where the nearest places
/// of the line are in the other half.
fn tube_frame(circle: f64, quadrant: Quadrant, from: &V, to: &V) -> Option<(Matrix3<f64>, V)> {
    let places = [nearest(circle, from, to), nearest(circle, to, from)];
    let distance = |p: &V| p.xy().norm_squared() - 2.0 * circle * p.xy().norm() + p.z * p.z;
    let allowed = |p: &V| match quadrant {
        Quadrant::All => true,
        Quadrant::Half { axis, positive } => Quadrant::on(axis, positive, p),
    };
    let place = match (allowed(&places[0]), allowed(&places[1])) {
        (true, true) if distance(&places[0]) < distance(&places[1]) => places[0],
        (_, true) => places[1],
        (true, false) => places[0],
        (false, false) => return None,
    };
    let inward = -V::new(place.x, place.y, 0.0).try_normalize(0.0)?;
    let across = -V::z();
    Some((
        Matrix3::from_rows(&[inward.transpose(), across.transpose(), inward.cross(&across).transpose()]),
        -circle * inward,
    ))
}

/// The place of a line nearest to a circle about z, or another where the distance does not change, searched from the line's start.
fn nearest(circle: f64, from: &V, to: &V) -> V {
    let along = (to - from).try_normalize(0.0).unwrap_or_default();
    let (flat, steep) = (along.xy().norm_squared(), 2.0 * from.dot(&along));
    let (mixed, start) = (from.xy().dot(&along.xy()), from.xy().norm_squared());
    // Derivative of the squared distance by the way along the line.
    let slope =
        |u: f64| steep + 2.0 * u - 4.0 * circle * (flat * u + mixed) / (u * u * flat + 2.0 * mixed * u + start).sqrt();
    from + root(slope) * along
}

/// A root from 0: the method of `lmdif` for one equation of one unknown. Trust regions are lengths of `scale` times the unknown.
fn root(function: impl Fn(f64) -> f64) -> f64 {
    let (mut at, mut value) = (0f64, function(0.0));
    let (mut scale, mut radius, mut damping) = (0.0f64, TORUS_FIRST_STEP, 0.0f64);
    let mut first = true;
    for _ in 0..TORUS_STEPS {
        let slope = (function(at + TORUS_NUDGE) - value) / TORUS_NUDGE;
        if !slope.is_finite() || slope == 0.0 || value == 0.0 {
            break;
        }
        scale = scale.max(slope.abs());
        loop {
            let step = damped(value, slope, scale, radius, &mut damping);
            let size = (scale * step).abs();
            if first {
                radius = radius.min(size);
            }
            let next = function(at - step);
            let actual = if 0.1 * next.abs() < value.abs() { 1.0 - (next / value).powi(2) } else { -1.0 };
            let linear = (slope * step / value).powi(2);
            let curved = damping * (size / value).powi(2);
            let predicted = linear + 2.0 * curved;
            let ratio = if predicted == 0.0 { 0.0 } else { actual / predicted };
            if ratio <= 0.25 {
                let downhill = -(linear + curved);
                let mut cut = if actual >= 0.0 { 0.5 } else { 0.5 * downhill / (downhill + 0.5 * actual) };
                if 0.1 * next.abs() >= value.abs() || cut < 0.1 {
                    cut = 0.1;
                }
                radius = cut * radius.min(10.0 * size);
                damping /= cut;
            } else if damping == 0.0 || ratio >= 0.75 {
                (radius, damping) = (2.0 * size, 0.5 * damping);
            }
            if ratio >= 1e-4 {
                (at, value) = (at - step, next);
                first = false;
            }
            let converged = actual.abs() <= TORUS_ACCURACY && predicted <= TORUS_ACCURACY && 0.5 * ratio <= 1.0;
            if converged || radius <= TORUS_ACCURACY * (scale * at).abs() || radius < f64::MIN_POSITIVE {
                return at;
            }
            if ratio >= 1e-4 {
                break;
            }
        }
    }
    at
}

/// A step of a size near the trust radius: value slope / (slope^2 + damping scale^2), by at most ten improvements of the damping.
fn damped(value: f64, slope: f64, scale: f64, radius: f64, damping: &mut f64) -> f64 {
    let step = value / slope;
    let mut excess = (scale * step).abs() - radius;
    if excess <= 0.1 * radius {
        *damping = 0.0;
        return step;
    }
    let mut low = excess / radius * (slope / scale).powi(2);
    let mut high = (slope * value).abs() / scale / radius;
    *damping = damping.max(low).min(high);
    if *damping == 0.0 {
        *damping = (slope * value).abs() / scale / (scale * step).abs();
    }
    for iteration in 1.. {
        if *damping == 0.0 {
            *damping = f64::MIN_POSITIVE.max(0.001 * high);
        }
        let square = slope.powi(2) + *damping * scale.powi(2);
        let step = slope * value / square;
        let before = excess;
        let size = (scale * step).abs();
        excess = size - radius;
        let stays = low == 0.0 && excess <= before && before < 0.0;
        if excess.abs() <= 0.1 * radius || stays || iteration == 10 {
            return step;
        }
        let correction = excess / radius * square / scale.powi(2);
        if excess > 0.0 {
            low = low.max(*damping);
        } else {
            high = high.min(*damping);
        }
        *damping = low.max(*damping + correction);
    }
    step
}
