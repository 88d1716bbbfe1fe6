//! Finds the posture of the first frame, also of a body that faces another way than its default posture.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::tolerances::{BETTER_LIMB, BETTER_START, SAME_TURN, TURNED_STARTS_FROM};
use super::tracker::{Solved, Tracker};
use crate::model::{CoordinateKind, Model};
use crate::posture::{Posture, PostureError};

/// The posture of a first frame from `start`. Where its markers stay far, the root begins turned by quarters of a turn about up to three
/// of its coordinates, too; where a coordinate is held at a limit, the limbs begin again from `start` with the root in its place, all of
/// them and then each that is held. The least objective is taken; a turn must save 1 % of it (`BETTER_START`), other limbs a millionth
/// (`BETTER_LIMB`).
///
/// # Errors
/// [`PostureError`] when the start does not fit the model.
pub fn first_posture(
    tracker: &mut Tracker,
    model: &Model,
    start: &Posture,
    observed: &[Option<Vector3<f64>>],
) -> Result<(Posture, Solved), PostureError> {
    let mut best = start.clone();
    let mut solved = tracker.solve(model, &mut best, observed)?;
    let weights = tracker.goals().markers.iter().map(|marker| marker.weight);
    let pulls = weights.zip(tracker.errors()).filter_map(|(weight, error)| Some((weight, error?)));
    let (sum, all) = pulls.fold((0.0, 0.0), |(sum, all), (weight, error)| (sum + weight * error * error, all + weight));
    if all == 0.0 {
        return Ok((best, solved));
    }
    let mut changed = false;
    let mut attempt =
        |tracker: &mut Tracker, share: f64, mut posture: Posture, best: &mut Posture, least: &mut Solved| {
            let other = tracker.solve(model, &mut posture, observed)?;
            if other.objective < share * least.objective {
                (*best, *least) = (posture, other);
            }
            changed = true;
            Ok::<(), PostureError>(())
        };
    if f64::sqrt(sum / all) >= TURNED_STARTS_FROM {
        for turned in turned_roots(tracker, model, start) {
            attempt(tracker, BETTER_START, turned, &mut best, &mut solved)?;
        }
    }
    if !held(tracker, model, &best).is_empty() {
        let mut posture = best.clone();
        let limbs = (0..start.values().len()).filter(|c| !root_coordinates(model).contains(c));
        limbs.for_each(|c| posture.values_mut()[c] = start.values()[c]);
        attempt(tracker, BETTER_LIMB, posture, &mut best, &mut solved)?;
    }
    for coordinate in held(tracker, model, &best) {
        let mut posture = best.clone();
        posture.values_mut()[coordinate] = start.values()[coordinate];
        attempt(tracker, BETTER_LIMB, posture, &mut best, &mut solved)?;
    }
    if changed {
        solved = tracker.solve(model, &mut best, observed)?;
    }
    Ok((best, solved))
}

fn root_coordinates(model: &Model) -> Vec<usize> {
    let roots = model.segments().iter().filter(|segment| segment.parent.is_none());
    roots.flat_map(|segment| segment.coordinates.clone()).collect()
}

/// Free coordinates of limbs that lie at a limit.
fn held(tracker: &Tracker, model: &Model, posture: &Posture) -> Vec<usize> {
    let root = root_coordinates(model);
    let goals = tracker.goals();
    let at_limit = |&(c, (low, high)): &(usize, (f64, f64))| {
        let value = posture.values()[c];
        let free = low < high && !goals.fixed.contains(&c) && !model.is_dependent(c) && !root.contains(&c);
        (free && (value <= low || value >= high)).then_some(c)
    };
    goals.limits.iter().filter_map(at_limit).collect()
}

/// Copies of `start` with the root turned.
fn turned_roots(tracker: &Tracker, model: &Model, start: &Posture) -> Vec<Posture> {
    let coordinates = root_coordinates(model);
    let movable = |c: &usize| !tracker.goals().fixed.contains(c) && !model.is_dependent(*c);
    let of_kind =
        |kind| coordinates.iter().copied().filter(movable).filter(move |&c| model.coordinates()[c].kind == kind);
    let angles: Vec<usize> = of_kind(CoordinateKind::Rotation).take(3).collect();
    let ball = of_kind(CoordinateKind::Quaternion).next();
    let axes = if ball.is_some() { 3 } else { angles.len() };
    let mut turned: Vec<Posture> = vec![];
    let mut tried = vec![UnitQuaternion::identity()];
    for choice in 1..4_usize.pow(axes as u32) {
        let quarter = |axis: usize| ((choice / 4_usize.pow(axis as u32)) % 4) as f64 * FRAC_PI_2;
        let mut posture = start.clone();
        let values = posture.values_mut();
        match ball {
            Some(first) => {
                let turn = UnitQuaternion::from_euler_angles(quarter(0), quarter(1), quarter(2));
                // Of the 64 choices 24 are different.
                if tried.iter().any(|other| other.angle_to(&turn) < SAME_TURN) {
                    continue;
                }
                tried.push(turn);
                let [w, i, j, k] = [0, 1, 2, 3].map(|part| values[first + part]);
                let q = turn * UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
                values[first..first + 4].copy_from_slice(&[q.w, q.i, q.j, q.k]);
            }
            None => angles.iter().enumerate().for_each(|(axis, &c)| values[c] += signed(quarter(axis))),
        }
        turned.push(posture);
    }
    turned
}

/// Three quarters forward are one back.
fn signed(turn: f64) -> f64 {
    if turn > 2.5 * FRAC_PI_2 { turn - 4.0 * FRAC_PI_2 } else { turn }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use std::f64::consts::PI;

    use super::super::goals::Goals;
    use super::*;
    use crate::model::{Adult, adult};

    #[test]
    fn turned_roots_are_the_63_other_quarters_of_three_angles_each_within_half_a_turn() {
        let model = adult(&Adult::default()).unwrap();
        let tracker = Tracker::new(&model, Goals::default()).unwrap();
        let start = model.default_posture();
        let angles = ["pelvis_tilt", "pelvis_list", "pelvis_rotation"].map(|name| model.coordinate(name).unwrap());
        let mut turns = vec![[0; 3]];
        for turned in turned_roots(&tracker, &model, &start) {
            turns.push(angles.map(|c| {
                let turn = turned.values()[c] - start.values()[c];
                assert!(turn > 0.1 - PI && turn < 0.1 + PI, "{turn}");
                (turn / FRAC_PI_2).round() as i32
            }));
            let others = (0..start.values().len()).filter(|c| !angles.contains(c));
            assert!(others.into_iter().all(|c| turned.values()[c] == start.values()[c]));
        }
        turns.sort_unstable();
        turns.dedup();
        assert_eq!(turns.len(), 64);
    }

    #[test]
    fn held_are_the_coordinates_of_limbs_at_a_limit_that_are_neither_fixed_nor_dependent() {
        let model = adult(&Adult::default()).unwrap();
        let at = |name: &str| model.coordinate(name).unwrap();
        let mut posture = model.default_posture();
        let mut goals = Goals { fixed: vec![at("knee_angle_l")], ..Goals::default() };
        for name in ["elbow_flex_r", "elbow_flex_l", "knee_angle_r", "knee_angle_l", "pelvis_tilt"] {
            goals.limits.push((at(name), (0.2, 0.8)));
        }
        goals.limits.push((at("pro_sup_r"), (0.8, 0.8)));
        for (name, value) in [
            ("elbow_flex_r", 0.2),
            ("elbow_flex_l", 0.5),
            ("knee_angle_r", 0.8),
            ("knee_angle_l", 0.8),
            ("pelvis_tilt", 0.8),
            ("pro_sup_r", 0.8),
        ] {
            posture.values_mut()[at(name)] = value;
        }
        let tracker = Tracker::new(&model, goals).unwrap();
        assert_eq!(held(&tracker, &model, &posture), [at("elbow_flex_r"), at("knee_angle_r")]);
    }
}
