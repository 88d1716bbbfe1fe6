//! Writes a motion of a body with a skin as binary glTF 2.0: one mesh, a skeleton in T-pose, and one animation.

use contrapposto::model::Placement;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::buffer::{Buffer, packed};
use super::course::{animation, courses};
use super::scenery::Around;
use super::{AnimationError, Clip, Skin};

/// Writes a motion as `.glb` with a skin.
///
/// Axes as those of [`super::glb`]. The skeleton is a tree of nodes below one that has the body's name. Their names are those of VRM's
/// humanoid (`hips`, `leftUpperArm`, ...); `extras.segment` is the segment at whose joint's centre a node is. Nodes stand in the
/// T-pose, the bind pose, in which no node is turned; everything else is in the animation, which is there unless all postures are the
/// T-pose. Nodes named `Twist` and `Half` turn by a part of what the next bone turns, so that limbs do not look wrung. The mesh is
/// coloured by its vertices (skin, suit, hair). Things and arrows of the clip are nodes of the scene beside the body.
///
/// # Errors
/// [`AnimationError`] says which time or posture does not fit.
pub fn skinned_glb(clip: &Clip<'_>, skin: &Skin) -> Result<Vec<u8>, AnimationError> {
    let (drawn, skeleton) = (clip.drawn(), &skin.skeleton);
    let turn = UnitQuaternion::from_rotation_matrix(&drawn);
    let rests: Vec<Vector3<f64>> = (0..skeleton.nodes.len()).map(|node| drawn * skeleton.head(node)).collect();
    let around = Around::of(clip);
    let count = skeleton.nodes.len() + around.count();
    let (times, courses) = courses(clip, count, |index, frames| {
        let in_file = |place: Placement| {
            let at = drawn * place.translation.vector;
            Placement::from_parts(at.into(), turn * place.rotation * turn.inverse())
        };
        let places: Vec<Placement> = skeleton.place(frames).into_iter().map(in_file).collect();
        let in_parent = |(node, place): (usize, &Placement)| {
            skeleton.nodes[node].parent.map_or_else(|| *place, |parent| places[parent].inv_mul(place))
        };
        let body = places.iter().enumerate().map(in_parent).map(|local| (local, 1.0));
        body.chain(around.places(index, frames).into_iter().map(|place| around_in_file(place, &drawn))).collect()
    })?;
    let (courses, beside) = courses.split_at(skeleton.nodes.len());
    let local_rest =
        |node: usize| rests[node] - skeleton.nodes[node].parent.map_or_else(Vector3::zeros, |parent| rests[parent]);
    let mut channels: Vec<_> = courses
        .iter()
        .enumerate()
        .map(|(node, course)| (node + 1, course.off(floats(local_rest(node)), [0.0, 0.0, 0.0, 1.0])))
        .collect();
    let mut buffer = Buffer::default();
    let mesh = mesh(skin, &drawn, &mut buffer);
    let bind: Vec<[f32; 16]> = rests[..skeleton.bones().len()].iter().map(back).collect();
    let bind = buffer.matrices(&bind);
    let mut nodes = nodes(clip, skin, local_rest);
    nodes.push(json!({ "name": "skin", "mesh": 0, "skin": 0 }));
    let skinned = nodes.len() - 1;
    let first = [nodes.len(), 1, 1];
    let around = around.written(beside, first, &mut buffer);
    nodes.extend(around.nodes);
    channels.extend(around.channels);
    let animation = animation(clip, &channels, &times, &mut buffer);
    let roots: Vec<usize> = std::iter::once(0).chain(skinned..nodes.len()).collect();
    let joints: Vec<usize> = (1..=skeleton.bones().len()).collect();
    let mut file = json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("contrapposto ", env!("CARGO_PKG_VERSION")),
            "copyright": "Mesh after MakeHuman hm08, CC0 1.0",
        },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "materials": std::iter::once(material()).chain(around.materials).collect::<Vec<_>>(),
        "meshes": std::iter::once(mesh).chain(around.meshes).collect::<Vec<_>>(),
        "skins": [{ "inverseBindMatrices": bind, "skeleton": 0, "joints": joints }],
    });
    if let Some(animation) = animation {
        file["animations"] = json!([animation]);
    }
    Ok(packed(file, buffer))
}

/// Placement and size of a node of the scenery in the axes of the file.
fn around_in_file((place, size): (Placement, f64), drawn: &Rotation3<f64>) -> (Placement, f64) {
    let turn = UnitQuaternion::from_rotation_matrix(drawn);
    (Placement::from_parts((drawn * place.translation.vector).into(), turn * place.rotation), size)
}

/// The material of the body, whose colours are those of its vertices.
fn material() -> Value {
    let look = json!({ "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.75 });
    json!({ "name": "body", "pbrMetallicRoughness": look })
}

fn floats(v: Vector3<f64>) -> [f32; 3] {
    // Never -0.
    [v.x, v.y, v.z].map(|v| v as f32 + 0.0)
}

/// The inverse bind matrix of an unturned node, by columns.
fn back(rest: &Vector3<f64>) -> [f32; 16] {
    let [x, y, z] = floats(-rest);
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
}

/// The skin as a mesh.
fn mesh(skin: &Skin, drawn: &Rotation3<f64>, buffer: &mut Buffer) -> Value {
    let triangles: Vec<u16> = skin.triangles.iter().flatten().copied().collect();
    let triangles = buffer.triangles(&triangles);
    let corner = |(p, n): (&Vector3<f64>, &Vector3<f64>)| [p, n].map(|v| floats(drawn * v));
    let corners: Vec<[[f32; 3]; 2]> = skin.vertices.iter().zip(&skin.normals).map(corner).collect();
    let [position, normal] = buffer.vertices(&corners);
    let color = |c: &[u8; 3]| [linear(c[0]), linear(c[1]), linear(c[2]), 255];
    let colors: Vec<[u8; 4]> = skin.colors.iter().map(color).collect();
    let attributes = json!({
        "POSITION": position,
        "NORMAL": normal,
        "COLOR_0": buffer.bytes_of_vertices(&colors, true),
        "JOINTS_0": buffer.bytes_of_vertices(&skin.bones, false),
        "WEIGHTS_0": buffer.bytes_of_vertices(&skin.weights, true),
    });
    json!({ "name": "skin", "primitives": [{ "attributes": attributes, "indices": triangles, "material": 0 }] })
}

/// A channel of sRGB as a linear one.
pub(super) fn linear(channel: u8) -> u8 {
    let c = f64::from(channel) / 255.0;
    let light = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
    (255.0 * light).round() as u8
}

/// The body, then all nodes of the skeleton, in T-pose.
fn nodes(clip: &Clip<'_>, skin: &Skin, local_rest: impl Fn(usize) -> Vector3<f64>) -> Vec<Value> {
    let skeleton = &skin.skeleton;
    let mut children: Vec<Vec<usize>> = vec![vec![]; skeleton.nodes.len() + 1];
    for node in 0..skeleton.nodes.len() {
        children[skeleton.nodes[node].parent.map_or(0, |parent| parent + 1)].push(node + 1);
    }
    let name = if clip.model.name().is_empty() { "body" } else { clip.model.name() };
    let mut nodes = vec![json!({ "name": name })];
    for node in 0..skeleton.nodes.len() {
        nodes.push(json!({
            "name": skeleton.nodes[node].name,
            "translation": floats(local_rest(node)),
            "extras": { "segment": clip.model.segments()[skeleton.nodes[node].segment].name },
        }));
    }
    for (node, children) in nodes.iter_mut().zip(children).filter(|(_, children)| !children.is_empty()) {
        node["children"] = json!(children);
    }
    nodes
}
