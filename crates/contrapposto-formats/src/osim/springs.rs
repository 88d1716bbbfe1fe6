//! Reads ligaments and springs along paths, and bushings. One that is not supported is counted with its reason, and does not refuse the
//! model.

use contrapposto::model::LARGEST;
use contrapposto::muscle::{Bushing, Ligament, LigamentLaw};
use nalgebra::Vector3;

use super::attributes::Reader;
use super::error::OsimProblem;
use super::functions;
use super::path::Surroundings;
use crate::model_ir::{Function, MusclesIr, Spline};
use crate::xml::Node;

/// Kinds of forces that are read here.
pub(super) const KINDS: [&str; 4] = ["Ligament", "Blankevoort1991Ligament", "PathSpring", "BushingForce"];

/// Length over slack length, and force over its greatest, of OpenSim's `Ligament` without a curve of its own (`Ligament.cpp`).
const CURVE: [[f64; 13]; 2] = [
    [-5.0, 0.998, 0.999, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.601, 1.602, 5.0],
    [0.0, 0.0, 0.0, 0.0, 0.035, 0.12, 0.26, 0.55, 1.17, 2.0, 2.0, 2.0, 2.0],
];

/// Adds one of them; gives the kinds of its path's points.
pub(super) fn read<'a>(
    around: &Surroundings<'_, 'a>,
    node: Node<'a>,
    all: &mut MusclesIr,
) -> Result<Vec<&'a str>, OsimProblem> {
    let name = around.reader.unique_name(node)?;
    if node.name() == "BushingForce" {
        let bushing = bushing(around, node, name)?;
        all.musculature.bushings.push(bushing);
        return Ok(vec![]);
    }
    let law = law(around.reader, node)?;
    let (path, points) = around.path(node)?;
    all.musculature.ligaments.push(Ligament { name, path: all.musculature.paths.paths.len(), law });
    all.musculature.paths.paths.push(path);
    Ok(points)
}

fn law<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<LigamentLaw, OsimProblem> {
    let number = |name: &str, default: Option<f64>, least: f64| {
        let value = reader.number(node, name, default)?;
        if value >= least && value <= LARGEST {
            return Ok(value);
        }
        let needs = format!("{name} must be {least} or more, and at most 1e9");
        Err(OsimProblem::invalid(node.place(), &value.to_string(), needs))
    };
    let length = |name: &str, default: Option<f64>| {
        let value = number(name, default, 0.0)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(OsimProblem::invalid(node.place(), "0", format!("{name} must be above 0")))
    };
    Ok(match node.name() {
        "Blankevoort1991Ligament" => LigamentLaw::Blankevoort1991 {
            slack_length: length("slack_length", Some(0.0))?,
            stiffness: number("linear_stiffness", Some(1.0), 0.0)?,
            transition_strain: number("transition_strain", Some(0.06), 0.0)?,
        },
        "PathSpring" => LigamentLaw::Spring {
            slack_length: number("resting_length", None, 0.0)?,
            stiffness: number("stiffness", None, 0.0)?,
        },
        _ => {
            let curve = match reader.object(node, "force_length_curve", functions::is_function) {
                Some(function) => functions::read(reader, function)?,
                None => Function::Spline(
                    Spline::simm(&CURVE[0], &CURVE[1])
                        .map_err(|why| OsimProblem::invalid(node.place(), "force_length_curve", why.to_string()))?,
                ),
            };
            LigamentLaw::Curve {
                slack_length: length("resting_length", Some(0.0))?,
                force: number("pcsa_force", Some(0.0), 0.0)?,
                curve,
            }
        }
    })
}

fn bushing<'a>(around: &Surroundings<'_, 'a>, node: Node<'a>, name: String) -> Result<Bushing, OsimProblem> {
    let reader = around.reader;
    let path = format!("/forceset/{name}");
    let [first, second] = [1, 2].map(|number| around.scene.frame_of_bushing(reader, node, &path, number));
    let (first, second) = (first?, second?);
    let stiffness = |name: &str| {
        let stiffness = reader.vector(node, name, Some(Vector3::zeros()))?;
        if stiffness.min() >= 0.0 && stiffness.max() <= LARGEST {
            return Ok(stiffness);
        }
        let found = format!("{} {} {}", stiffness.x, stiffness.y, stiffness.z);
        Err(OsimProblem::invalid(node.place(), &found, format!("{name} must be 0 or more, and at most 1e9")))
    };
    Ok(Bushing {
        name,
        segments: [first.body, second.body].map(|body| around.scene.segment(body, around.segments)),
        frames: [first.pose, second.pose],
        rotational_stiffness: stiffness("rotational_stiffness")?,
        translational_stiffness: stiffness("translational_stiffness")?,
        bands: vec![],
    })
}
