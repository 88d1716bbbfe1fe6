//! Scales the text of an OpenSim model, as OpenSim 4.6's ScaleTool scales a model; all that is not scaled stays as the file has it.
//!
//! A body's factors multiply, along its axes: mass centre, meshes, frames fixed to it, markers and stations, points of paths, surfaces that
//! paths wrap over, and translations of custom joints whose parent it is. Masses and inertia follow `inertia.rs`. Lengths of fibres,
//! tendons and ligaments follow the length of their path in the default posture: [`with_path_lengths`] comes second, with the paths of
//! the scaled model.

mod bodies;
mod edits;
mod inertia;
mod joints;
mod markers;
mod paths;
mod places;

pub use markers::{PlacedMarkers, SetMarker, with_markers, with_placed_markers};
pub use paths::with_path_lengths;

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::attributes::Reader;
use super::error::{OsimError, OsimProblem};
use super::sets::{SETS_FROM, Scene};
use crate::model_ir::Ignored;
use crate::xml::{self, Limits, Node};
use edits::Edits;

/// The factors of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scaling {
    /// Factors along the axes of bodies, by name; 1 for the others.
    pub factors: BTreeMap<String, Vector3<f64>>,
    /// Masses keep their proportions; else they grow with the volumes.
    pub preserve_mass_distribution: bool,
    /// Mass of the whole scaled model, kg; as it comes when left out.
    pub mass: Option<f64>,
    /// New name of the model.
    pub name: Option<String>,
}

/// A scaled model.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaled {
    /// Text of the file.
    pub text: String,
    /// Numbers of things that keep their size though they may belong to a scaled body, by kind.
    pub left: BTreeMap<&'static str, usize>,
}

/// Parts of a file.
struct Parts<'p, 'a> {
    model: Node<'a>,
    reader: &'p Reader<'a>,
    scene: &'p Scene<'a>,
}

/// Reads a file and does a job with it.
fn with_parts<T>(
    text: &str,
    file_name: &str,
    job: impl for<'p, 'a> FnOnce(Parts<'p, 'a>) -> Result<T, OsimProblem>,
) -> Result<T, OsimError> {
    let limits = Limits::default();
    let run = || {
        let document = xml::parse(text.as_bytes(), &limits)?;
        let root = document.root();
        let version = root.attribute("Version").and_then(|v| v.trim().parse::<u32>().ok()).unwrap_or(0);
        if root.name() != "OpenSimDocument" || version < SETS_FROM {
            let accepted = "an OpenSimDocument of version 30500 or later (open an older file in OpenSim 4 and save it)";
            let what = format!("<{}> of version {version}", root.name());
            return Err(OsimProblem::unsupported(root.place(), &what, accepted));
        }
        let Some(model) = root.child("Model") else {
            return Err(OsimProblem::Missing { place: root.place(), what: "a <Model>".to_owned() });
        };
        let reader = Reader::new(model, &limits);
        let scene = Scene::collect(&reader, model, version, &mut Ignored::default())?;
        job(Parts { model, reader: &reader, scene: &scene })
    };
    run().map_err(|problem| OsimError { file: file_name.to_owned(), problem: Box::new(problem) })
}

/// A text without the byte order mark, from which positions in it count.
fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Names of the bodies of a model file.
///
/// # Errors
/// [`OsimError`] for a file that is no model of OpenSim, or of a version below 30500.
pub fn bodies(text: &str, file_name: &str) -> Result<Vec<String>, OsimError> {
    with_parts(text, file_name, |parts| Ok(parts.scene.bodies.iter().map(|body| body.name.clone()).collect()))
}

/// Scales the text of a model. Factors of bodies that the model lacks are not used.
///
/// # Errors
/// [`OsimError`] for a file that is no model of OpenSim, or of a version below 30500, or a part of it that cannot be scaled.
pub fn scaled(text: &str, file_name: &str, scaling: &Scaling) -> Result<Scaled, OsimError> {
    let text = unmarked(text);
    with_parts(text, file_name, |parts| {
        let factor = |name: &String| scaling.factors.get(name).copied().unwrap_or(Vector3::repeat(1.0));
        let factors: Vec<Vector3<f64>> = parts.scene.bodies.iter().map(|body| factor(&body.name)).collect();
        let mut scaler = Scaler { parts: &parts, factors, edits: Edits::new(text), left: BTreeMap::new() };
        if let Some(name) = &scaling.name {
            scaler.edits.set_attribute(parts.model, "name", name);
        }
        scaler.bodies(scaling)?;
        scaler.places()?;
        scaler.joints()?;
        scaler.couplings()?;
        Ok(Scaled { text: scaler.edits.apply(), left: scaler.left })
    })
}

/// A model while it is scaled.
struct Scaler<'p, 'a> {
    parts: &'p Parts<'p, 'a>,
    /// By body.
    factors: Vec<Vector3<f64>>,
    edits: Edits<'p>,
    left: BTreeMap<&'static str, usize>,
}

impl Scaler<'_, '_> {
    /// Factors of a body; 1 for ground.
    fn of(&self, body: Option<usize>) -> Vector3<f64> {
        body.map_or(Vector3::repeat(1.0), |body| self.factors[body])
    }

    /// Counts a thing that is not scaled.
    fn leave(&mut self, kind: &'static str) {
        *self.left.entry(kind).or_default() += 1;
    }
}
