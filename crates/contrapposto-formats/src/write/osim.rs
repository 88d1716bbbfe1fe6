//! Writes a model as an OpenSim 4 document.
//!
//! Every joint is a `CustomJoint`, `BallJoint` or `WeldJoint` between two offset frames. A chain of motions that is not "three
//! translations, then three rotations" is turned round, or else becomes several joints with bodies without mass between them.
//! Passive laws that OpenSim 4.6 has no force for are written as `ExpressionBasedCoordinateForce`, with the very formula that we evaluate.

use contrapposto::model::{Adult, Coordinate, CoordinateKind, Model, Placement, Segment};
use contrapposto::muscle::Musculature;
use contrapposto::passive::CoordinateLimitForce;
use nalgebra::Vector3;

use super::law::{self, Part};
use super::names::Names;
use super::osim_joint::{Axis, Driver, Piece, filler, pieces};
use super::osim_muscles::{Carried, Frames, wrap_objects};
use super::steps::resting;
use super::xml::{Xml, moments, number, numbers};
use super::{WriteError, Written, common, exact, listed, osim_functions};
use crate::adult_text::credits;
use crate::markers::ModelMarker;

/// Characters that OpenSim refuses in a name.
fn accepts(c: char) -> bool {
    !(c.is_whitespace() || "\\/*+".contains(c))
}

/// Writes the model as an `.osim` document.
///
/// The `credits` of the built-in adult name its size, by which [`crate::tissue::SourcedModel::fill`] finds again what is lost.
/// Lost: muscle groups; laws that couple several joints; quaternions of balls, which become three body-fixed x, y, z angles
/// named `{joint}_rx`, `{joint}_ry`, `{joint}_rz`; names with blanks or slashes.
///
/// ```
/// use contrapposto::model::{Adult, adult};
/// let written = contrapposto_formats::write::osim(&adult(&Adult::default())?)?;
/// assert!(written.text.contains("<Coordinate name=\"elbow_flex_r\">"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] for names that XML cannot hold, and for joints whose chain must be split at a coordinate that moves both parts.
pub fn osim(model: &Model) -> Result<Written, WriteError> {
    document(model, &Musculature::default(), &[]).map(|(written, _)| written)
}

/// The model with muscles and markers, and the numbers of these that the document has.
pub(super) fn document(
    model: &Model,
    muscles: &Musculature,
    markers: &[ModelMarker],
) -> Result<(Written, Carried), WriteError> {
    let mut lost = common(model, |_| false)?;
    let mut writer = Writer::new(model, &mut lost)?;
    let mut carried = Carried { wrap_objects: muscles.paths.wrap_objects.len(), ..Carried::default() };
    writer.xml.open("OpenSimDocument", &[("Version", "40000")]);
    let name = Names::new(&[], accepts).keep("model", model.name(), &mut lost);
    writer.xml.open("Model", &[("name", &name)]);
    if let Some(size) = Adult::of(model) {
        writer.xml.value("credits", &credits(&size));
    }
    writer.xml.value("gravity", &numbers(&model.gravity()));
    writer.xml.open("Ground", &[("name", "ground")]);
    wrap_objects(&mut writer.xml, muscles, None);
    writer.xml.close();
    writer.set("BodySet", |writer| writer.bodies(muscles));
    writer.set("JointSet", |writer| {
        for index in 0..model.segments().len() {
            writer.joints(index, &mut lost);
        }
    });
    writer.set("ForceSet", |writer| {
        let mut names = Names::new(&[], accepts);
        let frames = Frames { model: writer.model, bodies: &writer.bodies, coordinates: &writer.coordinate_paths };
        (carried.muscles, carried.springs) = frames.forces(&mut writer.xml, muscles, &mut names, &mut lost);
        writer.forces(names, &mut lost);
    });
    writer.set("ConstraintSet", |writer| writer.couplings(&mut lost));
    if !markers.is_empty() {
        carried.markers = markers.len();
        writer.set("MarkerSet", |writer| {
            let frames = Frames { model: writer.model, bodies: &writer.bodies, coordinates: &writer.coordinate_paths };
            frames.markers(&mut writer.xml, markers);
        });
    }
    Ok((Written { text: writer.xml.finish(&lost), lost }, carried))
}

pub(super) struct Writer<'m> {
    model: &'m Model,
    xml: Xml,
    /// Of each segment: name of its body.
    bodies: Vec<String>,
    /// Of each segment: its joints, and the names of the bodies without mass between them.
    pub(super) pieces: Vec<(Vec<Piece<'m>>, Vec<String>)>,
    joints: Names,
    /// Of each coordinate: its path in the file, once joints are written.
    coordinate_paths: Vec<String>,
    /// Of each coordinate: its name, and whether OpenSim counts it in degrees, in forces and tables.
    pub(super) coordinates: Vec<(String, bool)>,
}

impl<'m> Writer<'m> {
    pub(super) fn new(model: &'m Model, lost: &mut Vec<String>) -> Result<Self, WriteError> {
        let mut names = Names::new(&["ground"], accepts);
        let bodies: Vec<String> = model.segments().iter().map(|s| names.keep("segment", &s.name, lost)).collect();
        let mut taken = Names::new(&[], accepts);
        let own = |c: &Coordinate| (c.name.clone(), c.kind == CoordinateKind::Rotation);
        let mut coordinates: Vec<(String, bool)> = model.coordinates().iter().map(own).collect();
        // Names that fit stay, whatever the others must become.
        for fit in [true, false] {
            let named = model.coordinates().iter().zip(&mut coordinates);
            for (coordinate, (name, _)) in named.filter(|(c, _)| c.kind != CoordinateKind::Quaternion) {
                if taken.fits(&coordinate.name) == fit {
                    *name = taken.keep("coordinate", &coordinate.name, lost);
                }
            }
        }
        let mut all = vec![];
        for (segment, body) in model.segments().iter().zip(&bodies) {
            let parts = pieces(segment);
            let mut seen = vec![false; segment.coordinates.len()];
            for piece in &parts {
                for c in piece.coordinates() {
                    if std::mem::replace(&mut seen[c - segment.coordinates.start], true) {
                        let problem = "OpenSim's joints have three translations, then three rotations; \
                                       this chain must be split, and one of its coordinates would move both parts";
                        return Err(WriteError::Joint { joint: segment.joint.clone(), problem });
                    }
                    coordinates[c].1 = piece.in_degrees(c);
                }
                if let Some(first) = piece.ball {
                    let joint = &segment.joint;
                    for (c, ending) in (first..).zip(["rx", "ry", "rz"]) {
                        coordinates[c] = (taken.take(&format!("{joint}_{ending}")), true);
                        seen[c - segment.coordinates.start] = true;
                    }
                    seen[first + 3 - segment.coordinates.start] = true;
                    let made = &coordinates[first].0;
                    lost.push(format!(
                        "The quaternion of joint `{joint}` is three angles about body-fixed x, y and z in the file, `{made}` first; \
                         torques there are those of the angles."
                    ));
                }
            }
            for (c, _) in segment.coordinates.clone().zip(seen).filter(|(_, seen)| !seen) {
                lost.push(format!(
                    "The coordinate `{}` moves nothing and is not written.",
                    model.coordinates()[c].name
                ));
            }
            let between = (1..parts.len()).map(|n| names.take(&format!("{body}_part{n}"))).collect();
            all.push((parts, between));
        }
        let joints = Names::new(&[], accepts);
        let coordinate_paths = vec![String::new(); coordinates.len()];
        Ok(Self { model, xml: Xml::new(), bodies, pieces: all, joints, coordinate_paths, coordinates })
    }

    fn set(&mut self, tag: &'static str, inside: impl FnOnce(&mut Self)) {
        self.xml.open(tag, &[]);
        self.xml.open("objects", &[]);
        inside(self);
        self.xml.close();
        self.xml.close();
    }

    fn bodies(&mut self, muscles: &Musculature) {
        for (index, segment) in self.model.segments().iter().enumerate() {
            for name in &self.pieces[index].1 {
                body(&mut self.xml, name, None, |_| {});
            }
            body(&mut self.xml, &self.bodies[index], Some(segment), |xml| wrap_objects(xml, muscles, Some(index)));
        }
    }

    fn joints(&mut self, index: usize, lost: &mut Vec<String>) {
        let segment = &self.model.segments()[index];
        let (parts, between) = &self.pieces[index];
        let parent = segment.parent.map_or("/ground".to_owned(), |p| format!("/bodyset/{}", self.bodies[p]));
        let own = format!("/bodyset/{}", self.bodies[index]);
        let chain: Vec<String> = between.iter().map(|name| format!("/bodyset/{name}")).collect();
        let last = parts.len() - 1;
        for (n, piece) in parts.iter().enumerate() {
            let name = if n == last {
                self.joints.keep("joint", &segment.joint, lost)
            } else {
                self.joints.take(&format!("{}_part{}", segment.joint, n + 1))
            };
            let identity = Placement::identity();
            let from = if n == 0 { (&parent, segment.in_parent) } else { (&chain[n - 1], identity) };
            let to = if n == last { (&own, segment.in_segment) } else { (&chain[n], identity) };
            let (from, to) = if piece.turned { (to, from) } else { (from, to) };
            let kind = match piece {
                Piece { ball: Some(_), slides, .. } if slides.is_empty() => "BallJoint",
                _ if piece.axes().next().is_none() => "WeldJoint",
                _ => "CustomJoint",
            };
            let xml = &mut self.xml;
            xml.open(kind, &[("name", &name)]);
            xml.value("socket_parent_frame", "parent_offset");
            xml.value("socket_child_frame", "child_offset");
            xml.open("coordinates", &[]);
            let all = self.model.coordinates();
            for c in piece.coordinates() {
                self.coordinate_paths[c] = format!("/jointset/{name}/{}", self.coordinates[c].0);
                let angle = piece.ball.filter(|&b| c >= b).map(|b| exact::xyz(&resting(&all[b..b + 4]))[c - b]);
                coordinate(xml, &self.coordinates[c].0, angle, &all[c]);
            }
            xml.close();
            xml.open("frames", &[]);
            for (name, (body, pose)) in [("parent_offset", from), ("child_offset", to)] {
                xml.open("PhysicalOffsetFrame", &[("name", name)]);
                xml.value("socket_parent", body);
                xml.value("translation", &numbers(&pose.translation.vector));
                xml.value("orientation", &numbers(&exact::xyz(&pose.rotation)));
                xml.close();
            }
            xml.close();
            if kind == "CustomJoint" {
                transform(xml, piece, &self.coordinates, lost);
            }
            xml.close();
        }
    }

    fn forces(&mut self, mut names: Names, lost: &mut Vec<String>) {
        let mut coupled = vec![];
        for (c, coordinate) in self.model.coordinates().iter().enumerate() {
            let Some(law) = &coordinate.passive else { continue };
            let (name, degrees) = &self.coordinates[c];
            let Some(parts) = law::summands(law) else {
                coupled.push(coordinate.name.as_str());
                continue;
            };
            for part in parts {
                force(&mut self.xml, &names.take(&format!("{name}_passive")), (name, *degrees), &part);
            }
        }
        if !coupled.is_empty() {
            lost.push(format!("The passive torques of {} have no OpenSim force.", listed(&coupled)));
        }
    }

    fn couplings(&mut self, lost: &mut Vec<String>) {
        let mut names = Names::new(&[], accepts);
        for coupling in self.model.couplings() {
            let [dependent, independent] = [coupling.dependent, coupling.independent].map(|c| &self.coordinates[c].0);
            let xml = &mut self.xml;
            xml.open("CoordinateCouplerConstraint", &[("name", &names.take(&format!("{dependent}_coupling")))]);
            xml.value("isEnforced", "true");
            // Constraints have their functions inside a property, joints by name.
            xml.open("coupled_coordinates_function", &[]);
            if !osim_functions::write(xml, None, &coupling.function) {
                lost.push(format!("`{dependent}` follows `{independent}` by a function that OpenSim has not."));
            }
            xml.close();
            xml.value("independent_coordinate_names", independent);
            xml.value("dependent_coordinate_name", dependent);
            xml.value("scale_factor", "1");
            xml.close();
        }
    }
}

fn body(xml: &mut Xml, name: &str, segment: Option<&Segment>, inside: impl FnOnce(&mut Xml)) {
    xml.open("Body", &[("name", name)]);
    xml.value("mass", &number(segment.map_or(0.0, |s| s.mass)));
    xml.value("mass_center", &numbers(&segment.map_or(Vector3::zeros(), |s| s.center_of_mass)));
    xml.value("inertia", &numbers(&segment.map_or([0.0; 6], |s| moments(&s.inertia))));
    inside(xml);
    xml.close();
}

/// A coordinate; of a ball, its angle at the default.
fn coordinate(xml: &mut Xml, name: &str, ball: Option<f64>, source: &Coordinate) {
    let full = std::f64::consts::PI;
    let (default, range) = ball.map_or((source.default, source.range), |angle| (angle, (-full, full)));
    // OpenSim knows infinity by this word only; our reader takes any.
    let limit = |value: f64| match value {
        f64::INFINITY => "Inf".to_owned(),
        f64::NEG_INFINITY => "-Inf".to_owned(),
        _ => number(value),
    };
    xml.open("Coordinate", &[("name", name)]);
    xml.value("default_value", &number(default));
    xml.value("range", &format!("{} {}", limit(range.0), limit(range.1)));
    xml.value("clamped", "false");
    xml.value("locked", if source.locked { "true" } else { "false" });
    xml.close();
}

fn transform(xml: &mut Xml, piece: &Piece<'_>, coordinates: &[(String, bool)], lost: &mut Vec<String>) {
    const ROTATIONS: [&str; 3] = ["rotation1", "rotation2", "rotation3"];
    const TRANSLATIONS: [&str; 3] = ["translation1", "translation2", "translation3"];
    xml.open("SpatialTransform", &[]);
    for (slots, axes) in [(ROTATIONS, &piece.hinges), (TRANSLATIONS, &piece.slides)] {
        let mut used: Vec<Vector3<f64>> = axes.iter().map(|axis| axis.direction.into_inner()).collect();
        for (n, slot) in slots.into_iter().enumerate() {
            xml.open("TransformAxis", &[("name", slot)]);
            match axes.get(n) {
                Some(axis) => transform_axis(xml, axis, coordinates, lost),
                None => {
                    let free = filler(&used);
                    used.push(free);
                    xml.value("coordinates", "");
                    xml.value("axis", &numbers(&free));
                    constant(xml, 0.0);
                }
            }
            xml.close();
        }
    }
    xml.close();
}

fn transform_axis(xml: &mut Xml, axis: &Axis<'_>, coordinates: &[(String, bool)], lost: &mut Vec<String>) {
    let names: Vec<&str> = axis.driver.coordinates().iter().map(|&c| coordinates[c].0.as_str()).collect();
    xml.value("coordinates", &names.join(" "));
    xml.value("axis", &numbers(&exact::axis(&axis.direction)));
    match &axis.driver {
        Driver::Constant(value) => constant(xml, *value),
        Driver::Linear(terms, intercept) => {
            xml.open("LinearFunction", &[("name", "function")]);
            xml.value("coefficients", &numbers(terms.iter().map(|(_, slope)| slope).chain([intercept])));
            xml.close();
        }
        Driver::Function(function, _) => {
            if !osim_functions::write(xml, Some("function"), function) {
                constant(xml, 0.0);
                lost.push(format!("The motion that {} drives uses a function that OpenSim has not.", listed(&names)));
            }
        }
    }
}

fn constant(xml: &mut Xml, value: f64) {
    xml.open("Constant", &[("name", "function")]);
    xml.value("value", &number(value));
    xml.close();
}

fn force(xml: &mut Xml, name: &str, (coordinate, degrees): (&str, bool), part: &Part<'_>) {
    let kind = match part {
        Part::Spring { .. } => "SpringGeneralizedForce",
        Part::Limit(_) => "CoordinateLimitForce",
        Part::Polynomial { .. } | Part::Formula(_) => "ExpressionBasedCoordinateForce",
    };
    xml.open(kind, &[("name", name)]);
    xml.value("coordinate", coordinate);
    match part {
        Part::Spring { stiffness, rest } => {
            xml.value("stiffness", &number(*stiffness));
            xml.value("rest_length", &number(*rest));
            xml.value("viscosity", "0");
        }
        Part::Limit(law) => limit_force(xml, law, degrees),
        Part::Polynomial { coefficients, rest } => xml.value("expression", &law::polynomial(coefficients, *rest)),
        Part::Formula(text) => xml.value("expression", text),
    }
    xml.close();
}

/// In degrees for a coordinate that OpenSim calls rotational.
fn limit_force(xml: &mut Xml, law: &CoordinateLimitForce, degrees: bool) {
    let unit = if degrees { 1f64.to_radians() } else { 1.0 };
    let angle = |value: f64| number(exact::near(value / unit, |v| v * unit == value));
    let stiffness = |value: f64| number(exact::near(value * unit, |v| v / unit == value));
    xml.value("upper_stiffness", &stiffness(law.upper_stiffness));
    xml.value("upper_limit", &angle(law.upper_limit));
    xml.value("lower_stiffness", &stiffness(law.lower_stiffness));
    xml.value("lower_limit", &angle(law.lower_limit));
    xml.value("transition", &angle(law.transition));
    xml.value("damping", "0");
}
