//! The skin of the built-in adult: its bones are at the joint centres, its shape is a person's of that size, and limbs are not wrung.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, CoordinateKind, Model, Sex, adult};
use contrapposto::posture::Posture;
use contrapposto_formats::animation::Skin;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const SEED: u64 = 21;
/// Greatest distance of a bone's head from the joint's centre, m.
const NEAR: f64 = 0.005;

fn size(sex: Sex, stature: f64, mass: f64) -> Adult {
    Adult { sex, stature, mass, ..Adult::default() }
}

pub(crate) fn people() -> Vec<(Adult, Model)> {
    let sizes = [
        size(Sex::Female, 1.50, 45.0),
        Adult::reference(Sex::Female),
        size(Sex::Female, 1.65, 75.0),
        Adult::default(),
        size(Sex::Male, 1.95, 110.0),
    ];
    sizes.into_iter().map(|size| (size.clone(), adult(&size).unwrap())).collect()
}

/// Anywhere within the ranges of all joints, the root anywhere within 1 m.
pub(crate) fn random(model: &Model, random: &mut Pcg64Mcg) -> Posture {
    let value = |c: &contrapposto::model::Coordinate| match c.kind {
        CoordinateKind::Translation => random.random_range(c.range.0.max(-1.0)..c.range.1.min(1.0)),
        _ => random.random_range(c.range.0..c.range.1),
    };
    Posture::new(model.coordinates().iter().map(value).collect())
}

/// Centres of the joints of all segments.
pub(crate) fn joints(model: &Model, posture: &Posture) -> Vec<Vector3<f64>> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    let center = |s: usize| kinematics.station(model, s, model.segments()[s].in_segment.translation.vector);
    (0..model.segments().len()).map(center).collect()
}

/// Volume within the triangles, m3.
fn volume(vertices: &[Vector3<f64>], triangles: &[[u16; 3]]) -> f64 {
    let six = |t: &[u16; 3]| {
        let [a, b, c] = t.map(|i| vertices[usize::from(i)]);
        a.dot(&b.cross(&c))
    };
    triangles.iter().map(six).sum::<f64>() / 6.0
}

/// Default posture with some coordinates set, degrees.
pub(crate) fn with(model: &Model, values: &[(&str, f64)]) -> Posture {
    let mut posture = model.default_posture().values().to_vec();
    values.iter().for_each(|(name, degrees)| posture[model.coordinate(name).unwrap()] = degrees.to_radians());
    Posture::new(posture)
}

#[test]
fn a_skin_has_stature_and_mass_of_its_adult_and_stands_on_the_ground() {
    for (size, model) in people() {
        let skin = Skin::of(&model).unwrap();
        let numbers = skin.vertices.iter().chain(&skin.normals).flat_map(|v| v.iter());
        assert!(numbers.into_iter().all(|v| v.is_finite()));
        assert!(skin.normals.iter().all(|n| (n.norm() - 1.0).abs() < 1e-9));
        assert!(skin.weights.iter().all(|w| w.iter().map(|&w| u32::from(w)).sum::<u32>() == 255));
        let bones = skin.bones.iter().flatten().all(|&bone| usize::from(bone) < skin.skeleton.bones().len());
        assert!(bones, "a vertex has a bone that is not there");
        let heights = || skin.vertices.iter().map(|v| v.y);
        let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(0.0, f64::max));
        let liters = 1000.0 * volume(&skin.vertices, &skin.triangles);
        println!("{size:?}: from {low:.3} to {high:.3} m, {liters:.1} l");
        assert!(low.abs() < 0.01, "soles at {low} m");
        assert!((high / size.stature - 1.0).abs() < 0.03, "{high} m");
        assert!((liters / size.mass - 1.0).abs() < 0.02, "{liters} l");
    }
}

#[test]
fn bones_are_at_the_joint_centres_in_any_posture() {
    println!("seed {SEED}");
    let mut numbers = Pcg64Mcg::seed_from_u64(SEED);
    for (size, model) in people() {
        let skin = Skin::of(&model).unwrap();
        let mut worst = 0.0_f64;
        let mut least = f64::INFINITY;
        for _ in 0..20 {
            let posture = random(&model, &mut numbers);
            let places = skin.skeleton.place_in(&model, &posture).unwrap();
            let centers = joints(&model, &posture);
            for (node, place) in places.iter().enumerate() {
                // The nodes of the clavicles are at the joint of the torso.
                worst = worst.max((place.translation.vector - centers[skin.skeleton.nodes[node].segment]).norm());
            }
            let moved = skin.moved(&places);
            assert!(moved.iter().all(|v| v.iter().all(|v| v.is_finite())));
            least = least.min(volume(&moved, &skin.triangles) / volume(&skin.vertices, &skin.triangles));
        }
        println!("{size:?}: bones within {worst:.1e} m, volume at least {least:.3} of that in T-pose");
        assert!(worst < NEAR, "{size:?}: {worst}");
        assert!(least > 0.85, "{size:?}: {least}");
    }
}

/// Flesh is about its bones: the middle of the skin around a joint is near its centre, in the T-pose, whose segments are straight.
#[test]
fn the_skin_around_a_joint_is_about_its_centre() {
    for (size, model) in people() {
        let skin = Skin::of(&model).unwrap();
        let posture = with(&model, &[("arm_add_r", -90.0), ("arm_add_l", -90.0)]);
        let centers = joints(&model, &posture);
        for (joint, along) in [("ulna", Vector3::z()), ("hand", Vector3::z()), ("tibia", Vector3::y())] {
            for side in ["_r", "_l"] {
                let center = centers[model.segment(&format!("{joint}{side}")).unwrap()];
                let about = |v: &&Vector3<f64>| {
                    let way = **v - center;
                    way.dot(&along).abs() < 0.02 && way.norm() < 0.11 * size.stature / 1.7
                };
                let ring: Vec<&Vector3<f64>> = skin.vertices.iter().filter(about).collect();
                let middle = ring.iter().copied().sum::<Vector3<f64>>() / ring.len() as f64;
                let off = (middle - center) - along * along.dot(&(middle - center));
                println!(
                    "{joint}{side} of {} m: {} vertices, {:.1} mm off",
                    size.stature,
                    ring.len(),
                    1e3 * off.norm()
                );
                assert!(ring.len() >= 8 && off.norm() < 0.025, "{joint}{side}: {off:?}");
            }
        }
    }
}

/// Mean distance of the skin from the bone between two joints, in slices along it.
fn girths(skin: &Skin, model: &Model, posture: &Posture, ends: [&str; 2], slices: usize) -> Vec<f64> {
    let t_pose = with(model, &[("arm_add_r", -90.0), ("arm_add_l", -90.0)]);
    let (rest, now) = (joints(model, &t_pose), joints(model, posture));
    let ends = ends.map(|name| model.segment(name).unwrap());
    let along = |p: &Vector3<f64>| (p - rest[ends[0]]).dot(&(rest[ends[1]] - rest[ends[0]]).normalize());
    let length = (rest[ends[1]] - rest[ends[0]]).norm();
    let axis = (now[ends[1]] - now[ends[0]]).normalize();
    let moved = skin.moved(&skin.skeleton.place_in(model, posture).unwrap());
    let mut sums = vec![(0.0, 0.0); slices];
    for (vertex, moved) in skin.vertices.iter().zip(&moved) {
        let share = along(vertex) / length;
        let aside = (vertex - rest[ends[0]]).norm_squared() - along(vertex).powi(2);
        if (0.0..1.0).contains(&share) && aside < 0.01 {
            let slice = &mut sums[(share * slices as f64) as usize];
            slice.0 += (moved - now[ends[0]]).cross(&axis).norm();
            slice.1 += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

#[test]
fn limbs_that_turn_about_themselves_keep_their_girth() {
    let (_, model) = people().remove(3);
    let skin = Skin::of(&model).unwrap();
    let limbs = [("pro_sup", ["ulna", "hand"], [-80.0, 80.0]), ("arm_rot", ["humerus", "ulna"], [-90.0, 70.0])];
    for side in ["_r", "_l"] {
        for (coordinate, ends, turns) in limbs {
            let names = ends.map(|name| format!("{name}{side}"));
            let names = [names[0].as_str(), names[1].as_str()];
            let out = format!("arm_add{side}");
            let at = |turn: f64| {
                girths(&skin, &model, &with(&model, &[(&out, -90.0), (&format!("{coordinate}{side}"), turn)]), names, 8)
            };
            let rest = at(0.0);
            for turn in turns {
                let shares: Vec<f64> = at(turn).iter().zip(&rest).map(|(now, rest)| now / rest).collect();
                println!("{coordinate}{side} {turn}: {shares:.3?}");
                assert!(
                    shares.iter().all(|share| (0.9..1.05).contains(share)),
                    "{coordinate}{side} {turn}: {shares:.3?}"
                );
            }
        }
    }
}

#[test]
fn only_the_whole_built_in_adult_has_a_skin() {
    assert!(Skin::of(&adult(&Adult::right_arm()).unwrap()).is_none());
    let long = Adult { lengths: vec![("femur".to_owned(), 0.5)], ..Adult::default() };
    assert!(Skin::of(&adult(&long).unwrap()).is_none());
}
