//! Three whole models from files, ten thousand postures each: external torque by recursion, by the sum of Jacobian columns times
//! forces over frames of the test's own, and by the slope of potential energy; its gradient by differences of torque. Functions
//! that drive joints, couplings, balls, slides and a free root are among them. Random trees without files:
//! `contrapposto/tests/statics.rs`. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use crate::common;

use common::{frames, here};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};
use contrapposto_formats::model_ir::{Drive, ModelIr, MotionIr};
use contrapposto_formats::{mjcf, osim, write};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random() -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("seed {seed}");
    Pcg64::seed_from_u64(seed)
}

/// The adult as OpenSim has it, a body whose knees and spine follow functions and each other, and odd joints of MJCF.
fn bodies() -> Vec<(&'static str, ModelIr)> {
    let file = |name: &str| std::fs::read(here().join("tests/models").join(name)).unwrap();
    let written = write::osim(&adult(&Adult::default()).unwrap()).unwrap().text;
    let mut include = |part: &str| Ok(file(part));
    vec![
        ("the adult", osim::read(written.as_bytes(), "adult.osim").unwrap()),
        ("coupled.osim", osim::read(&file("coupled.osim"), "coupled.osim").unwrap()),
        (
            "features.xml",
            mjcf::read(&file("features.xml"), "features.xml", &mut include, &mjcf::Options::default()).unwrap(),
        ),
    ]
}

/// Values in the order of the file, where a model has its own.
fn of_the_file(body: &ModelIr, model: &Model, values: &[f64]) -> Vec<f64> {
    let mut q: Vec<f64> = body.coordinates.iter().map(|c| values[model.coordinate(&c.name).unwrap()]).collect();
    lead(body, &mut q);
    q
}

/// Angles, slides and quaternions of any length.
fn posture(model: &Model, rng: &mut Pcg64) -> Posture {
    let value = |c: &contrapposto::model::Coordinate| {
        let (min, max) = (c.range.0.max(-3.0), c.range.1.min(3.0));
        if min < max { rng.random_range(min..max) } else { c.default }
    };
    Posture::new(model.coordinates().iter().map(value).collect())
}

/// Values of dependent coordinates, by their couplings.
fn lead(body: &ModelIr, values: &mut [f64]) {
    // As often as a chain of followers can be long.
    for _ in &body.couplings {
        for coupling in &body.couplings {
            values[coupling.dependent] = coupling.function.value(values[coupling.independent]);
        }
    }
}

fn loads(body: &ModelIr, rng: &mut Pcg64) -> Vec<Load> {
    let vector = |rng: &mut Pcg64, size: f64| V::from_fn(|_, _| rng.random_range(-size..size));
    (0..4)
        .map(|k| {
            let kind = match k {
                0 => LoadKind::Weight(rng.random_range(0.0..10.0)),
                1 => LoadKind::Force(vector(rng, 80.0), FixedIn::World),
                2 => LoadKind::Force(vector(rng, 80.0), FixedIn::Segment),
                _ => LoadKind::Couple(vector(rng, 20.0), FixedIn::Segment),
            };
            Load { segment: rng.random_range(0..body.segments.len()), point: vector(rng, 0.3), kind }
        })
        .collect()
}

/// Forces on each segment: point, force and couple in ground.
fn pulls(body: &ModelIr, frames: &[Isometry3<f64>], loads: &[Load]) -> Vec<(usize, V, V, V)> {
    let own = body
        .segments
        .iter()
        .enumerate()
        .map(|(s, segment)| (s, segment.center_of_mass, segment.mass * body.gravity, V::zeros()));
    let given = loads.iter().map(|load| {
        let turned = |v: V, fixed| if fixed == FixedIn::World { v } else { frames[load.segment].rotation * v };
        let (force, couple) = match load.kind {
            LoadKind::Weight(mass) => (mass * body.gravity, V::zeros()),
            LoadKind::Force(force, fixed) => (turned(force, fixed), V::zeros()),
            LoadKind::Couple(couple, fixed) => (V::zeros(), turned(couple, fixed)),
        };
        (load.segment, load.point, force, couple)
    });
    own.chain(given).map(|(s, x, f, c)| (s, (frames[s] * Point3::from(x)).coords, f, c)).collect()
}

/// A motion of a joint: what turns or slides, where, and by which coordinate's rate it goes how fast.
struct Screw {
    axis: V,
    point: V,
    turns: bool,
    rate: usize,
    speed: f64,
}

/// Rates of every segment's joint, in ground, with the segment's chain of parents.
fn screws(body: &ModelIr, model: &Model, frames: &[Isometry3<f64>], q: &[f64]) -> Vec<Vec<Screw>> {
    let place = |c: usize| model.coordinate(&body.coordinates[c].name).unwrap();
    let rate_of = |c: usize| model.coordinates()[place(c)].rate.unwrap();
    // A ball's three rates stand where its quaternion does.
    let before = |c: usize| {
        model.rates().iter().position(|rate| rate.coordinate.is_some_and(|own| own > c)).unwrap_or(model.rates().len())
            - 3
    };
    let joint = |segment: &contrapposto_formats::model_ir::SegmentIr| {
        let mut frame = segment.parent.map_or(Isometry3::identity(), |p| frames[p]) * segment.in_parent;
        let mut all = vec![];
        for motion in &segment.motions {
            let point = frame.translation.vector;
            match motion {
                MotionIr::Hinge { axis, drive } | MotionIr::Slide { axis, drive } => {
                    let (value, moved) = match drive {
                        Drive::Coordinate(c) => (q[*c], Some((*c, 1.0))),
                        Drive::Function(f, c) => (f.value(q[*c]), Some((*c, f.slope(q[*c])))),
                        Drive::Fixed(value) => (*value, None),
                    };
                    let turns = matches!(motion, MotionIr::Hinge { .. });
                    let unit = nalgebra::Unit::new_normalize(*axis);
                    // A slide goes along the axis as long as it is given.
                    let along = frame.rotation * if turns { unit.into_inner() } else { *axis };
                    all.extend(moved.map(|(c, speed)| Screw { axis: along, point, turns, rate: rate_of(c), speed }));
                    frame *= if turns {
                        Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&unit, value))
                    } else {
                        Isometry3::from(Translation3::from(axis * value))
                    };
                }
                MotionIr::Ball { first } => {
                    let turn = nalgebra::Quaternion::new(q[*first], q[first + 1], q[first + 2], q[first + 3]);
                    frame *= UnitQuaternion::new_normalize(turn);
                    let axes = [V::x(), V::y(), V::z()].map(|axis| frame.rotation * axis);
                    let rates = before(place(*first + 3));
                    all.extend(axes.into_iter().enumerate().map(|(i, axis)| Screw {
                        axis,
                        point,
                        turns: true,
                        rate: rates + i,
                        speed: 1.0,
                    }));
                }
            }
        }
        all
    };
    body.segments.iter().map(joint).collect()
}

/// Sum over forces of Jacobian columns, the torques of dependent coordinates folded into the independent ones.
fn virtual_work(body: &ModelIr, model: &Model, q: &[f64], loads: &[Load]) -> Vec<f64> {
    let frames = frames(body, q);
    let screws = screws(body, model, &frames, q);
    let mut torques = vec![0.0; model.rates().len()];
    for (segment, x, force, couple) in pulls(body, &frames, loads) {
        let mut next = Some(segment);
        while let Some(s) = next {
            for screw in &screws[s] {
                let power = if screw.turns {
                    screw.axis.cross(&(x - screw.point)).dot(&force) + screw.axis.dot(&couple)
                } else {
                    screw.axis.dot(&force)
                };
                torques[screw.rate] += screw.speed * power;
            }
            next = body.segments[s].parent;
        }
    }
    // The last followers of a chain first.
    let rate_of = |c: usize| model.coordinates()[c].rate.unwrap();
    let value_of =
        |c: usize| q[body.coordinates.iter().position(|own| own.name == model.coordinates()[c].name).unwrap()];
    for coupling in model.couplings().iter().rev() {
        let slope = coupling.function.slope(value_of(coupling.independent));
        let given = std::mem::take(&mut torques[rate_of(coupling.dependent)]);
        torques[rate_of(coupling.independent)] += slope * given;
    }
    torques
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(1e-3, |most: f64, v| most.max(v.abs()))
}

struct Statics<'a> {
    model: &'a Model,
    kinematics: Kinematics,
    external: ExternalTorque,
}

impl Statics<'_> {
    fn torques(&mut self, posture: &Posture, loads: &[Load]) -> &[f64] {
        self.kinematics.update(self.model, posture).unwrap();
        self.external.update(self.model, &self.kinematics, loads).unwrap();
        self.external.torques()
    }
}

#[test]
fn torque_and_gradient_two_ways() {
    let mut rng = random();
    for (name, body) in bodies() {
        let model = body.model().unwrap().model;
        let n = model.rates().len();
        let mut statics =
            Statics { model: &model, kinematics: Kinematics::new(&model), external: ExternalTorque::new(&model) };
        let mut gradient = Gradient::new(&model);
        let (mut work, mut slope, mut pairs) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut ratios = (f64::INFINITY, 0.0_f64);
        for round in 0..10_000 {
            let (at, loads) = (posture(&model, &mut rng), loads(&body, &mut rng));
            let expected = virtual_work(&body, &model, &of_the_file(&body, &model, at.values()), &loads);
            let torques = statics.torques(&at, &loads).to_vec();
            assert!(torques.iter().chain(&expected).all(|torque| torque.is_finite()), "{name}");
            let size = largest(&expected);
            let error = torques.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            work = work.max(error / size);
            if round % 25 != 0 {
                continue;
            }
            statics.external.gradient(&model, &statics.kinematics, &mut gradient);
            let moved = |rate: usize, h: f64| {
                let (mut step, mut there) = (vec![0.0; n], at.clone());
                step[rate] = h;
                there.displace(&model, &step);
                there
            };
            // Energy of weights and forces of the world.
            let steady: Vec<Load> = loads
                .iter()
                .filter(|l| matches!(l.kind, LoadKind::Weight(_) | LoadKind::Force(_, FixedIn::World)))
                .copied()
                .collect();
            let energy = |posture: &Posture| -> f64 {
                let q = of_the_file(&body, &model, posture.values());
                pulls(&body, &frames(&body, &q), &steady).iter().map(|(_, x, force, _)| -x.dot(force)).sum()
            };
            let leads = |rate: usize| model.rates()[rate].coordinate.is_none_or(|c| !model.is_dependent(c));
            let steady_torques = statics.torques(&at, &steady).to_vec();
            let steady_size = largest(&steady_torques);
            let (mut coarse, mut fine, mut most) = (0.0_f64, 0.0_f64, 1e-3_f64);
            for rate in (0..n).filter(|&rate| leads(rate)) {
                let h = 1e-4;
                let fall = (energy(&moved(rate, -h)) - energy(&moved(rate, h))) / (2.0 * h);
                assert!(fall.is_finite(), "{name}");
                slope = slope.max((fall - steady_torques[rate]).abs() / steady_size);
                let mut differences = |h: f64| -> Vec<f64> {
                    let up = statics.torques(&moved(rate, h), &loads).to_vec();
                    let down = statics.torques(&moved(rate, -h), &loads);
                    up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * h)).collect()
                };
                let [near, two, one] = [1e-5, 1e-2, 5e-3].map(&mut differences);
                for row in (0..n).filter(|&row| leads(row)) {
                    let exact = gradient.get(row, rate);
                    assert!([exact, near[row], two[row], one[row]].iter().all(|x| x.is_finite()), "{name}");
                    most = most.max(exact.abs());
                    pairs = pairs.max((exact - near[row]).abs() / size.max(most));
                    coarse += (exact - two[row]).powi(2);
                    fine += (exact - one[row]).powi(2);
                }
            }
            let ratio = (coarse / fine).sqrt();
            ratios = (ratios.0.min(ratio), ratios.1.max(ratio));
        }
        println!(
            "{name}: {n} rates; virtual work {work:.1e}, energy {slope:.1e}, gradient {pairs:.1e}, halved step: error falls by {:.3}..{:.3}",
            ratios.0, ratios.1
        );
        assert!(work < 1e-12 && slope < 1e-7 && pairs < 1e-7, "{name}");
        // Differences that reach over a knot of a spline see its third derivative jump.
        let smooth = !format!("{body:?}").contains("Spline");
        assert!(!smooth || (ratios.0 > 3.9 && ratios.1 < 4.1), "{name}");
    }
}
