//! Scales masses, mass centres, inertia and meshes of bodies.

use nalgebra::{Matrix3, Vector3};

use super::edits::{number, vector};
use super::inertia;
use super::{Scaler, Scaling};
use crate::osim::error::OsimProblem;
use crate::xml::Node;

impl<'a> Scaler<'_, 'a> {
    pub(super) fn bodies(&mut self, scaling: &Scaling) -> Result<(), OsimProblem> {
        let parts = self.parts;
        let bodies = &parts.scene.bodies;
        let mut scaled = Vec::with_capacity(bodies.len());
        for (body, factors) in bodies.iter().zip(&self.factors) {
            let known = parts.reader.inertia(body.node)?;
            let with_mass = !scaling.preserve_mass_distribution;
            let before = (body.mass, known.unwrap_or_default());
            let (mass, inertia) = inertia::scaled(before, *factors, with_mass);
            scaled.push((mass, known.map(|_| inertia)));
        }
        let total: f64 = scaled.iter().map(|(mass, _)| mass).sum();
        let all = scaling.mass.map_or(1.0, |mass| mass / total);
        if !all.is_finite() {
            let accepted = "bodies with mass, where the mass of the person is given";
            return Err(OsimProblem::unsupported(parts.model.place(), &format!("a body of {total} kg"), accepted));
        }
        for ((body, factors), (mass, inertia)) in bodies.iter().zip(self.factors.clone()).zip(scaled) {
            let center = body.center_of_mass.component_mul(&factors);
            let mut properties = vec![("mass", number(mass * all)), ("mass_center", vector(center))];
            // An inertia that is not finite stays.
            properties.extend(inertia.map(|inertia| ("inertia", six(inertia * all))));
            self.edits.set_properties(body.node, &properties);
            self.meshes(body.node, factors)?;
        }
        Ok(())
    }

    /// Scales the meshes of a body or frame.
    pub(super) fn meshes(&mut self, owner: Node<'a>, factors: Vector3<f64>) -> Result<(), OsimProblem> {
        for mesh in owner.child("attached_geometry").into_iter().flat_map(Node::children) {
            let before = self.parts.reader.vector(mesh, "scale_factors", Some(Vector3::repeat(1.0)))?;
            self.edits.set_properties(mesh, &[("scale_factors", vector(before.component_mul(&factors)))]);
        }
        Ok(())
    }
}

/// Moments, then products.
fn six(m: Matrix3<f64>) -> String {
    let all = [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(0, 2)], m[(1, 2)]];
    all.map(number).join(" ")
}
