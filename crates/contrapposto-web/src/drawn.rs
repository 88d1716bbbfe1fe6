//! Writes the posture that is shown, or the run so far, for programs that draw: glTF and BVH.

use contrapposto::model::Model;
use contrapposto_formats::Thing;
use contrapposto_formats::animation::{Clip, Skin, bvh, directions, glb, skinned_glb, solids};

use crate::error::Refusal;

/// Times, s, and postures.
pub(crate) type Motion<'a> = (Vec<f64>, Vec<&'a [f64]>);

/// The motion as glTF, with the things of its scenario: with a skin, where the body has one and its file is given.
pub(crate) fn gltf(
    (model, things): (&Model, &[Thing]),
    title: &str,
    motion: &Motion<'_>,
    skin: Option<&[u8]>,
) -> Result<Vec<u8>, Refusal> {
    let clip = Clip { things, ..clip(model, title, motion) };
    let written = match skin.and_then(|file| Skin::from_file(model, file)) {
        Some(skin) => skinned_glb(&clip, &skin),
        None => glb(&clip, &(0..model.segments().len()).map(|s| solids(model, s)).collect::<Vec<_>>()),
    };
    written.map_err(Refusal::of)
}

/// The motion as BVH.
pub(crate) fn text(model: &Model, title: &str, motion: &Motion<'_>) -> Result<String, Refusal> {
    bvh(&clip(model, title, motion)).map_err(Refusal::of)
}

fn clip<'a>(model: &'a Model, title: &'a str, (times, postures): &'a Motion<'a>) -> Clip<'a> {
    let [right, ahead, up] = directions(model);
    Clip {
        model,
        title,
        directions: [-right, up, ahead],
        times,
        postures,
        steps: times.len() == 1,
        things: &[],
        arrows: &[],
    }
}
