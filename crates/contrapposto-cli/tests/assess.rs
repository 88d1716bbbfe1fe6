//! `contrapposto assess` through the real program: who fails when, the same from ground reactions as from supports, and what it
//! says to files that make no sense.

use crate::support;

use std::fmt::Write;
use std::path::Path;

use contrapposto::contact::{Balance, ContactForces, Support};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::statics::LoadKind;
use contrapposto_formats::motion::{Table, read_table};
use nalgebra::Vector3;
use serde_json::Value;
use support::{column, joint, json, leg, page, refused, run, write};

fn table(path: &Path) -> Table {
    read_table("table", &std::fs::read(path).unwrap()).unwrap()
}

fn group<'a>(report: &'a Value, coordinate: &str, side: &str) -> &'a Value {
    let groups = report["groups"].as_array().unwrap();
    groups.iter().find(|group| group["coordinate"] == coordinate && group["side"] == side).unwrap()
}

/// A bent elbow and a bent knee hold a load: by muscle group and sex they fail when the closed form with that set's rates says, the
/// rates written here a second time. An export of the adult is recognised; another model has no sex.
#[test]
fn parameters_by_muscle_group_reach_the_adult_and_imported_models() {
    let folder = tempfile::tempdir().unwrap();
    let hold = write(folder.path(), "hold.csv", "time,elbow_flex_r_deg,knee_angle_r_deg\n0,90,30\n1000,90,30\n");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let own = std::fs::read_to_string(&file).unwrap();
    let other = own.replace("<mass>7.482</mass>", "<mass>7.5</mass>");
    assert_ne!(own, other);
    let other = write(folder.path(), "other.osim", &other);
    let file = file.to_str().unwrap();
    let held = |model: &str, more: &[&str]| {
        json(&[&["assess", model, &hold, "--fixed-root", "--load", "hand_r 8kg", "--json"], more].concat())
    };
    let time = |f: f64, r: f64, load: f64| -libm::log(1.0 - r * (1.0 - load) / (f * load)) / r;
    let by_group = ["--fatigue", "muscle_group"];
    let any = ["--fatigue", "muscle_group", "--fatigue-sex", "any"];
    let rows: [(&str, &[&str], &str, f64, f64); 6] = [
        ("adult", &[], "elbow", 0.00912, 0.00094),
        ("adult", &by_group, "elbow_flexor, male", 0.01302, 0.00188),
        ("adult:female,1.65m,60kg", &by_group, "elbow_flexor, female", 0.00965, 0.00197),
        ("adult:female,1.65m,60kg", &any, "elbow_flexor, any sex", 0.01703, 0.00494),
        (file, &by_group, "elbow_flexor, female", 0.00965, 0.00197),
        (&other, &by_group, "elbow_flexor, any sex", 0.01703, 0.00494),
    ];
    for (model, more, name, f, r) in rows {
        let report = held(model, more);
        let elbow = group(&report, "elbow_flex_r", "positive");
        assert_eq!(elbow["fatigue"], serde_json::json!({ "parameters": name, "status": "verified" }), "{model}");
        let expected = time(f, r, elbow["peak_load"]["value"].as_f64().unwrap());
        let found = elbow["exhausted_at_s"].as_f64().unwrap();
        assert!((found - expected).abs() < 0.01 * expected, "{model} {name}: {found}, {expected}");
    }
    let said = run(&["assess", "adult", &hold, "--fatigue", "muscle_group", "--verbose"]).stderr;
    assert!(said.contains("fatigue of ankle plantarflexion: `ankle_plantarflexor, male`"), "{said}");
    assert!(said.contains("no muscle group of its own, the joint fit `general`"), "{said}");
    assert!(!run(&["assess", "adult", &hold, "--verbose"]).stderr.contains("fatigue of"));
}

/// A straight elbow that was measured needs little of its extensors, an exact one much; a wrong error is refused by name.
#[test]
fn a_straight_elbow_is_judged_within_the_error_of_its_angle() {
    let folder = tempfile::tempdir().unwrap();
    let hold = write(folder.path(), "hold.csv", "time,elbow_flex_r_deg\n0,0\n600,0\n");
    let assess = ["assess", "adult", &hold, "--support", "calcn_r,calcn_l", "--json", "--no-suggest"];
    let answer = |more: &[&str]| json(&[&assess[..], more].concat());
    let [measured, exact] = [answer(&[]), answer(&["--angle-error", "0"])];
    assert_eq!((&measured["angle_error_deg"], &exact["angle_error_deg"]), (&5.0.into(), &0.0.into()));
    assert_eq!((&measured["verdict"]["kind"], &exact["verdict"]["kind"]), (&"holds".into(), &"held_until".into()));
    assert!(exact["verdict"]["who"].as_str().unwrap().contains("elbow extension"), "{}", exact["verdict"]);
    let elbow = group(&measured, "elbow_flex_r", "negative");
    let doubt = &elbow["angle_in_doubt"];
    assert_eq!(doubt["judged_load"], elbow["peak_load"]["value"]);
    assert_eq!(doubt["recorded_load"], group(&exact, "elbow_flex_r", "negative")["peak_load"]["value"]);
    assert!(group(&exact, "elbow_flex_r", "negative")["angle_in_doubt"].is_null());
    for wrong in ["-1", "21", "NaN", "five"] {
        let said = run(&[&assess[..], &["--angle-error", wrong]].concat());
        assert_eq!(said.code, 2, "{}", said.stderr);
        assert!(said.stderr.contains("an error of angles lies between 0 and 20 deg"), "{}", said.stderr);
    }
}

/// Every group that holds a constant load fails when its own law says, and those whose law lets them hold do not fail.
#[test]
fn a_constant_posture_fails_at_the_endurance_time() {
    const END: f64 = 1000.0;
    let folder = tempfile::tempdir().unwrap();
    let hold = write(folder.path(), "hold.csv", &format!("time,elbow_flex_r_deg\n0,90\n{END},90\n"));
    let load = ["--load", "hand_r 3kg", "--angle-error", "0"];
    let report = json(&[&["assess", "adult", &hold, "--fixed-root", "--json"][..], &load].concat());
    let model = adult(&Adult::default()).unwrap();
    let mut failed = 0;
    for found in report["groups"].as_array().unwrap() {
        let coordinate = &model.coordinates()[model.coordinate(found["coordinate"].as_str().unwrap()).unwrap()];
        let side = Side::BOTH.into_iter().find(|side| found["side"] == side.word()).unwrap();
        let group = &coordinate.groups.as_ref().unwrap()[side.index()];
        assert_eq!(found["group"], group.name.as_str());
        let expected = group.fatigue.endurance_time(found["peak_load"]["value"].as_f64().unwrap());
        match found["exhausted_at_s"].as_f64() {
            Some(time) => assert!((time - expected).abs() < 0.01 * expected, "{found}: {expected}"),
            None => assert!(expected > 0.99 * END, "{found}: {expected}"),
        }
        failed += usize::from(expected < END);
    }
    assert!(failed >= 4, "{failed}");
    // The arm that holds the weight is among them, at the load that `torques` says.
    let elbow = group(&report, "elbow_flex_r", "positive");
    let torque =
        &json(&["torques", "adult", &hold, "--load", "hand_r 3kg", "--json"])[0]["coordinates"]["elbow_flex_r"];
    let strength = &model.coordinates()[model.coordinate("elbow_flex_r").unwrap()].groups.as_ref().unwrap()[0].strength;
    let load = torque["active"].as_f64().unwrap() / strength.torque(90f64.to_radians());
    assert!((elbow["peak_load"]["value"].as_f64().unwrap() - load).abs() < 1e-12);
    assert!(elbow["exhausted_at_s"].as_f64().unwrap() < END);
    // The worst stand first.
    let times =
        report["groups"].as_array().unwrap().iter().map(|g| g["exhausted_at_s"].as_f64().unwrap_or(f64::INFINITY));
    assert!(times.is_sorted());
}

/// Relief is what `minimize` says of the same joint.
#[test]
fn relief_is_proposed_at_the_peaks() {
    let folder = tempfile::tempdir().unwrap();
    let lower = write(folder.path(), "lower.csv", "time,elbow_flex_r_deg\n0,90\n60,90\n120,20\n");
    let report = json(&["assess", "adult", &lower, "--fixed-root", "--load", "hand_r 3kg", "--json"]);
    let elbow = group(&report, "elbow_flex_r", "positive");
    assert_eq!(elbow["peak_load"]["at_s"], 0.0);
    let proposals = elbow["proposals"].as_array().unwrap();
    let kinds: Vec<_> =
        proposals.iter().map(|p| (p["at"].as_str().unwrap(), p["strategy"].as_str().unwrap())).collect();
    assert_eq!(kinds[..2], [("load", "active"), ("load", "passive")]);
    for proposal in proposals {
        let before = proposal["active_nm"].as_f64().unwrap().abs();
        assert!(proposal["active_at_goal_nm"].as_f64().unwrap().abs() <= before && before > 0.0, "{proposal}");
        assert!(proposal["sentence"].as_str().unwrap().starts_with("case "), "{proposal}");
    }
    assert!((proposals[0]["angle_deg"].as_f64().unwrap() - 90.0).abs() < 1e-9);
    let answer = run(&["assess", "adult", &lower, "--fixed-root", "--load", "hand_r 3kg"]);
    assert!(
        answer.stdout.contains("muscle group") && answer.stdout.contains("relief, if that joint alone moved:"),
        "{}",
        answer.stdout
    );
}

/// Three postures on both feet, and what the ground then gives: one plate a foot.
fn standing(model: &Model, supports: &[Support]) -> (String, String) {
    let mut motion = "time,lumbar_extension_deg,arm_flex_r_deg\n".to_owned();
    let mut ground = "time".to_owned();
    for plate in 1..=supports.len() {
        for label in ["ground_force_v", "ground_force_p", "ground_torque_"] {
            write!(ground, ",{plate}_{label}x,{plate}_{label}y,{plate}_{label}z").unwrap();
        }
    }
    ground.push('\n');
    let mut contact = ContactForces::new(model, supports.to_vec()).unwrap();
    let mut body = JointTorques::new(model);
    for (time, back, arm) in [(0.0, 0.0, 0.0), (10.0, -4.0, 20.0), (20.0, 2.0, 40.0)] {
        writeln!(motion, "{time},{back},{arm}").unwrap();
        let mut posture = model.default_posture();
        for (name, angle) in [("lumbar_extension", back), ("arm_flex_r", arm)] {
            posture.values_mut()[model.coordinate(name).unwrap()] = f64::to_radians(angle);
        }
        body.update_with_contact(model, &posture, &[], &mut contact, Quantities::TORQUES).unwrap();
        let kinematics = body.kinematics();
        assert_eq!(contact.balance(), Balance::Held, "at {time} s");
        write!(ground, "{time}").unwrap();
        for (number, support) in supports.iter().enumerate() {
            let at = kinematics.station(model, support.segment, support.corners[0]);
            let mut couple = Vector3::zeros();
            for load in &contact.loads()[contact.corners(number)] {
                let LoadKind::Force(force, _) = load.kind else { panic!("{load:?}") };
                couple += (kinematics.station(model, load.segment, load.point) - at).cross(&force);
            }
            for value in [contact.force(number), at, couple].iter().flatten() {
                write!(ground, ",{value:?}").unwrap();
            }
        }
        ground.push('\n');
    }
    (motion, ground)
}

#[test]
fn ground_reaction_and_supports_give_the_same_torques() {
    let folder = tempfile::tempdir().unwrap();
    let model = adult(&Adult::default()).unwrap();
    let supports = ["calcn_r", "calcn_l"].map(|name| {
        let segment = model.segment(name).unwrap();
        let corners = model.segments()[segment].patch.clone();
        Support {
            segment,
            corners,
            normal: Vector3::y(),
            friction: 0.6,
            share_max: 1.0,
            place: contrapposto::contact::Place::Fixed,
        }
    });
    let (motion, ground) = standing(&model, &supports);
    let motion = write(folder.path(), "motion.csv", &motion);
    let ground = write(folder.path(), "ground.csv", &ground);
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let on = run(&["assess", "adult", &motion, "--support", "calcn_r,calcn_l", "--out", &out("on")]);
    let grf = run(&["assess", "adult", &motion, "--grf", &ground, "--grf-on", "calcn_r,calcn_l", "--out", &out("grf")]);
    for answer in [&on, &grf] {
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        let warnings = answer.stderr.lines().filter(|line| line.starts_with("warning"));
        assert!(warnings.clone().all(|line| line.contains("against the ligaments")), "{}", answer.stderr);
    }
    let [on, grf] = ["on", "grf"].map(|name| table(&folder.path().join(name).join("torques.sto")));
    assert_eq!((on.columns.len(), on.rows.len(), &on.columns), (grf.columns.len(), 3, &grf.columns));
    let mut worst = 0.0_f64;
    for (a, b) in on.rows.iter().flatten().zip(grf.rows.iter().flatten()) {
        worst = worst.max((a - b).abs());
    }
    assert!(worst < 1e-7, "{worst} N m");
    // Both pages show the same forces at the same places, the centre of mass between them, and the same ground.
    let [on_page, grf_page] = ["on", "grf"].map(|name| page(&folder.path().join(name)));
    for (a, b) in [0, 1].map(|i| (&on_page["supports"][i], &grf_page["supports"][i])) {
        assert_eq!(a["label"], b["label"]);
        for (key, near) in [("force", 0.51), ("at", 2.1e-4)] {
            for k in 0..3 {
                let (a, b) = (column(&a[key][k], 3), column(&b[key][k], 3));
                assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < near), "{key} {a:?} {b:?}");
            }
        }
        assert!(column(&a["share"], 3).iter().all(|share| (0.2..0.8).contains(share)));
    }
    assert!((on_page["ground"].as_f64().unwrap() - grf_page["ground"].as_f64().unwrap()).abs() < 1e-3);
    assert_eq!(on_page["center"], grf_page["center"]);
    // The root is held, by the ground alone.
    for (label, column) in on.columns.iter().zip(0..).filter(|(label, _)| label.starts_with("pelvis_")) {
        if label.contains(".active_") {
            assert!(on.rows.iter().all(|row| row[column].abs() < 1e-6), "{label}");
        }
    }
}

/// A table may say one time twice; the film shows it once.
#[test]
fn a_motion_with_a_time_twice_has_all_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "twice.csv", "time,elbow_flex_r_deg\n0,90\n1,80\n1,70\n2,60\n");
    let out = folder.path().join("out");
    let answer = run(&["assess", "adult", &motion, "--fixed-root", "--out", out.to_str().unwrap()]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    let gltf = std::fs::read(out.join("motion.glb")).unwrap();
    let length = u32::from_le_bytes(gltf[12..16].try_into().unwrap()) as usize;
    let scene: Value = serde_json::from_slice(&gltf[20..20 + length]).unwrap();
    let samplers = scene["animations"][0]["samplers"].as_array().unwrap();
    let frames = |sampler: &Value| scene["accessors"][sampler["input"].as_u64().unwrap() as usize]["count"].as_u64();
    assert_eq!(samplers.iter().map(frames).max(), Some(Some(3)), "0, 1 and 2 s; {samplers:?}");
}

#[test]
fn files_are_those_of_torques_and_json_is_what_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n5,60\n");
    let out = folder.path().join("out");
    let target = out.to_str().unwrap();
    let answer = run(&["assess", "adult", &motion, "--load", "hand_r 3kg", "--json", "--out", target]);
    // Nothing carries it.
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(answer.stderr.contains("warning: nothing holds the body up"), "{}", answer.stderr);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    assert_eq!(answer.stdout, read("assess.json"));
    let report: Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!(
        report["files"],
        serde_json::json!(["assess.json", "torques.sto", "fatigue.sto", "report.html", "motion.glb"])
    );
    let warnings = report["warnings"].as_array().unwrap();
    let begin = [
        "nothing holds the body up",
        "muscles work more against the passive tissue",
        "muscles that work against the ligaments",
    ];
    let message = |(warning, begin): (&Value, &str)| warning.as_str().unwrap().starts_with(begin);
    assert!(warnings.len() == 3 && warnings.iter().zip(begin).all(message), "{warnings:?}");
    let plain = folder.path().join("plain.sto");
    let arguments = ["torques", "adult", &motion, "--load", "hand_r 3kg", "--out", plain.to_str().unwrap()];
    assert_eq!(run(&arguments).code, 0);
    assert_eq!(read("torques.sto"), std::fs::read_to_string(plain).unwrap());
    let fatigue = table(&out.join("fatigue.sto"));
    assert_eq!(fatigue.times, [0.0, 5.0]);
    let at = |label: &str| fatigue.columns.iter().position(|column| column == label).unwrap();
    let elbow = group(&report, "elbow_flex_r", "positive");
    assert_eq!(fatigue.rows[1][at("elbow_flex_r.fatigue_positive")], elbow["fatigue_at_end"]);
    assert_eq!(fatigue.rows[0][at("elbow_flex_r.load_positive")], elbow["peak_load"]["value"]);
    assert_eq!(fatigue.rows[1][at("elbow_flex_r.load_negative")], 0.0);

    let page = page(&out);
    assert_eq!((&page["title"], column(&page["times"], 2)), (&serde_json::json!("two.csv"), vec![0.0, 5.0]));
    let shown = joint(&page, "elbow_flex_r");
    assert_eq!(column(&shown["angle"], 2), [90.0, 60.0]);
    let [load, tired] = [&shown["load"], &shown["groups"][0]["fatigue"]].map(|values| column(values, 2));
    assert!((load[0] - elbow["peak_load"]["value"].as_f64().unwrap()).abs() < 6e-4, "{load:?}");
    assert!((tired[1] - elbow["fatigue_at_end"].as_f64().unwrap()).abs() < 6e-4, "{tired:?}");
    let reason = |i: usize| page["reasons"][i].as_str().unwrap();
    assert!(page["levels"].is_null() && reason(1).starts_with("Nothing holds the body up"), "{}", reason(1));
    assert!(reason(0).starts_with("To say who carries it, give --support SEG,SEG or --grf FILE.mot;"), "{}", reason(0));
    // The relief of the elbow is on the page, with the angle of assess.json.
    let goal = elbow["proposals"][0]["goal_deg"].as_f64().unwrap();
    let message = page["list"]["entries"].as_array().unwrap().iter().map(|entry| entry["text"].as_str().unwrap());
    let message: Vec<&str> = message.filter(|text| text.starts_with("Right elbow flexion: greatest load")).collect();
    assert!(message.len() == 1 && message[0].contains(&format!("to {goal:.1}°")), "{message:?} {goal}");
}

/// A whole adult that nothing carries falls, whatever its muscles can hold; with its root held only they are judged.
#[test]
fn a_body_that_nothing_carries_cannot_stand_unless_its_root_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n5,90\n");
    let answer = |more: &[&str]| run(&[&["assess", "adult", &motion, "--json"], more].concat());
    let verdict = |more: &[&str]| serde_json::from_str::<Value>(&answer(more).stdout).unwrap()["verdict"].clone();
    let weight = adult(&Adult::default()).unwrap().mass() * 9.80665;
    let falls = verdict(&[]);
    assert_eq!((answer(&[]).code, &falls["kind"]), (1, &serde_json::json!("cannot_stand")));
    let missing: f64 =
        falls["sentence"].as_str().unwrap().split(" N ").next().unwrap().rsplit(' ').next().unwrap().parse().unwrap();
    assert!((missing - weight).abs() < 0.01 * weight, "{falls}: {weight} N");
    for more in [&["--fixed-root"][..], &["--support", "calcn_r,calcn_l"]] {
        let stands = verdict(more);
        assert_eq!((answer(more).code, &stands["kind"]), (0, &serde_json::json!("holds")), "{stands}");
    }
    assert!(!answer(&["--fixed-root"]).stderr.contains("nothing holds"));
}

#[test]
fn a_swing_is_no_posture() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "time,hip_flexion_r_deg\n".to_owned();
    for i in 0..100 {
        let time = 0.01 * f64::from(i);
        writeln!(text, "{time},{}", 40.0 * libm::sin(10.0 * time)).unwrap();
    }
    let swing = write(folder.path(), "swing.csv", &text);
    let message = run(&["assess", "adult", &swing, "--static"]).stderr;
    assert!(message.contains("warning: the centre of mass accelerates by more than 1 m/s2 in "), "{message}");
    let slow = write(folder.path(), "slow.csv", &text.replace("time,hip_flexion_r", "time,wrist_flex_r"));
    let message = run(&["assess", "adult", &slow]).stderr;
    assert!(!message.contains("accelerates"), "{message}");
}

#[test]
fn what_makes_no_sense_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n5,60\n");
    let late = write(
        folder.path(),
        "late.csv",
        "time,ground_force_vx,ground_force_vy,ground_force_vz,ground_force_px,ground_force_py,ground_force_pz\n\
         7,0,700,0,0,0,0\n8,0,700,0,0,0,0\n",
    );
    let days = write(folder.path(), "days.csv", "time,elbow_flex_r_deg\n0,90\n2e5,60\n");
    let robot = write(folder.path(), "leg.xml", &leg(1, "knee"));
    let bent = write(folder.path(), "bent.csv", "time,knee_deg\n0,20\n");
    let out = folder.path().join("out");
    let target = out.to_str().unwrap();
    for (arguments, part) in [
        (
            &["adult", "nowhere.mot"][..],
            "No such file or directory (os error 2)\n  MOTION is a .mot, .sto or .csv file",
        ),
        (&["adult", &late], "no column is a coordinate of the model `adult, male`"),
        (&["adult", &days], "the motion lasts 200000 s; 1e5 s at most"),
        (&["adult", &motion, "--grf", &late], "they have no time in common"),
        (&["adult", &motion, "--grf", &motion], "no column is named like `ground_force_vx`"),
        (
            &["adult", &motion, "--support", "calcn_rr"],
            "--support calcn_rr: the model has no segment `calcn_rr`; did you mean `calcn_r`?",
        ),
        (&["adult", &motion, "--support", "calcn_r,calcn_r"], "it is named twice"),
        (&["adult", &motion, "--support", "head"], "give corners in its frame (m): --patch \"head X,Y,Z X,Y,Z ...\""),
        (&["adult", &motion, "--support", "calcn_r", "--patch", "calcn_l 0,0,0"], "`calcn_l` is no support"),
        (&["adult", &motion, "--support", "calcn_r", "--patch", "calcn_r 0,0"], "holds 2 numbers; three are needed"),
        (&["adult", &motion, "--support", "calcn_r", "--patch", "calcn_r"], "the corners are missing"),
        (&["adult", &motion, "--patch", "calcn_r 0,0,0"], "--support <SEG,SEG>"),
        (&["adult", &motion, "--support", "calcn_r", "--grf", &late], "cannot be used with"),
        (&["adult", &motion, "--load", "hand_r 3"], "`3` is no mass in kg"),
        (&[&robot, &bent, "--passive", "file"], "no strength of this model is known"),
    ] {
        let arguments: Vec<&str> = ["assess"].iter().chain(arguments).copied().chain(["--out", target]).collect();
        let message = refused(&arguments);
        assert!(message.contains(part), "`{part}` is not in\n{message}");
        assert!(!out.exists(), "{arguments:?}");
    }
}

/// Two postures ten minutes apart: the moment of a failure between them is that of the fatigue law, not that of a posture, and the
/// page opens with joint, moment and load of its title.
#[test]
fn the_page_of_a_failure_between_two_postures_names_its_moment_and_opens_with_the_joint_of_the_title() {
    let folder = tempfile::tempdir().unwrap();
    let motion = write(folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n600,90\n");
    let out = folder.path().join("out");
    let load = ["--fixed-root", "--load", "hand_r 8kg", "--json", "--out", out.to_str().unwrap()];
    let found = json(&[&["assess", "adult", &motion][..], &load].concat());
    let first = &found["groups"][0];
    let fails = first["exhausted_at_s"].as_f64().unwrap();
    assert!(fails > 1.0 && fails < 550.0, "{fails}");
    let page = page(&out);
    let entries = page["list"]["entries"].as_array().unwrap();
    let entry = entries.iter().find(|entry| entry["text"].as_str().unwrap().contains(" fails")).unwrap();
    assert!((entry["time"].as_f64().unwrap() - fails).abs() <= 1e-3, "{entry}");
    let shown = &page["joints"][page["main"].as_u64().unwrap() as usize];
    assert_eq!(shown["name"], first["coordinate"]);
    let side = usize::from(first["side"] == "negative");
    assert!((shown["groups"][side]["fails"].as_f64().unwrap() - fails).abs() <= 1e-3);
    let open = page["open"].as_u64().unwrap() as usize;
    let peak = first["peak_load"]["value"].as_f64().unwrap();
    assert!((column(&shown["load"], 2)[open] - peak).abs() < 1e-4);
}

#[test]
fn the_page_of_a_motion_that_starts_late_opens_at_its_failure() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..13).map(|i| format!("{},90\n", 1000 + 50 * i)).collect();
    let motion = write(folder.path(), "late.csv", &format!("time,elbow_flex_r_deg\n{rows}"));
    let out = folder.path().join("out");
    let load = ["--fixed-root", "--load", "hand_r 8kg", "--json", "--out", out.to_str().unwrap()];
    let found = json(&[&["assess", "adult", &motion][..], &load].concat());
    let fails = found["groups"][0]["exhausted_at_s"].as_f64().unwrap();
    assert!(fails > 1050.0 && fails < 1550.0, "{fails}");
    let open = page(&out)["open"].as_u64().unwrap();
    assert!((1000.0 + 50.0 * open as f64 - fails).abs() <= 25.0, "frame {open}, failure at {fails} s");
}
