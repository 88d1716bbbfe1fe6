//! Scales translations of custom joints, and couplings of translations.

use nalgebra::Vector3;

use super::Scaler;
use super::edits::number;
use crate::model_ir::{CoordinateKind, Ignored, ModelIr};
use crate::osim::error::OsimProblem;
use crate::osim::functions;
use crate::osim::joint::{declared, transform_axes};
use crate::osim::tree;

/// Joints without lengths of their own.
const WITHOUT_LENGTHS: [&str; 9] = [
    "WeldJoint",
    "PinJoint",
    "SliderJoint",
    "UniversalJoint",
    "GimbalJoint",
    "BallJoint",
    "FreeJoint",
    "PlanarJoint",
    "CustomJoint",
];

impl Scaler<'_, '_> {
    /// Translations grow with the factors of the parent's body, weighted by the parts of the axis. A coordinate that is a translation
    /// by itself stays.
    pub(super) fn joints(&mut self) -> Result<(), OsimProblem> {
        let parts = self.parts;
        let reader = parts.reader;
        for joint in &parts.scene.joints {
            if !WITHOUT_LENGTHS.contains(&joint.node.name()) {
                self.leave("joints of other kinds");
            }
            let transform =
                (joint.node.name() == "CustomJoint").then(|| reader.property(joint.node, "SpatialTransform"));
            let Some(transform) = transform.flatten() else { continue };
            let factors = self.of(joint.parent.body);
            for axis in transform_axes(transform)?[..3].iter().flatten() {
                let Some(function) = reader.object(*axis, "function", functions::is_function) else { continue };
                let is_coordinate = function.name() == "LinearFunction" && {
                    let coefficients = reader.list(function, "coefficients")?.unwrap_or_else(|| vec![1.0, 0.0]);
                    coefficients.first() == Some(&1.0) && coefficients.get(1) == Some(&0.0)
                };
                if is_coordinate {
                    continue;
                }
                let along = reader.vector(*axis, "axis", Some(Vector3::x()))?.abs();
                self.multiply(*axis, "function", function, along.dot(&factors))?;
            }
        }
        Ok(())
    }

    /// A coupling whose dependent coordinate is a translation grows with the factor of its joint's parent.
    pub(super) fn couplings(&mut self) -> Result<(), OsimProblem> {
        let parts = self.parts;
        let (reader, scene) = (parts.reader, parts.scene);
        let couplers = scene.constraints.iter().filter(|node| node.name() == "CoordinateCouplerConstraint");
        let couplers: Vec<_> = couplers.copied().collect();
        if couplers.is_empty() {
            return Ok(());
        }
        let coordinates = tree::assemble(reader, scene, &mut ModelIr::default(), &mut Ignored::default())?;
        for coupler in couplers {
            let (name, at) = reader.required_text(coupler, "dependent_coordinate_name")?;
            let index = coordinates.find(&name, at)?;
            let named = |node: &crate::xml::Node<'_>| node.attribute("name") == Some(name.as_str());
            let joint = scene.joints.iter().find(|joint| declared(joint.node).iter().any(named));
            let Some(joint) = joint.filter(|_| coordinates.list()[index].kind == CoordinateKind::Translation) else {
                continue;
            };
            let factors = self.of(joint.parent.body);
            if factors.x != factors.y || factors.x != factors.z {
                let what = format!("a coupling of the distance `{name}` on a body with three factors");
                let accepted = "the same factor along x, y and z";
                return Err(OsimProblem::unsupported(coupler.place(), &what, accepted));
            }
            let before = reader.number(coupler, "scale_factor", Some(1.0))?;
            self.edits.set_properties(coupler, &[("scale_factor", number(before * factors.x))]);
        }
        Ok(())
    }
}
