//! Sums up loads for sentences.

use nalgebra::Vector3;

use crate::model::{Model, plain_name};
use crate::statics::{FixedIn, Load, LoadKind};

/// Most weights and forces that are named one by one.
pub(crate) const MOST_AMOUNTS: usize = 3;
/// Forces whose sum is this share of the sum of their sizes act in one direction, and are told as one.
const ONE_DIRECTION: f64 = 0.999;

/// A size with its unit.
pub(crate) type Amount = (f64, &'static str);

/// The sum of all weights, and the forces and couples: those of one direction as their sum.
pub(crate) fn amounts(loads: &[Load]) -> Vec<Amount> {
    let mass: f64 = loads.iter().map(|load| if let LoadKind::Weight(mass) = load.kind { mass } else { 0.0 }).sum();
    let (mut forces, mut couples) = (vec![], vec![]);
    for load in loads {
        match load.kind {
            LoadKind::Weight(_) => {}
            LoadKind::Force(force, frame) => forces.push((force, frame)),
            LoadKind::Couple(couple, frame) => couples.push((couple, frame)),
        }
    }
    let weight = (mass > 0.0).then_some((mass, "kg"));
    weight.into_iter().chain(sizes(&forces, "N")).chain(sizes(&couples, "N m")).collect()
}

/// The sum of vectors of one direction in the world, or each of them.
fn sizes(vectors: &[(Vector3<f64>, FixedIn)], unit: &'static str) -> Vec<Amount> {
    let (all, sum) = vectors.iter().fold((0.0, Vector3::zeros()), |(all, sum), (v, _)| (all + v.norm(), sum + v));
    let in_world = vectors.iter().all(|(_, frame)| *frame == FixedIn::World);
    if in_world && all > 0.0 && sum.norm() > ONE_DIRECTION * all {
        return vec![(sum.norm(), unit)];
    }
    vectors.iter().map(|(vector, _)| (vector.norm(), unit)).collect()
}

/// `1.6 kg and 16 N`: a share of the amounts.
pub(crate) fn amounts_in_words(amounts: &[Amount], share: f64) -> String {
    let words: Vec<String> =
        amounts.iter().map(|(amount, unit)| format!("{}\u{a0}{unit}", number(share * amount))).collect();
    words.join(" and ")
}

/// ` under its load of 15 kg and a force of 50 N on left hand toward +x`; nothing without loads, and of many.
pub(super) fn burden_in_words(model: &Model, loads: &[Load]) -> String {
    let all = amounts(loads);
    if !(1..=MOST_AMOUNTS).contains(&all.len()) {
        return String::new();
    }
    let in_words = |&(amount, unit): &Amount| match unit {
        "kg" => format!("its load of {}\u{a0}kg", number(amount)),
        "N" => format!("a force of {}\u{a0}N{}", number(amount), force_in_words(model, loads).unwrap_or_default()),
        _ => format!("a moment of {}\u{a0}{unit}", number(amount)),
    };
    format!(" under {}", all.iter().map(in_words).collect::<Vec<_>>().join(" and "))
}

/// ` on right hand and left hand toward +x` (a ground axis, which is none without a direction in the world), of forces of one direction.
fn force_in_words(model: &Model, loads: &[Load]) -> Option<String> {
    let (mut parts, mut sum, mut all): (Vec<String>, _, _) = (vec![], Vector3::zeros(), 0.0);
    for load in loads {
        let LoadKind::Force(force, frame) = load.kind else { continue };
        if frame != FixedIn::World {
            return None;
        }
        let name = plain_name(&model.segments()[load.segment].name);
        if !parts.contains(&name) {
            parts.push(name);
        }
        (sum, all) = (sum + force, all + force.norm());
    }
    let along = |k: usize| (sum[k].abs() > ONE_DIRECTION * all).then(|| (sum[k] > 0.0, ["x", "y", "z"][k]));
    let direction = (0..3).find_map(along).map_or_else(String::new, |(positive, axis)| {
        format!(" toward {}{axis}", if positive { "+" } else { "\u{2212}" })
    });
    (sum.norm() > ONE_DIRECTION * all).then(|| format!(" on {}{direction}", parts.join(" and ")))
}

/// `2.4`, `12`, `0.05`: without zeros at the end.
fn number(value: f64) -> String {
    if value >= 99.5 {
        return format!("{value:.0}");
    }
    let text = if value < 0.095 { format!("{value:.3}") } else { format!("{value:.2}") };
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(newtons: [f64; 3]) -> Load {
        Load { segment: 0, point: Vector3::zeros(), kind: LoadKind::Force(newtons.into(), FixedIn::World) }
    }

    #[test]
    fn amounts_are_sums_of_weights_and_of_forces_of_one_direction() {
        let weight = |mass| Load { segment: 0, point: Vector3::zeros(), kind: LoadKind::Weight(mass) };
        let box_and_pull = [weight(7.5), weight(7.5), force([0.0, -30.0, 40.0])];
        assert_eq!(amounts(&box_and_pull), [(15.0, "kg"), (50.0, "N")]);
        assert_eq!(amounts(&[force([100.0, 0.0, 0.0]), force([100.0, 0.0, 0.0])]), [(200.0, "N")]);
        assert_eq!(amounts(&[force([10.0, 0.0, 0.0]), force([0.0, 20.0, 0.0])]), [(10.0, "N"), (20.0, "N")]);
    }

    #[test]
    fn a_fall_is_under_weights_and_under_forces_with_their_part_and_direction() {
        let model = crate::model::adult(&crate::model::Adult::right_arm()).unwrap();
        let hand = model.segment("hand_r").unwrap();
        let weight = Load { segment: hand, point: Vector3::zeros(), kind: LoadKind::Weight(15.0) };
        let pull = |newtons| Load { segment: hand, ..force(newtons) };
        let words = |loads: &[Load]| burden_in_words(&model, loads).replace('\u{a0}', " ");
        assert_eq!(words(&[]), "");
        assert_eq!(words(&[weight]), " under its load of 15 kg");
        assert_eq!(words(&[pull([400.0, 0.0, 0.0])]), " under a force of 400 N on right hand toward +x");
        let both = [weight, pull([0.0, -30.0, 0.0]), pull([0.0, -20.0, 0.0])];
        assert_eq!(words(&both), " under its load of 15 kg and a force of 50 N on right hand toward \u{2212}y");
        assert_eq!(words(&[pull([30.0, 0.0, 40.0])]), " under a force of 50 N on right hand");
        assert_eq!(
            words(&[pull([30.0, 0.0, 0.0]), pull([0.0, 0.0, 40.0])]),
            " under a force of 30 N and a force of 40 N"
        );
    }

    #[test]
    fn numbers_have_no_zeros_at_their_end() {
        assert_eq!([2.4, 12.0, 0.05, 200.0, 0.8].map(number), ["2.4", "12", "0.05", "200", "0.8"]);
    }
}
