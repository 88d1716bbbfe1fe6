//! Reads the first animation of a glTF 2.0 file (`.glb`, or `.gltf` with its buffers inside) as a rig: nodes that move or belong to a skin, and those that
//! carry them; without a skin also those that are carried.
//!
//! A node rests where the file has it (Khronos Group, glTF 2.0 Specification, section 3.5). Keys are sampled at even times: linear ones along the
//! shortest turn, steps, and cubic splines (section C).

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::gltf_data::{Document, GltfError};
use super::json::Json;
use super::{Channel, Rig, RigJoint};
use crate::motion::{MOST_NAME_BYTES, MOST_NUMBERS};
use crate::xml::shorten;

/// Most nodes of a file (assumed: rigs with fingers and a face have some hundred).
const MOST_NODES: usize = 10_000;
/// Numbers of frames that a file may have beside one for each of its bytes: between keys far apart lie many frames
/// (assumed: those of some minutes of a body).
const MORE_NUMBERS_OF_FRAMES: usize = 3_000_000;
/// Least and greatest time between samples, s: 240 and 10 a second (assumed).
const SAMPLE_TIMES: (f64, f64) = (1.0 / 240.0, 0.1);
/// Scales of a node along its axes that differ by less, as a share, are one.
const SAME_SCALE: f64 = 0.01;
/// Channels of a joint: its place, and its turns about z, y, x.
const CHANNELS: [Channel; 6] =
    [Channel::Place(0), Channel::Place(1), Channel::Place(2), Channel::Turn(2), Channel::Turn(1), Channel::Turn(0)];

/// A node at rest.
struct Node {
    name: String,
    parent: Option<usize>,
    place: Vector3<f64>,
    turn: UnitQuaternion<f64>,
    scale: f64,
    /// The node moves, or belongs to a skin, or carries such a node.
    kept: bool,
}

/// Keys of a node's place or turn.
struct Keys {
    node: usize,
    turns: bool,
    times: Vec<f64>,
    values: Vec<f64>,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Linear,
    Step,
    Cubic,
}

/// Reads a rig and its first animation. `name` stands in errors and warnings only.
///
/// # Errors
/// [`GltfError`] says what is wrong, where in the file, and what would be accepted.
pub fn read_gltf(name: &str, bytes: &[u8]) -> Result<Rig, GltfError> {
    let named = |error: GltfError| GltfError { file: name.to_owned(), ..error };
    let mut rig = rig(bytes).map_err(named)?;
    for warning in &mut rig.warnings {
        *warning = format!("{name}: {warning}");
    }
    Ok(rig)
}

fn rig(bytes: &[u8]) -> Result<Rig, GltfError> {
    let document = Document::read(bytes)?;
    let mut warnings = vec![];
    let (mut nodes, order) = nodes(&document, &mut warnings)?;
    let keys = keys(&document, nodes.len(), &mut warnings)?;
    let joints = document.list("skins").iter().flat_map(|skin| skin["joints"].as_list().into_iter().flatten());
    let joints: Vec<usize> = joints.filter_map(|joint| Some(joint.as_u64()? as usize)).collect();
    let skinless = joints.is_empty();
    drop(document);
    for first in keys.iter().map(|keys| keys.node).chain(joints) {
        let mut next = Some(first);
        while let Some(node) = next.and_then(|node| nodes.get_mut(node)).filter(|node| !node.kept) {
            node.kept = true;
            next = node.parent;
        }
    }
    if skinless {
        // Only its skin tells which nodes at rest are joints.
        for &node in &order {
            let carried = nodes[node].parent.is_some_and(|parent| nodes[parent].kept);
            nodes[node].kept |= carried;
        }
    }
    let (start, frame_time, count) = sampling(&keys);
    let kept: Vec<usize> = order.into_iter().filter(|&node| nodes[node].kept).collect();
    let frames = empty_frames(count, kept.len(), bytes.len())?;
    // A node's place in the axes of the one that carries it, in units of the scene.
    let mut scales = vec![1.0; nodes.len()];
    let mut rig = Rig { joints: vec![], ends: vec![], frame_time, frames, warnings };
    let mut index = vec![0; nodes.len()];
    for (number, &of) in kept.iter().enumerate() {
        let node = &nodes[of];
        let above = node.parent.map_or(1.0, |parent| scales[parent]);
        scales[of] = above * node.scale;
        index[of] = number;
        let own = |turns: bool| keys.iter().find(|keys| keys.node == of && keys.turns == turns);
        let (places, turns) = (own(false), own(true));
        for (frame, row) in rig.frames.iter_mut().enumerate() {
            let time = start + frame_time * frame as f64;
            let place = places.map_or(node.place, |keys| Vector3::from_column_slice(&keys.at(time)));
            let turn = turns.map_or(node.turn, |keys| quaternion(&keys.at(time)).unwrap_or(node.turn));
            let (x, y, z) = turn.euler_angles();
            row.extend((above * place).iter().chain(&[z, y, x]));
        }
        rig.joints.push(RigJoint {
            name: node.name.clone(),
            parent: node.parent.map(|parent| index[parent]),
            offset: above * node.place,
            rest: node.turn,
            channels: CHANNELS.to_vec(),
            first: CHANNELS.len() * number,
        });
    }
    Ok(rig)
}

/// The frames of an animation, each empty with room for the numbers of all joints. `bytes`: size of the file.
fn empty_frames(count: usize, joints: usize, bytes: usize) -> Result<Vec<Vec<f64>>, GltfError> {
    let most = bytes.saturating_add(MORE_NUMBERS_OF_FRAMES).min(MOST_NUMBERS);
    let channels = CHANNELS.len() * joints;
    if count.saturating_mul(channels) > most {
        let message = format!("{count} frames of {joints} joints have more than {most} numbers");
        return Err(GltfError::at("/animations/0", message, "a shorter animation is accepted"));
    }
    Ok((0..count).map(|_| Vec::with_capacity(channels)).collect())
}

/// All nodes, and their numbers with parents before children.
fn nodes(document: &Document<'_>, warnings: &mut Vec<String>) -> Result<(Vec<Node>, Vec<usize>), GltfError> {
    let list = document.list("nodes");
    if list.is_empty() || list.len() > MOST_NODES {
        let message = format!("the file has {} nodes", list.len());
        return Err(GltfError::at("/nodes", message, format!("1 to {MOST_NODES} are accepted")));
    }
    let mut nodes: Vec<Node> = vec![];
    for (i, node) in list.iter().enumerate() {
        let name = node["name"].as_str().map_or_else(|| format!("node {i}"), str::to_owned);
        if name.len() > MOST_NAME_BYTES {
            let accepted = format!("{MOST_NAME_BYTES} bytes at most are accepted");
            return Err(GltfError::at(format!("/nodes/{i}/name"), "the name is too long", accepted));
        }
        let (place, turn, scales) = rest(node).ok_or_else(|| {
            let message = format!("the node `{}` has no place, turn and scale that are finite", shorten(&name));
            GltfError::at(format!("/nodes/{i}"), message, "translation, rotation and scale, or a matrix, are accepted")
        })?;
        if scales.max() - scales.min() > SAME_SCALE * scales.max() {
            warnings.push(format!(
                "the scale of the node `{}` is not the same along its axes; its mean is taken",
                shorten(&name)
            ));
        }
        nodes.push(Node { name, parent: None, place, turn, scale: scales.mean(), kept: false });
    }
    let children = |i: usize| list[i]["children"].as_list().into_iter().flatten().filter_map(Json::as_u64);
    for i in 0..list.len() {
        for child in children(i) {
            let free = nodes.get_mut(child as usize).filter(|node| node.parent.is_none());
            let node = free.ok_or_else(|| {
                let message = format!("the child {child} is not there, or has two parents");
                GltfError::at(format!("/nodes/{i}/children"), message, "a tree of nodes is accepted")
            })?;
            node.parent = Some(i);
        }
    }
    let mut order: Vec<usize> = (0..nodes.len()).filter(|&i| nodes[i].parent.is_none()).collect();
    let mut next = 0;
    while let Some(&node) = order.get(next) {
        order.extend(children(node).map(|child| child as usize));
        next += 1;
    }
    if order.len() < nodes.len() {
        return Err(GltfError::at("/nodes", "some nodes carry each other", "a tree of nodes is accepted"));
    }
    Ok((nodes, order))
}

/// Place, turn and scale of a node; `None` where they are no numbers.
fn rest(node: &Json) -> Option<(Vector3<f64>, UnitQuaternion<f64>, Vector3<f64>)> {
    let numbers = |name: &str, usual: &[f64]| -> Option<Vec<f64>> {
        let Some(list) = node[name].as_list() else { return Some(usual.to_vec()) };
        let list: Vec<f64> = list.iter().map(Json::as_f64).collect::<Option<_>>()?;
        let in_order = list.len() == usual.len() && list.iter().all(|x| x.abs() <= contrapposto::model::LARGEST);
        in_order.then_some(list)
    };
    if node["matrix"].as_list().is_some() {
        let m = numbers("matrix", &[0.0; 16])?;
        let columns = [0, 4, 8].map(|at| Vector3::new(m[at], m[at + 1], m[at + 2]));
        let scales = Vector3::from(columns.each_ref().map(|column| column.norm()));
        let axes: Vec<Vector3<f64>> =
            columns.iter().map(|column| column.try_normalize(1e-12)).collect::<Option<_>>()?;
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&Matrix3::from_columns(&axes)));
        return Some((Vector3::new(m[12], m[13], m[14]), turn, scales));
    }
    let (place, scale) = (numbers("translation", &[0.0; 3])?, numbers("scale", &[1.0; 3])?);
    let turn = quaternion(&numbers("rotation", &[0.0, 0.0, 0.0, 1.0])?)?;
    let scale = Vector3::from_vec(scale).abs();
    (scale.min() > 0.0).then(|| (Vector3::from_vec(place), turn, scale))
}

/// The turn of four numbers x, y, z, w; `None` where they are all 0.
fn quaternion(xyzw: &[f64]) -> Option<UnitQuaternion<f64>> {
    UnitQuaternion::try_new(Quaternion::new(xyzw[3], xyzw[0], xyzw[1], xyzw[2]), 1e-9)
}

/// The keys of places and turns of the first animation.
fn keys(document: &Document<'_>, nodes: usize, warnings: &mut Vec<String>) -> Result<Vec<Keys>, GltfError> {
    let Some(animation) = document.list("animations").first() else {
        return Err(GltfError::at(
            "/animations",
            "the file has no animation",
            "a file with an animated skeleton is accepted",
        ));
    };
    let count = document.list("animations").len();
    if count > 1 {
        let name = shorten(animation["name"].as_str().unwrap_or_default());
        warnings.push(format!("the file has {count} animations; the first one, `{name}`, is read"));
    }
    let (mut all, mut total) = (vec![], 0);
    for (i, channel) in animation["channels"].as_list().into_iter().flatten().enumerate() {
        let at = format!("/animations/0/channels/{i}");
        let turns = match channel["target"]["path"].as_str() {
            Some("rotation") => true,
            Some("translation") => false,
            _ => continue,
        };
        let Some(node) = channel["target"]["node"].as_u64() else { continue };
        let samplers = animation["samplers"].as_list().unwrap_or_default();
        let sampler = channel["sampler"].as_u64().and_then(|sampler| samplers.get(sampler as usize));
        let sampler = sampler.filter(|_| (node as usize) < nodes).ok_or_else(|| {
            GltfError::at(
                &at,
                "names a node or a sampler that is not there",
                "a node and a sampler of the file are accepted",
            )
        })?;
        let kind = match sampler["interpolation"].as_str() {
            None | Some("LINEAR") => Kind::Linear,
            Some("STEP") => Kind::Step,
            Some("CUBICSPLINE") => Kind::Cubic,
            Some(other) => {
                let message = format!("the interpolation is `{}`", shorten(other));
                return Err(GltfError::at(&at, message, "LINEAR, STEP and CUBICSPLINE are accepted"));
            }
        };
        let (times, width) = (document.numbers(&sampler["input"], 1, &at)?, if turns { 4 } else { 3 });
        let values = document.numbers(&sampler["output"], width, &at)?;
        let needed = times.len() * width * if kind == Kind::Cubic { 3 } else { 1 };
        if times.is_empty() || values.len() != needed || !times.is_sorted() {
            let message = format!("{} times and {} numbers", times.len(), values.len());
            return Err(GltfError::at(&at, message, "times that rise, and a value for each, are accepted"));
        }
        total += times.len() + values.len();
        if total > document.most_numbers {
            let message = format!("the animation has more than {} numbers", document.most_numbers);
            return Err(GltfError::at(&at, message, "a shorter animation is accepted"));
        }
        all.push(Keys { node: node as usize, turns, times, values, kind });
    }
    if all.is_empty() {
        return Err(GltfError::at("/animations/0", "no node moves", "an animated skeleton is accepted"));
    }
    Ok(all)
}

/// First time, time between samples and number of samples: those of the keys with most of them.
fn sampling(keys: &[Keys]) -> (f64, f64, usize) {
    let ends = |of: fn(&Keys) -> f64, pick: fn(f64, f64) -> f64| keys.iter().map(of).reduce(pick).unwrap_or(0.0);
    let start = ends(|keys| keys.times[0], f64::min);
    let end = ends(|keys| keys.times[keys.times.len() - 1], f64::max);
    let most = keys.iter().max_by_key(|keys| keys.times.len());
    let mut steps: Vec<f64> =
        most.iter().flat_map(|keys| keys.times.windows(2).map(|pair| pair[1] - pair[0])).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(SAMPLE_TIMES.1).clamp(SAMPLE_TIMES.0, SAMPLE_TIMES.1);
    let count = ((end - start) / step).round() as usize + 1;
    // Even steps that end with the animation.
    let step = if count > 1 { (end - start) / (count - 1) as f64 } else { step };
    (start, step.clamp(SAMPLE_TIMES.0, SAMPLE_TIMES.1), count)
}

impl Keys {
    /// The value at a time, s.
    fn at(&self, time: f64) -> Vec<f64> {
        let width = if self.turns { 4 } else { 3 };
        let after = self.times.partition_point(|key| *key <= time);
        let (a, b) = (after.saturating_sub(1), after.min(self.times.len() - 1));
        // Of a cubic spline the value stands between two slopes.
        let (size, middle) = if self.kind == Kind::Cubic { (3 * width, width) } else { (width, 0) };
        let part = |key: usize, from: usize| &self.values[key * size + from..key * size + from + width];
        let span = self.times[b] - self.times[a];
        if self.kind == Kind::Step || a == b || span <= 0.0 || time <= self.times[a] {
            return part(a, middle).to_vec();
        }
        let t = (time - self.times[a]) / span;
        let (from, to) = (part(a, middle), part(b, middle));
        match (self.kind, self.turns) {
            (Kind::Cubic, _) => {
                let (out, into) = (part(a, 2 * width), part(b, 0));
                let (t2, t3) = (t * t, t * t * t);
                let value = |i: usize| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * from[i]
                        + span * (t3 - 2.0 * t2 + t) * out[i]
                        + (3.0 * t2 - 2.0 * t3) * to[i]
                        + span * (t3 - t2) * into[i]
                };
                (0..width).map(value).collect()
            }
            (_, true) => {
                let Some((p, q)) = quaternion(from).zip(quaternion(to)) else { return from.to_vec() };
                let between = p.try_slerp(&q, t, 1e-9).unwrap_or(q);
                between.coords.iter().copied().collect()
            }
            (_, false) => from.iter().zip(to).map(|(from, to)| from + t * (to - from)).collect(),
        }
    }
}
