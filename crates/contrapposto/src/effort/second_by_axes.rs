//! Collects second derivatives by rotations about the axes of three-axis joints, and changes them into those by coordinates.
//!
//! `E_m f` is the derivative of `f` by the rotation about axis `m`, or by the rate `m` of another coordinate. With `a_i` the axis of
//! hinge `i` of a joint, in components `A_li` along the joint's axes, which later hinges turn:
//!
//! ```text
//! d/dq_j d/dq_i f = sum_ml A_mj A_li E_m E_l f + sum_l (dA_li/dq_j) E_l f
//! d a_i/dq_j = a_i x a_j where hinge j comes after hinge i, else 0
//! E_m E_l W = W E_m E_l + E_(m x w) E_l + E_m E_(l x w)        W = sum_k w_k E_k
//! ```
//!
//! The last line gives the second derivatives of a torque that derives from an energy, or of an angle, from the change of the first
//! ones along one motion `w`.

use nalgebra::{Matrix3, Vector3};

use crate::joint_torques::JointTorques;
use crate::model::{Model, ThreeAxisJoint};

/// First and second derivatives of one function.
#[derive(Clone, Debug)]
pub(super) struct SecondByAxes {
    n: usize,
    /// `E_m E_l f` in row `m` and column `l`.
    entries: Vec<f64>,
    /// `E_l f`.
    pub(super) gradient: Vec<f64>,
}

/// Rates of the coordinates of a joint.
pub(super) fn rates(model: &Model, joint: &ThreeAxisJoint) -> [usize; 3] {
    joint.coordinates.map(|i| model.coordinates()[i].rate.unwrap_or_default())
}

/// `m x w` of each axis `m` of a joint, by its components along the axes, in row `m`; `w` by rate.
pub(super) fn turned_axes(model: &Model, joint: &ThreeAxisJoint, w: &[f64]) -> Matrix3<f64> {
    let rates = rates(model, joint);
    let w: Vector3<f64> = joint.axes.iter().zip(rates).map(|(axis, rate)| w[rate] * axis).sum();
    Matrix3::from_fn(|m, n| joint.axes[m].cross(&w).dot(&joint.axes[n]))
}

impl SecondByAxes {
    pub(super) fn new(n: usize) -> Self {
        Self { n, entries: vec![0.0; n * n], gradient: vec![0.0; n] }
    }

    pub(super) fn clear(&mut self) {
        self.entries.fill(0.0);
        self.gradient.fill(0.0);
    }

    pub(super) fn add(&mut self, m: usize, l: usize, value: f64) {
        self.entries[m * self.n + l] += value;
    }

    /// Adds `value` at both places of a pair.
    pub(super) fn add_pair(&mut self, m: usize, l: usize, value: f64) {
        self.add(m, l, value);
        self.add(l, m, value);
    }

    /// Adds the second derivatives of `sum_k w_k tau_k` of torques `tau_k = -E_k V` from the derivatives `E_m tau_l` (row `l`) now
    /// and after the motion `h w`: `W E_m tau_l + sum_n (m x w)_n E_n tau_l + sum_n (l x w)_n E_m tau_n`.
    pub(super) fn add_along<'g>(
        &mut self,
        model: &Model,
        w: &[f64],
        h: f64,
        now: impl Fn(usize) -> &'g [f64],
        after: impl Fn(usize) -> &'g [f64],
    ) {
        for l in 0..self.n {
            for (m, (after, now)) in after(l).iter().zip(now(l)).enumerate() {
                self.entries[m * self.n + l] += (after - now) / h;
            }
        }
        for joint in model.three_axis_joints() {
            let (rates, turned) = (rates(model, joint), turned_axes(model, joint, w));
            for (m, rate) in rates.into_iter().enumerate() {
                for (n, by) in rates.into_iter().enumerate() {
                    let share = turned[(m, n)];
                    for l in 0..self.n {
                        self.entries[rate * self.n + l] += share * now(l)[by];
                        self.entries[l * self.n + rate] += share * now(by)[l];
                    }
                }
            }
        }
    }

    /// Changes the derivatives about axes into those by coordinates.
    pub(super) fn fold(&mut self, model: &Model, body: &JointTorques) {
        body.fold_axes(model, &mut self.entries);
        for (joint, orientation) in model.three_axis_joints().iter().zip(body.passive_torque().orientations()) {
            let (rates, n) = (rates(model, joint), self.n);
            for column in 0..n {
                let by_axes = Vector3::from(rates.map(|rate| self.entries[rate * n + column]));
                let by_coordinates = orientation.hinges.tr_mul(&by_axes);
                (0..3).for_each(|j| self.entries[rates[j] * n + column] = by_coordinates[j]);
            }
            let along = |by: &dyn Fn(usize) -> f64| -> Vector3<f64> { (0..3).map(|k| by(k) * joint.axes[k]).sum() };
            let gradient = along(&|k| self.gradient[rates[k]]);
            let hinge = |i: usize| along(&|k| orientation.hinges[(k, i)]);
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                // Both orders of the pair: only the later hinge turns the earlier one's axis, and the order does not matter for f.
                self.entries[rates[j] * n + rates[i]] += hinge(i).cross(&hinge(j)).dot(&gradient);
            }
        }
    }

    /// Adds the symmetric part at the `free` rates to the upper triangle of a matrix with rows of `unknowns` entries.
    pub(super) fn add_to(&self, free: &[usize], unknowns: usize, matrix: &mut [f64]) {
        for (i, &a) in free.iter().enumerate() {
            for (j, &b) in free.iter().enumerate().skip(i) {
                matrix[i * unknowns + j] += 0.5 * (self.entries[a * self.n + b] + self.entries[b * self.n + a]);
            }
        }
    }
}
