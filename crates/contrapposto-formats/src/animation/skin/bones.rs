//! Names the nodes of the skin's skeleton, and turns each with the segments of the body.
//!
//! A limb that turns about its own axis by 80 degrees would be wrung like a cloth if its skin followed either of two segments. So the
//! turn is spread over several bones, and joints that bend far have a bone that turns half as far.

use contrapposto::model::{Model, Placement};
use nalgebra::{UnitQuaternion, Vector3};

/// A node of the skeleton, at the centre of a segment's joint.
#[derive(Clone, Debug)]
pub struct Bone {
    /// Name as in VRM's humanoid where that has one.
    pub name: String,
    /// Index of the parent among the nodes.
    pub parent: Option<usize>,
    /// The segment that it follows.
    pub segment: usize,
    /// Segment from which the turn counts; the same one for a bone that turns as its segment does.
    pub from: usize,
    /// The axis of twist in the T-pose; zero for a joint of which only the whole turn counts.
    pub axis: Vector3<f64>,
    /// Shares of swing and twist.
    pub shares: [f64; 2],
}

/// A row of the table: name, parent, segment from which the turn counts, segment, shares of swing and twist, whether the axis of twist counts.
type Row = (&'static str, &'static str, &'static str, &'static str, [f64; 2], bool);

const WHOLE: [f64; 2] = [1.0, 1.0];
const HALF: [f64; 2] = [0.5, 0.0];
const THIRD: f64 = 1.0 / 3.0;

/// Bones of the trunk, in the order of the baked file.
#[rustfmt::skip]
const TRUNK_BONES: [Row; 5] = [
    ("hips", "", "pelvis", "pelvis", WHOLE, false),
    ("spine", "hips", "abdomen", "abdomen", WHOLE, false),
    ("chest", "spine", "torso", "torso", WHOLE, false),
    ("neck", "chest", "torso", "head", HALF, false),
    ("head", "neck", "head", "head", WHOLE, false),
];
/// Bones of a side, in the order of the baked file. `*` stands for a name of this side.
#[rustfmt::skip]
const SIDE_BONES: [Row; 18] = [
    ("*Shoulder", "chest", "torso", "torso", WHOLE, false),
    ("*ShoulderHalf", "*Shoulder", "torso", "humerus*", HALF, true),
    ("*UpperArmTwist0", "*Shoulder", "torso", "humerus*", [1.0, 0.0], true),
    ("*UpperArmTwist1", "*Shoulder", "torso", "humerus*", [1.0, 0.5], true),
    ("*UpperArm", "*Shoulder", "humerus*", "humerus*", WHOLE, false),
    ("*ElbowHalf", "*UpperArm", "humerus*", "ulna*", HALF, false),
    ("*LowerArm", "*UpperArm", "ulna*", "ulna*", WHOLE, false),
    ("*LowerArmTwist1", "*LowerArm", "ulna*", "radius*", [1.0, THIRD], true),
    ("*LowerArmTwist2", "*LowerArm", "ulna*", "radius*", [1.0, 2.0 * THIRD], true),
    ("*LowerArmTwist3", "*LowerArm", "radius*", "radius*", WHOLE, false),
    ("*Hand", "*LowerArmTwist3", "hand*", "hand*", WHOLE, false),
    ("*HipHalf", "hips", "pelvis", "femur*", HALF, true),
    ("*UpperLegTwist0", "hips", "pelvis", "femur*", [1.0, 0.0], true),
    ("*UpperLeg", "hips", "femur*", "femur*", WHOLE, false),
    ("*KneeHalf", "*UpperLeg", "femur*", "tibia*", HALF, false),
    ("*LowerLeg", "*UpperLeg", "tibia*", "tibia*", WHOLE, false),
    ("*FootRoll", "*Foot", "calcn*", "calcn*", WHOLE, false),
    ("*Toes", "*FootRoll", "toes*", "toes*", WHOLE, false),
];
/// Node of a side that moves no skin itself.
const ANKLE: Row = ("*Foot", "*LowerLeg", "talus*", "talus*", WHOLE, false);

/// All nodes; first the bones of the baked file, in its order. `rest` is the T-pose. `None` where a segment is missing.
pub(super) fn nodes(model: &Model, rest: &[Placement]) -> Option<Vec<Bone>> {
    let sides = [("right", "_r"), ("left", "_l")];
    let of_side = |side: (&'static str, &'static str)| SIDE_BONES.into_iter().map(move |row| (row, side));
    let trunk = TRUNK_BONES.into_iter().map(|row| (row, sides[0]));
    let rows: Vec<_> =
        trunk.chain(sides.into_iter().flat_map(of_side)).chain(sides.into_iter().map(|side| (ANKLE, side))).collect();
    let names: Vec<String> = rows.iter().map(|(row, side)| row.0.replace('*', side.0)).collect();
    let node = |(i, ((_, parent, from, to, shares, twists), side)): (usize, &(Row, (&str, &str)))| {
        let segment = |name: &str| model.segment(&name.replace('*', side.1));
        let [from, to] = [segment(from)?, segment(to)?];
        let parent = parent.replace('*', side.0);
        Some(Bone {
            name: names[i].clone(),
            parent: names.iter().position(|name| *name == parent),
            segment: to,
            from,
            axis: if *twists { rest[to].rotation * Vector3::y() } else { Vector3::zeros() },
            shares: *shares,
        })
    };
    rows.iter().enumerate().map(node).collect()
}

impl Bone {
    /// The turn of the bone from the T-pose, by the turns of all segments from it.
    pub(super) fn turn(&self, turns: &[UnitQuaternion<f64>]) -> UnitQuaternion<f64> {
        let (from, to) = (turns[self.from], turns[self.segment]);
        if self.from == self.segment {
            return to;
        }
        let [swing, twist] = swing_and_twist(from.inverse() * to, self.axis);
        from * swing.powf(self.shares[0]) * twist.powf(self.shares[1])
    }
}

/// A turn as a twist about an axis, followed by a swing about an axis square to it; each by the shorter way.
fn swing_and_twist(turn: UnitQuaternion<f64>, axis: Vector3<f64>) -> [UnitQuaternion<f64>; 2] {
    let q = if turn.w < 0.0 { -turn.into_inner() } else { turn.into_inner() };
    let along = axis.dot(&q.vector());
    let twist = nalgebra::Quaternion::from_parts(q.w, along * axis);
    let twist = UnitQuaternion::try_new(twist, 1e-12).unwrap_or_else(UnitQuaternion::identity);
    [UnitQuaternion::new_normalize(q) * twist.inverse(), twist]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swing_after_twist_is_the_turn_and_a_pure_twist_has_no_swing() {
        let axis = Vector3::new(0.6, 0.0, 0.8);
        for turn in [[0.3, -1.0, 0.4], [2.0, 1.5, -1.0], [0.0, 0.0, 0.0]].map(Vector3::from) {
            let turn = UnitQuaternion::from_scaled_axis(turn);
            let [swing, twist] = swing_and_twist(turn, axis);
            assert!((swing * twist).angle_to(&turn) < 1e-12);
            assert!(swing.scaled_axis().dot(&axis).abs() < 1e-12 && twist.scaled_axis().cross(&axis).norm() < 1e-12);
            let [swing, twist] = swing_and_twist(UnitQuaternion::from_scaled_axis(1.4 * axis), axis);
            assert!(swing.angle() < 1e-7 && (twist.angle() - 1.4).abs() < 1e-12);
        }
    }
}
