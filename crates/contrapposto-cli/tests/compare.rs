//! `contrapposto compare` and `--figures`: they say the same as the other commands, and name which file is wrong.

use crate::support;

use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{ARM, Run, contents, contrapposto, results, scenarios};

fn shelf() -> PathBuf {
    scenarios().join("poses/reach-shelf.toml")
}

fn compare(files: &[&Path], out: &Path, more: &[&str]) -> Run {
    contrapposto(["compare"]).args(files).arg("--out").arg(out).args(more).run()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// A scenario of the repository, over ten seconds only.
fn short(name: &str, folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(scenarios().join(name)).unwrap();
    let (head, _) = text.split_once("duration_s").unwrap();
    let path = folder.join(name);
    std::fs::write(&path, format!("{head}duration_s = 10\n")).unwrap();
    path
}

#[test]
fn what_is_compared_is_what_simulate_and_pose_find() {
    let folder = tempfile::tempdir().unwrap();
    let relaxed = short("stand-relaxed.toml", folder.path());
    let out = folder.path().join("out");
    let run = compare(&[&relaxed, &shelf()], &out, &["--json"]);
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    let written = results(&out);
    let names: Vec<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["compare.json", "compare.png", "compare.svg", "report.html"]);
    assert_eq!(run.stdout.as_bytes(), written[0].1);
    let found = json(&run.stdout);
    let call = contrapposto(["simulate", "--json"]).arg(&relaxed).arg("--out").arg(folder.path().join("simulated"));
    let simulated = json(&call.run().stdout);
    let call = contrapposto(["pose", "--json"]).arg(shelf()).arg("--out").arg(folder.path().join("posed"));
    let posed = json(&call.run().stdout);
    let [a, b] = [&found["postures"][0], &found["postures"][1]];
    assert_eq!((a["how"].as_str(), b["how"].as_str()), (Some("simulated, 10\u{a0}s"), Some("posed")));
    assert_eq!(a["effort"], simulated["standing"]["effort"]);
    assert_eq!(b["coordinates"], posed["coordinates"]);
    // Both feet carry the weight, and nothing else.
    for posture in [a, b] {
        let shares = posture["supports"].as_array().unwrap().iter().map(|s| s["share"].as_f64().unwrap());
        assert!((shares.sum::<f64>() - 1.0).abs() < 1e-9);
    }
    // What the lists say of differences is what they say of numbers.
    for group in found["groups"].as_array().unwrap() {
        let spread = |key: &str| {
            let [a, b] = [0, 1].map(|i| group[key][i].as_f64().unwrap());
            (a - b).abs()
        };
        let difference = group["difference"].as_f64().unwrap();
        assert!((spread("relative_load").max(spread("on_ligaments")) - difference).abs() < 1e-12);
    }
    for coordinate in found["coordinates"].as_array().unwrap() {
        let name = coordinate["coordinate"].as_str().unwrap();
        assert_eq!(coordinate["value"][0], a["coordinates"][name]);
        assert_eq!(coordinate["value"][1], b["coordinates"][name]);
    }
    let differences: Vec<f64> =
        found["groups"].as_array().unwrap().iter().map(|g| g["difference"].as_f64().unwrap()).collect();
    assert!(differences.len() > 40 && differences.is_sorted_by(|a, b| a >= b));
}

#[test]
fn loads_of_a_pose_agree_with_the_torques_of_assess() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&compare(&[&shelf(), &shelf()], folder.path(), &["--json"]).stdout);
    assert!(found["groups"].as_array().unwrap().iter().all(|group| group["difference"] == 0.0));
    let out = folder.path().join("posed");
    assert_eq!(contrapposto(["pose"]).arg(shelf()).arg("--out").arg(&out).run().code, 0);
    let call = contrapposto(["assess", "adult:female,1.65m,60kg"]).arg(out.join("pose.mot"));
    // The angles of a posture that the program has found are exact.
    let assessed = json(&call.args(["--support", "calcn_r,calcn_l", "--angle-error", "0", "--json"]).run().stdout);
    let mut effort = 0.0;
    for group in assessed["groups"].as_array().unwrap() {
        let load = group["peak_load"]["value"].as_f64().unwrap();
        let same = |g: &&Value| g["coordinate"] == group["coordinate"] && g["side"] == group["side"];
        let ours = found["groups"].as_array().unwrap().iter().find(same).unwrap();
        assert!((ours["relative_load"][0].as_f64().unwrap() - load).abs() < 1e-6, "{group} {ours}");
        effort += load * load;
    }
    assert!((found["postures"][0]["effort"].as_f64().unwrap() - effort).abs() < 1e-6);
}

#[test]
fn the_tables_name_what_differs_and_bodies_may_differ() {
    let folder = tempfile::tempdir().unwrap();
    let (ready, relaxed) = (short("stand-ready.toml", folder.path()), short("stand-relaxed.toml", folder.path()));
    let run = compare(&[&ready, &relaxed], folder.path(), &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for words in
        ["A: Standing ready", "weight on right foot", "right hip abduction", "left hip adduction", "compare.svg"]
    {
        assert!(run.stdout.contains(words), "{words}\n{}", run.stdout);
    }
    assert!(!run.stdout.contains("not compared"));
    let loaded = std::fs::read_to_string(&ready).unwrap() + "\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 15\n";
    let heavy = folder.path().join("heavy.toml");
    std::fs::write(&heavy, loaded).unwrap();
    let run = compare(&[&heavy, &ready], folder.path(), &[]);
    let on_feet = run.stdout.lines().filter(|line| line.trim_start().starts_with("weight on"));
    let of_heavy = on_feet.map(|line| {
        let before = line.split('%').next().unwrap();
        before.split_whitespace().last().unwrap().parse::<f64>().unwrap()
    });
    let (feet, all) = of_heavy.fold((0, 0.0), |(feet, all), share| (feet + 1, all + share));
    assert!(feet == 2 && (all - 100.0).abs() < 0.11, "{feet} feet carry {all} % of body and loads\n{}", run.stdout);
    let arm = folder.path().join("arm.toml");
    std::fs::write(&arm, ARM).unwrap();
    let found = json(&compare(&[&shelf(), &arm], folder.path(), &["--json"]).stdout);
    let missing = found["not_in_all"].as_array().unwrap();
    let compared = found["coordinates"].as_array().unwrap();
    assert!(!missing.is_empty() && !compared.is_empty());
    for name in missing {
        let known = |i: usize| found["postures"][i]["coordinates"].get(name.as_str().unwrap()).is_some();
        assert!(known(0) != known(1), "{name}");
    }
}

#[test]
fn wrong_files_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let out = folder.path().join("out");
    let missing = folder.path().join("missing.toml");
    let cases = [
        (missing, "missing.toml"),
        (wrong("empty.toml", ""), "empty.toml"),
        (wrong("list.toml", "[1, 2"), "list.toml"),
        (wrong("nothing.toml", "format = 1\n"), "asks for nothing"),
        (wrong("no-strategy.toml", "format = 1\n[run]\nduration_s = 1\n"), "`strategy` is missing"),
        (wrong("future.toml", "format = 2\n"), "this program reads format 1"),
        (folder.path().to_owned(), "not a regular file"),
    ];
    for (path, words) in cases {
        for files in [[shelf().as_path(), path.as_path()], [path.as_path(), shelf().as_path()]] {
            let run = compare(&files, &out, &[]);
            assert_eq!(run.code, 2, "{words}: {}", run.stderr);
            assert!(run.stderr.contains(words), "{words}: {}", run.stderr);
            assert!(!out.exists(), "{words}");
        }
    }
    let run = compare(&[&shelf()], &out, &[]);
    assert!(run.code == 2 && run.stderr.contains("2 values required"), "{}", run.stderr);
    let run = compare(&[Path::new("-"), Path::new("-")], &out, &[]);
    assert!(run.code == 2 && run.stderr.contains("one scenario only"), "{}", run.stderr);
}

#[test]
fn a_pose_that_its_feet_cannot_hold_has_no_loads() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(shelf()).unwrap();
    // Nothing asks for balance, and a force to the side is larger than what friction under any posture could hold.
    let falling = text.replace(
        "kind = \"center_of_mass\"\nmargin_m = 0.01",
        "kind = \"orientation\"\nsegment = \"calcn_r\"\ntarget = \"start\"",
    );
    let falling = falling.replace("[0.45, 1.55, 0.25]", "[0.1, 0.9, 1.3]")
        + "\n[[load]]\nsegment = \"hand_r\"\nforce_n = [0, 0, 3000]\nfixed_in = \"world\"\n";
    let path = folder.path().join("falling.toml");
    std::fs::write(&path, falling).unwrap();
    let run = compare(&[&path, &shelf()], folder.path(), &["--json"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let found = json(&run.stdout);
    // Nothing but its root being held keeps the body there, and that by more than its strength.
    assert_eq!(found["postures"][0]["verdict"]["kind"], "cannot_be_done");
    assert!(found["sentence"].as_str().unwrap().ends_with("; A cannot be done."), "{}", found["sentence"]);
    assert!(found["postures"][0]["effort"].is_null() && found["postures"][1]["effort"].is_f64());
    for group in found["groups"].as_array().unwrap() {
        assert!(group["relative_load"][0].is_null() && group["relative_load"][1].is_f64());
    }
    let svg = std::fs::read_to_string(folder.path().join("compare.svg")).unwrap();
    assert!(svg.contains("supports cannot hold it") && svg.contains("load not known"));
}

#[test]
fn figures_are_whole_named_and_the_same_twice() {
    let folder = tempfile::tempdir().unwrap();
    let relaxed = short("stand-relaxed.toml", folder.path());
    let draw = |scenario: &Path, name: &str| {
        let out = folder.path().join(name);
        let run = contrapposto(["simulate", "--figures", "--json"]).arg(scenario).arg("--out").arg(&out).run();
        assert_eq!(run.code, 0, "{}", run.stderr);
        let files: Vec<String> =
            json(&run.stdout)["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap().to_owned()).collect();
        let figures = contents(&out.join("figures"));
        let listed: Vec<&str> = files.iter().filter_map(|file| file.strip_prefix("figures/")).collect();
        assert_eq!(listed.len(), figures.len());
        for (name, bytes) in &figures {
            assert!(listed.contains(&name.as_str()), "{name}");
            assert!(bytes.starts_with(if name.ends_with(".png") { b"\x89PNG" } else { b"<svg" }), "{name}");
        }
        figures
    };
    let figures = draw(&relaxed, "a");
    assert!(figures == draw(&relaxed, "b"));
    // The body, and of the four joints that work or move their torques and their course; the joint of the story first.
    assert_eq!(figures.len(), 2 * (1 + 4 + 4));
    for name in ["body.svg", "torque-balance-1-hip_adduction_r.svg", "time-line-1-hip_adduction_r.png"] {
        assert!(figures.iter().any(|(found, _)| found == name), "{name}");
    }
    let body = String::from_utf8(figures.iter().find(|(name, _)| name == "body.svg").unwrap().1.clone()).unwrap();
    for words in ["from the front", "from the right", "three-quarter view", "start", "end, 10 s", "of strength"] {
        assert!(body.contains(words), "{words}");
    }
    // An elbow on its own has an external torque over its whole range, and no ground.
    let figures = draw(&scenarios().join("figure-08.toml"), "c");
    let svg =
        |name: &str| String::from_utf8(figures.iter().find(|(found, _)| found == name).unwrap().1.clone()).unwrap();
    assert!(svg("torque-balance-1-elbow_flex_r.svg").contains("external"));
    assert!(!svg("body.svg").contains("contact force"));
}

#[test]
fn a_motion_that_is_assessed_has_figures_too() {
    let folder = tempfile::tempdir().unwrap();
    let relaxed = short("stand-relaxed.toml", folder.path());
    let run = folder.path().join("run");
    assert_eq!(contrapposto(["simulate"]).arg(&relaxed).arg("--out").arg(&run).run().code, 0);
    let assess = |motion: &Path, more: &[&str]| {
        let call = contrapposto(["assess", "adult:female,1.65m,60kg"]).arg(motion);
        call.args(["--support", "calcn_r,calcn_l", "--json"]).args(more).run()
    };
    let out = folder.path().join("out");
    let assessed = assess(&run.join("motion.mot"), &["--figures", "--out", out.to_str().unwrap()]);
    let found = json(&assessed.stdout);
    let files: Vec<&str> = found["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    let drawn = contents(&out.join("figures"));
    assert_eq!(files.iter().filter(|file| file.starts_with("figures/")).count(), drawn.len());
    assert!(drawn.iter().all(|(name, _)| files.contains(&format!("figures/{name}").as_str())));
    // The joints that fail first have charts, in this order.
    let mut worst: Vec<&str> = vec![];
    for group in found["groups"].as_array().unwrap() {
        let name = group["coordinate"].as_str().unwrap();
        if !worst.contains(&name) && worst.len() < 5 {
            worst.push(name);
        }
    }
    for (i, name) in worst.iter().enumerate() {
        for chart in ["time-line", "torque-balance"] {
            let file = format!("{chart}-{}-{name}.svg", i + 1);
            assert!(drawn.iter().any(|(found, _)| *found == file), "{file}");
        }
    }
    let svg = |name: &str| String::from_utf8(drawn.iter().find(|(found, _)| found == name).unwrap().1.clone()).unwrap();
    assert!(svg("body.svg").contains("end, 10 s") && svg("body.svg").contains("contact force"));
    // Who does not move is drawn once.
    let still = folder.path().join("still.csv");
    std::fs::write(&still, "time,elbow_flex_r_deg\n0,20\n5,20\n").unwrap();
    let out = folder.path().join("still");
    let run = assess(&still, &["--figures", "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let body = std::fs::read_to_string(out.join("figures/body.svg")).unwrap();
    assert!(body.contains("throughout, 5.0 s") && !body.contains(">end, "));
    let refused = assess(&still, &["--figures"]);
    assert!(refused.code == 2 && refused.stderr.contains("--out"), "{}", refused.stderr);
}

#[test]
fn page_and_figures_have_the_same_colours() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../contrapposto-report/page/data.js");
    let page = std::fs::read_to_string(page).unwrap();
    let bands = page.split("LOAD_BANDS = ").nth(1).unwrap().split(';').next().unwrap();
    let bands: Vec<(f64, String, String)> = serde_json::from_str(bands).unwrap();
    assert_eq!(bands.len(), 5);
    let drawn = |load: f64| {
        let part = contrapposto_plot::BodyPart { balls: vec![[0.0, 0.0, 0.0, 1.0]], load: Some(load), hazard: false };
        let posture = contrapposto_plot::BodyPosture { parts: vec![part], ..Default::default() };
        let picture = contrapposto_plot::BodyFigure { postures: vec![posture], ..Default::default() };
        contrapposto_plot::body_figure(&picture).svg()
    };
    for (k, (from, low, high)) in bands.iter().enumerate() {
        let to = bands.get(k + 1).map_or(2.0, |(to, ..)| *to);
        for (load, colour) in [(*from, low), (to - 1e-7, high)] {
            assert!(drawn(load).lines().any(|l| l.contains('C') && l.contains(colour.as_str())), "{load} {colour}");
        }
    }
}
