//! Gives contact forces and loads over time as arrows, for glTF.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_formats::animation::Arrow;
use nalgebra::Vector3;

use super::frame::Frame;
use super::stage::{Stage, load_in_words, push};
use crate::fail::Fail;

/// Length of an arrow of the body's weight, m, as on pages.
const OF_WEIGHT: f64 = 0.6;
/// Least length of the arrow of a load, m, as on pages.
const SHORTEST_LOAD: f64 = 0.25;
/// Share of the body's weight below which a force is none.
const NO_FORCE: f64 = 0.005;

/// An arrow for every contact and every load, with an entry for every frame.
pub(crate) fn arrows(
    model: &Model,
    stage: &Stage<'_>,
    frames: impl Iterator<Item = Frame>,
) -> Result<Vec<Arrow>, Fail> {
    let (weight, all) = ((model.mass() * model.gravity().norm()).max(1.0), stage.all_loads());
    let along = |force: Vector3<f64>, shortest: f64| {
        let share = force.norm() / weight;
        if share < NO_FORCE { Vector3::zeros() } else { force.normalize() * (OF_WEIGHT * share).max(shortest) }
    };
    let mut contacts: Vec<Arrow> = vec![];
    let mut loads: Vec<Arrow> =
        all.iter().map(|load| Arrow { name: load_in_words(model, load), ..Arrow::default() }).collect();
    let mut kinematics = Kinematics::new(model);
    for (number, frame) in frames.enumerate() {
        if number == 0 {
            let names = stage.support_names(model, &frame.posture);
            contacts = names.into_iter().map(|name| Arrow { name, contact: true, ..Arrow::default() }).collect();
        }
        for (i, arrow) in contacts.iter_mut().enumerate() {
            let contact = frame.standing.as_ref().and_then(|standing| standing.contacts.get(i));
            let last = arrow.at.last().copied().unwrap_or_default();
            arrow.at.push(contact.and_then(|contact| contact.center_of_pressure).unwrap_or(last));
            arrow.along.push(contact.map_or_else(Vector3::zeros, |contact| along(contact.force, 0.0)));
        }
        if loads.is_empty() {
            continue;
        }
        let updated = kinematics.update(model, &Posture::new(frame.posture));
        updated.map_err(|error| Fail::job("glTF", error))?;
        let now = stage.loads_at(frame.time);
        for (load, arrow) in all.iter().zip(&mut loads) {
            let [at, force] = push(model, &kinematics, load).unwrap_or_default();
            arrow.at.push(at);
            arrow.along.push(if now.contains(load) { along(force, SHORTEST_LOAD) } else { Vector3::zeros() });
        }
    }
    let is_seen = |arrow: &Arrow| arrow.along.iter().any(|along| *along != Vector3::zeros());
    Ok(contacts.into_iter().chain(loads).filter(is_seen).collect())
}
