//! Computes the torque of ligaments and other passive tissue of all coordinates.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::{Model, Orientation};

/// Larger torque cannot be calculated with: squares of it must stay finite. N m, N for slides.
const PASSIVE_TORQUE_LIMIT: f64 = 1e50;

/// A law of a file that gives no torque to calculate with in a posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the passive torque of `{coordinate}` at {value:.6} (rad or m) is {torque:e} N m (or N); it must be finite and at most {PASSIVE_TORQUE_LIMIT:e} in size"
)]
pub struct PassiveTorqueError {
    /// Name of the coordinate.
    pub coordinate: String,
    /// Value of the coordinate, rad or m.
    pub value: f64,
    /// Torque by its law, N m or N.
    pub torque: f64,
}

/// Passive torque of every rate, N m, in the posture that `kinematics` holds. Torques of a dependent coordinate are folded into its
/// independent one, as with external torque. Filled by [`PassiveTorque::update`].
///
/// The laws of a three-axis joint are those of the angles `x_j` about its axes ([`crate::model::ThreeAxisJoint`]): its passive moment
/// has the components `m_k = sum_j tau_j(x) E_k x_j`, minus the derivative of an energy where the laws have one, and gives its
/// coordinates the torques `A^T m`. Beyond the coordinate's range a law goes on along its tangent there.
#[derive(Clone, Debug)]
pub struct PassiveTorque {
    /// By coordinate; empty for none.
    ranges: Vec<Option<(f64, f64)>>,
    /// By three-axis joint.
    orientations: Vec<Orientation>,
    /// Angles of all coordinates: of a three-axis joint those about its axes.
    angles: Vec<f64>,
    /// The same, inside the range of the law.
    values: Vec<f64>,
    /// Torque of the law of each coordinate.
    laws: Vec<f64>,
    raw_about_axes: Vec<f64>,
    about_axes: Vec<f64>,
    raw: Vec<f64>,
    torques: Vec<f64>,
}

impl PassiveTorque {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        Self::within(model, &[])
    }

    /// Space for `model`. Outside of its range (rad, one entry a coordinate) the torque of a coordinate stays what it is at the
    /// nearer end: laws that were measured inside a range say nothing outside of it.
    pub fn within(model: &Model, ranges: &[Option<(f64, f64)>]) -> Self {
        let (n, coordinates) = (model.rates().len(), model.coordinates().len());
        Self {
            ranges: ranges.to_vec(),
            orientations: vec![Orientation::default(); model.three_axis_joints().len()],
            angles: vec![0.0; coordinates],
            values: vec![0.0; coordinates],
            laws: vec![0.0; coordinates],
            raw_about_axes: vec![0.0; n],
            about_axes: vec![0.0; n],
            raw: vec![0.0; n],
            torques: vec![0.0; n],
        }
    }

    /// Computes them. Does not allocate.
    ///
    /// # Errors
    /// [`PassiveTorqueError`] where a law gives no number, as `1/q` does at 0.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics) -> Result<(), PassiveTorqueError> {
        self.place(model, kinematics);
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            self.laws[i] = 0.0;
            if coordinate.passive.is_none() || coordinate.rate.is_none() {
                continue;
            }
            let torque = self.law(model, i, |_, _| {});
            if torque.is_nan() || torque.abs() > PASSIVE_TORQUE_LIMIT {
                return Err(PassiveTorqueError { coordinate: coordinate.name.clone(), value: self.values[i], torque });
            }
            self.laws[i] = torque;
        }
        for (torque, rate) in self.raw.iter_mut().zip(model.rates()) {
            *torque = rate.coordinate.map_or(0.0, |i| self.laws[i]);
        }
        self.raw_about_axes.copy_from_slice(&self.raw);
        for (joint, orientation) in model.three_axis_joints().iter().zip(&self.orientations) {
            let of_laws = Vector3::from(joint.coordinates.map(|i| self.laws[i]));
            let moment = orientation.angles.first.tr_mul(&of_laws);
            let by_coordinate = orientation.hinges.tr_mul(&moment);
            for (k, i) in joint.coordinates.into_iter().enumerate() {
                let Some(rate) = model.coordinates()[i].rate else { continue };
                (self.raw_about_axes[rate], self.raw[rate]) = (moment[k], by_coordinate[k]);
            }
        }
        kinematics.fold_couplings(model, &self.raw_about_axes, &mut self.about_axes);
        kinematics.fold_couplings(model, &self.raw, &mut self.torques);
        Ok(())
    }

    /// Adds torques by rate, N m, of coordinates and about axes, with dependent coordinates folded into their independent ones.
    pub(crate) fn add(&mut self, of_coordinates: &[f64], about_axes: &[f64]) {
        let pairs = [
            (&mut self.raw, of_coordinates),
            (&mut self.torques, of_coordinates),
            (&mut self.raw_about_axes, about_axes),
            (&mut self.about_axes, about_axes),
        ];
        for (torques, added) in pairs {
            torques.iter_mut().zip(added).for_each(|(torque, added)| *torque += added);
        }
    }

    /// Computes angles and orientations.
    fn place(&mut self, model: &Model, kinematics: &Kinematics) {
        self.angles.copy_from_slice(kinematics.values());
        self.values.copy_from_slice(kinematics.values());
        for (value, range) in self.values.iter_mut().zip(&self.ranges) {
            *value = range.map_or(*value, |(min, max)| value.max(min).min(max));
        }
        for (joint, orientation) in model.three_axis_joints().iter().zip(&mut self.orientations) {
            *orientation = joint.orientation(kinematics.values());
            for (&i, angle) in joint.coordinates.iter().zip(orientation.angles.values) {
                let (min, max) = range(&self.ranges, model, i);
                (self.angles[i], self.values[i]) = (angle, angle.max(min).min(max));
            }
        }
    }

    /// Range of the law of a coordinate, rad.
    pub(super) fn range(&self, model: &Model, coordinate: usize) -> (f64, f64) {
        range(&self.ranges, model, coordinate)
    }

    /// Whether the law of a coordinate keeps its torque beyond its range. Without a range of its own the law of an angle of a
    /// three-axis joint goes on along its tangent.
    fn is_held(&self, coordinate: usize) -> bool {
        self.ranges.get(coordinate).is_some_and(Option::is_some)
    }

    /// Whether the laws follow the angle of a coordinate: it lies inside the range.
    pub(crate) fn follows(&self, coordinate: usize) -> bool {
        self.angles[coordinate] == self.values[coordinate]
    }

    /// Torque of the law of a coordinate, N m, and through `visit` its derivatives by the angles of coordinates; 0 without a law.
    pub(crate) fn law(&self, model: &Model, coordinate: usize, mut visit: impl FnMut(usize, f64)) -> f64 {
        let beyond = |i: usize| self.beyond(i, self.angles[i], self.values[i]);
        extended(model, coordinate, &self.values, beyond(coordinate), |by, slope| {
            if by == coordinate || beyond(by) == 0.0 {
                visit(by, slope);
            }
        })
    }

    /// Distance over which the law of a coordinate goes on along its tangent from `value`, the end of its range, to `angle`, rad.
    pub(super) fn beyond(&self, coordinate: usize, angle: f64, value: f64) -> f64 {
        // A law that keeps its torque beyond its range does not go on.
        if self.is_held(coordinate) { 0.0 } else { angle - value }
    }

    /// Torque of the law of a coordinate about its axis, N m, nothing coupled.
    pub(crate) fn law_about_axis(&self, model: &Model, coordinate: usize) -> f64 {
        model.coordinates()[coordinate].rate.map_or(0.0, |rate| self.raw_about_axes[rate])
    }

    /// The angles of all coordinates at which the laws were evaluated, inside the ranges of the laws, rad or m.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The angles of all coordinates, rad or m: those of a three-axis joint about its axes.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// By three-axis joint of the model: angles about its axes, and the axes of its hinges.
    pub fn orientations(&self) -> &[Orientation] {
        &self.orientations
    }

    /// By rate, N m (N for slides), of the coordinates.
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// By rate, N m (N for slides): of the coordinates of a three-axis joint about the axes that stand for them.
    pub fn about_axes(&self) -> &[f64] {
        &self.about_axes
    }

    /// As [`PassiveTorque::torques`], but as if no coordinate depended on another one.
    pub fn uncoupled_torques(&self) -> &[f64] {
        &self.raw
    }
}

/// Range of the law of a coordinate, rad: its own among `ranges`, or that of the coordinate.
fn range(ranges: &[Option<(f64, f64)>], model: &Model, coordinate: usize) -> (f64, f64) {
    ranges.get(coordinate).copied().flatten().unwrap_or(model.coordinates()[coordinate].range)
}

/// Torque of the law of a coordinate at the angles `values`, N m, continued along its tangent by `beyond` (rad), and through `visit`
/// its derivatives by angles; 0 without a law.
pub(super) fn extended(
    model: &Model,
    coordinate: usize,
    values: &[f64],
    beyond: f64,
    mut visit: impl FnMut(usize, f64),
) -> f64 {
    let Some(law) = &model.coordinates()[coordinate].passive else { return 0.0 };
    let mut own = 0.0;
    let torque = law.torque_and_slopes(coordinate, values, |by, slope| {
        own += if by == coordinate { slope } else { 0.0 };
        visit(by, slope);
    });
    // A formula may have a torque where it has no finite slope.
    if beyond == 0.0 { torque } else { torque + own * beyond }
}
