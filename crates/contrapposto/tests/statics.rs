//! Compares external torque and its gradient for every pair of joints with independent computations.
//!
//! Random trees of every joint kind, with forward kinematics and Jacobians of the test's own: frames composed segment by
//! segment, columns by `r x (x - p)`. Three derivations must agree: the crate's recursion, the virtual-work sum, and
//! differences of energy and torque. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{
    Adult, CoordinateSpec, JointKind, LARGEST, Model, ModelBuilder, ModelError, Motion, Placement, SegmentSpec, adult,
};
use contrapposto::posture::{Posture, PostureError};
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadError, LoadKind};
use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

fn vector(rng: &mut Pcg64, size: f64) -> V {
    V::from_fn(|_, _| rng.random_range(-size..size))
}

fn unit(rng: &mut Pcg64) -> Unit<V> {
    loop {
        let v = vector(rng, 1.0);
        if v.norm() > 0.1 {
            return Unit::new_normalize(v);
        }
    }
}

fn turn(rng: &mut Pcg64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(unit(rng).into_inner() * rng.random_range(0.0..3.1))
}

fn place(rng: &mut Pcg64) -> Placement {
    let shift = vector(rng, 0.3);
    match rng.random_range(0..4) {
        0 => Placement::identity(),
        1 => Placement::from_parts(shift.into(), UnitQuaternion::identity()),
        _ => Placement::from_parts(shift.into(), turn(rng)),
    }
}

/// Joints and loads that a tree may have.
#[derive(Clone, Copy, PartialEq)]
enum Kinds {
    All,
    /// Hinges and slides, alone or in chains.
    Axes,
    /// Hinges only.
    Hinges,
}

/// A model with the specs it was built from, for the test's own kinematics.
struct Tree {
    model: Model,
    specs: Vec<SegmentSpec>,
    parents: Vec<Option<usize>>,
    gravity: V,
}

fn joint(rng: &mut Pcg64, kinds: Kinds) -> JointKind {
    let hinge = |rng: &mut Pcg64| Motion::Hinge(unit(rng));
    let choice = match kinds {
        Kinds::Hinges => [0, 1, 3, 4][rng.random_range(0..4)],
        Kinds::Axes => [0, 1, 1, 2, 3, 4, 5][rng.random_range(0..7)],
        Kinds::All => rng.random_range(0..10),
    };
    match choice {
        0 => JointKind::Weld,
        1 => JointKind::Hinge(unit(rng)),
        2 => JointKind::Slide(unit(rng)),
        3 => JointKind::Universal([unit(rng), unit(rng)]),
        4 => JointKind::Gimbal([unit(rng), unit(rng), unit(rng)]),
        5 => JointKind::Chain(vec![hinge(rng), Motion::Slide(unit(rng)), hinge(rng), Motion::Slide(unit(rng))]),
        6 => JointKind::Ball,
        7 => JointKind::Free,
        8 => JointKind::Chain(vec![Motion::Slide(unit(rng)), Motion::Ball, hinge(rng)]),
        _ => JointKind::Chain(vec![hinge(rng), Motion::Ball, Motion::Slide(unit(rng))]),
    }
}

fn tree(rng: &mut Pcg64, kinds: Kinds, coordinates: usize) -> Tree {
    let gravity = vector(rng, 10.0);
    let mut builder = ModelBuilder::new("random", gravity);
    let (mut specs, mut parents): (Vec<SegmentSpec>, Vec<Option<usize>>) = (vec![], vec![]);
    let mut count = 0;
    while count < coordinates {
        let kind = joint(rng, kinds);
        let motions = kind.motions();
        let more = motions.iter().map(|m| m.coordinates()).sum::<usize>();
        if count + more > coordinates {
            continue;
        }
        count += more;
        let n = specs.len();
        // Mostly the newest segment, so that chains are long; sometimes any, so that they branch; rarely ground.
        let parent = match rng.random_range(0..20) {
            _ if n == 0 => None,
            0 => None,
            1..=4 => Some(rng.random_range(0..n)),
            _ => Some(n - 1),
        };
        let names = motions.iter().enumerate().filter(|(_, m)| **m != Motion::Ball);
        let spec = SegmentSpec {
            name: format!("segment{n}"),
            parent: parent.map(|p| format!("segment{p}")),
            mass: if rng.random_range(0..4) == 0 { 0.0 } else { rng.random_range(0.1..5.0) },
            center_of_mass: vector(rng, 0.3),
            inertia: Matrix3::identity(),
            joint: format!("joint{n}"),
            coordinates: names.map(|(i, _)| CoordinateSpec::new(&format!("q{n}_{i}"), (-9.0, 9.0))).collect(),
            kind,
            in_parent: place(rng),
            in_segment: place(rng),
        };
        builder.segment(spec.clone()).unwrap();
        specs.push(spec);
        parents.push(parent);
    }
    Tree { model: builder.build(), specs, parents, gravity }
}

fn posture(rng: &mut Pcg64, tree: &Tree) -> Posture {
    let mut values = vec![];
    for motion in tree.specs.iter().flat_map(|s| s.kind.motions()) {
        match motion {
            Motion::Hinge(_) => values.push(rng.random_range(-3.0..3.0)),
            Motion::Slide(_) => values.push(rng.random_range(-0.4..0.4)),
            Motion::Ball => {
                // Any length: the crate normalises.
                let q = turn(rng).into_inner() * rng.random_range(0.5..2.0);
                values.extend([q.w, q.i, q.j, q.k]);
            }
        }
    }
    Posture::new(values)
}

fn loads(rng: &mut Pcg64, tree: &Tree, pure_world_forces: bool) -> Vec<Load> {
    let mut loads = vec![];
    for _ in 0..rng.random_range(0..12) {
        let segment = rng.random_range(0..tree.specs.len());
        for _ in 0..rng.random_range(1..3) {
            let kind = match rng.random_range(0..if pure_world_forces { 2 } else { 5 }) {
                0 => LoadKind::Weight(rng.random_range(0.0..10.0)),
                1 => LoadKind::Force(vector(rng, 80.0), FixedIn::World),
                2 => LoadKind::Force(vector(rng, 80.0), FixedIn::Segment),
                3 => LoadKind::Couple(vector(rng, 20.0), FixedIn::World),
                _ => LoadKind::Couple(vector(rng, 20.0), FixedIn::Segment),
            };
            loads.push(Load { segment, point: vector(rng, 0.5), kind });
        }
    }
    loads
}

/// One rate in ground: axis, a point on it, and whether it turns.
#[derive(Clone, Copy)]
struct Screw {
    axis: V,
    point: V,
    turns: bool,
}

impl Screw {
    /// Velocity of a carried point.
    fn column(&self, x: V) -> V {
        if self.turns { self.axis.cross(&(x - self.point)) } else { self.axis }
    }
}

/// The test's own kinematics: frame of every segment, every rate, and which rates move which segment.
struct Frames {
    segments: Vec<Isometry3<f64>>,
    screws: Vec<Screw>,
    movers: Vec<Vec<usize>>,
}

fn frames(tree: &Tree, values: &[f64]) -> Frames {
    let mut out = Frames { segments: vec![], screws: vec![], movers: vec![] };
    let mut values = values.iter().copied();
    let mut next = || values.next().unwrap();
    for (spec, parent) in tree.specs.iter().zip(&tree.parents) {
        let (mut frame, mut movers) = match parent {
            None => (spec.in_parent, vec![]),
            Some(p) => (out.segments[*p] * spec.in_parent, out.movers[*p].clone()),
        };
        for motion in spec.kind.motions() {
            let first = out.screws.len();
            match motion {
                Motion::Hinge(axis) => {
                    let point = frame.translation.vector;
                    out.screws.push(Screw { axis: frame.rotation * axis.into_inner(), point, turns: true });
                    frame *= UnitQuaternion::from_axis_angle(&axis, next());
                }
                Motion::Slide(axis) => {
                    let point = frame.translation.vector;
                    out.screws.push(Screw { axis: frame.rotation * axis.into_inner(), point, turns: false });
                    frame *= Translation3::from(axis.into_inner() * next());
                }
                Motion::Ball => {
                    let [w, i, j, k] = [next(), next(), next(), next()];
                    frame *= UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
                    let point = frame.translation.vector;
                    for axis in [V::x(), V::y(), V::z()] {
                        out.screws.push(Screw { axis: frame.rotation * axis, point, turns: true });
                    }
                }
            }
            movers.extend(first..out.screws.len());
        }
        out.segments.push(frame * spec.in_segment.inverse());
        out.movers.push(movers);
    }
    out
}

/// Everything that pulls, in ground: segment, point, force, couple. Weights of segments included.
fn pulls(tree: &Tree, frames: &Frames, loads: &[Load]) -> Vec<(usize, V, V, V)> {
    let own =
        tree.specs.iter().enumerate().map(|(s, spec)| (s, spec.center_of_mass, spec.mass * tree.gravity, V::zeros()));
    let given = loads.iter().map(|load| {
        let rotation = frames.segments[load.segment].rotation;
        let (force, couple) = match load.kind {
            LoadKind::Weight(mass) => (mass * tree.gravity, V::zeros()),
            LoadKind::Force(force, FixedIn::World) => (force, V::zeros()),
            LoadKind::Force(force, FixedIn::Segment) => (rotation * force, V::zeros()),
            LoadKind::Couple(couple, FixedIn::World) => (V::zeros(), couple),
            LoadKind::Couple(couple, FixedIn::Segment) => (V::zeros(), rotation * couple),
        };
        (load.segment, load.point, force, couple)
    });
    own.chain(given).map(|(s, x, f, c)| (s, (frames.segments[s] * nalgebra::Point3::from(x)).coords, f, c)).collect()
}

/// Sum over loads and segments of Jacobian column times force.
fn virtual_work(tree: &Tree, values: &[f64], loads: &[Load]) -> Vec<f64> {
    let frames = frames(tree, values);
    let mut torques = vec![0.0; frames.screws.len()];
    for (segment, x, force, couple) in pulls(tree, &frames, loads) {
        for &rate in &frames.movers[segment] {
            let screw = frames.screws[rate];
            torques[rate] += screw.column(x).dot(&force) + if screw.turns { screw.axis.dot(&couple) } else { 0.0 };
        }
    }
    torques
}

/// The posture moved by `h` along one rate; balls turn about their own axes.
fn moved(tree: &Tree, posture: &Posture, rate: usize, h: f64) -> Posture {
    let mut values = posture.values().to_vec();
    let (mut coordinate, mut first) = (0, 0);
    for motion in tree.specs.iter().flat_map(|s| s.kind.motions()) {
        if (first..first + motion.rates()).contains(&rate) {
            if motion == Motion::Ball {
                let v = &mut values[coordinate..coordinate + 4];
                let q = UnitQuaternion::from_quaternion(Quaternion::new(v[0], v[1], v[2], v[3]));
                let q = q * UnitQuaternion::from_scaled_axis(V::ith(rate - first, h));
                v.copy_from_slice(&[q.w, q.i, q.j, q.k]);
            } else {
                values[coordinate] += h;
            }
        }
        coordinate += motion.coordinates();
        first += motion.rates();
    }
    Posture::new(values)
}

/// Results of the crate.
struct Statics {
    kinematics: Kinematics,
    external: ExternalTorque,
    gradient: Gradient,
}

impl Statics {
    fn new(model: &Model) -> Self {
        let gradient = Gradient::new(model);
        Self { kinematics: Kinematics::new(model), external: ExternalTorque::new(model), gradient }
    }

    fn at(model: &Model, posture: &Posture, loads: &[Load]) -> Self {
        let mut statics = Self::new(model);
        statics.update(model, posture, loads);
        statics
    }

    fn update(&mut self, model: &Model, posture: &Posture, loads: &[Load]) {
        self.kinematics.update(model, posture).unwrap();
        self.external.update(model, &self.kinematics, loads).unwrap();
        self.external.gradient(model, &self.kinematics, &mut self.gradient);
    }

    fn bits(&self) -> Vec<u64> {
        let n = self.gradient.size();
        let entries = (0..n).flat_map(|row| self.gradient.row(row));
        self.external.torques().iter().chain(entries).map(|x| x.to_bits()).collect()
    }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| f64::max(a, b.abs()))
}

#[test]
fn torque_equals_virtual_work() {
    let mut rng = random("torque_equals_virtual_work");
    let mut worst = 0.0;
    let mut rates = 0;
    for round in 0..1000 {
        let coordinates = if round % 2 == 0 { 60 } else { rng.random_range(1..60) };
        let tree = tree(&mut rng, Kinds::All, coordinates);
        for _ in 0..10 {
            let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, false));
            let expected = virtual_work(&tree, posture.values(), &loads);
            let mut statics = Statics::new(&tree.model);
            statics.kinematics.update(&tree.model, &posture).unwrap();
            statics.external.update(&tree.model, &statics.kinematics, &loads).unwrap();
            let error = largest(statics.external.torques().iter().zip(&expected).map(|(a, b)| a - b));
            worst = f64::max(worst, error / largest(expected.iter().copied()).max(1e-3));
            rates += expected.len();
        }
    }
    println!("10000 postures, {rates} torques: worst relative difference {worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
}

#[test]
fn torque_is_minus_the_slope_of_potential_energy() {
    let mut rng = random("torque_is_minus_the_slope_of_potential_energy");
    let mut worst = 0.0;
    let h = 1e-4;
    for _ in 0..2000 {
        let tree = tree(&mut rng, Kinds::All, 60);
        let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, true));
        let energy = |posture: &Posture| -> f64 {
            let frames = frames(&tree, posture.values());
            pulls(&tree, &frames, &loads).iter().map(|(_, x, f, _)| -x.dot(f)).sum()
        };
        let statics = Statics::at(&tree.model, &posture, &loads);
        let scale = largest(statics.external.torques().iter().copied()).max(1e-3);
        for (rate, torque) in statics.external.torques().iter().enumerate() {
            let (up, down) = (moved(&tree, &posture, rate, h), moved(&tree, &posture, rate, -h));
            let slope = (energy(&up) - energy(&down)) / (2.0 * h);
            worst = f64::max(worst, (torque + slope).abs() / scale);
        }
    }
    println!("2000 trees, step {h}: worst relative difference {worst:.1e}");
    assert!(worst < 1e-7, "{worst:e}");
}

/// Greatest and root-mean-square error of the gradient against differences with step `h`.
fn gradient_errors(tree: &Tree, posture: &Posture, loads: &[Load], statics: &Statics, h: f64) -> (f64, f64) {
    let n = tree.model.rates().len();
    let (mut worst, mut squares) = (0.0, 0.0);
    for column in 0..n {
        let [up, down] = [h, -h].map(|h| Statics::at(&tree.model, &moved(tree, posture, column, h), loads));
        for row in 0..n {
            let slope = (up.external.torques()[row] - down.external.torques()[row]) / (2.0 * h);
            let error = statics.gradient.get(row, column) - slope;
            worst = f64::max(worst, error.abs());
            squares += error * error;
        }
    }
    (worst, f64::sqrt(squares))
}

#[test]
fn gradient_of_all_pairs() {
    let mut rng = random("gradient_of_all_pairs");
    let (mut worst, mut pairs) = (0.0, 0);
    let mut ratios = vec![];
    for round in 0..500 {
        let coordinates = if round % 4 == 0 { 60 } else { rng.random_range(5..40) };
        let tree = tree(&mut rng, Kinds::All, coordinates);
        for _ in 0..4 {
            let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, false));
            let statics = Statics::at(&tree.model, &posture, &loads);
            let n = tree.model.rates().len();
            let scale = largest((0..n).flat_map(|row| statics.gradient.row(row).to_vec())).max(1e-3);
            worst = f64::max(worst, gradient_errors(&tree, &posture, &loads, &statics, 1e-4).0 / scale);
            pairs += n * n;
            if round % 4 == 0 {
                let coarse = gradient_errors(&tree, &posture, &loads, &statics, 1e-2).1;
                let fine = gradient_errors(&tree, &posture, &loads, &statics, 5e-3).1;
                if coarse > 0.0 {
                    ratios.push(coarse / fine);
                }
            }
        }
    }
    let (low, high) = ratios.iter().fold((f64::MAX, 0f64), |(low, high), &r| (low.min(r), high.max(r)));
    println!(
        "2000 postures, {pairs} pairs: worst relative difference {worst:.1e}; halved step: error falls by {low:.3}..{high:.3}"
    );
    assert!(worst < 1e-7, "{worst:e}");
    assert!(low > 3.9 && high < 4.1, "{low} {high}");
}

/// Eq. 8 read literally, for every pair.
fn eq_8(tree: &Tree, frames: &Frames, loads: &[Load], l: usize, j: usize) -> f64 {
    let carried = pulls(tree, frames, loads).into_iter().filter(|(s, ..)| frames.movers[*s].contains(&l));
    carried.map(|(_, x, f, _)| frames.screws[l].column(x).dot(&f.cross(&frames.screws[j].axis))).sum()
}

#[test]
fn eq_8_as_printed_is_right_toward_the_root_only() {
    let mut rng = random("eq_8_as_printed_is_right_toward_the_root_only");
    let (mut toward, mut swapped, mut beyond, mut across) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..100 {
        let tree = tree(&mut rng, Kinds::Hinges, 40);
        let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, true));
        let statics = Statics::at(&tree.model, &posture, &loads);
        let frames = frames(&tree, posture.values());
        let n = frames.screws.len();
        // `j` moves `l` if some segment that `l` moves is moved by `j` earlier in its list.
        let near = |j: usize, l: usize| {
            let place = |m: &Vec<usize>, rate| m.iter().position(|&r| r == rate);
            frames.movers.iter().any(|m| matches!((place(m, j), place(m, l)), (Some(a), Some(b)) if a <= b))
        };
        for l in 0..n {
            for j in 0..n {
                let right = statics.gradient.get(l, j);
                let error = |value: f64| (value - right).abs();
                if near(j, l) {
                    toward = f64::max(toward, error(eq_8(&tree, &frames, &loads, l, j)));
                } else if near(l, j) {
                    beyond = f64::max(beyond, error(eq_8(&tree, &frames, &loads, l, j)));
                    swapped = f64::max(swapped, error(eq_8(&tree, &frames, &loads, j, l)));
                } else {
                    assert_eq!(right, 0.0);
                    across = f64::max(across, error(eq_8(&tree, &frames, &loads, l, j)));
                }
            }
        }
    }
    println!("Eq. 8, greatest errors in N m/rad: j at l or nearer the root {toward:.1e}; j beyond l {beyond:.0},");
    println!("with the roles of l and j swapped {swapped:.1e}; other branches {across:.0}");
    assert!(toward < 1e-9 && swapped < 1e-9, "{toward:e} {swapped:e}");
    assert!(beyond > 100.0 && across > 100.0, "{beyond} {across}");
}

#[test]
fn eq_8_by_hand() {
    // Planar double pendulum: turning the outer joint moves the outer rod's pull only, so d tau_1/d q_2 is
    // m2 g l2/2 sin(q_1 + q_2). Read literally, Eq. 8 takes the inner joint's whole lever: (m1/2 + m2) g l1 sin(q_1) more.
    let pendulum = pendulum();
    let (m1, m2, l1, l2, g) = PENDULUM;
    for (q_1, q_2) in [(90f64, 0f64), (0.0, 90.0), (30.0, 40.0)] {
        let (q_1, q_2) = (q_1.to_radians(), q_2.to_radians());
        let posture = Posture::new(vec![q_1, q_2]);
        let gradient = Statics::at(&pendulum.model, &posture, &[]).gradient;
        let frames = frames(&pendulum, posture.values());
        let right = m2 * g * l2 / 2.0 * libm::sin(q_1 + q_2);
        let too_much = (m1 / 2.0 + m2) * g * l1 * libm::sin(q_1);
        for (given, expected) in [
            (gradient.get(0, 1), right),
            (gradient.get(1, 0), right),
            (eq_8(&pendulum, &frames, &[], 1, 0), right),
            (eq_8(&pendulum, &frames, &[], 0, 1), right + too_much),
        ] {
            assert!((given - expected).abs() < 1e-12, "{given} {expected}");
        }
    }
}

#[test]
fn symmetric_for_axes_and_world_forces() {
    let mut rng = random("symmetric_for_axes_and_world_forces");
    let mut entries = 0;
    for _ in 0..300 {
        let tree = tree(&mut rng, Kinds::Axes, 60);
        let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, true));
        let gradient = Statics::at(&tree.model, &posture, &loads).gradient;
        for row in 0..gradient.size() {
            for column in 0..row {
                assert_eq!(gradient.get(row, column).to_bits(), gradient.get(column, row).to_bits());
                entries += 1;
            }
        }
    }
    println!("{entries} pairs equal to the bit");
}

#[test]
fn own_slope_is_the_diagonal() {
    let mut rng = random("own_slope_is_the_diagonal");
    let mut worst = 0.0;
    for _ in 0..300 {
        let tree = tree(&mut rng, Kinds::All, 60);
        let (posture, loads) = (posture(&mut rng, &tree), loads(&mut rng, &tree, false));
        let statics = Statics::at(&tree.model, &posture, &loads);
        for rate in 0..statics.gradient.size() {
            let slope = statics.external.own_slope(&statics.kinematics, &tree.model, rate);
            let difference = (slope - statics.gradient.get(rate, rate)).abs();
            worst = f64::max(worst, difference / slope.abs().max(1.0));
        }
    }
    println!("worst relative difference {worst:.1e}");
    assert!(worst < 1e-13, "{worst:e}");
}

#[test]
fn update_has_no_memory() {
    let mut rng = random("update_has_no_memory");
    for _ in 0..100 {
        let tree = tree(&mut rng, Kinds::All, 60);
        let (first, few) = (posture(&mut rng, &tree), loads(&mut rng, &tree, false));
        let (second, many) = (posture(&mut rng, &tree), loads(&mut rng, &tree, false));
        let fresh = Statics::at(&tree.model, &first, &few).bits();
        let mut used = Statics::at(&tree.model, &second, &many);
        used.update(&tree.model, &first, &few);
        assert_eq!(used.bits(), fresh);
        used.update(&tree.model, &first, &few);
        assert_eq!(used.bits(), fresh);
        // A refused update changes nothing.
        let bad = Load { segment: tree.specs.len(), point: V::zeros(), kind: LoadKind::Weight(1.0) };
        used.external.update(&tree.model, &used.kinematics, &[few.clone(), vec![bad]].concat()).unwrap_err();
        used.kinematics.update(&tree.model, &Posture::new(vec![])).unwrap_err();
        used.external.gradient(&tree.model, &used.kinematics, &mut used.gradient);
        assert_eq!(used.bits(), fresh);
    }
}

#[test]
fn kinematics_agrees_with_plain_composition() {
    let mut rng = random("kinematics_agrees_with_plain_composition");
    let mut worst = 0.0;
    for _ in 0..200 {
        let tree = tree(&mut rng, Kinds::All, 60);
        let mut posture = posture(&mut rng, &tree);
        for value in posture.values_mut() {
            // Half turns are where reading a rotation from its matrix is hardest.
            if rng.random_range(0..5) == 0 {
                *value = std::f64::consts::PI;
            }
        }
        let kinematics = Statics::at(&tree.model, &posture, &[]).kinematics;
        let frames = frames(&tree, posture.values());
        let (mut mass, mut moment) = (0.0, V::zeros());
        for (s, frame) in frames.segments.iter().enumerate() {
            let given = kinematics.placement(&tree.model, s);
            let x = vector(&mut rng, 1.0);
            let direction = frame.rotation * x;
            let station = direction + frame.translation.vector;
            let errors = [
                (given.translation.vector - frame.translation.vector).norm(),
                given.rotation.angle_to(&frame.rotation).min(given.rotation.rotation_to(&frame.rotation).angle()),
                (kinematics.station(&tree.model, s, x) - station).norm(),
                (kinematics.direction(&tree.model, s, x) - direction).norm(),
                (given * nalgebra::Point3::from(x) - nalgebra::Point3::from(station)).norm(),
            ];
            worst = f64::max(worst, largest(errors));
            mass += tree.specs[s].mass;
            moment += tree.specs[s].mass * (frame * nalgebra::Point3::from(tree.specs[s].center_of_mass)).coords;
        }
        match kinematics.center_of_mass(&tree.model) {
            Some(center) => worst = f64::max(worst, (center - moment / mass).norm()),
            None => assert_eq!(mass, 0.0),
        }
        for (rate, screw) in frames.screws.iter().enumerate() {
            worst = f64::max(worst, (kinematics.axis(&tree.model, rate) - screw.axis).norm());
        }
    }
    println!("worst difference {worst:.1e} (m, rad)");
    // Angles between nearly equal quaternions are only good to the root of the rounding error.
    assert!(worst < 1e-7, "{worst:e}");
}

#[test]
fn placement_of_a_half_turn() {
    let mut rng = random("placement_of_a_half_turn");
    for _ in 0..1000 {
        let axis = unit(&mut rng);
        let mut builder = ModelBuilder::new("one hinge", V::zeros());
        builder.segment(one_segment(JointKind::Hinge(axis))).unwrap();
        let model = builder.build();
        let statics = Statics::at(&model, &Posture::new(vec![std::f64::consts::PI]), &[]);
        let given = statics.kinematics.placement(&model, 0).rotation.to_rotation_matrix();
        let right = Rotation3::from_axis_angle(&axis, std::f64::consts::PI);
        assert!((given.into_inner() - right.into_inner()).norm() < 1e-14);
    }
}

fn one_segment(kind: JointKind) -> SegmentSpec {
    let axes = kind.motions().iter().filter(|m| **m != Motion::Ball).count();
    SegmentSpec {
        name: "body".to_owned(),
        parent: None,
        mass: 2.0,
        center_of_mass: V::new(0.5, 0.0, 0.0),
        inertia: Matrix3::identity(),
        joint: "root".to_owned(),
        kind,
        in_parent: Placement::identity(),
        in_segment: Placement::identity(),
        coordinates: (0..axes).map(|i| CoordinateSpec::new(&format!("q{i}"), (-10.0, 10.0))).collect(),
    }
}

fn one_body(kind: JointKind, gravity: V) -> Model {
    let mut builder = ModelBuilder::new("one body", gravity);
    builder.segment(one_segment(kind)).unwrap();
    builder.build()
}

/// Masses (kg), lengths (m), gravity (m/s^2).
const PENDULUM: (f64, f64, f64, f64, f64) = (2.0, 3.0, 0.4, 0.7, 9.81);

/// Two uniform rods in the x-y plane, level at zero, turning about z; gravity along -y.
fn pendulum() -> Tree {
    let (m1, m2, l1, l2, g) = PENDULUM;
    let gravity = V::new(0.0, -g, 0.0);
    let mut builder = ModelBuilder::new("pendulum", gravity);
    let rod = |name: &str, parent: Option<&str>, mass, length: f64, at| SegmentSpec {
        name: name.to_owned(),
        parent: parent.map(str::to_owned),
        mass,
        center_of_mass: V::new(length / 2.0, 0.0, 0.0),
        joint: format!("joint_{name}"),
        kind: JointKind::Hinge(V::z_axis()),
        in_parent: Placement::translation(at, 0.0, 0.0),
        coordinates: vec![CoordinateSpec::new(&format!("q_{name}"), (-9.0, 9.0))],
        ..one_segment(JointKind::Weld)
    };
    let specs = vec![rod("inner", None, m1, l1, 0.0), rod("outer", Some("inner"), m2, l2, l1)];
    for spec in &specs {
        builder.segment(spec.clone()).unwrap();
    }
    Tree { model: builder.build(), specs, parents: vec![None, Some(0)], gravity }
}

#[test]
fn planar_double_pendulum() {
    let mut rng = random("planar_double_pendulum");
    let tree = pendulum();
    let (m1, m2, l1, l2, g) = PENDULUM;
    for _ in 0..1000 {
        let (a, b) = (rng.random_range(-3.1..3.1), rng.random_range(-3.1..3.1));
        let (held, force) = (rng.random_range(0.0..5.0), rng.random_range(-50.0..50.0));
        let loads = [
            Load { segment: 1, point: V::new(l2, 0.0, 0.0), kind: LoadKind::Weight(held) },
            // A thruster at the tip, square to the outer rod, and a pull along ground x at the inner rod's tip.
            Load {
                segment: 1,
                point: V::new(l2, 0.0, 0.0),
                kind: LoadKind::Force(V::new(0.0, force, 0.0), FixedIn::Segment),
            },
            Load {
                segment: 0,
                point: V::new(l1, 0.0, 0.0),
                kind: LoadKind::Force(V::new(force, 0.0, 0.0), FixedIn::World),
            },
        ];
        let statics = Statics::at(&tree.model, &Posture::new(vec![a, b]), &loads);
        // V = m1 g l1/2 sin a + m2 g (l1 sin a + l2/2 sin(a+b)) + held g (l1 sin a + l2 sin(a+b)) - F l1 cos a
        let inner = g * l1 * (m1 / 2.0 + m2 + held);
        let outer = g * l2 * (m2 / 2.0 + held);
        let tau_2 = -outer * libm::cos(a + b) + force * l2;
        let tau_1 = -inner * libm::cos(a) - outer * libm::cos(a + b) - force * l1 * libm::sin(a)
            + force * (l2 + l1 * libm::cos(b));
        let d11 = inner * libm::sin(a) + outer * libm::sin(a + b) - force * l1 * libm::cos(a);
        let d12 = outer * libm::sin(a + b) - force * l1 * libm::sin(b);
        let d2 = outer * libm::sin(a + b);
        let expected = [tau_1, tau_2, d11, d12, d2, d2];
        let gradient = &statics.gradient;
        let given = [
            statics.external.torques()[0],
            statics.external.torques()[1],
            gradient.get(0, 0),
            gradient.get(0, 1),
            gradient.get(1, 0),
            gradient.get(1, 1),
        ];
        for (given, expected) in given.into_iter().zip(expected) {
            assert!((given - expected).abs() < 1e-11, "{given} {expected}");
        }
    }
}

#[test]
fn adult_elbow_with_the_upper_arm_horizontal() {
    let model = adult(&Adult::right_arm()).unwrap();
    let (flex, elbow) = (model.coordinate("arm_flex_r").unwrap(), model.coordinate("elbow_flex_r").unwrap());
    let mut posture = model.default_posture();
    posture.values_mut()[flex] = 90f64.to_radians();
    let rate = model.coordinates()[elbow].rate.unwrap();
    let mut peak = 0.0;
    for degrees in 0..=150 {
        let theta = f64::from(degrees).to_radians();
        posture.values_mut()[elbow] = theta;
        let statics = Statics::at(&model, &posture, &[]);
        let torque = statics.external.torques()[rate];
        if degrees == 0 {
            peak = torque;
        }
        assert!((torque - peak * libm::cos(theta)).abs() < 1e-12, "{degrees} deg: {torque}");
        let slope = statics.external.own_slope(&statics.kinematics, &model, rate);
        assert!((slope + peak * libm::sin(theta)).abs() < 1e-12, "{degrees} deg: slope {slope}");
    }
    println!("elbow torque, forearm level: {peak:.4} N m");
    assert!((peak + 2.90).abs() < 0.005);
    assert!((peak + 1.628 * 0.1815 * 9.81).abs() < 0.005);
}

#[test]
fn slide_that_carries_a_weight() {
    // A slide 30 deg above the horizontal carries 2 kg and 3 kg more: -(2 + 3) g sin 30, wherever it stands.
    let axis = Unit::new_normalize(V::new(libm::cos(30f64.to_radians()), libm::sin(30f64.to_radians()), 0.0));
    let model = one_body(JointKind::Slide(axis), V::new(0.0, -9.81, 0.0));
    for position in [-2.0, 0.0, 0.3] {
        let load = Load { segment: 0, point: V::new(0.1, 0.2, 0.3), kind: LoadKind::Weight(3.0) };
        let statics = Statics::at(&model, &Posture::new(vec![position]), &[load]);
        assert!((statics.external.torques()[0] + 5.0 * 9.81 / 2.0).abs() < 1e-13);
        assert_eq!(statics.gradient.get(0, 0), 0.0);
        assert_eq!(statics.external.own_slope(&statics.kinematics, &model, 0), 0.0);
    }
}

#[test]
fn ball_by_hand() {
    // 2 kg, 0.5 m along body x from a ball; gravity along ground -y. Torques are about body axes.
    let model = one_body(JointKind::Ball, V::new(0.0, -9.81, 0.0));
    let statics = Statics::at(&model, &Posture::new(vec![2.0, 0.0, 0.0, 0.0]), &[]);
    let mgc = 2.0 * 9.81 * 0.5;
    assert_eq!(statics.external.torques(), [0.0, 0.0, -mgc]);
    // About y by any angle gravity keeps its body direction, -y, and so the torque -m g c about body z.
    let q = UnitQuaternion::from_axis_angle(&V::y_axis(), std::f64::consts::FRAC_PI_2);
    let turned = Statics::at(&model, &Posture::new(vec![q.w, q.i, q.j, q.k]), &[]);
    for (given, expected) in turned.external.torques().iter().zip([0.0, 0.0, -mgc]) {
        assert!((given - expected).abs() < 1e-14);
    }
    // About body x by 90 deg: gravity along body +z; the moment lies along body -y.
    let q = UnitQuaternion::from_axis_angle(&V::x_axis(), std::f64::consts::FRAC_PI_2);
    let rolled = Statics::at(&model, &Posture::new(vec![q.w, q.i, q.j, q.k]), &[]);
    for (given, expected) in rolled.external.torques().iter().zip([0.0, -mgc, 0.0]) {
        assert!((given - expected).abs() < 1e-14);
    }
    // So row y changes by -m g c along x; row x never changes, as the arm lies along it: not symmetric.
    assert!((statics.gradient.get(1, 0) + mgc).abs() < 1e-14);
    assert_eq!(statics.gradient.get(0, 1), 0.0);
}

#[test]
fn bad_segments_are_refused_by_name() {
    let build = |gravity: V, change: &dyn Fn(&mut SegmentSpec)| {
        let mut spec = one_segment(JointKind::Free);
        change(&mut spec);
        ModelBuilder::new("one", gravity).segment(spec)
    };
    let g = V::new(0.0, -9.81, 0.0);
    build(g, &|_| ()).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1.1 * LARGEST] {
        let errors = [
            ("gravity", build(V::new(0.0, bad, 0.0), &|_| ())),
            ("mass", build(g, &|s| s.mass = bad)),
            ("centre of mass", build(g, &|s| s.center_of_mass.y = bad)),
            ("inertia", build(g, &|s| s.inertia[(1, 2)] = bad)),
            ("in the parent", build(g, &|s| s.in_parent.translation.z = bad)),
            ("in the segment", build(g, &|s| s.in_segment.translation.x = bad)),
            (
                "quaternion",
                build(g, &|s| s.in_parent.rotation = Unit::new_unchecked(Quaternion::new(bad, 0.0, 0.0, 0.0))),
            ),
            ("axis", build(g, &|s| s.kind = JointKind::Gimbal([Unit::new_unchecked(V::new(0.0, bad, 0.0)); 3]))),
            (
                "default",
                build(g, &|s| {
                    (s.coordinates[1].range, s.coordinates[1].default) = ((f64::NEG_INFINITY, f64::INFINITY), bad)
                }),
            ),
        ];
        for (what, result) in errors {
            let error = result.expect_err(what);
            assert!(matches!(error, ModelError::Number { .. }), "{what}: {error}");
            let text = error.to_string();
            assert!(text.contains(what) && !text.contains("NaN at"), "{what}: {text}");
        }
    }
    let text = |change: &dyn Fn(&mut SegmentSpec)| build(g, change).unwrap_err().to_string();
    assert_eq!(text(&|s| s.mass = -1.0), "mass (kg) of `body` is -1; it must be between 0 and 1e9");
    assert!(text(&|s| s.parent = Some("nobody".to_owned())).contains("`nobody`"));
    assert!(text(&|s| s.coordinates.clear()).contains("has 0 coordinates; its kind needs 3"));
    assert!(text(&|s| s.coordinates[2].name = "q0".to_owned()).contains("`q0`"));
    assert!(text(&|s| s.coordinates[0].range = (1.0, -1.0)).contains("lower limit of the range of `q0`"));
    assert!(text(&|s| s.coordinates[0].range = (f64::NAN, 1.0)).contains("`q0`"));
    assert!(text(&|s| s.coordinates[0].default = 11.0).contains("default of `q0` is 11"));
    assert!(text(&|s| s.kind = JointKind::Slide(Unit::new_unchecked(V::zeros()))).contains("axis of `body` is 0"));
    // Two balls would share their names.
    assert!(
        text(&|s| (s.kind, s.coordinates) = (JointKind::Chain(vec![Motion::Ball; 2]), vec![])).contains("`root_qw`")
    );
    let mut builder = ModelBuilder::new("twice", g);
    builder.segment(one_segment(JointKind::Weld)).unwrap();
    assert!(builder.segment(one_segment(JointKind::Weld)).unwrap_err().to_string().contains("`body`"));
    assert_eq!(builder.build().segments().len(), 1);
}

#[test]
fn bad_postures_are_refused_by_name() {
    let model = one_body(JointKind::Free, V::new(0.0, -9.81, 0.0));
    let mut kinematics = Kinematics::new(&model);
    let good = [0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0];
    kinematics.update(&model, &Posture::new(good.to_vec())).unwrap();
    for (i, name) in ["q0", "q1", "q2", "root_qw", "root_qx", "root_qy", "root_qz"].into_iter().enumerate() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1.1 * LARGEST] {
            let mut values = good.to_vec();
            values[i] = bad;
            let error = kinematics.update(&model, &Posture::new(values)).unwrap_err();
            assert!(matches!(error, PostureError::NotFinite { .. }));
            assert!(error.to_string().contains(&format!("`{name}`")), "{error}");
        }
    }
    for values in [vec![], good[..6].to_vec(), [&good[..], &[0.0]].concat()] {
        let error = kinematics.update(&model, &Posture::new(values)).unwrap_err();
        assert!(error.to_string().contains("the model has 7 coordinates"), "{error}");
    }
    let error = kinematics.update(&model, &Posture::new(vec![0.0; 7])).unwrap_err();
    assert!(matches!(error, PostureError::Quaternion { .. }) && error.to_string().contains("`root_qw`"), "{error}");
}

#[test]
fn bad_loads_are_refused_by_name() {
    let model = one_body(JointKind::Free, V::new(0.0, -9.81, 0.0));
    let kinematics = Kinematics::new(&model);
    let mut external = ExternalTorque::new(&model);
    let mut refuse = |segment, point, kind| {
        let error = external.update(&model, &kinematics, &[Load { segment, point, kind }]).unwrap_err();
        error.to_string()
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1.1 * LARGEST] {
        for axis in 0..3 {
            let v = V::ith(axis, bad);
            assert!(refuse(0, v, LoadKind::Weight(1.0)).starts_with("point (m) of a load is "));
            for fixed in [FixedIn::World, FixedIn::Segment] {
                assert!(refuse(0, V::zeros(), LoadKind::Force(v, fixed)).starts_with("force (N) of a load is "));
                assert!(refuse(0, V::zeros(), LoadKind::Couple(v, fixed)).starts_with("couple (N m) of a load is "));
            }
        }
        assert!(refuse(0, V::zeros(), LoadKind::Weight(bad)).starts_with("mass (kg) of a load is "));
    }
    assert_eq!(
        refuse(0, V::zeros(), LoadKind::Weight(-1.0)),
        "mass (kg) of a load is -1; it must be between 0 and 1e9"
    );
    let text = "load on segment number 7; the model has 1 segments";
    assert_eq!(refuse(7, V::zeros(), LoadKind::Weight(1.0)), text);
    assert_eq!(Load::weight(&model, 7, 1.0).check(&model), Err(LoadError::Segment { segment: 7, count: 1 }));
    assert_eq!(Load::weight(&model, 0, 1.0).point, V::new(0.5, 0.0, 0.0));
}

#[test]
fn the_largest_numbers_give_finite_results() {
    // The greatest accepted, the least subnormal and minus zero, in every field at once.
    let mut rng = random("the_largest_numbers_give_finite_results");
    for size in [LARGEST, -LARGEST, f64::from_bits(1), -0.0] {
        for _ in 0..20 {
            let random = tree(&mut rng, Kinds::All, 60);
            let all = V::repeat(size);
            let mut builder = ModelBuilder::new("large", all);
            for spec in random.specs {
                let mut spec = SegmentSpec { mass: size.abs(), center_of_mass: all, ..spec };
                spec.in_parent.translation.vector = all;
                spec.in_segment.translation.vector = all;
                builder.segment(spec).unwrap();
            }
            let model = builder.build();
            let values = model.coordinates().iter().map(|c| if c.name.ends_with("qw") { 1.0 } else { size });
            let posture = Posture::new(values.collect());
            let loads: Vec<_> = (0..model.segments().len())
                .flat_map(|segment| {
                    let kinds = [FixedIn::World, FixedIn::Segment]
                        .into_iter()
                        .flat_map(|fixed| [LoadKind::Force(all, fixed), LoadKind::Couple(all, fixed)])
                        .chain([LoadKind::Weight(size.abs())]);
                    kinds.map(move |kind| Load { segment, point: all, kind })
                })
                .collect();
            let statics = Statics::at(&model, &posture, &loads);
            assert!(statics.bits().iter().all(|b| f64::from_bits(*b).is_finite()));
            assert!(statics.kinematics.center_of_mass(&model).is_none_or(|c| c.iter().all(|x| x.is_finite())));
            let slope = |rate| statics.external.own_slope(&statics.kinematics, &model, rate);
            assert!((0..model.rates().len()).all(|rate| slope(rate).is_finite()));
        }
    }
}
