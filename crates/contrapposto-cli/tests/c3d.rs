//! C3D files: the same motion and the same scaled model as by `.trc`; refusals; mutated files.

use crate::support;
#[path = "../../contrapposto-formats/tests/common/c3d.rs"]
mod writer;

use std::fmt::Write as _;
use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;
use support::{contrapposto, refused, run, write};
use writer::{Kind, Trial};

const SEGMENTS: [&str; 8] = ["pelvis", "torso", "femur_r", "tibia_r", "calcn_r", "femur_l", "tibia_l", "calcn_l"];

/// Our own woman, with three markers on each of some segments: `femur_r0`, ...
fn marked_woman() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let text = std::fs::read_to_string(path).unwrap();
    let mut markers = String::new();
    for segment in SEGMENTS {
        for (i, place) in ["0.09 0.02 0.03", "-0.07 -0.06 0.05", "0.02 -0.11 0.08"].into_iter().enumerate() {
            let _ = write!(
                markers,
                "<Marker name=\"{segment}{i}\"><socket_parent_frame>/bodyset/{segment}</socket_parent_frame><location>{place}</location></Marker>"
            );
        }
    }
    let end = text.rfind("</Model>").unwrap();
    format!("{}<MarkerSet name=\"m\"><objects>{markers}</objects></MarkerSet>{}", &text[..end], &text[end..])
}

/// Frames of a walk in mm, rounded to reals of 32 bits, with a gap.
fn frames(read: &SourcedModel) -> Vec<Vec<[f64; 4]>> {
    let mut body = Kinematics::new(&read.model);
    let mut frame = |i: usize| {
        let mut posture = read.model.default_posture();
        for (name, value) in [("hip_flexion_r", 0.1), ("knee_angle_r", 0.05), ("pelvis_tx", 0.02)] {
            posture.values_mut()[read.model.coordinate(name).unwrap()] = value * (i + 1) as f64;
        }
        body.update(&read.model, &posture).unwrap();
        let places = read.markers.iter().enumerate().map(|(marker, m)| {
            let place: Vector3<f64> = 1e3 * body.station(&read.model, m.segment, m.point);
            let [x, y, z] = [place.x, place.y, place.z].map(|value| f64::from(value as f32));
            [x, y, z, if (i, marker) == (1, 4) { -1.0 } else { 0.5 }]
        });
        places.collect::<Vec<_>>()
    };
    (0..4).map(&mut frame).collect()
}

/// The same frames as the text of a `.trc` file.
fn trc(names: &[&str], frames: &[Vec<[f64; 4]>]) -> String {
    let mut text = format!("PathFileType\t4\nNumMarkers\tUnits\n{}\tmm\nFrame#\tTime\t", names.len());
    text.push_str(&names.join("\t\t\t"));
    for (i, frame) in frames.iter().enumerate() {
        let _ = write!(text, "\n{}\t{:?}", i + 31, (i + 30) as f64 / 60.0);
        for [x, y, z, residual] in frame {
            let _ = if *residual < 0.0 { write!(text, "\t\t\t") } else { write!(text, "\t{x:?}\t{y:?}\t{z:?}") };
        }
    }
    text + "\n"
}

struct Bench {
    folder: tempfile::TempDir,
    model: String,
    names: Vec<String>,
    frames: Vec<Vec<[f64; 4]>>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let text = marked_woman();
        let read = SourcedModel::read("w.osim", text.as_bytes(), None, &mut |_| Err(String::new())).unwrap();
        let model = write(folder.path(), "woman.osim", &text);
        let names = read.markers.iter().map(|marker| marker.name.clone()).collect();
        Self { folder, model, names, frames: frames(&read) }
    }

    fn names(&self) -> Vec<&str> {
        self.names.iter().map(String::as_str).collect()
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn trial(&self, kind: Kind) -> Trial {
        let mut trial = Trial::new(kind, -0.01, &self.names(), self.frames.clone());
        (trial.rate, trial.ends) = (60.0, (31, 34));
        trial
    }

    /// Writes a C3D file.
    fn c3d(&self, kind: Kind) -> String {
        let path = self.path("walk.c3d");
        std::fs::write(&path, self.trial(kind).bytes()).unwrap();
        path
    }
}

#[test]
fn the_same_markers_give_the_same_motion_and_the_same_scaled_model() {
    let bench = Bench::new();
    let trc = write(bench.folder.path(), "walk.trc", &trc(&bench.names(), &bench.frames));
    let (out, scaled) = (bench.path("out"), bench.path("scaled.osim"));
    let results = |markers: &str| {
        let track = run(&["track", &bench.model, markers, "--out", &out]);
        assert_eq!(track.code, 0, "{}", track.stderr);
        assert!(track.stdout.starts_with("Tracked 4 instants from 0.5 s to 0.55 s by 24 markers"), "{}", track.stdout);
        let measure = ["--measure", "thigh=femur_r0,tibia_r0:femur_r:XYZ", "--place-markers"];
        let scale = run(&[&["scale", &bench.model, markers, "--out", &scaled], measure.as_slice()].concat());
        assert_eq!(scale.code, 0, "{}", scale.stderr);
        [format!("{out}/motion.mot"), format!("{out}/marker-errors.sto"), scaled.clone()]
            .map(|path| std::fs::read_to_string(path).unwrap())
    };
    let wanted = results(&trc);
    for kind in Kind::ALL {
        let found = results(&bench.c3d(kind));
        assert!(found == wanted, "{kind:?}");
    }
}

#[test]
fn c3d_files_in_the_wrong_place_and_without_a_unit_are_refused() {
    let bench = Bench::new();
    let c3d = bench.c3d(Kind::Intel);
    let said = refused(&["scale", &c3d, &bench.model, "--out", &bench.path("s.osim")]);
    assert!(said.contains("the model comes first, then the markers"), "{said}");
    let said = refused(&["assess", "adult", &c3d]);
    assert!(
        said.contains("is a marker file; `contrapposto track MODEL FILE --out DIR` makes a motion of it"),
        "{said}"
    );
    let motion = write(bench.folder.path(), "two.csv", "time,elbow_flex_r_deg\n0,90\n5,60\n");
    let said = refused(&["assess", "adult", &motion, "--grf", &c3d]);
    assert!(
        said.contains("the file has no force plate (FORCE_PLATFORM:USED); a file with force plates is accepted"),
        "{said}"
    );
    let mut trial = bench.trial(Kind::Dec);
    trial.unit = "feet";
    std::fs::write(&c3d, trial.bytes()).unwrap();
    let said = refused(&["track", &bench.model, &c3d, "--out", &bench.path("out")]);
    assert!(said.contains("walk.c3d: byte ") && said.contains("`feet`; mm, cm and m are known units"), "{said}");
    let units = run(&["track", &bench.model, &c3d, "--units", "mm", "--out", &bench.path("out")]);
    assert_eq!(units.code, 0, "{}", units.stderr);
}

#[test]
fn two_hundred_mutated_files_get_an_answer_or_a_named_refusal() {
    const SEED: u64 = 31;
    println!("seed {SEED}");
    let bench = Bench::new();
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let (mut answered, mut refused) = (0, 0);
    for round in 0..200 {
        let mut bytes = bench.trial(Kind::ALL[round % 3]).bytes();
        for _ in 0..rng.random_range(1..4) {
            // The header, the parameters, or the frames.
            let at = [rng.random_range(0..24), rng.random_range(512..800), rng.random_range(0..bytes.len())];
            let at = at[rng.random_range(0..3)].min(bytes.len() - 1);
            match rng.random_range(0..4) {
                0 => bytes[at] = rng.random_range(0..=255),
                1 => bytes[at] ^= 1 << rng.random_range(0..8),
                2 => bytes.truncate(at.max(1)),
                _ => drop(bytes.drain(at..(at + 30).min(bytes.len()))),
            }
            if bytes.is_empty() {
                bytes.push(2);
            }
        }
        let file = bench.folder.path().join("mutated.c3d");
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
                assert!(run.stderr.contains("mutated.c3d"), "round {round}: {}", run.stderr);
            }
            code => panic!("round {round}: code {code}: {}", run.stderr),
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered > 20 && refused > 20, "{answered}, {refused}");
}

/// A force plate of a laboratory whose z axis points up, under the right foot: the same torques as by a table of its forces, and by name of the plate.
#[test]
fn a_force_plate_gives_the_torques_of_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(folder.path(), "woman.osim", &marked_woman());
    let read = SourcedModel::read("woman.osim", marked_woman().as_bytes(), None, &mut |_| Err(String::new())).unwrap();
    let mut body = Kinematics::new(&read.model);
    body.update(&read.model, &read.model.default_posture()).unwrap();
    let foot = read.model.segment("calcn_r").unwrap();
    let at = body.station(&read.model, foot, read.model.segments()[foot].center_of_mass);
    let ground = at.y - 0.1;
    // In the laboratory z points up and y to the left: x, -z, y of the model.
    let [x, y, z] = [at.x, -at.z, ground].map(|value| 1e3 * value);
    let mut trial = Trial::new(Kind::Intel, -1.0, &["A"], vec![vec![[1.0, 2.0, 3.0, 0.0]]; 4]);
    (trial.samples, trial.per_channel) = (6, 1);
    // Corners in an order that has the plate's x along the laboratory's x, y against its y, z down.
    let corners = [[0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2], [0.3, 0.2]];
    let corners = corners.iter().flat_map(|[a, b]| [x + 1e3 * a, y + 1e3 * b, z]).collect();
    trial.reals = vec![(4, "CORNERS", vec![3, 4, 1], corners), (4, "ORIGIN", vec![3, 1], vec![0.0; 3])];
    trial.integers = vec![
        (3, "USED", vec![], vec![6]),
        (4, "USED", vec![], vec![1]),
        (4, "TYPE", vec![1], vec![2]),
        (4, "CHANNEL", vec![6, 1], vec![1, 2, 3, 4, 5, 6]),
    ];
    // 40 N ahead, 10 N to the left, 600 N up; moments in N mm about the middle of the surface: 6 N m about x, -9 about y, 2 about z of the plate.
    trial.analog = vec![vec![40.0, -10.0, -600.0, 6e3, -9e3, 2e3]; 4];
    let c3d = folder.path().join("force.c3d");
    std::fs::write(&c3d, trial.bytes()).unwrap();
    let motion = write(folder.path(), "stand.csv", "time,hip_flexion_r_deg\n0,0\n0.02,1\n0.04,2\n0.06,3\n");
    // In the model's axes: x as it is, the plate's z is -y, its y is z.
    let row = format!("40\t600\t-10\t{:.9}\t{:.9}\t{:.9}\t6\t-2\t-9", at.x, ground, at.z);
    let columns = "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\tground_torque_x\tground_torque_y\tground_torque_z";
    let table = write(
        folder.path(),
        "force.sto",
        &format!("forces\nversion=1\nnRows=2\nnColumns=10\ninDegrees=no\nendheader\n{columns}\n0\t{row}\n0.1\t{row}\n"),
    );
    let torques = |more: &[&str]| {
        let said = run(&[&["torques", &model, &motion, "--static", "--json"], more].concat());
        assert_eq!(said.code, 0, "{}", said.stderr);
        (serde_json::from_str::<serde_json::Value>(&said.stdout).unwrap(), said.stderr)
    };
    let c3d = c3d.to_str().unwrap();
    let (wanted, _) = torques(&["--grf", &table, "--grf-on", "calcn_r"]);
    let (by_nearness, said) = torques(&["--grf", c3d]);
    assert!(said.contains("force plate 1 acts on `calcn_r` (0 s to 0.06 s)"), "{said}");
    assert!(said.contains("it is turned upright"), "{said}");
    let (by_name, _) = torques(&["--grf", c3d, "--plate", "1=calcn_r"]);
    assert_eq!(by_nearness, by_name);
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        let frames = value.as_array().unwrap().iter();
        let all = frames.flat_map(|frame| frame["coordinates"].as_object().unwrap().values());
        all.map(|torques| torques["external"].as_f64().unwrap()).collect()
    };
    let (wanted, found) = (numbers(&wanted), numbers(&by_name));
    assert!(wanted.len() > 40 && wanted.len() == found.len());
    for (a, b) in wanted.iter().zip(&found) {
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
    let (left, _) = torques(&["--grf", c3d, "--plate", "1=calcn_l"]);
    assert!(numbers(&left).iter().zip(&wanted).any(|(a, b)| (a - b).abs() > 10.0));
    for (more, part) in [
        (["--plate", "one=calcn_r"], "`one` is no number of a plate"),
        (["--plate", "1"], "NUMBER=SEGMENT is accepted"),
        (["--plate", "1=calcn_x"], "the model has no segment `calcn_x`"),
        (["--plate", "3=none"], "has 1 force plates, no number 3"),
        (["--grf-on", "calcn_r"], "--plate 1=calcn_r names that of a force plate"),
    ] {
        let message = refused(&[&["torques", &model, &motion, "--grf", c3d][..], &more].concat());
        assert!(message.contains(part), "`{part}` is not in\n{message}");
    }
    let message = refused(&["torques", &model, &motion, "--grf", &table, "--plate", "1=calcn_r"]);
    assert!(message.contains("is no C3D file"), "{message}");
}

/// Markers of a laboratory with z up give the motion of those with y up: by the axis that a C3D file says, and by --up of a `.trc`.
#[test]
fn markers_of_a_laboratory_with_z_up_are_turned_upright() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(folder.path(), "woman.osim", &marked_woman());
    let read = SourcedModel::read("woman.osim", marked_woman().as_bytes(), None, &mut |_| Err(String::new())).unwrap();
    let names: Vec<&str> = read.markers.iter().map(|marker| marker.name.as_str()).collect();
    let frames = frames(&read);
    let turned: Vec<Vec<[f64; 4]>> =
        frames.iter().map(|frame| frame.iter().map(|&[x, y, z, seen]| [x, -z, y, seen]).collect()).collect();
    let upright = write(folder.path(), "up.trc", &trc(&names, &frames));
    let lying = write(folder.path(), "z.trc", &trc(&names, &turned));
    let mut trial = Trial::new(Kind::Intel, -1.0, &names, turned);
    trial.texts.push((1, "Y_SCREEN", vec!["+Z"]));
    (trial.rate, trial.ends) = (60.0, (31, 34));
    let c3d = folder.path().join("z.c3d");
    std::fs::write(&c3d, trial.bytes()).unwrap();
    let motion = |markers: &str, more: &[&str], out: &str| {
        let out = folder.path().join(out);
        let said = run(&[&["track", &model, markers, "--out", out.to_str().unwrap()], more].concat());
        assert_eq!(said.code, 0, "{}", said.stderr);
        (std::fs::read_to_string(out.join("motion.mot")).unwrap(), said.stderr)
    };
    let (wanted, said) = motion(&upright, &[], "up");
    assert!(!said.contains("turned upright") && !said.contains("lies"), "{said}");
    let (by_name, said) = motion(&lying, &["--up", "z"], "z");
    assert!(said.contains("turned upright"), "{said}");
    let (by_file, _) = motion(c3d.to_str().unwrap(), &[], "c3d");
    let (_, said) = motion(&lying, &[], "lying");
    assert!(said.contains("the body lies in 4 of 4 instants") && said.contains("--up z turns them"), "{said}");
    for other in [by_name, by_file] {
        let numbers =
            |text: &str| -> Vec<f64> { text.split_whitespace().filter_map(|cell| cell.parse().ok()).collect() };
        let (a, b) = (numbers(&wanted), numbers(&other));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-4), "{wanted}\n{other}");
    }
}
