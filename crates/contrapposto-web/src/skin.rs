//! Fits the skin of the built-in adult, whose file the page loads apart, to the body of a session.

use contrapposto::model::Model;
use contrapposto_formats::animation::Skin;

use crate::message::SkinScene;

/// Vertices are given in this step, m.
const VERTEX_STEP: f64 = 1e-5;

/// The skin of a body from the bytes of its file; `None` of a body without one, and of bytes that are no such file.
pub(crate) fn scene(model: &Model, file: &[u8]) -> Option<SkinScene> {
    let skin = Skin::from_file(model, file)?;
    let bones = skin.skeleton.bones();
    let rounded = |x: f64| (x / VERTEX_STEP).round() * VERTEX_STEP;
    Some(SkinScene {
        vertices: skin.vertices.iter().map(|vertex| [vertex.x, vertex.y, vertex.z].map(rounded)).collect(),
        light: skin.light(),
        heads: (0..bones.len()).map(|bone| skin.skeleton.head(bone).into()).collect(),
        segments: bones.iter().map(|bone| bone.segment).collect(),
        triangles: skin.triangles,
        bones: skin.bones,
        weights: skin.weights,
    })
}
