//! Computes the shortest line over an ellipsoid: two tangents and a geodesic between them.
//!
//! All is done in coordinates y = x / a in which the ellipsoid is the unit sphere: straight lines and tangents stay what they are there.
//! The geodesic in these coordinates, at unit speed in them, with B = 1 / a^2 and w = B y: y'' = -(w - (w y') y') / (y w), and the length
//! grows by |a y'|. Of all plane sections through both ends, the shortest is the start of the search. In a quadrant the middle of the line is
//! in that half; where no geodesic is there, the shortest of these sections takes its place.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::contact::{Contact, Quadrant, Wrapping, crossings};
use super::geodesic::{State, Surface, find};
use crate::muscle::tolerances::{ELLIPSOID_ON, GEODESIC_OUTSIDE, GEODESIC_PIECES, GEODESIC_PLANES};

type V = Vector3<f64>;

/// Lays the straight line between two points over an ellipsoid about the origin.
pub(super) fn wrap(half_axes: &V, quadrant: Quadrant, from: &V, to: &V) -> Wrapping {
    let [p1, p2] = [from, to].map(|p| p.component_div(half_axes));
    if p1.norm_squared() < 1.0 - ELLIPSOID_ON || p2.norm_squared() < 1.0 - ELLIPSOID_ON {
        return Wrapping::Inside;
    }
    if crossings(&p1, &p2).is_none() {
        return Wrapping::Free;
    }
    let [p1, p2] = [p1, p2].map(|p| p * ((1.0 + GEODESIC_OUTSIDE) / p.norm()).max(1.0));
    let ellipsoid = Ellipsoid { half_axes: *half_axes, bend: half_axes.map(|a| (half_axes.mean() / a).powi(2)) };
    let restricted = quadrant != Quadrant::All;
    let allowed = |middle: &V| match quadrant {
        Quadrant::All => true,
        Quadrant::Half { axis, positive } => Quadrant::on(axis, positive, middle),
    };
    let Some(mut contact) = ellipsoid.line(&p1, &p2, restricted, allowed) else { return Wrapping::Free };
    contact.first.component_mul_assign(half_axes);
    contact.second.component_mul_assign(half_axes);
    Wrapping::Crosses(contact)
}

struct Ellipsoid {
    half_axes: V,
    /// Inverse squares of the half axes over their mean.
    bend: V,
}

/// Two unit vectors across a vector.
fn across(v: &V) -> (V, V) {
    let e = v.cross(&V::ith(v.iamin(), 1.0)).normalize();
    (e, v.normalize().cross(&e))
}

/// The number of a place of tangency: its angle about the direction of the point.
fn number(from: &V, place: &V) -> f64 {
    let (e1, e2) = across(from);
    libm::atan2(place.dot(&e2), place.dot(&e1))
}

impl Surface for Ellipsoid {
    fn tangent(&self, from: &V, number: f64) -> Option<State> {
        let distance = from.norm();
        let (e1, e2) = across(from);
        let (sin, cos) = libm::sincos(number);
        let (out, round) = (from / distance, e1 * cos + e2 * sin);
        let (along, off) = (1.0 / distance, (1.0 - 1.0 / (distance * distance)).max(0.0).sqrt());
        Some(State { place: along * out + off * round, direction: along * round - off * out, length: 0.0 })
    }

    fn rates(&self, state: &State) -> State {
        let scaled = state.place.component_mul(&self.bend);
        let force = scaled - scaled.dot(&state.direction) * state.direction;
        State {
            place: state.direction,
            direction: -force / state.place.dot(&scaled),
            length: state.direction.component_mul(&self.half_axes).norm(),
        }
    }

    fn radius(&self) -> f64 {
        1.0
    }

    fn normal(&self, place: &V) -> V {
        *place
    }
}

/// A plane section between two tangents.
#[derive(Clone, Copy)]
struct Section {
    first: V,
    second: V,
    /// Extent of the section in the coordinates of the sphere.
    angle: f64,
    /// Length of the section, m, and that with both tangents.
    length: f64,
    total: f64,
}

impl Section {
    fn contact(&self) -> Contact {
        Contact { first: self.first, second: self.second, length: self.length }
    }
}

impl Ellipsoid {
    /// The geodesic whose middle is allowed, from the shortest allowed plane section; where it leads to another half, from the longest one:
    /// the way over the far side, which no shortest line takes by itself. The shortest section where neither is found.
    fn line(&self, p1: &V, p2: &V, restricted: bool, allowed: impl Fn(&V) -> bool) -> Option<Contact> {
        let along = (p2 - p1).normalize();
        let foot = p1 - p1.dot(&along) * along;
        let (beside, _) = across(&along);
        let above = foot.try_normalize(f64::EPSILON).unwrap_or(beside);
        let aside = along.cross(&above);
        let mut ends: Option<(Section, Section)> = None;
        for plane in 0..GEODESIC_PLANES {
            let (sin, cos) = libm::sincos(TAU * plane as f64 / GEODESIC_PLANES as f64);
            let up = cos * above + sin * aside;
            let normal = along.cross(&up);
            let center = normal.dot(&foot) * normal;
            let radius = (1.0 - center.norm_squared()).sqrt();
            if !allowed(&(center + radius * up)) {
                continue;
            }
            let section = self.section([p1, p2], center, radius, (along, up));
            match &mut ends {
                None => ends = Some((section, section)),
                Some((shortest, _)) if section.total < shortest.total => *shortest = section,
                Some((_, longest)) if section.total > longest.total => *longest = section,
                Some(_) => {}
            }
        }
        let (shortest, longest) = ends?;
        let found = [shortest, longest].iter().find_map(|section| {
            find(self, p1, p2, (number(p1, &section.first), section.angle))
                .filter(|found| !restricted || allowed(&found.middle(self)))
        });
        Some(found.map_or_else(|| shortest.contact(), |found| found.contact()))
    }

    /// The section whose circle has a center and a radius, over the side of `up`.
    fn section(&self, ends: [&V; 2], center: V, radius: f64, (along, up): (V, V)) -> Section {
        let [at1, at2] = ends.map(|p| (p.dot(&along), p.dot(&up)));
        let reach = |(x, y): (f64, f64)| libm::acos((radius / libm::hypot(x, y)).min(1.0));
        let start = libm::atan2(at1.1, at1.0).rem_euclid(TAU) - reach(at1);
        let end = libm::atan2(at2.1, at2.0) + reach(at2);
        let angle = (start - end).rem_euclid(TAU);
        let place = |turned: f64| {
            let (sin, cos) = libm::sincos(start - turned);
            center + radius * (cos * along + sin * up)
        };
        let distance = |a: &V, b: &V| (a - b).component_mul(&self.half_axes).norm();
        let (first, second) = (place(0.0), place(angle));
        let (mut length, mut before) = (0.0, first);
        for piece in 1..=GEODESIC_PIECES {
            let here = place(angle * piece as f64 / GEODESIC_PIECES as f64);
            length += distance(&before, &here);
            before = here;
        }
        let total = distance(ends[0], &first) + length + distance(&second, ends[1]);
        Section { first, second, angle: radius * angle, length, total }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point on the surface counts as outside where it lies inside by rounding, and where it lies outside by as little.
    #[test]
    fn a_point_is_inside_only_beyond_the_thickness_of_the_surface() {
        let half_axes = V::new(0.05, 0.03, 0.04);
        let wrapped = |square: f64| {
            let from = V::new(0.05 * square.sqrt(), 0.0, 0.0);
            let to = V::new(-0.1, 0.01, 0.0);
            [wrap(&half_axes, Quadrant::All, &from, &to), wrap(&half_axes, Quadrant::All, &to, &from)]
        };
        for outside in [1.0 + 0.5 * ELLIPSOID_ON, 1.0 + 2.0 * ELLIPSOID_ON] {
            for wrapping in wrapped(outside) {
                let Wrapping::Crosses(contact) = wrapping else { panic!("{outside}: {wrapping:?}") };
                let straight = (contact.second - contact.first).norm();
                assert!(
                    straight > 0.07 && contact.length > straight + 0.005,
                    "about a third of the way round: {contact:?}"
                );
            }
        }
        assert!(wrapped(1.0 - 0.5 * ELLIPSOID_ON).iter().all(|wrapping| *wrapping != Wrapping::Inside));
        assert!(wrapped(1.0 - 2.0 * ELLIPSOID_ON).iter().all(|wrapping| *wrapping == Wrapping::Inside));
    }
}
