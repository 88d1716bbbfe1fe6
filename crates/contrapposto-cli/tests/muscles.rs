//! `contrapposto muscles`, and what `inspect` says of muscles, through the real program.

use crate::support;

use support::{json, refused, run, write};

/// A body on a hinge about z, and forces.
fn model(forces: &str) -> String {
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"b\"><mass>1</mass>
           <WrapObjectSet><objects><WrapCylinder name=\"roll\"><radius>0.01</radius><length>1</length></WrapCylinder>
           <WrapCube name=\"cube\"/></objects></WrapObjectSet></Body></objects></BodySet>
         <JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/b</socket_child_frame>
           <coordinates><Coordinate name=\"q\"/></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects>{forces}</objects></ForceSet></Model></OpenSimDocument>"
    )
}

/// A muscle 0.04 m in front of the hinge, 0.5 m long.
fn muscle(kind: &str, name: &str, more: &str) -> String {
    format!(
        "<{kind} name=\"{name}\"><GeometryPath><PathPointSet><objects>
         <PathPoint name=\"p\"><socket_parent_frame>/ground</socket_parent_frame><location>0.04 0.2 0</location></PathPoint>
         <PathPoint name=\"o\"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>0.04 -0.3 0</location></PathPoint>
         </objects></PathPointSet></GeometryPath><max_isometric_force>500</max_isometric_force>
         <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.38</tendon_slack_length>{more}</{kind}>"
    )
}

#[test]
fn a_muscle_has_the_length_moment_arm_and_forces_of_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let forces = muscle("Thelen2003Muscle", "t", "") + &muscle("Millard2012EquilibriumMuscle", "m", "");
    let file = write(folder.path(), "m.osim", &model(&forces));
    for rule in ["geodesic", "opensim"] {
        let frame = json(&["muscles", &file, "--json", "--rule", rule]);
        let number = |key: &str, name: &str| frame[key][name].as_f64().unwrap();
        for name in ["t", "m"] {
            assert!((number("lengths_m", name) - 0.5).abs() < 1e-12);
            assert!((frame["moment_arms_m"][name]["q"].as_f64().unwrap() - 0.04).abs() < 1e-12);
            let (tendon, passive) = (number("tendon_forces_n", name), number("passive_forces_n", name));
            assert!(passive > 0.0 && passive < tendon && tendon < number("max_forces_n", name), "{frame}");
        }
        let all = |key: &str| 0.04 * (number(key, "t") + number(key, "m"));
        let strength = &frame["strength_nm"]["q"];
        assert!((strength["positive"]["sum"].as_f64().unwrap() - all("max_forces_n")).abs() < 1e-9);
        assert!((strength["negative"]["sum"].as_f64().unwrap() - all("tendon_forces_n")).abs() < 1e-9);
        // No other joint limits the torque about the only one.
        for (sense, key) in [("positive", "max_forces_n"), ("negative", "tendon_forces_n")] {
            assert!((strength[sense]["coupled"].as_f64().unwrap() - all(key)).abs() < 1e-9);
        }
        assert!((number("passive_torques_nm", "q") - all("passive_forces_n")).abs() < 1e-9);
    }
    let table = run(&["muscles", &file]);
    assert!(table.code == 0 && table.stdout.contains("q 40.0"), "{}", table.stdout);
}

#[test]
fn inspect_counts_every_muscle_and_surface_as_read_left_out_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let forces = [
        muscle("Thelen2003Muscle", "a", ""),
        muscle("Thelen2003Muscle", "b", "<appliesForce>false</appliesForce>"),
        muscle("Thelen2003Muscle", "c", "<KshapeActive>0</KshapeActive>"),
        muscle("Thelen2003Muscle", "a", ""),
        muscle("RigidTendonMuscle", "d", ""),
    ];
    let file = write(folder.path(), "m.osim", &model(&forces.concat()));
    let report = json(&["inspect", &file, "--json"]);
    let counts = |kind: &str| {
        ["read", "left_out", "refused"].map(|what| report["muscles"][kind][what].as_u64().unwrap_or_default())
    };
    assert_eq!(counts("Thelen2003Muscle"), [1, 1, 2], "{}", report["muscles"]);
    assert_eq!(counts("RigidTendonMuscle"), [0, 0, 1]);
    assert_eq!(counts("PathPoint"), [2, 0, 0]);
    assert_eq!(counts("WrapCylinder"), [1, 0, 0]);
    assert_eq!(counts("WrapCube"), [0, 0, 1]);
    let readable = run(&["inspect", &file]);
    for part in
        ["switched off in the file", "KshapeActive is 0", "a second muscle `a`", "RigidTendonMuscle is not supported"]
    {
        assert!(readable.stdout.contains(part), "{part}: {}", readable.stdout);
    }
}

#[test]
fn a_model_without_muscles_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model(""));
    assert!(refused(&["muscles", &file]).contains("no muscle could be read from it"));
    assert!(refused(&["muscles", "adult"]).contains("MODEL is an OpenSim or MJCF file with muscles"));
    assert!(refused(&["muscles", &file, "--activation", "2"]).contains("from 0 to 1"));
}

/// An MJCF arm with a muscle of the class `strong`, `more` beside it.
fn mjcf(more: &str) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/>
        <default><default class="strong"><muscle range="0.5 1.5" force="100" lengthrange="0.3 0.7"/></default></default>
        <worldbody><site name="base" pos="0.04 0.2 0"/>
          <body name="arm"><joint name="turn" axis="0 0 1"/><geom type="mesh" mesh="bone"/>
            <site name="tip" pos="0.04 -0.3 0"/></body></worldbody>
        <tendon><spatial name="t"><site site="base"/><site site="tip"/></spatial></tendon>
        <actuator><muscle class="strong" name="m" tendon="t"/>{more}</actuator></mujoco>"#
    )
}

#[test]
fn a_muscle_of_an_mjcf_file_has_mujocos_forces_even_where_the_mass_of_a_mesh_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "arm.xml", &mjcf(r#"<muscle name="n" tendon="t" force="3"/>"#));
    let frame = json(&["muscles", &file, "--json"]);
    assert!((frame["lengths_m"]["m"].as_f64().unwrap() - 0.5).abs() < 1e-15, "{frame}");
    assert!((frame["moment_arms_m"]["m"]["turn"].as_f64().unwrap() - 0.04).abs() < 1e-15, "{frame}");
    // At its optimal length: all its force, and no passive one.
    assert!((frame["max_forces_n"]["m"].as_f64().unwrap() - 100.0).abs() < 1e-9, "{frame}");
    assert!(frame["passive_forces_n"]["m"].as_f64().unwrap().abs() < 1e-9, "{frame}");
    let kinds = &json(&["inspect", &file, "--json"])["muscles"];
    assert_eq!((&kinds["muscle"]["read"], &kinds["muscle"]["refused"]), (&1.into(), &1.into()), "{kinds}");
    assert_eq!(kinds["spatial"]["read"], 1);
    let message = run(&["inspect", &file]);
    assert!(message.stdout.contains("no lengthrange is given"), "{}", message.stdout);
    // Torques need the mass.
    assert!(refused(&["torques", &file, "default"]).contains("comes from a mesh"));
}

/// Two forearms with mass on the adult's elbows, three muscles at the right one, and frames at 5 and 20 degrees.
fn elbows(folder: &std::path::Path) -> (String, String) {
    let back = muscle("Thelen2003Muscle", "back", "").replace("0.04", "-0.1");
    let forces = muscle("Thelen2003Muscle", "t", "") + &muscle("Millard2012EquilibriumMuscle", "m", "") + &back;
    let left = "<Body name=\"c\"><mass>1</mass><mass_center>0 -0.2 0</mass_center></Body></objects></BodySet>";
    let joint = "<PinJoint name=\"k\"><socket_parent_frame>/ground</socket_parent_frame>
        <socket_child_frame>/bodyset/c</socket_child_frame>
        <coordinates><Coordinate name=\"elbow_flex_l\"/></coordinates></PinJoint></objects></JointSet>";
    let text = model(&forces)
        .replace("<mass>1</mass>", "<mass>1</mass><mass_center>0 -0.2 0</mass_center>")
        .replace("</objects></BodySet>", left)
        .replace("</objects></JointSet>", joint)
        .replace("\"q\"", "\"elbow_flex_r\"");
    let motion = "time,elbow_flex_r_deg,elbow_flex_l_deg\n0,5,40\n10,20,40\n";
    (write(folder, "elbows.osim", &text), write(folder, "hold.csv", motion))
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// Sum over muscles of moment arm times one of their forces, from `contrapposto muscles`.
fn torque_of(frame: &serde_json::Value, force: impl Fn(&str, f64) -> f64) -> f64 {
    let arms = frame["moment_arms_m"].as_object().unwrap();
    let of = |(name, arms): (&String, &serde_json::Value)| {
        let arm = number(&arms["elbow_flex_r"]);
        arm * force(name, arm)
    };
    arms.iter().map(of).sum()
}

#[test]
fn passive_torque_and_strength_of_a_crossed_joint_are_the_muscles_and_others_keep_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let (file, motion) = elbows(folder.path());
    let lines = run(&["muscles", &file, &motion, "--json"]).stdout;
    let own: Vec<serde_json::Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let built_in = json(&["torques", &file, &motion, "--json", "--muscles", "off"]);
    let source = serde_json::json!({ "status": "derived", "source": "muscles of the model" });
    for uses in ["both", "strength", "passive"] {
        let frames = json(&["torques", &file, &motion, "--json", "--muscles", uses]);
        for (frame, own) in own.iter().enumerate() {
            let [all, library] = [&frames, &built_in].map(|frames| &frames[frame]["coordinates"]);
            assert_eq!(all["elbow_flex_l"], library["elbow_flex_l"], "no muscle crosses it");
            let (found, library) = (&all["elbow_flex_r"], &library["elbow_flex_r"]);
            let passive = torque_of(own, |name, _| number(&own["passive_forces_n"][name]));
            if uses == "strength" {
                assert_eq!(
                    (&found["passive"], &found["passive_source"]),
                    (&library["passive"], &serde_json::Value::Null)
                );
            } else {
                assert!((number(&found["passive"]) - passive).abs() < 1e-9, "{uses}: {found}");
                assert!((number(&found["passive"]) - number(&library["passive"])).abs() > 0.1, "{found} {library}");
                assert_eq!(found["passive_source"], source);
                let balance = number(&found["external"]) + number(&found["passive"]) + number(&found["active"]);
                assert!(balance.abs() < 1e-12, "{found}");
            }
            if uses == "passive" {
                assert_eq!(found["strength"], library["strength"]);
                continue;
            }
            let sums = &own["strength_nm"]["elbow_flex_r"];
            for (side, (sense, sign)) in [("positive", 1.0), ("negative", -1.0)].into_iter().enumerate() {
                let force = |name: &str, arm: f64| {
                    let key = if arm * sign > 0.0 { "max_forces_n" } else { "tendon_forces_n" };
                    number(&own[key][name])
                };
                let greatest = torque_of(own, force);
                assert!((number(&sums[sense]["sum"]) - greatest).abs() < 1e-9);
                let beyond = sign * (greatest - passive);
                let strength = &found["strength"][side];
                assert!(beyond > 1.0 && (number(&strength["strength_nm"]) - beyond).abs() < 1e-9, "{uses}: {found}");
                assert_eq!((&strength["status"], &strength["floor"]), (&source["status"], &false.into()));
                assert_eq!(strength["source"], "muscles of the model, isometric");
            }
        }
    }
    assert_eq!(
        json(&["torques", &file, &motion, "--json"]),
        json(&["torques", &file, &motion, "--json", "--muscles", "both"])
    );
    let message = run(&["torques", &file, &motion, "--verbose"]).stderr;
    assert!(message.contains("cross are theirs in each posture (derived; strength is a plain sum)"), "{message}");
    assert!(message.contains("built-in data; `elbow_flex_l` keep what they have without muscles"), "{message}");
    assert!(!message.contains("not used"), "{message}");
    assert!(
        refused(&["torques", "adult", "default", "--muscles", "both"]).contains("--muscles: no muscle could be read")
    );
}

#[test]
fn assess_judges_every_frame_by_the_strength_of_the_muscles_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let (file, motion) = elbows(folder.path());
    let arguments = |command: &'static str| {
        let all = [command, &file, &motion, "--json", "--load", "b 4kg"];
        json(&all)
    };
    let (frames, found) = (arguments("torques"), arguments("assess"));
    let groups = found["groups"].as_array().unwrap();
    let right = |group: &&serde_json::Value| {
        group["coordinate"] == "elbow_flex_r" && number(&group["peak_load"]["value"]) > 0.0
    };
    let group = groups.iter().find(right).unwrap();
    let of_frame = &frames[usize::from(number(&group["peak_load"]["at_s"]) > 5.0)]["coordinates"]["elbow_flex_r"];
    let (active, strength) = (number(&group["active_at_peak_nm"]), number(&group["strength_at_peak"]["strength_nm"]));
    assert_eq!(group["strength_at_peak"]["source"], "muscles of the model, isometric");
    assert!((number(&group["peak_load"]["value"]) - active.abs() / strength).abs() < 1e-12, "{group}");
    assert!(
        (strength - number(&of_frame["strength"][usize::from(active < 0.0)]["strength_nm"])).abs() < 1e-12,
        "{group}"
    );
    assert!((number(&group["passive_at_peak_nm"]) - number(&of_frame["passive"])).abs() < 1e-12, "{group}");
    assert_eq!(group["proposals"].as_array().unwrap().len(), 0, "no falling curve of muscles is known");
    let page = folder.path().join("out");
    assert_eq!(run(&["assess", &file, &motion, "--load", "b 4kg", "--out", page.to_str().unwrap()]).code, 0);
    let text = std::fs::read_to_string(page.join("report.html")).unwrap();
    assert!(text.contains("derived (muscles of the model, isometric)"), "the page names the source");
}

#[test]
fn a_passive_law_and_a_strength_of_an_overlay_are_whole_joints_to_which_no_muscle_is_added() {
    let folder = tempfile::tempdir().unwrap();
    let (file, motion) = elbows(folder.path());
    let law = "[coordinates.elbow_flex_r]\nstrength = { positive_nm = 50.0, negative_nm = 40.0 }\n\
               passive.table_deg_nm = [[-10, 5], [0, 1], [150, -5]]\nrange_deg = [-10, 150]\n";
    let overlay = write(folder.path(), "overlay.toml", law);
    let with =
        |uses: &'static str| json(&["torques", &file, &motion, "--json", "--overlay", &overlay, "--muscles", uses]);
    assert_eq!(with("both"), with("off"));
    let message = run(&["torques", &file, &motion, "--overlay", &overlay, "--verbose"]).stderr;
    assert!(
        message.contains("muscles cross `elbow_flex_r`, whose joints have a passive law or strength of their own"),
        "{message}"
    );
}

#[test]
fn a_joint_whose_muscles_are_far_weaker_than_people_keeps_the_built_in_strength_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (file, motion) = elbows(folder.path());
    let text = std::fs::read_to_string(&file).unwrap();
    let message = |file: &str, more: &[&str]| run(&[&["torques", file, &motion], more].concat()).stderr;
    assert!(!message(&file, &[]).contains("far weaker"), "{}", message(&file, &[]));
    let force = |newtons: u32| format!("<max_isometric_force>{newtons}</max_isometric_force>");
    let weak = write(folder.path(), "weak.osim", &text.replace(&force(500), &force(50)));
    let said = "the model's muscles are far weaker than people in the default posture: right elbow ";
    assert!(message(&weak, &["--quiet"]).contains(&format!("warning: {said}")), "{}", message(&weak, &["--quiet"]));
    assert!(!message(&weak, &["--muscles", "off"]).contains("far weaker"));
    let warnings = json(&["assess", &weak, &motion, "--json"])["warnings"].clone();
    assert!(
        warnings.as_array().unwrap().iter().any(|warning| warning.as_str().unwrap().starts_with(said)),
        "{warnings}"
    );
    let elbow = |more: &[&str]| {
        let frames = json(&[&["torques", &weak, &motion, "--json"], more].concat());
        frames[0]["coordinates"]["elbow_flex_r"].clone()
    };
    let (kept, built_in) = (elbow(&[]), elbow(&["--muscles", "off"]));
    assert_eq!(kept["strength"], built_in["strength"], "that of the built-in data, with its status");
    assert_eq!(kept["passive_source"]["source"], "muscles of the model", "passive torque stays the muscles'");
    assert_ne!(kept["passive"], built_in["passive"]);
}

#[test]
fn a_sense_in_which_no_muscle_pulls_has_the_least_strength_marked_as_assumed_where_no_built_in_one_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model(&muscle("Thelen2003Muscle", "t", "")));
    let frames = json(&["torques", &file, "default", "--json"]);
    let [pulled, not_pulled] = [0, 1].map(|side| &frames[0]["coordinates"]["q"]["strength"][side]);
    assert_eq!((&pulled["status"], &pulled["floor"]), (&"derived".into(), &false.into()), "{pulled}");
    assert_eq!((&not_pulled["status"], &not_pulled["floor"]), (&"assumed".into(), &true.into()), "{not_pulled}");
    assert_eq!(not_pulled["strength_nm"], 0.001);
}

#[test]
fn muscles_that_could_not_be_read_are_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let (file, motion) = elbows(folder.path());
    let text = std::fs::read_to_string(&file).unwrap();
    let message = |file: &str| run(&["torques", file, &motion, "--quiet"]).stderr;
    let unread = text.replace("<Thelen2003Muscle name=\"back\">", "<RigidTendonMuscle name=\"back\">");
    assert_ne!(unread, text);
    let end = unread.rfind("</Thelen2003Muscle>").unwrap();
    let unread = format!("{}</RigidTendonMuscle>{}", &unread[..end], &unread[end + "</Thelen2003Muscle>".len()..]);
    let unread = write(folder.path(), "unread.osim", &unread);
    assert!(message(&unread).contains("warning: 1 of 3 muscles could not be read"), "{}", message(&unread));
}

/// The arm of `elbows` with a hand at 60 degrees of flexion and a weight in it.
fn weight_in_hand(folder: &std::path::Path, name: &str, model: &str) -> String {
    let text = format!(
        "format = 1\n[model]\n{model}\n[posture]\nelbow_flex_r_deg = 20\n[[load]]\nsegment = \"b\"\nmass_kg = 6\n\
         [[task]]\nkind = \"point\"\nsegment = \"b\"\nat_m = [0, -0.3, 0]\ntarget_m = [0.259807621, -0.15, 0]\n"
    );
    write(folder, name, &text)
}

#[test]
fn the_posture_of_a_scenario_has_the_strength_of_the_muscles_in_it() {
    let folder = tempfile::tempdir().unwrap();
    elbows(folder.path());
    let scenario = |uses: &str| {
        let model = format!("file = \"elbows.osim\"\nmuscles = \"{uses}\"");
        json(&["relax", &weight_in_hand(folder.path(), &format!("{uses}.toml"), &model), "--json"])
    };
    let work = |found: &serde_json::Value| {
        let groups = found["postures"][0]["groups"].as_array().unwrap();
        groups.iter().find(|group| group["coordinate"] == "elbow_flex_r").unwrap().clone()
    };
    let (found, without) = (scenario("strength"), scenario("off"));
    let angle = number(&found["postures"][0]["coordinates"]["elbow_flex_r"]).to_degrees();
    assert!((angle - 60.0).abs() < 0.1, "{angle}");
    let motion = format!("time,elbow_flex_r_deg,elbow_flex_l_deg\n0,{angle:?},0\n");
    let motion = write(folder.path(), "there.csv", &motion);
    let file = folder.path().join("elbows.osim");
    let frames = json(&["torques", file.to_str().unwrap(), &motion, "--json", "--muscles", "strength"]);
    let (group, side) = (work(&found), usize::from(number(&work(&found)["active_nm"]) < 0.0));
    let expected = number(&frames[0]["coordinates"]["elbow_flex_r"]["strength"][side]["strength_nm"]);
    let strength = number(&group["strength_nm"]);
    assert!((strength / expected - 1.0).abs() < 2e-6, "{strength} N m for {expected}");
    assert!((number(&group["relative_load"]) - number(&group["active_nm"]).abs() / strength).abs() < 1e-12, "{group}");
    assert!((number(&work(&without)["strength_nm"]) / strength - 1.0).abs() > 0.01, "the built-in one differs");
}

/// Without `muscles` a scenario takes strength and passive torque from an OpenSim model's muscles: each of the four uses gives other numbers.
#[test]
fn a_scenario_that_does_not_say_which_muscles_count_uses_both_strength_and_passive_torque() {
    let folder = tempfile::tempdir().unwrap();
    elbows(folder.path());
    let numbers = |uses: Option<&str>| {
        let key = uses.map(|uses| format!("\nmuscles = \"{uses}\"")).unwrap_or_default();
        let file = weight_in_hand(folder.path(), "hand.toml", &format!("file = \"elbows.osim\"{key}"));
        let found = json(&["relax", &file, "--json"]);
        let groups = found["postures"][0]["groups"].as_array().unwrap();
        let group = groups.iter().find(|group| group["coordinate"] == "elbow_flex_r").unwrap();
        ["strength_nm", "active_nm"].map(|key| number(&group[key]))
    };
    let [silent, both, strength, passive, off] =
        [None, Some("both"), Some("strength"), Some("passive"), Some("off")].map(numbers);
    assert_eq!(silent, both);
    let apart = |a: f64, b: f64| (a / b - 1.0).abs() > 0.01;
    // Strength is the muscles' in two of the four; so is passive torque in another two, by which the active torque under the weight is less.
    assert!(apart(both[0], off[0]) && apart(both[1], off[1]), "{both:?} {off:?}");
    assert!(!apart(both[0], strength[0]) && apart(both[1], strength[1]), "{both:?} {strength:?}");
    assert!(apart(both[0], passive[0]) && !apart(both[1], passive[1]), "{both:?} {passive:?}");
}

#[test]
fn a_scenario_refuses_muscles_that_it_cannot_use_by_name() {
    let folder = tempfile::tempdir().unwrap();
    elbows(folder.path());
    let message = |model: &str| refused(&["relax", &weight_in_hand(folder.path(), "refused.toml", model)]);
    let text = message("muscles = \"strength\"\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75 }");
    assert!(text.contains("`muscles` goes with a model file"), "{text}");
    write(folder.path(), "bare.osim", &model(""));
    let text = message("file = \"bare.osim\"\nmuscles = \"strength\"");
    assert!(text.contains("refused.toml: [model] muscles: no muscle could be read from the model"), "{text}");
    let text = message("file = \"elbows.osim\"\nmuscles = \"all\"");
    assert!(text.contains("there are: off, strength, passive, both"), "{text}");
}
