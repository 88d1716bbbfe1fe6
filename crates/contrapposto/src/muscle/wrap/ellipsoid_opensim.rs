//! Computes a line over an ellipsoid as OpenSim 4 does: tangents and a section of the ellipsoid in the plane through both ends and a
//! point of the surface.
//!
//! The rule was learnt from the behaviour and the source of OpenSim (opensim-core, `WrapEllipsoid`). The point is that nearest to a place
//! of the straight line: where the line crosses a plane of symmetry (`axial`), half way (`midpoint`), or by the mean direction of many
//! nearest points, blended with the first (`hybrid`). Its searches end early, so that their ends are part of the rule. All is done in a
//! scale in which the mean half axis is 1.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::contact::{Contact, Quadrant, Wrapping, crossings};
use super::nearest::nearest;
use super::tangency::Tangency;
use crate::muscle::rule::WrapMethod;
use crate::muscle::tolerances::{
    ELLIPSOID_AXIAL_FROM, ELLIPSOID_BLADES, ELLIPSOID_FADE, ELLIPSOID_FAN_BELOW, ELLIPSOID_ON, ELLIPSOID_PIECE,
    ELLIPSOID_PIECES,
};

type V = Vector3<f64>;

/// Lays the straight line between two points over an ellipsoid about the origin.
pub(super) fn wrap(sizes: &V, quadrant: Quadrant, method: WrapMethod, from: &V, to: &V) -> Wrapping {
    let factor = 3.0 / sizes.sum();
    let (p1, p2, axes) = (factor * from, factor * to, factor * sizes);
    let [beyond1, beyond2] = [p1, p2].map(|p| p.component_div(&axes).norm_squared() - 1.0);
    if beyond1 < -ELLIPSOID_ON || beyond2 < -ELLIPSOID_ON {
        return Wrapping::Inside;
    }
    if (p1.normalize().dot(&p2.normalize()) - 1.0).abs() < ELLIPSOID_ON {
        return Wrapping::Free;
    }
    let Some((enters, leaves)) = crossings(&p1.component_div(&axes), &p2.component_div(&axes)) else {
        return Wrapping::Free;
    };
    let chord = Chord { axes, from: p1 + enters * (p2 - p1), to: p1 + leaves * (p2 - p1) };
    let Middle { mut point, fan, inside } = chord.middle(method, &(p1 - p2));
    let mut starts = if inside { [point, point] } else { [chord.from, chord.to] };
    if let Quadrant::Half { axis, positive } = quadrant
        && !Quadrant::on(axis, positive, &point)
    {
        point[axis] = -point[axis];
        starts = [point, point];
        if fan > 0.0 {
            point[axis] *= 1.0 - fan;
            point = nearest(&axes, &point, None).unwrap_or(point);
        }
    }
    let normal = (p1 - p2).cross(&(p1 - point)).try_normalize(f64::EPSILON).unwrap_or_default();
    let plane = (normal, -normal.dot(&point));
    let tangent = |end: &V, beyond: f64, start: V| {
        if beyond.abs() < ELLIPSOID_ON { *end } else { Tangency::new(&axes, end, plane).search(start) }
    };
    let (first, second) = (tangent(&p1, beyond1, starts[0]), tangent(&p2, beyond2, starts[1]));
    let section = Section { axes, factor, normal, offset: plane.1, first, second };
    let (mut length, beside) = section.length(false);
    let back = |end: &V, at: &V, next: &V| (end - at).normalize().dot(&(next - at).normalize()) > 0.0;
    if let (Quadrant::Half { .. }, Some([w1, w2])) = (quadrant, beside)
        && (back(&p1, &first, &w1) || back(&p2, &second, &w2))
    {
        length = section.length(true).0;
    }
    Wrapping::Crosses(Contact { first: first / factor, second: second / factor, length: length / factor })
}

/// The part of the straight line inside of the ellipsoid.
struct Chord {
    axes: V,
    from: V,
    to: V,
}

/// The point of the surface that determines the plane.
struct Middle {
    point: V,
    /// Share of the fan in it, above 0 only where a fan was asked for.
    fan: f64,
    /// The search of tangents may start from it.
    inside: bool,
}

impl Chord {
    fn at(&self, share: f64) -> V {
        self.from + share * (self.to - self.from)
    }

    fn middle(&self, method: WrapMethod, line: &V) -> Middle {
        if method == WrapMethod::Midpoint {
            let half_way = self.at(0.5);
            let point = nearest(&self.axes, &half_way, None).unwrap_or(half_way);
            return Middle { point, fan: f64::NEG_INFINITY, inside: true };
        }
        let along = line.normalize().abs();
        let axis = along.imax();
        let share = -self.from[axis] / (self.to - self.from)[axis];
        let place = self.at(share);
        let mut point = nearest(&self.axes, &place, Some(axis)).unwrap_or(place);
        if method == WrapMethod::Axial {
            return Middle { point, fan: f64::NEG_INFINITY, inside: share > 0.0 && share < 1.0 };
        }
        let mut parallel = along[axis];
        if parallel > ELLIPSOID_FAN_BELOW {
            let to_end = share.min(1.0 - share).max(0.0);
            parallel = ELLIPSOID_FAN_BELOW + (to_end / ELLIPSOID_FADE).min(1.0) * (parallel - ELLIPSOID_FAN_BELOW);
        }
        let mut fan = f64::NEG_INFINITY;
        if parallel < ELLIPSOID_AXIAL_FROM {
            let by_fan = self.fan(point);
            let axial = (parallel - ELLIPSOID_FAN_BELOW) / (ELLIPSOID_AXIAL_FROM - ELLIPSOID_FAN_BELOW);
            fan = 1.0 - axial.max(0.0);
            if fan < 1.0 {
                let blend = axial * point + fan * by_fan;
                point = nearest(&self.axes, &blend, None).unwrap_or(blend);
            } else {
                point = by_fan;
            }
        }
        Middle { point, fan, inside: true }
    }

    /// The point in the mean direction from places of the chord to the points of the surface that are nearest to them.
    fn fan(&self, mut nearby: V) -> V {
        let mut sum = V::zeros();
        for blade in 1..ELLIPSOID_BLADES - 1 {
            let place = self.at(f64::from(blade) / f64::from(ELLIPSOID_BLADES));
            // Where the search fails OpenSim keeps the point before.
            nearby = nearest(&self.axes, &place, None).unwrap_or(nearby);
            sum += (nearby - place).try_normalize(f64::EPSILON).unwrap_or_default();
        }
        let tip = self.at(0.5) + sum.try_normalize(f64::EPSILON).unwrap_or_default();
        nearest(&self.axes, &tip, None).unwrap_or(tip)
    }
}

/// The section of the ellipsoid with a plane, between two points.
struct Section {
    axes: V,
    factor: f64,
    normal: V,
    offset: f64,
    first: V,
    second: V,
}

impl Section {
    /// Length of the section as that of its pieces, on the near or on the far side; the points next to both ends, where there are any.
    fn length(&self, far: bool) -> (f64, Option<[V; 2]>) {
        let straight = (self.first - self.second).norm() / self.factor;
        // Of none, and of one, the length is that of the chord.
        let pieces = ((straight / ELLIPSOID_PIECE) as u32).min(ELLIPSOID_PIECES);
        let axis = self.normal.icamax();
        let mut hub = V::zeros();
        hub[axis] = -self.offset / self.normal[axis];
        let unit = |v: V| v.try_normalize(f64::EPSILON).unwrap_or_default();
        let (out, other) = (unit(self.first - hub), unit(self.second - hub));
        let angle = libm::acos(out.dot(&other).clamp(-1.0, 1.0));
        let step = if far { angle - TAU } else { angle } / f64::from(pieces);
        let across = unit(out.cross(&other)).cross(&out);
        let from_hub = hub.component_div(&self.axes);
        let point = |number: u32| {
            let (sin, cos) = libm::sincos(f64::from(number) * step);
            let ray = out * cos + across * sin;
            let scaled = ray.component_div(&self.axes);
            let (a, b, c) = (scaled.norm_squared(), scaled.dot(&from_hub), from_hub.norm_squared() - 1.0);
            hub + ray * ((-b + (b * b - a * c).sqrt()) / a)
        };
        let (mut before, mut length, mut next) = (self.first, 0.0, None);
        for number in 1..pieces {
            let here = point(number);
            length += (here - before).norm();
            next.get_or_insert(here);
            before = here;
        }
        (length + (self.second - before).norm(), next.map(|next| [next, before]))
    }
}
