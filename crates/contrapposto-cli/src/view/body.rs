//! A body at one moment as a drawing shows it: the same solid parts, loads and axes as on the page.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::Contact;
use contrapposto_formats::animation::{joined_by, solids};
use contrapposto_plot::{BodyForce, BodyPart, BodyPosture, BodyThing};
use nalgebra::Point3;

use super::axes;
use super::axes::pelvis_list;
use super::frame::Frame;
use super::held::Held;
use super::scene::hazard::hazard;
use super::selection::shown;
use super::stage::{Stage, place, push};
use super::surfaces::surroundings;
use super::words::{percent, plain};
use crate::fail::Fail;

/// Most supports whose share is listed.
const MOST_SHARES: usize = 4;

/// The parts of a body in a posture, with the loads and hazards of its frame where it is known.
pub(crate) fn parts(model: &Model, posture: &[f64], frame: Option<&Frame>) -> Result<Vec<BodyPart>, Fail> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(posture.to_vec())).map_err(|error| Fail::job("picture", error))?;
    let (shown, turn) = (shown(model), axes::turn(model));
    let mut parts = vec![];
    for s in 0..model.segments().len() {
        let place = kinematics.placement(model, s);
        let moved_by = joined_by(model, s);
        let moves = shown.iter().filter(|i| moved_by.contains(i) && model.coordinates()[**i].groups.is_some());
        let load = frame.and_then(|frame| moves.map(|&i| frame.load[i]).reduce(f64::max));
        let hazard = frame.is_some_and(|frame| moved_by.clone().any(|i| hazard(model, frame, i).is_some()));
        for balls in solids(model, s) {
            let ball = |[x, y, z, r]: [f64; 4]| {
                let [x, y, z] = turn.point((place * Point3::new(x, y, z)).coords);
                [x, y, z, r]
            };
            parts.push(BodyPart { balls: balls.into_iter().map(ball).collect(), load, hazard });
        }
    }
    Ok(parts)
}

/// The body of a frame among the things of its stage: parts, contact forces, centre of mass, ground, surfaces, things, loads. The
/// relative loads of muscles are shown where they are known.
pub(crate) fn body(model: &Model, stage: &Stage<'_>, frame: &Frame) -> Result<BodyPosture, Fail> {
    let turn = axes::turn(model);
    let standing = frame.standing.as_ref();
    let force = |contact: &Contact| {
        let at = contact.center_of_pressure?;
        Some(BodyForce { at: turn.point(at), force: turn.point(contact.force) })
    };
    Ok(BodyPosture {
        parts: parts(model, &frame.posture, (!frame.load.is_empty()).then_some(frame))?,
        forces: standing.iter().flat_map(|standing| &standing.contacts).filter_map(force).collect(),
        center_of_mass: standing
            .filter(|_| !stage.supports.is_empty())
            .map(|standing| turn.point(standing.center_of_mass)),
        ..around(model, stage, frame)?
    })
}

/// A body that is held still; where the supports cannot hold it, its torques and forces are not known.
pub(crate) fn held_body(model: &Model, stage: &Stage<'_>, held: &Held) -> Result<BodyPosture, Fail> {
    let frame = &held.frame;
    match held.missing {
        None => body(model, stage, frame),
        Some(_) => Ok(BodyPosture { parts: parts(model, &frame.posture, None)?, ..around(model, stage, frame)? }),
    }
}

/// Ground, surfaces, things and loads of a frame.
fn around(model: &Model, stage: &Stage<'_>, frame: &Frame) -> Result<BodyPosture, Fail> {
    let turn = axes::turn(model);
    let surroundings = surroundings(model, stage, &frame.posture, std::slice::from_ref(frame), &turn)?;
    let mut kinematics = Kinematics::new(model);
    let updated = kinematics.update(model, &Posture::new(frame.posture.clone()));
    updated.map_err(|error| Fail::job("picture", error))?;
    let thing = |thing: &contrapposto_formats::Thing| {
        let (place, half) = (place(model, &kinematics, thing), 0.5 * thing.size);
        let end = |i: usize, k: usize| if i & (1 << k) == 0 { -half[k] } else { half[k] };
        let corner = |i| turn.point((place * Point3::new(end(i, 0), end(i, 1), end(i, 2))).coords);
        BodyThing { label: thing.name.clone(), corners: std::array::from_fn(corner) }
    };
    let load = |[at, force]: [nalgebra::Vector3<f64>; 2]| BodyForce { at: turn.point(at), force: turn.point(force) };
    let loads = stage.loads_at(frame.time).iter().filter_map(|load| push(model, &kinematics, load));
    Ok(BodyPosture {
        ground: surroundings.ground,
        surfaces: surroundings.surfaces.into_iter().map(|surface| surface.corners).collect(),
        things: stage.things.iter().filter(|thing| thing.is_there(frame.time)).map(thing).collect(),
        loads: loads.map(load).collect(),
        ..BodyPosture::default()
    })
}

/// The few numbers that say most of how it stands: `effort 0.0590`, `left foot 15 %`, `pelvis 6.2° down to the right`.
pub(crate) fn key_numbers(model: &Model, supports: &[Support], frame: &Frame) -> Vec<String> {
    let mut numbers = vec![format!("effort {:.4}", frame.effort())];
    let share = |(support, share): (&Support, f64)| {
        format!("{} {}", plain(&model.segments()[support.segment].name), percent(share))
    };
    numbers.extend(supports.iter().zip(frame.shares()).take(MOST_SHARES).map(share));
    if let Some(list) = pelvis_list(model, &frame.posture).filter(|_| !supports.is_empty()) {
        let side = if list > 0.0 { "right" } else { "left" };
        numbers.push(if list.abs() < 0.05 {
            "pelvis level".to_owned()
        } else {
            format!("pelvis {:.1}° down to the {side}", list.abs())
        });
    }
    numbers
}
