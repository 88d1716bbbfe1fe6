//! Scales what is fixed to bodies: frames, markers, stations, points of paths, and surfaces that paths wrap over.

use nalgebra::Vector3;

use super::Scaler;
use super::edits::{number, vector};
use crate::osim::attributes::objects;
use crate::osim::error::OsimProblem;
use crate::osim::functions;
use crate::xml::Node;

/// Axes of a moving point: its function, the name in older documents, and the coordinate that drives it.
const MOVING: [(&str, &str, &str); 3] = [
    ("x_location", "XAttachment", "x_coordinate"),
    ("y_location", "YAttachment", "y_coordinate"),
    ("z_location", "ZAttachment", "z_coordinate"),
];

impl<'a> Scaler<'_, 'a> {
    pub(super) fn places(&mut self) -> Result<(), OsimProblem> {
        let parts = self.parts;
        let (reader, scene) = (parts.reader, parts.scene);
        for (path, node) in scene.offset_frames() {
            let factors = self.of(scene.frame(reader, node, "socket_parent", path)?.body);
            self.place(node, "translation", factors)?;
            self.meshes(node, factors)?;
        }
        for &marker in scene.markers() {
            let path = format!("/markerset/{}", reader.name(marker)?);
            let factors = self.of(scene.frame_of_point(reader, marker, &path)?.body);
            self.place(marker, "location", factors)?;
        }
        for (body, set) in scene.wrap_sets() {
            let factors = self.of(body);
            for surface in objects(Some(set)) {
                self.surface(surface, factors)?;
            }
        }
        for &force in &scene.forces {
            self.points(force)?;
        }
        objects(parts.model.child("ContactGeometrySet")).for_each(|_| self.leave("contact geometries"));
        Ok(())
    }

    fn place(&mut self, node: Node<'a>, property: &str, factors: Vector3<f64>) -> Result<(), OsimProblem> {
        let before = self.parts.reader.vector(node, property, Some(Vector3::zeros()))?;
        self.edits.set_properties(node, &[(property, vector(before.component_mul(&factors)))]);
        Ok(())
    }

    /// Scales the points of a force's path.
    fn points(&mut self, force: Node<'a>) -> Result<(), OsimProblem> {
        let (reader, scene) = (self.parts.reader, self.parts.scene);
        let Some(path) = force.children().find(|child| child.name() == "GeometryPath") else {
            if force.children().any(|child| child.name().ends_with("Path")) {
                self.leave("paths that are no GeometryPath");
            }
            return Ok(());
        };
        let within = format!("/forceset/{}/{}", reader.name(force)?, path.attribute("name").unwrap_or("geometrypath"));
        for point in objects(path.child("PathPointSet")) {
            let name = format!("{within}/{}", reader.name(point)?);
            let factors = self.of(scene.frame_of_point(reader, point, &name)?.body);
            if point.name() == "MovingPathPoint" {
                self.moving(point, factors)?;
            } else {
                self.place(point, "location", factors)?;
            }
        }
        Ok(())
    }

    /// Scales the functions of a moving point; OpenSim leaves those without a coordinate.
    fn moving(&mut self, point: Node<'a>, factors: Vector3<f64>) -> Result<(), OsimProblem> {
        let reader = self.parts.reader;
        for ((new, old, coordinate), factor) in MOVING.into_iter().zip(factors.iter()) {
            let driven = [coordinate.to_owned(), format!("socket_{coordinate}")];
            let driven = driven.iter().any(|name| reader.text(point, name).is_some_and(|text| !text.is_empty()));
            let named = |name: &'static str| reader.object(point, name, |_| false).map(|function| (name, function));
            match named(new).or_else(|| named(old)) {
                Some((name, function)) if driven => self.multiply(point, name, function, *factor)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Multiplies a function, the property `name` of `owner`.
    pub(super) fn multiply(
        &mut self,
        owner: Node<'a>,
        name: &str,
        function: Node<'a>,
        factor: f64,
    ) -> Result<(), OsimProblem> {
        let (inside, outside) = (function.whole(), owner.whole());
        if inside.start < outside.start || inside.end > outside.end {
            // The function is that of a <defaults> section, which others share.
            self.leave("functions of a <defaults> section");
        } else if function.name() == "MultiplierFunction" {
            let before = self.parts.reader.number(function, "scale", Some(1.0))?;
            self.edits.set_properties(function, &[("scale", number(before * factor))]);
        } else if functions::is_function(function.name()) {
            let (before, after) = (
                format!("<MultiplierFunction name=\"{name}\"><function>"),
                format!("</function><scale>{}</scale></MultiplierFunction>", number(factor)),
            );
            self.edits.wrap(function, &before, &after);
        }
        Ok(())
    }

    /// Scales a surface by its own axes: radii by the mean of the factors across, lengths by those along.
    fn surface(&mut self, node: Node<'a>, factors: Vector3<f64>) -> Result<(), OsimProblem> {
        let reader = self.parts.reader;
        let pose = reader.pose(node, "translation", "xyz_body_rotation")?;
        let along = |axis: usize| {
            let axis = Vector3::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 });
            (pose.rotation * axis).component_mul(&factors).norm()
        };
        let across = (along(0) + along(1)) * 0.5;
        let sizes: &[(&str, f64, f64)] = match node.name() {
            "WrapCylinder" => &[("radius", across, 1.0), ("length", along(2), 1.0)],
            "WrapSphere" => &[("radius", factors.sum() / 3.0, 0.05)],
            "WrapTorus" => &[("inner_radius", across, 0.01), ("outer_radius", across, 0.05)],
            "WrapEllipsoid" => &[],
            _ => {
                self.leave("surfaces of unknown kinds");
                return Ok(());
            }
        };
        let translation = reader.vector(node, "translation", Some(Vector3::zeros()))?.component_mul(&factors);
        let mut properties = vec![("translation", vector(translation))];
        for &(name, factor, default) in sizes {
            properties.push((name, number(reader.number(node, name, Some(default))? * factor)));
        }
        if node.name() == "WrapEllipsoid" {
            let sizes = reader.vector(node, "dimensions", Some(Vector3::repeat(0.05)))?;
            let sizes = sizes.component_mul(&Vector3::new(along(0), along(1), along(2)));
            properties.push(("dimensions", vector(sizes)));
        }
        self.edits.set_properties(node, &properties);
        Ok(())
    }
}
