//! Computes the torques of one joint over its range, as Figure 1 of Rodriguez & Boulic 2007 draws them: that joint alone turns, loads and
//! contact forces stay.

use contrapposto::joint_torques::{AboutAxes, JointTorques, Quantities};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;

use crate::body::Body;
use crate::error::Refusal;
use crate::message::Balance;

/// Angles at which the torques are computed.
const ANGLES: usize = 91;

/// The torques of a coordinate in a posture under loads, contact forces among them.
pub(crate) fn balance(body: &Body, posture: &Posture, loads: &[Load], name: &str) -> Result<Balance, Refusal> {
    let model = &*body.model;
    let known = model.coordinate(name).and_then(|i| Some((i, model.coordinates()[i].rate?)));
    let Some((i, rate)) = known else {
        return Err(Refusal(format!("there is no joint coordinate `{name}`")));
    };
    let mut torques = JointTorques::new(model);
    let passive = Quantities { passive_torque: true, ..Quantities::default() };
    torques.update(model, posture, &[], passive).map_err(Refusal::of)?;
    let range = model.coordinates()[i].range;
    let (kinematics, tissue, now) = (torques.kinematics(), torques.passive_torque(), torques.angles()[i]);
    let range = match model.three_axis_joint_of(i) {
        Some(_) => tissue.curve_about_axis(model, kinematics, i, range).map_or(range, |curve| curve.range()),
        None => range,
    };
    let (mut turned, mut step) = (AboutAxes::new(model), vec![0.0; model.rates().len()]);
    let mut values = vec![0.0; model.coordinates().len()];
    let mut found = Balance { coordinate: name.to_owned(), angle: vec![], external: vec![], minus_passive: vec![] };
    for k in 0..ANGLES {
        let angle = range.0 + (range.1 - range.0) * k as f64 / (ANGLES - 1) as f64;
        step[rate] = angle - now;
        turned.update_displaced(model, posture, &step, loads).map_err(Refusal::of)?;
        found.angle.push(angle);
        found.external.push(turned.external().torques()[rate]);
        found.minus_passive.push(-tissue.torque_after_turn((model, kinematics), i, angle - now, &mut values));
    }
    Ok(found)
}
