//! Joints of a model for `inspect`: kind and coordinates, and of joints with three rotations how their muscles are judged.

use contrapposto::model::{CoordinateKind, Drive, JointKind, Model, Motion, Segment};
use contrapposto::passive::PassiveLaw;
use serde::Serialize;

use crate::view::moment::MomentJoint;

#[derive(Serialize)]
pub(super) struct JointText<'a> {
    name: &'a str,
    kind: &'static str,
    coordinates: Vec<&'a str>,
    /// Of a joint with three rotations.
    #[serde(skip_serializing_if = "Option::is_none")]
    muscles: Option<MusclesText<'a>>,
}

/// The torques that effort, load, strength and fatigue of a joint with three rotations are known by.
#[derive(Serialize)]
#[serde(tag = "judged_by", rename_all = "snake_case")]
enum MusclesText<'a> {
    /// Components of its moment.
    Moment {
        axes: Vec<AxisText<'a>>,
        /// The axis of twist; `null` for a ball of the file, which has no muscles.
        long_axis: Option<&'a str>,
        /// Swing about each axis from which swing is counted.
        reference_deg: Option<[f64; 3]>,
    },
    /// Torques of its coordinates.
    Coordinates { because: String },
}

/// An axis, by the coordinate or rate that it stands for.
#[derive(Serialize)]
pub(crate) struct AxisText<'a> {
    pub(crate) name: &'a str,
    /// In the frame of the distal segment.
    pub(crate) direction: [f64; 3],
}

impl AxisText<'_> {
    /// The axes of a joint.
    pub(crate) fn all<'m>(model: &'m Model, joint: &MomentJoint) -> Vec<AxisText<'m>> {
        joint.axes(model).map(|(name, direction)| AxisText { name, direction }).into()
    }
}

impl<'a> JointText<'a> {
    /// The joint that ends at segment `s`; `moments`: [`MomentJoint::all`].
    pub(super) fn new(model: &'a Model, moments: &[MomentJoint], s: usize) -> Self {
        let segment = &model.segments()[s];
        let coordinates = model.coordinates()[segment.coordinates.clone()].iter().map(|c| c.name.as_str()).collect();
        Self {
            name: &segment.joint,
            kind: joint_word(&segment.joint_kind),
            coordinates,
            muscles: MusclesText::new(model, moments, s),
        }
    }
}

impl<'a> MusclesText<'a> {
    /// `None` for a joint without three rotations.
    fn new(model: &'a Model, moments: &[MomentJoint], s: usize) -> Option<Self> {
        let Some(joint) = moments.iter().find(|joint| joint.segment == s) else {
            return by_coordinates(model, s).map(|because| Self::Coordinates { because });
        };
        let found = model.three_axis_joints().iter().find(|found| found.segment == s);
        let long_axis = found.map(|found| {
            let i = found.coordinates[found.swing_twist.twist()];
            model.coordinates()[i].name.as_str()
        });
        let reference_deg = found.map(|found| found.swing_twist.reference().map(f64::to_degrees));
        Some(Self::Moment { axes: AxisText::all(model, joint), long_axis, reference_deg })
    }

    fn sentence(&self) -> String {
        match self {
            Self::Coordinates { because } => format!("judged by its coordinates, because {because}"),
            Self::Moment { axes, long_axis, reference_deg } => {
                let axis = |axis: &AxisText| {
                    let [x, y, z] = axis.direction.map(short);
                    format!("{} ({x} {y} {z})", axis.name)
                };
                let axes: Vec<String> = axes.iter().map(axis).collect();
                let long = long_axis.map_or_else(String::new, |name| format!("; long axis {name}"));
                let reference = reference_deg.filter(|angles| angles.iter().any(|angle| *angle != 0.0));
                let reference = reference.map_or_else(String::new, |angles| {
                    let [x, y, z] = angles.map(short);
                    format!("; swing counted from {x}, {y}, {z} deg")
                });
                format!("judged by its moment about {}{long}{reference}", axes.join(", "))
            }
        }
    }
}

/// One line for each joint with three rotations.
pub(super) fn three_rotations(model: &Model) -> String {
    let moments = MomentJoint::all(model);
    let line = |s: usize| {
        let muscles = MusclesText::new(model, &moments, s)?;
        Some(format!("  {}: {}\n", model.segments()[s].joint, muscles.sentence()))
    };
    let lines: String = (0..model.segments().len()).filter_map(line).collect();
    let heading = "\njoints with three rotations (axes in the frame of the distal segment):\n";
    if lines.is_empty() { lines } else { format!("{heading}{lines}") }
}

/// The reason for which a joint with three rotations is judged by its coordinates; `None` for other joints.
fn by_coordinates(model: &Model, s: usize) -> Option<String> {
    let chain = chain(model, s);
    let of_kind = |kind: CoordinateKind| {
        let all = chain.iter().flat_map(|segment| segment.coordinates.clone());
        all.filter(|&i| model.coordinates()[i].kind == kind).collect::<Vec<usize>>()
    };
    let motions: Vec<Motion> = chain.iter().flat_map(|segment| segment.joint_kind.motions()).collect();
    let slides = !of_kind(CoordinateKind::Translation).is_empty();
    if motions.contains(&Motion::Ball) {
        return Some("it joins the body to ground and slides".to_owned());
    }
    let turning = of_kind(CoordinateKind::Rotation);
    if turning.len() != 3 {
        return None;
    }
    let to_ground = chain.first().is_some_and(|segment| segment.parent.is_none());
    if slides {
        return Some(if to_ground { "it joins the body to ground and slides" } else { "it slides, too" }.to_owned());
    }
    if let Some(why) = turning.iter().find_map(|&i| of_coordinate(model, i)) {
        return Some(why);
    }
    let driven = |wanted: fn(&Motion) -> bool| {
        chain.iter().any(|segment| match &segment.joint_kind {
            JointKind::Driven(parts) => {
                parts.iter().any(|(motion, drive)| wanted(motion) && matches!(drive, Drive::Function(..)))
            }
            _ => false,
        })
    };
    Some(if driven(|motion| matches!(motion, Motion::Slide(_))) {
        "a slide of it follows a coordinate".to_owned()
    } else if driven(|motion| matches!(motion, Motion::Hinge(_))) {
        "a rotation of it is a function of a coordinate".to_owned()
    } else {
        "its hinges do not pass through one point, or two of them are parallel".to_owned()
    })
}

/// The reason for which a coordinate can belong to no three-axis joint.
fn of_coordinate(model: &Model, i: usize) -> Option<String> {
    let coordinate = &model.coordinates()[i];
    let name = &coordinate.name;
    let coupled = model.couplings().iter().any(|k| k.dependent == i || k.independent == i);
    if coupled {
        Some(format!("`{name}` is coupled"))
    } else if coordinate.locked {
        Some(format!("`{name}` is locked"))
    } else if matches!(coordinate.passive, Some(PassiveLaw::Sum(_))) {
        Some(format!("the file gives forces on `{name}`"))
    } else {
        None
    }
}

/// The segments, the nearest to the root first, whose joints make up that of segment `s`: those before it have no mass and carry
/// nothing else.
fn chain(model: &Model, s: usize) -> Vec<&Segment> {
    let segments = model.segments();
    let is_link = |p: &usize| {
        let children = segments.iter().filter(|other| other.parent == Some(*p)).count();
        segments[*p].mass == 0.0 && children == 1
    };
    let mut chain = vec![&segments[s]];
    let alone = segments.iter().filter(|other| other.parent == Some(s)).count() == 1;
    if segments[s].mass == 0.0 && alone {
        return chain;
    }
    while let Some(parent) = chain[0].parent.filter(is_link) {
        chain.insert(0, &segments[parent]);
    }
    chain
}

/// At most three decimals, without the sign of -0.
fn short(value: f64) -> String {
    let rounded = (1e3 * value).round() / 1e3 + 0.0;
    format!("{rounded}")
}

/// `hinge`, `free`, `driven by functions`.
pub(super) fn joint_word(kind: &JointKind) -> &'static str {
    match kind {
        JointKind::Weld => "weld",
        JointKind::Hinge(_) => "hinge",
        JointKind::Slide(_) => "slide",
        JointKind::Universal(_) => "universal",
        JointKind::Gimbal(_) => "gimbal",
        JointKind::Ball => "ball",
        JointKind::Free => "free",
        JointKind::Chain(_) => "chain",
        JointKind::Driven(_) => "driven",
    }
}
