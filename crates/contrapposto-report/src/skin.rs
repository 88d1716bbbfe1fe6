//! Writes the mesh of a skin for the page's script: lists of small whole numbers, as base64.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::Skin;

/// The mesh. Vertices are multiples of a step from the lowest corner of their box, 65,535 at most.
pub(crate) fn mesh(skin: &Skin) -> Value {
    let known = |v: &f64| if v.is_finite() { *v } else { 0.0 };
    let vertices: Vec<[f64; 3]> = skin.vertices.iter().map(|vertex| vertex.each_ref().map(known)).collect();
    let bound =
        |pick: fn(f64, f64) -> f64| [0, 1, 2].map(|k| vertices.iter().map(|v| v[k]).reduce(pick).unwrap_or(0.0));
    let (low, high) = (bound(f64::min), bound(f64::max));
    let widest = [0, 1, 2].map(|k| high[k] - low[k]).into_iter().fold(0.0, f64::max);
    let step = if widest > 0.0 { widest / f64::from(u16::MAX) } else { 1.0 };
    let numbers = vertices.iter().flat_map(|v| [0, 1, 2].map(|k| ((v[k] - low[k]) / step).round() as u16));
    let corners = skin.triangles.iter().filter(|t| t.iter().all(|&i| usize::from(i) < vertices.len())).flatten();
    let bytes = |list: &[[u8; 4]]| {
        let row = |i: usize| list.get(i).copied().unwrap_or_default();
        (0..vertices.len()).flat_map(row).collect::<Vec<u8>>()
    };
    let bones = bytes(&skin.bones).into_iter().map(|bone| if usize::from(bone) < skin.nodes.len() { bone } else { 0 });
    json!({
        "low": low,
        "step": step,
        "vertices": base64(numbers.flat_map(u16::to_le_bytes)),
        "triangles": base64(corners.flat_map(|i| i.to_le_bytes())),
        "bones": base64(bones),
        "weights": base64(bytes(&skin.weights)),
        "light": base64((0..vertices.len()).map(|i| skin.light.get(i).copied().unwrap_or(u8::MAX))),
    })
}

fn base64(bytes: impl IntoIterator<Item = u8>) -> String {
    BASE64_STANDARD.encode(bytes.into_iter().collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bone;

    #[test]
    fn odd_numbers_and_lists_that_are_too_short_are_written_as_something_within_bounds() {
        let skin = Skin {
            vertices: vec![[0.0, f64::NAN, 1.0], [1.0, 2.0, f64::INFINITY]],
            triangles: vec![[0, 1, 1], [0, 1, 2]],
            bones: vec![[0, 7, 0, 0]],
            nodes: vec![Bone::default()],
            ..Skin::default()
        };
        let mesh = mesh(&skin);
        let bytes = |key: &str| BASE64_STANDARD.decode(mesh[key].as_str().unwrap()).unwrap();
        assert_eq!(bytes("vertices").len(), 12);
        assert_eq!(bytes("triangles"), [0, 0, 1, 0, 1, 0]);
        assert_eq!((bytes("bones"), bytes("weights"), bytes("light")), (vec![0; 8], vec![0; 8], vec![255; 2]));
    }
}
