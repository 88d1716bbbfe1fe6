//! Reads OpenSim's numbers of the muscles of a model, and compares ours with them.

use std::io::Read;
use std::path::{Path, PathBuf};

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::{FiberLaw, FiberState, Muscle, Musculature, PathGeometry, PathRule};
use contrapposto::posture::Posture;
use contrapposto_formats::osim;
use serde_json::Value;

/// A file of the folder that CONTRAPPOSTO_OPENSIM_MODELS names.
pub fn model_bytes(file: &str) -> Vec<u8> {
    let folder = std::env::var_os("CONTRAPPOSTO_OPENSIM_MODELS").expect("CONTRAPPOSTO_OPENSIM_MODELS names a folder");
    let path = PathBuf::from(folder).join(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A model, and OpenSim's numbers of it.
pub struct Reference {
    pub model: Model,
    pub muscles: Musculature,
    numbers: Value,
}

/// The largest error of a kind, and where it is.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    pub size: f64,
    pub at: String,
}

impl Worst {
    fn take(&mut self, error: f64, at: impl FnOnce() -> String) {
        if error.is_nan() || error.abs() > self.size {
            (self.size, self.at) = (error.abs(), at());
        }
    }
}

/// The largest errors: m, m (N/N for slides), and shares of the greatest isometric force.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    pub muscles: usize,
    pub length: Worst,
    pub arm: Worst,
    pub tendon: Worst,
    pub active: Worst,
    pub passive: Worst,
    /// Difference of the equilibrium's fibre length, m, where OpenSim's is rough.
    pub fiber: Worst,
    pub imbalance: Worst,
}

impl Reference {
    pub fn read(name: &str, bytes: &[u8], vectors: &Path) -> Self {
        let mut text = String::new();
        flate2::read::GzDecoder::new(std::fs::File::open(vectors).unwrap()).read_to_string(&mut text).unwrap();
        let imported = osim::read(bytes, name).unwrap().model().unwrap();
        for (kind, tally) in &imported.muscle_tally.0 {
            println!("{name} {kind}: {} read, {} left out, {} refused", tally.read, tally.left_out, tally.refused);
            tally.reasons.keys().take(3).for_each(|why| println!("    {why}"));
        }
        Self { model: imported.model, muscles: imported.muscles, numbers: serde_json::from_str(&text).unwrap() }
    }

    /// The postures.
    pub fn postures(&self) -> Vec<Posture> {
        let names = strings(&self.numbers["coordinates"]);
        let posture = |theirs: &Value| {
            let mut posture = self.model.default_posture();
            for (name, value) in names.iter().zip(theirs["q"].as_array().unwrap()) {
                let index = self.model.coordinate(name).unwrap_or_else(|| panic!("no coordinate {name}"));
                posture.values_mut()[index] = value.as_f64().unwrap();
            }
            posture
        };
        self.numbers["postures"].as_array().unwrap().iter().map(posture).collect()
    }

    /// The kinds of surfaces of the muscles, each list once.
    pub fn wraps(&self) -> Vec<Vec<String>> {
        let mut all: Vec<_> = self.numbers["wraps"].as_array().unwrap().iter().map(strings).collect();
        all.sort();
        all.dedup();
        all
    }

    /// Errors of the muscles whose surfaces are of these kinds, in this order.
    pub fn errors(&self, rule: PathRule, wraps: &[&str]) -> Errors {
        let names = strings(&self.numbers["muscles"]);
        let own = |name: &String| {
            let found = self.muscles.muscles.iter().find(|muscle| muscle.spec().name == *name);
            found.unwrap_or_else(|| panic!("`{name}` is not read"))
        };
        let chosen: Vec<(usize, &Muscle)> = (0..names.len())
            .filter(|&i| strings(&self.numbers["wraps"][i]) == wraps)
            .map(|i| (i, own(&names[i])))
            .collect();
        let mut errors = Errors { muscles: chosen.len(), ..Errors::default() };
        let mut kinematics = Kinematics::new(&self.model);
        let mut geometry = PathGeometry::new(&self.model, &self.muscles.paths);
        for (number, posture) in self.postures().iter().enumerate() {
            kinematics.update(&self.model, posture).unwrap();
            geometry.update(&self.model, &kinematics, &self.muscles.paths, rule);
            let theirs = &self.numbers["postures"][number];
            for &(i, muscle) in &chosen {
                let place = |what: &str| format!("{}, posture {number}{what}", names[i]);
                let length = geometry.lengths()[muscle.spec().path];
                let reference = theirs["length"][i].as_f64().unwrap();
                errors.length.take(length - reference, || place(""));
                self.arms(&geometry, (i, muscle), theirs, |error, name| errors.arm.take(error, || place(name)));
                forces(muscle, i, reference, theirs, &mut errors, &place);
            }
        }
        errors
    }

    /// Errors of moment arms about coordinates that follow no other.
    fn arms(
        &self,
        geometry: &PathGeometry,
        (i, muscle): (usize, &Muscle),
        theirs: &Value,
        mut take: impl FnMut(f64, &str),
    ) {
        let coordinates = strings(&self.numbers["coordinates"]);
        let arms = geometry.moment_arms(muscle.spec().path);
        // Pairs that do not cross are not in the file. Over several surfaces OpenSim's forces are not in balance, and its arms about joints
        // that the path does not cross are not 0.
        let several = strings(&self.numbers["wraps"][i]).len() > 1;
        let mut known = vec![if several { None } else { Some(0.0) }; arms.len()];
        for (pair, arm) in
            self.numbers["pairs"].as_array().unwrap().iter().zip(theirs["moment_arm"].as_array().unwrap())
        {
            let name = &coordinates[pair[1].as_u64().unwrap() as usize];
            let coordinate = self.model.coordinate(name).unwrap();
            if pair[0].as_u64().unwrap() as usize != i || self.model.is_dependent(coordinate) {
                continue;
            }
            known[self.model.coordinates()[coordinate].rate.unwrap()] = arm.as_f64();
        }
        for ((rate, arm), theirs) in self.model.rates().iter().zip(arms).zip(&known) {
            // Locked coordinates have none.
            let locked = rate.coordinate.is_some_and(|c| self.model.coordinates()[c].locked);
            if let (false, Some(theirs)) = (locked, theirs) {
                take(arm - theirs, &format!(", {}: {arm} for {theirs}", rate.name));
            }
        }
    }
}

fn forces(muscle: &Muscle, i: usize, length: f64, theirs: &Value, errors: &mut Errors, place: &dyn Fn(&str) -> String) {
    let most = muscle.spec().max_isometric_force;
    // OpenSim stops this muscle's search of the equilibrium at an error of a hundredth, and its tendon force does not always belong to
    // its fibre length: only its passive force is that of the length.
    let rough = matches!(muscle.spec().law, FiberLaw::Schutte1993(_));
    for (key, activation) in [("minimum", 0.01), ("full", 1.0)] {
        let state = &theirs[key];
        let number = |what: &str| state[what][i].as_f64();
        let mut ours = muscle.at_rest(length, activation);
        // Where its curve is negative there is no equilibrium.
        if !(rough && ours.passive_force < 0.0) {
            errors.imbalance.take(ours.imbalance, || place(key));
        }
        if let Some(fiber) = number("fiber_length").filter(|_| rough) {
            errors.fiber.take(ours.fiber_length - fiber, || place(key));
            ours = muscle.at_fiber_length(length, fiber, activation);
        }
        let FiberState { tendon_force, active_force, passive_force, fiber_length, .. } = ours;
        let compare = |worst: &mut Worst, ours: f64, what: &str| {
            if let Some(known) = number(what) {
                let fiber = number("fiber_length").unwrap_or(f64::NAN);
                worst.take((ours - known) / most, || {
                    place(&format!(", {key} {what}: {ours} for {known} N, fibre {fiber_length} for {fiber} m"))
                });
            }
        };
        compare(&mut errors.passive, passive_force, "passive_along");
        if !rough {
            compare(&mut errors.tendon, tendon_force, "tendon");
            compare(&mut errors.active, active_force, "active_along");
        }
    }
}

fn strings(value: &Value) -> Vec<String> {
    value.as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
}
