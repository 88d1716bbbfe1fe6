//! Error and Jacobian of the distances of parts of the body from each other and from things.
//!
//! `d >= margin`, m, one inequality a pair, with `d = |p - q| - r_a - r_b` for two capsules whose lines are closest at `p` and `q`.
//! Its row is `n . (J_p - J_q)`, `n` the unit line from `q` to `p`: where the closest points are unique they may be taken as
//! fixed in their segments (Danskin 1967, "The Theory of Max-Min"; recalled). Where the lines meet, `n` is square to both of
//! them. A thing is fixed in ground. A pair farther apart than [`Clearance::activation`] has a row of zeros without limits.

use nalgebra::{Point3, Vector3};

use super::check::{Check, TaskError, TaskPart};
use super::rows::{add_along, append};
use super::thing::Thing;
use crate::joint_torques::JointTorques;
use crate::kinematics::Kinematics;
use crate::math::{closest_on_segments, closest_to_block};
use crate::model::{Capsule, LARGEST, Model};
use hierarchical_least_squares::Level;

/// Parts of the body apart from each other and from things.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    /// One row each.
    pub pairs: Vec<ClearancePair>,
    /// Least distance, m; not negative.
    pub margin: f64,
    /// Distance from which on a pair has no row, m; above the margin.
    pub activation: f64,
}

/// A part of the body, and what it keeps apart from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearancePair {
    /// The part.
    pub part: Capsule,
    /// The other part, or the thing.
    pub other: Obstacle,
}

/// Thing or part that a part of the body does not pass through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// Another part of the body.
    Part(Capsule),
    /// A thing in ground.
    Thing(Thing),
}

/// Closest points of a pair, in a posture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Distance of the surfaces, m; negative where the parts overlap.
    pub(super) distance: f64,
    /// Unit direction in ground in which the part moves away from the other one.
    pub(super) away: Vector3<f64>,
    /// Point of the part's line, in its segment, m.
    on_part: Vector3<f64>,
    /// Segment and point of the other line, for a part.
    on_other: Option<(usize, Vector3<f64>)>,
}

impl Nearest {
    /// Segments, their points and unit directions whose motions along them add up to the growth of the distance.
    pub(super) fn stations(&self, pair: &ClearancePair) -> impl Iterator<Item = (usize, Vector3<f64>, Vector3<f64>)> {
        let part = (pair.part.segment, self.on_part, self.away);
        std::iter::once(part).chain(self.on_other.map(|(segment, point)| (segment, point, -self.away)))
    }
}

impl ClearancePair {
    /// Distance of the surfaces in a posture, m; negative where the parts overlap.
    pub fn distance(&self, model: &Model, kinematics: &Kinematics) -> f64 {
        self.nearest(model, kinematics, f64::INFINITY).map_or(f64::INFINITY, |nearest| nearest.distance)
    }

    /// The closest points; `None` for a pair that is certainly farther apart than `within`, m.
    pub(super) fn nearest(&self, model: &Model, kinematics: &Kinematics, within: f64) -> Option<Nearest> {
        let p = line(model, kinematics, &self.part);
        match &self.other {
            Obstacle::Part(other) => self.nearest_of_parts(p, other, line(model, kinematics, other), within),
            Obstacle::Thing(Thing::HalfSpace { normal, offset }) => {
                let height = [0, 1].map(|end| normal.dot(&p[end]) - offset);
                let (end, height) = if height[0] <= height[1] { (0, height[0]) } else { (1, height[1]) };
                let distance = height - self.part.radius;
                let on_part = self.part.ends[end];
                Some(Nearest { distance, away: *normal, on_part, on_other: None })
            }
            Obstacle::Thing(Thing::Block { placement, half }) => {
                let inside = p.map(|end| placement.inverse_transform_point(&Point3::from(end)).coords);
                let (t, distance, away) = from_block(inside, half);
                let on_part = self.part.ends[0] + t * (self.part.ends[1] - self.part.ends[0]);
                let distance = distance - self.part.radius;
                Some(Nearest { distance, away: placement.rotation * away, on_part, on_other: None })
            }
        }
    }

    fn nearest_of_parts(
        &self,
        p: [Vector3<f64>; 2],
        other: &Capsule,
        q: [Vector3<f64>; 2],
        within: f64,
    ) -> Option<Nearest> {
        let radii = self.part.radius + other.radius;
        let (u, v) = (p[1] - p[0], q[1] - q[0]);
        // Half of the lines' lengths and the radii lie between the middles at most.
        let middles = 0.5 * (p[0] + p[1] - q[0] - q[1]).norm();
        if middles - 0.5 * (u.norm() + v.norm()) - radii > within {
            return None;
        }
        let (s, t) = closest_on_segments(p, q);
        let between = p[0] + s * u - q[0] - t * v;
        let length = between.norm();
        let away = if length > SAME_POINT { between / length } else { square_to(&u, &v) };
        Some(Nearest {
            distance: length - radii,
            away,
            on_part: self.part.ends[0] + s * (self.part.ends[1] - self.part.ends[0]),
            on_other: Some((other.segment, other.ends[0] + t * (other.ends[1] - other.ends[0]))),
        })
    }
}

/// Lines nearer to each other than this, m, meet.
const SAME_POINT: f64 = 1e-9;

/// Ends of the line of a capsule, in ground, m.
fn line(model: &Model, kinematics: &Kinematics, capsule: &Capsule) -> [Vector3<f64>; 2] {
    capsule.ends.map(|end| kinematics.station(model, capsule.segment, end))
}

/// A unit direction square to both vectors; to one of them where they are parallel.
fn square_to(u: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let long = if u.norm_squared() >= v.norm_squared() { u } else { v };
    let square = |w: Vector3<f64>| w.try_normalize(SAME_POINT);
    let beside = || square(long.cross(&Vector3::ith(long.iamin(), 1.0)));
    square(u.cross(v)).or_else(beside).unwrap_or_else(Vector3::x)
}

/// Point of a line segment that is closest to the block `|x_k| <= half_k`: its parameter, the distance, and the direction away from
/// the block. A line that enters the block has the negative distance by which it must move through the nearest face.
fn from_block(p: [Vector3<f64>; 2], half: &Vector3<f64>) -> (f64, f64, Vector3<f64>) {
    let t = closest_to_block(p, half);
    let x = p[0] + t * (p[1] - p[0]);
    let out = x - x.zip_map(half, |x, h| x.clamp(-h, h));
    let length = out.norm();
    if length > SAME_POINT {
        return (t, length, out / length);
    }
    let mut best = (t, f64::NEG_INFINITY, Vector3::y());
    for k in 0..3 {
        for sign in [-1.0, 1.0] {
            let [a, b] = [0, 1].map(|end| sign * p[end][k] - half[k]);
            let (t, depth) = if a <= b { (0.0, a) } else { (1.0, b) };
            if depth > best.1 {
                best = (t, depth, sign * Vector3::ith(k, 1.0));
            }
        }
    }
    best
}

impl Clearance {
    /// Adds the lack of distance of each pair to `out`: negative, 0 where the distance suffices, m.
    pub(super) fn residual(&self, model: &Model, body: &JointTorques, out: &mut Vec<f64>) {
        out.extend(self.pairs.iter().map(|pair| {
            let nearest = pair.nearest(model, body.kinematics(), self.margin);
            nearest.map_or(0.0, |nearest| (nearest.distance - self.margin).min(0.0))
        }));
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let n = model.rates().len();
        for pair in &self.pairs {
            // The pair's row, then the three that it is made of, which are removed again.
            let (row, jacobian) = append(level, model, 4).split_at_mut(n);
            let nearest = pair.nearest(model, body.kinematics(), self.activation);
            let mut lower = f64::NEG_INFINITY;
            if let Some(nearest) = nearest.filter(|nearest| nearest.distance < self.activation) {
                for (segment, point, along) in nearest.stations(pair) {
                    body.kinematics().point_jacobian(model, segment, point, jacobian);
                    add_along(row, &along, jacobian);
                }
                lower = self.margin - nearest.distance;
            }
            level.matrix.truncate(level.matrix.len() - 3 * n);
            level.lower.push(lower);
            level.upper.push(f64::INFINITY);
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.some(TaskPart::Pair, !self.pairs.is_empty())?;
        if !(0.0..=LARGEST).contains(&self.margin) {
            return check.refuse(TaskPart::Margin, self.margin, "between 0 and 1e9");
        }
        if !(self.margin < self.activation && self.activation <= LARGEST) {
            return check.refuse(TaskPart::Activation, self.activation, "above the margin and at most 1e9");
        }
        let capsule = |capsule: &Capsule| {
            check.segment(capsule.segment)?;
            capsule.ends.iter().try_for_each(|end| check.vector(TaskPart::CapsuleEnd, end))?;
            let fits = (0.0..=LARGEST).contains(&capsule.radius);
            if fits { Ok(()) } else { check.refuse(TaskPart::Radius, capsule.radius, "between 0 and 1e9") }
        };
        self.pairs.iter().try_for_each(|pair| {
            capsule(&pair.part)?;
            match &pair.other {
                Obstacle::Part(other) => capsule(other),
                Obstacle::Thing(thing) => thing.check(check),
            }
        })
    }
}
