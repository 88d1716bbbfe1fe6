//! Things of the world by name: each becomes the loads, supports, tasks and obstacles that the longhand would give.

use crate::common;

use common::complaint;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::simulation::Scenario;
use contrapposto::statics::LoadKind;
use contrapposto::tasks::{Task, Thing};
use contrapposto_formats::{read_run, read_scenario};
use nalgebra::Vector3;

const HEAD: &str = "format = 1\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";

fn read(text: &str) -> Scenario {
    let text = format!("{HEAD}{text}");
    read_scenario("world.toml", text.as_bytes(), None).unwrap_or_else(|e| panic!("{:?}", miette::Report::new(e)))
}

fn refused(text: &str) -> String {
    complaint(&read_scenario("world.toml", format!("{HEAD}{text}").as_bytes(), None).unwrap_err())
}

fn segment(model: &Model, name: &str) -> usize {
    model.segment(name).unwrap()
}

/// Places that points of hands must be at, by the name of the hand.
fn targets(scenario: &Scenario) -> Vec<(String, Vector3<f64>)> {
    let tasks = scenario.tasks.iter().flat_map(|task| &task.goal.tasks);
    let point = |task: &Task| match task {
        Task::Point(point) => Some((scenario.model.segments()[point.segment].name.clone(), point.target)),
        _ => None,
    };
    tasks.filter_map(point).collect()
}

/// Height of every support's patch at the start, m, by the name of its segment.
fn heights(scenario: &Scenario) -> Vec<(String, f64)> {
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &scenario.start).unwrap();
    let height = |support: &contrapposto::contact::Support| {
        let middle = kinematics.station(model, support.segment, support.middle());
        (model.segments()[support.segment].name.clone(), middle.y)
    };
    scenario.supports.iter().map(height).collect()
}

fn found_height(scenario: &Scenario, segment: &str) -> f64 {
    heights(scenario).iter().find(|(name, _)| name == segment).unwrap().1
}

fn assert_heights(scenario: &Scenario, expected: &[(&str, f64)]) {
    let found = heights(scenario);
    assert_eq!(
        found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        expected.iter().map(|e| e.0).collect::<Vec<_>>()
    );
    for ((name, height), (_, expected)) in found.iter().zip(expected) {
        assert!((height - expected).abs() < 1e-3, "{name} is at {height} m, wanted {expected}");
    }
}

#[test]
fn a_box_in_two_hands_is_half_its_weight_and_one_place_on_its_side_for_each() {
    let named = read("[[box]]\nmass_kg = 15\nsize_m = [0.3, 0.25, 0.4]\nat_m = [0.4, 0.3, 0]\n");
    let hands = [("hand_r", 0.2), ("hand_l", -0.2)];
    assert_eq!(named.loads.len(), 2);
    for (load, (hand, _)) in named.loads.iter().zip(hands) {
        assert_eq!((load.segment, load.kind), (segment(&named.model, hand), LoadKind::Weight(7.5)));
    }
    let expected = hands.map(|(hand, z)| (hand.to_owned(), Vector3::new(0.4, 0.3, z)));
    assert_eq!(targets(&named), expected);
    assert!(named.tasks[0].above_relief && named.tasks[0].goal.tasks.len() == 2);
    assert_heights(&named, &[("calcn_r", 0.0), ("calcn_l", 0.0)]);
}

#[test]
fn a_box_without_a_place_is_where_the_hands_are_at_the_start_as_wide_as_it_is() {
    let places = targets(&read("[[box]]\nmass_kg = 5\nsize_m = [0.3, 0.2, 0.5]\n"));
    let apart = places[0].1 - places[1].1;
    assert!((apart - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-12, "{apart}");
    assert!(places[0].1.y > 0.9 && places[0].1.x > 0.2, "{places:?}");
}

#[test]
fn a_push_presses_back_on_both_hands_and_a_pull_of_one_hand_pulls_it() {
    let push = read("[[handle]]\nat_m = [0.5, 1.1, 0]\npush_n = 200\nspacing_m = 0.4\n");
    let force = |scenario: &Scenario| match scenario.loads[0].kind {
        LoadKind::Force(force, _) => force.x,
        _ => panic!("no force"),
    };
    assert_eq!((push.loads.len(), force(&push)), (2, -100.0));
    assert_eq!(targets(&push)[1], ("hand_l".to_owned(), Vector3::new(0.5, 1.1, -0.2)));
    let pull = read("[[handle]]\nat_m = [0.5, 1.1, -0.2]\nhands = \"left\"\npull_n = 80\n");
    assert_eq!((pull.loads.len(), force(&pull)), (1, 80.0));
    assert_eq!(targets(&pull), [("hand_l".to_owned(), Vector3::new(0.5, 1.1, -0.2))]);
}

#[test]
fn a_tool_without_a_place_is_only_carried_and_a_bag_hangs_on_the_side_that_is_named() {
    let named = read("[[tool]]\nhand = \"left\"\nmass_kg = 2\n[[bag]]\nmass_kg = 6\non = \"left_shoulder\"\n");
    assert!(targets(&named).is_empty());
    let loads: Vec<_> = named.loads.iter().map(|load| (load.segment, load.kind, load.point.z < 0.0)).collect();
    let hand = (segment(&named.model, "hand_l"), LoadKind::Weight(2.0));
    let torso = (segment(&named.model, "torso"), LoadKind::Weight(6.0));
    assert_eq!((loads[0].0, loads[0].1), hand);
    assert_eq!(loads[1], (torso.0, torso.1, true));
}

/// The feet that the floor names carry, and no other.
#[test]
fn the_floor_carries_the_feet_that_it_names() {
    for (feet, expected) in
        [("both", &["calcn_r", "calcn_l"][..]), ("right", &["calcn_r"]), ("left", &["calcn_l"]), ("none", &[])]
    {
        let seat = if feet == "none" { "[seat]\nheight_m = 0.45\n" } else { "" };
        let scenario = read(&format!("[floor]\nfeet = \"{feet}\"\n{seat}"));
        let names = scenario.supports.iter().map(|support| scenario.model.segments()[support.segment].name.as_str());
        let feet: Vec<&str> = names.filter(|name| name.starts_with("calcn")).collect();
        assert_eq!(feet, expected);
    }
}

/// A bag weighs where it is worn: in the right half or the left half of the trunk, or behind its middle.
#[test]
fn bags_on_shoulders_and_back_pull_on_the_trunk_where_they_are_worn() {
    let place = |on: &str| {
        let scenario = read(&format!("[floor]\n[[bag]]\nmass_kg = 6\non = \"{on}\"\n"));
        let [load] = &scenario.loads[..] else { panic!("{on}: {:?}", scenario.loads) };
        assert_eq!(
            (&load.kind, &*scenario.model.segments()[load.segment].name),
            (&LoadKind::Weight(6.0), "torso"),
            "{on}"
        );
        load.point
    };
    let [right, left, back] = ["right_shoulder", "left_shoulder", "back"].map(place);
    assert!(right.z > 0.05 && (left.z + right.z).abs() < 1e-12 && (left.y - right.y).abs() < 1e-12, "{right} {left}");
    assert!(back.z == 0.0 && back.x < right.x - 0.05 && back.y < right.y, "{back} {right}");
}

#[test]
fn a_seat_without_a_posture_has_the_sitter_on_it_with_both_feet_on_the_floor() {
    for height in [0.35, 0.43, 0.55] {
        let named = read(&format!("[seat]\nheight_m = {height}\nbackrest = true\narmrests_m = {}\n", height + 0.30));
        let bones = |name: &str| found_height(&named, name);
        let arms = bones("radius_r");
        assert!((0.32..0.36).contains(&(arms - height)), "half a forearm above the armrest: {arms}");
        let found = heights(&named);
        let back = found.iter().find(|(name, _)| name == "torso").unwrap().1;
        assert!(back > height + 0.2, "{back}");
        let expected = [
            ("calcn_r", 0.0),
            ("calcn_l", 0.0),
            ("pelvis", height),
            ("torso", back),
            ("radius_r", arms),
            ("radius_l", arms),
        ];
        assert_heights(&named, &expected);
        let value = |name: &str| named.start.values()[named.model.coordinate(name).unwrap()].to_degrees();
        assert!(
            (value("hip_flexion_r") + value("pelvis_tilt") - value("knee_angle_r")).abs() < 20.0,
            "shanks are upright"
        );
    }
}

#[test]
fn hands_rest_on_a_table_on_a_counter_and_on_a_wall_without_a_posture() {
    let hands = "carries = [\"right_hand\", \"left_hand\"]";
    for height in [0.7, 0.9, 1.0] {
        let named = read(&format!("[[table]]\nheight_m = {height}\nedge_m = 0.3\n{hands}\n"));
        assert_heights(&named, &[("calcn_r", 0.0), ("calcn_l", 0.0), ("hand_r", height), ("hand_l", height)]);
    }
    let wall = read(&format!("[[wall]]\nahead_m = 0.5\n{hands}\n"));
    assert_eq!(wall.supports[2].normal, Vector3::new(-1.0, 0.0, 0.0));
    let leaning = read("[[wall]]\nbehind_m = 0.15\ncarries = [\"back\"]\n");
    assert_eq!(leaning.supports[2].segment, segment(&leaning.model, "torso"));
}

#[test]
fn a_step_is_under_its_foot_and_the_other_foot_stands_on_the_floor_a_stride_apart_where_asked() {
    for height in [0.1, 0.2, 0.35] {
        let named = read(&format!("[[step]]\nheight_m = {height}\nunder = \"right_foot\"\n"));
        assert_heights(&named, &[("calcn_l", 0.0), ("calcn_r", height)]);
    }
    let stride = read("[floor]\nstride_m = 0.4\nahead = \"left_foot\"\n");
    let mut kinematics = Kinematics::new(&stride.model);
    kinematics.update(&stride.model, &stride.start).unwrap();
    let ahead = |i: usize| {
        let support = &stride.supports[i];
        kinematics.station(&stride.model, support.segment, support.middle()).x
    };
    assert!((ahead(1) - ahead(0) - 0.4).abs() < 1e-3, "{} {}", ahead(0), ahead(1));
}

#[test]
fn tables_and_seats_are_obstacles_and_feet_may_step_where_the_floor_lets_them() {
    let named = read("[floor]\nmay_step = true\n[[counter]]\nheight_m = 0.95\nedge_m = 0.4\n");
    let Task::Clearance(limits) = &named.limits[0] else { panic!("no limits") };
    let block = |thing: &Thing| matches!(thing, Thing::Block { half, .. } if (half.y - 0.02).abs() < 1e-12);
    let things = limits
        .pairs
        .iter()
        .filter(|pair| matches!(&pair.other, contrapposto::tasks::Obstacle::Thing(thing) if block(thing)));
    assert!(things.count() > 0);
    assert!(named.supports.iter().all(|support| support.place != contrapposto::contact::Place::Fixed));
}

#[test]
fn the_first_task_of_an_event_is_the_first_of_the_file_beside_things_that_have_tasks() {
    let text = "[[box]]\nmass_kg = 2\nsize_m = [0.3, 0.2, 0.4]\nat_m = [0.4, 1, 0]\n[[task]]\nkind = \"look_at\"\n\
                target_m = [1, 1, 0]\n[[event]]\nat_s = 0.5\ntask = 1\ntarget_m = [1, 2, 0]\n";
    let named = read(text);
    assert_eq!(named.events[0].tasks[0].0, 1, "level 0 is the box");
}

#[test]
fn wrong_numbers_of_things_are_refused_at_their_key_with_the_accepted_range() {
    let cases = [
        ("[[table]]\nheight_m = 75\nedge_m = 0.3\n", "height_m is 75 m; it must lie in 0..2.5 m"),
        ("[[table]]\nheight_m = 75\nedge_m = 0.3\n", "0.75 m? lengths are in metres"),
        ("[[box]]\nmass_kg = -4\nsize_m = [1, 1, 1]\n", "mass_kg is -4 kg; it must lie in 0..1000000000 kg"),
        ("[[box]]\nmass_kg = 1\nsize_m = [1, 1]\n", "2 numbers are given; 3 are due"),
        ("[[tool]]\nhand = \"right\"\n", "neither mass nor force nor place"),
        ("[[handle]]\nat_m = [0.5, 1, 0]\npush_n = 1\npull_n = 1\n", "both pushed and pulled"),
        ("[[wall]]\ncarries = [\"back\"]\n", "is said 0 times"),
        ("[seat]\nheight_m = 0.4\nbackrest_deg = 100\n", "no backrest"),
        ("[seat]\nheight_m = 0.43\narmrests_m = 0.6\n", "the arms of this body reach armrests of"),
        (
            "[seat]\nheight_m = 0.45\nbackrest = true\n[[table]]\nheight_m = 0.72\nedge_m = 0.25\ncarries = [\"right_forearm\", \"left_forearm\"]\n",
            "no start was found in which all parts rest on their things: bring the things nearer",
        ),
        ("[[step]]\nheight_m = 0.2\nunder = \"right_hand\"\n", "unknown value `right_hand`"),
        ("[floor]\nfeet = \"both\"\n[[step]]\nheight_m = 0.2\nunder = \"left_foot\"\n", "is a support already"),
    ];
    for (text, expected) in cases {
        let found = refused(text);
        assert!(found.contains(expected), "{text}: {found}");
        assert!(found.contains("label at line") && !found.contains("label at line 1,"), "no place: {found}");
    }
}

#[test]
fn everyday_mistakes_get_the_number_or_the_name_that_was_meant() {
    let adult = |stature: &str| {
        let text = format!("format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = {stature}, mass_kg = 75 }}\n");
        complaint(&read_scenario("world.toml", text.as_bytes(), None).unwrap_err())
    };
    assert!(adult("175").contains("1.75 m? lengths are in metres"), "{}", adult("175"));
    assert!(adult("1,75").contains("the decimal mark is a point: 1.75"), "{}", adult("1,75"));
    for (word, segment) in [("right_hand", "hand_r"), ("left_foot", "calcn_l"), ("back", "torso")] {
        let found = refused(&format!("[[load]]\nsegment = \"{word}\"\nmass_kg = 1\n"));
        assert!(found.contains(&format!("did you mean `{segment}`?")), "{found}");
    }
}

#[test]
fn a_place_of_a_hand_in_centimetres_gets_a_note_and_one_in_metres_none() {
    let notes = |height: &str| {
        let text = format!("{HEAD}[[tool]]\nhand = \"right\"\nat_m = [0.3, {height}, 0.2]\n");
        read_run("world.toml", text.as_bytes(), None).unwrap().notes
    };
    assert!(notes("195").iter().any(|note| note.contains("m away from the body")));
    assert!(!notes("1.95").iter().any(|note| note.contains("m away")));
}

fn drawn(text: &str) -> (Scenario, Vec<contrapposto_formats::Thing>) {
    let text = format!("{HEAD}{text}");
    let run = read_run("world.toml", text.as_bytes(), None).unwrap_or_else(|e| panic!("{:?}", miette::Report::new(e)));
    (run.scenario, run.things)
}

/// Heights of the lowest and the highest corner of a thing where the body starts, m.
fn low_and_high(scenario: &Scenario, thing: &contrapposto_formats::Thing) -> [f64; 2] {
    let mut kinematics = Kinematics::new(&scenario.model);
    kinematics.update(&scenario.model, &scenario.start).unwrap();
    let place = thing.place_by(|segment| kinematics.placement(&scenario.model, segment));
    let corners = (0..8).map(|i| {
        let half = Vector3::from_fn(|k, _| if i >> k & 1 == 0 { -0.5 } else { 0.5 } * thing.size[k]);
        (place * nalgebra::Point3::from(half)).y
    });
    corners.fold([f64::MAX, f64::MIN], |[low, high], y| [low.min(y), high.max(y)])
}

#[test]
fn things_are_drawn_where_they_carry_and_where_they_are_held() {
    let seat =
        "[seat]\nheight_m = 0.43\nbackrest = true\narmrests_m = 0.72\n[[table]]\nheight_m = 0.74\nedge_m = 0.3\n";
    let (scenario, things) = drawn(seat);
    let of = |name: &str| things.iter().filter(|thing| thing.name == name).collect::<Vec<_>>();
    assert_eq!(["seat", "backrest", "armrest", "table"].map(|name| of(name).len()), [2, 1, 2, 5]);
    let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 0.006, "{found} for {wanted}");
    for rest in of("armrest") {
        near(low_and_high(&scenario, rest)[1], 0.72);
    }
    near(low_and_high(&scenario, of("seat")[0])[1], 0.43);
    for leg in of("table").into_iter().chain(of("seat")).filter(|thing| thing.size.x < 0.05) {
        near(low_and_high(&scenario, leg)[0], 0.0);
    }
    // The corners of the back's patch are on the face of the backrest.
    let mut kinematics = Kinematics::new(&scenario.model);
    kinematics.update(&scenario.model, &scenario.start).unwrap();
    let back = scenario.supports.iter().find(|s| scenario.model.segments()[s.segment].name == "torso").unwrap();
    let backrest = of("backrest")[0];
    for corner in &back.corners {
        let at = kinematics.station(&scenario.model, back.segment, *corner);
        let inside = backrest.place.inverse_transform_point(&at.into());
        assert!((inside.x - 0.5 * backrest.size.x).abs() < 0.02 && inside.y.abs() < 0.5 * backrest.size.y, "{inside}");
    }
    // A tool that is pressed upwards has its tip above the fist; a bag hangs below it.
    let (scenario, things) = drawn("[[tool]]\nhand = \"right\"\nforce_n = [0, -40, 0]\nat_m = [0.35, 1.8, 0.2]\n");
    let tip = low_and_high(&scenario, &things[1]);
    assert!(things.len() == 2 && tip[1] > 1.95 && tip[1] < 2.1, "{tip:?}");
    let (scenario, things) = drawn("[[bag]]\nmass_kg = 6\non = \"right_hand\"\n");
    let [bag, strap] = [0, 1].map(|i| low_and_high(&scenario, &things[i]));
    near(bag[1] - bag[0], 0.26);
    near(strap[0], bag[1]);
}

/// The start that a posture does not give: straight knees for hands above the hips, bent ones for hands below them.
#[test]
fn knees_begin_the_more_bent_the_deeper_a_box_is() {
    let knee = |height: f64| {
        let text = format!("[[box]]\nmass_kg = 1\nsize_m = [0.3, 0.2, 0.4]\nat_m = [0.4, {height}, 0]\n");
        let named = read(&text);
        named.start.values()[named.model.coordinate("knee_angle_r").unwrap()].to_degrees()
    };
    let [high, middle, low, floor] = [1.2, 0.7, 0.5, 0.3].map(knee);
    println!("{high:.1} {middle:.1} {low:.1} {floor:.1}");
    assert!(high.abs() < 5.0, "{high}");
    assert!(middle > high + 5.0 && low > middle + 5.0 && floor > low + 2.0, "{high} {middle} {low} {floor}");
}
