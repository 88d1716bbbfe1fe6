//! Times muscles in random postures on files of the reader's own, for scripts/muscle_times.py: `muscle_times MODEL.osim|MODEL.xml COUNT` prints a line for each
//! quantity and posture, with its name and microseconds: `paths` (kinematics, lengths and all moment arms), `equilibria` (one a
//! muscle, at an activation of 0.5), and of an OpenSim model `static` (static optimisation from the
//! start, its own weight the load) and `reactions` (force and moment of all joints).

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a measurement without its files has nothing to measure")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use contrapposto::joint_torques::{JointReactions, PathForces};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::{PathGeometry, PathRule, Recruitment, StaticOptimisation};
use contrapposto::posture::Posture;
use contrapposto::statics::ExternalTorque;
use contrapposto_formats::model_ir::Imported;
use contrapposto_formats::{mjcf, osim};
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

fn read(file: &str) -> Imported {
    let bytes = std::fs::read(file).unwrap();
    if !file.ends_with(".xml") {
        return osim::read(&bytes, file).unwrap().model().unwrap();
    }
    let folder = Path::new(file).parent().unwrap();
    let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|error| error.to_string());
    let options = mjcf::Options { omit_mesh_mass: true, ..Default::default() };
    mjcf::read(&bytes, file, &mut include, &options).unwrap().model().unwrap()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = &arguments[..] else { panic!("MODEL COUNT are needed") };
    let imported = read(file);
    let (model, muscles) = (&imported.model, &imported.muscles);
    let mut rng = Pcg64::new(19, 0);
    let (mut kinematics, mut geometry) = (Kinematics::new(model), PathGeometry::new(model, &muscles.paths));
    let mut external = ExternalTorque::new(model);
    let mut reactions = JointReactions::new(model, muscles);
    let rates = geometry.crossed(model);
    let bounds = vec![(0.01, 1.0); muscles.muscles.len()];
    let reserves = vec![1.0; rates.len()];
    let mut forces = vec![0.0; muscles.muscles.len()];
    let mut torques = vec![0.0; rates.len()];
    let postures: Vec<Posture> = (0..count.parse().unwrap()).map(|_| random(&mut rng, model)).collect();
    // The first round over all postures warms memory up; each posture follows another one.
    for (posture, counts) in [false, true].iter().flat_map(|counts| postures.iter().map(move |of| (of, *counts))) {
        let said = |kind: &str, start: Instant| {
            if counts {
                println!("{kind} {:.3}", 1e6 * start.elapsed().as_secs_f64());
            }
        };
        let start = Instant::now();
        kinematics.update(model, posture).unwrap();
        geometry.update(model, &kinematics, &muscles.paths, PathRule::Geodesic);
        said("paths", start);
        let start = Instant::now();
        for (force, muscle) in forces.iter_mut().zip(&muscles.muscles) {
            *force = muscle.at_rest(geometry.lengths()[muscle.spec().path], 0.5).tendon_force;
        }
        said("equilibria", start);
        black_box(&forces);
        if file.ends_with(".xml") {
            continue;
        }
        external.update(model, &kinematics, &[]).unwrap();
        for (torque, &rate) in torques.iter_mut().zip(&rates) {
            *torque = -external.torques()[rate];
        }
        for (force, muscle) in forces.iter_mut().zip(&muscles.muscles) {
            *force = muscle.at_rest_on_rigid_tendon(geometry.lengths()[muscle.spec().path], 1.0).active_force;
        }
        let asked =
            Recruitment { rates: &rates, torques: &torques, reserves: &reserves, forces: &forces, bounds: &bounds };
        // From the start: the answer to another posture is no start here.
        let mut optimisation = StaticOptimisation::default();
        let start = Instant::now();
        optimisation.solve(muscles, &geometry, &asked).unwrap();
        said("static", start);
        black_box(optimisation.activations());
        let tensions: Vec<f64> = optimisation.activations().iter().zip(&forces).map(|(a, force)| a * force).collect();
        let start = Instant::now();
        reactions
            .update(model, &kinematics, &[], PathForces { muscles, geometry: &geometry, tensions: &tensions })
            .unwrap();
        said("reactions", start);
    }
}
