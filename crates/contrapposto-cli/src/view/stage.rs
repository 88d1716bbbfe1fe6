//! Describes what stands around a body and pushes on it, as pages and figures draw it.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::Scenario;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_formats::Thing;
use nalgebra::{Isometry3, Point3, Vector3};

use super::words::plain;

/// An event is due at samples from so long before it on, s.
pub(crate) const EVENT_TOLERANCE: f64 = 1e-9;

/// Points so near to a box, m, are on it.
const ON_BOX: f64 = 0.02;
/// The same of the bones of a forearm, with flesh below them.
const FOREARM_ON_BOX: f64 = 0.07;

/// Supports, things and loads of a body.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stage<'a> {
    /// Supports, which stay in their places.
    pub(crate) supports: &'a [Support],
    /// Things in ground and in hands.
    pub(crate) things: &'a [Thing],
    /// Loads besides the body's weight, and the time from which on they are in force, s; the earliest first.
    pub(crate) loads: Vec<(f64, &'a [Load])>,
}

impl<'a> Stage<'a> {
    /// With loads that do not change.
    pub(crate) fn still(supports: &'a [Support], things: &'a [Thing], loads: &'a [Load]) -> Self {
        Self { supports, things, loads: vec![(f64::NEG_INFINITY, loads)] }
    }

    /// Of a run, whose events may change the loads.
    pub(crate) fn of_run(scenario: &'a Scenario, things: &'a [Thing]) -> Self {
        let mut stage = Self::still(&scenario.supports, things, &scenario.loads);
        let changes = scenario.events.iter().filter_map(|event| Some((event.time, event.loads.as_deref()?)));
        stage.loads.extend(changes);
        stage
    }

    /// The loads in force at a time.
    pub(crate) fn loads_at(&self, time: f64) -> &'a [Load] {
        let begun = self.loads.partition_point(|(from, _)| *from <= time + EVENT_TOLERANCE);
        self.loads[..begun].last().map_or(&[], |(_, loads)| loads)
    }

    /// The name of the thing under each support in a posture, such as `seat` or `backrest`; `None` for the floor and for a plane without a
    /// name.
    pub(crate) fn carriers(&self, model: &Model, posture: &[f64]) -> Vec<Option<String>> {
        let mut kinematics = Kinematics::new(model);
        if kinematics.update(model, &Posture::new(posture.to_vec())).is_err() {
            return vec![None; self.supports.len()];
        }
        let sits = self.things.iter().any(|thing| thing.name == "seat");
        let carrier = |support: &Support| {
            let corners = support.corners.iter().map(|corner| kinematics.station(model, support.segment, *corner));
            let corners: Vec<Vector3<f64>> = corners.collect();
            let name = &model.segments()[support.segment].name;
            let on = |thing: &&Thing| carries(thing, name, &corners);
            self.things.iter().find(on).map(|thing| thing.name.clone()).or_else(|| rest(name).filter(|_| sits))
        };
        self.supports.iter().map(carrier).collect()
    }

    /// A name for each support: `backrest (torso)`, `right foot`.
    pub(crate) fn support_names(&self, model: &Model, posture: &[f64]) -> Vec<String> {
        let name = |(support, carrier): (&Support, Option<String>)| {
            let part = plain(&model.segments()[support.segment].name);
            carrier.map_or_else(|| part.clone(), |carrier| format!("{carrier} ({part})"))
        };
        self.supports.iter().zip(self.carriers(model, posture)).map(name).collect()
    }

    /// All loads, each once.
    pub(crate) fn all_loads(&self) -> Vec<Load> {
        let mut all: Vec<Load> = vec![];
        for load in self.loads.iter().flat_map(|(_, loads)| *loads) {
            if !all.contains(load) {
                all.push(*load);
            }
        }
        all
    }
}

/// The part of a seat that carries a segment and is no thing of its own.
fn rest(segment: &str) -> Option<String> {
    match segment {
        "torso" => Some("backrest".to_owned()),
        "radius_r" | "radius_l" => Some("armrest".to_owned()),
        _ => None,
    }
}

/// Whether a thing that stands in ground carries the patch of a segment: half of its corners or more, ground, m, are in it or on it.
pub(crate) fn carries(thing: &Thing, segment: &str, corners: &[Vector3<f64>]) -> bool {
    let near = if segment.starts_with("radius") { FOREARM_ON_BOX } else { ON_BOX };
    let is_on = |point: &&Vector3<f64>| {
        let inside = thing.place.inverse_transform_point(&Point3::from(**point));
        (0..3).all(|k| inside[k].abs() <= 0.5 * thing.size[k] + near)
    };
    thing.segment.is_none() && 2 * corners.iter().filter(is_on).count() >= corners.len()
}

/// Point and force of a load in ground, m and N; `None` of a couple.
pub(crate) fn push(model: &Model, kinematics: &Kinematics, load: &Load) -> Option<[Vector3<f64>; 2]> {
    let force = match load.kind {
        LoadKind::Weight(mass) => mass * model.gravity(),
        LoadKind::Force(force, FixedIn::World) => force,
        LoadKind::Force(force, FixedIn::Segment) => kinematics.placement(model, load.segment).rotation * force,
        LoadKind::Couple(..) => return None,
    };
    Some([kinematics.station(model, load.segment, load.point), force])
}

/// `7.5 kg on the right hand`, `60 N on the right hand`.
pub(crate) fn load_in_words(model: &Model, load: &Load) -> String {
    let amount = match load.kind {
        LoadKind::Weight(mass) => format!("{} kg", (10.0 * mass).round() / 10.0),
        LoadKind::Force(force, _) => format!("{:.0} N", force.norm()),
        LoadKind::Couple(couple, _) => format!("{:.1} N m", couple.norm()),
    };
    format!("{amount} on {}", plain(&model.segments()[load.segment].name))
}

/// Placement of a thing in ground.
pub(crate) fn place(model: &Model, kinematics: &Kinematics, thing: &Thing) -> Isometry3<f64> {
    thing.place_by(|segment| kinematics.placement(model, segment))
}
