//! Reads the forces and constraints of a model that matter at rest.

use super::attributes::Reader;
use super::coordinates::Coordinates;
use super::error::OsimProblem;
use super::functions;
use super::sets::Scene;
use super::springs;
use crate::model_ir::{Coupling, Ignored, ModelIr, PassiveIr, PassiveLawIr};
use crate::xml::Node;
use contrapposto::passive::{CoordinateLimitForce, DoubleExponential, End};

const FORCES: &str = "CoordinateLimitForce, ExponentialCoordinateLimitForce, SpringGeneralizedForce, \
                      ExpressionBasedCoordinateForce, muscles, Ligament, \
                      Blankevoort1991Ligament, PathSpring, BushingForce, actuators, contacts, and forces with <appliesForce>false</appliesForce>";
/// Contacts of the body with the ground, which a scenario's supports stand for.
const CONTACTS: [&str; 3] = ["HuntCrossleyForce", "ElasticFoundationForce", "SmoothSphereHalfSpaceForce"];
const CONSTRAINTS: &str = "CoordinateCouplerConstraint, and constraints with <isEnforced>false</isEnforced>";

/// Reads couplings and passive torques.
pub(super) fn read<'a>(
    reader: &Reader<'a>,
    scene: &Scene<'a>,
    coordinates: &Coordinates,
    body: &mut ModelIr,
    ignored: &mut Ignored,
) -> Result<(), OsimProblem> {
    for &node in &scene.constraints {
        if !reader.flag(node, "isEnforced", true)? || reader.flag(node, "isDisabled", false)? {
            ignored.add("constraints switched off", 1);
        } else if node.name() == "CoordinateCouplerConstraint" {
            let coupling = coupling(reader, node, coordinates)?;
            body.couplings.push(coupling);
        } else {
            return Err(OsimProblem::unsupported(node.place(), node.name(), CONSTRAINTS));
        }
    }
    check_couplings(scene, body)?;
    for &node in &scene.forces {
        let kind = node.name();
        if kind.contains("Muscle") {
            ignored.add("muscles", 1);
        } else if springs::KINDS.contains(&kind) {
            ignored.add("ligaments, path springs and bushings", 1);
        } else if kind.ends_with("Actuator") {
            ignored.add("actuators", 1);
        } else if !reader.flag(node, "appliesForce", true)? || reader.flag(node, "isDisabled", false)? {
            ignored.add("forces switched off", 1);
        } else if CONTACTS.contains(&kind) {
            ignored.add("contact forces (supports carry the body instead)", 1);
        } else {
            body.passive.push(passive(reader, node, coordinates)?);
        }
    }
    Ok(())
}

fn coupling<'a>(reader: &Reader<'a>, node: Node<'a>, coordinates: &Coordinates) -> Result<Coupling, OsimProblem> {
    let (names, node_of_names) = reader.required_text(node, "independent_coordinate_names")?;
    let mut names = names.split_ascii_whitespace();
    let (Some(independent), None) = (names.next(), names.next()) else {
        let what = "a coupling to several coordinates";
        return Err(OsimProblem::unsupported(node_of_names.place(), what, "one independent coordinate"));
    };
    let (dependent, node_of_dependent) = reader.required_text(node, "dependent_coordinate_name")?;
    let Some(function) = reader.object(node, "coupled_coordinates_function", functions::is_function) else {
        let what = "<coupled_coordinates_function>".to_owned();
        return Err(OsimProblem::Missing { place: node.place(), what });
    };
    let scale = reader.number(node, "scale_factor", Some(1.0))?;
    Ok(Coupling {
        dependent: coordinates.find(&dependent, node_of_dependent)?,
        independent: coordinates.find(independent, node_of_names)?,
        function: functions::read(reader, function)?.scaled(scale),
    })
}

/// Each coordinate follows at most one other, and no circle.
fn check_couplings(scene: &Scene<'_>, body: &ModelIr) -> Result<(), OsimProblem> {
    let mut leader_of = std::collections::HashMap::new();
    let enforced = scene.constraints.iter().filter(|n| n.name() == "CoordinateCouplerConstraint");
    let place = enforced.clone().next().map(|n| n.place()).unwrap_or_default();
    let refuse =
        |what| Err(OsimProblem::unsupported(place.clone(), what, "couplings that form no loop, one per coordinate"));
    for coupling in &body.couplings {
        if leader_of.insert(coupling.dependent, coupling.independent).is_some() {
            return refuse("a coordinate that follows two others");
        }
    }
    // Every chain is at most as long as there are couplings; chains share their ends, which are walked once.
    let mut ends = std::collections::HashSet::new();
    for coupling in &body.couplings {
        let (mut at, mut path) = (coupling.dependent, std::collections::HashSet::new());
        while let Some(&next) = leader_of.get(&at).filter(|_| !ends.contains(&at)) {
            if !path.insert(at) {
                return refuse("a coordinate that follows itself");
            }
            at = next;
        }
        ends.extend(path);
    }
    Ok(())
}

fn passive<'a>(reader: &Reader<'a>, node: Node<'a>, coordinates: &Coordinates) -> Result<PassiveIr, OsimProblem> {
    let read_law = match node.name() {
        "CoordinateLimitForce" => limit_force,
        "ExponentialCoordinateLimitForce" => exponential,
        "SpringGeneralizedForce" => spring,
        "ExpressionBasedCoordinateForce" => expression,
        other => return Err(OsimProblem::unsupported(node.place(), &format!("force {other}"), FORCES)),
    };
    let property = if node.child("socket_coordinate").is_some() { "socket_coordinate" } else { "coordinate" };
    let (name, name_node) = reader.required_text(node, property)?;
    let coordinate = coordinates.find(&name, name_node)?;
    let traits = coordinates.traits(coordinate);
    if traits.of_ball {
        let accepted = "coordinates of other joints (OpenSim applies it about an axis of the parent, which is not that of the angle)";
        return Err(OsimProblem::unsupported(node.place(), "a force on a rotation of a ball or free joint", accepted));
    }
    Ok(PassiveIr { name: reader.name(node)?, coordinate, law: read_law(reader, node, traits.degrees)? })
}

/// Degrees for a coordinate that OpenSim calls rotational, rad or m for the others.
fn limit_force<'a>(reader: &Reader<'a>, node: Node<'a>, degrees: bool) -> Result<PassiveLawIr, OsimProblem> {
    let unit = if degrees { 1f64.to_radians() } else { 1.0 };
    let law = CoordinateLimitForce {
        upper_stiffness: reader.number(node, "upper_stiffness", Some(1.0))? / unit,
        upper_limit: reader.number(node, "upper_limit", Some(0.0))? * unit,
        lower_stiffness: reader.number(node, "lower_stiffness", Some(1.0))? / unit,
        lower_limit: reader.number(node, "lower_limit", Some(0.0))? * unit,
        transition: reader.number(node, "transition", Some(0.1))? * unit,
    };
    law.form().map_err(|error| OsimProblem::invalid(node.place(), node.name(), error.to_string()))?;
    Ok(PassiveLawIr::CoordinateLimitForce(law))
}

/// `lower[0] exp(-lower[1] (q - lower_limit)) - upper[0] exp(upper[1] (q - upper_limit))`, in rad or m.
fn exponential<'a>(reader: &Reader<'a>, node: Node<'a>, _: bool) -> Result<PassiveLawIr, OsimProblem> {
    let end = |shape, limit| {
        let [torque, rate] = reader.fixed(node, shape, Some([0.0, 0.0]))?;
        let angle = reader.number(node, limit, Some(0.0))?;
        // Without torque the rate has no meaning.
        Ok::<_, OsimProblem>(End { torque, rate: if torque == 0.0 && rate == 0.0 { 1.0 } else { rate }, angle })
    };
    let (lower, upper) = (end("lower_shape_parameters", "lower_limit")?, end("upper_shape_parameters", "upper_limit")?);
    let law = DoubleExponential { lower, upper, stiffness: 0.0, neutral: 0.0 };
    law.form().map_err(|error| OsimProblem::invalid(node.place(), node.name(), error.to_string()))?;
    Ok(PassiveLawIr::DoubleExponential(law))
}

/// `-stiffness (q - rest_length)`; viscosity plays no part at rest.
fn spring<'a>(reader: &Reader<'a>, node: Node<'a>, _: bool) -> Result<PassiveLawIr, OsimProblem> {
    let stiffness = reader.number(node, "stiffness", Some(0.0))?;
    let rest = reader.number(node, "rest_length", Some(0.0))?;
    Ok(PassiveLawIr::Spring { stiffness, rest })
}

fn expression<'a>(reader: &Reader<'a>, node: Node<'a>, _: bool) -> Result<PassiveLawIr, OsimProblem> {
    let Some(property) = reader.property(node, "expression") else {
        return Err(OsimProblem::Missing { place: node.place(), what: "<expression>".to_owned() });
    };
    let parsed = super::expression::parse(&property.text());
    let formula = parsed.map_err(|problem| OsimProblem::Expression { place: property.place(), problem })?;
    Ok(PassiveLawIr::Expression(formula))
}
