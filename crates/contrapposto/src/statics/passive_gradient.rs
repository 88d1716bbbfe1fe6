//! Computes how passive torque changes with the posture, by rotations about the axes of three-axis joints.
//!
//! Passive torque is folded as external torque is: that of a dependent coordinate counts at its independent one. With `q_d(q_i)`
//! through however many couplings, `tau_i = sum_d q_d' tau_d` and `d tau_i/dq_i` has `q_d'' tau_d` besides. A component
//! `m_k = sum_j tau_j(x) E_k x_j` of the moment of a three-axis joint changes by
//! `E_m m_k = sum_j (E_m tau_j) (E_k x_j) + tau_j E_m E_k x_j`.

use super::PassiveTorque;
use crate::kinematics::Kinematics;
use crate::model::Model;

impl PassiveTorque {
    /// Adds the derivatives of an independent coordinate's passive torque about its axis, dependent coordinates folded in, to
    /// `row`, one entry a rate: by rotations about the axes of three-axis joints. Returns the torque.
    pub(crate) fn add_row_about_axis(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        coordinate: usize,
        row: &mut [f64],
    ) -> f64 {
        let torque = match model.three_axis_joint_of(coordinate) {
            Some((joint, place)) => self.add_component(model, joint, place, row),
            None => {
                let values = kinematics.values();
                self.add_folded(model, values, (coordinate, coordinate), [1.0, 0.0], row)
            }
        };
        kinematics.fold_columns(model, row);
        torque
    }

    /// Adds `share` times a derivative by the angle of a coordinate to `row`.
    fn add_slope(&self, model: &Model, by: usize, slope: f64, row: &mut [f64]) {
        if let Some((joint, place)) = model.three_axis_joint_of(by) {
            let rates = model.three_axis_joints()[joint].coordinates.map(|i| model.coordinates()[i].rate);
            for (k, rate) in rates.into_iter().enumerate() {
                if let Some(rate) = rate {
                    row[rate] += slope * self.orientations()[joint].angles.first[(place, k)];
                }
            }
        } else if let Some(rate) = model.coordinates()[by].rate {
            row[rate] += slope;
        }
    }

    /// Adds the derivatives of component `k` of a three-axis joint's passive moment; returns the component.
    fn add_component(&self, model: &Model, joint: usize, k: usize, row: &mut [f64]) -> f64 {
        let coordinates = model.three_axis_joints()[joint].coordinates;
        let angles = &self.orientations()[joint].angles;
        let mut moment = 0.0;
        for (j, own) in coordinates.into_iter().enumerate() {
            let share = angles.first[(j, k)];
            let torque = self.law(model, own, |by, slope| self.add_slope(model, by, share * slope, row));
            moment += share * torque;
            for (m, other) in coordinates.into_iter().enumerate() {
                if let Some(rate) = model.coordinates()[other].rate {
                    row[rate] += torque * angles.second[j][(m, k)];
                }
            }
        }
        moment
    }

    /// Adds the derivatives of the passive torque of a coordinate and of all that depend on it, `[q', q'']` times: derivatives of
    /// the coordinate by `independent`, whose rate takes those by it. Dependent coordinates are not yet folded in `row`.
    fn add_folded(
        &self,
        model: &Model,
        values: &[f64],
        (coordinate, independent): (usize, usize),
        [first, second]: [f64; 2],
        row: &mut [f64],
    ) -> f64 {
        let torque = self.law(model, coordinate, |by, slope| self.add_slope(model, by, first * slope, row));
        if let Some(rate) = model.coordinates()[independent].rate {
            row[rate] += second * torque;
        }
        let mut sum = first * torque;
        for coupling in model.couplings().iter().filter(|coupling| coupling.independent == coordinate) {
            let [_, slope, curvature] = coupling.function.value_slope_curvature(values[coordinate]);
            let by = [slope * first, curvature * first * first + slope * second];
            sum += self.add_folded(model, values, (coupling.dependent, independent), by, row);
        }
        sum
    }
}
