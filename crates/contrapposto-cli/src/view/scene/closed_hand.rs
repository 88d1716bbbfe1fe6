//! Closes the fingers of hands that hold something: the skin's fingers are straight, and follow the hand as a whole.
//!
//! Fingers bend like a bar into an arc about a handle in the palm, and close up to lie side by side. Lengths are shares of the length of
//! the hand, measured on the skin of the built-in adult; the thumb lies across the palm already.

use contrapposto::model::{Model, plain_name};
use contrapposto::statics::LoadKind;
use contrapposto_formats::animation::Skin;
use nalgebra::{Point3, Vector3};

use crate::view::stage::Stage;

/// Distance of the knuckles from the wrist.
const KNUCKLES: f64 = 0.535;
/// Distance of the middle of the fingers at the knuckles from the plane of the hand, and its growth along the fingers.
const DROOP: (f64, f64) = (0.055, 0.30);
/// Radius of the arc of the middle of the fingers: about a handle of 3.5 cm, a fist closes by 200 degrees. Assumed.
const HANDLE_RADIUS: f64 = 0.135;
/// The share of the radius off the middle of the fingers from which on a vertex belongs to the thumb.
const THUMB: f64 = 0.7;
/// Little, ring, middle and index finger: the place of the middle of each across the hand at the knuckles, its growth along the straight
/// finger, and its place in a closed hand, a finger's width apart.
const FINGERS: [(f64, f64, f64); 4] =
    [(-0.25, -0.4, -0.215), (-0.13, -0.25, -0.112), (0.0, -0.1, -0.01), (0.14, 0.115, 0.095)];
/// Distance from the knuckles at which fingers lie side by side.
const CLOSED_UP: f64 = 0.15;
/// The share of 255 from which on a vertex belongs to the hand.
const OF_HAND: u16 = 128;

/// Hands that hold something: a weight, a thing that they carry, or a handle that presses on them.
pub(super) fn closed_hands(model: &Model, stage: &Stage<'_>) -> Vec<usize> {
    let is_hand = |segment: &usize| plain_name(&model.segments()[*segment].name).ends_with("hand");
    let handle = stage.things.iter().any(|thing| thing.name.contains("handle"));
    let holds = |kind: &LoadKind| matches!(kind, LoadKind::Weight(_)) || handle;
    let loaded = stage.all_loads().into_iter().filter(|load| holds(&load.kind)).map(|load| load.segment);
    let carrying = stage.things.iter().filter_map(|thing| thing.segment);
    let mut hands: Vec<usize> = loaded.chain(carrying).filter(is_hand).collect();
    hands.sort_unstable();
    hands.dedup();
    hands
}

/// The vertices of a skin in its rest posture, with the fingers of these hands closed.
pub(super) fn closed(skin: &Skin, model: &Model, hands: &[usize]) -> Vec<Vector3<f64>> {
    let mut vertices = skin.vertices.clone();
    let bones = skin.skeleton.bones();
    for &hand in hands {
        let rest = &skin.skeleton.rest[hand];
        let share = |v: usize| -> u16 {
            let of_hand =
                |b: u8| bones.get(usize::from(b)).is_some_and(|bone| (bone.from, bone.segment) == (hand, hand));
            let parts = skin.bones[v].iter().zip(&skin.weights[v]).filter(|(bone, _)| of_hand(**bone));
            parts.map(|(_, weight)| u16::from(*weight)).sum()
        };
        let own: Vec<usize> = (0..vertices.len()).filter(|&v| share(v) >= OF_HAND).collect();
        let local = |v: &usize| rest.inverse_transform_point(&Point3::from(skin.vertices[*v])).coords;
        let length = own.iter().map(|v| -local(v).y).fold(0.0, f64::max);
        // Palms of hanging arms face the thighs.
        let palm = if model.segments()[hand].name.ends_with("_l") { 1.0 } else { -1.0 };
        for v in own {
            vertices[v] = (rest * Point3::from(bent(local(&v), length, palm))).coords;
        }
    }
    vertices
}

/// A place of a hand of this length in its frame, after its fingers are closed; `palm`: the sign of z toward which the palm faces.
fn bent(at: Vector3<f64>, length: f64, palm: f64) -> Vector3<f64> {
    let (along, radius) = (-at.y - KNUCKLES * length, HANDLE_RADIUS * length);
    let middle = DROOP.0 * length + DROOP.1 * along;
    let off = palm * at.z - middle;
    if along <= 0.0 || off > THUMB * radius {
        return at;
    }
    let (sine, cosine) = libm::sincos(along / radius);
    let toward = DROOP.0 * length + radius - (radius - off) * cosine;
    let across = length * beside(at.x / length, along / length);
    Vector3::new(across, -KNUCKLES * length - (radius - off) * sine, palm * toward)
}

/// The place across a closed hand of a point of a finger, from its place across the open one and its distance from the knuckles.
fn beside(across: f64, along: f64) -> f64 {
    let middle = |&(at, growth, _): &(f64, f64, f64)| at + growth * along;
    let off = |finger: &&(f64, f64, f64)| (across - middle(finger)).abs();
    let Some(finger) = FINGERS.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return across };
    let share = (along / CLOSED_UP).clamp(0.0, 1.0);
    across + share * share * (3.0 - 2.0 * share) * (finger.2 - middle(finger))
}

#[cfg(test)]
mod tests {
    use super::*;
    use contrapposto::model::{Adult, adult};

    /// Fingers of a closed hand end near its palm, keep their length along the arc, and begin without a step; the other hand and the rest of
    /// the body stay.
    #[test]
    fn fingers_of_a_closed_hand_end_at_its_palm_and_nothing_else_moves() {
        let model = adult(&Adult::default()).unwrap();
        let skin = Skin::of(&model).unwrap();
        for (side, palm) in [("r", -1.0), ("l", 1.0)] {
            let hand = model.segment(&format!("hand_{side}")).unwrap();
            let after = closed(&skin, &model, &[hand]);
            let rest = &skin.skeleton.rest[hand];
            let local = |v: &Vector3<f64>| rest.inverse_transform_point(&Point3::from(*v)).coords;
            let moved: Vec<usize> = (0..after.len()).filter(|&v| after[v] != skin.vertices[v]).collect();
            let far = |v: &Vector3<f64>| -local(v).y;
            let farthest = |all: &[Vector3<f64>]| moved.iter().map(|&v| far(&all[v])).fold(f64::NEG_INFINITY, f64::max);
            let (open, shut) = (farthest(&skin.vertices), farthest(&after));
            assert!(moved.len() > 300 && shut < 0.75 * open && shut > 0.5 * open, "{} {open} {shut}", moved.len());
            for &v in &moved {
                let (before, at) = (local(&skin.vertices[v]), local(&after[v]));
                assert!((at.x - before.x).abs() < 0.16 * open && -before.y > KNUCKLES * open - 1e-9, "{before} {at}");
                assert!(palm * at.z < 0.45 * open, "in the palm or before it: {at}");
            }
            // Side by side: between straight fingers are gaps, between closed ones hardly any.
            let gap = |all: &[Vector3<f64>]| {
                let far_out = moved.iter().filter(|v| far(&skin.vertices[**v]) > (KNUCKLES + CLOSED_UP) * open);
                let mut across: Vec<f64> = far_out.map(|&v| local(&all[v]).x).collect();
                across.sort_by(f64::total_cmp);
                across.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
            };
            let (apart, together) = (gap(&skin.vertices), gap(&after));
            assert!(apart > 0.05 * open && together < 0.03 * open, "{} {}", apart / open, together / open);
            let tip = moved.iter().max_by(|a, b| far(&skin.vertices[**a]).total_cmp(&far(&skin.vertices[**b])));
            let tip = local(&after[*tip.unwrap()]);
            assert!(-tip.y < KNUCKLES * open && palm * tip.z > 0.1 * open, "{tip}");
        }
        assert_eq!(closed(&skin, &model, &[]), skin.vertices);
        let knuckle = Vector3::new(0.0, -0.535 * 0.2, -0.055 * 0.2);
        assert!((bent(knuckle - Vector3::new(0.0, 1e-9, 0.0), 0.2, -1.0) - knuckle).norm() < 1e-8);
    }
}
