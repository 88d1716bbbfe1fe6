//! Reads the surfaces that paths wrap over.

use std::collections::HashMap;

use contrapposto::model::LARGEST;
use contrapposto::muscle::{Quadrant, WrapObject, WrapShape};
use nalgebra::Vector3;

use super::attributes::{Reader, objects};
use super::error::OsimProblem;
use super::sets::Scene;
use crate::model_ir::MuscleTally;
use crate::xml::Node;

const WRAP_SHAPES: &str = "WrapCylinder, WrapSphere, WrapEllipsoid, WrapTorus";

/// The surfaces, and the index of each by its name.
#[derive(Default)]
pub(super) struct WrapObjects {
    pub(super) list: Vec<WrapObject>,
    by_name: HashMap<String, usize>,
}

impl WrapObjects {
    /// Reads all surfaces; the tally counts them.
    pub(super) fn read<'a>(
        reader: &Reader<'a>,
        scene: &Scene<'a>,
        segments: &HashMap<&str, usize>,
        tally: &mut MuscleTally,
    ) -> Self {
        let mut all = Self::default();
        for (body, set) in scene.wrap_sets() {
            let segment = scene.segment(body, segments);
            for node in objects(Some(set)) {
                match object(reader, node, segment) {
                    Ok(object) => {
                        tally.read(node.name());
                        all.by_name.entry(object.name.clone()).or_insert(all.list.len());
                        all.list.push(object);
                    }
                    Err(why) => tally.refused(node.name(), why.to_string()),
                }
            }
        }
        all
    }

    /// The surface of a name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }
}

fn object<'a>(reader: &Reader<'a>, node: Node<'a>, segment: Option<usize>) -> Result<WrapObject, OsimProblem> {
    let length = |name, default| {
        let value = reader.number(node, name, Some(default))?;
        if value > 0.0 && value <= LARGEST {
            return Ok(value);
        }
        let needs = format!("{name} must be above 0 and at most 1e9 m");
        Err(OsimProblem::invalid(node.place(), &value.to_string(), needs))
    };
    let half_axes = || {
        let sizes = reader.vector(node, "dimensions", Some(Vector3::from_element(0.05)))?;
        if sizes.min() > 0.0 && sizes.max() <= LARGEST {
            return Ok(sizes);
        }
        let found = format!("{} {} {}", sizes.x, sizes.y, sizes.z);
        Err(OsimProblem::invalid(node.place(), &found, "dimensions must be above 0 and at most 1e9 m"))
    };
    let torus = || {
        let (tube, circle) = (length("inner_radius", 0.01)?, length("outer_radius", 0.05)?);
        if tube < circle {
            return Ok(WrapShape::Torus { tube, circle });
        }
        Err(OsimProblem::invalid(node.place(), &circle.to_string(), format!("outer_radius must be above {tube}")))
    };
    let shape = match node.name() {
        "WrapCylinder" => WrapShape::Cylinder { radius: length("radius", 1.0)?, length: length("length", 1.0)? },
        "WrapSphere" => WrapShape::Sphere { radius: length("radius", 0.05)? },
        "WrapEllipsoid" => WrapShape::Ellipsoid { half_axes: half_axes()? },
        "WrapTorus" => torus()?,
        other => return Err(OsimProblem::unsupported(node.place(), other, WRAP_SHAPES)),
    };
    let pose = reader.pose(node, "translation", "xyz_body_rotation")?;
    let far = pose.translation.vector.amax();
    if far > LARGEST {
        return Err(OsimProblem::invalid(node.place(), &far.to_string(), "a surface is at most 1e9 m away"));
    }
    Ok(WrapObject {
        name: reader.unique_name(node)?,
        segment,
        pose,
        quadrant: quadrant(&reader.text(node, "quadrant").unwrap_or_default()),
        active: reader.flag(node, "active", true)?,
        shape,
    })
}

/// The half that a word names; all of it for every other word, as in OpenSim.
fn quadrant(word: &str) -> Quadrant {
    let half = |axis, positive| Quadrant::Half { axis, positive };
    match word.to_ascii_lowercase().as_str() {
        "x" | "+x" => half(0, true),
        "-x" => half(0, false),
        "y" | "+y" => half(1, true),
        "-y" => half(1, false),
        "z" | "+z" => half(2, true),
        "-z" => half(2, false),
        _ => Quadrant::All,
    }
}
