//! Random bodies of every joint kind, driven joints and couplings included, shared by the tests of Jacobians and of tasks.
use contrapposto::fatigue::FatigueLaw;
use contrapposto::math::Function;
use contrapposto::model::{
    CoordinateKind, CoordinateSpec, Drive, JointKind, Model, ModelBuilder, Motion, MuscleGroup, Placement, SegmentSpec,
};
use contrapposto::passive::{Coupled, CoupledTerm, PassiveLaw, RienerEdrich1999, Term};
use contrapposto::posture::Posture;
use contrapposto::strength::{EVERY_ANGLE, Strength};
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub type V = Vector3<f64>;

/// The generator of a test; its seed is printed, and `CONTRAPPOSTO_SEED` chooses another one.
pub fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

pub fn vector(rng: &mut Pcg64, size: f64) -> V {
    V::from_fn(|_, _| rng.random_range(-size..size))
}

pub fn unit(rng: &mut Pcg64) -> Unit<V> {
    loop {
        let v = vector(rng, 1.0);
        if v.norm() > 0.1 {
            return Unit::new_normalize(v);
        }
    }
}

pub fn turn(rng: &mut Pcg64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(unit(rng).into_inner() * rng.random_range(0.0..3.1))
}

fn place(rng: &mut Pcg64) -> Placement {
    Placement::from_parts(vector(rng, 0.3).into(), turn(rng))
}

fn function(rng: &mut Pcg64) -> Function {
    match rng.random_range(0..3) {
        0 => Function::Linear { slope: rng.random_range(-1.2..1.2), intercept: rng.random_range(-0.3..0.3) },
        _ => Function::Polynomial((0..4).map(|i| rng.random_range(-0.8..0.8) / f64::from(1 << i)).collect()),
    }
}

/// A joint and its coordinates, which are named after `n`.
fn joint(rng: &mut Pcg64, n: usize) -> (JointKind, Vec<CoordinateSpec>) {
    let kind = match rng.random_range(0..11) {
        0 => JointKind::Weld,
        1 | 2 => JointKind::Hinge(unit(rng)),
        3 => JointKind::Slide(unit(rng)),
        4 => JointKind::Universal([unit(rng), unit(rng)]),
        5 => JointKind::Gimbal([unit(rng), unit(rng), unit(rng)]),
        6 => JointKind::Ball,
        7 => JointKind::Free,
        8 => JointKind::Chain(vec![Motion::Slide(unit(rng)), Motion::Ball, Motion::Hinge(unit(rng))]),
        _ => {
            // Two coordinates, an angle and a distance, move up to five axes; one stands still.
            let motions = (0..rng.random_range(2..6)).map(|i| {
                let axis = unit(rng);
                let motion = if i % 3 == 1 { Motion::Slide(axis) } else { Motion::Hinge(axis) };
                let drive = match rng.random_range(0..6) {
                    0 => Drive::Fixed(rng.random_range(-1.0..1.0)),
                    1 => Drive::Coordinate(rng.random_range(0..2)),
                    _ => Drive::Function(function(rng), rng.random_range(0..2)),
                };
                (motion, drive)
            });
            let kind = JointKind::Driven(motions.collect());
            let mut specs: Vec<_> = (0..2).map(|i| CoordinateSpec::new(&format!("q{n}_{i}"), (-9.0, 9.0))).collect();
            specs[1].kind = CoordinateKind::Translation;
            return (kind, specs);
        }
    };
    let names = kind.motions().into_iter().enumerate().filter(|(_, m)| *m != Motion::Ball);
    let specs = names.map(|(i, _)| CoordinateSpec::new(&format!("q{n}_{i}"), (-9.0, 9.0))).collect();
    (kind, specs)
}

/// A body with some massless segments, branches, sometimes several roots, and (if `coupled`) coordinates that follow others.
pub fn tree(rng: &mut Pcg64, segments: usize, coupled: bool) -> Model {
    let mut builder = ModelBuilder::new("random", vector(rng, 10.0));
    let mut names = vec![];
    for n in 0..segments {
        let (kind, coordinates) = joint(rng, n);
        // Mostly the newest segment, so that chains are long; sometimes any, so that they branch; rarely ground.
        let parent = match rng.random_range(0..20) {
            _ if n == 0 => None,
            0 => None,
            1..=4 => Some(rng.random_range(0..n)),
            _ => Some(n - 1),
        };
        names.extend(coordinates.iter().map(|c| c.name.clone()));
        let spec = SegmentSpec {
            name: format!("segment{n}"),
            parent: parent.map(|p| format!("segment{p}")),
            mass: if rng.random_range(0..4) == 0 { 0.0 } else { rng.random_range(0.1..5.0) },
            center_of_mass: vector(rng, 0.3),
            inertia: Matrix3::from_diagonal(&V::new(0.9, 1.0 + 0.1 * (n % 4) as f64, 1.1)),
            joint: format!("joint{n}"),
            kind,
            in_parent: place(rng),
            in_segment: place(rng),
            coordinates,
        };
        builder.segment(spec).unwrap();
    }
    if coupled {
        // Pairs that would make a circle or a second coupling of one coordinate are refused, which is as good.
        for _ in 0..names.len() / 4 {
            let pick = |rng: &mut Pcg64| names[rng.random_range(0..names.len())].clone();
            let (dependent, independent) = (pick(rng), pick(rng));
            let _ = builder.couple(&dependent, &independent, function(rng));
        }
    }
    builder.build()
}

/// A step of rates.
pub fn step(rng: &mut Pcg64, model: &Model, size: f64) -> Vec<f64> {
    model.rates().iter().map(|_| rng.random_range(-size..size)).collect()
}

/// Anywhere within two radians (half a metre) of the default; quaternions of any length.
pub fn posture(rng: &mut Pcg64, model: &Model) -> Posture {
    let mut posture = model.default_posture();
    let step: Vec<f64> =
        model.rates().iter().map(|r| rng.random_range(-1.0..1.0) * if r.rotational { 2.0 } else { 0.5 }).collect();
    posture.displace(model, &step);
    for i in 0..model.coordinates().len() {
        if model.coordinates()[i].name.ends_with("_qw") {
            let length = rng.random_range(0.5..2.0);
            posture.values_mut()[i..i + 4].iter_mut().for_each(|v| *v *= length);
        }
    }
    posture
}

/// The posture moved by `h` along one rate.
pub fn moved(model: &Model, posture: &Posture, rate: usize, h: f64) -> Posture {
    let (mut posture, mut step) = (posture.clone(), vec![0.0; model.rates().len()]);
    step[rate] = h;
    posture.displace(model, &step);
    posture
}

/// Root of the sum of squares.
pub fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| if b.is_nan() { b } else { f64::max(a, b.abs()) })
}

/// Passive laws, single and coupled, and muscle groups for most coordinates that have a torque.
pub fn with_muscles(rng: &mut Pcg64, mut model: Model, fatigue: &FatigueLaw) -> Model {
    let torqued: Vec<usize> =
        (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].rate.is_some()).collect();
    for &i in &torqued {
        let law = match rng.random_range(0..4) {
            0 => None,
            1 => {
                let mut neighbours = [0; 3].map(|_| {
                    let sign = if rng.random_range(0..2) == 0 { -1.0 } else { 1.0 };
                    (rng.random_range(0..4) > 0).then(|| (torqued[rng.random_range(0..torqued.len())], sign))
                });
                let joint = rng.random_range(0..3);
                neighbours[joint] = Some((i, if rng.random_range(0..2) == 0 { -1.0 } else { 1.0 }));
                let terms = (0..2).map(|k| CoupledTerm {
                    sign: if k == 0 { 1.0 } else { -1.0 },
                    c0: rng.random_range(-1.0..1.5),
                    rates: [0; 3].map(|_| rng.random_range(-0.8..0.8)),
                });
                let terms = terms.collect();
                let law = RienerEdrich1999 { joint, terms, constant: rng.random_range(-3.0..3.0) };
                Some(PassiveLaw::Coupled(Coupled { law, neighbours }))
            }
            _ => Some(PassiveLaw::Sum(vec![
                Term::Spring { stiffness: rng.random_range(0.0..5.0), rest: rng.random_range(-1.0..1.0) },
                Term::Polynomial { coefficients: vec![rng.random_range(-2.0..2.0), 0.3, 0.1], rest: 0.2 },
            ])),
        };
        model = model.with_passive_law(i, law);
        if rng.random_range(0..5) > 0 {
            let mut group = |name: &str| MuscleGroup {
                name: name.to_owned(),
                strength: Strength {
                    peak: rng.random_range(5.0..200.0),
                    best: rng.random_range(-1.0..1.0),
                    narrowness: [0.0, rng.random_range(0.2..1.2)][rng.random_range(0..2)],
                    floor: rng.random_range(0.05..0.5),
                    tested: EVERY_ANGLE,
                    table: None,
                },
                fatigue: fatigue.clone(),
            };
            model = model.with_groups(i, [group("up"), group("down")]);
        }
    }
    model
}
