//! Moves postures about the axes of three-axis joints.

use contrapposto::model::Model;
use contrapposto::posture::Posture;
use nalgebra::{UnitQuaternion, Vector3};

/// The posture after a small motion of one rate: a three-axis joint turns about its axis.
pub(crate) fn moved_about_axis(model: &Model, posture: &Posture, rate: usize, by: f64) -> Posture {
    let mut moved = posture.clone();
    let coordinate = model.rates()[rate].coordinate.unwrap();
    let Some((joint, place)) = model.three_axis_joint_of(coordinate) else {
        moved.values_mut()[coordinate] += by;
        return moved;
    };
    let joint = &model.three_axis_joints()[joint];
    let goal = joint.rotation(posture.values()) * UnitQuaternion::from_scaled_axis(by * joint.axes[place]);
    for _ in 0..4 {
        let left = (joint.rotation(moved.values()).inverse() * goal).scaled_axis();
        let left = Vector3::from(joint.axes.map(|axis| axis.dot(&left)));
        let step = joint.orientation(moved.values()).hinges.lu().solve(&left).unwrap();
        joint.coordinates.iter().zip(step.iter()).for_each(|(i, step)| moved.values_mut()[*i] += step);
    }
    moved
}
