//! Which body does an OpenSim `.osim` file describe?
//!
//! Documents of OpenSim 4 (bodies and joints in two sets, offset frames) and the older form (joints inside their child
//! body), from version 10901 on. What a document leaves out has OpenSim's default, that of a `<defaults>` section of the model
//! first. Muscles, actuators, meshes and the like do not matter to quasi-static torque: they are counted in [`Body::ignored`].
//! What matters and is not supported is an [`OsimError`] with its place.
//!
//! Rotations of ball and free joints are three body-fixed x, y, z angles, as OpenSim's coordinates are; the torques that
//! belong to them are those of the angles. (OpenSim's solver prints moments about the parent's axes in these rows.)

mod attributes;
mod coordinates;
mod error;
mod force;
mod frames;
mod functions;
mod joint;
mod sets;
mod tree;

pub use error::{OsimError, OsimProblem};

use std::collections::BTreeMap;

use crate::body::Body;
use crate::xml::{self, Limits, Node};
use attributes::Reader;

/// Oldest version that is read: before it, custom joints were written otherwise.
const OLDEST: u32 = 10901;
/// From this version on a body does not contain its joint.
const SETS_FROM: u32 = 30500;

/// Reads a file's bytes. `file_name` stands in errors only.
///
/// # Errors
/// [`OsimError`] with the place and what would be accepted.
pub fn read(text: &[u8], file_name: &str) -> Result<Body, OsimError> {
    read_with(text, file_name, &Limits::default())
}

/// [`read`] with other caps.
///
/// # Errors
/// [`OsimError`] with the place and what would be accepted.
pub fn read_with(text: &[u8], file_name: &str, limits: &Limits) -> Result<Body, OsimError> {
    body(text, limits).map_err(|problem| OsimError { file: file_name.to_owned(), problem: Box::new(problem) })
}

/// Kinds of things read past, and how many of each.
#[derive(Default)]
struct Ignored(BTreeMap<String, usize>);

impl Ignored {
    fn add(&mut self, kind: &str, count: usize) {
        if count > 0 {
            *self.0.entry(kind.to_owned()).or_default() += count;
        }
    }
}

fn body(text: &[u8], limits: &Limits) -> Result<Body, OsimProblem> {
    let document = xml::parse(text, limits)?;
    let root = document.root();
    if root.name() != "OpenSimDocument" {
        return Err(OsimProblem::unsupported(root.place(), root.name(), "a document whose root is <OpenSimDocument>"));
    }
    let version = root.attribute("Version").and_then(|v| v.trim().parse::<u32>().ok());
    let Some(version) = version.filter(|v| (OLDEST..50_000).contains(v)) else {
        let found = root.attribute("Version").unwrap_or("no version");
        let accepted = "Version=\"10901\" to \"49999\" (open an older file in OpenSim 4 and save it)";
        return Err(OsimProblem::unsupported(root.attribute_place("Version"), found, accepted));
    };
    let Some(model) = root.child("Model") else {
        return Err(OsimProblem::Missing { place: root.place(), what: "a <Model>".to_owned() });
    };
    let reader = Reader::new(model, limits);
    let mut ignored = Ignored::default();
    let scene = sets::Scene::collect(&reader, model, version, &mut ignored)?;
    let mut body = Body {
        name: reader.name(model)?,
        gravity: reader.vector(model, "gravity", Some(nalgebra::Vector3::new(0.0, -9.80665, 0.0)))?,
        ..Body::default()
    };
    let coordinates = tree::assemble(&reader, &scene, &mut body, &mut ignored)?;
    force::read(&reader, &scene, &coordinates, &mut body, &mut ignored)?;
    sets::stations(&reader, &scene, &mut body, &mut ignored)?;
    body.coordinates = coordinates.into_list();
    body.ignored = ignored.0.into_iter().collect();
    Ok(body)
}

/// Children of a set: those of its `<objects>`.
fn objects<'a>(set: Option<Node<'a>>) -> impl Iterator<Item = Node<'a>> {
    set.and_then(|s| s.child("objects")).into_iter().flat_map(Node::children)
}
