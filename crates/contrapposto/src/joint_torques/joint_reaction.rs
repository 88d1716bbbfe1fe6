//! Computes the force and moment that every joint transmits: those of the bones on each other, with muscles pulling.
//!
//! The part of the body beyond a joint is a free body. On it act its weight, loads (contact forces and those of inertia among them) and the
//! pulls of muscles and ligaments on the corners of their paths, at `x_k` with forces `f_k` and couples `c_k`. The rest of the body acts
//! through the joint alone:
//!
//! ```text
//! F = - sum_k f_k                    M = - sum_k ((x_k - c) x f_k + c_k)               c the joint's centre
//! ```
//!
//! `F` and `M` act on the segment beyond the joint; the segment before it feels `-F` and `-M`. The centre is the origin of the joint's frame in
//! the segment beyond. No moment arm is in these sums. So the part of `M` along a free axis of the joint is the torque that no path
//! gives there: of passive curves, limits, bushings and motors, which count as parts of the joint, of muscles without paths, and that which the muscles
//! lack. The same holds for the torque of a path's point that moves in its segment, since the bone leads that point.
//!
//! Compression is the part of `F` along a bone, positive where the joint is pressed together. The bone is that beyond the joint,
//! from its centre to the joints which that segment carries (their mean, by the masses beyond them), or to its centre of mass where it carries
//! none. Where that bone is less than half as long as the one before the joint, from the joint of that segment, the axis is that of the latter: at the
//! ankle the tibia's, not that of the talus.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::muscle::{Musculature, PathGeometry};
use crate::statics::{FixedIn, Load, LoadError, LoadKind};

/// The bone beyond the joint gives the axis of compression from this share of the length of the bone before it on (assumed).
const LEAST_SHARE_OF_BONE_BEFORE: f64 = 0.5;
/// Least length of a bone that has a direction, m (assumed).
const LEAST_BONE: f64 = 1e-3;

/// Force and moment that a joint transmits to the segment beyond it, in ground axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointReaction {
    /// Force on the segment beyond the joint, N.
    pub force: Vector3<f64>,
    /// Moment on it about the joint's centre, N m.
    pub moment: Vector3<f64>,
    /// The joint's centre in ground, m.
    pub center: Vector3<f64>,
    /// Part of the force along a bone; `None` between bones without a length.
    pub compression: Option<Compression>,
}

/// Force with which a joint is pressed together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compression {
    /// N; negative where the joint is pulled apart.
    pub force: f64,
    /// Index of the segment that is the bone.
    pub along: usize,
}

/// Muscles and ligaments that pull along their paths.
#[derive(Clone, Copy, Debug)]
pub struct PathForces<'a> {
    /// The muscles, with ligaments and paths.
    pub muscles: &'a Musculature,
    /// The paths in the posture, by any rule.
    pub geometry: &'a PathGeometry,
    /// Tension of every muscle, N.
    pub tensions: &'a [f64],
}

/// The reaction of every joint. Depends on posture, loads and tensions; filled by [`JointReactions::update`].
#[derive(Clone, Debug)]
pub struct JointReactions {
    /// By segment beyond the joint: first forces and moments about ground's origin.
    reactions: Vec<JointReaction>,
    /// By segment: mass of the segment and of all beyond it, kg.
    masses: Vec<f64>,
    /// By segment beyond the joint: whether a muscle's path crosses it.
    crossed: Vec<bool>,
    /// By segment: end of its bone in ground, m, as a sum over the joints which it carries, and the sum of their weights.
    ends: Vec<(Vector3<f64>, f64)>,
}

impl JointReactions {
    /// Space for `model` and muscles.
    pub fn new(model: &Model, muscles: &Musculature) -> Self {
        let count = model.segments.len();
        let mut masses: Vec<f64> = model.segments.iter().map(|segment| segment.mass).collect();
        for (s, segment) in model.segments.iter().enumerate().rev() {
            let beyond = masses[s];
            segment.parent.iter().for_each(|&parent| masses[parent] += beyond);
        }
        Self {
            reactions: vec![JointReaction::default(); count],
            masses,
            crossed: (0..count).map(|joint| crosses(model, muscles, joint)).collect(),
            ends: vec![(Vector3::zeros(), 0.0); count],
        }
    }

    /// Computes the reactions in the posture of `kinematics`, under gravity, `loads` and tensions. Does not allocate.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the model; the reactions are then those of the call before.
    ///
    /// # Panics
    /// Unless there is a tension for every muscle.
    pub fn update(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        loads: &[Load],
        paths: PathForces<'_>,
    ) -> Result<(), LoadError> {
        loads.iter().try_for_each(|load| load.check(model))?;
        for (s, (segment, reaction)) in model.segments.iter().zip(&mut self.reactions).enumerate() {
            let center = kinematics.station(model, s, segment.in_segment.translation.vector);
            *reaction = JointReaction { center, ..JointReaction::default() };
            let weight = segment.mass * model.gravity;
            reaction.press(&kinematics.station(model, s, segment.center_of_mass), &weight);
        }
        self.load(model, kinematics, loads);
        self.pull(paths);
        // Parents stand before children: what acts beyond a joint is complete when its turn comes.
        for (s, segment) in model.segments.iter().enumerate().rev() {
            let JointReaction { force, moment, center, .. } = self.reactions[s];
            if let Some(parent) = segment.parent {
                self.reactions[parent].force += force;
                self.reactions[parent].moment += moment;
            }
            self.reactions[s].force = -force;
            self.reactions[s].moment = center.cross(&force) - moment;
        }
        self.compress(model, kinematics);
        Ok(())
    }

    /// Adds the loads to the segments on which they act.
    fn load(&mut self, model: &Model, kinematics: &Kinematics, loads: &[Load]) {
        for load in loads {
            let reaction = &mut self.reactions[load.segment];
            let place = kinematics.station(model, load.segment, load.point);
            let in_ground = |v: Vector3<f64>, fixed| match fixed {
                FixedIn::World => v,
                FixedIn::Segment => kinematics.direction(model, load.segment, v),
            };
            match load.kind {
                LoadKind::Weight(mass) => reaction.press(&place, &(mass * model.gravity)),
                LoadKind::Force(force, fixed) => reaction.press(&place, &in_ground(force, fixed)),
                LoadKind::Couple(couple, fixed) => reaction.moment += in_ground(couple, fixed),
            }
        }
    }

    /// Adds the pulls of muscles and ligaments to the segments on which they act.
    fn pull(&mut self, PathForces { muscles, geometry, tensions }: PathForces<'_>) {
        assert_eq!(tensions.len(), muscles.muscles.len(), "one tension a muscle");
        let of_muscles = muscles.muscles.iter().zip(tensions).map(|(muscle, tension)| (muscle.spec().path, *tension));
        let of_ligaments = muscles.ligaments.iter().map(|ligament| {
            let (tension, _) = ligament.law.tension_and_slope(geometry.lengths()[ligament.path]);
            (ligament.path, tension)
        });
        for (path, tension) in of_muscles.chain(of_ligaments).filter(|(_, tension)| *tension != 0.0) {
            for pull in geometry.pulls(path) {
                if let Some(segment) = pull.segment {
                    self.reactions[segment].press(&pull.place, &(tension * pull.force));
                }
            }
        }
    }

    /// Finds the axis of the bone of every joint, and the part of the force along it.
    fn compress(&mut self, model: &Model, kinematics: &Kinematics) {
        self.ends.fill((Vector3::zeros(), 0.0));
        for (s, segment) in model.segments.iter().enumerate() {
            if let Some(parent) = segment.parent {
                self.ends[parent].0 += self.masses[s] * self.reactions[s].center;
                self.ends[parent].1 += self.masses[s];
            }
        }
        for (s, segment) in model.segments.iter().enumerate() {
            let center = self.reactions[s].center;
            let end = match self.ends[s] {
                (sum, weights) if weights > 0.0 => sum / weights,
                _ => kinematics.station(model, s, segment.center_of_mass),
            };
            let beyond = end - center;
            let before = segment.parent.map(|parent| (center - self.reactions[parent].center, parent));
            let longer = before.filter(|(before, _)| beyond.norm() < LEAST_SHARE_OF_BONE_BEFORE * before.norm());
            let (bone, along) = longer.unwrap_or((beyond, s));
            let force = bone.try_normalize(LEAST_BONE).map(|axis| axis.dot(&self.reactions[s].force));
            self.reactions[s].compression = force.map(|force| Compression { force, along });
        }
    }

    /// The reactions, by segment beyond the joint.
    pub fn all(&self) -> &[JointReaction] {
        &self.reactions
    }

    /// The segments beyond joints that muscles cross: where none does, the force of the joint is not known.
    pub fn crossed(&self) -> impl Iterator<Item = usize> {
        self.crossed.iter().enumerate().filter_map(|(segment, crossed)| crossed.then_some(segment))
    }
}

/// Whether some muscle has points on both sides of a joint.
fn crosses(model: &Model, muscles: &Musculature, joint: usize) -> bool {
    let beyond = |segment: Option<usize>| {
        std::iter::successors(segment, |&s| model.segments[s].parent).any(|segment| segment == joint)
    };
    muscles.muscles.iter().any(|muscle| {
        let points = &muscles.paths.paths[muscle.spec().path].points;
        points.iter().any(|point| beyond(point.segment)) && points.iter().any(|point| !beyond(point.segment))
    })
}

impl JointReaction {
    /// Adds a force at a place, both in ground, to sums about ground's origin.
    fn press(&mut self, place: &Vector3<f64>, force: &Vector3<f64>) {
        self.force += force;
        self.moment += place.cross(force);
    }
}
