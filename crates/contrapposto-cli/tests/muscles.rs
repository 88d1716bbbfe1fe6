//! `contrapposto muscles`, and what `inspect` says of muscles, through the real program.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]

mod support;

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
    let told = run(&["inspect", &file]);
    assert!(told.stdout.contains("no lengthrange is given"), "{}", told.stdout);
    // Torques need the mass.
    assert!(refused(&["torques", &file, "default"]).contains("comes from a mesh"));
}
