//! Bodies for other programs: `motion.glb`, `motion.bvh`, `model.osim`, and the postures of other commands as glTF and BVH.

use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::Scenario;
use contrapposto_formats::animation::{Clip, Skin, bvh, glb_with_tubes, skinned_glb, solids};
use contrapposto_formats::{Thing, write};

use super::arrows::arrows;
use super::axes::directions;
use super::frame::Frame;
use super::muscle_work::MusclesAtWork;
use super::recording::Recording;
use super::stage::Stage;
use crate::fail::Fail;
use crate::output::print_note;

/// Name and content of every file of a run; one that a body cannot be written as is missing, and standard error says why.
pub(crate) fn bodies(
    (scenario, things): (&Scenario, &[Thing]),
    (recording, muscles): (&Recording, Option<&MusclesAtWork<'_>>),
    wooden: bool,
) -> Result<Vec<(&'static str, Vec<u8>)>, Fail> {
    let model = &scenario.model;
    let postures: Vec<&[f64]> = recording.rows().map(|row| row.posture).collect();
    let stage = Stage::of_run(scenario, things);
    let arrows = arrows(model, &stage, recording.rows().map(|row| Frame::of_row(model, row)))?;
    let clip = Clip { things, arrows: &arrows, ..clip(model, &scenario.title, recording.times(), &postures) };
    let mut files = vec![
        ("motion.glb", gltf("motion.glb", &clip, muscles, wooden)?),
        ("motion.bvh", bvh_text("motion.bvh", &clip)?),
    ];
    match write::osim(model) {
        Ok(written) => files.push(("model.osim", written.text.into_bytes())),
        Err(error) => print_note("note", &format!("no model.osim: {error}")),
    }
    Ok(files)
}

/// Postures among the things of a stage, one after another, each for a second: glTF under the first name, BVH under the second.
pub(crate) fn steps(
    [gltf_name, bvh_name]: [&str; 2],
    (model, stage): (&Model, &Stage<'_>),
    title: &str,
    (frames, muscles): (&[Frame], Option<&MusclesAtWork<'_>>),
    wooden: bool,
) -> Result<[Vec<u8>; 2], Fail> {
    let postures: Vec<&[f64]> = frames.iter().map(|frame| frame.posture.as_slice()).collect();
    let times: Vec<f64> = (0..postures.len()).map(|i| i as f64).collect();
    let arrows = arrows(model, stage, frames.iter().cloned())?;
    let clip = Clip { steps: true, things: stage.things, arrows: &arrows, ..clip(model, title, &times, &postures) };
    Ok([gltf(gltf_name, &clip, muscles, wooden)?, bvh_text(bvh_name, &clip)?])
}

/// A recorded motion as glTF. Of frames with one time the first is shown.
pub(crate) fn motion(
    name: &str,
    model: &Model,
    title: &str,
    (motion, muscles): (&[(f64, Posture)], Option<&MusclesAtWork<'_>>),
    wooden: bool,
) -> Result<Vec<u8>, Fail> {
    let mut shown: Vec<&(f64, Posture)> = motion.iter().collect();
    shown.dedup_by_key(|frame| frame.0);
    let times: Vec<f64> = shown.iter().map(|frame| frame.0).collect();
    let postures: Vec<&[f64]> = shown.iter().map(|frame| frame.1.values()).collect();
    gltf(name, &clip(model, title, &times, &postures), muscles, wooden)
}

fn clip<'a>(model: &'a Model, title: &'a str, times: &'a [f64], postures: &'a [&'a [f64]]) -> Clip<'a> {
    let [right, ahead, up] = directions(model);
    Clip { model, title, directions: [-right, up, ahead], times, postures, steps: false, things: &[], arrows: &[] }
}

/// With a skin, where the body has one and none of wood is asked for.
fn gltf(name: &str, clip: &Clip<'_>, muscles: Option<&MusclesAtWork<'_>>, wooden: bool) -> Result<Vec<u8>, Fail> {
    let skin = if wooden { None } else { Skin::of(clip.model) };
    let written = match skin {
        Some(skin) => skinned_glb(clip, &skin),
        None => {
            let solids: Vec<_> = (0..clip.model.segments().len()).map(|s| solids(clip.model, s)).collect();
            glb_with_tubes(clip, &solids, &muscles.map_or_else(Vec::new, MusclesAtWork::tubes))
        }
    };
    written.map_err(|error| Fail::job(name, error))
}

fn bvh_text(name: &str, clip: &Clip<'_>) -> Result<Vec<u8>, Fail> {
    bvh(clip).map(String::into_bytes).map_err(|error| Fail::job(name, error))
}
