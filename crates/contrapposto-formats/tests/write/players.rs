//! Readers of glTF and BVH that know the formats and nothing of our writers.

use std::collections::BTreeMap;

use nalgebra::{Matrix4, Rotation3, Vector3};
use serde_json::Value;

/// A binary glTF file.
pub(crate) struct Glb {
    pub(crate) json: Value,
    pub(crate) binary: Vec<u8>,
}

pub(crate) fn index(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

impl Glb {
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (b"glTF".as_slice(), 2, bytes.len()));
        let end = 20 + word(12);
        assert_eq!((&bytes[16..20], end % 4), (b"JSON".as_slice(), 0));
        let json: Value = serde_json::from_slice(&bytes[20..end]).unwrap();
        let mut binary = vec![];
        if end < bytes.len() {
            assert_eq!((&bytes[end + 4..end + 8], end + 8 + word(end)), (b"BIN\0".as_slice(), bytes.len()));
            binary.extend(&bytes[end + 8..]);
        }
        Self { json, binary }
    }

    /// The rows of an accessor of floats.
    pub(crate) fn floats(&self, accessor: &Value, width: usize) -> Vec<Vec<f64>> {
        let accessor = &self.json["accessors"][index(accessor)];
        assert_eq!(accessor["componentType"], 5126);
        assert_eq!(accessor["type"], ["SCALAR", "", "VEC3", "VEC4"][width - 1]);
        let view = &self.json["bufferViews"][index(&accessor["bufferView"])];
        let start = index(&view["byteOffset"]) + accessor.get("byteOffset").map_or(0, index);
        let stride = view.get("byteStride").map_or(4 * width, index);
        let float = |at: usize| f64::from(f32::from_le_bytes(self.binary[at..at + 4].try_into().unwrap()));
        let row = |i: usize| (0..width).map(|k| float(start + i * stride + 4 * k)).collect();
        (0..index(&accessor["count"])).map(row).collect()
    }

    /// Positions of all corners of a node's mesh, in its frame.
    pub(crate) fn corners(&self, node: &str) -> Vec<Vector3<f64>> {
        let node = list(&self.json["nodes"]).iter().find(|n| n["name"] == node).unwrap();
        let primitives = list(&self.json["meshes"][index(&node["mesh"])]["primitives"]);
        let rows = primitives.iter().flat_map(|p| self.floats(&p["attributes"]["POSITION"], 3));
        rows.map(|row| Vector3::new(row[0], row[1], row[2])).collect()
    }

    /// The value of a channel at a time: linear, of rotations along the shorter arc.
    fn value(&self, sampler: &Value, width: usize, time: f64) -> Vec<f64> {
        let steps = sampler["interpolation"] == "STEP";
        assert!(steps || sampler["interpolation"] == "LINEAR");
        let (times, values) = (self.floats(&sampler["input"], 1), self.floats(&sampler["output"], width));
        assert_eq!(times.len(), values.len());
        assert!(times.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        let after = times.partition_point(|t| t[0] < time).clamp(1, times.len() - 1);
        let (from, to) = (times[after - 1][0], times[after][0]);
        let part = ((time - from) / (to - from)).clamp(0.0, 1.0);
        let part = if steps { part.floor() } else { part };
        let (a, b) = (&values[after - 1], &values[after]);
        let along: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        assert!(width == 3 || steps || along >= 0.0, "the sign of a quaternion jumps");
        let mut weights = [1.0 - part, part];
        let angle = libm::acos(along.clamp(-1.0, 1.0));
        if width == 4 && angle > 1e-6 {
            weights = weights.map(|w| libm::sin(w * angle) / libm::sin(angle));
        }
        a.iter().zip(b).map(|(a, b)| weights[0] * a + weights[1] * b).collect()
    }

    /// Of every node, by name, its frame in the scene.
    pub(crate) fn frames(&self, time: f64) -> BTreeMap<String, Matrix4<f64>> {
        let nodes = list(&self.json["nodes"]);
        let own = |node: &Value, path: &str, otherwise: &[f64]| -> Vec<f64> {
            let given = node.get(path).map(list);
            given.map_or(otherwise.to_vec(), |list| list.iter().map(|v| v.as_f64().unwrap()).collect())
        };
        let mut parts: Vec<[Vec<f64>; 3]> = nodes
            .iter()
            .map(|n| {
                let turn = own(n, "rotation", &[0.0, 0.0, 0.0, 1.0]);
                [own(n, "translation", &[0.0; 3]), turn, own(n, "scale", &[1.0; 3])]
            })
            .collect();
        let animation = self.json.get("animations").map_or(&Value::Null, |animations| &animations[0]);
        for channel in list(&animation["channels"]) {
            let sampler = &animation["samplers"][index(&channel["sampler"])];
            let paths = ["translation", "rotation", "scale"];
            let part = paths.iter().position(|path| channel["target"]["path"] == *path).unwrap();
            let width = if part == 1 { 4 } else { 3 };
            parts[index(&channel["target"]["node"])][part] = self.value(sampler, width, time);
        }
        let mut frames = BTreeMap::new();
        let mut open: Vec<(usize, Matrix4<f64>)> =
            list(&self.json["scenes"][0]["nodes"]).iter().map(|n| (index(n), Matrix4::identity())).collect();
        while let Some((n, parent)) = open.pop() {
            let [t, q, scale] = &parts[n];
            let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
            #[rustfmt::skip]
            let local = Matrix4::new(
                1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y), t[0],
                2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x), t[1],
                2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y), t[2],
                0.0, 0.0, 0.0, 1.0,
            );
            let size = Vector3::new(scale[0], scale[1], scale[2]);
            let frame = parent * local * Matrix4::new_nonuniform_scaling(&size);
            frames.insert(nodes[n]["name"].as_str().unwrap().to_owned(), frame);
            open.extend(list(&nodes[n]["children"]).iter().map(|child| (index(child), frame)));
        }
        frames
    }
}

/// A BVH file.
pub(crate) struct Bvh {
    joints: Vec<Joint>,
    /// s.
    pub(crate) step: f64,
    pub(crate) rows: Vec<Vec<f64>>,
}

struct Joint {
    name: String,
    parent: Option<usize>,
    offset: Vector3<f64>,
    channels: Vec<String>,
}

impl Bvh {
    pub(crate) fn read(text: &str) -> Self {
        let mut words = text.split_whitespace();
        let mut next = || words.next().unwrap();
        assert_eq!(next(), "HIERARCHY");
        let (mut joints, mut open): (Vec<Joint>, Vec<usize>) = (vec![], vec![]);
        loop {
            match next() {
                kind @ ("ROOT" | "JOINT" | "End") => {
                    let mut name = next().to_owned();
                    if kind == "End" {
                        name = format!("{} end", joints[*open.last().unwrap()].name);
                    }
                    assert_eq!(next(), "{");
                    let joint =
                        Joint { name, parent: open.last().copied(), offset: Vector3::zeros(), channels: vec![] };
                    open.push(joints.len());
                    joints.push(joint);
                }
                "OFFSET" => {
                    let last = joints.last_mut().unwrap();
                    last.offset = Vector3::from_fn(|_, _| next().parse().unwrap());
                }
                "CHANNELS" => {
                    let count: usize = next().parse().unwrap();
                    joints.last_mut().unwrap().channels = (0..count).map(|_| next().to_owned()).collect();
                }
                "}" => {
                    open.pop();
                }
                "MOTION" => break,
                other => panic!("{other}"),
            }
        }
        assert!(open.is_empty());
        assert_eq!(next(), "Frames:");
        let frames: usize = next().parse().unwrap();
        assert_eq!([next(), next()], ["Frame", "Time:"]);
        let step = next().parse().unwrap();
        let width: usize = joints.iter().map(|joint| joint.channels.len()).sum();
        let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        assert_eq!(numbers.len(), frames * width);
        Self { joints, step, rows: numbers.chunks(width).map(<[f64]>::to_vec).collect() }
    }

    /// Of every joint and end, by name, its place; channels of places add to offsets or replace them.
    pub(crate) fn places(&self, values: &[f64], replaces: bool) -> BTreeMap<String, Vector3<f64>> {
        let mut values = values.iter();
        let mut frames: Vec<(Rotation3<f64>, Vector3<f64>)> = vec![];
        for joint in &self.joints {
            let mut own = Rotation3::identity();
            let (mut moved, mut moves) = (Vector3::zeros(), false);
            for channel in &joint.channels {
                let value = *values.next().unwrap();
                let k = "XYZ".find(&channel[..1]).unwrap();
                if channel.ends_with("position") {
                    (moved[k], moves) = (value, true);
                } else {
                    let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][k];
                    own *= Rotation3::from_axis_angle(&axis, value.to_radians());
                }
            }
            let local = if moves && replaces { moved } else { joint.offset + moved };
            let (rotation, place) = joint.parent.map_or((Rotation3::identity(), Vector3::zeros()), |p| frames[p]);
            frames.push((rotation * own, rotation * local + place));
        }
        self.joints.iter().map(|joint| joint.name.clone()).zip(frames.into_iter().map(|frame| frame.1)).collect()
    }
}
