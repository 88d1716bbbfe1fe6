//! Reads joints of every kind as a chain of slides, then hinges, from the parent's frame to the child's.
//!
//! Checked against OpenSim 4.6: translations run along the axes of the parent's frame, rotations follow body-fixed, and the axes
//! of custom joints are taken at unit length.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::attributes::{Reader, objects};
use super::coordinates::{self, CoordinateTraits, Coordinates};
use super::error::OsimProblem;
use super::functions;
use super::sets::SceneJoint;
use crate::model_ir::{CoordinateKind, Drive, Function, Ignored, MotionIr, near, unit};
use crate::xml::{Node, shorten};

const ACCEPTED_JOINTS: &str =
    "WeldJoint, PinJoint, SliderJoint, UniversalJoint, GimbalJoint, BallJoint, FreeJoint, PlanarJoint, CustomJoint";

use CoordinateKind::{Rotation, Translation};

type Mobility = (CoordinateKind, fn() -> Vector3<f64>);

const X: fn() -> Vector3<f64> = Vector3::x;
const Y: fn() -> Vector3<f64> = Vector3::y;
const Z: fn() -> Vector3<f64> = Vector3::z;

/// Motions of a free joint in the order of its coordinates.
const FREE: [Mobility; 6] =
    [(Rotation, X), (Rotation, Y), (Rotation, Z), (Translation, X), (Translation, Y), (Translation, Z)];

/// The motions of a joint that is no custom joint, in the order of its coordinates.
fn mobilities(kind: &str) -> Option<&'static [Mobility]> {
    Some(match kind {
        "WeldJoint" => &[],
        "PinJoint" => &[(Rotation, Z)],
        "SliderJoint" => &[(Translation, X)],
        "UniversalJoint" => &[(Rotation, X), (Rotation, Y)],
        "GimbalJoint" | "BallJoint" => &[(Rotation, X), (Rotation, Y), (Rotation, Z)],
        "FreeJoint" => &FREE,
        "PlanarJoint" => &[(Rotation, Z), (Translation, X), (Translation, Y)],
        _ => return None,
    })
}

fn motion(kind: CoordinateKind, axis: Vector3<f64>, drive: Drive) -> MotionIr {
    match kind {
        Translation => MotionIr::Slide { axis, drive },
        _ => MotionIr::Hinge { axis, drive },
    }
}

/// The motions of a joint; its coordinates join the others.
pub(super) fn motions<'a>(
    reader: &Reader<'a>,
    joint: &SceneJoint<'a>,
    all: &mut Coordinates,
    ignored: &mut Ignored,
) -> Result<Vec<MotionIr>, OsimProblem> {
    let node = joint.node;
    let declared = declared(node);
    if node.name() == "CustomJoint" {
        return custom(reader, joint, &declared, all, ignored);
    }
    let Some(mobilities) = mobilities(node.name()) else {
        return Err(OsimProblem::unsupported(node.place(), &format!("joint {}", node.name()), ACCEPTED_JOINTS));
    };
    if declared.len() > mobilities.len() || (declared.len() < mobilities.len() && !joint.old) {
        let problem = format!("a {} has {} coordinate(s)", node.name(), mobilities.len());
        return Err(OsimProblem::invalid(node.place(), &format!("{} coordinates", declared.len()), problem));
    }
    let ball = matches!(node.name(), "BallJoint" | "FreeJoint");
    let mut driven = Vec::new();
    for (i, &(kind, axis)) in mobilities.iter().enumerate() {
        let coordinate = match declared.get(i) {
            Some(&coordinate) => coordinates::read(reader, coordinate, kind)?,
            None => coordinates::unwritten(format!("{}_coord_{i}", joint.name), kind),
        };
        let traits = CoordinateTraits { degrees: kind == Rotation, of_ball: ball && kind == Rotation };
        let place = declared.get(i).unwrap_or(&node).place();
        driven.push(((kind, axis), all.add(reader, place, &joint.name, coordinate, traits)?));
    }
    Ok(slides_first(&driven))
}

fn slides_first(driven: &[(Mobility, usize)]) -> Vec<MotionIr> {
    let of = |wanted| driven.iter().filter(move |d| d.0.0 == wanted);
    of(Translation)
        .chain(of(Rotation))
        .map(|&((kind, axis), index)| motion(kind, axis(), Drive::Coordinate(index)))
        .collect()
}

/// The free joint that OpenSim gives to a body without one.
pub(super) fn free<'a>(
    reader: &Reader<'a>,
    body: &str,
    node: Node<'a>,
    all: &mut Coordinates,
) -> Result<(String, Vec<MotionIr>), OsimProblem> {
    let joint = format!("free_{body}");
    let mut driven = Vec::new();
    for (i, &(kind, axis)) in FREE.iter().enumerate() {
        let coordinate = coordinates::unwritten(format!("{joint}_coord_{i}"), kind);
        let traits = CoordinateTraits { degrees: kind == Rotation, of_ball: kind == Rotation };
        driven.push(((kind, axis), all.add(reader, node.place(), &joint, coordinate, traits)?));
    }
    Ok((joint, slides_first(&driven)))
}

pub(super) fn declared(joint: Node<'_>) -> Vec<Node<'_>> {
    let new = joint.child("coordinates").into_iter().flat_map(Node::children);
    new.chain(objects(joint.child("CoordinateSet"))).filter(|n| n.name() == "Coordinate").collect()
}

/// The six axes of a custom joint in the order in which they act.
const AXES: [(&str, CoordinateKind); 6] = [
    ("translation1", Translation),
    ("translation2", Translation),
    ("translation3", Translation),
    ("rotation1", Rotation),
    ("rotation2", Rotation),
    ("rotation3", Rotation),
];

/// One motion before its coordinate has a number.
struct Part {
    kind: CoordinateKind,
    axis: Vector3<f64>,
    function: Function,
    /// The coordinate of the joint that drives the motion, by index.
    coordinate: Option<usize>,
    /// OpenSim takes the coordinate's kind from this axis: its function is linear and begins with the slope 1.
    gives_kind: bool,
}

/// The elements of the six axes: translations, then rotations.
pub(super) fn transform_axes<'a>(transform: Node<'a>) -> Result<[Option<Node<'a>>; 6], OsimProblem> {
    let mut axes: [Option<Node<'a>>; 6] = [None; 6];
    for axis in transform.children().filter(|n| n.name() == "TransformAxis") {
        let name = axis.attribute("name").unwrap_or_default().trim();
        let Some(slot) = AXES.iter().position(|(known, _)| *known == name) else {
            let problem = "rotation1 to rotation3 and translation1 to translation3 are accepted";
            return Err(OsimProblem::invalid(axis.attribute_place("name"), name, problem));
        };
        axes[slot].get_or_insert(axis);
    }
    Ok(axes)
}

fn custom<'a>(
    reader: &Reader<'a>,
    joint: &SceneJoint<'a>,
    declared: &[Node<'a>],
    all: &mut Coordinates,
    ignored: &mut Ignored,
) -> Result<Vec<MotionIr>, OsimProblem> {
    let node = joint.node;
    let Some(transform) = reader.property(node, "SpatialTransform") else {
        return Err(OsimProblem::Missing { place: node.place(), what: "<SpatialTransform>".to_owned() });
    };
    let mut by_name = HashMap::new();
    for (i, &coordinate) in declared.iter().enumerate() {
        let name = reader.unique_name(coordinate)?;
        if by_name.insert(name.clone(), i).is_some() {
            return Err(OsimProblem::Twice { place: coordinate.place(), what: "coordinate", name });
        }
    }
    let axes = transform_axes(transform)?;
    let mut parts: Vec<Part> = Vec::new();
    // OpenSim's kind of a coordinate: that of the last axis, rotations first, that gives one.
    let mut plain = vec![None; declared.len()];
    for slot in [3, 4, 5, 0, 1, 2] {
        let kind = AXES[slot].1;
        for part in axes[slot].map(|axis| axis_parts(reader, axis, kind, &by_name)).transpose()?.unwrap_or_default() {
            if let Some(i) = part.coordinate.filter(|_| part.gives_kind) {
                plain[i] = Some(kind);
            }
            parts.push(part);
        }
    }
    parts.sort_by_key(|part| part.kind == Rotation);
    let mut numbers = Vec::with_capacity(declared.len());
    for (i, &coordinate) in declared.iter().enumerate() {
        let drives = |kind| parts.iter().any(|part| part.coordinate == Some(i) && part.kind == kind);
        let kind = if drives(Rotation) { Rotation } else { Translation };
        let read = coordinates::read(reader, coordinate, kind)?;
        if !drives(kind) {
            ignored.add("coordinates that move nothing", 1);
            numbers.push(None);
            continue;
        }
        let traits = CoordinateTraits { degrees: plain[i] == Some(Rotation), of_ball: false };
        numbers.push(Some(all.add(reader, coordinate.place(), &joint.name, read, traits)?));
    }
    let drive = |function: Function, coordinate: Option<usize>| match (coordinate.and_then(|i| numbers[i]), function) {
        (_, Function::Constant(value)) => Drive::Fixed(value),
        (Some(index), function) if function.is_identity() => Drive::Coordinate(index),
        (Some(index), function) => Drive::Function(function, index),
        (None, function) => Drive::Fixed(function.value(0.0)),
    };
    let motions = parts.into_iter().map(|part| motion(part.kind, part.axis, drive(part.function, part.coordinate)));
    Ok(motions.filter(|m| !is_still(m)).collect())
}

/// Whether it never moves.
fn is_still(motion: &MotionIr) -> bool {
    matches!(motion, MotionIr::Hinge { drive: Drive::Fixed(v), .. } | MotionIr::Slide { drive: Drive::Fixed(v), .. } if *v == 0.0)
}

/// The motion of one axis. A linear function of several coordinates is a chain of motions along the same axis.
fn axis_parts<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    kind: CoordinateKind,
    by_name: &HashMap<String, usize>,
) -> Result<Vec<Part>, OsimProblem> {
    let names = axis_coordinates(reader, node, by_name)?;
    let Some(function) = reader.object(node, "function", functions::is_function) else { return Ok(Vec::new()) };
    let (parts, gives_kind) = axis_functions(reader, node, function, &names)?;
    if parts.iter().all(|(function, _)| *function == Function::Constant(0.0)) {
        return Ok(Vec::new());
    }
    let axis = reader.vector(node, "axis", None)?;
    let Some(axis) = unit(axis) else {
        let text = reader.text(node, "axis").unwrap_or_default();
        return Err(OsimProblem::invalid(node.place(), &text, "an axis must have a length"));
    };
    let axis = axis.into_inner();
    let part = |(function, coordinate)| Part { kind, axis, function, coordinate, gives_kind };
    Ok(parts.into_iter().map(part).collect())
}

/// Places of the coordinates that drive an axis among those of its joint.
fn axis_coordinates<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    by_name: &HashMap<String, usize>,
) -> Result<Vec<usize>, OsimProblem> {
    let list = reader.property(node, "coordinates");
    let text = list.map(Node::text).unwrap_or_default();
    let mut names = Vec::new();
    for name in text.split_ascii_whitespace() {
        let index = by_name.get(name).copied().ok_or_else(|| OsimProblem::Unknown {
            place: list.unwrap_or(node).place(),
            what: "coordinate of this joint",
            name: shorten(name),
            near: near(name, by_name.keys().map(String::as_str).collect::<std::collections::BTreeSet<_>>()),
        })?;
        names.push(index);
    }
    Ok(names)
}

/// A function, and the place of the coordinate that drives it.
type Driven = (Function, Option<usize>);

/// The functions that an axis adds up, each with the coordinate that drives it; and whether the axis gives this coordinate its
/// kind.
fn axis_functions<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    function: Node<'a>,
    names: &[usize],
) -> Result<(Vec<Driven>, bool), OsimProblem> {
    let mut gives_kind = false;
    let parts = match (names, function.name()) {
        (_, "Constant") => vec![(functions::read(reader, function)?, None)],
        (&[index], kind) => {
            let read = functions::read(reader, function)?;
            gives_kind = kind == "LinearFunction" && matches!(read, Function::Linear { slope, .. } if slope == 1.0);
            vec![(read, Some(index))]
        }
        ([], _) => match functions::read(reader, function)? {
            // OpenSim's scaling tool wraps constants.
            constant @ Function::Constant(_) => vec![(constant, None)],
            _ => {
                let accepted = "a Constant, or the name of a coordinate in <coordinates>";
                return Err(OsimProblem::unsupported(node.place(), "a function of no coordinate", accepted));
            }
        },
        (several, "LinearFunction") => {
            let coefficients = functions::linear(reader, function, several.len())?;
            gives_kind = coefficients[0] == 1.0;
            let mut intercept = coefficients[several.len()];
            let each = several.iter().zip(&coefficients).map(|(&index, &slope)| {
                (Function::Linear { slope, intercept: std::mem::take(&mut intercept) }, Some(index))
            });
            each.collect()
        }
        _ => {
            let accepted = "a LinearFunction, or a function of one coordinate";
            let what = format!("{} of {} coordinates", function.name(), names.len());
            return Err(OsimProblem::unsupported(function.place(), &what, accepted));
        }
    };
    Ok((parts, gives_kind))
}
