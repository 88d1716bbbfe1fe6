//! Writes a motion as binary glTF 2.0: rigid segments in a tree of nodes, and one animation.

use std::collections::BTreeMap;

use contrapposto::model::Placement;
use nalgebra::UnitQuaternion;
use serde_json::{Value, json};

use super::buffer::Buffer;
use super::track::Track;
use super::{AnimationError, Clip, Solid, hull};

/// Placement of a node in its parent, over time.
struct Course {
    place: Track<3>,
    /// x, y, z, w.
    turn: Track<4>,
}

/// Writes a motion as `.glb`.
///
/// The first node has the body's name and turns ground axes to those of glTF (y up, z ahead, x left; m, s). Below it every segment is
/// a node of its name at the centre of its joint, with the segment's axes, and carries its `solids` (one list a segment, in its
/// frame) as closed meshes of one grey material; none is fine. A segment that moves against its parent has keys with linear
/// interpolation, one a posture; keys between equal neighbours are left out, and so is the animation where nothing moves at all. The
/// nodes stand as in the first posture.
///
/// Numbers are `f32`: joint centres of a body within some metres of the origin are right to about a micrometre.
///
/// # Errors
/// [`AnimationError`] says which time or posture does not fit.
pub fn glb(clip: &Clip<'_>, solids: &[Vec<Solid>]) -> Result<Vec<u8>, AnimationError> {
    let segments = clip.model.segments();
    let new = || Course { place: Track::new(), turn: Track::new() };
    let mut courses: Vec<Course> = segments.iter().map(|_| new()).collect();
    let mut times: Vec<f32> = vec![];
    clip.play(|index, frames| {
        // Times so near each other that they are one in f32 would be refused by every reader.
        let time = (clip.times[index] - clip.times[0]) as f32;
        if times.last().is_some_and(|last| *last >= time) {
            return;
        }
        for ((segment, course), frame) in segments.iter().zip(&mut courses).zip(frames) {
            let parent = segment.parent.map_or_else(Placement::identity, |parent| frames[parent]);
            let local = parent.inv_mul(frame);
            course.place.push(times.len(), local.translation.vector.into());
            course.turn.push_nearer(times.len(), local.rotation.coords.into());
        }
        times.push(time);
    })?;
    let mut buffer = Buffer::default();
    let meshes = meshes(clip, solids, &mut buffer);
    let nodes = nodes(clip, &courses, &meshes);
    let animation = animation(clip, &courses, &times, &mut buffer);
    let mut file = json!({
        "asset": { "version": "2.0", "generator": concat!("contrapposto ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes,
    });
    let meshes: Vec<Value> = meshes.into_iter().flatten().collect();
    if !meshes.is_empty() {
        let color = [0.5, 0.5, 0.52, 1.0];
        let look = json!({ "baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.7 });
        file["materials"] = json!([{ "name": "body", "pbrMetallicRoughness": look }]);
        file["meshes"] = meshes.into();
    }
    if let Some(animation) = animation {
        file["animations"] = json!([animation]);
    }
    if !buffer.bytes.is_empty() {
        file["buffers"] = json!([{ "byteLength": buffer.bytes.len() }]);
        file["bufferViews"] = buffer.views.into();
        file["accessors"] = buffer.accessors.into();
    }
    Ok(packed(&file.to_string(), &buffer.bytes))
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

/// One channel for everything that moves; `None` where nothing does.
fn animation(clip: &Clip<'_>, courses: &[Course], times: &[f32], buffer: &mut Buffer) -> Option<Value> {
    let (mut channels, mut samplers) = (vec![], vec![]);
    let mut inputs: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for (s, course) in courses.iter().enumerate() {
        let paths = [("translation", "VEC3", 3, course.place.moving()), ("rotation", "VEC4", 4, course.turn.moving())];
        for (path, kind, width, moving) in paths {
            let Some((keys, values)) = moving else { continue };
            let input = *inputs.entry(keys).or_insert_with_key(|keys| {
                let times: Vec<f32> = keys.iter().map(|&key| times[key]).collect();
                buffer.course("SCALAR", 1, &times)
            });
            let output = buffer.course(kind, width, &values);
            channels.push(json!({ "sampler": samplers.len(), "target": { "node": s + 1, "path": path } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
    }
    let name = if clip.title.is_empty() { "motion" } else { clip.title };
    (!channels.is_empty()).then(|| json!({ "name": name, "channels": channels, "samplers": samplers }))
}

/// Header, JSON and binary chunk, each padded to four bytes.
fn packed(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut file = vec![];
    let word = |bytes: &mut Vec<u8>, value: usize| bytes.extend((value as u32).to_le_bytes());
    let padded = json.len().next_multiple_of(4);
    let body = if binary.is_empty() { 0 } else { 8 + binary.len() };
    file.extend(b"glTF");
    word(&mut file, 2);
    word(&mut file, 12 + 8 + padded + body);
    word(&mut file, padded);
    file.extend(b"JSON");
    file.extend(json.as_bytes());
    file.resize(20 + padded, b' ');
    if !binary.is_empty() {
        word(&mut file, binary.len());
        file.extend(b"BIN\0");
        file.extend(binary);
    }
    file
}
