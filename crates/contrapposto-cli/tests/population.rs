//! `contrapposto population`: all can hold what weighs nothing and nobody what is absurd, the same bytes for any number of threads and after
//! an interruption, numbers that follow from the table, and refusals that write nothing.

use crate::support;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use contrapposto_sweep::wilson;
use serde_json::Value;
use support::{contrapposto, scenarios};

/// A weight in the hand of an arm, held until the shoulder fails.
const JOB: &str = "format = 1\ntitle = \"Held out\"\n\
    [model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75, part = \"right_arm\" }\n\
    [posture]\narm_flex_r_deg = 60\nelbow_flex_r_deg = 20\n[coordinates]\nfree = [\"elbow_flex_r\"]\n\
    [[load]]\nsegment = \"hand_r\"\nmass_kg = 1\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 120\n";

fn job(folder: &Path, from: &str, to: &str) -> PathBuf {
    assert!(JOB.contains(from));
    let path = folder.join("job.toml");
    std::fs::write(&path, JOB.replace(from, to)).unwrap();
    path
}

fn population(job: &Path, more: &[&str]) -> (i32, String, String) {
    let run = contrapposto(["population"]).arg(job).args(more.iter()).run();
    (run.code, run.stdout.replace('\u{a0}', " "), run.stderr)
}

fn json(job: &Path, more: &[&str]) -> Value {
    let (code, out, notes) = population(job, &[&["--json"], more].concat());
    assert_eq!(code, 0, "{notes}");
    serde_json::from_str(&out).unwrap()
}

/// All files below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let inner = files(&path);
            all.extend(inner.into_iter().map(|(name, bytes)| (Path::new(path.file_name().unwrap()).join(name), bytes)));
        } else {
            all.insert(PathBuf::from(path.file_name().unwrap()), std::fs::read(&path).unwrap());
        }
    }
    all
}

/// A foot on a step that is high enough for one tall man only: everybody else's foot hangs 5 cm or more below it.
const TALL_STEP: &str = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.95, mass_kg = 90 }\n\
    [posture]\nhip_flexion_r_deg = 55\nknee_angle_r_deg = 60\nankle_angle_r_deg = 5\n\
    [[support]]\nsegment = \"calcn_r\"\nstep_m = 0.25\n[[support]]\nsegment = \"calcn_l\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";

#[test]
fn a_job_of_which_no_body_can_be_judged_fails_with_the_reason_and_writes_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    let (job, out) = (folder.path().join("job.toml"), folder.path().join("out"));
    std::fs::write(&job, TALL_STEP).unwrap();
    let (code, said, notes) = population(&job, &["--rows", "2", "--out", out.to_str().unwrap()]);
    assert_eq!((code, said.as_str()), (1, ""), "{notes}");
    assert!(notes.contains("none of the 2 bodies could be judged; the first: "), "{notes}");
    assert!(notes.contains("step"), "{notes}");
    assert!(!out.join("population.json").exists() && !out.join("population.html").exists());
}

#[test]
fn all_can_hold_a_hanging_arm_and_nobody_can_hold_a_ton() {
    let folder = tempfile::tempdir().unwrap();
    let hanging = job(folder.path(), "arm_flex_r_deg = 60", "arm_flex_r_deg = 0");
    let text = std::fs::read_to_string(&hanging).unwrap().replace("mass_kg = 1\n", "mass_kg = 0.01\n");
    std::fs::write(&hanging, text).unwrap();
    let (code, out, _) = population(&hanging, &["--rows", "40"]);
    let first = "100 % of 20 women (95 % interval 84 % to 100 %) and 100 % of 20 men (84 % to 100 %) can hold it for the 2.0 min asked.";
    assert_eq!((code, out.lines().next().unwrap()), (0, first));
    assert!(!out.contains("Fails first"), "{out}");
    let ton = job(folder.path(), "mass_kg = 1\n", "mass_kg = 1000\n");
    let (code, out, _) = population(&ton, &["--rows", "40"]);
    let first = "0 % of 20 women (95 % interval 0 % to 16 %) and 0 % of 20 men (0 % to 16 %) can hold it for the 2.0 min asked.";
    assert_eq!((code, out.lines().next().unwrap()), (0, first));
    let found = json(&ton, &["--rows", "4"]);
    for people in [&found["women"], &found["men"]] {
        assert_eq!(
            (&people["share"], &people["not_done"], &people["minutes"]["p95"]),
            (&0.0.into(), &2.into(), &0.0.into())
        );
    }
}

#[test]
fn one_thread_two_threads_and_a_resumption_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let job = job(folder.path(), "", "");
    let out = |name: &str| folder.path().join(name);
    let run = |name: &str, more: &[&str]| {
        let out = out(name);
        let (code, text, notes) =
            population(&job, &[&["--rows", "42", "--seed", "7", "--out", out.to_str().unwrap()], more].concat());
        assert_eq!(code, 0, "{notes}");
        (text, files(&out))
    };
    let (text, one) = run("one", &["--threads", "1"]);
    assert!(text.contains("Fails first: of women who cannot"), "{text}");
    assert_eq!(one.len(), 11 + 4, "eleven parts, the results and their manifest");
    assert!(one == run("two", &["--threads", "2"]).1);
    // The page has the answer and three pictures, and no script.
    let page = String::from_utf8(one[Path::new("population.html")].clone()).unwrap().replace('\u{a0}', " ");
    let first = text.lines().next().unwrap();
    assert!(page.contains(&format!("<h1>{first}</h1>")), "{first}");
    assert!(page.matches("<svg").count() == 3 && !page.contains("<script") && page.contains("default-src 'none'"));
    assert!(page.contains(">right shoulder flexion<") && page.contains(">strength<") && page.contains("ANSUR II"));
    // Two parts are lost.
    let rows = out("two").join("rows");
    let names: Vec<PathBuf> = std::fs::read_dir(&rows).unwrap().map(|entry| entry.unwrap().path()).collect();
    names[..2].iter().for_each(|path| std::fs::remove_file(path).unwrap());
    assert!(one == run("two", &["--resume"]).1);
    let (code, _, notes) = population(&job, &["--out", out("two").to_str().unwrap()]);
    assert!(code == 2 && notes.contains("--resume keeps them and computes those that are missing"), "{notes}");
}

#[test]
fn a_resumption_with_other_numbers_of_bodies_removes_none_and_one_with_other_bodies_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = job(folder.path(), "", "");
    let out = folder.path().join("out");
    let run = |out: &Path, more: &[&str]| population(&path, &[&["--out", out.to_str().unwrap()], more].concat());
    let rows = || files(&out.join("rows"));
    assert_eq!(run(&out, &["--rows", "42"]).0, 0);
    let first = rows();
    // Fewer bodies, and more of them: no part is lost, and the results are those of a folder of their own.
    for (bodies, parts) in [("20", 11), ("18", 12), ("50", 15), ("42", 15)] {
        let (code, _, notes) = run(&out, &["--rows", bodies, "--resume"]);
        assert_eq!((code, rows().len()), (0, parts), "{bodies}: {notes}");
        assert!(first.iter().all(|(name, bytes)| rows().get(name) == Some(bytes)), "{bodies}");
        let fresh = folder.path().join(bodies);
        assert_eq!(run(&fresh, &["--rows", bodies]).0, 0);
        for name in ["population.csv", "population.html", "population.json"] {
            assert!(files(&out)[Path::new(name)] == files(&fresh)[Path::new(name)], "{bodies} {name}");
        }
    }
    let all = files(&out);
    let words = "rows: holds bodies of another scenario, seed or version";
    let (code, _, notes) = run(&out, &["--rows", "20", "--resume", "--seed", "3"]);
    assert!(code == 2 && notes.contains(words) && notes.contains("name another folder"), "{notes}");
    job(folder.path(), "mass_kg = 1\n", "mass_kg = 1.5\n");
    let (code, _, notes) = run(&out, &["--rows", "60", "--resume"]);
    assert!(code == 2 && notes.contains(words), "{notes}");
    assert!(files(&out) == all, "nothing was changed");
}

#[test]
fn a_part_that_was_cut_off_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = job(folder.path(), "", "");
    let out = folder.path().join("out");
    let more = ["--rows", "8", "--out", out.to_str().unwrap()];
    assert_eq!(population(&path, &more).0, 0);
    let (name, bytes) = files(&out.join("rows")).pop_last().unwrap();
    std::fs::write(out.join("rows").join(&name), &bytes[..bytes.len() - 1]).unwrap();
    let (code, _, notes) = population(&path, &[&more[..], &["--resume"]].concat());
    assert!(
        code == 1 && notes.contains(name.to_str().unwrap()) && notes.contains("rows 4 to 7 are expected"),
        "{notes}"
    );
    std::fs::remove_file(out.join("rows").join(&name)).unwrap();
    assert_eq!(population(&path, &[&more[..], &["--resume"]].concat()).0, 0);
    assert_eq!(files(&out.join("rows"))[&name], bytes);
}

#[test]
fn a_wrong_scenario_is_quoted_as_its_author_wrote_it() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = job(folder.path(), "part = \"right_arm\"", "part = \"third_arm\"");
    let (code, _, notes) = population(&wrong, &["--rows", "4"]);
    assert!(code == 2 && notes.contains("stature_m = 1.75, mass_kg = 75") && notes.contains("third_arm"), "{notes}");
    // A value that every body replaces is judged, too.
    let tall = job(folder.path(), "stature_m = 1.75", "stature_m = 17.5");
    let (code, _, notes) = population(&tall, &["--rows", "4"]);
    assert!(code == 2 && notes.contains("17.5"), "{notes}");
}

#[test]
fn the_numbers_follow_from_the_table_and_another_seed_gives_other_people() {
    let folder = tempfile::tempdir().unwrap();
    let job = job(folder.path(), "", "");
    let out = folder.path().join("out");
    let found = json(&job, &["--rows", "60", "--out", out.to_str().unwrap()]);
    let table = String::from_utf8(files(&out)[Path::new("population.csv")].clone()).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let rows: Vec<BTreeMap<&str, &str>> = lines.map(|line| header.iter().copied().zip(line).collect()).collect();
    assert_eq!(
        rows.iter().map(|row| row["row"].parse::<usize>().unwrap()).collect::<Vec<_>>(),
        (0..60).collect::<Vec<_>>()
    );
    for (name, sex) in [("women", "female"), ("men", "male")] {
        let of_sex: Vec<_> = rows.iter().filter(|row| row["model.adult.sex"] == sex).collect();
        assert_eq!(of_sex.len(), 30);
        let can = of_sex.iter().filter(|row| row["kind"] == "holds").count();
        let people = &found[name];
        assert!(0 < can + usize::from(sex == "female") && can < 30, "the job should separate people: {can} {name}");
        assert_eq!(people["can_hold"], can);
        let interval: Vec<f64> =
            people["interval_95"].as_array().unwrap().iter().map(|end| end.as_f64().unwrap()).collect();
        assert_eq!(interval, wilson(can, 30));
        let mut minutes: Vec<f64> = of_sex
            .iter()
            .map(|row| match row["kind"] {
                "cannot_be_done" => 0.0,
                _ => row["minutes"].parse().unwrap_or(f64::INFINITY),
            })
            .collect();
        minutes.sort_by(f64::total_cmp);
        // Of 30: the second, the 15th and the 29th.
        for (quantile, place) in [("p5", 1), ("p50", 14), ("p95", 28)] {
            let expected = Some(minutes[place]).filter(|minutes| minutes.is_finite());
            assert_eq!(people["minutes"][quantile].as_f64(), expected, "{name} {quantile}");
        }
        let fails: u64 =
            people["fails_first"].as_array().unwrap().iter().map(|fails| fails["bodies"].as_u64().unwrap()).sum();
        assert_eq!(fails as usize, 30 - can);
    }
    let sensitivity = &found["sensitivity"];
    let first: Vec<&str> =
        (0..2).map(|place| sensitivity["parameters"][place]["parameter"].as_str().unwrap()).collect();
    assert!(first.contains(&"sex") && first.contains(&"strength"), "{sensitivity}");
    let other = json(&job, &["--rows", "60", "--seed", "1"]);
    assert_ne!(other["women"]["minutes"], found["women"]["minutes"]);
}

#[test]
fn a_body_is_the_one_that_simulate_takes() {
    let folder = tempfile::tempdir().unwrap();
    let path = job(folder.path(), "", "");
    let out = folder.path().join("out");
    json(&path, &["--rows", "4", "--out", out.to_str().unwrap()]);
    let table = String::from_utf8(files(&out)[Path::new("population.csv")].clone()).unwrap();
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [stature, mass, deviations, spread, sex, kind, minutes] = cells[1..8].try_into().unwrap();
        let text = JOB.replace("stature_m = 1.75, mass_kg = 75", &format!("stature_m = {stature}, mass_kg = {mass}"));
        let text = text.replace("sex = \"male\"", &format!("sex = \"{sex}\""))
            + &format!("[strength]\ndeviations = {deviations}\n[passive]\nspread = {spread}\n");
        std::fs::write(&path, text).unwrap();
        let run = contrapposto(["simulate"]).arg(&path).args(["--no-report", "--json", "--no-suggest"]).run();
        let verdict = &serde_json::from_str::<Value>(&run.stdout).unwrap()["verdict"];
        assert_eq!(verdict["kind"], kind);
        assert_eq!(verdict["minutes"].as_f64(), minutes.parse().ok(), "{line}");
    }
}

#[test]
fn refused_inputs_are_named_with_what_is_accepted_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let good = job(folder.path(), "", "");
    let model = scenarios().join("stand-osim.toml");
    let pose = scenarios().join("poses/reach-shelf.toml");
    let out = folder.path().join("out");
    for (path, more, words) in [
        (
            &model,
            ["--rows", "4"],
            "names the model file \"models/adult-female.osim\"; a population takes scenarios of the built-in adult",
        ),
        (&pose, ["--rows", "4"], "the key `strategy` is missing"),
        (&good, ["--rows", "5"], "an even number from 2 to 100000 is accepted"),
        (&good, ["--rows", "0"], "an even number from 2 to 100000 is accepted"),
        (&good, ["--rows", "100002"], "an even number from 2 to 100000 is accepted"),
        (&good, ["--seed", "2147483648"], "2147483648 is not in 0..=2147483647"),
        (&good, ["--threads", "0"], "'--threads <N>'"),
    ] {
        let (code, _, notes) = population(path, &[&more[..], &["--out", out.to_str().unwrap()]].concat());
        assert_eq!(code, 2, "{more:?}: {notes}");
        let said = notes.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(words), "{more:?}: {notes}");
        assert!(!out.exists(), "{more:?}");
    }
    let (code, _, notes) = population(&good, &["--rows", "4", "--resume"]);
    assert!(code == 2 && notes.contains("--out <DIR>"), "{notes}");
}
