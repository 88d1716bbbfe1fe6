//! Reads the muscles, ligaments and springs of a model. One that is not supported is counted with its reason, and does not refuse the model.

use std::collections::HashMap;

use contrapposto::muscle::{
    ActiveCurve, DeGrooteFregly2016, FiberLaw, Millard2012, Muscle, MuscleSpec, PassiveFiberCurve, PassiveShape,
    Schutte1993, TendonCurve, TendonShape, Thelen2003,
};

use super::attributes::Reader;
use super::coordinates::Coordinates;
use super::error::OsimProblem;
use super::functions;
use super::path::Surroundings;
use super::sets::Scene;
use super::springs;
use super::wrap::WrapObjects;
use crate::model_ir::{ModelIr, MusclesIr};
use crate::xml::Node;

const MUSCLES: &str =
    "Thelen2003Muscle, Millard2012EquilibriumMuscle, DeGrooteFregly2016Muscle, Schutte1993Muscle_Deprecated";
/// Fibre damping from which on OpenSim's fibres need no least active force.
const DAMPED: f64 = 0.001;
/// Least active force, over the greatest isometric force, of undamped fibres with a compliant tendon in OpenSim.
const UNDAMPED_FLOOR: f64 = 0.1;

/// Reads muscles, their paths and the surfaces that they wrap over.
pub(super) fn read<'a>(reader: &Reader<'a>, scene: &Scene<'a>, coordinates: &Coordinates, body: &ModelIr) -> MusclesIr {
    let segments: HashMap<&str, usize> = body.segments.iter().zip(0..).map(|(s, i)| (s.name.as_str(), i)).collect();
    let mut all = MusclesIr::default();
    let objects = WrapObjects::read(reader, scene, &segments, &mut all.tally);
    let list = coordinates.list();
    let around = Surroundings { reader, scene, coordinates, list, segments: &segments, objects: &objects };
    let soft = |kind: &str| kind.contains("Muscle") || springs::KINDS.contains(&kind);
    for &node in scene.forces.iter().filter(|node| soft(node.name())) {
        let read = if node.name().contains("Muscle") { muscle } else { springs::read };
        match off(reader, node).and_then(|off| if off { Ok(None) } else { read(&around, node, &mut all).map(Some) }) {
            Ok(Some(points)) => {
                all.tally.read(node.name());
                points.into_iter().for_each(|kind| all.tally.read(kind));
            }
            Ok(None) => all.tally.left_out(node.name(), "switched off in the file"),
            Err(why) => all.tally.refused(node.name(), why.to_string()),
        }
    }
    all.musculature.paths.wrap_objects = objects.list;
    all
}

/// Whether the file switches a force off.
fn off<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<bool, OsimProblem> {
    Ok(!reader.flag(node, "appliesForce", true)? || reader.flag(node, "isDisabled", false)?)
}

/// Adds a muscle and its path; gives the kinds of the path's points.
fn muscle<'a>(around: &Surroundings<'_, 'a>, node: Node<'a>, all: &mut MusclesIr) -> Result<Vec<&'a str>, OsimProblem> {
    let reader = around.reader;
    let number = |name, default| reader.number(node, name, Some(default));
    let compliant = !reader.flag(node, "ignore_tendon_compliance", false)?;
    let (law, rigid_tendon) = match node.name() {
        // OpenSim's muscle of this kind has a compliant tendon whatever the file says.
        "Thelen2003Muscle" => (FiberLaw::Thelen2003(thelen(reader, node)?), false),
        "Millard2012EquilibriumMuscle" => (FiberLaw::Millard2012(millard(reader, node, compliant)?), !compliant),
        "DeGrooteFregly2016Muscle" => (FiberLaw::DeGrooteFregly2016(degroote_fregly(reader, node)?), !compliant),
        "Schutte1993Muscle_Deprecated" => (FiberLaw::Schutte1993(schutte(reader, node)?), false),
        other => return Err(OsimProblem::unsupported(node.place(), other, MUSCLES)),
    };
    let least_activation = match law {
        FiberLaw::Thelen2003(_) | FiberLaw::Millard2012(_) => number("minimum_activation", 0.01)?,
        _ => 0.0,
    };
    let pennation = if reader.property(node, "pennation_angle_at_optimal").is_some() {
        "pennation_angle_at_optimal"
    } else {
        "pennation_angle"
    };
    let spec = MuscleSpec {
        name: reader.unique_name(node)?,
        path: all.musculature.paths.paths.len(),
        max_isometric_force: number("max_isometric_force", 1000.0)?,
        optimal_fiber_length: number("optimal_fiber_length", 0.1)?,
        tendon_slack_length: number("tendon_slack_length", 0.2)?,
        pennation: number(pennation, 0.0)?,
        max_pennation: number("maximum_pennation_angle", libm::acos(0.1))?,
        least_activation,
        rigid_tendon,
        law,
    };
    if all.musculature.muscles.iter().any(|other| other.spec().name == spec.name) {
        return Err(OsimProblem::Twice { place: node.place(), what: "muscle", name: spec.name });
    }
    let (path, points) = around.path(node)?;
    let made = Muscle::new(spec).map_err(|why| OsimProblem::invalid(node.place(), node.name(), why.to_string()))?;
    all.musculature.paths.paths.push(path);
    all.musculature.muscles.push(made);
    Ok(points)
}

fn thelen<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<Thelen2003, OsimProblem> {
    let number = |name, default| reader.number(node, name, Some(default));
    let default = Thelen2003::default();
    Ok(Thelen2003 {
        tendon_strain: number("FmaxTendonStrain", default.tendon_strain)?,
        fiber_strain: number("FmaxMuscleStrain", default.fiber_strain)?,
        active_shape: number("KshapeActive", default.active_shape)?,
        passive_shape: number("KshapePassive", default.passive_shape)?,
    })
}

fn degroote_fregly<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<DeGrooteFregly2016, OsimProblem> {
    let number = |name, default| reader.number(node, name, Some(default));
    let default = DeGrooteFregly2016::default();
    Ok(DeGrooteFregly2016 {
        active_width: number("active_force_width_scale", default.active_width)?,
        fiber_strain: number("passive_fiber_strain_at_one_norm_force", default.fiber_strain)?,
        tendon_strain: number("tendon_strain_at_one_norm_force", default.tendon_strain)?,
        without_passive: reader.flag(node, "ignore_passive_fiber_force", default.without_passive)?,
    })
}

fn schutte<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<Schutte1993, OsimProblem> {
    let curve = |name: &str| {
        let function = reader.object(node, name, |_| false);
        function.map(|function| functions::read(reader, function)).transpose()
    };
    let default = Schutte1993::default();
    Ok(Schutte1993 {
        active: curve("active_force_length_curve")?.unwrap_or(default.active),
        passive: curve("passive_force_length_curve")?,
        tendon: curve("tendon_force_length_curve")?.unwrap_or(default.tendon),
    })
}

fn millard<'a>(reader: &Reader<'a>, node: Node<'a>, compliant: bool) -> Result<Millard2012, OsimProblem> {
    let mut law = Millard2012::default();
    let number = |curve, name, default| reader.number(curve, name, Some(default));
    if let Some(curve) = reader.property(node, "ActiveForceLengthCurve") {
        let own = law.active;
        law.active = ActiveCurve {
            least: number(curve, "min_norm_active_fiber_length", own.least)?,
            transition: number(curve, "transition_norm_fiber_length", own.transition)?,
            greatest: number(curve, "max_norm_active_fiber_length", own.greatest)?,
            shallow_slope: number(curve, "shallow_ascending_slope", own.shallow_slope)?,
            floor: number(curve, "minimum_value", own.floor)?,
        };
    }
    let undamped = reader.number(node, "fiber_damping", Some(0.1))? < DAMPED;
    law.active.floor = if compliant && undamped { law.active.floor.max(UNDAMPED_FLOOR) } else { 0.0 };
    if let Some(curve) = reader.property(node, "FiberForceLengthCurve") {
        let names = ["stiffness_at_low_force", "stiffness_at_one_norm_force", "curviness"];
        let shape = shape(reader, curve, names)?;
        law.passive = PassiveFiberCurve {
            zero_strain: number(curve, "strain_at_zero_force", law.passive.zero_strain)?,
            strain: number(curve, "strain_at_one_norm_force", law.passive.strain)?,
            shape: shape.map(|[low_slope, slope, curviness]| PassiveShape { low_slope, slope, curviness }),
        };
    }
    if let Some(curve) = reader.property(node, "TendonForceLengthCurve") {
        let names = ["stiffness_at_one_norm_force", "norm_force_at_toe_end", "curviness"];
        let shape = shape(reader, curve, names)?;
        law.tendon = TendonCurve {
            strain: number(curve, "strain_at_one_norm_force", law.tendon.strain)?,
            shape: shape.map(|[slope, toe_force, curviness]| TendonShape { slope, toe_force, curviness }),
        };
    }
    Ok(law)
}

/// Three optional numbers, all of which or none must be there.
fn shape<'a>(reader: &Reader<'a>, curve: Node<'a>, names: [&str; 3]) -> Result<Option<[f64; 3]>, OsimProblem> {
    let given = |name: &str| reader.text(curve, name).is_some_and(|text| !text.is_empty());
    if !names.iter().any(|name| given(name)) {
        return Ok(None);
    }
    let mut values = [0.0; 3];
    for (value, name) in values.iter_mut().zip(names) {
        *value = reader.number(curve, name, None)?;
    }
    Ok(Some(values))
}
