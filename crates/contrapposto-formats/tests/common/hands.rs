//! Bodies that exert a force with the right hand, shared by the test and the benchmark of capacities.
use contrapposto::capacity::{Capacity, Demand, Situation, Station};
use contrapposto::contact::{Place, Support};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A body in a posture.
pub struct Body {
    pub model: Model,
    pub posture: Posture,
    pub supports: Vec<Support>,
    pub station: Station,
}

impl Body {
    pub fn capacity(&self) -> Option<Capacity> {
        let Self { model, posture, supports, station } = self;
        let situation = Situation { model, posture, loads: &[], supports, muscles: None };
        Capacity::new(&situation, *station, Demand::default()).unwrap()
    }
}

fn palm(model: &Model) -> Station {
    Station { segment: model.segment("hand_r").unwrap(), point: Vector3::new(0.0, -0.07, 0.0) }
}

/// The built-in adult on both feet, the forearms forward.
pub fn standing() -> Body {
    let model = adult(&Adult::default()).unwrap();
    let support = |name: &str| {
        let segment = model.segment(name).unwrap();
        let corners = model.segments()[segment].patch.clone();
        Support { segment, corners, normal: Vector3::y(), friction: 0.6, share_max: 1.0, place: Place::Fixed }
    };
    let supports = vec![support("calcn_r"), support("calcn_l")];
    let mut posture = model.default_posture();
    for (name, degrees) in [("arm_flex_r", 40.0), ("elbow_flex_r", 70.0), ("arm_flex_l", 40.0), ("elbow_flex_l", 70.0)]
    {
        posture.values_mut()[model.coordinate(name).unwrap()] = f64::to_radians(degrees);
    }
    Body { station: palm(&model), model, posture, supports }
}

/// The right arm with a fixed shoulder, in a posture drawn at random by its number.
pub fn arm(number: u64) -> Body {
    let rng = &mut Pcg64::seed_from_u64(number);
    let model = adult(&Adult::right_arm()).unwrap();
    let values = model.coordinates().iter().map(|c| c.range.0 + rng.random_range(0.2..0.8) * (c.range.1 - c.range.0));
    let posture = Posture::new(values.collect());
    Body { station: palm(&model), model, posture, supports: vec![] }
}

/// The input of a program for robots about an arm: the torque of every joint per newton that the hand exerts along each ground
/// axis (a row a joint), least and greatest active torque, and active torque without a force.
pub fn exerted(body: &Body) -> (Vec<[f64; 3]>, Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut torques = JointTorques::new(&body.model);
    let mut active = |force: Vector3<f64>| {
        let Station { segment, point } = body.station;
        let load = Load { segment, point, kind: LoadKind::Force(-force, FixedIn::World) };
        torques.update(&body.model, &body.posture, &[load], Quantities::TORQUES).unwrap();
        (torques.active_torque().to_vec(), torques.angles().to_vec())
    };
    let (bias, angles) = active(Vector3::zeros());
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| active(axis).0);
    let joints = body.model.coordinates().iter().enumerate();
    let joints: Vec<(usize, [f64; 2])> = joints
        .filter_map(|(i, c)| {
            let groups = c.groups.as_ref()?;
            Some((c.rate?, Side::BOTH.map(|side| groups[side.index()].strength.torque(angles[i]))))
        })
        .collect();
    let jacobian =
        joints.iter().map(|(rate, _)| [0, 1, 2].map(|axis: usize| axes[axis][*rate] - bias[*rate])).collect();
    let (least, greatest) = joints.iter().map(|(_, [positive, negative])| (-negative, *positive)).unzip();
    (jacobian, least, greatest, joints.iter().map(|(rate, _)| bias[*rate]).collect())
}
