//! No part of a body is in another one, or in the floor, from the start to the end of any scenario of the repository, nor in the
//! postures of least effort; distances by dense sampling of the parts' lines.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Capsule, Model};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Scenario, run};
use contrapposto::tasks::{Clearance, ClearancePair, Obstacle, Task, Thing};
use contrapposto_formats::{read_pose, read_relax, read_scenario};
use nalgebra::Vector3;

use crate::common::runs::{Course, Kept, courses, searches};

/// Deepest overlap that counts as none, m.
const DEEPEST: f64 = 1e-3;

fn points(model: &Model, kinematics: &Kinematics, capsule: &Capsule) -> Vec<Vector3<f64>> {
    let [a, b] = capsule.ends.map(|end| kinematics.station(model, capsule.segment, end));
    (0..=100).map(|i| a + 0.01 * f64::from(i) * (b - a)).collect()
}

/// The deepest overlap of two parts, or of a part and the floor, m, and its names. Parts that carry the body, and soles, are left
/// out with the floor.
fn deepest(model: &Model, posture: &[f64], carrying: &[usize]) -> (f64, String) {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(posture.to_vec())).unwrap();
    let shapes = model.shapes();
    let lines: Vec<_> = shapes.iter().map(|shape| points(model, &kinematics, &shape.capsule)).collect();
    let mut deepest = (f64::NEG_INFINITY, String::new());
    let mut see = |distance: f64, names: [&str; 2]| {
        if -distance > deepest.0 {
            deepest = (-distance, names.join(" in "));
        }
    };
    for &(a, b) in model.meeting_shapes() {
        let all = lines[a].iter().flat_map(|p| lines[b].iter().map(move |q| (p - q).norm()));
        let radii = shapes[a].capsule.radius + shapes[b].capsule.radius;
        see(all.fold(f64::INFINITY, f64::min) - radii, [&shapes[a].name, &shapes[b].name]);
    }
    for (shape, line) in shapes.iter().zip(&lines) {
        if !shape.sole && !carrying.contains(&shape.capsule.segment) {
            let lowest = line.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
            see(lowest - shape.capsule.radius, [&shape.name, "floor"]);
        }
    }
    deepest
}

/// The deepest point of a part in a block, m, below the block's nearest face; only of parts that may not touch it.
fn deepest_in_blocks(model: &Model, posture: &[f64], limits: &[Task]) -> f64 {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(posture.to_vec())).unwrap();
    let pairs = limits.iter().flat_map(|task| match task {
        Task::Clearance(clearance) => &clearance.pairs[..],
        _ => &[],
    });
    let depth = |pair: &ClearancePair| {
        let Obstacle::Thing(Thing::Block { placement, half }) = pair.other else { return f64::NEG_INFINITY };
        let line = points(model, &kinematics, &pair.part).into_iter();
        let distance = |point: Vector3<f64>| {
            let beyond = placement.inverse_transform_point(&point.into()).coords.abs() - half;
            let out = beyond.map(|x| x.max(0.0)).norm();
            if out > 0.0 { out } else { beyond.max() }
        };
        pair.part.radius - line.map(distance).fold(f64::INFINITY, f64::min)
    };
    pairs.map(depth).fold(f64::NEG_INFINITY, f64::max)
}

fn assert_apart(what: &str, model: &Model, posture: &[f64], carrying: &[usize], limits: &[Task]) {
    let in_blocks = deepest_in_blocks(model, posture, limits);
    assert!(in_blocks < DEEPEST, "{what}: in a block by {:.1} mm", 1e3 * in_blocks);
    let (depth, names) = deepest(model, posture, carrying);
    println!("{what}: {:.2} mm ({names})", 1e3 * depth);
    assert!(depth < DEEPEST, "{what}: {names} by {:.1} mm", 1e3 * depth);
}

/// The limits of a scenario in which hands that may rest have been put down: these touch things, as those do that carry from the start
/// (`rests.rs` looks at their palms).
fn touching(scenario: &Scenario) -> Vec<Task> {
    let hands: Vec<usize> = scenario.rests.iter().map(|rest| scenario.supports[rest.support].segment).collect();
    let limit = |task: &Task| match task {
        Task::Clearance(clearance) if !hands.is_empty() => {
            Task::Clearance(clearance.with_carrying(&scenario.model, &hands))
        }
        _ => task.clone(),
    };
    scenario.limits.iter().map(limit).collect()
}

/// Whether the body moves as a whole: a single joint moves by the tables alone.
fn is_whole(supports: usize, tasks: usize) -> bool {
    supports > 0 || tasks > 0
}

#[test]
fn every_second_of_every_run_has_no_part_in_another_or_in_the_floor() {
    let mut runs = 0;
    for Course { name, scenario, postures, .. } in courses() {
        // Bodies of files have no parts that may meet.
        if !is_whole(scenario.supports.len(), scenario.tasks.len()) || scenario.model.shapes().is_empty() {
            continue;
        }
        assert!(matches!(&scenario.limits[..], [Task::Clearance(_)]), "{name}");
        let carrying: Vec<usize> = scenario.supports.iter().map(|support| support.segment).collect();
        let touching = touching(scenario);
        let limits = |put_down| if put_down { &touching } else { &scenario.limits };
        let (mut worst, mut blocks) = ((f64::NEG_INFINITY, String::new()), f64::NEG_INFINITY);
        for Kept { values, put_down } in postures {
            let now = deepest(&scenario.model, values, &carrying);
            blocks = blocks.max(deepest_in_blocks(&scenario.model, values, limits(*put_down)));
            worst = if now.0 > worst.0 { now } else { worst };
        }
        let kept = postures.len();
        println!("{name}, {kept} postures: {:.2} mm ({}), in a block {:.2} mm", 1e3 * worst.0, worst.1, 1e3 * blocks);
        assert!(blocks < DEEPEST, "{name}: in a block by {:.1} mm", 1e3 * blocks);
        assert!(worst.0 < DEEPEST, "{name}: {} by {:.1} mm", worst.1, 1e3 * worst.0);
        runs += 1;
    }
    assert!(runs >= 9, "{runs}");
}

#[test]
fn postures_of_least_effort_have_no_part_in_another_or_in_the_floor() {
    for (name, scenario, found) in searches() {
        let carrying: Vec<usize> = scenario.supports.iter().map(|support| support.segment).collect();
        for (i, posture) in found.postures.iter().enumerate() {
            let values = posture.relaxed.posture.values();
            let what = format!("{name}, posture {}", i + 1);
            assert_apart(&what, &scenario.model, values, &carrying, &scenario.limits);
        }
    }
    assert!(searches().len() >= 9, "{}", searches().len());
}

/// The hand of a pose is wanted inside the trunk: it stays outside, and comes as near as it can.
#[test]
fn pose_with_the_hand_wanted_in_the_abdomen_keeps_the_hand_outside() {
    let text = "format = 1\n[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n\
        [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\nat_m = [0, -0.1, 0]\ntarget_m = [0.05, 1.1, 0.05]\n\
        [posture]\nelbow_flex_r_deg = 90\narm_rot_r_deg = 30\n[coordinates]\nfree = [\"arm_flex_r\", \"arm_add_r\", \"arm_rot_r\", \"elbow_flex_r\", \"wrist_flex_r\"]\n";
    let solve = |text: &str| {
        let scenario = read_pose("in the abdomen", text.as_bytes(), None).unwrap();
        let (levels, limits) = scenario.levels();
        let mut engine =
            contrapposto::posture_solver::Engine::new(&scenario.model, levels, &[], scenario.options).unwrap();
        scenario.locked.iter().for_each(|&rate| engine.lock(rate));
        let solved = engine.solve(&scenario.start).unwrap();
        let left = solved.levels.last().unwrap().length;
        (deepest(&scenario.model, solved.posture.values(), &[]), left, limits)
    };
    let (apart, left, limits) = solve(text);
    let (through, reached, none) = solve(&format!("{text}[model]\nclearance = false\n"));
    println!("{apart:?}, {left} m from the target; without clearance {through:?}, {reached} m");
    assert!(apart.0 < DEEPEST && (0.01..0.3).contains(&left) && limits == Some(1));
    assert!(through.0 > 0.02 && reached < 1e-6 && none.is_none());
}

/// A hand wanted inside the top of a table, from above: it stops on the table.
#[test]
fn pose_with_the_hand_wanted_inside_a_table_stops_on_it() {
    let text = "format = 1\n[posture]\nelbow_flex_r_deg = 90\n[[support]]\nsegment = \"calcn_r\"\n[[support]]\n\
        segment = \"calcn_l\"\n[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\nat_m = [0, -0.1, 0]\n\
        target_m = [0.45, 0.9, 0.2]\n[[obstacle]]\nname = \"table\"\nmiddle_m = [0.6, 0.9, 0]\nsize_m = [0.6, 0.1, 1.4]\n";
    let scenario = read_pose("on the table", text.as_bytes(), None).unwrap();
    let (levels, _) = scenario.levels();
    let mut engine = contrapposto::posture_solver::Engine::new(&scenario.model, levels, &[], scenario.options).unwrap();
    let solved = engine.solve(&scenario.start).unwrap();
    let depth = deepest_in_blocks(&scenario.model, solved.posture.values(), &scenario.limits);
    let left = solved.levels.iter().map(|level| level.length).fold(0.0, f64::max);
    println!("{:.2} mm in the table, {left} m from the target after {} steps", 1e3 * depth, solved.steps);
    assert!(depth.abs() < DEEPEST && (0.02..0.2).contains(&left));
}

/// A start with the forearm in the thigh is no error: the run begins by moving it out.
#[test]
fn run_from_an_overlap_moves_the_parts_apart() {
    let text = "format = 1\n[posture]\narm_add_r_deg = 8\narm_flex_r_deg = 5\n[[support]]\nsegment = \"calcn_r\"\n\
        [[support]]\nsegment = \"calcn_l\"\n[[task]]\nkind = \"effort\"\n[strategy]\nkind = \"passive\"\n\
        [run]\nduration_s = 10\n";
    let scenario = read_scenario("overlap", text.as_bytes(), None).unwrap();
    let start = deepest(&scenario.model, scenario.start.values(), &[]);
    let mut last = vec![];
    run(&scenario, |sample| last = sample.posture.to_vec()).unwrap();
    let end = deepest(&scenario.model, &last, &[]);
    println!("start {start:?}, end {end:?}");
    assert!(start.0 > 0.01 && end.0 < DEEPEST);
}

/// Walls and blocks of a file become pairs; what is neither is refused with its place.
#[test]
fn obstacles_of_a_file_become_pairs() {
    let head = "format = 1\n[[support]]\nsegment = \"calcn_r\"\n[[task]]\nkind = \"effort\"\n";
    let pairs = |text: &str| {
        let scenario = read_relax("obstacle", format!("{head}{text}").as_bytes(), None);
        scenario.map(|scenario| match &scenario.limits[..] {
            [Task::Clearance(Clearance { pairs, .. })] => pairs.len(),
            _ => 0,
        })
    };
    let none = pairs("").unwrap();
    let block = "[[obstacle]]\nname = \"table\"\nmiddle_m = [0.6, 0.7, 0]\nsize_m = [0.6, 0.04, 1.2]\nturn_deg = 10\n";
    let wall = "[[obstacle]]\nname = \"wall\"\nnormal = [1, 0, 0]\npoint_m = [-0.4, 0, 0]\n";
    assert!(pairs(block).unwrap() > none && pairs(wall).unwrap() > pairs(block).unwrap());
    assert_eq!(pairs("[model]\nclearance = false\n").unwrap(), 0);
    for (wrong, message) in [
        ("[[obstacle]]\nname = \"table\"\nmiddle_m = [0.6, 0.7, 0]\n", "neither a block nor a wall"),
        ("[[obstacle]]\nname = \"t\"\nmiddle_m = [0, 0, 0]\nsize_m = [1, 0, 1]\n", "greater than 0"),
        ("[[obstacle]]\nname = \"w\"\nnormal = [0, 0, 0]\npoint_m = [0, 0, 0]\n", "has no length"),
        (
            "[model]\nclearance = false\n[[obstacle]]\nname = \"w\"\nnormal = [0, 1, 0]\npoint_m = [0, 0, 0]\n",
            "passes through",
        ),
    ] {
        let error = format!("{:?}", miette::Report::new(pairs(wrong).unwrap_err()));
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn a_block_among_the_obstacles_is_a_thing_of_its_size_and_place_and_a_wall_is_none() {
    let text = "format = 1\n[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 60 }\n[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n\
        [[task]]\nkind = \"effort\"\n[[obstacle]]\nname = \"table\"\nmiddle_m = [0.6, 0.7, 0.1]\nsize_m = [0.7, 0.03, 1.4]\n\
        [[obstacle]]\nname = \"wall\"\nnormal = [1, 0, 0]\npoint_m = [-1, 0, 0]\n";
    let things = contrapposto_formats::read_relax("a.toml", text.as_bytes(), None).unwrap().things;
    assert_eq!(things.len(), 1);
    assert_eq!((things[0].name.as_str(), things[0].segment), ("table", None));
    assert!((things[0].size - nalgebra::Vector3::new(0.7, 0.03, 1.4)).norm() < 1e-12);
    assert!((things[0].place.translation.vector - nalgebra::Vector3::new(0.6, 0.7, 0.1)).norm() < 1e-12);
}
