//! Computes the placement of every segment and axis in a posture.

mod center_of_mass;
mod jacobian;

pub(crate) use center_of_mass::Carried;
pub use center_of_mass::CenterOfMass;

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};

use crate::model::{Drive, Mobility, Model, Motion, Placement};
use crate::posture::{Posture, PostureError};

/// Frames and axes of a posture. Depends on the posture only; filled by [`Kinematics::update`].
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// Rotation of each mobility's moved frame in ground.
    pub(crate) rotations: Vec<Matrix3<f64>>,
    /// Origin of each mobility's moved frame in ground, m: the point that hinges and balls turn about.
    pub(crate) origins: Vec<Vector3<f64>>,
    /// Unit axis of each elementary rate in ground.
    pub(crate) axes: Vec<Vector3<f64>>,
    /// Value of every coordinate, those that follow others filled in.
    pub(crate) values: Vec<f64>,
    /// First and second derivative of each elementary motion by its coordinate.
    pub(crate) drives: Vec<(f64, f64)>,
    /// First and second derivative of each coupling.
    pub(crate) couplings: Vec<(f64, f64)>,
    /// Rotation of each ball beyond the orientation that its coordinates give.
    turns: Vec<UnitQuaternion<f64>>,
}

impl Kinematics {
    /// Space for `model`, at its default posture.
    pub fn new(model: &Model) -> Self {
        let mut kinematics = Self {
            rotations: vec![Matrix3::identity(); model.mobilities.len()],
            origins: vec![Vector3::zeros(); model.mobilities.len()],
            axes: vec![Vector3::zeros(); model.elements.len()],
            values: vec![0.0; model.coordinates.len()],
            drives: vec![(1.0, 0.0); model.elements.len()],
            couplings: vec![(0.0, 0.0); model.couplings.len()],
            turns: vec![UnitQuaternion::identity(); model.three_axis.len()],
        };
        kinematics.fill(model, model.default_posture().values());
        kinematics
    }

    /// Brings all frames to `posture`. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model; nothing is changed then.
    pub fn update(&mut self, model: &Model, posture: &Posture) -> Result<(), PostureError> {
        posture.check(model)?;
        self.turns.fill(UnitQuaternion::identity());
        self.fill(model, posture.values());
        Ok(())
    }

    /// As [`Kinematics::update`] for a body with balls ([`Model::by_axes`]), each turned further about its axes by its entries of
    /// `step` (rad, one a rate).
    ///
    /// # Errors
    /// As [`Kinematics::update`].
    pub(crate) fn update_turned(&mut self, model: &Model, posture: &Posture, step: &[f64]) -> Result<(), PostureError> {
        posture.check(model)?;
        for (turn, joint) in self.turns.iter_mut().zip(&model.three_axis) {
            let by = |(axis, c): (&Vector3<f64>, usize)| model.coordinates[c].rate.map(|rate| step[rate] * axis);
            let turned: Vector3<f64> = joint.axes.iter().zip(joint.coordinates).filter_map(by).sum();
            *turn = UnitQuaternion::from_scaled_axis(turned);
        }
        self.fill(model, posture.values());
        Ok(())
    }

    fn fill(&mut self, model: &Model, posture: &[f64]) {
        self.fill_values(model, posture);
        for (i, mobility) in model.mobilities.iter().enumerate() {
            let (rotation, origin) = match mobility.parent {
                None => (mobility.rotation, mobility.translation),
                Some(p) => {
                    let parent = &self.rotations[p];
                    let rotation = if mobility.turned { parent * mobility.rotation } else { *parent };
                    (rotation, parent * mobility.translation + self.origins[p])
                }
            };
            let value = match &mobility.drive {
                _ if mobility.motion == Motion::Ball => 0.0,
                Drive::Coordinate(c) => self.values[*c],
                Drive::Fixed(value) => *value,
                Drive::Function(function, c) => {
                    let [value, slope, curvature] = function.value_slope_curvature(self.values[*c]);
                    self.drives[mobility.rate] = (slope, curvature);
                    value
                }
            };
            match mobility.motion {
                Motion::Hinge(axis) => {
                    (self.rotations[i], self.axes[mobility.rate]) = match mobility.principal {
                        Some((k, sign)) => turn_about(&rotation, k, sign, value),
                        None => {
                            let turn = Rotation3::from_axis_angle(&axis, value).into_inner();
                            (rotation * turn, rotation * axis.into_inner())
                        }
                    };
                    self.origins[i] = origin;
                }
                Motion::Slide(axis) => {
                    let axis = rotation * axis.into_inner();
                    self.axes[mobility.rate] = axis;
                    self.rotations[i] = rotation;
                    self.origins[i] = origin + value * axis;
                }
                Motion::Ball => {
                    self.turn_ball(model, mobility, &rotation, i);
                    self.origins[i] = origin;
                }
            }
        }
    }

    /// Turns a ball by its quaternion, or by the coordinates of its three-axis joint, from its resting `rotation` in ground.
    fn turn_ball(&mut self, model: &Model, mobility: &Mobility, rotation: &Matrix3<f64>, i: usize) {
        let axes = &mut self.axes[mobility.rate..mobility.rate + 3];
        if let Some(j) = mobility.angles {
            let joint = &model.three_axis[j];
            let turn = joint.rotation(&self.values) * self.turns[j];
            self.rotations[i] = rotation * turn.to_rotation_matrix().into_inner();
            axes.iter_mut().zip(&joint.axes).for_each(|(axis, of_joint)| *axis = self.rotations[i] * of_joint);
        } else if let Drive::Coordinate(c) = mobility.drive {
            let [w, x, y, z] = [0, 1, 2, 3].map(|k| self.values[c + k]);
            let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            self.rotations[i] = rotation * turn.to_rotation_matrix().into_inner();
            axes.iter_mut().enumerate().for_each(|(k, axis)| *axis = self.rotations[i].column(k).into_owned());
        }
    }

    /// Coordinates, the dependent ones from their independent ones; frames stay where they are.
    pub(crate) fn fill_values(&mut self, model: &Model, posture: &[f64]) {
        self.values.copy_from_slice(posture);
        for (coupling, derivatives) in model.couplings.iter().zip(&mut self.couplings) {
            let [value, slope, curvature] = coupling.function.value_slope_curvature(self.values[coupling.independent]);
            self.values[coupling.dependent] = value;
            *derivatives = (slope, curvature);
        }
    }

    /// Pose of a segment in ground.
    pub fn placement(&self, model: &Model, segment: usize) -> Placement {
        let segment = &model.segments[segment];
        match segment.mobility {
            None => segment.offset,
            Some(m) => {
                let rotation = Rotation3::from_matrix_unchecked(self.rotations[m]);
                let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
                Placement::from_parts(self.origins[m].into(), rotation) * segment.offset
            }
        }
    }

    /// A point fixed in a segment (m, its frame), in ground.
    pub fn station(&self, model: &Model, segment: usize, point: Vector3<f64>) -> Vector3<f64> {
        let segment = &model.segments[segment];
        let point = (segment.offset * Point3::from(point)).coords;
        segment.mobility.map_or(point, |m| self.rotations[m] * point + self.origins[m])
    }

    /// A direction fixed in a segment, in ground.
    pub fn direction(&self, model: &Model, segment: usize, direction: Vector3<f64>) -> Vector3<f64> {
        let segment = &model.segments[segment];
        let direction = segment.offset.rotation * direction;
        segment.mobility.map_or(direction, |m| self.rotations[m] * direction)
    }

    /// Unit axis of the first elementary motion that a rate drives, in ground; zero if it drives none.
    pub fn axis(&self, model: &Model, rate: usize) -> Vector3<f64> {
        let element = model.elements.iter().position(|&r| r == Some(rate));
        element.map_or_else(Vector3::zeros, |element| self.axes[element])
    }

    /// Value of every coordinate, those that follow others filled in.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Centre of mass of the whole body in ground, m; `None` for a body without mass.
    pub fn center_of_mass(&self, model: &Model) -> Option<Vector3<f64>> {
        let mass = model.mass();
        let moment: Vector3<f64> = (0..model.segments.len())
            .map(|s| model.segments[s].mass * self.station(model, s, model.segments[s].center_of_mass))
            .sum();
        (mass > 0.0).then(|| moment / mass)
    }
}

/// `rotation` turned by `angle` about its own axis `k` (times `sign`), and that axis in ground.
#[inline]
fn turn_about(rotation: &Matrix3<f64>, k: usize, sign: f64, angle: f64) -> (Matrix3<f64>, Vector3<f64>) {
    let (sin, cos) = libm::sincos(sign * angle);
    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
    let (from, to) = (rotation.column(a).into_owned(), rotation.column(b).into_owned());
    let mut turned = *rotation;
    turned.set_column(a, &(cos * from + sin * to));
    turned.set_column(b, &(cos * to - sin * from));
    (turned, sign * rotation.column(k))
}
