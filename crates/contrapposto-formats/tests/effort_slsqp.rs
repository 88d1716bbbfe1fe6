//! Compares `relax` with SLSQP of scipy from 50 random starts on the same problems of least effort, and checks what was kept of SLSQP.
//!
//! `data/effort_slsqp.json` is written by `scripts/effort_by_slsqp.py`: of every scenario all runs, and the best posture. Effort, balance,
//! supports and tasks of that posture are computed anew here, so that nothing rests on SLSQP's word. A scenario that changes is to be
//! given to SLSQP again.

use std::path::Path;

use contrapposto::contact::{Balance, ContactForces};
use contrapposto::equilibria::equilibria;
use contrapposto::joint_torques::{JointTorques, Quantities, effort};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Coordinate;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{Task, free_place, held_place};
use contrapposto_formats::{RelaxScenario, read_relax};
use serde_json::Value;

/// The options of the program's `relax`.
const OPTIONS: Options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };
/// Share by which the effort of `relax` may lie above the best of SLSQP.
const MORE: f64 = 0.02;
/// Largest error of a support, a task or a clearance in a kept posture, m and rad.
const HELD: f64 = 1e-6;

/// A scenario, and what SLSQP found.
struct Kept {
    name: String,
    scenario: RelaxScenario,
    /// Effort of the best feasible run.
    effort: f64,
    posture: Posture,
    runs: usize,
}

fn kept() -> Vec<Kept> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = std::fs::read_to_string(here.join("tests/data/effort_slsqp.json")).unwrap();
    let data: Value = serde_json::from_str(&data).unwrap();
    let scenarios = data["scenarios"].as_object().unwrap().iter();
    let read = scenarios.map(|(name, found)| {
        let file = here.join(format!("../../scenarios/{name}.toml"));
        let scenario = read_relax(name, &std::fs::read(file).unwrap(), None).unwrap();
        let of_slsqp = |c: &Coordinate| found["best"]["coordinates"][&c.name].as_f64().unwrap();
        let values = scenario.model.coordinates().iter().map(of_slsqp).collect();
        Kept {
            name: name.clone(),
            effort: found["best"]["effort"].as_f64().unwrap(),
            posture: Posture::new(values),
            runs: found["runs"].as_array().unwrap().len(),
            scenario,
        }
    });
    read.collect()
}

impl Kept {
    /// All tasks above effort, and the task of effort.
    fn tasks(&self) -> (Vec<Task>, Task) {
        let RelaxScenario { model, start, supports, limits, goals, .. } = &self.scenario;
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, start).unwrap();
        let mut tasks: Vec<Task> = supports.iter().map(|support| held_place(support, model, &kinematics)).collect();
        tasks.extend(supports.iter().filter_map(|support| free_place(support, model, &kinematics)));
        tasks.extend(limits.iter().cloned());
        let mut all = goals.iter().flat_map(|level| level.tasks.iter().cloned());
        let effort = loop {
            match all.next().unwrap() {
                task @ Task::Effort(_) => break task,
                task => tasks.push(task),
            }
        };
        (tasks, effort)
    }
}

/// Balance is held, no support, task or clearance is off, and effort is the kept one, in every posture that SLSQP found.
#[test]
fn postures_of_slsqp_are_feasible_and_need_what_is_kept() {
    for kept in kept() {
        let model = &kept.scenario.model;
        let mut contact = ContactForces::new(model, kept.scenario.supports.clone()).unwrap();
        let mut body = JointTorques::new(model);
        let needs = Quantities { gradient: true, ..Quantities::ALL };
        body.update_with_contact(model, &kept.posture, &kept.scenario.loads, &mut contact, needs).unwrap();
        let missing = contact.missing(model, body.kinematics());
        let weight = contact.weight();
        let missing = missing.map_or(0.0, |missing| missing.force.max(missing.moment) / weight);
        let (tasks, of_effort) = kept.tasks();
        let mut errors = vec![];
        tasks.iter().for_each(|task| task.residual(model, &body, &mut errors));
        let worst = errors.iter().fold(0.0f64, |worst, error| worst.max(error.abs()));
        let mut loads = vec![];
        of_effort.residual(model, &body, &mut loads);
        let found = effort(&loads);
        println!(
            "{}: effort {found:.6}, kept {:.6}, errors {worst:.1e}, missing {missing:.1e}",
            kept.name, kept.effort
        );
        assert!(worst <= HELD && missing <= HELD, "{}: {worst} {missing}", kept.name);
        assert!((found / kept.effort - 1.0).abs() <= 1e-4, "{}: {found} {}", kept.name, kept.effort);
        for (coordinate, value) in model.coordinates().iter().zip(kept.posture.values()) {
            let (low, high) = coordinate.range;
            assert!((low - 1e-9..=high + 1e-9).contains(value), "{}: {} {value}", kept.name, coordinate.name);
        }
    }
}

/// From the best posture of SLSQP the engine of `relax` descends to the same effort, or to less: both solve one problem.
#[test]
fn a_descent_from_the_posture_of_slsqp_ends_no_higher() {
    for kept in kept() {
        let RelaxScenario { model, start, supports, limits, goals, loads, locked, .. } = &kept.scenario;
        let options = Options { local_minima: 1, ..OPTIONS };
        let mut engine = Engine::with_supports(model, start, supports.clone(), goals.clone(), loads, options).unwrap();
        locked.iter().for_each(|&rate| engine.lock(rate));
        limits.iter().for_each(|task| engine.limit(task.clone()).unwrap());
        let found = engine.solve(&kept.posture).unwrap();
        println!("{}: SLSQP {:.6}, descent from there {:.6}", kept.name, kept.effort, found.effort);
        assert_eq!(found.balance, Balance::Held, "{}", kept.name);
        assert!(found.slip.length() <= HELD, "{}: {:?}", kept.name, found.slip);
        assert!(found.effort <= kept.effort * 1.001, "{}: {} {}", kept.name, found.effort, kept.effort);
    }
}

/// `relax` needs at most 2 percent more than the best of SLSQP.
#[test]
fn relax_is_within_two_percent_of_slsqp() {
    let all = kept();
    assert!(all.len() >= 4 && all.iter().all(|kept| kept.runs >= 50));
    for kept in all {
        let found = equilibria(&kept.scenario.search(), OPTIONS).unwrap();
        let least = found.postures[0].relaxed.effort;
        let more = least / kept.effort - 1.0;
        println!("{}: relax {least:.6}, SLSQP {:.6}, {:+.1} %", kept.name, kept.effort, 100.0 * more);
        assert!(more <= MORE, "{}: {least} {}", kept.name, kept.effort);
    }
}
