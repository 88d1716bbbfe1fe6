//! The same way to stand on the other leg is told once.

use contrapposto::equilibria::{Aim, Equilibria, Mirror, RelaxedPosture, Search, equilibria};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_formats::{RelaxScenario, read_relax};

use crate::common::here;

/// Places of joints, m.
const NEAR: f64 = 0.05;

fn found(scenario: &RelaxScenario, aim: Aim<'static>) -> Equilibria {
    equilibria(&Search { aim, ..scenario.search() }, RelaxScenario::OPTIONS).unwrap()
}

/// Whether all joints of two postures are at the same places.
fn is_near(model: &Model, a: &Posture, b: &Posture) -> bool {
    let places = |posture: &Posture| {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).unwrap();
        (0..model.segments().len()).map(|s| kinematics.placement(model, s).translation.vector).collect::<Vec<_>>()
    };
    places(a).iter().zip(places(b)).all(|(a, b)| (a - b).norm() <= NEAR)
}

/// Places of the first of each pair of mirror images of one effort.
fn pairs(model: &Model, postures: &[RelaxedPosture]) -> Vec<usize> {
    let mirror = Mirror::of(model).unwrap();
    let are_images = |a: &RelaxedPosture, b: &RelaxedPosture| {
        let (least, more) = (a.relaxed.effort, b.relaxed.effort);
        is_near(model, &mirror.posture(&a.relaxed.posture), &b.relaxed.posture) && more <= 1.01 * least
    };
    let has_image = |&i: &usize| postures[i + 1..].iter().any(|later| are_images(&postures[i], later));
    (0..postures.len()).filter(has_image).collect()
}

#[test]
fn mirror_images_of_one_effort_are_one_answer() {
    for name in ["stand-ready.toml", "lean-on-table.toml"] {
        let text = std::fs::read(here().join("../../scenarios").join(name)).unwrap();
        let scenario = read_relax(name, &text, None).unwrap();
        let model = &scenario.model;
        let [all, once] = [Aim::Ways, Aim::WaysOnEitherSide].map(|aim| found(&scenario, aim));
        let first = pairs(model, &all.postures);
        assert!(!first.is_empty(), "{name}: no mirror images among {} postures", all.postures.len());
        assert!(all.postures.iter().all(|posture| !posture.mirrored), "{name}");
        assert_eq!(pairs(model, &once.postures), [0_usize; 0], "{name}");
        for &i in &first {
            let known = once.postures.iter().find(|known| known.relaxed.posture == all.postures[i].relaxed.posture);
            assert!(known.is_some_and(|known| known.mirrored), "{name}: posture {i}");
        }
        let marked = once.postures.iter().filter(|posture| posture.mirrored).count();
        assert_eq!(marked, first.len(), "{name}");
    }
}

/// A body that holds a tool in one hand has two different stances: the other one takes more effort, or the tool is in the other hand.
#[test]
fn stances_beside_a_hand_at_work_are_two_answers() {
    let text = std::fs::read(here().join("../../scenarios/counter.toml")).unwrap();
    let scenario = read_relax("counter.toml", &text, None).unwrap();
    let found = found(&scenario, Aim::WaysOnEitherSide);
    assert!(found.postures.len() > 1 && found.postures.iter().all(|posture| !posture.mirrored));
}
