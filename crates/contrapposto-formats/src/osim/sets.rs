//! Finds bodies, joints and frames of a model by name, before they are joined together.

use std::collections::{HashMap, HashSet};

use nalgebra::{Matrix3, Vector3};

use super::attributes::{Reader, objects};
use super::error::OsimProblem;
use super::frames::{Attachment, Frames};
use crate::model_ir::{Ignored, ModelIr, near};
use crate::xml::Node;

/// From this version on a body does not contain its joint.
pub(super) const SETS_FROM: u32 = 30500;

/// A body with its mass.
pub(super) struct SceneBody<'a> {
    pub(super) name: String,
    pub(super) node: Node<'a>,
    pub(super) mass: f64,
    pub(super) center_of_mass: Vector3<f64>,
    pub(super) inertia: Matrix3<f64>,
}

/// A joint and the frames that it joins.
pub(super) struct SceneJoint<'a> {
    pub(super) name: String,
    pub(super) node: Node<'a>,
    pub(super) parent: Attachment,
    pub(super) child: Attachment,
    /// The older form, in which coordinates may be left out.
    pub(super) old: bool,
}

/// A model's parts.
pub(super) struct Scene<'a> {
    pub(super) bodies: Vec<SceneBody<'a>>,
    pub(super) joints: Vec<SceneJoint<'a>>,
    pub(super) forces: Vec<Node<'a>>,
    pub(super) constraints: Vec<Node<'a>>,
    markers: Vec<Node<'a>>,
    frames: Frames<'a>,
    by_name: HashMap<String, usize>,
    /// The element of ground, where there is one.
    ground: Option<Node<'a>>,
}

/// Sets whose members do not matter: element, and the name of its members in messages.
const IGNORED_SETS: [(&str, &str); 4] = [
    ("ControllerSet", "controllers"),
    ("ContactGeometrySet", "contact geometries"),
    ("ProbeSet", "probes"),
    ("AnalysisSet", "analyses"),
];

/// Sections read elsewhere, or without things in them.
const KNOWN_SECTIONS: [&str; 18] = [
    "Ground",
    "gravity",
    "credits",
    "publications",
    "length_units",
    "force_units",
    "assembly_accuracy",
    "defaults",
    "components",
    "BodySet",
    "JointSet",
    "ForceSet",
    "ConstraintSet",
    "MarkerSet",
    "ComponentSet",
    "ModelVisualPreferences",
    "notes",
    "frames",
];

const COMPONENTS: &str = "joints, forces, constraints, markers, PhysicalOffsetFrame and things that do not matter";

impl<'a> Scene<'a> {
    pub(super) fn collect(
        reader: &Reader<'a>,
        model: Node<'a>,
        version: u32,
        ignored: &mut Ignored,
    ) -> Result<Self, OsimProblem> {
        let mut scene = Self {
            bodies: Vec::new(),
            joints: Vec::new(),
            forces: Vec::new(),
            constraints: Vec::new(),
            markers: Vec::new(),
            frames: Frames::default(),
            by_name: HashMap::new(),
            ground: model.child("Ground"),
        };
        for section in model.children() {
            let name = section.name();
            if let Some((_, kind)) = IGNORED_SETS.iter().find(|(set, _)| *set == name) {
                ignored.add(kind, objects(Some(section)).count());
            } else if !KNOWN_SECTIONS.contains(&name) {
                ignored.add("unknown sections", 1);
            }
        }
        let set = |name| members(model, name);
        let sections = [model.child("Ground")].into_iter().flatten().chain(set("BodySet")?);
        for node in sections {
            count_geometry(node, ignored);
        }
        for node in set("BodySet")? {
            scene.add_body(reader, node, version, ignored)?;
        }
        scene.frames.add_base("/ground".to_owned(), None);
        scene.frames.add_offsets(reader, "/ground", inside(model.child("Ground")))?;
        for (index, body) in scene.bodies.iter().enumerate() {
            let path = format!("/bodyset/{}", body.name);
            scene.frames.add_offsets(reader, &path, inside(Some(body.node)))?;
            scene.frames.add_base(path, Some(index));
        }
        let mut joints = Vec::from_iter(set("JointSet")?.map(|node| (node, "/jointset")));
        scene.forces.extend(set("ForceSet")?);
        scene.constraints.extend(set("ConstraintSet")?);
        scene.markers.extend(set("MarkerSet")?);
        for &force in scene.forces.iter().filter(|node| node.name().ends_with("BushingForce")) {
            let path = format!("/forceset/{}", reader.name(force)?);
            let frames = force.child("frames").into_iter().chain(force.child("components")).flat_map(Node::children);
            scene.frames.add_offsets(reader, &path, frames)?;
        }
        for (nodes, path) in
            [(Vec::from_iter(inside(Some(model))), ""), (Vec::from_iter(set("ComponentSet")?), "/componentset")]
        {
            scene.add_components(reader, nodes, path, &mut joints, ignored)?;
        }
        scene.add_joints(reader, joints)?;
        scene.add_old_joints(reader, version)?;
        Ok(scene)
    }

    /// Sorts components by their kind; joints go to `joints`, with the path that they stand under.
    fn add_components<'p>(
        &mut self,
        reader: &Reader<'a>,
        nodes: Vec<Node<'a>>,
        path: &'p str,
        joints: &mut Vec<(Node<'a>, &'p str)>,
        ignored: &mut Ignored,
    ) -> Result<(), OsimProblem> {
        self.frames.add_offsets(reader, path, nodes.iter().copied())?;
        for node in nodes {
            match Component::of(node.name()) {
                Component::Frame => {}
                Component::Joint => joints.push((node, path)),
                Component::Force => self.forces.push(node),
                Component::Constraint => self.constraints.push(node),
                Component::Marker => self.markers.push(node),
                Component::Harmless(kind) => ignored.add(kind, 1),
                Component::Unknown => {
                    return Err(OsimProblem::unsupported(node.place(), node.name(), COMPONENTS));
                }
            }
        }
        Ok(())
    }

    fn add_body(
        &mut self,
        reader: &Reader<'a>,
        node: Node<'a>,
        version: u32,
        ignored: &mut Ignored,
    ) -> Result<(), OsimProblem> {
        if node.name() != "Body" {
            return Err(OsimProblem::unsupported(node.place(), node.name(), "<Body>"));
        }
        let name = reader.unique_name(node)?;
        if version < SETS_FROM && name == "ground" {
            self.ground = Some(node);
            return Ok(());
        }
        if self.by_name.insert(name.clone(), self.bodies.len()).is_some() {
            return Err(OsimProblem::Twice { place: node.place(), what: "body", name });
        }
        let mass = reader.number(node, "mass", None)?;
        if mass < 0.0 {
            return Err(OsimProblem::invalid(node.place(), &mass.to_string(), "a mass must not be negative"));
        }
        let center_of_mass = match reader.vector(node, "mass_center", Some(Vector3::zeros())) {
            // Of a body without mass it has no meaning.
            Err(OsimProblem::Number(crate::numbers::NumberError::NotFinite { .. })) if mass == 0.0 => Vector3::zeros(),
            other => other?,
        };
        let inertia = reader.inertia(node)?;
        ignored.add("inertias that are not finite", usize::from(inertia.is_none()));
        let inertia = inertia.unwrap_or_default();
        self.bodies.push(SceneBody { name, node, mass, center_of_mass, inertia });
        Ok(())
    }

    fn add_joints(&mut self, reader: &Reader<'a>, nodes: Vec<(Node<'a>, &str)>) -> Result<(), OsimProblem> {
        let mut named = Vec::with_capacity(nodes.len());
        for (node, set) in nodes {
            let name = reader.unique_name(node)?;
            let path = format!("{set}/{name}");
            let frames = node.child("frames").into_iter().chain(node.child("components")).flat_map(Node::children);
            self.frames.add_offsets(reader, &path, frames)?;
            named.push((node, name, path));
        }
        for (node, name, path) in named {
            let parent = self.frames.socket(reader, node, "socket_parent_frame", &path)?;
            let child = self.frames.socket(reader, node, "socket_child_frame", &path)?;
            self.joints.push(SceneJoint { name, node, parent, child, old: false });
        }
        Ok(())
    }

    fn add_old_joints(&mut self, reader: &Reader<'a>, version: u32) -> Result<(), OsimProblem> {
        for (index, body) in self.bodies.iter().enumerate() {
            let Some(node) = body.node.child("Joint").and_then(|joint| joint.children().next()) else { continue };
            if version >= SETS_FROM {
                let what = format!("a joint inside a body in a document of version {version}");
                return Err(OsimProblem::unsupported(node.place(), &what, "a joint in <JointSet>"));
            }
            let parent = self.old_body(reader, node, "parent_body")?;
            let parent = Attachment {
                body: parent,
                pose: reader.old_pose(node, "location_in_parent", "orientation_in_parent")?,
            };
            let child = Attachment { body: Some(index), pose: reader.old_pose(node, "location", "orientation")? };
            let (parent, child) = if reader.flag(node, "reverse", false)? { (child, parent) } else { (parent, child) };
            self.joints.push(SceneJoint { name: reader.name(node)?, node, parent, child, old: true });
        }
        Ok(())
    }

    /// The markers.
    pub(super) fn markers(&self) -> &[Node<'a>] {
        &self.markers
    }

    /// Frames that are fixed to others, with their paths.
    pub(super) fn offset_frames(&self) -> Vec<(&str, Node<'a>)> {
        self.frames.offsets()
    }

    /// The frame that the socket `name` of the component at `path` is connected to.
    pub(super) fn frame(
        &self,
        reader: &Reader<'a>,
        component: Node<'a>,
        name: &str,
        path: &str,
    ) -> Result<Attachment, OsimProblem> {
        self.frames.socket(reader, component, name, path)
    }

    /// Sets of surfaces that paths wrap over, each with the body that carries it.
    pub(super) fn wrap_sets(&self) -> impl Iterator<Item = (Option<usize>, Node<'a>)> {
        let ground = self.ground.into_iter().map(|node| (None, node));
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| (Some(index), body.node));
        ground.chain(bodies).filter_map(|(body, node)| Some((body, node.child("WrapObjectSet")?)))
    }

    /// The frame of a point: by `socket_parent_frame` of the component at `path`, or by `body` in older documents.
    pub(super) fn frame_of_point(
        &self,
        reader: &Reader<'a>,
        node: Node<'a>,
        path: &str,
    ) -> Result<Attachment, OsimProblem> {
        if node.child("body").is_some() && node.child("socket_parent_frame").is_none() {
            Ok(Attachment { body: self.old_body(reader, node, "body")?, pose: nalgebra::Isometry3::identity() })
        } else {
            self.frames.socket(reader, node, "socket_parent_frame", path)
        }
    }

    /// A frame of a bushing, the first or the second: by a socket, or by body and pose in older documents.
    pub(super) fn frame_of_bushing(
        &self,
        reader: &Reader<'a>,
        node: Node<'a>,
        path: &str,
        number: usize,
    ) -> Result<Attachment, OsimProblem> {
        if node.child(&format!("body_{number}")).is_none() {
            return self.frames.socket(reader, node, &format!("socket_frame{number}"), path);
        }
        let body = self.old_body(reader, node, &format!("body_{number}"))?;
        let [location, orientation] = ["location", "orientation"].map(|what| format!("{what}_body_{number}"));
        Ok(Attachment { body, pose: reader.old_pose(node, &location, &orientation)? })
    }

    /// The segment of a body; `None` for ground.
    pub(super) fn segment(&self, body: Option<usize>, segments: &HashMap<&str, usize>) -> Option<usize> {
        body.and_then(|index| segments.get(self.bodies[index].name.as_str()).copied())
    }

    /// A body by its name, as older documents give it; `None` is ground.
    fn old_body(&self, reader: &Reader<'a>, node: Node<'a>, property: &str) -> Result<Option<usize>, OsimProblem> {
        let (name, place) = reader.required_text(node, property)?;
        if name == "ground" {
            return Ok(None);
        }
        self.by_name.get(&name).map(|&index| Some(index)).ok_or_else(|| OsimProblem::Unknown {
            place: place.place(),
            what: "body",
            near: near(&name, self.bodies.iter().map(|b| b.name.as_str())),
            name: crate::xml::shorten(&name),
        })
    }
}

/// Members of a set of the model.
fn members<'a>(model: Node<'a>, name: &str) -> Result<impl Iterator<Item = Node<'a>> + use<'a>, OsimProblem> {
    match model.child(name) {
        Some(set) if set.attribute("file").is_some() => {
            let accepted = "the set inside this file (open it in OpenSim and save it)";
            Err(OsimProblem::unsupported(set.attribute_place("file"), "a set in a file of its own", accepted))
        }
        set => Ok(objects(set)),
    }
}

/// Components inside an element.
fn inside<'a>(node: Option<Node<'a>>) -> impl Iterator<Item = Node<'a>> + use<'a> {
    node.and_then(|n| n.child("components")).into_iter().flat_map(Node::children)
}

enum Component {
    Frame,
    Joint,
    Force,
    Constraint,
    Marker,
    Harmless(&'static str),
    Unknown,
}

impl Component {
    fn of(name: &str) -> Self {
        match name {
            "PhysicalOffsetFrame" => Self::Frame,
            "Marker" => Self::Marker,
            "Station" => Self::Harmless("stations"),
            _ if name.ends_with("Joint") => Self::Joint,
            _ if name.ends_with("Constraint") => Self::Constraint,
            _ if ["Force", "Muscle", "Actuator", "Spring", "Ligament"].iter().any(|end| name.ends_with(end)) => {
                Self::Force
            }
            _ if name.ends_with("Controller") => Self::Harmless("controllers"),
            _ if name.ends_with("Probe") => Self::Harmless("probes"),
            _ if name.ends_with("Geometry") || name.starts_with("Contact") => Self::Harmless("contact geometries"),
            _ if name.ends_with("Reporter") || name.starts_with("Table") => Self::Harmless("reporters"),
            _ => Self::Unknown,
        }
    }
}

/// Counts the geometry and wrapping objects of a body.
fn count_geometry(body: Node<'_>, ignored: &mut Ignored) {
    let attached = body.child("attached_geometry").into_iter().flat_map(Node::children).count();
    let old = body.child("VisibleObject").and_then(|v| v.child("GeometrySet"));
    ignored.add("meshes", attached + objects(old).count());
    ignored.add("wrap objects", objects(body.child("WrapObjectSet")).count());
}

/// Reads the markers; `body.segments` must be there.
pub(super) fn stations<'a>(
    reader: &Reader<'a>,
    scene: &Scene<'a>,
    body: &mut ModelIr,
    ignored: &mut Ignored,
) -> Result<(), OsimProblem> {
    let segments: HashMap<&str, usize> = body.segments.iter().zip(0..).map(|(s, i)| (s.name.as_str(), i)).collect();
    let mut seen = HashSet::new();
    let mut stations = Vec::new();
    for &node in &scene.markers {
        let name = reader.unique_name(node)?;
        let frame = scene.frame_of_point(reader, node, &format!("/markerset/{name}"))?;
        let location = frame.pose * nalgebra::Point3::from(reader.vector(node, "location", Some(Vector3::zeros()))?);
        let Some(segment) = scene.segment(frame.body, &segments) else {
            ignored.add("markers fixed to ground", 1);
            continue;
        };
        if !seen.insert(name.clone()) {
            return Err(OsimProblem::Twice { place: node.place(), what: "marker", name });
        }
        stations.push((name, segment, location.coords));
    }
    ignored.add("markers", stations.len());
    body.stations = stations;
    Ok(())
}
