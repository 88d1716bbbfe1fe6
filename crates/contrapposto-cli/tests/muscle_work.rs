//! Single muscles in the answers of `assess`, `simulate` and `pose`, in their pages and glTF files, through the real program.

use crate::support;

use serde_json::Value;
use support::{hinge_with_muscles, run, write};

/// A body on a hinge about z, pulled forward by two muscles 0.04 m in front of the hinge, and backward by one behind it.
fn model() -> String {
    hinge_with_muscles(&[("weak", 0.04, 200.0), ("strong", 0.04, 600.0), ("behind", -0.04, 500.0)])
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

#[test]
fn assess_names_the_muscles_that_share_a_torque_in_proportion_to_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let motion = write(folder.path(), "still.csv", "time,q_deg\n0,0\n20,0\n");
    let out = folder.path().join("out");
    let force = "b -20,0,0 at 0,-0.3,0 world";
    let arguments = ["assess", &file, &motion, "--force", force, "--fixed-root"];
    let words = run(&arguments);
    let found = |text: &str| -> Value { serde_json::from_str(text).unwrap_or_else(|why| panic!("{why}: {text}")) };
    let json = run(&[&arguments[..], &["--json"]].concat());
    let all = found(&json.stdout);
    let [weak, strong, behind] = ["weak", "strong", "behind"].map(|name| &all["muscles"][name]);
    // Least squares: activations are in proportion to the torques of the muscles, here to their forces.
    let ratio = number(&strong["peak_activation"]) / number(&weak["peak_activation"]);
    assert!((ratio - 3.0).abs() < 1e-6, "{ratio}");
    assert_eq!((number(&behind["peak_activation"]), number(&strong["at_s"])), (0.0, 0.0));
    assert_eq!(strong["works_for"]["coordinate"], "q");
    assert_ne!(strong["works_for"]["side"], behind["works_for"]["side"]);
    // Tensions beyond those of the one behind, which only its passive fibres hold, balance the force about the hinge: 0.3 m of 20 N.
    let tension = |of: &Value| number(&of["force_n"]);
    let torque = 0.04 * (tension(weak) + tension(strong) - tension(behind));
    assert!((torque - 6.0).abs() < 1e-3, "{torque}");
    assert_eq!(all["muscles_lack"], Value::Null);
    let table = words.stdout.split("hardest-worked muscle").nth(1).unwrap_or_else(|| panic!("{}", words.stdout));
    let rows: Vec<&str> = table.lines().skip(1).filter(|line| !line.trim().is_empty()).collect();
    assert!(rows.len() == 2 && rows[0].contains("strong") && rows[1].contains("weak"), "{table}");
    // The same numbers beside files, and the muscles in page and glTF.
    let written = run(&[&arguments[..], &["--json", "--out", &out.display().to_string()]].concat());
    let same = found(&written.stdout);
    assert_eq!(same["muscles"], all["muscles"]);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("\"works_for\"") && page.contains("\"name\":\"behind\""));
    let gltf = std::fs::read(out.join("motion.glb")).unwrap();
    assert!(gltf.windows(9).any(|text| text == b"\"muscles\""), "no muscles in motion.glb");
    // Without muscles nothing is said of them.
    let without = run(&[&arguments[..], &["--json", "--muscles", "off"]].concat());
    assert!(!without.stdout.contains("\"muscles\""), "{}", without.stdout);
}

/// Least cubes: activations are in proportion to the roots of the torques of the muscles. Commands and scenarios take the same word.
#[test]
fn muscles_share_by_cubes_where_a_command_or_a_scenario_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let motion = write(folder.path(), "still.csv", "time,q_deg\n0,0\n20,0\n");
    let force = ["--force", "b -20,0,0 at 0,-0.3,0 world"];
    let scenario = |sharing: &str| {
        let text = format!(
            "format = 1\n[model]\nfile = \"m.osim\"\n{sharing}\n[[load]]\nsegment = \"b\"\nat_m = [0.0, -0.3, 0.0]\n\
             force_n = [-20.0, 0.0, 0.0]\n[[task]]\nkind = \"posture\"\n"
        );
        write(folder.path(), "pose.toml", &text)
    };
    let ratio = |arguments: &[&str]| {
        let answer = run(arguments);
        let json: Value = serde_json::from_str(&answer.stdout).unwrap_or_else(|why| panic!("{why}: {}", answer.stderr));
        let [weak, strong] = ["weak", "strong"].map(|name| number(&json["muscles"][name]["peak_activation"]));
        strong / weak
    };
    let assess = [&["assess", &file, &motion, "--fixed-root", "--json"][..], &force].concat();
    assert!((ratio(&[&assess[..], &["--sharing", "cubes"]].concat()) - 3f64.sqrt()).abs() < 1e-6);
    assert!((ratio(&[&assess[..], &["--sharing", "squares"]].concat()) - 3.0).abs() < 1e-6);
    let posed = ratio(&["pose", &scenario("sharing = \"cubes\""), "--json", "--no-report"]);
    assert!((posed - 3f64.sqrt()).abs() < 1e-6, "{posed}");
    let refused = run(&["pose", &scenario("sharing = \"cubes\"\nmuscles = \"passive\""), "--no-report"]);
    assert!(refused.stderr.contains("by which muscles share torques"), "{}", refused.stderr);
    let refused = run(&["pose", &scenario("sharing = \"fourths\""), "--no-report"]);
    assert!(refused.stderr.contains("fourths") && refused.stderr.contains("cubes"), "{}", refused.stderr);
}

#[test]
fn assess_says_what_the_muscles_together_cannot_give() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model());
    let motion = write(folder.path(), "still.csv", "time,q_deg\n0,0\n20,0\n");
    let force = "b -400,0,0 at 0,-0.3,0 world";
    let arguments = ["assess", &file, &motion, "--force", force, "--fixed-root"];
    let json: Value = serde_json::from_str(&run(&[&arguments[..], &["--json"]].concat()).stdout).unwrap();
    let lack = &json["muscles_lack"];
    assert!(lack["coordinate"] == "q" && number(&lack["torque_nm"]) > 80.0, "{lack}");
    let text = run(&arguments).stdout;
    assert!(text.contains("The muscles together cannot give all torques: "), "{text}");
}

#[test]
fn simulate_says_the_same_of_muscles_with_and_without_files() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "m.osim", &model());
    let scenario = "format = 1\n[model]\nfile = \"m.osim\"\n[run]\nduration_s = 2.0\nstep_s = 0.1\n\
                    [[load]]\nsegment = \"b\"\nat_m = [0.0, -0.3, 0.0]\nforce_n = [-20.0, 0.0, 0.0]\n[strategy]\nkind = \"active\"\n";
    let file = write(folder.path(), "run.toml", scenario);
    let found = |arguments: &[&str]| -> Value {
        let result = run(&[&["simulate", &file, "--json"], arguments].concat());
        serde_json::from_str(&result.stdout).unwrap_or_else(|why| panic!("{why}: {}", result.stderr))
    };
    let bare = found(&["--no-report"]);
    let out = folder.path().join("out").display().to_string();
    let written = found(&["--out", &out]);
    assert!(number(&bare["muscles"]["strong"]["peak_activation"]) > 0.05, "{}", bare["muscles"]);
    assert_eq!(bare["muscles"], written["muscles"]);
    let words = run(&["simulate", &file, "--no-report"]).stdout;
    assert!(words.contains("hardest-worked muscle") && words.contains("strong"), "{words}");
}

#[test]
fn pose_says_which_muscles_hold_the_posture() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "m.osim", &model());
    let scenario = "format = 1\n[model]\nfile = \"m.osim\"\n[[load]]\nsegment = \"b\"\nat_m = [0.0, -0.3, 0.0]\n\
                    force_n = [-20.0, 0.0, 0.0]\n[[task]]\nkind = \"posture\"\n";
    let file = write(folder.path(), "pose.toml", scenario);
    let answer = run(&["pose", &file, "--json", "--no-report"]);
    let json: Value = serde_json::from_str(&answer.stdout).unwrap_or_else(|why| panic!("{why}: {}", answer.stderr));
    let ratio =
        number(&json["muscles"]["strong"]["peak_activation"]) / number(&json["muscles"]["weak"]["peak_activation"]);
    assert!((ratio - 3.0).abs() < 1e-6, "{ratio}");
    let words = run(&["pose", &file, "--no-report"]).stdout;
    assert!(words.contains("hardest-worked muscle") && words.contains("strong"), "{words}");
}

/// The force of the hinge by hand: the weight and the force on the body, and the tensions of three muscles that pull it straight up.
#[test]
fn torques_and_assess_say_what_the_joint_transmits() {
    let folder = tempfile::tempdir().unwrap();
    // The bone has its centre of mass under the hinge.
    let model = model().replace("<mass>1</mass>", "<mass>1</mass><mass_center>0 -0.2 0</mass_center>");
    let file = write(folder.path(), "m.osim", &model);
    let motion = write(folder.path(), "still.csv", "time,q_deg\n0,0\n20,0\n");
    let force = ["--force", "b -20,0,0 at 0,-0.3,0 world"];
    let json = run(&[&["torques", &file, "default", "--json"][..], &force].concat());
    let frames: Value = serde_json::from_str(&json.stdout).unwrap();
    let reaction = &frames[0]["reactions"]["j"];
    let tensions = ["weak", "strong", "behind"].map(|name| number(&frames[0]["muscle_forces_n"][name]));
    let up: f64 = tensions.iter().sum();
    let [fx, fy, fz] = [0, 1, 2].map(|i| number(&reaction["force_n"][i]));
    assert!((fx - 20.0).abs() < 1e-9 && fz.abs() < 1e-9, "{reaction}");
    let weight = number(&reaction["compression_n"]) / number(&reaction["body_weights"]);
    assert!((fy + up - weight).abs() < 1e-9 && up > 100.0, "{reaction}, {up} N up");
    assert!((number(&reaction["compression_n"]) + fy).abs() < 1e-9, "the bone hangs down: {reaction}");
    // About the hinge nothing is left for the joint to give.
    assert!((0..3).all(|i| number(&reaction["moment_nm"][i]).abs() < 1e-6), "{reaction}");
    assert_eq!(frames[0]["muscles_lack"], Value::Null);
    assert_eq!(reaction["frame"], "b");
    let arguments = [&["assess", &file, &motion, "--fixed-root"][..], &force].concat();
    let assessed = run(&[&arguments[..], &["--json"]].concat());
    let all: Value = serde_json::from_str(&assessed.stdout).unwrap();
    let (there, same) = (&all["reactions"]["j"], &reaction["force_n"]);
    assert!((0..3).all(|i| (number(&there["force_n"][i]) - number(&same[i])).abs() < 1e-9), "{there}");
    assert_eq!(number(&there["at_s"]), 0.0);
    let without = run(&["torques", &file, "default", "--json", "--muscles", "off"]);
    assert!(!without.stdout.contains("reactions"), "{}", without.stdout);
    let words = run(&[&["torques", &file, "default"][..], &force].concat());
    assert!(words.stdout.contains("pressed together by"), "{}", words.stdout);
}
