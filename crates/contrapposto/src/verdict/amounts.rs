//! Sums up loads for sentences.

use nalgebra::Vector3;

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
    fn numbers_have_no_zeros_at_their_end() {
        assert_eq!([2.4, 12.0, 0.05, 200.0, 0.8].map(number), ["2.4", "12", "0.05", "200", "0.8"]);
    }
}
