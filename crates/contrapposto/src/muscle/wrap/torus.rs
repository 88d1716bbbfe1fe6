//! Computes the line over a torus: two tangents and a geodesic between them, over the inner side of the tube.
//!
//! The place at which a line touches the tube is told apart by its angle about the axis of the torus; in the section across the tube there,
//! two lines touch, of which the one on the side of the first guess counts. The guess is the line over a straight tube at the same place.
//! Where no geodesic is near, that line takes its place.

use nalgebra::Vector3;

use super::contact::{Contact, Quadrant, Wrapping};
use super::geodesic::{Geodesic, State, Surface, find};
use super::torus_opensim::over_tube;
use crate::muscle::tolerances::{GEODESIC_TURN, TORUS_BENDS};

type V = Vector3<f64>;

/// Lays the straight line between two points over a torus about z.
pub(super) fn wrap(tube: f64, circle: f64, quadrant: Quadrant, from: &V, to: &V) -> Wrapping {
    let Wrapping::Touches(guess) = over_tube(tube, circle, quadrant, from, to) else { return Wrapping::Free };
    let near = |place: &V| {
        let angle = libm::atan2(place.y, place.x);
        let mut torus = Torus { tube, circle, upper: true };
        let miss = |torus: &Torus| torus.tangent(from, angle).map(|state| (state.place - place).norm_squared());
        let above = miss(&torus)?;
        torus.upper = false;
        torus.upper = above < miss(&torus)?;
        find(&torus, from, to, (angle, guess.length))
    };
    let total = |contact: &Contact| (contact.first - from).norm() + contact.length + (to - contact.second).norm();
    // Geodesics that run round the tube or the torus another way are not the line.
    let same_way = |found: &Geodesic| (total(&found.contact()) - total(&guess)).abs() < tube;
    let through = through_hole(circle - tube, from, to).as_ref().and_then(near).filter(same_way);
    let found = through.or_else(|| near(&guess.first).filter(same_way));
    Wrapping::Touches(found.map_or(guess, |geodesic| geodesic.contact()))
}

/// The place of the edge of a disc across z at which the shortest way between two points through the disc bends; `None` for points on one
/// side of its plane. The lengths are a convex function of the place, so that there is one.
fn through_hole(radius: f64, from: &V, to: &V) -> Option<V> {
    if from.z * to.z >= 0.0 {
        return None;
    }
    let straight = from + from.z / (from.z - to.z) * (to - from);
    let mut angle = libm::atan2(straight.y, straight.x);
    for _ in 0..TORUS_BENDS {
        let (sin, cos) = libm::sincos(angle);
        let (place, slope) = (radius * V::new(cos, sin, 0.0), radius * V::new(-sin, cos, 0.0));
        let (mut first, mut second) = (0.0, 0.0);
        for end in [from, to] {
            let away = place - end;
            let distance = away.norm();
            let rate = away.dot(&slope) / distance;
            first += rate;
            second += (slope.norm_squared() - place.dot(&away) - rate * rate) / distance;
        }
        let step = if second > 0.0 { -first / second } else { -first.signum() * GEODESIC_TURN };
        angle += step.clamp(-GEODESIC_TURN, GEODESIC_TURN);
    }
    Some(radius * V::new(libm::cos(angle), libm::sin(angle), 0.0))
}

struct Torus {
    tube: f64,
    circle: f64,
    /// The line touches on the upper side, seen from the point.
    upper: bool,
}

impl Surface for Torus {
    fn tangent(&self, from: &V, number: f64) -> Option<State> {
        let (sin, cos) = libm::sincos(number);
        let out = V::new(cos, sin, 0.0);
        // In the section across the tube: the point as seen from the middle of the tube.
        let (beyond, above) = (from.dot(&out) - self.circle, from.z);
        let distance = libm::hypot(beyond, above);
        if distance <= self.tube {
            return None;
        }
        let half = libm::acos(self.tube / distance);
        let turned = libm::atan2(above, beyond) + if self.upper { half } else { -half };
        let place = (self.circle + self.tube * libm::cos(turned)) * out + self.tube * libm::sin(turned) * V::z();
        let direction = (place - from).try_normalize(0.0)?;
        Some(State { place, direction, length: 0.0 })
    }

    fn rates(&self, state: &State) -> State {
        let (place, direction) = (&state.place, &state.direction);
        let distance = place.xy().norm();
        let out = V::new(place.x, place.y, 0.0) / distance;
        let (away, up) = (direction.dot(&out), direction.z);
        let round = V::z().cross(&out).dot(direction);
        let bend = (away * away + up * up + (distance - self.circle) / distance * round * round) / self.tube;
        State { place: *direction, direction: -bend * self.normal(place), length: 1.0 }
    }

    fn radius(&self) -> f64 {
        self.tube
    }

    fn normal(&self, place: &V) -> V {
        let flat = V::new(place.x, place.y, 0.0);
        (place - self.circle / flat.norm() * flat) / self.tube
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use std::f64::consts::TAU;

    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::{V, through_hole};

    const SEED: u128 = 96;
    /// Places of the edge that are compared.
    const PLACES: u32 = 20_000;

    /// The line passes outside of the disc, so that its edge is where the way bends.
    #[test]
    fn no_other_place_of_the_edge_makes_the_way_through_a_hole_shorter() {
        let mut random = Pcg64Mcg::new(SEED);
        let mut compared = 0;
        while compared < 40 {
            let mut at = |z: std::ops::Range<f64>| {
                V::new(random.random_range(-0.3..0.3), random.random_range(-0.3..0.3), random.random_range(z))
            };
            let (from, to) = (at(0.02..0.3), at(-0.3..-0.02));
            if (from + from.z / (from.z - to.z) * (to - from)).norm() < 0.1 {
                continue;
            }
            compared += 1;
            let length = |place: V| (place - from).norm() + (to - place).norm();
            let place = |k: u32| {
                let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(PLACES));
                0.1 * V::new(cos, sin, 0.0)
            };
            let least = (0..PLACES).map(|k| length(place(k))).fold(f64::INFINITY, f64::min);
            let found = through_hole(0.1, &from, &to).unwrap();
            assert!((found.norm() - 0.1).abs() < 1e-15 && found.z == 0.0, "{found}");
            assert!(length(found) < least + 1e-14, "seed {SEED}: {} is more than {least}", length(found));
        }
        assert_eq!(through_hole(0.1, &V::new(0.2, 0.0, 0.1), &V::new(-0.2, 0.0, 0.1)), None, "on one side");
    }
}
