//! Compares batches with one posture at a time on published models: free and fixed roots, coupled and function-driven coordinates.

use crate::common::shared;

use contrapposto::batch::{Statics, Table, Wanted};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{mjcf, osim, urdf};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Largest difference, by the largest number of its kind.
const ROUNDING: f64 = 1e-12;

fn assert_near(what: &str, found: &[f64], expected: &[f64]) {
    let size = expected.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= ROUNDING * size);
    assert!(near && found.len() == expected.len(), "{what}: {found:?} in a batch, {expected:?} alone");
}

fn compare(name: &str, model: &Model) {
    let mut random = Pcg64Mcg::new(7);
    let mut value = |c: &contrapposto::model::Coordinate| random.random_range(c.range.0.max(-3.0)..=c.range.1.min(3.0));
    let postures: Vec<Posture> =
        (0..203).map(|_| Posture::new(model.coordinates().iter().map(&mut value).collect())).collect();
    let mut table = Table::of_postures(model, postures.len());
    postures.iter().enumerate().for_each(|(i, posture)| table.set_posture(i, posture.values()));
    let last = model.segments().len() - 1;
    let point = Vector3::new(0.02, -0.05, 0.01);
    let force = |segment, fixed| Load { segment, point, kind: LoadKind::Force(Vector3::new(10.0, -20.0, 30.0), fixed) };
    let wanted = Wanted { placements: vec![last], active_torque: true, gradient: true };
    let mut statics = Statics::new(model, wanted).unwrap();
    let (mut alone, n) = (JointTorques::new(model), model.rates().len());
    for loads in [vec![], vec![force(last, FixedIn::World), force(last / 2, FixedIn::Segment)]] {
        statics.update(model, &table, &loads, 2).unwrap();
        let rows = |row: &dyn Fn(usize) -> Vec<f64>| (0..n).map(row).collect::<Vec<_>>();
        let torques = rows(&|rate| statics.external_torque(rate).collect());
        let active = rows(&|rate| statics.active_torque(rate).collect());
        let slopes = rows(&|rate| statics.gradient(rate, rate).collect());
        for (i, posture) in postures.iter().enumerate() {
            alone.update(model, posture, &loads, Quantities::ALL).unwrap();
            let of = |rows: &[Vec<f64>]| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
            assert_near(name, &of(&torques), alone.external_torque().torques());
            assert_near(name, &of(&active), alone.active_torque());
            let expected: Vec<f64> = (0..n).map(|rate| alone.gradient().get(rate, rate)).collect();
            assert_near(name, &of(&slopes), &expected);
            let (_, origin) = statics.placement(0, i);
            let expected = alone.kinematics().placement(model, last).translation.vector;
            assert_near(name, origin.as_slice(), expected.as_slice());
            let center = alone.center_of_mass().position().unwrap();
            assert_near(name, statics.center_of_mass(i).unwrap().as_slice(), center.as_slice());
        }
    }
    println!("{name}: {n} rates, {} postures agree", postures.len());
}

#[test]
#[ignore = "needs ../shared: published models"]
fn published_models_in_a_batch_agree_with_one_posture_at_a_time() {
    for dof in ["48", "66"] {
        for root in [RootAttachment::Free, RootAttachment::Fixed] {
            let path = format!("models/human-gazebo/humanSubject01_{dof}dof.urdf");
            let options = urdf::Options { root, ..urdf::Options::default() };
            let read = urdf::read(&std::fs::read(shared::shared(&path)).unwrap(), &path, &options).unwrap();
            compare(&path, &read.model().unwrap().model);
        }
        let path = format!("models/human-gazebo/human{dof}_free.mjcf.xml");
        let read = mjcf::read(
            &std::fs::read(shared::shared(&path)).unwrap(),
            &path,
            &mut |name| Err(format!("no file {name}")),
            &mjcf::Options::default(),
        )
        .unwrap();
        compare(&path, &read.model().unwrap().model);
    }
    for file in ["arm26.osim", "gait2392_thelen2003muscle.osim"] {
        let path = format!("models/opensim/{file}");
        let read = osim::read(&std::fs::read(shared::shared(&path)).unwrap(), &path).unwrap();
        compare(&path, &read.model().unwrap().model);
    }
}
