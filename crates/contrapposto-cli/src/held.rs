//! What does a posture that is held still ask of the muscles? External, passive and active torque, contact forces of least effort.

use contrapposto::contact::Support;
use contrapposto::model::{Model, Side};
use contrapposto::posture::Posture;
use contrapposto::simulation::{AssessSettings, Contact, Instant, Standing, assess};
use contrapposto::statics::Load;
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
    let settings = AssessSettings { supports: supports.to_vec(), ..AssessSettings::default() };
    let mut frame = None;
    let found = assess(
        model,
        &[(0.0, posture.clone())],
        |_, _, all| all.extend_from_slice(loads),
        &settings,
        |instant| frame = Some(frame_of_instant(model, instant)),
    )
    .map_err(|error| Fail::job("posture", error))?;
    Ok(frame.filter(|_| found.unheld == 0))
}

/// An instant of a motion that is assessed.
pub(crate) fn frame_of_instant(model: &Model, instant: &Instant) -> Frame {
    let kinematics = instant.kinematics;
    let contact = instant.contact.iter().flat_map(|contact| {
        (0..contact.supports().len()).map(|i| Contact {
            force: contact.force(i),
            share: contact.share(i),
            center_of_pressure: contact.center_of_pressure(model, kinematics, i),
            couple: Vector3::zeros(), // no picture shows it
        })
    });
    let standing = Standing {
        contacts: contact.collect(),
        center_of_mass: kinematics.center_of_mass(model).unwrap_or_default(),
        ..Standing::default()
    };
    Frame {
        time: instant.time,
        fatigue: instant.fatigue.to_vec(),
        ..frame(model, instant.values, [instant.external, instant.passive], standing)
    }
}

/// A moment of which posture and torques (external and passive, by rate) are known.
pub(crate) fn frame(model: &Model, posture: &[f64], torques: [&[f64]; 2], standing: Standing) -> Frame {
    let coordinates = model.coordinates();
    let by_coordinate = |torques: &[f64]| -> Vec<f64> {
        coordinates.iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
    };
    let [external, passive] = torques.map(by_coordinate);
    let load = |(i, coordinate): (usize, &contrapposto::model::Coordinate)| {
        let active = -(passive[i] + external[i]);
        // Torques of followers are those of their leaders.
        let groups = coordinate.groups.as_ref().filter(|_| coordinate.rate.is_some() && !model.is_dependent(i));
        groups.map_or(0.0, |groups| active.abs() / groups[Side::of(active).index()].strength.torque(posture[i]))
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
