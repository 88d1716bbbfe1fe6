//! What does a posture that is held still ask of the muscles? External, passive and active torque, contact forces of least effort.

use contrapposto::contact::{Balance, ContactForces, Support};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Side};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Contact, Standing};
use contrapposto::statics::{ExternalTorque, Load, PassiveTorque};
use nalgebra::Vector3;

use crate::fail::Fail;
use crate::report::Frame;

/// A posture and what it asks for; `None` where the supports cannot hold it. Without supports its root is held as if by hand.
pub(crate) fn held(
    model: &Model,
    posture: &Posture,
    loads: &[Load],
    supports: &[Support],
) -> Result<Option<Frame>, Fail> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).map_err(|error| Fail::job("posture", error))?;
    let mut external = ExternalTorque::new(model);
    external.update(model, &kinematics, loads).map_err(|error| Fail::job("load", error))?;
    let mut passive = PassiveTorque::new(model);
    passive.update(model, &kinematics);
    let mut contacts = vec![];
    if !supports.is_empty() {
        let refused = |error| Fail::job("support", error);
        let mut contact = ContactForces::new(model, supports.to_vec()).map_err(refused)?;
        if contact.update(model, &kinematics, external.torques(), passive.torques()) != Balance::Held {
            return Ok(None);
        }
        let all: Vec<Load> = loads.iter().chain(contact.loads()).cloned().collect();
        external.update(model, &kinematics, &all).map_err(|error| Fail::job("load", error))?;
        contacts.extend((0..supports.len()).map(|i| Contact {
            force: contact.force(i),
            share: contact.share(i),
            center_of_pressure: contact.center_of_pressure(model, &kinematics, i),
            couple: Vector3::zeros(),
        }));
    }
    let center_of_mass = kinematics.center_of_mass(model).unwrap_or_default();
    let standing = Standing { contacts, center_of_mass, ..Standing::default() };
    Ok(Some(frame(model, kinematics.values(), [external.torques(), passive.torques()], standing)))
}

/// A moment of which postures and torques (external and passive, by rate) are known.
pub(crate) fn frame(model: &Model, posture: &[f64], torques: [&[f64]; 2], standing: Standing) -> Frame {
    let coordinates = model.coordinates();
    let by_coordinate = |torques: &[f64]| -> Vec<f64> {
        coordinates.iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
    };
    let [external, passive] = torques.map(by_coordinate);
    let load = |(i, coordinate): (usize, &contrapposto::model::Coordinate)| {
        let active = -(passive[i] + external[i]);
        let group = coordinate.groups.as_ref().map(|groups| &groups[Side::of(active).index()]);
        group.map_or(0.0, |group| active.abs() / group.strength.torque(posture[i]))
    };
    Frame {
        time: 0.0,
        load: coordinates.iter().enumerate().map(load).collect(),
        fatigue: vec![[0.0; 2]; coordinates.len()],
        posture: posture.to_vec(),
        external,
        passive,
        standing: Some(standing),
    }
}
