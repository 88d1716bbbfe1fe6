//! Measures lengths with moment arms, and equilibria of fibres and tendons, of the muscles of published models in the folder that
//! CONTRAPPOSTO_OPENSIM_MODELS names, and of MyoSuite's legs in the checkout that CONTRAPPOSTO_MYO_SIM names: random postures, one core.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark without its models has nothing to measure"
)]

use std::hint::black_box;
use std::path::PathBuf;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::{FiberState, PathGeometry, PathRule};
use contrapposto::posture::Posture;
use contrapposto_formats::model_ir::Imported;
use contrapposto_formats::{mjcf, osim};
use criterion::{Criterion, criterion_group, criterion_main};
use rand::RngExt;
use rand_pcg::Pcg64;

/// Inside of the ranges, at most 1 from the default.
fn random(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.0), c.range.1.min(c.default + 1.0));
        if c.locked || low > high { c.default } else { low + rng.random_range(0.0..=1.0) * (high - low) }
    });
    Posture::new(values.collect())
}

/// The model's body and muscles under the rules that its paths may follow.
fn measure(criterion: &mut Criterion, name: &str, imported: &Imported, rules: &[PathRule]) {
    let (model, muscles) = (&imported.model, &imported.muscles);
    let mut rng = Pcg64::new(19, 0);
    let postures: Vec<Posture> = (0..100).map(|_| random(&mut rng, model)).collect();
    let (mut kinematics, mut geometry) = (Kinematics::new(model), PathGeometry::new(model, &muscles.paths));
    for &rule in rules {
        let mut next = 0;
        criterion.bench_function(&format!("{name}: lengths and moment arms, {rule:?}"), |bencher| {
            bencher.iter(|| {
                next = (next + 1) % postures.len();
                kinematics.update(model, &postures[next]).unwrap();
                geometry.update(model, &kinematics, &muscles.paths, rule);
                black_box(geometry.lengths());
            });
        });
    }
    let lengths: Vec<Vec<f64>> = postures
        .iter()
        .map(|posture| {
            kinematics.update(model, posture).unwrap();
            geometry.update(model, &kinematics, &muscles.paths, PathRule::Geodesic);
            geometry.lengths().to_vec()
        })
        .collect();
    let mut next = 0;
    criterion.bench_function(&format!("{name}: equilibria"), |bencher| {
        bencher.iter(|| {
            next = (next + 1) % postures.len();
            let forces: f64 = muscles
                .muscles
                .iter()
                .map(|muscle| {
                    let state: FiberState = muscle.at_rest(lengths[next][muscle.spec().path], 0.5);
                    state.tendon_force
                })
                .sum();
            black_box(forces)
        });
    });
}

fn folder(variable: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        println!("{variable} names no folder: its models are not measured");
    }
    folder
}

fn muscles(criterion: &mut Criterion) {
    if let Some(folder) = folder("CONTRAPPOSTO_OPENSIM_MODELS") {
        for name in ["Rajagopal2016", "mobl2016_v01", "arm26"] {
            let bytes = std::fs::read(folder.join(format!("{name}.osim"))).unwrap();
            let imported = osim::read(&bytes, name).unwrap().model().unwrap();
            measure(criterion, name, &imported, &[PathRule::Geodesic, PathRule::OpenSim]);
        }
    }
    if let Some(folder) = folder("CONTRAPPOSTO_MYO_SIM") {
        let path = folder.join("leg/myolegs.xml");
        let above = path.parent().unwrap();
        let mut include = |name: &str| std::fs::read(above.join(name)).map_err(|error| error.to_string());
        let options = mjcf::Options { omit_mesh_mass: true, ..Default::default() };
        let read = mjcf::read(&std::fs::read(&path).unwrap(), "myolegs", &mut include, &options);
        measure(criterion, "myolegs", &read.unwrap().model().unwrap(), &[PathRule::Geodesic]);
    }
}

criterion_group!(benches, muscles);
criterion_main!(benches);
