//! Reads properties of an object: child elements, or those of its type in a `<defaults>` section.

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::error::OsimProblem;
use crate::numbers;
use crate::xml::{Limits, Node};

/// Reads properties with their defaults.
pub(super) struct Reader<'a> {
    pub(super) limits: &'a Limits,
    defaults: HashMap<&'a str, Node<'a>>,
}

fn placed(translation: Vector3<f64>, angles: Vector3<f64>) -> Isometry3<f64> {
    let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
    let rotation =
        turn(Vector3::x_axis(), angles.x) * turn(Vector3::y_axis(), angles.y) * turn(Vector3::z_axis(), angles.z);
    Isometry3::from_parts(Translation3::from(translation), UnitQuaternion::from_rotation_matrix(&rotation))
}

type Result<T> = std::result::Result<T, OsimProblem>;

impl<'a> Reader<'a> {
    pub(super) fn new(model: Node<'a>, limits: &'a Limits) -> Self {
        let defaults = model.child("defaults").into_iter().flat_map(Node::children).map(|n| (n.name(), n)).collect();
        Self { limits, defaults }
    }

    /// The element of a property; empty ones count as given.
    pub(super) fn property(&self, object: Node<'a>, name: &str) -> Option<Node<'a>> {
        object.child(name).or_else(|| self.defaults.get(object.name()).and_then(|d| d.child(name)))
    }

    /// A property that is an object: `<name><Kind>` in older files, `<Kind name="name">` in newer ones.
    pub(super) fn object(&self, owner: Node<'a>, name: &str, is_kind: impl Fn(&str) -> bool) -> Option<Node<'a>> {
        if let Some(holder) = self.property(owner, name) {
            return holder.children().next();
        }
        let named = owner.children().find(|n| n.attribute("name") == Some(name));
        named.or_else(|| owner.children().find(|n| is_kind(n.name())))
    }

    /// The name attribute.
    pub(super) fn name(&self, object: Node<'_>) -> Result<String> {
        let name = object.attribute("name").unwrap_or_default().trim();
        if name.len() > self.limits.name_bytes {
            let problem = format!("a name may have {} bytes", self.limits.name_bytes);
            return Err(OsimProblem::invalid(object.attribute_place("name"), name, problem));
        }
        Ok(name.to_owned())
    }

    /// A name, which must not be empty or contain the separators of paths.
    pub(super) fn unique_name(&self, object: Node<'_>) -> Result<String> {
        let name = self.name(object)?;
        if name.is_empty() {
            return Err(OsimProblem::Missing { place: object.attribute_place("name"), what: "a name".to_owned() });
        }
        if name.contains('/') {
            return Err(OsimProblem::invalid(object.attribute_place("name"), &name, "a name must not contain `/`"));
        }
        Ok(name)
    }

    pub(super) fn text(&self, object: Node<'a>, name: &str) -> Option<String> {
        self.property(object, name).map(Node::text)
    }

    pub(super) fn required_text(&self, object: Node<'a>, name: &str) -> Result<(String, Node<'a>)> {
        match self.property(object, name).map(|n| (n.text(), n)) {
            Some((text, node)) if !text.is_empty() => Ok((text, node)),
            _ => Err(OsimProblem::Missing { place: object.place(), what: format!("<{name}>") }),
        }
    }

    /// A finite number; without a default it must be there.
    pub(super) fn number(&self, object: Node<'a>, name: &str, default: Option<f64>) -> Result<f64> {
        match (self.property(object, name), default) {
            (Some(node), _) => Ok(numbers::number(&node.text(), || node.place())?),
            (None, Some(value)) => Ok(value),
            (None, None) => Err(OsimProblem::Missing { place: object.place(), what: format!("<{name}>") }),
        }
    }

    pub(super) fn list(&self, object: Node<'a>, name: &str) -> Result<Option<Vec<f64>>> {
        let Some(node) = self.property(object, name) else { return Ok(None) };
        Ok(Some(numbers::list(&node.text(), 0..=self.limits.numbers, || node.place())?))
    }

    pub(super) fn fixed<const N: usize>(
        &self,
        object: Node<'a>,
        name: &str,
        default: Option<[f64; N]>,
    ) -> Result<[f64; N]> {
        match (self.property(object, name), default) {
            (Some(node), _) => {
                let mut values = [0.0; N];
                numbers::fixed(&node.text(), &mut values, || node.place())?;
                Ok(values)
            }
            (None, Some(values)) => Ok(values),
            (None, None) => Err(OsimProblem::Missing { place: object.place(), what: format!("<{name}>") }),
        }
    }

    pub(super) fn vector(&self, object: Node<'a>, name: &str, default: Option<Vector3<f64>>) -> Result<Vector3<f64>> {
        Ok(self.fixed(object, name, default.map(Into::into))?.into())
    }

    /// `true`, `false`, 1 or 0 in any case, as OpenSim reads them.
    pub(super) fn flag(&self, object: Node<'a>, name: &str, default: bool) -> Result<bool> {
        let Some(node) = self.property(object, name) else { return Ok(default) };
        let text = node.text();
        match text.to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            _ => Err(OsimProblem::invalid(node.place(), &text, "`true` or `false` is accepted")),
        }
    }

    /// Translation and body-fixed x, y, z angles.
    pub(super) fn pose(&self, object: Node<'a>, translation: &str, orientation: &str) -> Result<Isometry3<f64>> {
        let zero = Some(Vector3::zeros());
        Ok(placed(self.vector(object, translation, zero)?, self.vector(object, orientation, zero)?))
    }

    /// The pose of a joint inside a body. OpenSim 4 brings such documents up to date as it reads them, and its text of these
    /// numbers has six digits: what it computes with, we do.
    pub(super) fn old_pose(&self, object: Node<'a>, translation: &str, orientation: &str) -> Result<Isometry3<f64>> {
        let six = |x: f64| format!("{x:.5e}").parse().unwrap_or(x);
        let zero = Some(Vector3::zeros());
        let (t, r) = (self.vector(object, translation, zero)?, self.vector(object, orientation, zero)?);
        Ok(placed(t.map(six), r.map(six)))
    }

    /// Inertia about the centre of mass. It does not matter to statics: `None` if it is not finite.
    pub(super) fn inertia(&self, object: Node<'a>) -> Result<Option<Matrix3<f64>>> {
        const OLD: [&str; 6] = ["inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"];
        let mut values = [0.0; 6];
        if let Some(node) = self.property(object, "inertia") {
            let read = numbers::fixed(&node.text(), &mut values, || node.place());
            if matches!(read, Err(numbers::NumberError::NotFinite { .. })) {
                return Ok(None);
            }
            read?;
        } else {
            for (value, name) in values.iter_mut().zip(OLD) {
                match self.number(object, name, Some(0.0)) {
                    Err(OsimProblem::Number(numbers::NumberError::NotFinite { .. })) => return Ok(None),
                    other => *value = other?,
                }
            }
        }
        let [xx, yy, zz, xy, xz, yz] = values;
        Ok(Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)))
    }
}

/// Children of a set: those of its `<objects>`.
pub(super) fn objects<'a>(set: Option<Node<'a>>) -> impl Iterator<Item = Node<'a>> + use<'a> {
    set.and_then(|s| s.child("objects")).into_iter().flat_map(Node::children)
}
