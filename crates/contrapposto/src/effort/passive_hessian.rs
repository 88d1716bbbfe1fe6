//! Computes the second derivative of weighed passive torques.
//!
//! `f = sum_i v_i tau_i(x)` with the laws `tau_i` of the angles `x`, and `v_i = w_i`, or for the laws of a three-axis joint
//! `v_j = sum_k w_k E_k x_j = W x_j`, as its moment has the components `sum_j tau_j E_k x_j`:
//!
//! ```text
//! E_m E_l f = sum_ab (d2f/dx_a dx_b) E_m x_a E_l x_b + sum_a (df/dx_a) E_m E_l x_a
//!           + sum_j (E_m v_j)(E_l tau_j) + (E_l v_j)(E_m tau_j) + tau_j E_m E_l W x_j
//! ```
//!
//! Laws of dependent coordinates, whose passive torque counts at the independent ones, are left out.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::second_by_axes::{SecondByAxes, rates, turned_axes};
use super::tolerances::{DIFFERENCE_STEP, PASSIVE_DIFFERENCE_STEP};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use crate::passive::PassiveLaw;
use crate::tasks::for_each_angle_slope;

/// Adds the second derivative of `sum_i w_i tau_p,i`, `weights` by rate; without that of coupled laws by their angles unless `coupled`.
pub(super) fn add_passive(model: &Model, body: &JointTorques, weights: &[f64], coupled: bool, to: &mut SecondByAxes) {
    let passive = body.passive_torque();
    for (own, coordinate) in model.coordinates().iter().enumerate() {
        let (Some(law), Some(rate), false) = (&coordinate.passive, coordinate.rate, model.is_dependent(own)) else {
            continue;
        };
        let weight = match model.three_axis_joint_of(own) {
            Some((joint, place)) => {
                let rates = rates(model, &model.three_axis_joints()[joint]);
                (0..3).map(|k| weights[rates[k]] * passive.orientations()[joint].angles.first[(place, k)]).sum()
            }
            None => weights[rate],
        };
        if weight == 0.0 {
            continue;
        }
        add_law(model, body, own, law, (weight, coupled), to);
    }
    for joint in 0..model.three_axis_joints().len() {
        add_joint(model, body, joint, weights, to);
    }
}

/// Adds `weight` times the terms of one law in the second derivatives by its angles, and in those of the angles.
fn add_law(
    model: &Model,
    body: &JointTorques,
    own: usize,
    law: &PassiveLaw,
    (weight, with_coupled): (f64, bool),
    to: &mut SecondByAxes,
) {
    let passive = body.passive_torque();
    if let PassiveLaw::Coupled(coupled) = law {
        for (a, row) in coupled.neighbours.iter().zip(coupled.curvature(passive.values())) {
            for (b, entry) in coupled.neighbours.iter().zip(row) {
                if let (Some((a, _)), Some((b, _)), true) = (a, b, with_coupled)
                    && passive.follows(*a)
                    && passive.follows(*b)
                {
                    add_products(model, body, (*a, *b), weight * entry, to);
                }
            }
        }
    } else if passive.follows(own) {
        let at = passive.angles()[own];
        let slope = |angle: f64| law.own_slope(own, angle);
        let change = slope(at + PASSIVE_DIFFERENCE_STEP) - slope(at - PASSIVE_DIFFERENCE_STEP);
        add_products(model, body, (own, own), weight * change / (2.0 * PASSIVE_DIFFERENCE_STEP), to);
    }
    passive.law(model, own, |by, slope| {
        let Some((joint, place)) = model.three_axis_joint_of(by) else { return };
        add_block(model, joint, &(weight * slope * passive.orientations()[joint].angles.second[place]), to);
    });
}

/// Adds `share E_m x_a E_l x_b`.
fn add_products(model: &Model, body: &JointTorques, (a, b): (usize, usize), share: f64, to: &mut SecondByAxes) {
    if share == 0.0 {
        return;
    }
    for_each_angle_slope(model, body, a, |m, by_a| {
        for_each_angle_slope(model, body, b, |l, by_b| to.add(m, l, share * by_a * by_b))
    });
}

fn add_block(model: &Model, joint: usize, block: &Matrix3<f64>, to: &mut SecondByAxes) {
    let rates = rates(model, &model.three_axis_joints()[joint]);
    for (m, by) in rates.into_iter().enumerate() {
        rates.into_iter().enumerate().for_each(|(l, other)| to.add(by, other, block[(m, l)]));
    }
}

/// Adds the terms with derivatives of `v_j` of one three-axis joint.
fn add_joint(model: &Model, body: &JointTorques, joint: usize, weights: &[f64], to: &mut SecondByAxes) {
    let of = &model.three_axis_joints()[joint];
    let (rates, passive) = (rates(model, of), body.passive_torque());
    let w = Vector3::from(rates.map(|rate| weights[rate]));
    let size = w.amax();
    if size == 0.0 {
        return;
    }
    let angles = &passive.orientations()[joint].angles;
    let h = DIFFERENCE_STEP / size;
    let about: Vector3<f64> = (0..3).map(|k| h * w[k] * of.axes[k]).sum();
    let rotation = of.rotation(body.kinematics().values());
    let after = of.swing_twist.angles(&(rotation * UnitQuaternion::from_scaled_axis(about)));
    let turned = turned_axes(model, of, weights);
    for (j, own) in of.coordinates.into_iter().enumerate() {
        let second = &angles.second[j];
        let by_weight = second * w;
        let torque = passive.law(model, own, |by, slope| {
            for_each_angle_slope(model, body, by, |l, by_l| {
                (0..3).for_each(|m| to.add_pair(rates[m], l, by_weight[m] * slope * by_l));
            });
        });
        let third = (after.second[j] - second) / h + turned * second + second * turned.transpose();
        add_block(model, joint, &(torque * third), to);
    }
}
