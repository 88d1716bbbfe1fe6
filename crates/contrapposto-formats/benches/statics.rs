//! Times kinematics, centre of mass, gravity torque, the full gradient and torques with inertia: on the published humans beside the
//! project (the models of the peers' benchmark; left out where they are not there), and on chains of 10 to 1,000 hinges. Batches of
//! postures are timed in one thread and in two.
//!
//! The peer's figures come from its own program in the same run: see docs/benchmarks.md.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

use std::hint::black_box;
use std::path::PathBuf;

use contrapposto::batch::{Statics, Table, Wanted};
use contrapposto::dynamics::Inertia;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, CoordinateSpec, JointKind, Model, ModelBuilder, Placement, SegmentSpec};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{osim, urdf};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{Matrix3, Unit, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Number of random postures, as in the peer's program.
const POSTURES: usize = 256;
/// Postures of batches: in the second-level cache, in the third-level one, in memory.
const BATCHES: [usize; 3] = [256, 16_384, 65_536];

fn postures(model: &Model) -> Vec<Posture> {
    let mut random = Pcg64Mcg::new(7);
    let mut draw = |c: &contrapposto::model::Coordinate| match c.kind {
        CoordinateKind::Rotation => random.random_range(c.range.0.max(-1.5)..=c.range.1.min(1.5)),
        _ => random.random_range(-1.0..=1.0),
    };
    (0..POSTURES).map(|_| Posture::new(model.coordinates().iter().map(&mut draw).collect())).collect()
}

/// Inverse dynamics: from values, speeds and accelerations to torques.
fn bench_inertia(c: &mut Criterion, name: &str, model: &Model) {
    let postures = postures(model);
    let (mut kinematics, mut external) = (Kinematics::new(model), ExternalTorque::new(model));
    let mut inertia = Inertia::new(model);
    let rates = (vec![0.3; model.rates().len()], vec![0.1; model.rates().len()]);
    let mut next = postures.iter().cycle();
    c.bench_function(&format!("dynamics/{name}"), |b| {
        b.iter(|| {
            kinematics.update(model, next.next().expect("cycle")).expect("a posture of the model");
            inertia.update(model, &kinematics, (&rates.0, &rates.1), &[]).expect("rates of the model");
            inertia.external_torque(model, &kinematics, &[], &mut external).expect("no loads");
            black_box(external.torques())[0]
        });
    });
}

/// The walking body of OpenSim's tutorials, whose peer is timed by scripts/inverse_dynamics_peer.py.
fn walker(c: &mut Criterion) {
    let file = "../../../shared/models/opensim/gait2392_thelen2003muscle.osim";
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(file);
    let Ok(bytes) = std::fs::read(path) else {
        println!("gait2392: left out, its file is not on this machine");
        return;
    };
    let model = osim::read(&bytes, file).expect("a model file").model().expect("a model").model;
    bench_inertia(c, "gait2392", &model);
}

fn bench_model(c: &mut Criterion, name: &str, model: &Model, loads: &[Load]) {
    let postures = postures(model);
    let mut kinematics = Kinematics::new(model);
    let mut external = ExternalTorque::new(model);
    let mut gradient = Gradient::new(model);
    let mut group = c.benchmark_group(format!("statics/{name}"));
    let mut next = postures.iter().cycle();
    group.bench_function("kinematics", |b| {
        b.iter(|| kinematics.update(model, next.next().expect("cycle")).expect("a posture of the model"));
    });
    let mut next = postures.iter().cycle();
    group.bench_function("kinematics + centre of mass + gravity torque", |b| {
        b.iter(|| {
            kinematics.update(model, next.next().expect("cycle")).expect("a posture of the model");
            external.update(model, &kinematics, &[]).expect("no loads");
            (external.center_of_mass().position(), black_box(external.torques())[0])
        });
    });
    let mut next = postures.iter().cycle();
    group.bench_function("the same with two forces + full gradient", |b| {
        b.iter(|| {
            kinematics.update(model, next.next().expect("cycle")).expect("a posture of the model");
            external.update(model, &kinematics, loads).expect("checked loads");
            external.gradient(model, &kinematics, &mut gradient);
            black_box(gradient.get(0, 0))
        });
    });
    group.finish();
    bench_batch(c, name, model, loads);
}

/// The throughput is that of postures.
fn bench_batch(c: &mut Criterion, name: &str, model: &Model, loads: &[Load]) {
    let single = postures(model);
    let mut group = c.benchmark_group(format!("statics/{name}/batch"));
    for count in BATCHES {
        let mut table = Table::of_postures(model, count);
        (0..count).for_each(|i| table.set_posture(i, single[i % POSTURES].values()));
        group.throughput(Throughput::Elements(count as u64));
        let mut bench = |what: &str, wanted: Wanted, loads: &[Load], threads: usize| {
            let mut statics = Statics::new(model, wanted).expect("segments of the model");
            let id = BenchmarkId::new(format!("{what}, {threads} threads"), count);
            group.bench_function(id, |b| {
                b.iter(|| {
                    statics.update(model, black_box(&table), loads, threads).expect("postures of the model");
                    black_box(statics.center_of_mass(count - 1))
                });
            });
        };
        for threads in [1, 2] {
            bench("kinematics + centre of mass + gravity torque", Wanted::default(), &[], threads);
        }
        bench("the same with two forces", Wanted::default(), loads, 1);
        if count == POSTURES {
            bench("with active torque", Wanted { active_torque: true, ..Wanted::default() }, &[], 1);
            bench("with two forces + full gradient", Wanted { gradient: true, ..Wanted::default() }, loads, 1);
        }
    }
    group.finish();
}

fn humans(c: &mut Criterion) {
    for dof in ["48", "66"] {
        let file = format!("../../../shared/models/human-gazebo/humanSubject01_{dof}dof.urdf");
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(&file);
        let Ok(bytes) = std::fs::read(path) else {
            println!("human{dof}: left out, its file is not on this machine");
            continue;
        };
        for (root, word) in [(RootAttachment::Free, "free"), (RootAttachment::Fixed, "fixed")] {
            let options = urdf::Options { root, ..urdf::Options::default() };
            let model = urdf::read(&bytes, &file, &options).expect("a URDF").model().expect("a model").model;
            let hand = |name: &str| model.segment(name).expect("a hand");
            let force = |segment, f| Load {
                segment,
                point: Vector3::new(0.0, 0.0, 0.05),
                kind: LoadKind::Force(f, FixedIn::World),
            };
            let loads = [
                force(hand("RightHand"), Vector3::new(10.0, -20.0, 30.0)),
                force(hand("LeftHand"), Vector3::new(-5.0, 15.0, -25.0)),
            ];
            bench_model(c, &format!("human{dof} {word}"), &model, &loads);
            bench_inertia(c, &format!("human{dof} {word}"), &model);
        }
    }
}

/// A chain of hinges about turning axes.
fn chain(n: usize) -> Model {
    let mut builder = ModelBuilder::new("chain", Vector3::new(0.0, -9.81, 0.0));
    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    for i in 0..n {
        let axis: Unit<Vector3<f64>> = axes[i % 3];
        let spec = SegmentSpec {
            name: format!("s{i}"),
            parent: i.checked_sub(1).map(|p| format!("s{p}")),
            mass: 1.0,
            center_of_mass: Vector3::new(0.05, 0.0, 0.0),
            inertia: Matrix3::identity(),
            joint: format!("j{i}"),
            kind: JointKind::Hinge(axis),
            in_parent: Placement::translation(0.1, 0.0, 0.0),
            in_segment: Placement::identity(),
            coordinates: vec![CoordinateSpec::new(&format!("q{i}"), (-1.0, 1.0))],
        };
        builder.segment(spec).expect("a link");
    }
    builder.build()
}

fn growth(c: &mut Criterion) {
    let mut group = c.benchmark_group("statics/chain of hinges, torque + gradient");
    for n in [10, 30, 100, 300, 1000] {
        let model = chain(n);
        let posture = Posture::new(vec![0.1; n]);
        let mut kinematics = Kinematics::new(&model);
        let mut external = ExternalTorque::new(&model);
        let mut gradient = Gradient::new(&model);
        group.bench_with_input(BenchmarkId::from_parameter(n), &n, |b, _| {
            b.iter(|| {
                kinematics.update(&model, &posture).expect("a posture");
                external.update(&model, &kinematics, &[]).expect("no loads");
                external.gradient(&model, &kinematics, &mut gradient);
                black_box(gradient.get(0, 0))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, humans, walker, growth);
criterion_main!(benches);
