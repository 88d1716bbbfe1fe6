//! Makes of each frame of a rig the points that the adult's segments should have: the goals of marker tracking.
//!
//! The points belong to a chain of the adult's own lengths whose segments turn as the rig's joints do from the rest pose on, and whose hip centre lies where
//! the rig's is; its shoulder joints rise with the arms as the adult's do. So motion of collar bones and stretched bones, which the adult has not, moves
//! nothing else.

use std::f64::consts::TAU;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Placement};
use contrapposto::tasks::Height;
use contrapposto::tracking::{Goals, MarkerGoal};
use nalgebra::{UnitQuaternion, Vector3};

use super::Rig;
use super::fit::{Fitted, Turned};
use super::names::Assignment;

/// Distance of the points that show how a segment is turned, m: an error of 1 deg there counts as 1.7 mm of a joint's place (assumed).
const ARM: f64 = 0.1;
/// Weight of the turn of upper arm and thigh about their own axis where elbow and knee of the rig are no hinges: the bent forearm and shank tell
/// it better (assumed).
const TWIST_WEIGHT: f64 = 0.2;
/// Distance from the start, m, beyond which a motion is moved to the origin: the range of the adult's root.
const FAR: f64 = 5.0;
/// Direction that the body faces, rad from that of its rest, beyond which a motion is turned: the range of the adult's root, 90 deg, less 10 deg for
/// turns that its other angles add (assumed).
const ASIDE: f64 = 80.0 * std::f64::consts::PI / 180.0;
/// Turn between the first two frames that is a jump, rad (20 deg), and the greatest one between the next two that is none (5 deg). Assumed.
const JUMP: (f64, f64) = (20.0 * std::f64::consts::PI / 180.0, 5.0 * std::f64::consts::PI / 180.0);

/// The share of a segment's orientation that its points show.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    /// All of it.
    Turn,
    /// That of its bone, and less of its own axis.
    MostlyBone,
    /// None: the next segment's points show where its bone lies.
    Nothing,
}

/// Points of the adult, and where they should be in each frame.
pub struct Targets<'a> {
    rig: &'a Rig,
    fitted: &'a Fitted,
    /// Numbers of the frames that are asked for.
    frames: &'a [usize],
    hips: [usize; 2],
    scale: f64,
    /// Ground place that becomes the origin, m.
    origin: Vector3<f64>,
    /// Turn of the whole motion about the vertical.
    facing: UnitQuaternion<f64>,
    shown: Vec<Shown>,
    /// The rhythm of the shoulders: their joints rise with the arms.
    shoulders: Vec<(usize, Height)>,
    /// Points and their weights.
    pub goals: Goals,
}

impl<'a> Targets<'a> {
    /// The points of a fitted adult. `frames`: those of the rig that are asked for; by them the motion is turned and moved.
    pub fn new(rig: &'a Rig, assignment: &Assignment, fitted: &'a Fitted, frames: &'a [usize]) -> Self {
        let model = &fitted.model;
        let has = |stem: &str, side: &str| assignment.joint(&format!("{stem}{side}")).is_some();
        let mut shown = vec![];
        let mut goals = Goals::default();
        for turned in &fitted.turned {
            let name = &model.segments()[turned.segment].name;
            let side = if name.ends_with("_r") { "_r" } else { "_l" };
            // Elbows and knees are hinges in rigs that have the joints of the adult.
            let (arm, leg) = (has("radius", side), has("talus", side));
            let part = match name.trim_end_matches(side) {
                "humerus" if !arm => Shown::MostlyBone,
                "femur" if !leg => Shown::MostlyBone,
                "ulna" if !arm => Shown::Nothing,
                "tibia" | "talus" if !leg => Shown::Nothing,
                _ => Shown::Turn,
            };
            shown.push(part);
            for (point, weight) in points(part) {
                goals.markers.push(MarkerGoal { segment: turned.segment, point, weight });
            }
        }
        goals.limits = hinge_limits(model);
        let hips = ["femur_r", "femur_l"].map(|name| assignment.needed(name));
        let scale = if fitted.from_first_frame { fitted.metres } else { fitted.scale(rig, assignment) };
        let (origin, facing) = (Vector3::zeros(), UnitQuaternion::identity());
        let shoulders = Height::shoulder_rhythm(model);
        let mut targets = Self { rig, fitted, frames, hips, scale, origin, facing, shown, shoulders, goals };
        targets.facing = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -targets.aside());
        targets.origin = targets.far_origin();
        targets
    }

    /// Whether the motion was moved to the origin because it goes farther than the root's range.
    pub fn is_moved(&self) -> bool {
        self.origin != Vector3::zeros()
    }

    /// Angle by which the motion was turned about the vertical, rad, left positive.
    pub fn turned(&self) -> f64 {
        self.facing.scaled_axis().y
    }

    /// Places of the points in a frame, ground, m, in the order of the goals.
    pub fn places(&self, frame: usize) -> Vec<Option<Vector3<f64>>> {
        let chain = self.chain(frame);
        let of = |marker: &MarkerGoal| Some(chain[marker.segment].transform_point(&marker.point.into()).coords);
        self.goals.markers.iter().map(of).collect()
    }

    /// Angle (rad) between each segment whose turn is a goal and its joint of the rig in a frame, by segment.
    pub fn misfits(&self, frame: usize, body: &Kinematics) -> Vec<(usize, f64)> {
        let chain = self.chain(frame);
        let turned = self.fitted.turned.iter().zip(&self.shown).filter(|(_, shown)| **shown == Shown::Turn);
        let angle = |s: usize| body.placement(&self.fitted.model, s).rotation.angle_to(&chain[s].rotation);
        turned.map(|(turned, _)| (turned.segment, angle(turned.segment))).collect()
    }

    /// Whether the first frame that is asked for is another pose than the motion that follows: one for calibration.
    pub fn first_frame_jumps(&self) -> bool {
        let [first, second, third, ..] = *self.frames else { return false };
        let frames = [first, second, third].map(|frame| self.chain(frame));
        let most = |a: &[Placement], b: &[Placement]| {
            a.iter().zip(b).map(|(a, b)| a.rotation.angle_to(&b.rotation)).fold(0.0, f64::max)
        };
        most(&frames[0], &frames[1]) > JUMP.0 && most(&frames[1], &frames[2]) < JUMP.1
    }

    /// The chain of the adult's lengths, ground.
    fn chain(&self, frame: usize) -> Vec<Placement> {
        let model = &self.fitted.model;
        let mut placed = vec![];
        self.rig.place(Some(frame), &mut placed);
        let to_ground = self.facing * self.fitted.axes.to_ground();
        let turn = |turned: &Turned| to_ground * placed[turned.joint].rotation * turned.to_joint;
        let mut chain: Vec<Placement> = Vec::with_capacity(model.segments().len());
        for (index, segment) in model.segments().iter().enumerate() {
            let held = segment.parent.map_or_else(Placement::identity, |parent| chain[parent]);
            let own = self.fitted.turned.iter().find(|turned| turned.segment == index);
            let rotation = own.map_or(held.rotation, turn);
            let mut joint = segment.in_parent.translation.vector;
            if let Some((_, shoulder)) = self.shoulders.iter().find(|(_, shoulder)| shoulder.segment == index) {
                let along = shoulder.along.into_inner();
                let cosine = (held.rotation * along).dot(&(rotation * along));
                joint += along * (shoulder.of_origin(cosine) - along.dot(&joint));
            }
            let at = match segment.parent {
                Some(_) => held.transform_point(&joint.into()).coords,
                None => self.hips(&placed) - self.origin,
            };
            chain.push(Placement::from_parts(at.into(), rotation));
        }
        chain
    }

    /// The middle between the hip joints, ground, m.
    fn hips(&self, placed: &[Placement]) -> Vector3<f64> {
        let [right, left] = self.hips.map(|joint| placed[joint].translation.vector);
        self.facing * self.fitted.axes.to_ground() * ((right + left) * (self.scale / 2.0))
    }

    /// The middle direction that the body faces, rad, where it leaves the range of the root; else 0.
    fn aside(&self) -> f64 {
        let Some(pelvis) = self.fitted.turned.iter().find(|turned| turned.segment == 0) else { return 0.0 };
        let (mut placed, mut before, mut low, mut high) = (vec![], 0.0, f64::INFINITY, f64::NEG_INFINITY);
        for &frame in self.frames {
            self.rig.place(Some(frame), &mut placed);
            let ahead = self.fitted.axes.to_ground() * placed[pelvis.joint].rotation * pelvis.to_joint * Vector3::x();
            let yaw = libm::atan2(-ahead.z, ahead.x);
            before = yaw - TAU * ((yaw - before) / TAU).round();
            (low, high) = (before.min(low), before.max(high));
        }
        if high.max(-low) > ASIDE { (low + high) / 2.0 } else { 0.0 }
    }

    /// The level place of the first frame where the motion leaves the range of the root.
    fn far_origin(&self) -> Vector3<f64> {
        let (mut placed, mut first, mut far) = (vec![], None, false);
        for &frame in self.frames {
            self.rig.place(Some(frame), &mut placed);
            let hips = self.hips(&placed);
            first.get_or_insert(Vector3::new(hips.x, 0.0, hips.z));
            far |= hips.x.abs().max(hips.z.abs()) > FAR;
        }
        first.filter(|_| far).unwrap_or_else(Vector3::zeros)
    }
}

/// Points of a segment that show its place and turn, and their weights.
fn points(shown: Shown) -> Vec<(Vector3<f64>, f64)> {
    let twist = match shown {
        Shown::Nothing => return vec![(Vector3::zeros(), 1.0)],
        Shown::MostlyBone => TWIST_WEIGHT,
        Shown::Turn => 1.0,
    };
    let arm = |axis: Vector3<f64>, weight: f64| (ARM * axis, weight);
    vec![(Vector3::zeros(), 1.0), arm(Vector3::x(), twist), arm(Vector3::y(), 1.0), arm(Vector3::z(), twist)]
}

/// Ranges of the coordinates of joints with one or two of them. Those with three can have one posture by several angles.
fn hinge_limits(model: &Model) -> Vec<(usize, (f64, f64))> {
    let joints = model.segments().iter().filter(|segment| segment.coordinates.len() <= 2);
    joints.flat_map(|segment| segment.coordinates.clone()).map(|c| (c, model.coordinates()[c].range)).collect()
}
