//! The reader of pose scenarios: every kind of task means what docs/scenario.md says, every mistake is refused where it
//! stands, and any bytes give a value or an error.

use crate::common;

use std::path::Path;

use common::complaint;
use common::toml::hammer_toml;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{CenterOfMassGoal, LookAtGoal, Task};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{InputError, PoseScenario, read_pose, read_scenario, scenario_model, scenario_schema};
use nalgebra::Vector3;

const HEAD: &str = "format = 1\n";

/// A scenario of these lines after the first, which says the format.
fn read(lines: &str) -> Result<PoseScenario, InputError> {
    read_pose("pose.toml", format!("{HEAD}{lines}").as_bytes(), None)
}

fn good(lines: &str) -> PoseScenario {
    read(lines).unwrap_or_else(|error| panic!("{}\n{lines}", complaint(&error)))
}

fn task(lines: &str) -> Task {
    good(&format!("[[task]]\n{lines}")).goals.remove(0).tasks.remove(0)
}

fn at_default(model: &Model, name: &str) -> contrapposto::model::Placement {
    Kinematics::new(model).placement(model, model.segment(name).unwrap())
}

/// One of everything.
const FULL: &str = r#"title = "Every kind"
[model]
adult = { sex = "male", stature_m = 1.8, mass_kg = 80 }
[posture]
elbow_flex_r_deg = 20
pelvis_ty_m = 0.95
[coordinates]
locked = ["mtp_angle_r", "mtp_angle_l"]
[[load]]
segment = "hand_r"
mass_kg = 2
[[support]]
segment = "calcn_r"
on = "ground"
friction = 0.6
share_max = 0.9
[[support]]
segment = "calcn_l"
[[task]]
kind = "center_of_mass"
margin_m = 0.01
above_relief = true
[[task]]
kind = "point"
segment = "hand_r"
at_m = [0, -0.07, 0]
target_m = [0.4, 1.3, 0.2]
axes = "xy"
[[task]]
kind = "look_at"
target_m = [2, 1.4, 0]
eye_m = [0.1, 0.1, 0]
direction = [2, 0, 0]
same_priority = true
[[task]]
kind = "orientation"
segment = "torso"
target_deg = [0, 30, 0]
[[task]]
kind = "placement"
segment = "hand_l"
target_m = [0.2, 1.0, -0.3]
target_quaternion = [1, 0, 0, 0]
[[task]]
kind = "distance"
a = { segment = "hand_r" }
b = { segment = "hand_l", at_m = [0, -0.05, 0] }
range_m = [0.2, 0.6]
[[task]]
kind = "posture"
weights = { elbow_flex_l = 2.5, neck_rotation = 0 }
[task.values]
elbow_flex_l_deg = 90
[[task]]
kind = "effort"
[solver]
max_step_deg = 20
max_steps = 50
still = 1e-8
reached = 1e-5
"#;

#[test]
fn everything_is_read() {
    let scenario = good(FULL);
    let model = &scenario.model;
    assert_eq!(scenario.title, "Every kind");
    assert_eq!(
        scenario.labels,
        [
            vec!["support calcn_r", "support calcn_l"],
            vec!["center_of_mass"],
            vec!["point hand_r", "look_at head"],
            vec!["orientation torso"],
            vec!["placement hand_l"],
            vec!["distance hand_r hand_l"],
            vec!["posture"],
            vec!["humerus_r rhythm", "humerus_l rhythm"],
            vec!["effort"],
        ]
    );
    let hard: Vec<bool> = scenario.goals.iter().map(|goal| goal.hard).collect();
    assert_eq!(hard, [true, false, false, false, false, false, false, false, false]);
    // Moved from 0.95, where the soles were below the floor.
    assert!((scenario.start.values()[model.coordinate("pelvis_ty").unwrap()] - 0.961_929).abs() < 1e-9);
    assert_eq!(scenario.loads.len(), 1);
    let mut locked: Vec<&str> = scenario.locked.iter().map(|&rate| model.rates()[rate].name.as_str()).collect();
    locked.sort_unstable();
    assert_eq!(locked, ["mtp_angle_l", "mtp_angle_r"]);
    let options = scenario.options;
    assert!((options.max_step.to_degrees() - 20.0).abs() < 1e-12);
    assert_eq!((options.max_steps, options.step_tolerance, options.level_tolerance), (50, 1e-8, 1e-5));
    assert!(scenario.unused.is_empty());

    let Task::Point(point) = &scenario.goals[2].tasks[0] else { panic!() };
    assert_eq!(point.axes, [true, true, false]);
    assert_eq!((point.point.y, point.target.z), (-0.07, 0.2));
    let Task::LookAt(look) = &scenario.goals[2].tasks[1] else { panic!() };
    assert_eq!((look.direction.x, look.eye.x, look.goal), (1.0, 0.1, LookAtGoal::Place([2.0, 1.4, 0.0].into())));
    let Task::Orientation(turn) = &scenario.goals[3].tasks[0] else { panic!() };
    assert!((turn.target.scaled_axis().y.to_degrees() - 30.0).abs() < 1e-9);
    let Task::Distance(distance) = &scenario.goals[5].tasks[0] else { panic!() };
    assert_eq!((distance.lower, distance.upper, distance.b.1.y), (0.2, 0.6, -0.05));
    let Task::Posture(posture) = &scenario.goals[6].tasks[0] else { panic!() };
    let [elbow, neck] = ["elbow_flex_l", "neck_rotation"].map(|name| model.coordinate(name).unwrap());
    assert_eq!(posture.weights[model.coordinates()[elbow].rate.unwrap()], 2.5);
    assert_eq!(posture.weights[model.coordinates()[neck].rate.unwrap()], 0.0);
    assert!((posture.target.values()[elbow].to_degrees() - 90.0).abs() < 1e-9);
    assert_eq!(posture.target.values()[neck], scenario.start.values()[neck]);
    let Task::Effort(effort) = &scenario.goals[8].tasks[0] else { panic!() };
    assert!(effort.coordinates.len() > 20);
    // What was read is what the engine takes.
    Engine::new(model, scenario.goals.clone(), &scenario.loads, options).unwrap().solve(&scenario.start).unwrap();
}

#[test]
fn defaults_are_those_of_the_page() {
    let Task::LookAt(look) = task("kind = \"look_at\"\ntarget_m = [2, 1, 0]\n") else { panic!() };
    let model = good("[[task]]\nkind = \"posture\"\n").model;
    assert_eq!(model.segments()[look.segment].name, "head");
    assert_eq!(look.eye, model.segments()[look.segment].center_of_mass);
    assert_eq!(look.direction.x, 1.0);
    // A palm that faces down: the direction in ground has the length 1, whatever its length in the file.
    let palm = "kind = \"look_at\"\nsegment = \"hand_r\"\ndirection = [0, 0, -1]\ntarget_direction = [0, -3, 0]\n";
    let Task::LookAt(look) = task(palm) else { panic!() };
    assert_eq!((look.direction.z, look.goal), (-1.0, LookAtGoal::Direction(-Vector3::y_axis())));
    let hand = at_default(&model, "hand_r");
    let Task::Point(point) = task("kind = \"point\"\nsegment = \"hand_r\"\ntarget = \"start\"\n") else { panic!() };
    assert_eq!((point.target, point.axes), (hand.translation.vector, [true; 3]));
    let Task::Placement(placement) = task("kind = \"placement\"\nsegment = \"hand_r\"\ntarget = \"start\"\n") else {
        panic!()
    };
    assert_eq!(placement.target, hand);
    // A new place, turned as at the start.
    let lines = "kind = \"placement\"\nsegment = \"hand_r\"\ntarget_m = [0.3, 1, 0.2]\ntarget = \"start\"\n";
    let Task::Placement(placement) = task(lines) else { panic!() };
    assert_eq!((placement.target.translation.x, placement.target.rotation), (0.3, hand.rotation));
    let Task::Distance(distance) =
        task("kind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_l\" }\ndistance_m = 0.3\n")
    else {
        panic!()
    };
    assert_eq!((distance.lower, distance.upper), (0.3, 0.3));
    let Task::CenterOfMass(center) = task("kind = \"center_of_mass\"\ntarget = \"start\"\naxes = \"xz\"\n") else {
        panic!()
    };
    let CenterOfMassGoal::At { target, axes } = center.goal else { panic!() };
    assert_eq!((Some(target), axes), (Kinematics::new(&model).center_of_mass(&model), [true, false, true]));
    let Task::Posture(posture) = task("kind = \"posture\"\ncoordinates = [\"elbow_flex_r\"]\n") else { panic!() };
    assert_eq!(posture.weights.iter().sum::<f64>(), 1.0);
}

/// Turns about ground axes, x first, then y, then z: a point on the x axis goes to z by the turn about y, and to y by none.
#[test]
fn degrees_turn_about_x_then_y_then_z() {
    let Task::Orientation(turn) = task("kind = \"orientation\"\nsegment = \"torso\"\ntarget_deg = [90, 90, 0]\n")
    else {
        panic!()
    };
    // About x: y goes to z. About y: z goes to x.
    let y = turn.target * nalgebra::Vector3::y();
    assert!((y - nalgebra::Vector3::x()).norm() < 1e-12, "{y}");
}

#[test]
fn polygons_are_horizontal() {
    let lines = "kind = \"center_of_mass\"\npolygon_m = [[-0.1, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.1, 0.2]]\n";
    let Task::CenterOfMass(center) = task(lines) else { panic!() };
    let CenterOfMassGoal::Inside { polygon, margin } = center.goal else { panic!() };
    assert_eq!((polygon.len(), margin), (4, 0.0));
    let inside = |x, y, z| polygon.iter().all(|edge| edge.excess(&nalgebra::Vector3::new(x, y, z)) <= 0.0);
    assert!(inside(0.19, 1.0, 0.19) && !inside(0.21, 1.0, 0.0) && !inside(0.0, 1.0, -0.21));
    // Around the patches of both feet, as they lie at the start.
    let scenario = good(&format!("{TWO_FEET}[[task]]\nkind = \"center_of_mass\"\n"));
    let Task::CenterOfMass(center) = &scenario.goals[1].tasks[0] else { panic!() };
    let CenterOfMassGoal::Inside { polygon, .. } = &center.goal else { panic!() };
    let corners: Vec<nalgebra::Vector3<f64>> = ["calcn_r", "calcn_l"]
        .into_iter()
        .flat_map(|name| {
            let foot = at_default(&scenario.model, name);
            let patch = scenario.model.segments()[scenario.model.segment(name).unwrap()].patch.clone();
            patch.into_iter().map(move |corner| (foot * nalgebra::Point3::from(corner)).coords)
        })
        .collect();
    for direction in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]].map(nalgebra::Vector3::from)
    {
        let outermost = corners.iter().max_by(|a, b| a.dot(&direction).total_cmp(&b.dot(&direction))).unwrap();
        let inside = |point: nalgebra::Vector3<f64>| polygon.iter().all(|edge| edge.excess(&point) <= 1e-9);
        assert!(inside(*outermost) && !inside(outermost + 1e-3 * direction), "{direction:?}");
    }
}

const TWO_FEET: &str = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";

/// Text after the first line, line and column of the complaint, and a part of it.
#[test]
fn mistakes_are_refused_where_they_stand() {
    let cases: &[(&str, &str, &str)] = &[
        ("", "1, column 1", "asks for nothing"),
        ("[[task]]\n", "2, column 1", "`kind` is missing"),
        ("[[task]]\nkind = \"pint\"\n", "3, column 8", "did you mean `point`"),
        ("[[task]]\nkind = \"point\"\nsegmnt = \"hand_r\"\n", "4, column 1", "did you mean `segment`"),
        ("[[task]]\nkind = \"point\"\n", "3, column 8", "needs `segment`"),
        ("[[task]]\nkind = \"point\"\nsegment = \"hand_\"\n", "4, column 11", "did you mean `hand_"),
        ("[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\n", "3, column 8", "needs `target_m`"),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [1, 2]\n",
            "5, column 12",
            "2 numbers are given; 3 are due",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [1, 2, 1e10]\n",
            "5, column 12",
            "target (m) is 10000000000",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\nat_m = [1e10, 2, 0]\ntarget = \"start\"\n",
            "5, column 8",
            "point (m) is 10000000000",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [1, 2, 3]\ntarget = \"start\"\n",
            "6, column 1",
            "two targets",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget = \"here\"\n",
            "5, column 10",
            "unknown value `here`",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget = \"start\"\naxes = \"xw\"\n",
            "6, column 8",
            "names no ground axes",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget = \"start\"\naxes = \"xx\"\n",
            "6, column 8",
            "names no ground axes",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget = \"start\"\naxes = \"\"\n",
            "6, column 8",
            "no axis is asked for",
        ),
        (
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget = \"start\"\nmargin_m = 1\n",
            "6, column 1",
            "does not go with a point task",
        ),
        ("[[task]]\nkind = \"posture\"\nsame_priority = true\n", "4, column 1", "no task stands before"),
        ("[[task]]\nkind = \"orientation\"\nsegment = \"head\"\n", "3, column 8", "needs `target_quaternion`"),
        (
            "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget_quaternion = [1, 1, 0, 0]\n",
            "5, column 21",
            "must have length 1",
        ),
        (
            "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget_quaternion = [1, 0, 0]\n",
            "5, column 21",
            "3 numbers are given; 4 are due",
        ),
        (
            "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget_deg = [0, 0, 0]\ntarget = \"start\"\n",
            "6, column 1",
            "two targets",
        ),
        (
            "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget_deg = [0, 0, 0]\ntarget_quaternion = [1, 0, 0, 0]\n",
            "5, column 1",
            "two rotations",
        ),
        (
            "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget_deg = [0, 1e300, 0]\n",
            "5, column 14",
            "too large",
        ),
        (
            "[[task]]\nkind = \"placement\"\nsegment = \"head\"\ntarget_m = [0, 1, 0]\n",
            "3, column 8",
            "needs `target_q",
        ),
        ("[[task]]\nkind = \"look_at\"\n", "3, column 8", "needs `target_m`, or `target_direction`"),
        (
            "[[task]]\nkind = \"look_at\"\ntarget_m = [2, 1, 0]\ntarget_direction = [1, 0, 0]\n",
            "5, column 1",
            "two targets",
        ),
        (
            "[[task]]\nkind = \"look_at\"\ntarget_direction = [1, 0, 0]\neye_m = [0, 0.1, 0]\n",
            "5, column 1",
            "does not go with `target_direction`",
        ),
        ("[[task]]\nkind = \"look_at\"\ntarget_direction = [0, 0, 0]\n", "4, column 20", "has no length"),
        ("[[task]]\nkind = \"point\"\ntarget_direction = [0, 1, 0]\n", "4, column 1", "does not go with a point task"),
        (
            "[[task]]\nkind = \"look_at\"\ntarget_m = [2, 1, 0]\ndirection = [0, 0, 0]\n",
            "5, column 13",
            "has no length",
        ),
        (
            "[model]\nadult = { sex = \"male\", stature_m = 1.8, mass_kg = 80 }\n[[task]]\nkind = \"look_at\"\n\
             segment = \"nose\"\ntarget_m = [2, 1, 0]\n",
            "6, column 11",
            "no segment `nose`",
        ),
        ("[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\n", "3, column 8", "needs `b`"),
        (
            "[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_\" }\n",
            "5, column 17",
            "did you mean `hand_",
        ),
        (
            "[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_l\" }\n",
            "3, column 8",
            "needs a distance or a range",
        ),
        (
            "[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_l\" }\nrange_m = [2, 1]\n",
            "6, column 11",
            "at or above the lower limit",
        ),
        (
            "[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_l\" }\ndistance_m = -1\n",
            "6, column 14",
            "distance_m is -1",
        ),
        (
            "[[task]]\nkind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"hand_r\" }\ndistance_m = 1\n",
            "5, column 5",
            "the same point",
        ),
        ("[[task]]\nkind = \"center_of_mass\"\n", "3, column 8", "no support is there"),
        (
            "[[support]]\nsegment = \"ulna_r\"\n[[task]]\nkind = \"center_of_mass\"\n",
            "5, column 8",
            "give polygon_m = [[x, z], ...]",
        ),
        (
            "[[task]]\nkind = \"center_of_mass\"\npolygon_m = [[0, 0], [1, 0], [2, 0]]\n",
            "4, column 13",
            "narrower than a centimetre",
        ),
        (
            "[[task]]\nkind = \"center_of_mass\"\npolygon_m = [[0, 0], [1, 0], [2, 1e10]]\n",
            "4, column 30",
            "1e9 at most",
        ),
        (
            "[[task]]\nkind = \"center_of_mass\"\ntarget_m = [0, 1, 0]\nmargin_m = 0.1\n",
            "5, column 1",
            "does not go with a target",
        ),
        (
            "[[task]]\nkind = \"center_of_mass\"\npolygon_m = [[0, 0], [1, 0], [1, 1]]\naxes = \"xz\"\n",
            "5, column 1",
            "does not go with a polygon",
        ),
        ("[[task]]\nkind = \"posture\"\ncoordinates = [\"elbow\"]\n", "4, column 16", "no coordinate `elbow`"),
        (
            "[[task]]\nkind = \"posture\"\ncoordinates = [\"elbow_flex_r\", \"elbow_flex_r\"]\n",
            "4, column 32",
            "stands twice",
        ),
        ("[[task]]\nkind = \"posture\"\nweights = { elbow_flex_r = -1 }\n", "4, column 28", "the weight is -1"),
        ("[[task]]\nkind = \"posture\"\nvalues = { elbow_flex_r_deg = 170 }\n", "4, column 31", "outside its range"),
        ("[[task]]\nkind = \"posture\"\nvalues = { elbow_flex_r = 17 }\n", "4, column 12", "did you mean"),
        ("[[task]]\nkind = \"effort\"\ncoordinates = [\"pelvis_tx\"]\n", "4, column 15", "no known strength"),
        ("[[task]]\nkind = \"effort\"\ncoordinates = []\n", "4, column 15", "names no coordinate"),
        ("[[task]]\nkind = \"posture\"\ncoordinates = []\n", "4, column 15", "names no coordinate"),
        (
            "[[task]]\nkind = \"posture\"\ncoordinates = [\"elbow_flex_r\"]\nweights = { elbow_flex_r = 0 }\n",
            "5, column 11",
            "all weights are 0",
        ),
        ("[[support]]\nsegment = \"calcn\"\n", "3, column 11", "did you mean `calcn_"),
        ("[[support]]\n", "2, column 1", "`segment` is missing"),
        (
            "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_r\"\n",
            "5, column 11",
            "a support already",
        ),
        (
            "[[support]]\nsegment = \"calcn_r\"\non = \"chair\"\n",
            "4, column 6",
            "neither the floor nor the ground nor a plane",
        ),
        (
            "[[support]]\nsegment = \"calcn_r\"\non = { point_m = [0, 0, 0] }\n",
            "4, column 6",
            "write \"floor\", \"ground\", or { normal = [x, y, z], point_m",
        ),
        (
            "[[support]]\nsegment = \"calcn_r\"\non = { normal = [0, 1, 0, 0] }\n",
            "4, column 6",
            "neither the floor nor the ground nor a plane",
        ),
        (
            "[[support]]\nsegment = \"calcn_r\"\non = { normal = [0, 1e300, 0] }\n",
            "4, column 6",
            "a number of the plane is too large",
        ),
        (
            "[[support]]\nsegment = \"calcn_r\"\ncorners_m = [[0, 0]]\n",
            "4, column 13",
            "a row of 2 numbers; 3 are due in each",
        ),
        ("[[support]]\nsegment = \"calcn_r\"\ncorners_m = []\n", "4, column 13", "a patch has 1 to 64 corners"),
        ("[[support]]\nsegment = \"calcn_r\"\nfriction = -1\n", "4, column 12", "friction is -1"),
        ("[[support]]\nsegment = \"calcn_r\"\nshare_max = 1.5\n", "4, column 13", "share_max is 1.5"),
        ("[solver]\nmax_step_deg = 5e-324\n[[task]]\nkind = \"posture\"\n", "3, column 16", "must be from 1e-9 to 180"),
        (
            "[solver]\nmax_step_deg = 0.001\nstill = 1e-4\n[[task]]\nkind = \"posture\"\n",
            "4, column 9",
            "still is 0.0001; it must be below the largest step, 0.0000174",
        ),
        ("[solver]\nmax_step_deg = 0\n[[task]]\nkind = \"posture\"\n", "3, column 16", "max_step_deg is 0"),
        ("[solver]\nmax_steps = 0\n[[task]]\nkind = \"posture\"\n", "3, column 13", "max_steps is 0"),
        ("[solver]\nmax_steps = -5\n[[task]]\nkind = \"posture\"\n", "3, column 13", "a whole number"),
        ("[solver]\nstill = 0\n[[task]]\nkind = \"posture\"\n", "3, column 9", "still is 0"),
        ("[solver]\nreached = 2\n[[task]]\nkind = \"posture\"\n", "3, column 11", "reached is 2"),
        ("[solver]\nsteps = 2\n[[task]]\nkind = \"posture\"\n", "3, column 1", "max_step_deg, max_steps"),
        ("[model]\noverlay = \"a.toml\"\n[[task]]\nkind = \"posture\"\n", "3, column 1", "goes with a model file"),
        ("[model]\nroot = \"fre\"\n", "3, column 8", "did you mean `free`"),
        (
            "[model]\nfile = \"a.urdf\"\nadult = { sex = \"male\", stature_m = 1.8, mass_kg = 80 }\n",
            "4, column 1",
            "either",
        ),
        ("[model]\nfile = \"\"\n", "3, column 8", "no name of a file"),
        (
            "[coordinates]\nlocked = [\"elbow\"]\n[[task]]\nkind = \"posture\"\n",
            "3, column 11",
            "no coordinate `elbow`",
        ),
    ];
    let mut wrong = vec![];
    for (lines, place, part) in cases {
        let bytes = format!("{HEAD}{lines}");
        let refused = scenario_model("pose.toml", bytes.as_bytes()).err().or_else(|| read(lines).err());
        let text = refused.map_or("accepted".to_owned(), |error| complaint(&error));
        let places =
            [format!("label at line {place}: "), format!("label at line {place} to ").replace("column", "columns")];
        if !text.contains(part) || !places.iter().any(|place| text.contains(place)) {
            wrong.push(format!("`{part}` or `{place}` is not in\n{text}\n{lines}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n----\n"));
    println!("{} mistakes", cases.len());
}

/// Keys that only a pose takes are refused in a simulation, and a model file that nobody opened in both.
#[test]
fn a_simulation_is_no_pose() {
    let run = "[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";
    let file = "[model]\nfile = \"a.urdf\"\n";
    for (lines, part) in
        [("[solver]\nmax_steps = 5\n", "[solver] is for poses"), (file, "the model file was not opened")]
    {
        let error = read_scenario("run.toml", format!("{HEAD}{lines}{run}").as_bytes(), None).unwrap_err();
        let text = complaint(&error);
        assert!(text.contains(part), "{text}");
        assert!(
            text.contains(if lines == file { "label at line 3, columns 1 to 4" } else { "label at line 2" }),
            "{text}"
        );
    }
    assert!(complaint(&read(file).unwrap_err()).contains("the model file was not opened"));
    // A pose takes the scenario of a run, and lists the tables that it does not use.
    let scenario = good(&format!("[[task]]\nkind = \"posture\"\n{run}"));
    assert_eq!(scenario.unused, ["strategy", "run"]);
}

#[test]
fn the_model_file_is_told() {
    let of = |lines: &str| scenario_model("pose.toml", format!("{HEAD}{lines}").as_bytes()).unwrap();
    assert_eq!(of("[[task]]\nkind = \"posture\"\n"), None);
    let file = of("[model]\nfile = \"a/b.urdf\"\noverlay = \"c.toml\"\nroot = \"free\"\n").unwrap();
    assert_eq!((file.file.as_str(), file.overlay.as_deref()), ("a/b.urdf", Some("c.toml")));
    assert_eq!(file.root, Some(RootAttachment::Free));
}

/// A free root and a ball: quaternions by their bare names, together or not at all.
#[test]
fn quaternions_by_their_names() {
    let urdf = r#"<robot name="two"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;
    let options = contrapposto_formats::urdf::Options { root: RootAttachment::Free, ..Default::default() };
    let model = contrapposto_formats::urdf::read(urdf.as_bytes(), "two", &options).unwrap().model().unwrap().model;
    let read = |lines: &str| {
        let text = format!("{HEAD}[model]\nfile = \"two.urdf\"\n{lines}[[task]]\nkind = \"posture\"\n");
        read_pose("two.toml", text.as_bytes(), Some(model.clone()))
    };
    let scenario = read("[posture]\nroot_tx_m = 2\nroot_qw = 0.6\nroot_qz = 0.8\n").unwrap();
    assert_eq!(scenario.start.values(), [2.0, 0.0, 0.0, 0.6, 0.0, 0.0, 0.8]);
    for (lines, part) in [
        ("[posture]\nroot_qz = 0.8\n", "must have length 1"),
        ("[posture]\nroot_qz_deg = 0.8\n", "no coordinate `root_qz`"),
        ("[posture]\nroot_tx_deg = 0.8\n", "not measured in the unit"),
        ("[coordinates]\nlocked = [\"root_qx\"]\n", "turn together"),
    ] {
        let text = complaint(&read(lines).unwrap_err());
        assert!(text.contains(part) || lines.contains("qz_deg"), "`{part}` is not in\n{text}");
    }
    let locked = read("[coordinates]\nlocked = [\"root_qw\", \"root_qx\", \"root_qy\", \"root_qz\"]\n").unwrap().locked;
    assert_eq!(locked, [3, 4, 5]);
    let free = read("[coordinates]\nfree = [\"root_ty\"]\n").unwrap().locked;
    assert_eq!(free, [0, 2, 3, 4, 5]);
}

#[test]
fn the_schema_knows_tasks() {
    let schema = scenario_schema().to_string();
    for word in ["\"task\"", "\"support\"", "\"solver\"", "\"center_of_mass\"", "\"same_priority\"", "\"overlay\""] {
        assert!(schema.contains(word), "{word}");
    }
}

/// A value that the engine takes, or a complaint that names the file.
#[test]
fn mutated_poses_never_panic() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/poses");
    let published = ["reach-shelf", "out-of-reach"].map(|name| folder.join(name).with_extension("toml"));
    let mut texts = vec![format!("{HEAD}{FULL}")];
    texts.extend(published.map(|path| std::fs::read_to_string(path).unwrap()));
    hammer_toml("pose", 20_070_903, 3_000, &texts, |bytes| {
        let message = || String::from_utf8_lossy(bytes).into_owned();
        match read_pose("mutant.toml", bytes, None) {
            Ok(scenario) => {
                let options = Options { max_steps: 3, ..scenario.options };
                let engine = Engine::new(&scenario.model, scenario.goals.clone(), &scenario.loads, options);
                let mut engine = engine.unwrap_or_else(|error| panic!("{error}\n{}", message()));
                // Goals a galaxy away may be refused; no number may come out that is not finite.
                if let Ok(pose) = engine.solve(&scenario.start) {
                    assert!(pose.posture.values().iter().all(|value| value.is_finite()), "{}", message());
                }
                true
            }
            Err(error) => {
                assert!(complaint(&error).contains("mutant.toml"), "{}", message());
                false
            }
        }
    });
}
