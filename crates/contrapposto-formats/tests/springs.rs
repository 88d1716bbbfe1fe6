//! Compares ligaments, path springs and bushings with OpenSim's (`scripts/opensim_springs.py`), with closed forms and with energies.

use contrapposto::kinematics::Kinematics;
use contrapposto::math::{Function, Spline};
use contrapposto::muscle::{LigamentLaw, PathGeometry, PathRule, bushing_torque, passive_torque};
use contrapposto::posture::Posture;
use contrapposto_formats::osim;
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Torque by coordinate of all ligaments and bushings, and the energy of the bushings.
struct Springs {
    imported: contrapposto_formats::model_ir::Imported,
    kinematics: Kinematics,
    geometry: PathGeometry,
}

impl Springs {
    fn read(text: &str) -> Self {
        let imported = osim::read(text.as_bytes(), "chain.osim").unwrap().model().unwrap();
        let kinematics = Kinematics::new(&imported.model);
        let geometry = PathGeometry::new(&imported.model, &imported.muscles.paths);
        Self { imported, kinematics, geometry }
    }

    fn place(&mut self, values: &[f64]) {
        let model = &self.imported.model;
        self.kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
        self.geometry.update(model, &self.kinematics, &self.imported.muscles.paths, PathRule::Geodesic);
    }

    fn torque(&mut self, values: &[f64]) -> Vec<f64> {
        self.place(values);
        let (model, muscles) = (&self.imported.model, &self.imported.muscles);
        let mut torque = vec![0.0; model.rates().len()];
        let mut of_bushings = torque.clone();
        passive_torque(muscles, &self.geometry, &[], &mut torque);
        bushing_torque(&muscles.bushings, model, &self.kinematics, &mut of_bushings);
        torque.iter().zip(&of_bushings).map(|(a, b)| a + b).collect()
    }

    fn energy(&mut self, values: &[f64]) -> f64 {
        self.place(values);
        let energy = |bushing: &contrapposto::muscle::Bushing| bushing.energy(&self.imported.model, &self.kinematics);
        self.imported.muscles.bushings.iter().map(energy).sum()
    }
}

fn reference() -> Value {
    serde_json::from_str(include_str!("data/opensim_springs.json")).unwrap()
}

#[test]
fn torques_of_ligaments_path_springs_and_bushings_are_opensims() {
    for (kind, data) in reference()["kinds"].as_object().unwrap() {
        let mut springs = Springs::read(data["osim"].as_str().unwrap());
        let tally = &springs.imported.muscle_tally.0[kind];
        assert_eq!((tally.read, tally.refused), (1, 0), "{kind}: {:?}", tally.reasons);
        let (mut worst, mut most) = (0f64, 0f64);
        for posture in data["postures"].as_array().unwrap() {
            let ours = springs.torque(&numbers(&posture["q"]));
            for (ours, theirs) in ours.iter().zip(numbers(&posture["torque"])) {
                assert!(ours.is_finite(), "{kind}: {ours}");
                worst = worst.max((ours - theirs).abs());
                most = most.max(theirs.abs());
            }
        }
        println!("{kind}: {worst:e} of {most}");
        assert!(most > 1.0 && worst < 1e-10 * most, "{kind}: {worst:e} of {most}");
    }
}

#[test]
fn the_torque_of_a_bushing_is_minus_the_slope_of_its_energy() {
    let data = &reference()["kinds"]["BushingForce"];
    let mut springs = Springs::read(data["osim"].as_str().unwrap());
    for posture in data["postures"].as_array().unwrap() {
        let values = numbers(&posture["q"]);
        let torque = springs.torque(&values);
        for (i, torque) in torque.iter().enumerate() {
            let mut at = |step: f64| {
                let mut moved = values.clone();
                moved[i] += step;
                springs.energy(&moved)
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((torque + slope).abs() < 1e-6, "{values:?}, {i}: {torque} for {}", -slope);
        }
    }
}

#[test]
fn tensions_of_ligaments_are_their_closed_forms_and_the_slopes_their_derivatives() {
    let spring = LigamentLaw::Spring { slack_length: 0.2, stiffness: 500.0 };
    let knee = LigamentLaw::Blankevoort1991 { slack_length: 0.1, stiffness: 2000.0, transition_strain: 0.06 };
    let curve = Function::Spline(Spline::simm(&[0.9, 1.0, 1.1, 1.3, 1.5], &[0.0, 0.0, 0.1, 0.6, 1.4]).unwrap());
    let curved = LigamentLaw::Curve { slack_length: 0.1, force: 300.0, curve };
    assert_eq!(spring.tension_and_slope(0.19), (0.0, 0.0));
    assert!((spring.tension_and_slope(0.23).0 - 15.0).abs() < 1e-12);
    // Strains 0.03 and 0.1: 2000 0.03^2 / 0.12 and 2000 (0.1 - 0.03).
    assert!((knee.tension_and_slope(0.103).0 - 15.0).abs() < 1e-11);
    assert!((knee.tension_and_slope(0.11).0 - 140.0).abs() < 1e-11);
    assert_eq!(knee.tension_and_slope(0.1), (0.0, 0.0));
    assert!((curved.tension_and_slope(0.11).0 - 30.0).abs() < 1e-12);
    for law in [spring, knee, curved] {
        for step in 0..100 {
            let length = 0.0801 + 0.002 * f64::from(step);
            let h = 1e-7;
            let slope = (law.tension_and_slope(length + h).0 - law.tension_and_slope(length - h).0) / (2.0 * h);
            assert!((law.tension_and_slope(length).1 - slope).abs() < 1e-3 * (1.0 + slope), "{law:?} at {length}");
        }
    }
}

#[test]
fn springs_with_odd_numbers_are_refused_by_count() {
    let data = reference();
    for (kind, property, bad) in [
        ("Ligament", "resting_length", "0"),
        ("Ligament", "pcsa_force", "-1"),
        ("Blankevoort1991Ligament", "slack_length", "0"),
        ("Blankevoort1991Ligament", "transition_strain", "nan"),
        ("PathSpring", "stiffness", "-3"),
        ("BushingForce", "rotational_stiffness", "1 -2 3"),
    ] {
        let text = data["kinds"][kind]["osim"].as_str().unwrap();
        let (open, close) = (format!("<{property}>"), format!("</{property}>"));
        let start = text.find(&open).unwrap() + open.len();
        let end = start + text[start..].find(&close).unwrap();
        let text = format!("{}{bad}{}", &text[..start], &text[end..]);
        let tally = &Springs::read(&text).imported.muscle_tally.0[kind];
        assert_eq!((tally.read, tally.refused), (0, 1), "{kind} {property} {bad}");
    }
}
