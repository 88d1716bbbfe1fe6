//! Every passive curve of the built-in data, over the range of every coordinate that has it: torque takes from the energy what it
//! gives, slope is its derivative, and it falls everywhere. Seeded.

use crate::support;

use contrapposto::model::{Adult, Sex, adult, data};
use contrapposto::passive::PassiveCurve;
use rand::RngExt;
use support::random;

/// Points and weights of Gauss and Legendre's rule on -1..1 that is exact to the ninth power.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Curves by name: of all coordinates of a man and a woman, ligaments that reach over other joints with those anywhere; plain, and
/// reshaped near the limits of the range.
fn curves() -> Vec<(String, PassiveCurve, f64)> {
    let mut random = random(7);
    let (zone, end_torque, _) = data::library().reshape();
    let mut all = vec![];
    for sex in [Sex::Male, Sex::Female] {
        let model = adult(&Adult { sex, ..Adult::default() }).unwrap();
        let mut values = model.default_posture().values().to_vec();
        for round in 0..10 {
            for (i, coordinate) in model.coordinates().iter().enumerate() {
                let Some(law) = &coordinate.passive else { continue };
                let curve = law.curve_at(i, &values, coordinate.range).unwrap().into_owned();
                assert_eq!(curve.torque(values[i]).to_bits(), curve.torque_and_slope(values[i]).0.to_bits());
                let (own, here) = (law.torque(i, &values), curve.torque(values[i]));
                assert!((own - here).abs() < 1e-9 * (1.0 + own.abs()), "{}: {own} and {here}", coordinate.name);
                let held = law.curve().is_none();
                if round == 0 || held {
                    let name = data::library().sources(&coordinate.name).unwrap().curve.unwrap();
                    all.push((format!("{name}, {}", coordinate.name), curve.clone(), 0.0));
                    if let Ok(shaped) = data::reshaped(&curve, zone, end_torque) {
                        all.push((format!("{name}, {}, reshaped", coordinate.name), shaped, zone));
                    }
                }
            }
            for (value, coordinate) in values.iter_mut().zip(model.coordinates()) {
                *value = random.random_range(coordinate.range.0.max(-4.0)..=coordinate.range.1.min(4.0));
            }
        }
    }
    // What the adult does not use of the data, over a range of its own.
    for name in data::library().curve_names() {
        if !all.iter().any(|(known, ..)| known.split(',').next() == Some(name)) {
            let curve = data::library().curve(name).unwrap().over((0.0, 2.0), 1.0).unwrap();
            all.push((name.to_owned(), curve, 0.0));
        }
    }
    all
}

#[test]
fn torque_is_what_the_energy_loses() {
    let (mut worst, mut intervals) = (0.0_f64, 0);
    for (name, curve, zone) in curves() {
        let (min, max) = curve.range();
        let mut angles: Vec<f64> = (0..=1000).map(|k| min + (max - min) * f64::from(k) / 1000.0).collect();
        angles.extend([min + zone, max - zone]); // where a reshaped curve has its kinks
        angles.sort_by(f64::total_cmp);
        let largest = curve.torque(min).abs().max(curve.torque(max).abs());
        for pair in angles.windows(2).filter(|pair| pair[1] - pair[0] > 1e-6) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let work: f64 = GAUSS.iter().map(|(x, weight)| weight * half * curve.torque(middle + half * x)).sum();
            let lost = curve.energy(pair[0]) - curve.energy(pair[1]);
            // Energies are differences of large numbers where the curve is flat.
            let error = (work - lost).abs() / (2.0 * half * largest);
            worst = worst.max(error);
            assert!(error < 1e-9, "{name} from {} to {}: {work} and {lost} J", pair[0], pair[1]);
            intervals += 1;
        }
    }
    println!("{intervals} intervals: worst relative difference {worst:.1e}");
    assert!(intervals > 300_000);
}

#[test]
fn every_curve_falls_everywhere() {
    let mut angles = 0_u64;
    for (name, curve, _) in curves() {
        let (min, max) = curve.range();
        let size = 1.0 + curve.torque(min).abs() + curve.torque(max).abs();
        let count = ((max - min) / 1e-4).ceil();
        let mut before = curve.torque(min);
        for k in 1..=count as u64 {
            let angle = (min + (max - min) * k as f64 / count).min(max);
            let (torque, slope) = curve.torque_and_slope(angle);
            assert!(torque <= before + 1e-14 * size && slope <= 0.0, "{name} rises at {angle}");
            (before, angles) = (torque, angles + 1);
        }
    }
    println!("{angles} angles");
}

#[test]
fn slope_is_the_derivative() {
    let mut worst = 0.0_f64;
    for (name, curve, zone) in curves() {
        let (min, max) = curve.range();
        let step = 1e-4;
        for k in 1..1000 {
            let angle = min + (max - min) * f64::from(k) / 1000.0;
            let kinks = [min + zone, max - zone, min, max];
            if kinks.iter().any(|kink| (angle - kink).abs() < 3.0 * step) {
                continue;
            }
            let difference = |h: f64| curve.torque(angle + h) - curve.torque(angle - h);
            // Exact for quartics.
            let expected = (8.0 * difference(step) - difference(2.0 * step)) / (12.0 * step);
            let error = (curve.slope(angle) - expected).abs() / (1.0 + expected.abs() + curve.torque(angle).abs());
            worst = worst.max(error);
            assert!(error < 1e-9, "{name} at {angle}: {error:e}");
        }
    }
    println!("worst relative difference {worst:.1e}");
}
