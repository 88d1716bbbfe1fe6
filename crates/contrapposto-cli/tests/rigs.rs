//! `track` of animations: runs and postures of ours come back from their BVH, `assess` takes the adult that was moved, mutated files.

use crate::support;

use std::collections::BTreeMap;
use std::path::Path;

use contrapposto_formats::motion::read_table;
use rand::RngExt;
use rand_pcg::Pcg64;
use support::{contrapposto, refused, run, write};

/// Rows and labels of a motion.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let table = read_table("motion.mot", &std::fs::read(path).unwrap()).unwrap();
    (table.columns, table.rows)
}

/// The file of an animation and the motion that it shows, by the program itself.
fn animated(folder: &Path, command: &str, scenario: &str, name: &str) -> (String, std::path::PathBuf) {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(scenario);
    let out = folder.join(name);
    let made = contrapposto([command, "--no-suggest"]).arg(scenario).arg("--out").arg(&out).run();
    assert!(made.code < 2, "{}", made.stderr);
    let file = |name: &str| out.join(name);
    let stem = if command == "simulate" { "motion" } else { "pose" };
    (file(&format!("{stem}.bvh")).to_str().unwrap().to_owned(), file(&format!("{stem}.mot")))
}

#[test]
fn runs_and_postures_of_ours_come_back_from_their_animations() {
    let folder = tempfile::tempdir().unwrap();
    for (command, scenario) in [
        ("simulate", "lift-box.toml"),
        ("simulate", "crouch.toml"),
        ("pose", "reach-floor.toml"),
        ("pose", "screw-overhead.toml"),
        ("pose", "lean-on-table.toml"),
    ] {
        let (animation, motion) = animated(folder.path(), command, scenario, &format!("{command}-{scenario}"));
        let out = folder.path().join("tracked");
        let answer = contrapposto(["track", "adult", &animation, "--out"]).arg(&out).run();
        assert_eq!(answer.code, 0, "{scenario}: {}", answer.stderr);
        assert!(answer.stdout.contains("within 0.00 deg in the root mean square"), "{scenario}: {}", answer.stdout);
        assert!(!answer.stderr.contains("warning"), "{scenario}: {}", answer.stderr);
        let ((names, wanted), (found_names, found)) = (table(&motion), table(&out.join("motion.mot")));
        assert_eq!(wanted.len(), found.len());
        let (mut worst, mut compared) = (0.0_f64, 0);
        for (wanted, found) in wanted.iter().zip(&found) {
            for (name, wanted) in names.iter().zip(wanted) {
                let Some(column) = found_names.iter().position(|found| found == name) else { continue };
                let off = (wanted - found[column]).abs();
                // Shoulders are found by the rhythm, which a pose whose steps ran out keeps to some millimetres: 1 cm.
                worst = worst.max(if name.starts_with("shoulder_rise") { 0.01 * off } else { off });
                compared += 1;
            }
        }
        println!("{scenario}: {} frames, angles and places within {worst:.1e} deg and m", found.len());
        assert!(worst < 1e-4, "{scenario}: {worst}");
        assert_eq!(compared, found_names.len() * found.len(), "{scenario}: {names:?} {found_names:?}");
    }
}

#[test]
fn assess_takes_the_adult_that_was_moved_and_answers_as_for_the_same_body() {
    let folder = tempfile::tempdir().unwrap();
    let (animation, motion) = animated(folder.path(), "simulate", "stand-ready.toml", "stand");
    let text = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let answer = run(&["track", "adult", &animation, "--out", &text("tracked"), "--verbose"]);
    assert!(answer.stdout.contains("next: contrapposto assess "), "{}", answer.stdout);
    for said in
        ["lengths are read in cm", "up is y of the file", "femur_l = femur_l", "the adult has the rig's femur 0.4"]
    {
        assert!(answer.stderr.contains(said), "{said}: {}", answer.stderr);
    }
    let more = ["--support", "calcn_l,calcn_r", "--no-report", "--no-suggest", "--json"];
    let by = |model: &str, motion: &str| {
        let run = run(&[&["assess", model, motion], &more[..]].concat());
        assert!(run.code < 2, "{}", run.stderr);
        let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        json["groups"]
            .as_array()
            .unwrap()
            .iter()
            .map(|group| {
                let name = format!("{} {}", group["coordinate"].as_str().unwrap(), group["side"].as_str().unwrap());
                (name, group["peak_load"]["value"].as_f64().unwrap())
            })
            .collect::<BTreeMap<_, _>>()
    };
    let tracked = by(&text("tracked/adult.toml"), &text("tracked/motion.mot"));
    let scenario = std::fs::read_to_string(folder.path().join("tracked/adult.toml")).unwrap();
    let size = scenario.split("stature_m = ").nth(1).unwrap().split(',').next().unwrap();
    let mass = scenario.split("mass_kg = ").nth(1).unwrap().split(',').next().unwrap();
    let own = by(&format!("adult:male,{size}m,{mass}kg"), motion.to_str().unwrap());
    assert!(tracked.len() > 10 && tracked.keys().eq(own.keys()), "{tracked:?}\n{own:?}");
    assert!(tracked.iter().all(|(name, load)| (load - own[name]).abs() < 1e-6), "{tracked:?}\n{own:?}");
    let inspected = run(&["inspect", &text("tracked/adult.toml")]);
    assert_eq!(inspected.code, 0, "{}", inspected.stderr);
    // A scenario that says more than a body is no MODEL.
    let job = write(folder.path(), "job.toml", &(scenario.clone() + "\n[floor]\n"));
    let answer = run(&["torques", &job, "default", "--verbose"]);
    assert!(
        answer.stderr.contains("job.toml: as MODEL it gives its body only; not used: [floor]"),
        "{}",
        answer.stderr
    );
    let more = write(folder.path(), "strong.toml", &(scenario + "\n[strength]\nspread = 1.2\n"));
    let said = refused(&["torques", &more, "default"]);
    assert!(said.contains("[strength] counts in runs of the scenario only"), "{said}");
}

#[test]
fn options_of_markers_and_of_rigs_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let (animation, _) = animated(folder.path(), "pose", "reach-floor.toml", "pose");
    let out = folder.path().join("out").to_str().unwrap().to_owned();
    let said = refused(&["track", "subject.osim", &animation, "--out", &out]);
    assert!(said.contains("an animation moves the built-in adult"), "{said}");
    let said = refused(&["track", "adult", &animation, "--from", "7", "--out", &out]);
    assert!(said.contains("no frame lies in the time that is asked for (from 7 s)"), "{said}");
    let said = refused(&["track", "adult", &animation, "--units", "m", "--out", &out]);
    assert!(said.contains("--units says their unit"), "{said}");
    let strange = std::fs::read_to_string(&animation).unwrap().replace("JOINT femur_r", "JOINT flipper");
    let strange = write(folder.path(), "strange.bvh", &strange);
    let said = refused(&["track", "adult", &strange, "--out", &out]);
    assert!(said.contains("known to be `femur_r`") && said.contains("femur_r = \"\"   # needed"), "{said}");
    let names = write(folder.path(), "names.toml", "femur_r = \"flipper\"\n");
    let answer = run(&["track", "adult", &strange, "--rig", &names, "--out", &out]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    let given = run(&["track", "adult:female,1.65m,60kg", &animation, "--out", &out]);
    assert_eq!(given.code, 0, "{}", given.stderr);
    let adult = std::fs::read_to_string(Path::new(&out).join("adult.toml")).unwrap();
    assert!(adult.contains("adult = { sex = \"female\", stature_m = 1.65, mass_kg = 60.0 }"), "{adult}");
    let said = refused(&["track", "adult:female,1.65m,60kg", &animation, "--units", "cm", "--out", &out]);
    assert!(said.contains("--units goes with MODEL `adult`"), "{said}");
    let blank = folder.path().join("two words").to_str().unwrap().to_owned();
    let answer = run(&["track", "adult", &animation, "--out", &blank]);
    assert!(answer.stdout.contains("two words/adult.toml\" \""), "{}", answer.stdout);
    let trc = write(folder.path(), "a.trc", "");
    let said = refused(&["track", "adult", &trc, "--rig", &names, "--out", &out]);
    assert!(said.contains("--rig names the joints of an animation"), "{said}");
}

#[test]
fn two_hundred_mutated_animations_get_an_answer_or_a_named_refusal() {
    const SEED: u64 = 29;
    println!("seed {SEED}");
    let folder = tempfile::tempdir().unwrap();
    let (animation, _) = animated(folder.path(), "pose", "reach-floor.toml", "pose");
    let plain = std::fs::read_to_string(animation).unwrap();
    let row = plain.lines().last().unwrap().to_owned() + "\n";
    let plain = plain.replace("Frames: 1", "Frames: 30") + &row.repeat(29);
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let (mut answered, mut refused) = (0, 0);
    for round in 0..200 {
        let mut bytes = plain.clone().into_bytes();
        for _ in 0..rng.random_range(1..3) {
            let at = rng.random_range(0..bytes.len());
            match rng.random_range(0..5) {
                0 | 1 => bytes[at] = b"1 9.e-0\n{}"[rng.random_range(0..10)],
                2 => drop(bytes.drain(at..(at + 20).min(bytes.len()))),
                3 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, b"1 9.e-0\n{}"[rng.random_range(0..10)]),
            }
        }
        let file = folder.path().join("mutated.bvh");
        std::fs::write(&file, bytes).unwrap();
        let out = folder.path().join("mutated");
        let run = contrapposto(["track", "adult"]).arg(&file).arg("--out").arg(&out).run();
        assert!(run.seconds < 20.0, "round {round}: {} s", run.seconds);
        match run.code {
            0 => {
                answered += 1;
                let text = std::fs::read_to_string(out.join("motion.mot")).unwrap();
                assert!(!text.contains("NaN") && !text.contains("inf"), "round {round}");
            }
            2 => {
                refused += 1;
                assert!(run.stderr.contains("mutated.bvh"), "round {round}: {}", run.stderr);
            }
            code => panic!("round {round}: code {code}: {}", run.stderr),
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered > 20 && refused > 20, "{answered}, {refused}");
}
