//! Fits the built-in adult to a rig: its axes, unit and bones, and how each joint of the rig lies to a segment at rest.

use contrapposto::model::{Adult, AdultError, Model, Placement, adult};
use nalgebra::{UnitQuaternion, Vector3};

use super::Rig;
use super::axes::{NO_LENGTH, RigAxes};
use super::names::Assignment;
use super::size::{RigUnit, Sizing, bones, leg, sized, unit};

/// Horizontal share of the line from ankle to toes below which a foot has no direction (assumed).
const LEVEL_FOOT: f64 = 0.2;
/// Largest angle between shank and vertical at rest, rad (12 deg), with feet that are flat on the ground (assumed: rigs in A-pose; skeletons of CMU captures have their
/// legs 20 deg apart and feet square to them).
const FEET_FLAT: f64 = 12.0 * std::f64::consts::PI / 180.0;
/// Largest angle by which the feet of a rig at rest point outwards or inwards, rad (60 deg, assumed).
const MOST_TOE_OUT: f64 = std::f64::consts::FRAC_PI_3;

/// The reason for which a rig cannot move the adult.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// Neither rest pose nor first frame stands.
    #[error(
        "the rig does not stand upright, neither at rest (all angles 0) nor in its first frame: legs and trunk must lie within 45 deg of one \
         axis of the file, so that it is known how its bones lie to the adult's; begin the motion with a frame in T-pose"
    )]
    Standing,
    /// A bone has no length.
    #[error("the rig's {0} has no length between its joints")]
    Bone(&'static str),
    /// The body is no adult's.
    #[error("the rig's bones: {0}; --units says their unit")]
    Adult(AdultError),
}

/// A segment that a joint of the rig turns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Turned {
    /// Index of the segment.
    pub(super) segment: usize,
    /// Index of the rig's joint.
    pub(super) joint: usize,
    /// From the segment's axes to the joint's.
    pub(super) to_joint: UnitQuaternion<f64>,
}

/// The adult that fits a rig.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Size of the adult.
    pub size: Adult,
    /// The adult.
    pub model: Model,
    /// Up, left and ahead in the file.
    pub axes: RigAxes,
    /// Unit of the file.
    pub unit: RigUnit,
    /// Length of the file's unit, m.
    pub metres: f64,
    /// The first frame is the pose in which the rig stands, not its rest.
    pub from_first_frame: bool,
    /// The feet point ahead where left is left.
    pub feet_point_ahead: bool,
    /// Segments with a joint of the rig, parents before children.
    pub(super) turned: Vec<Turned>,
}

impl Fitted {
    /// Fits an adult. `metres`: the unit of the rig's lengths, if it is known.
    ///
    /// # Errors
    /// [`RigError`] when the rig stands nowhere, or its bones are no adult's.
    pub fn new(rig: &Rig, assignment: &Assignment, sizing: &Sizing, metres: Option<f64>) -> Result<Self, RigError> {
        let mut placed = vec![];
        rig.place(None, &mut placed);
        let mut axes = RigAxes::of(assignment, &placed);
        let from_first_frame = axes.is_none();
        if from_first_frame {
            rig.place(Some(0), &mut placed);
            axes = RigAxes::of(assignment, &placed);
        }
        let axes = axes.ok_or(RigError::Standing)?;
        let bones = bones(assignment, &placed);
        let leg_length = bones[0] + bones[1];
        let named = ["thigh", "shank", "upper arm", "forearm"].into_iter().zip(bones);
        if let Some((name, _)) = named.into_iter().find(|(_, length)| *length <= NO_LENGTH * leg_length) {
            return Err(RigError::Bone(name));
        }
        let (unit, metres) = unit(leg_length, sizing, metres).map_err(RigError::Adult)?;
        let size = match sizing {
            Sizing::ToRig(sex) => sized(*sex, bones.map(|length| metres * length)).map_err(RigError::Adult)?,
            Sizing::Given(size) => size.clone(),
        };
        let model = adult(&size).map_err(RigError::Adult)?;
        let pose = Pose { rig, assignment, placed: &placed, to_ground: axes.to_ground() };
        let turned = pose.turned(&model);
        let feet_point_ahead = pose.feet_point_ahead();
        Ok(Self { size, model, axes, unit, metres, from_first_frame, feet_point_ahead, turned })
    }

    /// Length of the adult's leg over that of the rig's, in m for each unit of the file.
    pub(super) fn scale(&self, rig: &Rig, assignment: &Assignment) -> f64 {
        let mut placed = vec![];
        rig.place(None, &mut placed);
        let [thigh, shank, ..] = bones(assignment, &placed);
        leg(&self.model) / (thigh + shank)
    }
}

/// A rig that stands.
struct Pose<'a> {
    rig: &'a Rig,
    assignment: &'a Assignment,
    placed: &'a [Placement],
    to_ground: UnitQuaternion<f64>,
}

impl Pose<'_> {
    fn turned(&self, model: &Model) -> Vec<Turned> {
        let mut rotations = vec![UnitQuaternion::identity(); model.segments().len()];
        let mut turned = vec![];
        for (index, segment) in model.segments().iter().enumerate() {
            let held = segment.parent.map_or_else(UnitQuaternion::identity, |parent| rotations[parent]);
            rotations[index] = self.rotation(&segment.name, held);
            // The talus has no points of its own; it lies as the foot does.
            let (stem, side) = split(&segment.name);
            let joint = self.assignment.joint(&segment.name);
            let joint = joint.or_else(|| (stem == "talus").then(|| self.assignment.joint(&format!("calcn{side}")))?);
            if let Some(joint) = joint {
                let at_rest = self.placed[joint].rotation;
                let to_joint = at_rest.inverse() * self.to_ground.inverse() * rotations[index];
                turned.push(Turned { segment: index, joint, to_joint });
            }
        }
        turned
    }

    /// The rotation of a segment of the adult in the pose, in ground: its bone along the rig's, turned no more than that takes.
    fn rotation(&self, name: &str, held: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let (stem, side) = split(name);
        let along = |to: &str| self.direction(name, &format!("{to}{side}"));
        let direction = match stem {
            "humerus" => along("ulna"),
            "ulna" => along("hand"),
            "hand" => self.fingers(name),
            "femur" => along("tibia"),
            "tibia" => along("talus").or_else(|| along("calcn")),
            "talus" => return self.foot(&format!("calcn{side}"), held),
            "radius" | "calcn" | "toes" => return held,
            _ => return UnitQuaternion::identity(),
        };
        let Some(direction) = direction else { return held };
        let bone = held * -Vector3::y();
        // A bone that points the other way was lifted sideways.
        let swing = UnitQuaternion::rotation_between(&bone, &direction)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        swing * held
    }

    /// From the joint of a segment to that of another one, ground, any length above 0.
    fn direction(&self, from: &str, to: &str) -> Option<Vector3<f64>> {
        let [from, to] = [from, to].map(|name| self.assignment.joint(name));
        let [from, to] = [from?, to?].map(|joint| self.placed[joint].translation.vector);
        self.ground_direction(to - from)
    }

    fn ground_direction(&self, along: Vector3<f64>) -> Option<Vector3<f64>> {
        (self.to_ground * along).try_normalize(f64::MIN_POSITIVE)
    }

    /// The mean direction of the joints and ends that hang on a joint, thumbs left out.
    fn below(&self, joint: usize) -> Option<Vector3<f64>> {
        let own = &self.placed[joint];
        let joints =
            self.rig.joints.iter().enumerate().filter(|(index, _)| *index != joint && self.rig.carries(joint, *index));
        let joints = joints.filter(|(_, other)| !other.name.to_ascii_lowercase().contains("thumb"));
        let places = joints.map(|(index, _)| self.placed[index].translation.vector);
        let ends = self.rig.ends.iter().filter(|(of, _)| *of == joint);
        let ends = ends.map(|(_, at)| own.transform_point(&(*at).into()).coords);
        let sum: Vector3<f64> = places.chain(ends).map(|place| place - own.translation.vector).sum();
        self.ground_direction(sum)
    }

    fn fingers(&self, hand: &str) -> Option<Vector3<f64>> {
        self.below(self.assignment.joint(hand)?)
    }

    /// A foot that stands flat, or square to the shank of legs that are far apart, and points where its toes are.
    fn foot(&self, foot: &str, shank: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let flat = if shank.angle() > FEET_FLAT { shank } else { UnitQuaternion::identity() };
        let ahead = self.assignment.joint(foot).and_then(|joint| self.below(joint)).map(|ahead| flat.inverse() * ahead);
        let Some(ahead) = ahead.filter(|v| libm::hypot(v.x, v.z) > LEVEL_FOOT) else { return flat };
        let yaw = libm::atan2(-ahead.z, ahead.x);
        let yaw = if yaw.abs() <= MOST_TOE_OUT { yaw } else { 0.0 };
        flat * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw)
    }

    /// Whether the feet, where they have a direction, point ahead.
    fn feet_point_ahead(&self) -> bool {
        let feet = ["calcn_r", "calcn_l"].into_iter().filter_map(|foot| self.below(self.assignment.joint(foot)?));
        feet.map(|v| v.x).sum::<f64>() >= 0.0
    }
}

/// `("hand", "_r")` of `hand_r`.
fn split(name: &str) -> (&str, &str) {
    let stem = name.trim_end_matches("_r").trim_end_matches("_l");
    (stem, &name[stem.len()..])
}
