//! Moments of the joints with three rotations about one point, by their components along axes of the distal segment.

use contrapposto::joint_torques::{JointTorques, active_torque, relative_load};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model, Motion};
use nalgebra::Vector3;

/// A joint whose torques are components of its moment.
pub(crate) struct MomentJoint {
    /// Name of the joint in the model.
    pub(crate) name: String,
    /// The distal segment.
    pub(crate) segment: usize,
    /// The rates about its axes, in the order of the coordinates.
    rates: [usize; 3],
    /// The axes in the frame of the distal segment.
    directions: [Vector3<f64>; 3],
}

/// Torques of such a joint about its axes, N m.
pub(crate) struct Moment {
    pub(crate) external: [f64; 3],
    pub(crate) passive: [f64; 3],
    pub(crate) active: [f64; 3],
    /// Angles about the axes, rad; 0 for a ball, which has none.
    pub(crate) angles: [f64; 3],
    /// Greatest |active torque| over strength; `None` where no strength is known.
    pub(crate) load: Option<f64>,
}

impl MomentJoint {
    /// All of a model: three-axis joints and balls, but for balls of joints to ground that slide, too.
    pub(crate) fn all(model: &Model) -> Vec<Self> {
        let balls = model.by_axes();
        let kinematics = Kinematics::new(balls);
        let joint = |segment: usize, name: &str, rates: [usize; 3]| {
            let back = kinematics.placement(balls, segment).rotation.inverse();
            let directions = rates.map(|rate| back * kinematics.axis(balls, rate));
            Self { name: name.to_owned(), segment, rates, directions }
        };
        let mut joints: Vec<Self> = vec![];
        for found in model.three_axis_joints() {
            let [a, b, c] = found.coordinates.map(|i| model.coordinates()[i].rate);
            if let (Some(a), Some(b), Some(c)) = (a, b, c) {
                joints.push(joint(found.segment, &found.name, [a, b, c]));
            }
        }
        for (s, segment) in model.segments().iter().enumerate() {
            let motions = segment.joint_kind.motions();
            let slides = motions.iter().any(|motion| matches!(motion, Motion::Slide(_)));
            if motions.contains(&Motion::Ball) && !(segment.parent.is_none() && slides) {
                let rate = |axis: &str| {
                    let name = format!("{}_{axis}", segment.joint);
                    model.rates().iter().position(|rate| rate.coordinate.is_none() && rate.name == name)
                };
                if let (Some(a), Some(b), Some(c)) = (rate("mx"), rate("my"), rate("mz")) {
                    joints.push(joint(s, &segment.joint, [a, b, c]));
                }
            }
        }
        joints.sort_by_key(|joint| joint.segment);
        joints
    }

    /// Names of the axes, those of the coordinates or rates that they stand for, and their directions in the distal segment.
    pub(crate) fn axes<'m>(&self, model: &'m Model) -> [(&'m str, [f64; 3]); 3] {
        [0, 1, 2].map(|k| (model.rates()[self.rates[k]].name.as_str(), self.directions[k].into()))
    }

    /// The coordinates that its axes stand for; none of a ball.
    pub(crate) fn coordinates(&self, model: &Model) -> [Option<usize>; 3] {
        self.rates.map(|rate| model.rates()[rate].coordinate)
    }

    /// Torques of the joint in the posture of `body`.
    pub(crate) fn moment(&self, model: &Model, body: &JointTorques) -> Moment {
        // Adding 0 turns -0, the active torque of no torques, into 0.
        let of = |torques: &[f64]| self.rates.map(|rate| torques[rate] + 0.0);
        let load = self.rates.iter().filter_map(|&rate| load(model, body, rate)).reduce(f64::max);
        Moment {
            external: of(body.external_about_axes()),
            passive: of(body.passive_torque().about_axes()),
            active: of(body.active_torque()),
            angles: self.coordinates(model).map(|c| c.map_or(0.0, |c| body.angles()[c])),
            load,
        }
    }
}

/// Relative load of the coordinate of a rate; `None` where its strength is not known.
fn load(model: &Model, body: &JointTorques, rate: usize) -> Option<f64> {
    let i = model.rates()[rate].coordinate?;
    let coordinate = &model.coordinates()[i];
    let (external, passive) = (body.external_about_axes()[rate], body.passive_torque().about_axes()[rate]);
    let known = coordinate.groups.is_some() && coordinate.kind != CoordinateKind::Quaternion;
    known.then(|| relative_load(coordinate, body.angles()[i], active_torque(external, passive)))
}

/// Relative loads of all coordinates of known strength.
pub(crate) fn loads(model: &Model, body: &JointTorques) -> Vec<f64> {
    (0..model.rates().len()).filter_map(|rate| load(model, body, rate)).collect()
}
