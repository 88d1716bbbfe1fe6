//! Tests the forces of force plates of C3D files: wrenches that are written into channels of all types come back, stances find their feet, mutations,
//! and another program's numbers.

use crate::common::c3d as writer;

use std::path::PathBuf;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use contrapposto::statics::LoadKind;
use contrapposto_formats::loads::{ForcePlateError, GroundReaction};
use contrapposto_formats::markers::{MarkerUnit, read_force_plates, turn_upright};
use nalgebra::{Matrix3, Matrix6, Rotation3, Vector3, Vector6};
use rand::RngExt;
use rand_pcg::Pcg64;
use writer::{Kind, Trial};

/// A plate of a laboratory whose z axis points up: corners in m, axes as columns, z into the floor.
struct Surface {
    center: Vector3<f64>,
    axes: Matrix3<f64>,
}

impl Surface {
    fn turned(center: Vector3<f64>, yaw: f64) -> Self {
        let down = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let axes = (Rotation3::from_axis_angle(&Vector3::z_axis(), yaw) * down).into_inner();
        Self { center, axes }
    }

    /// Corners 1 to 4 in mm, one number after the other.
    fn corners(&self) -> Vec<f64> {
        let signs = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let at = |[x, y]: [f64; 2]| 1000.0 * (self.center + self.axes * Vector3::new(0.3 * x, 0.2 * y, 0.0));
        signs.into_iter().flat_map(|sign| at(sign).iter().copied().collect::<Vec<_>>()).collect()
    }
}

/// Load of a plate in its own axes: force (N), centre of pressure (m), couple about its normal (N m).
#[derive(Clone, Copy)]
struct Carried {
    force: Vector3<f64>,
    at: [f64; 2],
    couple: f64,
}

impl Carried {
    fn moment(&self) -> Vector3<f64> {
        Vector3::new(self.at[0], self.at[1], 0.0).cross(&self.force) + Vector3::new(0.0, 0.0, self.couple)
    }

    /// Values of the channels of a type, in N and N mm or mm; of type 4 before the calibration.
    fn channels(&self, kind: i16, origin: Vector3<f64>, calibration: &Matrix6<f64>) -> Vec<f64> {
        let (force, moment) = (self.force, self.moment());
        match kind {
            1 => vec![force.x, force.y, force.z, 1e3 * self.at[0], 1e3 * self.at[1], 1e3 * self.couple],
            3 => {
                // Four sensors at (a, b), (-a, b), (-a, -b), (a, -b), in the order of their numbers; the moment about them.
                let [a, b] = [origin.x, origin.y];
                let about = moment - force.cross(&Vector3::new(0.0, 0.0, origin.z));
                let (x, y) = (about.x / b, about.y / a);
                // Sums over the sides: 1 + 2 - 3 - 4 = x, 2 + 3 - 1 - 4 = y, and a part that bends the plate alone.
                let warp = 3.0;
                let signs = [[1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, -1.0]];
                let z = signs.map(|[s, t, u]| (force.z + s * x + t * y + u * warp) / 4.0);
                // The couple by differences along x and along y, half of it each.
                let (dx, dy) = (about.z / 2.0 / b, about.z / 2.0 / a);
                let [x12, x34] = [(force.x - dx) / 2.0, (force.x + dx) / 2.0];
                let [y14, y23] = [(force.y + dy) / 2.0, (force.y - dy) / 2.0];
                vec![x12, x34, y14, y23, z[0], z[1], z[2], z[3]]
            }
            _ => {
                let about = 1e3 * (moment - force.cross(&origin));
                let six = Vector6::new(force.x, force.y, force.z, about.x, about.y, about.z);
                let raw = if kind == 4 { calibration.try_inverse().unwrap() * six } else { six };
                raw.iter().copied().collect()
            }
        }
    }
}

const OFFSETS: [i16; 8] = [10, -20, 30, 5, 0, -7, 11, 2];

/// A trial with one plate of a type; two analog samples a frame, a channel more in front of the plate's.
fn trial(computer: Kind, kind: i16, surface: &Surface, carried: &[Carried]) -> (Trial, Vector3<f64>, Matrix6<f64>) {
    let count = if kind == 3 { 8 } else { 6 };
    let origin = Vector3::new(0.12, 0.08, -0.04);
    let calibration = Matrix6::from_fn(|i, j| if i == j { 2.0 + i as f64 } else { 0.05 * (i as f64 - 2.0 * j as f64) });
    let frames = vec![vec![[100.0, 200.0, 300.0, 1.0]]; carried.len() / 2];
    let mut trial = Trial::new(computer, -1.0, &["A"], frames);
    trial.ends = (11, 10 + trial.frames.len() as u16);
    (trial.samples, trial.per_channel) = (2 * (count as u16 + 1), 2);
    let scales: Vec<f64> = (0..=count).map(|i| 0.25 * f64::from(1 << (i % 3))).collect();
    let mut offsets = vec![4];
    offsets.extend(&OFFSETS[..count]);
    trial.reals = vec![
        (3, "SCALE", vec![count + 1], scales.clone()),
        (3, "GEN_SCALE", vec![], vec![0.5]),
        (4, "CORNERS", vec![3, 4, 1], surface.corners()),
        (4, "ORIGIN", vec![3, 1], origin.iter().map(|x| 1000.0 * x).collect()),
        (4, "CAL_MATRIX", vec![6, 6, 1], calibration.iter().copied().collect()),
    ];
    trial.integers = vec![
        (3, "USED", vec![], vec![count as i16 + 1]),
        (3, "OFFSET", vec![count + 1], offsets.clone()),
        (4, "USED", vec![], vec![1]),
        (4, "TYPE", vec![1], vec![kind]),
        (4, "CHANNEL", vec![count, 1], (2..=count as i16 + 1).collect()),
    ];
    for pair in carried.chunks(2) {
        let samples = pair.iter().flat_map(|carried| {
            let values = carried.channels(kind, origin, &calibration);
            let all: Vec<f64> = std::iter::once(99.0).chain(values).collect();
            let raw = |(i, value): (usize, f64)| value / scales[i] / 0.5 + f64::from(offsets[i]);
            all.into_iter().enumerate().map(raw).collect::<Vec<_>>()
        });
        trial.analog.push(samples.collect());
    }
    (trial, origin, calibration)
}

fn random(rng: &mut Pcg64) -> Carried {
    let mut number = |most: f64| rng.random_range(-most..most);
    // The reaction points out of the floor: along -z of the plate.
    let force = Vector3::new(number(80.0), number(80.0), -600.0 + number(300.0));
    Carried { force, at: [number(0.25), number(0.15)], couple: number(10.0) }
}

#[test]
fn wrenches_come_back_from_the_channels_of_all_types_and_computers() {
    const SEED: u64 = 2008;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    for computer in Kind::ALL {
        for kind in [1, 2, 3, 4] {
            let surface =
                Surface::turned(Vector3::new(rng.random_range(-1.0..1.0), 0.7, 0.02), rng.random_range(-3.0..3.0));
            let carried: Vec<Carried> = (0..12).map(|_| random(&mut rng)).collect();
            let (trial, ..) = trial(computer, kind, &surface, &carried);
            let read = read_force_plates("a.c3d", &trial.bytes(), None).unwrap();
            assert!(read.warnings.is_empty(), "{:?}", read.warnings);
            let times: Vec<f64> = (0..12).map(|k| (10.0 + f64::from(k) / 2.0) / 50.0).collect();
            assert!(read.times.iter().zip(&times).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", read.times);
            let plate = &read.plates[0];
            // Reals of 32 bits.
            assert!((plate.center - surface.center).norm() < 1e-6 && (plate.up - Vector3::z()).norm() < 1e-5);
            for (i, carried) in carried.iter().enumerate() {
                let (force, moment) = (surface.axes * carried.force, surface.axes * carried.moment());
                assert!((plate.forces[i] - force).norm() < 2e-3, "{computer:?} {kind}: {} {force}", plate.forces[i]);
                assert!(
                    (plate.moments[i] - moment).norm() < 2e-3,
                    "{computer:?} {kind}: {} {moment}",
                    plate.moments[i]
                );
                let at = surface.center + surface.axes * Vector3::new(carried.at[0], carried.at[1], 0.0);
                assert!((plate.center_of_pressure(i).unwrap() - at).norm() < 1e-5, "{computer:?} {kind}");
            }
        }
    }
}

/// Integers with and without a sign, forces of the body on the plate, and an origin with the wrong sign.
#[test]
fn integers_other_senses_and_origins_are_read() {
    let carried = Carried { force: Vector3::new(0.0, 0.0, -500.0), at: [0.1, -0.05], couple: 0.0 };
    let surface = Surface::turned(Vector3::new(0.2, 0.3, 0.0), 0.4);
    let (mut signed, ..) = trial(Kind::Intel, 2, &surface, &[carried; 2]);
    // Integers: coarse scales, so that all fit into 16 bits.
    let whole = |trial: &mut Trial, least: f64| {
        trial.scale = 1.0;
        let scales = trial.reals.iter_mut().find(|(_, name, ..)| *name == "SCALE").unwrap();
        scales.3.iter_mut().for_each(|scale| *scale *= 8.0);
        for samples in &mut trial.analog {
            samples.iter_mut().for_each(|raw| *raw = (*raw / 8.0 + least).round());
        }
        let offsets = trial.integers.iter_mut().find(|(_, name, ..)| *name == "OFFSET").unwrap();
        offsets
            .3
            .iter_mut()
            .for_each(|offset| *offset = ((f64::from(*offset) / 8.0 + least).round() as i32) as u16 as i16);
    };
    let plain = signed.clone();
    whole(&mut signed, 0.0);
    let mut unsigned = plain.clone();
    whole(&mut unsigned, 40_000.0);
    unsigned.texts.push((3, "FORMAT", vec!["UNSIGNED"]));
    let at = surface.center + surface.axes * Vector3::new(0.1, -0.05, 0.0);
    for trial in [&signed, &unsigned] {
        let read = read_force_plates("a.c3d", &trial.bytes(), None).unwrap();
        let plate = &read.plates[0];
        assert!((plate.forces[0] - Vector3::new(0.0, 0.0, 500.0)).norm() < 10.0, "{}", plate.forces[0]);
        assert!((plate.center_of_pressure(0).unwrap() - at).norm() < 0.02);
    }
    let mut pulls = plain.clone();
    for raw in pulls.analog.iter_mut().flat_map(|samples| samples.chunks_mut(7)) {
        (0..6).for_each(|i| raw[i + 1] = 2.0 * f64::from(OFFSETS[i]) - raw[i + 1]);
    }
    let read = read_force_plates("a.c3d", &pulls.bytes(), None).unwrap();
    assert_eq!(read.warnings, ["a.c3d: force plate 1 gives the forces of the body on it; they are turned round"]);
    assert!((read.plates[0].forces[0] - Vector3::new(0.0, 0.0, 500.0)).norm() < 1e-3);
    let mut above = plain.clone();
    above
        .reals
        .iter_mut()
        .filter(|(_, name, ..)| *name == "ORIGIN")
        .for_each(|o| o.3.iter_mut().for_each(|x| *x = -*x));
    let read = read_force_plates("a.c3d", &above.bytes(), None).unwrap();
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    assert!((read.plates[0].center_of_pressure(0).unwrap() - at).norm() < 1e-5);
    // A unit of the moments that is said counts.
    let mut metres = plain;
    metres.texts.push((3, "UNITS", vec!["V", "N", "N", "N", "Nm", "Nm", "Nm"]));
    let far = read_force_plates("a.c3d", &metres.bytes(), None).unwrap().plates[0].center_of_pressure(0).unwrap();
    assert!((far - at).norm() > 10.0);
}

#[test]
fn plates_that_cannot_be_read_are_refused_by_name() {
    let carried = Carried { force: Vector3::new(0.0, 0.0, -500.0), at: [0.0; 2], couple: 0.0 };
    let surface = Surface::turned(Vector3::zeros(), 0.0);
    let (good, ..) = trial(Kind::Intel, 2, &surface, &[carried; 2]);
    let refusal = |change: &dyn Fn(&mut Trial)| {
        let mut trial = good.clone();
        change(&mut trial);
        read_force_plates("a.c3d", &trial.bytes(), None).unwrap_err().to_string()
    };
    let set = |name: &'static str, values: Vec<i16>| {
        move |trial: &mut Trial| {
            trial.integers.iter_mut().filter(|(group, other, ..)| *group == 4 && *other == name).for_each(
                |parameter| {
                    parameter.2 = vec![values.len()];
                    parameter.3.clone_from(&values);
                },
            );
        }
    };
    let without = |name: &'static str| move |trial: &mut Trial| trial.reals.retain(|(_, other, ..)| *other != name);
    for (said, part) in [
        (refusal(&set("TYPE", vec![7])), "force plate 1 is of type 7; types 1, 2, 3 and 4 are accepted"),
        (refusal(&set("USED", vec![0])), "the file has no force plate (FORCE_PLATFORM:USED)"),
        (refusal(&set("USED", vec![2])), "FORCE_PLATFORM:TYPE holds no 1 numbers of plate 2"),
        (
            refusal(&set("CHANNEL", vec![2, 3, 4, 5, 6, 8])),
            "numbers from 1 to 7, that of analog channels, are accepted",
        ),
        (refusal(&set("CHANNEL", vec![2, 3])), "FORCE_PLATFORM:CHANNEL names no 6 channels of plate 1"),
        (refusal(&without("CORNERS")), "FORCE_PLATFORM:CORNERS holds no 12 numbers of plate 1"),
        (refusal(&without("ORIGIN")), "FORCE_PLATFORM:ORIGIN holds no 3 numbers of plate 1"),
        (
            refusal(&|trial| trial.reals.iter_mut().filter(|r| r.1 == "CORNERS").for_each(|r| r.3.fill(1.0))),
            "the corners of force plate 1 span no area",
        ),
        (refusal(&|trial| trial.analog[0][3] = f64::NAN), "analog channel 4 in frame 11: NaN is no value"),
    ] {
        assert!(said.starts_with("a.c3d: byte ") && said.contains(part), "`{part}` is not in\n{said}");
    }
}

/// The adult on two plates of a laboratory with z up, one foot each, then the right foot on both: each stance is given to the foot above it.
#[test]
fn stances_are_given_to_the_foot_that_stands_on_the_plate() {
    let model = adult(&Adult::default()).unwrap();
    let mut kinematics = Kinematics::new(&model);
    let posture = model.default_posture();
    kinematics.update(&model, &posture).unwrap();
    let to_laboratory = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let under = |name: &str| {
        let foot = model.segment(name).unwrap();
        let at = kinematics.station(&model, foot, model.segments()[foot].center_of_mass);
        to_laboratory * Vector3::new(at.x, 0.0, at.z)
    };
    let [right, left] = ["calcn_r", "calcn_l"].map(under);
    // One plate under both feet, each of which stands on it for a while: first the right one, then the left one.
    let middle = (right + left) / 2.0;
    let surface = Surface::turned(middle, 0.0);
    let on = |at: Vector3<f64>, newtons: f64| {
        let own = surface.axes.transpose() * (at - middle);
        Carried { force: Vector3::new(0.0, 0.0, -newtons), at: [own.x, own.y], couple: 0.0 }
    };
    let nothing = on(middle, 0.0);
    let mut carried = vec![on(right, 700.0); 20];
    carried.extend(vec![nothing; 20]);
    carried.extend(vec![on(left, 600.0); 20]);
    let (trial, ..) = trial(Kind::Intel, 2, &surface, &carried);
    let mut read = read_force_plates("walk.c3d", &trial.bytes(), None).unwrap();
    let motion: Vec<(f64, Posture)> = read.times.iter().map(|time| (*time, posture.clone())).collect();
    let turn = turn_upright(read.up, Vector3::y()).unwrap();
    assert!(
        (turn.inverse() * Vector3::new(0.3, 0.4, 0.5) - to_laboratory * Vector3::new(0.3, 0.4, 0.5)).norm() < 1e-12
    );
    read.turn(&turn);
    assert!(turn_upright(read.up, Vector3::y()).is_none());
    let ground = GroundReaction::of_force_plates("walk.c3d", &read, &[], (&model, &motion)).unwrap();
    assert_eq!(
        ground.assigned(),
        ["force plate 1 acts on `calcn_r` (0.2 s to 0.39 s) and on `calcn_l` (0.6 s to 0.79 s)"]
    );
    let forces = |ground: &GroundReaction, time: f64| -> Vec<(usize, Vector3<f64>)> {
        let mut loads = vec![];
        ground.loads(time, &model, &kinematics, &mut loads);
        let force = |load: &contrapposto::statics::Load| match load.kind {
            LoadKind::Force(force, _) if force.norm() > 1.0 => Some((load.segment, force)),
            _ => None,
        };
        loads.iter().filter_map(force).collect()
    };
    let [calcn_r, calcn_l] = ["calcn_r", "calcn_l"].map(|name| model.segment(name).unwrap());
    for (time, wanted) in [(0.3, vec![(calcn_r, 700.0)]), (0.5, vec![]), (0.7, vec![(calcn_l, 600.0)])] {
        let found = forces(&ground, time);
        assert_eq!(found.len(), wanted.len(), "{time}");
        for ((segment, force), (expected, newtons)) in found.iter().zip(wanted) {
            assert!(*segment == expected && (force - Vector3::new(0.0, newtons, 0.0)).norm() < 1e-2, "{force}");
        }
    }
    // Given by hand; of no body; of a plate that is not there; far from both feet.
    let given = [(1, Some(calcn_l))];
    let ground = GroundReaction::of_force_plates("walk.c3d", &read, &given, (&model, &motion)).unwrap();
    assert_eq!(forces(&ground, 0.3)[0].0, calcn_l);
    let none = GroundReaction::of_force_plates("walk.c3d", &read, &[(1, None)], (&model, &motion)).unwrap();
    assert_eq!(none.assigned(), ["force plate 1 does not act on the body in the time of the motion"]);
    let wrong = GroundReaction::of_force_plates("walk.c3d", &read, &[(2, None)], (&model, &motion)).unwrap_err();
    assert_eq!(wrong.to_string(), "walk.c3d has 1 force plates, no number 2");
    let mut far = read.clone();
    far.plates[0].center += Vector3::x();
    let far = GroundReaction::of_force_plates("walk.c3d", &far, &[], (&model, &motion)).unwrap_err();
    assert!(
        matches!(far, ForcePlateError::Far { number: 1, distance, .. } if distance > 0.9 && distance < 1.1),
        "{far}"
    );
    let arm: Model = adult(&Adult::right_arm()).unwrap();
    let frames = [(0.3, arm.default_posture())];
    let none = GroundReaction::of_force_plates("walk.c3d", &read, &[], (&arm, &frames));
    assert!(matches!(none, Err(ForcePlateError::NoFeet { .. })));
}

#[test]
fn mutated_files_with_force_plates_are_read_or_refused() {
    const SEED: u64 = 23;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let (mut read, mut refused) = (0, 0);
    let surface = Surface::turned(Vector3::new(0.1, 0.2, 0.0), 0.3);
    for kind in [1, 2, 3, 4] {
        let carried: Vec<Carried> = (0..4).map(|_| random(&mut rng)).collect();
        let plain = trial(Kind::ALL[kind as usize % 3], kind, &surface, &carried).0.bytes();
        for round in 0..600 {
            let mut bytes = plain.clone();
            for _ in 0..rng.random_range(1..5) {
                let at = [rng.random_range(0..24), rng.random_range(512..bytes.len()), rng.random_range(512..1600)];
                let at = at[rng.random_range(0..3)].min(bytes.len() - 1);
                bytes[at] =
                    if rng.random_bool(0.5) { rng.random() } else { [0, 1, 127, 128, 255][rng.random_range(0..5)] };
            }
            if round % 10 == 0 {
                bytes.truncate(rng.random_range(0..bytes.len()));
            }
            match read_force_plates("m.c3d", &bytes, Some(MarkerUnit::Millimetre)) {
                Ok(plates) => {
                    read += 1;
                    for plate in &plates.plates {
                        assert_eq!((plate.forces.len(), plate.moments.len()), (plates.times.len(), plates.times.len()));
                        assert!(plate.forces.iter().chain(&plate.moments).all(|v| v.iter().all(|x| x.is_finite())));
                    }
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().starts_with("m.c3d: byte "), "{error}");
                }
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 200 && refused > 200, "{read} {refused}");
}

#[test]
#[ignore = "needs CONTRAPPOSTO_C3D: a folder of C3D files, with forces that scripts/c3d_peer.py wrote beside them"]
fn forces_of_published_files_are_those_of_ezc3d() {
    let folder = PathBuf::from(std::env::var_os("CONTRAPPOSTO_C3D").unwrap());
    let (mut files, mut samples, mut largest, mut faults) = (0, 0, 0.0_f64, vec![]);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("c3d"))) {
        let name = path.file_name().unwrap().to_string_lossy();
        let ours = read_force_plates(&name, &std::fs::read(path).unwrap(), None);
        let Ok(peer) = std::fs::read_to_string(path.with_extension("forces")) else {
            println!(
                "{name}: ezc3d gives none; {}",
                ours.map_or_else(|e| e.to_string(), |r| format!("{} plates", r.plates.len()))
            );
            continue;
        };
        let read = match ours {
            Ok(read) => read,
            Err(error) => {
                faults.push(error.to_string());
                continue;
            }
        };
        let rows: Vec<Vec<f64>> = peer
            .lines()
            .filter(|line| !line.is_empty())
            .map(|line| line.split('\t').map(|cell| cell.parse().unwrap()).collect())
            .collect();
        if rows.is_empty() {
            println!("{name}: ezc3d gives no sample");
            continue;
        }
        if rows.len() != read.times.len() || rows[0].len() != 6 * read.plates.len() {
            faults.push(format!("{name}: {} samples, {} wanted", read.times.len(), rows.len()));
            continue;
        }
        let mut worst = 0.0_f64;
        for (number, plate) in read.plates.iter().enumerate() {
            let turned =
                read.warnings.iter().any(|w| w.contains(&format!("plate {} gives the forces of the body", number + 1)));
            let sense = if turned { -1.0 } else { 1.0 };
            for (i, row) in rows.iter().enumerate() {
                let wanted = Vector6::from_column_slice(&row[6 * number..6 * number + 6]) * sense;
                let ours = Vector6::from_iterator(plate.forces[i].iter().chain(&plate.moments[i]).copied());
                let apart = (ours - wanted).norm() / wanted.norm().max(1.0);
                if apart.is_finite() {
                    worst = worst.max(apart);
                }
            }
        }
        println!("{name}: {} plates, {worst:.1e}; {:?}", read.plates.len(), read.warnings);
        if worst > 1e-6 {
            faults.push(format!("{name}: {worst:e} apart"));
        }
        (files, samples, largest) = (files + 1, samples + rows.len() * read.plates.len(), largest.max(worst));
    }
    println!("{files} files, {samples} samples of plates; {largest:.1e} apart at most");
    assert!(faults.is_empty() && files > 10, "{}", faults.join("\n"));
}
