//! Texts of rigs as Mixamo and the CMU captures have them, made here.

use std::fmt::Write as _;

use contrapposto::model::{Adult, adult};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Names and rest pose of a program's rigs.
#[derive(Clone, Copy)]
pub(crate) struct Names {
    prefix: &'static str,
    /// Joints between hips and chest, the chest last.
    spine: &'static [&'static str],
    /// A joint without length between the hips and each thigh.
    hip_joints: bool,
    /// Angle of each leg from the vertical, deg.
    pub(crate) legs_apart: f64,
    order: &'static str,
}

pub(crate) const MIXAMO: Names = Names {
    prefix: "mixamorig:",
    spine: &["Spine", "Spine1", "Spine2"],
    hip_joints: false,
    legs_apart: 0.0,
    order: "ZXY",
};
pub(crate) const CMU: Names =
    Names { prefix: "", spine: &["LowerBack", "Spine", "Spine1"], hip_joints: true, legs_apart: 20.0, order: "ZYX" };

/// A rig in T-pose with the bones of the reference man.
pub(crate) struct RigText {
    pub(crate) names: Names,
    /// Length of the file's unit, m.
    pub(crate) metres: f64,
    /// The file's axis that points up.
    pub(crate) up: &'static str,
    pub(crate) splayed: f64,
    /// Angle by which the elbows are bent forward in the rest pose, deg.
    pub(crate) bent: f64,
}

struct Joint {
    name: String,
    parent: Option<usize>,
    /// Left, up, ahead, m.
    offset: Vector3<f64>,
    end: Option<Vector3<f64>>,
}

impl RigText {
    /// From left, up and ahead to the axes of the file.
    fn axes(&self) -> Rotation3<f64> {
        let columns = match self.up {
            "y" => [Vector3::x(), Vector3::y(), Vector3::z()],
            "z" => [Vector3::x(), Vector3::z(), -Vector3::y()],
            _ => [Vector3::x(), -Vector3::y(), -Vector3::z()],
        };
        Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns))
    }

    fn joints(&self) -> Vec<Joint> {
        let model = adult(&Adult::default()).unwrap();
        let length = |name: &str| model.segments()[model.segment(name).unwrap()].in_parent.translation.vector.norm();
        let (thigh, shank, upper_arm, forearm) =
            (length("tibia_r"), length("talus_r"), length("ulna_r"), length("hand_r"));
        let mut joints: Vec<Joint> = vec![];
        let mut add = |name: &str, parent: Option<usize>, offset: [f64; 3], end: Option<[f64; 3]>| {
            let (offset, end) = (Vector3::from(offset), end.map(Vector3::from));
            joints.push(Joint { name: format!("{}{name}", self.names.prefix), parent, offset, end });
            joints.len() - 1
        };
        let hips = add("Hips", None, [0.0; 3], None);
        let mut chest = hips;
        for name in self.names.spine {
            chest = add(name, Some(chest), [0.0, 0.12, 0.0], None);
        }
        let neck = add("Neck", Some(chest), [0.0, 0.15, 0.0], None);
        add("Head", Some(neck), [0.0, 0.1, 0.02], Some([0.0, 0.18, 0.0]));
        for (word, letter, side) in [("Left", "L", 1.0), ("Right", "R", -1.0)] {
            // Along the forearm, and ahead of it.
            let (sin, cos) = libm::sincos(self.bent.to_radians());
            let fore = |[along, ahead]: [f64; 2]| [side * (along * cos - ahead * sin), 0.0, along * sin + ahead * cos];
            let collar = add(&format!("{word}Shoulder"), Some(chest), [0.05 * side, 0.1, 0.0], None);
            let arm = add(&format!("{word}Arm"), Some(collar), [0.13 * side, 0.0, 0.0], None);
            let elbow = add(&format!("{word}ForeArm"), Some(arm), [upper_arm * side, 0.0, 0.0], None);
            let hand = add(&format!("{word}Hand"), Some(elbow), fore([forearm, 0.0]), None);
            add(&format!("{word}HandThumb1"), Some(hand), fore([0.03, 0.03]), Some(fore([0.03, 0.03])));
            add(&format!("{word}HandMiddle1"), Some(hand), fore([0.09, 0.0]), Some(fore([0.09, 0.0])));
            let mut parent = hips;
            if self.names.hip_joints {
                parent = add(&format!("{letter}HipJoint"), Some(hips), [0.0; 3], None);
            }
            // The bones lean outwards, and the foot with them.
            let (sin, cos) = libm::sincos(self.splayed.to_radians());
            let lean = |[out, up, ahead]: [f64; 3]| [side * (out * cos - up * sin), out * sin + up * cos, ahead];
            let thigh_joint = add(&format!("{word}UpLeg"), Some(parent), [0.09 * side, -0.06, 0.0], None);
            let knee = add(&format!("{word}Leg"), Some(thigh_joint), lean([0.0, -thigh, 0.0]), None);
            let foot = add(&format!("{word}Foot"), Some(knee), lean([0.0, -shank, 0.0]), None);
            add(&format!("{word}ToeBase"), Some(foot), lean([0.0, -0.05, 0.13]), Some(lean([0.0, 0.0, 0.06])));
        }
        joints
    }

    /// Two frames: the rest pose with the hip joints 1 m above the ground, and joints turned (deg) about axes given as left, up, ahead.
    pub(crate) fn text(&self, turns: &[(&str, [f64; 3], f64)]) -> String {
        let joints = self.joints();
        let axes = self.axes();
        let at = |v: Vector3<f64>| {
            let v = axes * v / self.metres;
            format!("{} {} {}", v.x, v.y, v.z)
        };
        let mut text = "HIERARCHY\n".to_owned();
        let mut order = vec![];
        self.node(&joints, 0, &at, &mut text, &mut order);
        text.push_str("MOTION\nFrames: 2\nFrame Time: 0.0333\n");
        for turned in [false, true] {
            let mut row = vec![at(Vector3::new(0.0, 1.06, 0.0))];
            for joint in order.iter().map(|&index| &joints[index]) {
                let turn = turns.iter().find(|turn| turned && joint.name == format!("{}{}", self.names.prefix, turn.0));
                let angles = turn.map_or([0.0; 3], |(_, axis, degrees)| {
                    let axis = Unit::new_normalize(axes * Vector3::from(*axis));
                    self.angles(&Rotation3::from_axis_angle(&axis, degrees.to_radians()))
                });
                row.extend(angles.iter().map(|angle| format!("{:.7}", angle.to_degrees())));
            }
            text += &(row.join(" ") + "\n");
        }
        text
    }

    fn node(
        &self,
        joints: &[Joint],
        index: usize,
        at: &impl Fn(Vector3<f64>) -> String,
        text: &mut String,
        order: &mut Vec<usize>,
    ) {
        order.push(index);
        let joint = &joints[index];
        let word = if index == 0 { "ROOT" } else { "JOINT" };
        let channels: Vec<String> = self.names.order.chars().map(|axis| format!("{axis}rotation")).collect();
        let (count, places) = if index == 0 { (6, "Xposition Yposition Zposition ") } else { (3, "") };
        let offset = at(joint.offset);
        let _ = write!(
            text,
            "{word} {}\n{{\nOFFSET {offset}\nCHANNELS {count} {places}{}\n",
            joint.name,
            channels.join(" ")
        );
        if let Some(end) = joint.end {
            let _ = write!(text, "End Site\n{{\nOFFSET {}\n}}\n", at(end));
        }
        (0..joints.len())
            .filter(|&child| joints[child].parent == Some(index))
            .for_each(|child| self.node(joints, child, at, text, order));
        text.push_str("}\n");
    }

    /// Angles in the order of the channels, by formulas of their own: `R = Rz Ry Rx` or `Rz Rx Ry`.
    fn angles(&self, rotation: &Rotation3<f64>) -> [f64; 3] {
        let r = rotation.matrix();
        if self.names.order == "ZYX" {
            [libm::atan2(r[(1, 0)], r[(0, 0)]), libm::asin(-r[(2, 0)]), libm::atan2(r[(2, 1)], r[(2, 2)])]
        } else {
            [libm::atan2(-r[(0, 1)], r[(1, 1)]), libm::asin(r[(2, 1)]), libm::atan2(-r[(2, 0)], r[(2, 2)])]
        }
    }
}
