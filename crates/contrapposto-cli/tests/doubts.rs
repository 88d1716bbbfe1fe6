//! Warnings about models and motions that cannot be what their author meant, and the folding of notes.

use crate::support;

use std::fmt::Write as _;
use std::path::Path;

use contrapposto::statics::{ExternalTorque, FixedIn, Load, LoadKind};
use serde_json::Value;
use support::{contrapposto, json, refused, run, write};

fn formats(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../contrapposto-formats/tests").join(path).to_str().unwrap().to_owned()
}

fn woman() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_model_without_mass_or_in_millimetres_is_told_by_name_and_number() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |y: f64| {
        format!(
            "<joint name=\"j\" type=\"revolute\"><origin xyz=\"0 0 {y}\"/><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>\
             <limit lower=\"-1\" upper=\"1\"/></joint></robot>"
        )
    };
    let mass = "<inertial><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
    let light = format!("<robot name=\"paper\"><link name=\"a\"/><link name=\"b\"/>{}", joint(0.5));
    let light = run(&["torques", &write(folder.path(), "light.urdf", &light), "default"]);
    assert!(
        light.stderr.starts_with("warning: `paper`: no segment has mass: all torques of weight are 0\n"),
        "{}",
        light.stderr
    );
    let large =
        format!("<robot name=\"large\"><link name=\"a\">{mass}</link><link name=\"b\">{mass}</link>{}", joint(500.0));
    let large = run(&["inspect", &write(folder.path(), "large.urdf", &large)]);
    assert!(large.stderr.contains("up to 500.0 m apart"), "{}", large.stderr);
    assert!(large.stderr.contains("millimetres?"), "{}", large.stderr);
    assert!(!run(&["inspect", "adult"]).stderr.contains("warning"));
}

/// A knee of the wrong sign that is nearly straight for half of a stride lies inside its range then, and is named nevertheless; the right one is not.
#[test]
fn a_walking_knee_with_the_opposite_sign_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (sign, named) in [(-1.0, true), (1.0, false)] {
        let mut text = "time,knee_angle_r_deg\n".to_owned();
        for i in 0..=100 {
            let phase = std::f64::consts::TAU * f64::from(i) / 50.0;
            text += &format!("{},{}\n", 0.02 * f64::from(i), sign * 60.0 * libm::sin(phase).max(0.0));
        }
        let motion = write(folder.path(), "stride.csv", &text);
        let said = run(&["assess", "adult", &motion, "--support", "calcn_r,calcn_l", "--static"]).stderr;
        let warned = said.contains("`knee_angle_r` lies outside its range") && said.contains("opposite sign?");
        assert_eq!(warned, named, "{said}");
    }
}

#[test]
fn a_motion_with_the_opposite_sign_is_warned_of_first_and_in_the_json() {
    let folder = tempfile::tempdir().unwrap();
    let bent = write(folder.path(), "bent.csv", "time,knee_angle_r_deg\n0,-60\n1,-70\n2,-66\n");
    let run = run(&["assess", &woman(), &bent, "--json"]);
    let first = run.stderr.lines().next().unwrap();
    assert!(first.starts_with("warning: `knee_angle_r` lies outside its range"), "{}", run.stderr);
    assert!(
        first.contains("in 100 % of the time (-70.0 .. -60.0 deg); opposite sign? With it 100 % of the time"),
        "{first}"
    );
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(
        report["warnings"][0].as_str().unwrap().starts_with("`knee_angle_r` lies outside"),
        "{}",
        report["warnings"]
    );
    let sentence = report["verdict"]["sentence"].as_str().unwrap();
    let doubt = " This is in doubt: check the sign of right knee (knee_angle_r), which is outside of its range in 100\u{a0}% of the time.";
    assert!(sentence.ends_with(doubt), "{sentence}");
    // A knee that walks is nearly straight half of the time: the answer is in doubt all the same.
    let walking = write(folder.path(), "walking.csv", "time,knee_angle_r_deg\n0,-3\n1,-60\n2,-2\n3,-4\n");
    let sentence = json(&["assess", &woman(), &walking, "--json", "--fixed-root"])["verdict"]["sentence"].clone();
    let doubt = "check the sign of right knee (knee_angle_r), which is outside of its range in 25\u{a0}% of the time.";
    assert!(sentence.as_str().unwrap().ends_with(doubt), "{sentence}");
    // Within the error of recorded angles nothing is in doubt.
    let straight = write(folder.path(), "straight.csv", "time,knee_angle_r_deg\n0,-9\n1,-9\n");
    let sentence = json(&["assess", &woman(), &straight, "--json", "--fixed-root"])["verdict"]["sentence"].clone();
    assert!(!sentence.as_str().unwrap().contains("in doubt"), "{sentence}");
    let good = write(folder.path(), "good.csv", "time,knee_angle_r_deg\n0,60\n1,70\n2,66\n");
    assert!(!support::run(&["assess", &woman(), &good]).stderr.contains("knee_angle_r` lies outside"));
}

/// A weight of tonnes in a hand, with the right knee far beyond its straight end, as of a model that counts it the other way: the answer says in
/// words that the load is too great, and which joint to check.
#[test]
fn a_load_of_many_times_the_strength_is_told_in_words_with_the_joints_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    let assess = |knee: &str| {
        let text = format!("time,knee_angle_r_deg,elbow_flex_r_deg\n0,{knee},90\n1,{knee},90\n");
        let held = write(folder.path(), "held.csv", &text);
        run(&["assess", "adult", &held, "--fixed-root", "--no-suggest", "--load", "hand_r 3000kg"])
    };
    for (knee, doubt) in [
        (
            "-60",
            "check the sign of right knee (knee_angle_r), which is outside of its range in 100\u{a0}% of the time.",
        ),
        ("60", "check the signs and units of angles and loads."),
    ] {
        let run = assess(knee);
        let first = run.stdout.lines().next().unwrap();
        assert_eq!(run.code, 1, "{first}");
        assert!(
            first.starts_with("Cannot be done: right ") && first.contains(" would need far more than its strength: "),
            "{first}"
        );
        assert!(first.ends_with(doubt) && !first.contains("000\u{a0}%"), "{first}");
        assert!(run.stdout.contains("more than 1000\u{a0}%"), "{}", run.stdout);
    }
}

/// At 0 degrees the adult's ligaments bend the knee, and nothing else loads it: the leg hangs.
#[test]
fn a_knee_that_is_held_straight_against_its_ligaments_is_warned_of_with_its_strength() {
    let folder = tempfile::tempdir().unwrap();
    let straight = write(folder.path(), "straight.csv", "time,knee_angle_r_deg\n0,0\n1,0\n");
    let report = json(&["assess", "adult", &straight, "--fixed-root", "--angle-error", "0", "--json"]);
    let knee =
        |group: &&Value| group["coordinate"] == "knee_angle_r" && group["peak_load"]["value"].as_f64().unwrap() > 0.0;
    let knee = report["groups"].as_array().unwrap().iter().find(knee).unwrap();
    let number = |key: &str| knee[key].as_f64().unwrap();
    let strength = knee["strength_at_peak"]["strength_nm"].as_f64().unwrap();
    let load = number("active_at_peak_nm").abs() / strength;
    assert!((load - knee["peak_load"]["value"].as_f64().unwrap()).abs() < 1e-12, "{knee}");
    let sum = number("active_at_peak_nm") + number("external_at_peak_nm") + number("passive_at_peak_nm");
    assert!(
        sum.abs() < 1e-9 && number("passive_at_peak_nm").abs() > 2.0 * number("external_at_peak_nm").abs(),
        "{knee}"
    );
    assert!(!knee["strength_at_peak"]["status"].as_str().unwrap().is_empty(), "{knee}");
    let warned = report["warnings"].to_string();
    assert!(
        warned.contains("muscles work more against the passive tissue of their own joint than against loads")
            && warned.contains("`knee_angle_r` at 0.0 deg (0 s): passive torque"),
        "{warned}"
    );
    let table = run(&["assess", "adult", &straight]).stdout;
    assert!(table.contains("of a strength of"), "{table}");
}

#[test]
fn torques_of_a_fast_motion_are_warned_of_and_say_that_they_are_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..100)
        .map(|i| {
            let time = 0.01 * f64::from(i);
            format!("{time},{}\n", 0.2 * libm::sin(20.0 * time))
        })
        .collect();
    let shaken = write(folder.path(), "shaken.csv", &format!("time,pelvis_tx_m\n{rows}"));
    let run = run(&["torques", "adult", &shaken, "--json", "--static"]);
    assert!(run.stderr.contains("warning: the centre of mass accelerates by more than 1 m/s2"), "{}", run.stderr);
    let frames: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&frames[7]["time_s"], &frames[7]["quasi_static"]), (&serde_json::json!(0.07), &Value::Bool(true)));
    let elbow = &frames[7]["coordinates"]["elbow_flex_r"]["strength"];
    assert!(elbow[0]["strength_nm"].as_f64().unwrap() > 10.0 && elbow[1]["angle_deg"] == 0.0, "{elbow}");
    assert!(elbow[0]["status"].is_string() && elbow[0]["floor"].is_boolean(), "{elbow}");
    assert!(frames[7]["coordinates"]["hip_flexion_r"]["strength"].is_null(), "judged by its moment");
    let still = support::run(&["torques", "adult", "default"]);
    assert!(still.stdout.starts_with("at rest, without inertia:") && !still.stderr.contains("accelerates"));
}

#[test]
fn notes_are_folded_shown_or_left_out_and_warnings_never() {
    let folder = tempfile::tempdir().unwrap();
    let bent = write(folder.path(), "bent.csv", "time,knee_angle_r_deg\n0,-60\n1,-70\n");
    // Another pelvis: no export of the adult, but a model of which much is noted.
    let own = std::fs::read_to_string(woman()).unwrap();
    let other = own.replace("<mass>7.482</mass>", "<mass>7.5</mass>");
    assert_ne!(own, other);
    let other = write(folder.path(), "other.osim", &other);
    let stderr = |more: &[&str]| run(&[&["assess", other.as_str(), &bent], more].concat()).stderr;
    let count = |text: &str, kind: &str| text.lines().filter(|line| line.starts_with(kind)).count();
    let (folded, all, none) = (stderr(&[]), stderr(&["--verbose"]), stderr(&["--quiet"]));
    assert_eq!((count(&folded, "note: "), count(&none, "note: ")), (5, 0), "{folded}");
    let more = count(&all, "note: ") - 4;
    assert!(more > 10 && folded.contains(&format!("note: {more} more notes; --verbose shows all of them")), "{folded}");
    for text in [&folded, &all, &none] {
        assert_eq!(count(text, "warning: "), count(&all, "warning: "), "{text}");
        assert!(count(text, "warning: ") > 0, "{text}");
    }
}

#[test]
fn convert_counts_what_is_not_carried_over() {
    let folder = tempfile::tempdir().unwrap();
    let said = |model: &str, name: &str| run(&["convert", model, folder.path().join(name).to_str().unwrap()]);
    let point = |name: &str, frame: &str| {
        format!(
            "<PathPoint name=\"{name}\"><socket_parent_frame>{frame}</socket_parent_frame><location>0 0.1 0</location></PathPoint>"
        )
    };
    let hinge = format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\"><BodySet><objects><Body name=\"b\"><mass>1</mass>
         <inertia>0.01 0.01 0.01 0 0 0</inertia><WrapObjectSet><objects><WrapSphere name=\"w\"><radius>0.01</radius></WrapSphere></objects></WrapObjectSet>
         </Body></objects></BodySet><JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
         <socket_child_frame>/bodyset/b</socket_child_frame><coordinates><Coordinate name=\"q\"/></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects><Thelen2003Muscle name=\"t\"><GeometryPath><PathPointSet><objects>{}{}</objects></PathPointSet></GeometryPath>
         </Thelen2003Muscle></objects></ForceSet><MarkerSet><objects><Marker name=\"k\"><socket_parent_frame>/bodyset/b</socket_parent_frame>
         </Marker></objects></MarkerSet></Model></OpenSimDocument>",
        point("from", "/ground"),
        point("to", "/bodyset/b")
    );
    let hinge = write(folder.path(), "hinge.osim", &hinge);
    for name in ["out.urdf", "out.xml"] {
        let text = said(&hinge, name).stdout;
        assert!(
            text.contains("1 markers, 1 muscles, 1 wrap objects") && text.ends_with("not carried over\n"),
            "{text}"
        );
    }
    let text = said(&hinge, "again.osim").stdout;
    assert!(text.ends_with("kg; 1 property that is named as lost not carried over\n"), "{text}");
    // OpenSim's own format keeps them, but for the marker on ground and the muscle's speeds.
    let osim = said(&formats("models/joints_4x.osim"), "out.osim");
    assert!(osim.stdout.contains("1 markers fixed to ground, 1 property that is named as lost not"), "{}", osim.stdout);
    assert!(!osim.stdout.contains("1 muscles") && !osim.stdout.contains("wrap objects"), "{}", osim.stdout);
    assert!(osim.stderr.contains("lost: Speeds, times of activation and damping of muscles"), "{}", osim.stderr);
    assert!(!osim.stderr.contains("in the file and not used"), "{}", osim.stderr);
}

#[test]
fn compressed_files_and_marker_files_say_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.osim.gz");
    std::fs::write(&path, [0x1f, 0x8b, 8, 0, 1, 2, 3]).unwrap();
    assert!(refused(&["inspect", path.to_str().unwrap()]).contains("is compressed (gzip); unpack it first"));
    std::fs::write(&path, b"PK\x03\x04abc").unwrap();
    assert!(refused(&["inspect", path.to_str().unwrap()]).contains("is compressed (zip); unpack it first"));
    for (name, text) in [("walk.bvh", "HIERARCHY\n"), ("walk.txt", "HIERARCHY\n"), ("walk.glb", "glTF")] {
        let said = refused(&["assess", "adult", &write(folder.path(), name, text)]);
        assert!(
            said.contains("is an animation; `contrapposto track adult FILE --out DIR` makes a motion of it"),
            "{said}"
        );
    }
    for name in ["walk.trc", "walk.txt"] {
        let markers = write(folder.path(), name, "PathFileType\t4\t(X/Y/Z)\twalk.trc\nDataRate\n60\n");
        let said = refused(&["assess", "adult", &markers]);
        assert!(
            said.contains("is a marker file; `contrapposto track MODEL FILE --out DIR` makes a motion of it"),
            "{said}"
        );
        let motion = write(folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n5,60\n");
        let said = refused(&["assess", "adult", &motion, "--grf", &markers]);
        assert!(
            said.contains("is a marker file, which holds no forces; --grf is a C3D file with force plates, a table"),
            "{said}"
        );
    }
}

const FORCES: &str = "ground_force_vx,ground_force_vy,ground_force_vz,ground_force_px,ground_force_py,ground_force_pz";

/// An ExternalLoads file of one force on the right heel; `more` stands in the force.
fn external(folder: &Path, more: &str) -> String {
    let identifier = |kind: &str, name: &str| format!("<{kind}_identifier>{name}</{kind}_identifier>");
    let force = format!(
        "<ExternalForce name=\"right\"><applied_to_body>calcn_r</applied_to_body>{}{}{more}</ExternalForce>",
        identifier("force", "ground_force_v"),
        identifier("point", "ground_force_p")
    );
    let off = "<ExternalForce name=\"off\"><appliesForce>false</appliesForce></ExternalForce>";
    let text = format!(
        "<OpenSimDocument Version=\"30000\"><ExternalLoads name=\"x\"><objects>{force}{off}</objects>\
         <datafile>forces.csv</datafile></ExternalLoads></OpenSimDocument>"
    );
    write(folder, "external.xml", &text)
}

/// Force tables of a stride in which the right foot stands, then the left one: each force in its place, with sides swapped in both or one of the
/// plates, with points in mm, and without a place.
fn stride() -> [(&'static str, String, String); 5] {
    let model = contrapposto::model::adult(&contrapposto::model::Adult::default()).unwrap();
    let mut body = contrapposto::kinematics::Kinematics::new(&model);
    let [hip_r, hip_l, knee_r, knee_l] =
        ["hip_flexion_r", "hip_flexion_l", "knee_angle_r", "knee_angle_l"].map(|name| model.coordinate(name).unwrap());
    let feet = ["calcn_r", "calcn_l"].map(|name| model.segment(name).unwrap());
    let mut motion = "time,hip_flexion_r_deg,hip_flexion_l_deg,knee_angle_r_deg,knee_angle_l_deg\n".to_owned();
    let mut tables = [const { String::new() }; 4];
    for i in 0..=40 {
        let (time, stands) = (0.025 * f64::from(i), usize::from(i > 20));
        let bent = [[5.0, 35.0], [35.0, 5.0]][stands];
        let straight = [[2.0, 50.0], [50.0, 2.0]][stands];
        let _ = writeln!(motion, "{time},{},{},{},{}", bent[0], bent[1], straight[0], straight[1]);
        let mut posture = model.default_posture();
        for (coordinate, angle) in [(hip_r, bent[0]), (hip_l, bent[1]), (knee_r, straight[0]), (knee_l, straight[1])] {
            posture.values_mut()[coordinate] = f64::to_radians(angle);
        }
        body.update(&model, &posture).unwrap();
        let foot = body.station(&model, feet[stands], model.segments()[feet[stands]].center_of_mass);
        let (carries, idle) = ([0.0, 700.0, 0.0, foot.x, 0.0, foot.z], [0.0; 6]);
        let in_mm = [0.0, 700.0, 0.0, 1e3 * foot.x, 0.0, 1e3 * foot.z];
        let right = |at| if stands == 0 { [at, idle] } else { [idle, at] };
        for (table, [a, b]) in tables.iter_mut().zip([
            right(carries),
            [right(carries)[1], right(carries)[0]],
            right(in_mm),
            right(carries),
        ]) {
            let row: Vec<String> = a.iter().chain(&b).map(ToString::to_string).collect();
            let _ = writeln!(table, "{time},{}", row.join(","));
        }
    }
    let names = |plate: u8| FORCES.split(',').map(|name| format!("{plate}_{name}")).collect::<Vec<_>>().join(",");
    let head = format!("time,{},{}\n", names(1), names(2));
    let [plain, swapped, millimetres, nowhere] = tables.map(|rows| format!("{head}{rows}"));
    let on = |first: &str, second: &str, point: bool| {
        let force = |plate: u8, foot: &str| {
            let point = if point {
                format!("<point_identifier>{plate}_ground_force_p</point_identifier>")
            } else {
                String::new()
            };
            format!(
                "<ExternalForce name=\"f{plate}\"><applied_to_body>{foot}</applied_to_body><force_identifier>{plate}_ground_force_v</force_identifier>\
                 {point}</ExternalForce>"
            )
        };
        let (first, second) = (force(1, first), force(2, second));
        format!("<ExternalLoads><datafile>forces.csv</datafile><objects>{first}{second}</objects></ExternalLoads>")
    };
    let (straight, crossed) = (on("calcn_r", "calcn_l", true), on("calcn_l", "calcn_r", false));
    [
        ("plain", plain, straight.clone()),
        ("swapped", swapped, straight.clone()),
        ("mm", millimetres, straight.clone()),
        ("nowhere", nowhere, crossed),
        ("motion", motion, String::new()),
    ]
}

#[test]
fn forces_of_the_other_side_in_mm_or_on_a_foot_in_the_air_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let cases = stride();
    let motion = write(folder.path(), "motion.csv", &cases[4].1);
    for ((name, table, loads), (doubt, also)) in cases.iter().take(4).zip([
        ("", ""),
        ("left and right seem to be swapped in the forces of", "those on `calcn_r` act "),
        ("the forces on `calcn_r` act ", "are their points in mm?"),
        ("left and right seem to be swapped in the forces of", "`calcn_l` carries the body alone while it is "),
    ]) {
        write(folder.path(), "forces.csv", table);
        let loads = write(folder.path(), "loads.xml", loads);
        for command in ["assess", "torques"] {
            let said = run(&[command, "adult", &motion, "--grf", &loads, "--static"]).stderr;
            if doubt.is_empty() {
                assert!(!said.contains("swapped") && !said.contains("away from it"), "{name}: {said}");
            } else {
                let warned = said
                    .lines()
                    .any(|line| line.starts_with("warning: ") && line.contains(doubt) && line.contains(also));
                assert!(warned, "{command}, {name}: {said}");
            }
        }
        if *name == "swapped" {
            let answer = run(&["assess", "adult", &motion, "--grf", &loads, "--static", "--json"]);
            let report: Value = serde_json::from_str(&answer.stdout).unwrap();
            assert!(report["warnings"][0].as_str().unwrap().starts_with(doubt), "{}", report["warnings"]);
        }
    }
}

/// A pelvis in mm, and an angle in degrees in a table of radians, are named as such.
#[test]
fn coordinates_in_another_unit_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let far = write(folder.path(), "far.csv", "time,pelvis_ty_m\n0,930\n1,931\n");
    let said = run(&["torques", "adult", &far]).stderr;
    assert!(
        said.contains("`pelvis_ty` lies outside its range") && said.contains("are its values in millimetres?"),
        "{said}"
    );
    let wide = write(folder.path(), "wide.csv", "time,knee_angle_r\n0,60\n1,70\n");
    let said = run(&["torques", "adult", &wide, "--radians"]).stderr;
    assert!(said.contains("are its values in degrees, taken for radians?"), "{said}");
    assert!(!run(&["torques", "adult", &wide, "--degrees"]).stderr.contains("outside its range"));
}

#[test]
fn external_loads_that_name_a_table_outside_their_folder_are_refused_without_its_text_unless_it_is_allowed() {
    let outside = tempfile::tempdir().unwrap();
    let table = format!("time,{FORCES}\n0,0,700,0,0.1,0,0.1\n1,0,700,0,0.1,0,0.1\n");
    let table = write(outside.path(), "forces.csv", &table);
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "motion.csv", "time,hip_flexion_r_deg\n0,5\n1,6\n");
    let text = std::fs::read_to_string(external(folder.path(), "")).unwrap();
    let loads = write(folder.path(), "away.xml", &text.replace("forces.csv", &table));
    let torques = |more: &[&str]| run(&[&["torques", "adult", &motion, "--grf", &loads], more].concat());
    let refused = torques(&[]);
    assert!(refused.code == 2 && refused.stderr.contains("is not in the file's folder or below"), "{}", refused.stderr);
    assert!(!refused.stderr.contains("ground_force_vx"), "{}", refused.stderr);
    let allowed = torques(&["--allow-path", outside.path().to_str().unwrap()]);
    assert_eq!(allowed.code, 0, "{}", allowed.stderr);
}

#[test]
fn external_loads_name_the_table_and_the_segments_of_ground_reactions() {
    let folder = tempfile::tempdir().unwrap();
    let forces =
        write(folder.path(), "forces.csv", &format!("time,{FORCES}\n0,0,700,0,0.1,0,0.1\n1,0,700,0,0.1,0,0.1\n"));
    let motion = write(folder.path(), "motion.csv", "time,hip_flexion_r_deg\n0,5\n1,6\n");
    let torques = |grf: &str, more: &[&str]| run(&[&["torques", "adult", &motion, "--grf", grf], more].concat());
    let loads = external(folder.path(), "");
    let (named, plain) = (torques(&loads, &[]), torques(&forces, &["--grf-on", "calcn_r"]));
    assert_eq!(named.code, 0, "{}", named.stderr);
    assert!(named.stdout == plain.stdout && named.stdout.len() > 1000);
    for (more, said) in [
        ("<force_expressed_in_body>tail</force_expressed_in_body>", "tail"),
        ("<torque_identifier>moment_</torque_identifier>", "there is no column `moment_x`"),
    ] {
        let refused = torques(&external(folder.path(), more), &[]);
        assert!(refused.code == 2 && refused.stderr.contains(said), "{}", refused.stderr);
    }
    let other = write(folder.path(), "other.xml", "<robot/>");
    assert!(torques(&other, &[]).stderr.contains("holds no <ExternalLoads>"));
}

#[test]
fn frames_outside_of_the_ground_reactions_are_left_out_with_the_common_time() {
    let folder = tempfile::tempdir().unwrap();
    let forces =
        write(folder.path(), "forces.csv", &format!("time,{FORCES}\n1,0,700,0,0.1,0,0.1\n2,0,700,0,0.1,0,0.1\n"));
    let motion = write(folder.path(), "motion.csv", "time,hip_flexion_r_deg\n0,5\n1,6\n1.5,7\n2,8\n3,9\n");
    let call = |more: &[&str]| {
        run(&[&["torques", "adult", &motion, "--grf", &forces, "--grf-on", "calcn_r", "--json"], more].concat())
    };
    let times = |text: &str| -> Vec<f64> {
        let frames: Value = serde_json::from_str(text).unwrap();
        frames.as_array().unwrap().iter().map(|frame| frame["time_s"].as_f64().unwrap()).collect()
    };
    let whole = call(&[]);
    assert_eq!((whole.code, times(&whole.stdout)), (0, vec![1.0, 1.5, 2.0]), "{}", whole.stderr);
    let said = "forces go from 1 s to 2 s, the motion from 0 s to 3 s: 2 of 5 instants are left out, 3 from 1 s to 2 s";
    assert!(whole.stderr.contains(said), "{}", whole.stderr);
    let cut = call(&["--from", "1", "--to", "1.5"]);
    assert!(times(&cut.stdout) == [1.0, 1.5] && !cut.stderr.contains("left out"), "{}", cut.stderr);
    let apart = call(&["--from", "2.5"]);
    assert!(apart.code == 2 && apart.stderr.contains("they have no time in common"), "{}", apart.stderr);
    let none = call(&["--from", "4"]);
    assert!(none.code == 2 && none.stderr.contains("it goes from 0 s to 3 s"), "{}", none.stderr);
}

/// Times and angles of a forearm that swings, and what a hand-made second derivation says of it: external torque with inertia is that at
/// rest plus inertia, and the inertia of a still motion is 0.
#[test]
fn dynamics_adds_inertia_to_the_external_torque_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |size: f64| -> String {
        (0..60)
            .map(|i| {
                let time = 0.02 * f64::from(i);
                format!("{time},{}\n", 40.0 + size * libm::sin(5.0 * time))
            })
            .collect()
    };
    let head = "time,elbow_flex_r_deg\n";
    let swung = write(folder.path(), "swung.csv", &format!("{head}{}", rows(30.0)));
    let held = write(folder.path(), "held.csv", &format!("{head}{}", rows(0.0)));
    let call = |motion: &str, more: &[&str]| {
        let answer = run(&[&["torques", "adult", motion, "--load", "hand_r 2kg", "--json"], more].concat());
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        (serde_json::from_str::<Value>(&answer.stdout).unwrap(), answer.stderr)
    };
    let elbow = |frames: &Value, i: usize, what: &str| frames[i]["coordinates"]["elbow_flex_r"][what].as_f64();
    let (moving, said) = call(&swung, &["--dynamics", "--cutoff-hz", "none"]);
    assert!(said.contains("inertia counts") && said.contains("no filter"), "{said}");
    let (rest, _) = call(&swung, &["--static"]);
    for i in [20, 30, 40] {
        let inertia = elbow(&moving, i, "inertia_nm").unwrap();
        let sum = elbow(&rest, i, "external").unwrap() + inertia;
        assert!((elbow(&moving, i, "external").unwrap() - sum).abs() < 1e-9 && elbow(&rest, i, "inertia_nm").is_none());
        // -I alpha: forearm and hand about the elbow have about 0.07 kg m2, 2 kg in the hand at 0.3 m to 0.4 m 0.18 to 0.32.
        let alpha = -(30f64.to_radians()) * 25.0 * libm::sin(0.1 * i as f64);
        let moment = -inertia / alpha;
        assert!((0.2..0.5).contains(&moment), "{moment} kg m2 at frame {i}");
    }
    assert_eq!(moving[0]["quasi_static"], Value::Bool(false));
    let (still, said) = call(&held, &["--dynamics"]);
    assert!(said.contains("low-pass at 6 Hz"), "{said}");
    assert!(still.as_array().unwrap().iter().all(|frame| frame["coordinates"]["elbow_flex_r"]["inertia_nm"] == 0.0));
    let (filtered, _) = call(&swung, &["--dynamics", "--filter", "filtfilt"]);
    let (a, b) = (elbow(&filtered, 30, "inertia_nm").unwrap(), elbow(&moving, 30, "inertia_nm").unwrap());
    assert!((a - b).abs() < 0.05 * b.abs() && a != b, "{a} and {b}");
    let table = run(&["torques", "adult", &swung, "--dynamics"]).stdout;
    assert!(table.lines().next().unwrap().contains("elbow_flex_r.active_nm,elbow_flex_r.inertia_nm"), "{table}");
}

#[test]
fn dynamics_without_a_motion_or_with_a_cutoff_beyond_the_frames_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(refused(&["torques", "adult", "default", "--dynamics"]).contains("needs a motion"));
    let few = write(folder.path(), "few.csv", "time,elbow_flex_r_deg\n0,5\n1,6\n");
    assert!(refused(&["torques", "adult", &few, "--dynamics"]).contains("2 instants; accelerations need at least 6"));
    let rows: String = (0..20).map(|i| format!("{},{}\n", 0.1 * f64::from(i), i)).collect();
    let slow = write(folder.path(), "slow.csv", &format!("time,elbow_flex_r_deg\n{rows}"));
    let said = refused(&["assess", "adult", &slow, "--dynamics"]);
    assert!(said.contains("a cut-off of 6 Hz: it must be above 0 and below half of the 10"), "{said}");
    for (cutoff, why) in
        [("0", "a number of Hz above 0, `auto` or `none`"), ("x", "a number of Hz above 0, `auto` or `none`")]
    {
        assert!(refused(&["assess", "adult", &slow, "--dynamics", "--cutoff-hz", cutoff]).contains(why));
    }
}

/// The ends that padding reaches, a cut-off too low for the length, an angle that wraps, and a fast motion that cannot be differentiated are each
/// warned of by name; a wrapped motion has the torques of the one that turns on.
#[test]
fn doubts_about_the_filter_of_a_motion_are_told_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let swing = |name: &str, frames: u32, value: &dyn Fn(f64) -> f64| {
        let rows: String =
            (0..=frames).map(|i| format!("{},{}\n", 0.01 * f64::from(i), value(0.01 * f64::from(i)))).collect();
        write(folder.path(), name, &format!("time,pelvis_rotation_deg\n{rows}"))
    };
    let said = |motion: &str, more: &[&str]| {
        let run = run(&[&["torques", "adult", motion, "--dynamics", "--json"], more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        (run.stderr, run.stdout)
    };
    let sine = |time: f64| 10.0 * libm::sin(6.0 * time);
    let (long, short) = (swing("long.csv", 300, &sine), swing("short.csv", 80, &sine));
    let (quiet, _) = said(&long, &[]);
    assert!(!quiet.contains("padding") && !quiet.contains("below two over"), "{quiet}");
    let (ends, _) = said(&short, &[]);
    assert!(ends.contains("within 0.17 s of the ends of the file") && ends.contains("34 of 81 instants"), "{ends}");
    assert!(!said(&short, &["--cutoff-hz", "none"]).0.contains("padding"));
    let (low, _) = said(&short, &["--cutoff-hz", "2"]);
    assert!(low.contains("the cut-off of 2 Hz is below two over the length of the motion, 0.800 s"), "{low}");
    assert!(low.contains("--cutoff-hz 3 or more"), "{low}");

    // 100 deg a second through 180 deg, and the same recorded between -180 and 180.
    let on = swing("on.csv", 300, &|time| 100.0 * time);
    let wrapped =
        swing("wrapped.csv", 300, &|time| if 100.0 * time > 180.0 { 100.0 * time - 360.0 } else { 100.0 * time });
    let ((plain, a), (warned, b)) = (said(&on, &[]), said(&wrapped, &[]));
    assert!(!plain.contains("jumps"), "{plain}");
    assert!(
        warned.contains("`pelvis_rotation` jumps from 180.0 to -179.0 deg at 1.81 s: a whole turn is added"),
        "{warned}"
    );
    let torques = |text: &str| -> Vec<f64> {
        let frames: Value = serde_json::from_str(text).unwrap();
        let all =
            frames.as_array().unwrap().iter().flat_map(|frame| frame["coordinates"].as_object().unwrap().values());
        all.map(|torques| torques["external"].as_f64().unwrap()).collect()
    };
    assert!(torques(&a).iter().zip(torques(&b)).all(|(a, b)| (a - b).abs() < 1e-6));

    let auto = said(&long, &["--cutoff-hz", "auto"]).0;
    assert!(auto.contains("low-pass at") && auto.contains("as residual analysis suggests"), "{auto}");
    // A jump up and down in five frames is fast, and too short for accelerations.
    let rows: String = [0.0, 0.2, 0.4, 0.2, 0.0]
        .iter()
        .enumerate()
        .map(|(i, y)| format!("{},{}\n", 0.06 * i as f64, 1.0 + y))
        .collect();
    let hop = write(folder.path(), "hop.csv", &format!("time,pelvis_ty_m\n{rows}"));
    let hop = run(&["torques", "adult", &hop]).stderr;
    assert!(hop.contains("inertia is left out, although the centre of mass accelerates"), "{hop}");
    assert!(hop.contains("5 instants; accelerations need at least 6"), "{hop}");
}

#[test]
fn assess_of_a_fast_motion_counts_inertia_in_its_first_sentence_unless_static_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..100)
        .map(|i| {
            let time = 0.02 * f64::from(i);
            format!("{time},{},{}\n", 0.05 * libm::sin(8.0 * time), 20.0 + 10.0 * libm::cos(8.0 * time))
        })
        .collect();
    let bounced = write(folder.path(), "bounced.csv", &format!("time,pelvis_ty_m,hip_flexion_r_deg\n{rows}"));
    let of = |more: &[&str]| run(&[&["assess", "adult", &bounced, "--load", "hand_r 1kg"], more].concat());
    let first = |text: &str| text.lines().next().unwrap().to_owned();
    let moving = of(&[]);
    assert!(first(&moving.stdout).contains("Inertia of the motion counts."), "{}", moving.stdout);
    assert!(
        !moving.stdout.contains("judged at rest") && !moving.stderr.contains("do not describe"),
        "{}",
        moving.stderr
    );
    assert!(moving.stderr.contains("inertia counts, because the centre of mass accelerates"), "{}", moving.stderr);
    let still = of(&["--static"]);
    assert!(first(&still.stdout).contains("Each posture is judged at rest"), "{}", still.stdout);
    assert!(still.stderr.contains("--dynamics counts inertia"), "{}", still.stderr);
    let report: Value = serde_json::from_str(&of(&["--json"]).stdout).unwrap();
    assert_eq!(report["dynamics"], true);
    let hip = report["groups"].as_array().unwrap().iter().find(|group| group["coordinate"] == "hip_flexion_r").unwrap();
    assert!(hip["inertia_at_peak_nm"].as_f64().unwrap().abs() > 1.0, "{hip}");
    let out = folder.path().join("out");
    let code = of(&["--out", out.to_str().unwrap()]).code;
    assert!(code <= 1);
    let table = std::fs::read_to_string(out.join("torques.sto")).unwrap();
    assert!(table.contains("inertia counts") && table.contains("hip_flexion_r.inertia_nm"));
}

/// A force measured in the axes of the foot, at a point of the foot, is the force measured in ground where the foot is level; a force
/// without a point acts at the origin of its segment, a couple alone has no force.
#[test]
fn external_loads_in_the_frame_of_a_body_are_turned_into_ground() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "motion.csv", "time,hip_flexion_r_deg\n0,30\n1,30\n");
    let names = FORCES.to_owned() + ",ground_torque_x,ground_torque_y,ground_torque_z";
    write(
        folder.path(),
        "forces.csv",
        &format!("time,{names}\n0,10,70,5,0.1,0.02,0.1,1,2,3\n1,10,70,5,0.1,0.02,0.1,1,2,3\n"),
    );
    let torques = |xml: &str| {
        let answer = run(&["torques", "adult", &motion, "--grf", xml, "--json"]);
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        let frames: Value = serde_json::from_str(&answer.stdout).unwrap();
        ["hip_flexion_r", "hip_adduction_r", "knee_angle_r", "ankle_angle_r"]
            .map(|name| frames[0]["coordinates"][name]["external"].as_f64().unwrap())
    };
    let model = contrapposto::model::adult(&contrapposto::model::Adult::default()).unwrap();
    let (foot, hip) = (model.segment("calcn_r").unwrap(), model.coordinate("hip_flexion_r").unwrap());
    let mut posture = model.default_posture();
    posture.values_mut()[hip] = 30f64.to_radians();
    let mut kinematics = contrapposto::kinematics::Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let expected = |loads: &[Load]| {
        let mut external = ExternalTorque::new(&model);
        external.update(&model, &kinematics, loads).unwrap();
        ["hip_flexion_r", "hip_adduction_r", "knee_angle_r", "ankle_angle_r"]
            .map(|name| external.torques()[model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap()])
    };
    let (force, point) = (nalgebra::Vector3::new(10.0, 70.0, 5.0), nalgebra::Vector3::new(0.1, 0.02, 0.1));
    let in_foot = kinematics.placement(&model, foot);
    let load = |point, kind| Load { segment: foot, point, kind };
    let pelvis = kinematics.placement(&model, model.segment("pelvis").unwrap());
    let from_pelvis = (in_foot.inverse() * pelvis * nalgebra::Point3::from(point)).coords;
    let own = "<point_expressed_in_body>/bodyset/calcn_r</point_expressed_in_body>";
    for (more, load) in [
        (
            format!("<force_expressed_in_body>calcn_r</force_expressed_in_body>{own}"),
            load(point, LoadKind::Force(force, FixedIn::Segment)),
        ),
        (
            format!("<force_expressed_in_body>pelvis</force_expressed_in_body>{own}"),
            load(point, LoadKind::Force(pelvis.rotation * force, FixedIn::World)),
        ),
        (
            "<point_expressed_in_body>pelvis</point_expressed_in_body>".to_owned(),
            load(from_pelvis, LoadKind::Force(force, FixedIn::World)),
        ),
    ] {
        let (found, expected) = (torques(&external(folder.path(), &more)), expected(&[load]));
        found.iter().zip(&expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{more}: {a} and {b}"));
    }
    let couple = "<ExternalLoads><datafile>forces.csv</datafile><objects><ExternalForce name=\"c\"><applied_to_body>calcn_r</applied_to_body>\
                  <torque_identifier>ground_torque_</torque_identifier></ExternalForce></objects></ExternalLoads>";
    let alone = torques(&write(folder.path(), "couple.xml", couple));
    let expected = expected(&[load(point, LoadKind::Couple(nalgebra::Vector3::new(1.0, 2.0, 3.0), FixedIn::World))]);
    alone.iter().zip(&expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{a} and {b}"));
}

#[test]
fn a_table_with_a_wrong_number_of_rows_is_read_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let text = "motion\nnRows=901\nnColumns=2\ninDegrees=yes\nendheader\ntime\thip_flexion_r\n0\t5\n1\t6\n";
    let motion = write(folder.path(), "motion.mot", text);
    let answer = run(&["torques", "adult", &motion, "--quiet"]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("the header says 901 rows (line 2), but there are 2, which are read"),
        "{}",
        answer.stderr
    );
}

/// `assess` of the adult on both feet under a motion.
fn assessed_on_feet(motion: &str) -> support::Run {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motion.csv");
    std::fs::write(&path, motion).unwrap();
    contrapposto(["assess", "adult"])
        .arg(&path)
        .args(["--degrees", "--support", "calcn_r,calcn_l", "--no-suggest"])
        .run()
}

#[test]
fn a_foot_in_the_air_that_is_named_as_a_support_gives_a_warning_with_its_height() {
    let run =
        assessed_on_feet("time,hip_flexion_r,knee_angle_r,elbow_flex_r,elbow_flex_l\n0,90,90,20,20\n60,90,90,20,20\n");
    let warning = run.stderr.lines().find(|line| line.contains("support `calcn_r` is ")).unwrap();
    let height: f64 = warning.split("is ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    // The thigh of the adult is level, its shank hangs: the foot is about a thigh's length up.
    assert!((30.0..50.0).contains(&height) && warning.contains("100 % of the time"), "{warning}");
    assert!(!run.stderr.contains("support `calcn_l` is "), "{}", run.stderr);
}

#[test]
fn tilted_soles_give_a_warning_with_their_angle_and_level_ones_none() {
    let tilted = assessed_on_feet("time,ankle_angle_r,ankle_angle_l,elbow_flex_r,elbow_flex_l\n0,-30,-30,20,20\n");
    for foot in ["calcn_r", "calcn_l"] {
        let words = format!("the patch of support `{foot}` is tilted by 30 deg at 0 s");
        assert!(tilted.stderr.contains(&words), "{}", tilted.stderr);
    }
    let level = assessed_on_feet("time,elbow_flex_r,elbow_flex_l\n0,20,20\n");
    assert!(!level.stderr.contains("tilted") && !level.stderr.contains("lowest support"), "{}", level.stderr);
}

#[test]
fn a_hinge_a_quarter_turn_beyond_its_range_gives_a_warning_with_its_frame() {
    let run = assessed_on_feet(
        "time,hip_flexion_r,elbow_flex_r,elbow_flex_l\n0,0,20,20\n1,0,20,20\n2,300,20,20\n3,0,20,20\n",
    );
    assert!(run.stderr.contains("warning: `hip_flexion_r` is at 300.0 deg at 2 s, "), "{}", run.stderr);
}

#[test]
fn frames_that_all_have_one_time_are_refused() {
    let run = assessed_on_feet("time,elbow_flex_r\n0,20\n0,20\n");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("its 2 instants all have the time 0 s; times must rise"), "{}", run.stderr);
}
