//! Reads the path of a muscle, ligament or spring: its points, and the surfaces that it may wrap over.

use std::collections::HashMap;

use contrapposto::model::LARGEST;
use contrapposto::muscle::{Location, MovingPoint, Path, PathPoint, PathWrap, WrapMethod};
use nalgebra::{Point3, Vector3};

use super::attributes::{Reader, objects};
use super::coordinates::Coordinates;
use super::error::OsimProblem;
use super::functions;
use super::sets::Scene;
use super::wrap::WrapObjects;
use crate::model_ir::CoordinateIr;
use crate::xml::Node;

const POINTS: &str = "PathPoint, ConditionalPathPoint, MovingPathPoint";
const PATHS: &str = "GeometryPath";

/// The parts of the file that paths refer to.
pub(super) struct Surroundings<'s, 'a> {
    pub(super) reader: &'s Reader<'a>,
    pub(super) scene: &'s Scene<'a>,
    pub(super) coordinates: &'s Coordinates,
    pub(super) list: &'s [CoordinateIr],
    pub(super) segments: &'s HashMap<&'s str, usize>,
    pub(super) objects: &'s WrapObjects,
}

impl<'a> Surroundings<'_, 'a> {
    /// The path of a force, and the kinds of its points.
    pub(super) fn path(&self, force: Node<'a>) -> Result<(Path, Vec<&'a str>), OsimProblem> {
        let Some(node) = force.children().find(|child| child.name() == PATHS) else {
            let other = force.children().find(|child| child.name().ends_with("Path"));
            return Err(match other {
                Some(other) => OsimProblem::unsupported(other.place(), other.name(), PATHS),
                None => OsimProblem::Missing { place: force.place(), what: format!("<{PATHS}>") },
            });
        };
        let set = |new, old| node.child(new).or_else(|| node.child(old));
        let within =
            format!("/forceset/{}/{}", self.reader.name(force)?, node.attribute("name").unwrap_or("geometrypath"));
        let (mut points, mut kinds) = (vec![], vec![]);
        for point in objects(set("PathPointSet", "MusclePointSet")) {
            points.push(self.point(point, &within)?);
            kinds.push(point.name());
        }
        if points.len() < 2 {
            let found = format!("{} points", points.len());
            return Err(OsimProblem::invalid(node.place(), &found, "a path has at least two"));
        }
        let mut wraps = vec![];
        for wrap in objects(set("PathWrapSet", "MuscleWrapSet")) {
            wraps.push(self.wrap(wrap, points.len())?);
        }
        Ok((Path { points, wraps, tendon: None }, kinds))
    }

    fn point(&self, node: Node<'a>, within: &str) -> Result<PathPoint, OsimProblem> {
        let reader = self.reader;
        let path = format!("{within}/{}", reader.name(node)?);
        let frame = self.scene.frame_of_point(reader, node, &path)?;
        let place = || {
            let place = reader.vector(node, "location", Some(Vector3::zeros()))?;
            let place = (frame.pose * Point3::from(place)).coords;
            if place.amax() <= LARGEST {
                return Ok(place);
            }
            Err(OsimProblem::invalid(node.place(), &place.amax().to_string(), "a point is at most 1e9 m away"))
        };
        let location = match node.name() {
            "PathPoint" => Location::Fixed(place()?),
            "ConditionalPathPoint" => {
                let [low, high] = reader.fixed(node, "range", Some([0.0, 0.0]))?;
                let (name, at) = self.coordinate_name(node, "coordinate")?;
                let coordinate = self.coordinates.find(&name, at)?;
                Location::Conditional { place: place()?, coordinate, range: (low, high) }
            }
            "MovingPathPoint" => Location::Moving(Box::new(self.moving(node, frame.pose)?)),
            other => return Err(OsimProblem::unsupported(node.place(), other, POINTS)),
        };
        Ok(PathPoint { segment: self.scene.segment(frame.body, self.segments), location })
    }

    /// The name of a coordinate: a socket, or a property of older documents.
    fn coordinate_name(&self, node: Node<'a>, property: &str) -> Result<(String, Node<'a>), OsimProblem> {
        let socket = format!("socket_{property}");
        let given = if node.child(&socket).is_some() { &socket } else { property };
        self.reader.required_text(node, given)
    }

    fn moving(&self, node: Node<'a>, frame: nalgebra::Isometry3<f64>) -> Result<MovingPoint, OsimProblem> {
        let mut coordinate = None;
        for property in ["x_coordinate", "y_coordinate", "z_coordinate"] {
            let Ok((name, at)) = self.coordinate_name(node, property) else { continue };
            let found = self.coordinates.find(&name, at)?;
            if coordinate.is_some_and(|other| other != found) {
                let what = "a point that several coordinates move";
                return Err(OsimProblem::unsupported(at.place(), what, "the same coordinate for x, y and z"));
            }
            coordinate = Some(found);
        }
        let axis = |new: &str, old: &str| {
            let function = self.reader.object(node, new, |_| false);
            let function = function.or_else(|| self.reader.object(node, old, |_| false));
            match function {
                Some(function) => functions::read(self.reader, function),
                None => Err(OsimProblem::Missing { place: node.place(), what: format!("<{new}>") }),
            }
        };
        let place = [
            axis("x_location", "XAttachment")?,
            axis("y_location", "YAttachment")?,
            axis("z_location", "ZAttachment")?,
        ];
        let range = coordinate.map_or((0.0, 0.0), |c: usize| self.list[c].range);
        Ok(MovingPoint { frame, coordinate, range, place })
    }

    fn wrap(&self, node: Node<'a>, points: usize) -> Result<PathWrap, OsimProblem> {
        let (name, at) = self.reader.required_text(node, "wrap_object")?;
        let Some(object) = self.objects.find(&name) else {
            let what = format!("a path over `{name}`, which is not there or not supported,");
            return Err(OsimProblem::unsupported(at.place(), &what, "a path over supported surfaces"));
        };
        let method = match self.reader.text(node, "method").unwrap_or_default().to_ascii_lowercase().as_str() {
            "midpoint" => WrapMethod::Midpoint,
            "axial" => WrapMethod::Axial,
            _ => WrapMethod::Hybrid,
        };
        let [first, last] = self.reader.fixed(node, "range", Some([-1.0, -1.0]))?;
        let index = |number: f64| {
            // OpenSim counts from 1; what is below means all.
            let whole = if number >= 1.0 { Some(number as usize - 1) } else { None };
            match whole {
                Some(index) if number.fract() != 0.0 || index >= points => {
                    let problem = format!("the points are numbered from 1 to {points}");
                    Err(OsimProblem::invalid(node.place(), &number.to_string(), problem))
                }
                other => Ok(other),
            }
        };
        let range = (index(first)?, index(last)?);
        if let (Some(first), Some(last)) = range
            && first > last
        {
            let found = format!("{} {}", first + 1, last + 1);
            return Err(OsimProblem::invalid(node.place(), &found, "the first point of a range comes before its last"));
        }
        Ok(PathWrap { object, method, range })
    }
}
