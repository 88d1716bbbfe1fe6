//! Finds the joints of three hinges through one point, whose muscles are judged by the joint's moment, not by its coordinates.
//!
//! Torques of the three coordinates are `t = A^T m` with the moment `m` about the joint's centre and the hinges' axes as columns of
//! `A`; where two hinges align, `A` is singular and `t` loses a component of `m`. Muscles lose nothing there. Effort, relative
//! load, strength, fatigue and muscle groups of such a joint are those of the components of `m` along three orthonormal axes of
//! the distal segment: the axis of each coordinate where the joint's coordinates are zero (for models in the axes of Wu et al. 2002
//! and 2005, the distal segment's own: flexion z, adduction x, axial rotation y). The angle of each axis, by which its strength and
//! its passive torque are known, is one of swing and twist ([`SwingTwist`]); with the other two at zero it is the coordinate.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{Drive, Mobility, Model, Motion};
use crate::math::{Angles, SwingTwist};

/// Swing, rad, from which on the swing of a range is counted from a reference within it: half a turn must lie outside.
const FAR_SWING: f64 = 150.0 * std::f64::consts::PI / 180.0;
/// Share of the way to the middle of the ranges at which that reference lies.
const REFERENCE_SHARE: f64 = 0.5;
/// Sine of the angle between two axes below which they count as one.
const PARALLEL_SINE: f64 = 1e-6;
/// Distance of hinges, m, below which they count as through one point.
const ONE_POINT: f64 = 1e-9;

/// A joint of three hinges through one point. Where arrays have three entries, they are in the order of its hinges.
#[derive(Clone, Debug)]
pub struct ThreeAxisJoint {
    /// Name of the joint in the model.
    pub name: String,
    /// The distal segment.
    pub segment: usize,
    /// The coordinate of each hinge.
    pub coordinates: [usize; 3],
    /// The orthonormal axis that stands for each coordinate, in the moved frame of the last hinge.
    pub axes: [Vector3<f64>; 3],
    /// Swing and twist about these axes.
    pub swing_twist: SwingTwist,
    /// Axis of each hinge, in the frame that it moves.
    hinges: [Vector3<f64>; 3],
}

/// Rotation of a three-axis joint in a posture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// Angles about the axes, with their derivatives.
    pub angles: Angles,
    /// `A`: in column `i` the axis of hinge `i` by its components along the axes of the joint.
    pub hinges: Matrix3<f64>,
}

impl ThreeAxisJoint {
    /// Orientation of the moved frame of the last hinge in the resting frame of the first one, at the values of all coordinates.
    pub fn rotation(&self, values: &[f64]) -> UnitQuaternion<f64> {
        let [first, second, third] = [0, 1, 2].map(|i| self.turn(i, values));
        first * second * third
    }

    fn turn(&self, hinge: usize, values: &[f64]) -> UnitQuaternion<f64> {
        let (sine, cosine) = libm::sincos(0.5 * values[self.coordinates[hinge]]);
        let part = sine * self.hinges[hinge];
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(cosine, part.x, part.y, part.z))
    }

    /// Angles and hinge axes at the values of all coordinates.
    pub fn orientation(&self, values: &[f64]) -> Orientation {
        let [first, second, third] = [0, 1, 2].map(|i| self.turn(i, values));
        let angles = self.swing_twist.angles(&(first * second * third));
        let distal =
            [third.inverse() * (second.inverse() * self.hinges[0]), third.inverse() * self.hinges[1], self.hinges[2]];
        Orientation { angles, hinges: Matrix3::from_fn(|k, i| self.axes[k].dot(&distal[i])) }
    }

    /// The place of a coordinate among those of the joint.
    pub fn place(&self, coordinate: usize) -> Option<usize> {
        self.coordinates.iter().position(|own| *own == coordinate)
    }

    /// `E_m E_l - E_l E_m` of a function with the derivatives `gradient` about the axes, in row `m` and column `l`.
    pub(crate) fn turned(&self, gradient: &Vector3<f64>) -> Matrix3<f64> {
        self.swing_twist.turned(gradient)
    }
}

impl Model {
    /// Joints of three hinges through one point, each moved by a coordinate of its own that is free, uncoupled, and has no
    /// forces of a file on it. A joint may slide before it turns, except a joint to ground.
    pub fn three_axis_joints(&self) -> &[ThreeAxisJoint] {
        &self.three_axis
    }

    /// The joint whose moment stands for the torque of a coordinate, and the place of the coordinate in it.
    pub fn three_axis_joint_of(&self, coordinate: usize) -> Option<(usize, usize)> {
        self.three_axis.iter().enumerate().find_map(|(joint, of)| Some((joint, of.place(coordinate)?)))
    }

    /// The same body with a ball for each three-axis joint, whose rates are rotations about the axes that stand for its
    /// coordinates; the body itself if it has no such joint.
    pub fn by_axes(&self) -> &Self {
        self.by_axes.as_deref().unwrap_or(self)
    }

    /// Finds the three-axis joints and builds the body with balls.
    pub(super) fn find_three_axis_joints(&mut self) {
        self.three_axis.clear();
        for segment in 0..self.segments.len() {
            // Segments that are welded together end the same joint.
            let known = |joint: &ThreeAxisJoint| self.three_axis_joint_of(joint.coordinates[0]).is_some();
            if let Some(joint) = self.three_axis_joint(segment).filter(|joint| !known(joint)) {
                self.three_axis.push(joint);
            }
        }
        self.build_by_axes();
    }

    /// The three-axis joint that ends at a segment.
    fn three_axis_joint(&self, segment: usize) -> Option<ThreeAxisJoint> {
        let chain = self.hinges_at(segment)?;
        let coordinates = [0, 1, 2].map(|i| self.coordinate_of(chain[i]));
        let coordinates = [coordinates[0]?, coordinates[1]?, coordinates[2]?];
        let hinges = chain.map(|m| match self.mobilities[m].motion {
            Motion::Hinge(axis) => axis.into_inner(),
            _ => Vector3::zeros(),
        });
        // Axes where all coordinates are zero; the last hinge is fixed in the distal segment.
        let third = hinges[2];
        let second = hinges[1] - third * third.dot(&hinges[1]);
        if second.norm() < PARALLEL_SINE {
            return None;
        }
        let second = second.normalize();
        let first = second.cross(&third);
        let axes = [if first.dot(&hinges[0]) < 0.0 { -first } else { first }, second, third];
        let twist = self.long_axis(segment, chain[2], &axes);
        let mut reference = [0.0; 3];
        let ranges = coordinates.map(|c| self.coordinates[c].range);
        let far = |i: usize| i != twist && (ranges[i].0 < -FAR_SWING || ranges[i].1 > FAR_SWING);
        if (0..3).any(far) {
            reference = ranges.map(|(low, high)| REFERENCE_SHARE * 0.5 * (low.max(-FAR_SWING) + high.min(FAR_SWING)));
        }
        let swing_twist = SwingTwist::new(axes, twist, reference);
        let name = self.segments[segment].joint.clone();
        Some(ThreeAxisJoint { name, segment, coordinates, axes, swing_twist, hinges })
    }

    /// The three hinges through one point that carry a segment, if they are a joint of their own.
    fn hinges_at(&self, segment: usize) -> Option<[usize; 3]> {
        let mut at = self.segments[segment].mobility?;
        while let (Motion::Slide(_), Drive::Fixed(_)) = (self.mobilities[at].motion, &self.mobilities[at].drive) {
            at = self.mobilities[at].parent?;
        }
        let third = at;
        let second = self.mobilities[third].parent?;
        let first = self.mobilities[second].parent?;
        let joined = |m: usize| {
            let mobility = &self.mobilities[m];
            !mobility.turned && mobility.translation.norm() < ONE_POINT
        };
        // What carries mass or another joint between the hinges is a segment of its own.
        let bare = |m: usize| {
            let children = self.mobilities.iter().filter(|other| other.parent == Some(m)).count();
            self.mobilities[m].mass == 0.0 && children == 1
        };
        let through_one_point = joined(second) && joined(third) && bare(first) && bare(second);
        let others = self.coordinates_at(first, segment);
        let carried = self.slides_before(first, segment);
        (through_one_point && others == 3 + carried).then_some([first, second, third])
    }

    /// Number of coordinates by which a joint that is not at ground slides before it turns about `first`.
    fn slides_before(&self, first: usize, segment: usize) -> usize {
        let own = &self.segments[segment];
        if own.parent.is_none() {
            return 0;
        }
        let is_own = |drive: &Drive| matches!(drive, Drive::Coordinate(c) if own.coordinates.contains(c));
        let mut count = 0;
        let mut next = self.mobilities[first].parent;
        while let Some(slide) = next.map(|m| &self.mobilities[m]) {
            if !matches!(slide.motion, Motion::Slide(_)) || !is_own(&slide.drive) {
                break;
            }
            count += 1;
            next = slide.parent;
        }
        count
    }

    /// Number of coordinates of the joint, or the joints, between `first` and a segment.
    fn coordinates_at(&self, first: usize, segment: usize) -> usize {
        let own = &self.segments[segment];
        let mut count = own.coordinates.len();
        let mut next = own.parent;
        while let Some(parent) = next.map(|p| &self.segments[p]).filter(|p| p.mobility.is_some_and(|m| m >= first)) {
            count += parent.coordinates.len();
            next = parent.parent;
        }
        count
    }

    /// The coordinate of a hinge that can belong to a three-axis joint.
    fn coordinate_of(&self, mobility: usize) -> Option<usize> {
        let Mobility { motion: Motion::Hinge(_), drive: Drive::Coordinate(c), .. } = &self.mobilities[mobility] else {
            return None;
        };
        let coordinate = &self.coordinates[*c];
        let coupled = self.couplings.iter().any(|k| k.dependent == *c || k.independent == *c);
        let by_coordinate = matches!(coordinate.passive, Some(crate::passive::PassiveLaw::Sum(_)));
        (!coupled && !by_coordinate && !coordinate.locked && coordinate.rate.is_some()).then_some(*c)
    }

    /// Axis nearest to the line from the joint's centre to the centre of mass of the segment, or of all that the segment
    /// carries at the values zero if it has no mass; the last one where there is no mass.
    fn long_axis(&self, segment: usize, mobility: usize, axes: &[Vector3<f64>; 3]) -> usize {
        let own = &self.segments[segment];
        let frame = if own.mobility == Some(mobility) { own.offset.translation.vector } else { Vector3::zeros() };
        let line = if own.mass > 0.0 {
            frame + own.offset.rotation * own.center_of_mass
        } else {
            self.carried_moment(mobility)
        };
        let along = |k: usize| axes[k].dot(&line).abs();
        if line.norm() <= 0.0 { 2 } else { (0..3).fold(0, |best, k| if along(k) > along(best) { k } else { best }) }
    }

    /// First moment of all that a mobility carries, in its frame, every joint at rest.
    fn carried_moment(&self, mobility: usize) -> Vector3<f64> {
        let mut frames = vec![None; self.mobilities.len()];
        frames[mobility] = Some((Matrix3::identity(), Vector3::zeros()));
        let mut sum = Vector3::zeros();
        for (i, other) in self.mobilities.iter().enumerate() {
            if let Some((rotation, origin)) = other.parent.and_then(|p| frames[p]) {
                frames[i] = Some((rotation * other.rotation, rotation * other.translation + origin));
            }
            if let Some((rotation, origin)) = frames[i] {
                sum += rotation * other.first_moment + other.mass * origin;
            }
        }
        sum
    }

    /// Builds the body with balls from the joints found.
    pub(crate) fn build_by_axes(&mut self) {
        self.by_axes = None;
        if self.three_axis.is_empty() {
            return;
        }
        let mut model = self.clone();
        (model.mobilities, model.elements) = (vec![], vec![]);
        (model.ancestors, model.ancestor_starts) = (vec![], vec![0]);
        let mut now: Vec<usize> = vec![];
        for old in &self.mobilities {
            let joint = match &old.drive {
                Drive::Coordinate(c) if old.motion != Motion::Ball => self.three_axis_joint_of(*c),
                _ => None,
            };
            if let Some((_, 1 | 2)) = joint {
                now.push(model.mobilities.len() - 1);
                let merged = &mut model.mobilities[now[now.len() - 1]];
                (merged.mass, merged.first_moment) = (old.mass, old.first_moment);
                continue;
            }
            let parent = old.parent.map(|p| now[p]);
            model.add_ancestors(parent);
            let rate = model.elements.len();
            let mut mobility = Mobility { parent, rate, ..old.clone() };
            if let Some((joint, _)) = joint {
                let coordinates = self.three_axis[joint].coordinates;
                model.elements.extend(coordinates.map(|c| self.coordinates[c].rate));
                (mobility.motion, mobility.principal, mobility.angles) = (Motion::Ball, None, Some(joint));
            } else {
                model.elements.extend_from_slice(&self.elements[old.rate..old.rate + old.motion.rates()]);
            }
            model.mobilities.push(mobility);
            now.push(model.mobilities.len() - 1);
        }
        for segment in &mut model.segments {
            segment.mobility = segment.mobility.map(|m| now[m]);
        }
        model.set_direct();
        self.by_axes = Some(Box::new(model));
    }
}
