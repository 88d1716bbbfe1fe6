//! Angles about the axes of three-axis joints, and the torques of their coordinates: `A^T m`, from the moment `m` about the axes.

use contrapposto::model::Model;
use nalgebra::Vector3;

/// The angles of all coordinates in a posture, rad or m: of a three-axis joint those about its axes.
pub(crate) fn angles(model: &Model, posture: &[f64]) -> Vec<f64> {
    let mut angles = posture.to_vec();
    for joint in model.three_axis_joints() {
        let about_axes = joint.orientation(posture).angles.values;
        joint.coordinates.into_iter().zip(about_axes).for_each(|(i, angle)| angles[i] = angle);
    }
    angles
}

/// Changes torques about the axes of three-axis joints into those of their coordinates, which OpenSim calls generalised forces.
pub(crate) fn of_coordinates(model: &Model, posture: &[f64], about_axes: &[f64]) -> Vec<f64> {
    let mut torques = about_axes.to_vec();
    for joint in model.three_axis_joints() {
        let moment = Vector3::from(joint.coordinates.map(|i| about_axes[i]));
        let of_coordinates = joint.orientation(posture).hinges.tr_mul(&moment);
        joint.coordinates.into_iter().zip(of_coordinates.iter()).for_each(|(i, torque)| torques[i] = *torque);
    }
    torques
}
