//! Compares lengths, moment arms and forces of muscles with MuJoCo's, of published models that are not in this project.

use crate::common::shared;

use std::io::Read;
use std::path::{Path, PathBuf};

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::{Musculature, PathGeometry, PathRule};
use contrapposto_formats::mjcf;
use contrapposto_formats::model_ir::ModelIr;
use serde_json::Value;

/// The models of the vectors, and where they are in myo_sim.
const MODELS: [(&str, &str); 6] = [
    ("myolegs", "leg/myolegs.xml"),
    ("myoarm", "arm/myoarm.xml"),
    ("myohand", "hand/myohand.xml"),
    ("myoelbow", "elbow/myoelbow_2dof6muscles.xml"),
    ("myobody", "body/myobody.xml"),
    ("myotorso", "torso/myotorso.xml"),
];

fn read(file: &str) -> ModelIr {
    let folder = std::env::var_os("CONTRAPPOSTO_MYO_SIM").expect("CONTRAPPOSTO_MYO_SIM names a checkout of myo_sim");
    let path = PathBuf::from(folder).join(file);
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let above = path.parent().unwrap();
    let mut include = |name: &str| std::fs::read(above.join(name)).map_err(|error| error.to_string());
    mjcf::read(&bytes, file, &mut include, &mjcf::Options { omit_mesh_mass: true, ..Default::default() })
        .unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn json(path: &Path) -> Value {
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path).unwrap()).read_to_string(&mut text).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn names(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

/// The largest error of a kind, and where it is.
#[derive(Debug, Default)]
struct Worst(f64, String);

impl Worst {
    fn take(&mut self, error: f64, at: impl FnOnce() -> String) {
        if error.is_nan() || error.abs() > self.0 {
            (self.0, self.1) = (error.abs(), at());
        }
    }
}

/// Errors of lengths (m), moment arms (m), and forces (relative).
#[derive(Debug, Default)]
struct Errors {
    length: Worst,
    arm: Worst,
    /// Of tendons that pass through a surface.
    inside_arm: Worst,
    gain: Worst,
    bias: Worst,
    /// Of tendons that pass through a surface.
    inside_bias: Worst,
}

struct Comparison<'a> {
    model: Model,
    muscles: Musculature,
    theirs: &'a Value,
}

impl Comparison<'_> {
    /// Errors in all postures, of which the values are those of all coordinates in the file's order.
    fn errors(&self, order: &[String]) -> Errors {
        let mut errors = Errors::default();
        let mut kinematics = Kinematics::new(&self.model);
        let mut geometry = PathGeometry::new(&self.model, &self.muscles.paths);
        for (number, theirs) in self.theirs["postures"].as_array().unwrap().iter().enumerate() {
            let mut posture = self.model.default_posture();
            let qpos = numbers(&theirs["qpos"]);
            assert_eq!(qpos.len(), order.len());
            for (name, value) in order.iter().zip(&qpos) {
                posture.values_mut()[self.model.coordinate(name).unwrap()] = *value;
            }
            kinematics.update(&self.model, &posture).unwrap();
            geometry.update(&self.model, &kinematics, &self.muscles.paths, PathRule::Geodesic);
            self.compare(&geometry, theirs, number, &mut errors);
        }
        errors
    }

    /// Whether a tendon passes through a surface. MuJoCo stops its search of the point there at an error of 1e-6 rad, so that its tension is
    /// out of balance by up to a millionth.
    fn passes_inside(&self, path: usize) -> bool {
        let paths = &self.muscles.paths;
        paths.paths[path].tendon.iter().flat_map(|tendon| &tendon.parts).any(|part| {
            let Some((geom, side)) = part.around.and_then(|around| Some((&paths.geoms[around.geom], around.side?)))
            else {
                return false;
            };
            let away = geom.pose.inverse_transform_point(&nalgebra::Point3::from(side.place)).coords.norm();
            side.segment == geom.segment && away < geom.radius
        })
    }

    fn compare(&self, geometry: &PathGeometry, theirs: &Value, number: usize, errors: &mut Errors) {
        let (actuators, muscles) = (names(&self.theirs["actuators"]), &self.theirs["muscles"]);
        let indices: Vec<usize> = muscles.as_array().unwrap().iter().map(|i| i.as_u64().unwrap() as usize).collect();
        assert_eq!(indices.len(), self.muscles.muscles.len(), "all muscles are read");
        let (lengths, gains, biases) =
            (numbers(&theirs["actuator_length"]), numbers(&theirs["gain_full"]), numbers(&theirs["bias_passive"]));
        let mut arms = vec![vec![0.0; self.model.rates().len()]; actuators.len()];
        for entry in theirs["moment"].as_array().unwrap() {
            let [i, v, arm] = numbers(entry)[..] else { panic!("three numbers") };
            arms[i as usize][v as usize] = arm;
        }
        for (at, &i) in indices.iter().enumerate() {
            let muscle = &self.muscles.muscles[at];
            let name = muscle.spec().name.as_str();
            assert_eq!(name, actuators[i]);
            let place = || format!("{name}, posture {number}");
            let length = geometry.lengths()[muscle.spec().path];
            errors.length.take(length - lengths[at], place);
            let inside = self.passes_inside(muscle.spec().path);
            let worst = if inside { &mut errors.inside_arm } else { &mut errors.arm };
            for (ours, (theirs, rate)) in
                geometry.moment_arms(muscle.spec().path).iter().zip(arms[i].iter().zip(self.model.rates()))
            {
                worst.take(ours + theirs, || format!("{}, {}: {ours} for {}", place(), rate.name, -theirs));
            }
            let [rest, full] = [0.0, 1.0].map(|activation| muscle.at_rest(length, activation));
            // A passive force of a millionth of the greatest one begins within a thousandth of the optimal length: below it, rounding of the
            // length of 1e-16 m is more than 1e-10 of the force.
            let bias = if inside { &mut errors.inside_bias } else { &mut errors.bias };
            let floor = 1e-6 * muscle.spec().max_isometric_force;
            let relative = |ours: f64, theirs: f64| (ours + theirs) / theirs.abs().max(floor);
            errors
                .gain
                .take(relative(full.active_force, gains[at]), || format!("{}: {full:?} for {}", place(), gains[at]));
            bias.take(relative(rest.passive_force, biases[at]), || format!("{}: {rest:?} for {}", place(), biases[at]));
        }
    }
}

/// Reads a model, and compares it in all postures of `theirs`.
fn check(name: &str, file: &str, theirs: &Value) {
    let mut body = read(file);
    assert!(body.muscles.tally.0.values().all(|tally| tally.refused == 0), "{name}: {:?}", body.muscles.tally);
    // MuJoCo's postures obey no couplings.
    body.couplings.clear();
    let order: Vec<String> = body.coordinates.iter().map(|coordinate| coordinate.name.clone()).collect();
    let imported = body.model().unwrap();
    let errors = Comparison { model: imported.model, muscles: imported.muscles, theirs }.errors(&order);
    println!("{name}: {errors:#?}");
    assert!(errors.length.0 <= 1e-10, "{name}: {:?}", errors.length);
    assert!(errors.arm.0 <= 1e-9, "{name}: {:?}", errors.arm);
    // A millionth of the tension on a lever of less than half a metre.
    assert!(errors.inside_arm.0 <= 5e-7, "{name}: {:?}", errors.inside_arm);
    assert!(errors.gain.0 <= 1e-10, "{name}: {:?}", errors.gain);
    // The square of that angle in the length, which small passive forces multiply.
    assert!(errors.inside_bias.0 <= 1e-8, "{name}: {:?}", errors.inside_bias);
    assert!(errors.bias.0 <= 1e-10, "{name}: {:?}", errors.bias);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_MYO_SIM: a checkout of MyoSuite's myo_sim; and ../shared: MuJoCo's numbers of its muscles"]
fn muscles_of_myo_sim_are_mujocos() {
    for (name, file) in MODELS {
        check(name, file, &json(&shared(&format!("vectors/muscles/mj_{name}.json.gz"))));
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_MYO_SIM, and CONTRAPPOSTO_MYO_SIM_NUMBERS: the folder that scripts/mujoco_muscles.py writes"]
fn random_postures_of_myo_sim_are_mujocos() {
    let folder = std::env::var_os("CONTRAPPOSTO_MYO_SIM_NUMBERS").expect("CONTRAPPOSTO_MYO_SIM_NUMBERS names a folder");
    let more =
        [("myoelbow_exo", "elbow/myoelbow_1dof6muscles_1dofexo.xml"), ("myolegs_abdomen", "leg/myolegs_abdomen.xml")];
    for (name, file) in MODELS.into_iter().chain(more) {
        let bytes = std::fs::read(PathBuf::from(&folder).join(format!("mj_{name}.json"))).unwrap();
        check(name, file, &serde_json::from_slice(&bytes).unwrap());
    }
}
