//! `track`: measured markers in, a motion that `assess` reads out; warnings by name; mutated files.

use crate::support;

use std::fmt::Write as _;
use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto::posture::Posture;
use contrapposto_formats::motion::{Units, postures, read_table};
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;
use support::{contrapposto, refused, run, write};

/// Our own woman, with three markers on each of some segments: `R.thigh1`, `L.thigh1`, `pelvis1`, ...
fn marked_woman() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let text = std::fs::read_to_string(path).unwrap();
    let mut markers = String::new();
    let mut add = |name: &str, segment: &str, [x, y, z]: [f64; 3]| {
        let _ = write!(
            markers,
            "<Marker name=\"{name}\"><socket_parent_frame>/bodyset/{segment}</socket_parent_frame><location>{x} {y} {z}</location></Marker>"
        );
    };
    let places = [[0.09, 0.02, 0.03], [-0.07, -0.06, 0.05], [0.02, -0.11, 0.08]];
    for (i, [x, y, z]) in places.into_iter().enumerate() {
        add(&format!("pelvis{i}"), "pelvis", [x, y, z]);
        add(&format!("torso{i}"), "torso", [x, y + 0.2, z]);
        for segment in ["femur", "tibia", "calcn", "humerus", "hand"] {
            add(&format!("R.{segment}{i}"), &format!("{segment}_r"), [x, y, z]);
            add(&format!("L.{segment}{i}"), &format!("{segment}_l"), [x, y, -z]);
        }
    }
    let set = format!("<MarkerSet name=\"m\"><objects>{markers}</objects></MarkerSet>");
    assert!(!text.contains("<MarkerSet"));
    let end = text.rfind("</Model>").unwrap();
    format!("{}{set}{}", &text[..end], &text[end..])
}

/// A walk in place: postures over time.
fn walk(read: &SourcedModel) -> Vec<Posture> {
    let model = &read.model;
    let at = |name: &str| model.coordinate(name).unwrap();
    let frame = |i: usize| {
        let mut posture = model.default_posture();
        let phase = i as f64 * 0.15;
        let values = posture.values_mut();
        values[at("hip_flexion_r")] = 0.3 + 0.4 * libm::sin(phase);
        values[at("hip_flexion_l")] = 0.3 - 0.4 * libm::sin(phase);
        values[at("knee_angle_r")] = 0.6 + 0.5 * libm::cos(phase);
        values[at("knee_angle_l")] = 0.6 - 0.5 * libm::cos(phase);
        values[at("elbow_flex_r")] = 0.7 + 0.2 * libm::sin(phase);
        values[at("pelvis_tilt")] = 0.05 * libm::cos(phase);
        values[at("pelvis_tx")] = 0.02 * i as f64;
        posture
    };
    (0..12).map(frame).collect()
}

/// The text of a `.trc` file in mm of these postures, names changed by `rename`.
fn trc(read: &SourcedModel, postures: &[Posture], rename: impl Fn(&str) -> String) -> String {
    let count = read.markers.len();
    let frames = postures.len();
    let mut text = format!(
        "PathFileType\t4\t(X/Y/Z)\twalk.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n60\t60\t{frames}\t{count}\tmm\nFrame#\tTime"
    );
    read.markers.iter().for_each(|marker| write!(text, "\t{}\t\t", rename(&marker.name)).unwrap());
    text.push_str("\n\t");
    (1..=count).for_each(|i| write!(text, "\tX{i}\tY{i}\tZ{i}").unwrap());
    let mut body = Kinematics::new(&read.model);
    for (i, posture) in postures.iter().enumerate() {
        body.update(&read.model, posture).unwrap();
        let _ = write!(text, "\n{}\t{:.3}", i + 1, i as f64 / 60.0);
        for marker in &read.markers {
            let p: Vector3<f64> = 1e3 * body.station(&read.model, marker.segment, marker.point);
            let _ = write!(text, "\t{:.6}\t{:.6}\t{:.6}", p.x, p.y, p.z);
        }
    }
    text + "\n"
}

/// The places (x, y, z) of a file as (x, -z, y).
fn z_up(text: &str) -> String {
    let turned = |(i, line): (usize, &str)| {
        let cells: Vec<&str> = line.split('\t').collect();
        if i < 5 {
            return line.to_owned() + "\n";
        }
        let places =
            cells[2..].chunks_exact(3).map(|p| format!("\t{}\t{}\t{}", p[0], -p[2].parse::<f64>().unwrap(), p[1]));
        format!("{}\t{}{}\n", cells[0], cells[1], places.collect::<String>())
    };
    text.lines().enumerate().map(turned).collect()
}

struct Bench {
    folder: tempfile::TempDir,
    read: SourcedModel,
    model: String,
    walk: Vec<Posture>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let text = marked_woman();
        let read = SourcedModel::read("w.osim", text.as_bytes(), None, &mut |_| Err(String::new())).unwrap();
        let model = write(folder.path(), "woman.osim", &text);
        let walk = walk(&read);
        Self { folder, read, model, walk }
    }

    fn out(&self) -> String {
        self.folder.path().join("out").to_str().unwrap().to_owned()
    }

    fn track(&self, text: &str, more: &[&str]) -> support::Run {
        let file = write(self.folder.path(), "walk.trc", text);
        let out = self.out();
        let arguments = [&["track", &self.model, &file, "--out", &out], more].concat();
        run(&arguments)
    }
}

#[test]
fn a_walk_comes_back_from_its_markers_and_assess_reads_it() {
    let bench = Bench::new();
    let model = &bench.read.model;
    let text = trc(&bench.read, &bench.walk, str::to_owned);
    let answer = bench.track(&text, &[]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    assert!(
        answer.stdout.starts_with("Tracked 12 instants from 0 s to 0.183 s by 36 markers: their error is 0.00 mm"),
        "{}",
        answer.stdout
    );
    assert!(!answer.stderr.contains("warning"), "{}", answer.stderr);
    let motion = format!("{}/motion.mot", bench.out());
    let bytes = std::fs::read(&motion).unwrap();
    let table = read_table("motion.mot", &bytes).unwrap();
    let found = postures(&table, "motion.mot", &bytes, model, Units::FromFile).unwrap();
    assert!(found.missing.is_empty() && found.unknown.is_empty());
    for name in
        ["hip_flexion_r", "hip_flexion_l", "knee_angle_r", "knee_angle_l", "elbow_flex_r", "pelvis_tilt", "pelvis_tx"]
    {
        let c = model.coordinate(name).unwrap();
        for ((_, found), wanted) in found.postures.iter().zip(&bench.walk) {
            let (found, wanted) = (found.values()[c], wanted.values()[c]);
            assert!((found - wanted).abs() < 1e-6, "{name}: {found} against {wanted}");
        }
    }
    let errors = std::fs::read_to_string(format!("{}/marker-errors.sto", bench.out())).unwrap();
    assert!(
        errors.starts_with("Model Marker Errors from IK\nversion=1\nnRows=12\nnColumns=4\ninDegrees=no\nendheader\n")
    );
    assert!(errors.contains("time\ttotal_squared_error\tmarker_error_RMS\tmarker_error_max\n"));
    let assess = run(&["assess", &bench.model, &motion, "--fixed-root", "--no-report"]);
    assert!(assess.code < 2, "{}", assess.stderr);
}

#[test]
fn units_sides_pairs_names_and_gaps_that_are_wrong_are_told_by_name() {
    let bench = Bench::new();
    let plain = trc(&bench.read, &bench.walk, str::to_owned);
    let metres = bench.track(&plain.replace("\tmm\n", "\tm\n"), &[]);
    assert!(metres.stderr.contains("are they in mm? --units mm reads them so"), "{}", metres.stderr);
    let again = bench.track(&plain.replace("\tmm\n", "\tm\n"), &["--units", "mm"]);
    assert!(!again.stderr.contains("warning") && again.stdout.contains("0.00 mm"), "{}", again.stderr);
    let other = |name: &str| match name.split_at(2) {
        ("R.", rest) => format!("L.{rest}"),
        ("L.", rest) => format!("R.{rest}"),
        _ => name.to_owned(),
    };
    let sides = bench.track(&trc(&bench.read, &bench.walk, other), &[]);
    assert!(
        sides.stderr.contains("left and right seem to be swapped in the names of the markers: with the 15 pairs"),
        "{}",
        sides.stderr
    );
    let pair = |name: &str| if name.ends_with("femur0") { other(name) } else { name.to_owned() };
    let pair = bench.track(&trc(&bench.read, &bench.walk, pair), &[]);
    assert!(
        pair.stderr.contains("`R.femur0` and `L.femur0` seem to be swapped in 12 instants, from 0 s on"),
        "{}",
        pair.stderr
    );
    assert!(!pair.stderr.contains("left and right seem"), "{}", pair.stderr);
    let misspelt = bench.track(&plain.replace("R.tibia1", "R.tibbia1"), &[]);
    assert!(misspelt.stderr.contains("the marker `R.tibbia1` of"), "{}", misspelt.stderr);
    assert!(misspelt.stderr.contains("is it `R.tibia1` there?"), "{}", misspelt.stderr);
    // The same walk in a laboratory whose z axis points up.
    let upright = bench.track(&z_up(&plain), &[]);
    assert!(upright.stderr.contains("the body lies in 12 of 12 instants"), "{}", upright.stderr);
    assert!(upright.stdout.contains("0.00 mm"), "{}", upright.stdout);
    let gap = plain.lines().enumerate().map(|(i, line)| {
        let mut cells: Vec<&str> = line.split('\t').collect();
        if i == 7 {
            cells[2..5].fill("")
        }
        cells.join("\t") + "\n"
    });
    let gap = bench.track(&gap.collect::<String>(), &[]);
    assert!(gap.stderr.contains("1 gaps in 1 of 36 markers: `pelvis0`"), "{}", gap.stderr);
    assert!(gap.stdout.contains("0.00 mm"), "{}", gap.stdout);
}

#[test]
fn tasks_choose_weights_and_values_and_refusals_have_places() {
    let bench = Bench::new();
    let plain = trc(&bench.read, &bench.walk, str::to_owned);
    let setup = |coordinate: &str| {
        let markers: String = bench
            .read
            .markers
            .iter()
            .map(|m| format!("<IKMarkerTask name=\"{}\"><weight>1</weight></IKMarkerTask>", m.name))
            .collect();
        format!(
            "<OpenSimDocument><InverseKinematicsTool><IKTaskSet><objects>{markers}\n<IKCoordinateTask name=\"{coordinate}\">\
             <weight>1e6</weight><value_type>manual_value</value_type><value>0.5</value></IKCoordinateTask></objects></IKTaskSet>\
             <time_range>0.05 0.15</time_range></InverseKinematicsTool></OpenSimDocument>"
        )
    };
    let file = write(bench.folder.path(), "setup.xml", &setup("elbow_flex_r"));
    let answer = bench.track(&plain, &["--tasks", &file]);
    assert!(
        answer.stdout.starts_with("Tracked 7 instants from 0.05 s to 0.15 s by 36 markers"),
        "{}{}",
        answer.stdout,
        answer.stderr
    );
    let text = std::fs::read_to_string(format!("{}/motion.mot", bench.out())).unwrap();
    let mut rows =
        text.lines().skip_while(|line| !line.starts_with("time")).map(|line| line.split('\t').collect::<Vec<_>>());
    let column = rows.next().unwrap().iter().position(|label| *label == "elbow_flex_r").unwrap();
    for row in rows {
        let value: f64 = row[column].parse().unwrap();
        assert!((value.to_radians() - 0.5).abs() < 1e-4, "{value}");
    }
    let unknown = write(bench.folder.path(), "unknown.xml", &setup("elbow_flexx_r"));
    let trc = write(bench.folder.path(), "walk.trc", &plain);
    let said = refused(&["track", &bench.model, &trc, "--tasks", &unknown, "--out", &bench.out()]);
    assert!(
        said.contains(
            "unknown.xml:2:1: the task's coordinate `elbow_flexx_r` is not in the model; did you mean `elbow_flex_r`?"
        ),
        "{said}"
    );
    let said = refused(&["track", "adult", &trc, "--out", &bench.out()]);
    assert!(said.contains("adult: holds no markers"), "{said}");
    let said = refused(&["track", &bench.model, &trc, "--from", "9", "--out", &bench.out()]);
    assert!(said.contains("no instant lies in the time that is asked for (from 9 s)"), "{said}");
    let weightless = write(bench.folder.path(), "none.xml", &setup("elbow_flex_r").replace("<weight>1</weight>", ""));
    let said = refused(&["track", &bench.model, &trc, "--tasks", &weightless, "--out", &bench.out()]);
    assert!(said.contains("all 36 markers that are in both files have the weight 0"), "{said}");
    let strangers = write(
        bench.folder.path(),
        "strangers.trc",
        &plain.replace("R.", "x").replace("L.", "y").replace("pelvis", "z").replace("torso", "u"),
    );
    let said = refused(&["track", &bench.model, &strangers, "--out", &bench.out()]);
    assert!(said.contains("no marker is in both files"), "{said}");
}

#[test]
fn two_hundred_mutated_files_get_an_answer_or_a_named_refusal() {
    const SEED: u64 = 23;
    println!("seed {SEED}");
    let bench = Bench::new();
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let plain = trc(&bench.read, &bench.walk[..3], str::to_owned);
    let (mut answered, mut refused) = (0, 0);
    for round in 0..200 {
        let mut bytes = plain.clone().into_bytes();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(0..bytes.len());
            match rng.random_range(0..4) {
                0 => bytes[at] = b"\t\n-e9N."[rng.random_range(0..7)],
                1 => drop(bytes.drain(at..(at + 30).min(bytes.len()))),
                2 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, b"\t\n-e9N."[rng.random_range(0..7)]),
            }
        }
        let file = bench.folder.path().join("mutated.trc");
        std::fs::write(&file, bytes).unwrap();
        let out = bench.folder.path().join("mutated");
        let run = contrapposto(["track", &bench.model]).arg(&file).arg("--out").arg(&out).run();
        assert!(run.seconds < 20.0, "round {round}: {} s", run.seconds);
        match run.code {
            0 => {
                answered += 1;
                let text = std::fs::read_to_string(out.join("motion.mot")).unwrap();
                assert!(!text.contains("NaN") && !text.contains("inf"), "round {round}");
            }
            2 => {
                refused += 1;
                assert!(run.stderr.contains("mutated.trc"), "round {round}: {}", run.stderr);
            }
            code => panic!("round {round}: code {code}: {}", run.stderr),
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered > 20 && refused > 20, "{answered}, {refused}");
}
