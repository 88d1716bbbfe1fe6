//! Writes the binary part of a glTF file: views of one buffer, and accessors that name their contents.

use serde_json::{Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Bytes with their description.
#[derive(Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Buffer {
    /// Corners of triangles; gives the accessor.
    pub(super) fn triangles(&mut self, corners: &[u16]) -> usize {
        let view = self.view(corners.iter().flat_map(|i| i.to_le_bytes()), json!({ "target": INDICES }));
        self.accessor(
            json!({ "bufferView": view, "componentType": UNSIGNED_SHORT, "count": corners.len(), "type": "SCALAR" }),
        )
    }

    /// Positions and normals, one after the other; gives their accessors.
    pub(super) fn vertices(&mut self, corners: &[[[f32; 3]; 2]]) -> [usize; 2] {
        let numbers = corners.iter().flatten().flatten();
        let view = self.view(numbers.flat_map(|v| v.to_le_bytes()), json!({ "target": VERTICES, "byteStride": 24 }));
        [0, 1].map(|part| {
            let (least, most) = bounds(3, corners.iter().flat_map(|corner| corner[part]));
            self.accessor(json!({
                "bufferView": view, "byteOffset": 12 * part, "componentType": FLOAT, "count": corners.len(), "type": "VEC3",
                "min": least, "max": most,
            }))
        })
    }

    /// Colours of vertices, RGBA, or bones of vertices and their weights (shares of 255); gives the accessor.
    pub(super) fn bytes_of_vertices(&mut self, values: &[[u8; 4]], shares: bool) -> usize {
        let view = self.view(values.iter().flatten().copied(), json!({ "target": VERTICES, "byteStride": 4 }));
        self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_BYTE, "normalized": shares, "count": values.len(), "type": "VEC4",
        }))
    }

    /// Matrices by columns; gives the accessor.
    pub(super) fn matrices(&mut self, matrices: &[[f32; 16]]) -> usize {
        let view = self.view(matrices.iter().flatten().flat_map(|v| v.to_le_bytes()), json!({}));
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": matrices.len(), "type": "MAT4" }))
    }

    /// Numbers of an animation: times (`SCALAR`), places (`VEC3`) or rotations (`VEC4`); gives the accessor.
    pub(super) fn course(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let view = self.view(values.iter().flat_map(|v| v.to_le_bytes()), json!({}));
        let (least, most) = bounds(width, values.iter().copied());
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len() / width, "type": kind, "min": least, "max": most,
        }))
    }

    fn view(&mut self, bytes: impl Iterator<Item = u8>, mut about: Value) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        about["buffer"] = json!(0);
        about["byteOffset"] = json!(start);
        about["byteLength"] = json!(self.bytes.len() - start);
        // Every view begins at a multiple of four, as floats ask.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(about);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// Least and greatest of every component.
fn bounds(width: usize, values: impl Iterator<Item = f32>) -> (Vec<f32>, Vec<f32>) {
    let (mut least, mut most) = (vec![f32::INFINITY; width], vec![f32::NEG_INFINITY; width]);
    for (i, value) in values.enumerate() {
        least[i % width] = least[i % width].min(value);
        most[i % width] = most[i % width].max(value);
    }
    (least, most)
}

/// The file: header, JSON with the buffer's description, and binary chunk, each padded to four bytes.
pub(super) fn packed(mut json: Value, buffer: Buffer) -> Vec<u8> {
    if !buffer.bytes.is_empty() {
        json["buffers"] = json!([{ "byteLength": buffer.bytes.len() }]);
        json["bufferViews"] = buffer.views.into();
        json["accessors"] = buffer.accessors.into();
    }
    let (json, binary) = (json.to_string(), buffer.bytes);
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
