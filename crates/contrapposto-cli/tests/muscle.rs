//! `contrapposto muscle`: one muscle in a posture, through the real program.

use crate::support;

use serde_json::Value;
use support::{assert_png, assert_svg, json, refused, run, write};

/// A body on a hinge about z; a straight muscle 0.04 m in front of the hinge, and one that wraps over a roll of 0.05 m about it.
fn model() -> String {
    let muscle = |name: &str, x: f64, wrap: &str| {
        format!(
            "<Thelen2003Muscle name=\"{name}\"><GeometryPath><PathPointSet><objects>
             <PathPoint name=\"p\"><socket_parent_frame>/ground</socket_parent_frame><location>{x} 0.2 0</location></PathPoint>
             <PathPoint name=\"o\"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>{x} -0.3 0</location></PathPoint>
             </objects></PathPointSet>{wrap}</GeometryPath><max_isometric_force>500</max_isometric_force>
             <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.4</tendon_slack_length></Thelen2003Muscle>"
        )
    };
    let wrap =
        "<PathWrapSet><objects><PathWrap name=\"w\"><wrap_object>roll</wrap_object></PathWrap></objects></PathWrapSet>";
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"b\"><mass>1</mass>
           <WrapObjectSet><objects><WrapCylinder name=\"roll\"><radius>0.05</radius><length>1</length></WrapCylinder></objects></WrapObjectSet>
         </Body></objects></BodySet>
         <JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/b</socket_child_frame>
           <coordinates><Coordinate name=\"q\"/></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects>{}{}</objects></ForceSet></Model></OpenSimDocument>",
        muscle("straight", 0.04, ""),
        muscle("bent", 0.02, wrap)
    )
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn corners(found: &Value) -> Vec<(String, [f64; 3])> {
    let path = found["path"].as_array().unwrap().iter();
    path.map(|corner| {
        let place = [0, 1, 2].map(|axis| number(&corner["ground_m"][axis]));
        (corner["kind"].as_str().unwrap().to_owned(), place)
    })
    .collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn numbers_of_a_muscle_are_those_of_all_muscles_and_its_path_is_as_long_as_its_corners_lie_apart() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let posture = write(folder.path(), "bent.csv", "time,q_deg\n0,0\n1,-25\n");
    let all = run(&["muscles", &file, &posture, "--from", "1", "--json"]).stdout;
    let all: Value = serde_json::from_str(&all).unwrap();
    for name in ["straight", "bent"] {
        let found = json(&["muscle", &file, name, &posture, "--from", "1", "--json"]);
        for (key, own) in [
            ("lengths_m", &found["length_m"]),
            ("fibre_lengths_m", &found["rest"]["fibre_length_m"]),
            ("tendon_forces_n", &found["rest"]["tendon_force_n"]),
            ("passive_forces_n", &found["rest"]["passive_force_n"]),
            ("max_forces_n", &found["full"]["tendon_force_n"]),
        ] {
            assert_eq!(&all[key][name], own, "{key} of {name}");
        }
        assert_eq!(all["moment_arms_m"][name], found["moment_arms_m"]);
        let corners = corners(&found);
        let straight: f64 = corners.windows(2).map(|pair| distance(pair[0].1, pair[1].1)).sum();
        if name == "straight" {
            assert_eq!(corners.iter().map(|corner| corner.0.as_str()).collect::<Vec<_>>(), ["point", "point"]);
            assert!((straight - number(&found["length_m"])).abs() < 1e-12, "{found}");
            continue;
        }
        assert_eq!(corners.iter().map(|corner| corner.0.as_str()).collect::<Vec<_>>(), ["point", "on", "off", "point"]);
        assert_eq!(found["path"][1]["surface"], "roll");
        assert_eq!((&found["path"][0]["segment"], &found["path"][3]["segment"]), (&"ground".into(), &"b".into()));
        // On the roll the line is an arc of 0.05 m about the hinge instead of its chord.
        let chord = distance(corners[1].1, corners[2].1);
        let arc = 0.1 * libm::asin(chord / 0.1);
        assert!((straight - chord + arc - number(&found["length_m"])).abs() < 1e-9, "{found}");
        assert!((number(&found["moment_arms_m"]["q"]).abs() - 0.05).abs() < 1e-9, "{found}");
    }
}

#[test]
fn curves_are_those_of_thelen_and_the_present_state_lies_on_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let out = folder.path().join("out");
    let found = json(&["muscle", &file, "straight", "--json", "--out", out.to_str().unwrap()]);
    let list = |key: &str| -> Vec<f64> { found["force_length"][key].as_array().unwrap().iter().map(number).collect() };
    let (lengths, active, passive) =
        (list("fibre_length_over_optimal"), list("active_over_max"), list("passive_over_max"));
    assert!(lengths.len() > 100 && active.len() == lengths.len() && passive.len() == lengths.len());
    // Thelen 2003: with OpenSim's numbers: gamma 0.45, k 5, strain 0.6.
    let closed = |length: f64| {
        let passive = (libm::exp(5.0 * (length - 1.0) / 0.6) - 1.0) / (libm::exp(5.0) - 1.0);
        [libm::exp(-(length - 1.0).powi(2) / 0.45), if length > 1.0 { passive } else { 0.0 }]
    };
    for ((length, active), passive) in lengths.iter().zip(&active).zip(&passive) {
        let [expected, expected_passive] = closed(*length);
        assert!((active - expected).abs() < 1e-9, "at {length}: {active} {expected}");
        assert!((passive - expected_passive).abs() < 1e-9, "at {length}: {passive} {expected_passive}");
    }
    for (state, activation) in [("rest", 0.01), ("full", 1.0)] {
        let state = &found[state];
        let [active, _] = closed(number(&state["fibre_length_over_optimal"]));
        let force = 500.0 * libm::cos(number(&state["pennation_rad"]));
        assert!((number(&state["active_force_n"]) - activation * active * force).abs() < 1e-6, "{state}");
        let sum = number(&state["active_force_n"]) + number(&state["passive_force_n"]);
        assert!((sum - number(&state["tendon_force_n"])).abs() < 1e-6, "fibres and tendon are in equilibrium: {state}");
    }
    let files: Vec<&str> = found["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    assert!(files.len() == 2 && files[0].ends_with("muscle-straight.svg") && files[1].ends_with("muscle-straight.png"));
    assert_svg(&std::fs::read(files[0]).unwrap());
    assert_png(&std::fs::read(files[1]).unwrap());
    let words = run(&["muscle", &file, "straight"]);
    let first = words.stdout.lines().next().unwrap();
    assert!(
        words.code == 0 && first.starts_with("straight: fibres at ") && first.ends_with(" N in the tendon."),
        "{first}"
    );
    for part in ["point 2  b", "40.0", "Thelen 2003"] {
        assert!(words.stdout.contains(part), "{part}: {}", words.stdout);
    }
}

#[test]
fn an_unknown_muscle_is_refused_with_the_nearest_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let message = refused(&["muscle", &file, "strait"]);
    assert!(message.contains("there is no muscle `strait`; did you mean `straight`?"), "{message}");
    assert!(message.contains("muscles: straight, bent"), "{message}");
    assert!(!refused(&["muscle", &file, "zzzzzzzz"]).contains("did you mean"));
    let two = write(folder.path(), "two.csv", "time,q_deg\n0,0\n1,5\n");
    assert!(refused(&["muscle", &file, "bent", &two]).contains("has 2 postures, and one posture is wanted"));
    assert!(refused(&["muscle", "adult", "bent"]).contains("MODEL is an OpenSim or MJCF file with muscles"));
}
