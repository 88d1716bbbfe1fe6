//! Writes lines fixed to segments, such as muscles, as tubes of one skinned mesh: every corner follows the segment that carries its point, so
//! that a tube between two segments stretches as they move. A tube stays thick as it is; its ends and bends turn with their segments.

use contrapposto::model::Placement;
use nalgebra::{Point3, Rotation3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::buffer::Buffer;
use super::skinned::linear;

/// Corners round a tube.
const SIDES: usize = 6;
/// Most rings of a primitive, whose corners are counted by 16 bits, and most segments that carry tubes, which 8 bits count.
const MOST_RINGS: usize = 65_535 / SIDES;
const MOST_CARRIERS: usize = 255;

/// A tube along points that segments carry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tube {
    /// Lines one after another: of every point the segment that carries it (`None` for ground) and its place in that frame, m.
    pub lines: Vec<Vec<(Option<usize>, [f64; 3])>>,
    /// m.
    pub radius: f64,
    /// Red, green and blue (sRGB).
    pub color: [u8; 3],
}

/// A mesh of tubes, with the skin that moves it.
pub(super) struct TubeMesh {
    pub(super) mesh: Value,
    pub(super) skin: Value,
}

/// One corner: place and normal in the file's axes, its colour, and its joint.
type Corner = ([[f32; 3]; 2], [u8; 4], [u8; 4]);

/// The tubes as a mesh in the first posture; `None` without any. `frames`: the nodes of all segments in ground, `segments` the segments'
/// own frames there, both of that posture; `turn`: from ground to the file's axes; `material`: index of the look. A node of a segment is one
/// further than the segment, as [`super::glb`] has them.
pub(super) fn tube_mesh(
    tubes: &[Tube],
    (frames, segments): (&[Placement], &[Placement]),
    turn: &Rotation3<f64>,
    material: usize,
    buffer: &mut Buffer,
) -> Option<TubeMesh> {
    let mut carriers: Vec<Option<usize>> =
        tubes.iter().flat_map(|tube| tube.lines.iter().flatten()).map(|p| p.0).collect();
    carriers.sort_unstable();
    carriers.dedup();
    if carriers.is_empty() || carriers.len() > MOST_CARRIERS || carriers.iter().flatten().any(|s| *s >= frames.len()) {
        return None;
    }
    let joint = |segment: &Option<usize>| carriers.binary_search(segment).unwrap_or(0) as u8;
    let in_file = |(segment, place): &(Option<usize>, [f64; 3])| {
        let place = Point3::from(*place);
        turn * segment.map_or(place, |s| segments[s] * place).coords
    };
    let mut parts: Vec<(Vec<Corner>, Vec<u16>)> = vec![(vec![], vec![])];
    for (tube, line) in tubes.iter().flat_map(|tube| tube.lines.iter().map(move |line| (tube, line))) {
        let places: Vec<Vector3<f64>> = line.iter().map(in_file).collect();
        if places.len() < 2 || places.len() > MOST_RINGS {
            continue;
        }
        if parts.last().is_none_or(|(corners, _)| corners.len() / SIDES + places.len() > MOST_RINGS) {
            parts.push((vec![], vec![]));
        }
        let Some((corners, triangles)) = parts.last_mut() else { continue };
        for (k, (segment, _)) in line.iter().enumerate() {
            if k > 0 {
                triangles.extend(between(corners.len() - SIDES));
            }
            let ring = ring(&places, k, tube.radius);
            let color = [linear(tube.color[0]), linear(tube.color[1]), linear(tube.color[2]), 255];
            corners.extend(ring.map(|corner| (corner, color, [joint(segment), 0, 0, 0])));
        }
    }
    parts.retain(|(_, triangles)| !triangles.is_empty());
    let primitives: Vec<Value> = parts.iter().map(|part| primitive(part, material, buffer)).collect();
    let quaternion = UnitQuaternion::from_rotation_matrix(turn);
    let back = |carrier: &Option<usize>| {
        let place = carrier.map_or_else(Placement::identity, |segment| frames[segment]);
        let in_file = Placement::from_parts((turn * place.translation.vector).into(), quaternion * place.rotation);
        let matrix = in_file.inverse().to_homogeneous();
        std::array::from_fn(|i| if i % 4 == 3 { f32::from(i == 15) } else { matrix[(i % 4, i / 4)] as f32 + 0.0 })
    };
    let bind: Vec<[f32; 16]> = carriers.iter().map(back).collect();
    let joints: Vec<usize> = carriers.iter().map(|carrier| carrier.map_or(0, |segment| segment + 1)).collect();
    (!primitives.is_empty()).then(|| TubeMesh {
        mesh: json!({ "name": "muscles", "primitives": primitives }),
        skin: json!({ "inverseBindMatrices": buffer.matrices(&bind), "skeleton": 0, "joints": joints }),
    })
}

fn primitive((corners, triangles): &(Vec<Corner>, Vec<u16>), material: usize, buffer: &mut Buffer) -> Value {
    let indices = buffer.triangles(triangles);
    let [position, normal] = buffer.vertices(&corners.iter().map(|corner| corner.0).collect::<Vec<_>>());
    let attributes = json!({
        "POSITION": position,
        "NORMAL": normal,
        "COLOR_0": buffer.bytes_of_vertices(&corners.iter().map(|corner| corner.1).collect::<Vec<_>>(), true),
        "JOINTS_0": buffer.bytes_of_vertices(&corners.iter().map(|corner| corner.2).collect::<Vec<_>>(), false),
        "WEIGHTS_0": buffer.bytes_of_vertices(&vec![[255, 0, 0, 0]; corners.len()], true),
    });
    json!({ "attributes": attributes, "indices": indices, "material": material })
}

/// The corners round point `k` of a line, across the mean of the directions on both sides.
fn ring(places: &[Vector3<f64>], k: usize, radius: f64) -> [[[f32; 3]; 2]; SIDES] {
    let way = |from: usize, to: usize| (places[to] - places[from]).try_normalize(0.0).unwrap_or_default();
    let before = if k > 0 { way(k - 1, k) } else { Vector3::zeros() };
    let after = if k + 1 < places.len() { way(k, k + 1) } else { Vector3::zeros() };
    let along = (before + after).try_normalize(0.0).unwrap_or_else(Vector3::y);
    let other = if along.x.abs() < 0.9 { Vector3::x() } else { Vector3::z() };
    let x = other.cross(&along).normalize();
    let z = x.cross(&along);
    std::array::from_fn(|side| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * side as f64 / SIDES as f64);
        let out = cos * x + sin * z;
        [places[k] + radius * out, out].map(|v| [v.x, v.y, v.z].map(|v| v as f32 + 0.0))
    })
}

/// Triangles between a ring and the next one, counterclockwise seen from outside.
fn between(first: usize) -> impl Iterator<Item = u16> {
    (0..SIDES).flat_map(move |side| {
        let next = (side + 1) % SIDES;
        let [a, b, c, d] = [first + side, first + next, first + SIDES + side, first + SIDES + next];
        [a, b, c, b, d, c].map(|corner| corner as u16)
    })
}
