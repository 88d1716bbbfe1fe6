//! Checks supports whose place is free: the search puts a resting foot where effort is least, flat on the floor and within its region.

use std::sync::OnceLock;

use contrapposto::contact::{Place, Region, Support};
use contrapposto::equilibria::{Aim, Equilibria, Search, equilibria};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Sex, adult};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{CenterOfMass, CenterOfMassGoal, Effort, Orientation, PriorityLevel, Task, turned_since};
use nalgebra::Vector3;

/// From side by side to 0.3 m ahead, and 0.2 m aside.
const CORNERS: [[f64; 3]; 4] = [[-0.3, 0.0, -0.08], [0.3, 0.0, -0.08], [0.3, 0.0, -0.3], [-0.3, 0.0, -0.3]];
const TURN: (f64, f64) = (-0.2, 0.6);

struct Waiting {
    model: Model,
    goals: Vec<PriorityLevel>,
}

impl Waiting {
    /// A woman who stands on her right foot, the left one resting, head and chest upright.
    fn new() -> Self {
        let model = adult(&Adult { sex: Sex::Female, stature: 1.65, mass: 60.0, ..Adult::default() }).unwrap();
        let kinematics = kinematics(&model, &model.default_posture());
        let target = Vector3::new(0.03, 0.0, 0.055);
        let goal = CenterOfMassGoal::At { target, axes: [true, false, true] };
        let mut goals = vec![PriorityLevel::from(Task::CenterOfMass(CenterOfMass { goal }))];
        for name in ["head", "torso"] {
            let segment = model.segment(name).unwrap();
            let target = kinematics.placement(&model, segment).rotation;
            goals.push(Task::Orientation(Orientation { segment, target }).into());
        }
        goals.push(Task::Effort(Effort::whole(&model)).into());
        Self { model, goals }
    }

    fn supports(&self, left: Place) -> Vec<Support> {
        let support = |name: &str, share_max: f64, place: Place| {
            let segment = self.model.segment(name).unwrap();
            let corners = self.model.segments()[segment].patch.clone();
            Support { segment, corners, normal: Vector3::y(), friction: 0.6, share_max, place }
        };
        vec![support("calcn_r", 1.0, Place::Fixed), support("calcn_l", 0.15, left)]
    }

    /// The effort of the local minimum near `start` with both feet where they are in it.
    fn effort_near(&self, start: &Posture) -> f64 {
        let (supports, goals) = (self.supports(Place::Fixed), self.goals.clone());
        let options = Options { max_step: 0.1, max_steps: 300, local_minima: 1, ..Options::least_effort() };
        let mut engine = Engine::with_supports(&self.model, start, supports, goals, &[], options).unwrap();
        engine.solve(start).unwrap().effort
    }

    /// `start` with the left foot shifted (m) and turned (rad) on the floor, found without regard to effort.
    fn with_foot_moved(&self, start: &Posture, shift: Vector3<f64>, turn: f64) -> Posture {
        let mut levels = self.goals.clone();
        levels.truncate(self.goals.len() - 1);
        let now = kinematics(&self.model, start);
        let mut feet = PriorityLevel { hard: true, ..PriorityLevel::default() };
        for (name, shift, turn) in [("calcn_r", Vector3::zeros(), 0.0), ("calcn_l", shift, turn)] {
            let segment = self.model.segment(name).unwrap();
            let mut target = now.placement(&self.model, segment);
            target.translation.vector += shift;
            target.rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), turn) * target.rotation;
            feet.tasks.push(Task::Placement(contrapposto::tasks::Placement {
                segment,
                point: Vector3::zeros(),
                target,
            }));
        }
        levels.insert(0, feet);
        let mut engine = Engine::new(&self.model, levels, &[], Options::inverse_kinematics()).unwrap();
        engine.solve(start).unwrap().posture
    }
}

fn kinematics(model: &Model, posture: &Posture) -> Kinematics {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    kinematics
}

fn free() -> Place {
    Place::Free(Region { corners: CORNERS.map(Vector3::from).to_vec(), turn: TURN })
}

/// Found once for all tests, with the left foot fixed and free.
fn found() -> &'static [(Waiting, Equilibria); 2] {
    static FOUND: OnceLock<[(Waiting, Equilibria); 2]> = OnceLock::new();
    FOUND.get_or_init(|| {
        [Place::Fixed, free()].map(|place| {
            let waiting = Waiting::new();
            let (supports, start) = (waiting.supports(place), waiting.model.default_posture());
            let search = Search {
                model: &waiting.model,
                start: &start,
                supports: &supports,
                limits: &[],
                goals: &waiting.goals,
                loads: &[],
                locked: &[],
                most_work: usize::MAX,
                scattered: contrapposto::equilibria::SCATTERED_STARTS,
                aim: Aim::Ways,
                threads: 1,
            };
            let options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };
            let found = equilibria(&search, options).unwrap();
            (waiting, found)
        })
    })
}

#[test]
fn a_free_resting_foot_lets_the_body_stand_at_a_fraction_of_the_effort() {
    let [fixed, free] = found().each_ref().map(|(_, found)| found.postures[0].relaxed.effort);
    println!("least effort {fixed:.4} with the foot fixed, {free:.4} with the foot free");
    assert!(free < 0.3 * fixed, "{free} {fixed}");
}

#[test]
fn every_patch_of_a_free_foot_is_flat_on_the_floor_within_its_region_and_turn() {
    let (Waiting { model, .. }, found) = &found()[1];
    let floor = kinematics(model, &model.default_posture());
    let segment = model.segment("calcn_l").unwrap();
    let corners = &model.segments()[segment].patch;
    let level = floor.station(model, segment, corners[0]).y;
    for found in &found.postures {
        let now = kinematics(model, &found.relaxed.posture);
        let stations: Vec<_> = corners.iter().map(|corner| now.station(model, segment, *corner)).collect();
        assert!(stations.iter().all(|at| (at.y - level).abs() < 1e-6), "{stations:?}");
        let middle = stations.iter().sum::<Vector3<f64>>() / corners.len() as f64;
        assert!(middle.x.abs() < 0.3 + 1e-6 && (-0.3 - 1e-6..=-0.08 + 1e-6).contains(&middle.z), "{middle}");
        let [from, to] = [&floor, &now].map(|kinematics| kinematics.placement(model, segment).rotation);
        let turn = (to * from.inverse()).scaled_axis();
        println!(
            "effort {:.4}: middle at {:.3}, {:.3} m, turned by {:.3} rad",
            found.relaxed.effort, middle.x, middle.z, turn.y
        );
        assert!((TURN.0 - 1e-6..=TURN.1 + 1e-6).contains(&turn.y) && libm::hypot(turn.x, turn.z) < 1e-6, "{turn}");
    }
}

/// The second derivation: the same body with both feet fixed, the left one moved a little every way.
#[test]
fn no_place_near_that_of_a_free_foot_has_less_effort() {
    let (waiting, found) = &found()[1];
    let best = &found.postures[0].relaxed;
    let here = waiting.effort_near(&best.posture);
    assert!((here - best.effort).abs() <= 1e-6 * best.effort, "fixed where it was put: {here}, free: {}", best.effort);
    let (segment, mut tried) = (waiting.model.segment("calcn_l").unwrap(), 0);
    let middle = {
        let corners = &waiting.model.segments()[segment].patch;
        corners.iter().sum::<Vector3<f64>>() / corners.len() as f64
    };
    let at = kinematics(&waiting.model, &best.posture).station(&waiting.model, segment, middle);
    for (x, z, turn) in
        [(0.02, 0.0, 0.0), (-0.02, 0.0, 0.0), (0.0, 0.02, 0.0), (0.0, -0.02, 0.0), (0.0, 0.0, 0.05), (0.0, 0.0, -0.05)]
    {
        let moved = at + Vector3::new(x, 0.0, z);
        let rotation =
            |posture: &Posture| kinematics(&waiting.model, posture).placement(&waiting.model, segment).rotation;
        let start = waiting.model.default_posture();
        let turned = (rotation(&best.posture) * rotation(&start).inverse()).scaled_axis().y + turn;
        if moved.x.abs() > 0.3 || !(-0.3..=-0.08).contains(&moved.z) || turned < TURN.0 || turned > TURN.1 {
            println!("({x:+.2}, {z:+.2}) m, {turn:+.2} rad: outside the region");
            continue;
        }
        tried += 1;
        let effort = waiting.effort_near(&waiting.with_foot_moved(&best.posture, Vector3::new(x, 0.0, z), turn));
        println!("({x:+.2}, {z:+.2}) m, {turn:+.2} rad: effort {effort:.6}, {:.6} at the place found", best.effort);
        assert!(effort > best.effort * (1.0 - 1e-6), "{effort} {}", best.effort);
    }
    assert!(tried >= 3, "{tried}");
}

/// Limits of a turn that are counted from another posture allow the same places: the foot is at a limit in both or in neither.
#[test]
fn limits_of_a_turn_are_the_same_from_another_posture() {
    let waiting = Waiting::new();
    let model = &waiting.model;
    let start = model.default_posture();
    let support = &waiting.supports(free())[1];
    // Half of the outward turn and all of the inward one.
    for turn in [0.3, -0.2] {
        let now = waiting.with_foot_moved(&start, Vector3::new(0.05, 0.0, -0.05), turn);
        let [from, to] = [&start, &now].map(|posture| kinematics(model, posture));
        let moved = turned_since(support, model, &from, &to);
        let (Place::Free(before), Place::Free(after)) = (&support.place, &moved.place) else { panic!() };
        assert_eq!(before.corners, after.corners);
        let expected = (TURN.0 - turn, TURN.1 - turn);
        let off = (after.turn.0 - expected.0).abs().max((after.turn.1 - expected.1).abs());
        assert!(off < 1e-6, "{:?} {expected:?}", after.turn);
    }
}
