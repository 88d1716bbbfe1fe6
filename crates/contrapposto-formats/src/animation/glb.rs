//! Writes a motion as binary glTF 2.0: rigid segments in a tree of nodes, and one animation.

use contrapposto::model::Placement;
use nalgebra::UnitQuaternion;
use serde_json::{Value, json};

use super::buffer::{Buffer, packed};
use super::course::{Course, animation, courses};
use super::scenery::Around;
use super::tubes::{Tube, TubeMesh, tube_mesh};
use super::{AnimationError, Clip, Solid, hull};

/// Opacity of solids about tubes.
const GLASS: f64 = 0.25;

/// Writes a motion as `.glb`.
///
/// The first node has the body's name and turns ground axes to those of glTF (y up, z ahead, x left; m, s). Below it every segment is
/// a node of its name at the centre of its joint, with the segment's axes, and carries its `solids` (one list a segment, in its
/// frame) as closed meshes of one grey material; none is fine. A segment that moves against its parent has keys with linear
/// interpolation, one a posture; keys between equal neighbours are left out, and so is the animation where nothing moves at all. The
/// nodes stand as in the first posture. Things and arrows of the clip are nodes below the first one, too, with boxes and arrows as meshes.
///
/// Numbers are `f32`: joint centres of a body within some metres of the origin are right to about a micrometre.
///
/// # Errors
/// [`AnimationError`] says which time or posture does not fit.
pub fn glb(clip: &Clip<'_>, solids: &[Vec<Solid>]) -> Result<Vec<u8>, AnimationError> {
    glb_with_tubes(clip, solids, &[])
}

/// Writes a motion as [`glb`] does, with tubes along lines that segments carry, such as muscles: one mesh, which a skin fixes to the nodes of
/// the segments, beside the body's node. The solids about them are transparent.
///
/// # Errors
/// As [`glb`].
pub fn glb_with_tubes(clip: &Clip<'_>, solids: &[Vec<Solid>], tubes: &[Tube]) -> Result<Vec<u8>, AnimationError> {
    let segments = clip.model.segments();
    let around = Around::of(clip);
    let count = segments.len() + around.count();
    let mut first: Option<Vec<Placement>> = None;
    let (times, courses) = courses(clip, count, |index, frames| {
        first.get_or_insert_with(|| frames.to_vec());
        let in_parent = |(segment, frame): (&contrapposto::model::Segment, &Placement)| {
            segment.parent.map_or_else(|| *frame, |parent| frames[parent].inv_mul(frame))
        };
        let body = segments.iter().zip(frames).map(in_parent).map(|local| (local, 1.0));
        body.chain(around.places(index, frames)).collect()
    })?;
    let (courses, beside) = courses.split_at(segments.len());
    let mut buffer = Buffer::default();
    let meshes = meshes(clip, solids, &mut buffer);
    let has_body = meshes.iter().any(Option::is_some);
    let mut nodes = nodes(clip, courses, &meshes);
    let mut meshes: Vec<Value> = meshes.into_iter().flatten().collect();
    let mut channels: Vec<_> = courses.iter().enumerate().map(|(s, course)| (s + 1, course.moving())).collect();
    let material_of_tubes = usize::from(has_body);
    let tubes = first.and_then(|frames| tubes_in(clip, &frames, tubes, material_of_tubes, &mut buffer));
    let mut materials = vec![];
    if has_body {
        materials.push(material("body", [0.5, 0.5, 0.52, if tubes.is_some() { GLASS } else { 1.0 }]));
    }
    if tubes.is_some() {
        materials.push(material("muscles", [1.0; 4]));
    }
    let first = [nodes.len(), meshes.len(), materials.len()];
    let around = around.written(beside, first, &mut buffer);
    add_to_ground(&mut nodes, around.nodes);
    meshes.extend(around.meshes);
    channels.extend(around.channels);
    materials.extend(around.materials);
    let animation = animation(clip, &channels, &times, &mut buffer);
    let mut file = json!({
        "asset": { "version": "2.0", "generator": concat!("contrapposto ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
    });
    if let Some(tubes) = tubes {
        file["scenes"] = json!([{ "nodes": [0, nodes.len()] }]);
        nodes.push(json!({ "name": "muscles", "mesh": meshes.len(), "skin": 0 }));
        file["skins"] = json!([tubes.skin]);
        meshes.push(tubes.mesh);
    }
    if !meshes.is_empty() {
        file["materials"] = materials.into();
        file["meshes"] = meshes.into();
    }
    file["nodes"] = nodes.into();
    if let Some(animation) = animation {
        file["animations"] = json!([animation]);
    }
    Ok(packed(file, buffer))
}

/// Adds nodes below the first one.
fn add_to_ground(nodes: &mut Vec<Value>, more: Vec<Value>) {
    let numbers = (nodes.len()..nodes.len() + more.len()).map(Value::from);
    if !more.is_empty() {
        let known = nodes[0]["children"].as_array().cloned().unwrap_or_default();
        nodes[0]["children"] = known.into_iter().chain(numbers).collect();
    }
    nodes.extend(more);
}

/// The mesh of tubes, if there are some, in the posture of these joint frames.
fn tubes_in(
    clip: &Clip<'_>,
    frames: &[Placement],
    tubes: &[Tube],
    material: usize,
    buffer: &mut Buffer,
) -> Option<TubeMesh> {
    let own = |(frame, segment): (&Placement, &contrapposto::model::Segment)| {
        frame * Placement::from_parts(segment.in_segment.translation, UnitQuaternion::identity()).inverse()
    };
    let own: Vec<Placement> = frames.iter().zip(clip.model.segments()).map(own).collect();
    tube_mesh(tubes, (frames, &own), &clip.drawn(), material, buffer)
}

/// A look without metal; one that is not opaque is drawn as glass.
fn material(name: &str, color: [f64; 4]) -> Value {
    let look = json!({ "baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.7 });
    let mut material = json!({ "name": name, "pbrMetallicRoughness": look });
    if color[3] < 1.0 {
        material["alphaMode"] = json!("BLEND");
    }
    material
}

/// Of each segment its mesh, if it has solids.
fn meshes(clip: &Clip<'_>, solids: &[Vec<Solid>], buffer: &mut Buffer) -> Vec<Option<Value>> {
    let mut triangles = None;
    let mut mesh = |(s, segment): (usize, &contrapposto::model::Segment)| {
        let solids = solids.get(s).filter(|solids| !solids.is_empty())?;
        let origin = segment.in_segment.translation.vector.into();
        let primitive = |solid: &Solid| {
            let indices = *triangles.get_or_insert_with(|| buffer.triangles(&hull::triangles()));
            let [position, normal] = buffer.vertices(&hull::corners(solid, origin));
            json!({ "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices, "material": 0 })
        };
        let primitives: Vec<Value> = solids.iter().map(primitive).collect();
        Some(json!({ "name": segment.name, "primitives": primitives }))
    };
    clip.model.segments().iter().enumerate().map(&mut mesh).collect()
}

/// The turned ground, then all segments.
fn nodes(clip: &Clip<'_>, courses: &[Course], meshes: &[Option<Value>]) -> Vec<Value> {
    let segments = clip.model.segments();
    let mut children: Vec<Vec<usize>> = vec![vec![]; segments.len() + 1];
    for (s, segment) in segments.iter().enumerate() {
        children[segment.parent.map_or(0, |parent| parent + 1)].push(s + 1);
    }
    let turn = UnitQuaternion::from_rotation_matrix(&clip.drawn()).coords.map(|v| v as f32);
    let name = if clip.model.name().is_empty() { "body" } else { clip.model.name() };
    let mut nodes = vec![json!({ "name": name, "rotation": turn.as_slice() })];
    let mut used = 0;
    for ((segment, course), mesh) in segments.iter().zip(courses).zip(meshes) {
        let mut node =
            json!({ "name": segment.name, "translation": course.place.first(), "rotation": course.turn.first() });
        if mesh.is_some() {
            node["mesh"] = json!(used);
            used += 1;
        }
        nodes.push(node);
    }
    for (node, children) in nodes.iter_mut().zip(children).filter(|(_, children)| !children.is_empty()) {
        node["children"] = json!(children);
    }
    nodes
}
