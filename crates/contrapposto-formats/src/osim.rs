//! Reads OpenSim's `.osim` files as a [`ModelIr`].
//!
//! Documents of OpenSim 4 (bodies and joints in two sets, offset frames) and the older form (joints inside their child
//! body), from version 10901 on. A property that a document leaves out has the value of a `<defaults>` section of the model,
//! else OpenSim's default. Actuators, meshes and the like do not matter to quasi-static torque: they are counted in [`ModelIr::ignored`].
//! Muscles that are not supported do not refuse the model: [`ModelIr::muscles`] counts them.
//! A part that matters and is not supported is an [`OsimError`] with its place.
//!
//! Rotations of ball and free joints are three body-fixed x, y, z angles, as OpenSim's coordinates are; the torques that
//! belong to them are those of the angles. (OpenSim's solver prints moments about the parent's axes in these rows.)

mod attributes;
mod coordinates;
mod error;
pub mod expression;
mod force;
mod frames;
mod functions;
mod joint;
mod muscle;
mod path;
pub mod scaling;
mod sets;
mod springs;
mod tree;
mod wrap;

pub use error::{OsimError, OsimProblem};

use crate::model_ir::{Ignored, ModelIr};
use crate::xml::{self, Limits};
use attributes::Reader;

/// Oldest version that is read: before it, custom joints were written otherwise.
const OLDEST: u32 = 10901;

/// Reads a file's bytes. `file_name` stands in errors only.
///
/// # Errors
/// [`OsimError`] with the place and the accepted alternative.
pub fn read(text: &[u8], file_name: &str) -> Result<ModelIr, OsimError> {
    read_with(text, file_name, &Limits::default())
}

/// [`read`] with other caps.
///
/// # Errors
/// [`OsimError`] with the place and the accepted alternative.
pub fn read_with(text: &[u8], file_name: &str, limits: &Limits) -> Result<ModelIr, OsimError> {
    body(text, limits).map_err(|problem| OsimError { file: file_name.to_owned(), problem: Box::new(problem) })
}

fn body(text: &[u8], limits: &Limits) -> Result<ModelIr, OsimProblem> {
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
    let mut body = ModelIr {
        name: reader.name(model)?,
        gravity: reader.vector(model, "gravity", Some(nalgebra::Vector3::new(0.0, -9.80665, 0.0)))?,
        credits: reader.text(model, "credits"),
        ..ModelIr::default()
    };
    let coordinates = tree::assemble(&reader, &scene, &mut body, &mut ignored)?;
    force::read(&reader, &scene, &coordinates, &mut body, &mut ignored)?;
    body.muscles = muscle::read(&reader, &scene, &coordinates, &body);
    sets::stations(&reader, &scene, &mut body, &mut ignored)?;
    body.coordinates = coordinates.into_list();
    body.ignored = ignored.into_list();
    Ok(body)
}
