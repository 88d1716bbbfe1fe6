//! Holds the results of the walk through the bodies that later steps need.

use super::attributes::Attributes;
use super::compiler::Settings;
use super::error::MjcfError;
use super::geom::surface;
use super::item::Item;
use crate::xml::Place;
use contrapposto::muscle::TendonGeom;
use nalgebra::{Isometry3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Results of the walk that later steps need.
#[derive(Default)]
pub(super) struct Built<'a> {
    /// Place of each segment in the file.
    pub(super) places: Vec<Place>,
    /// Hinges and slides by name: coordinate and reference value.
    pub(super) joints: BTreeMap<&'a str, (usize, f64)>,
    /// Least and greatest torque (N m) of all actuators of a hinge together, by coordinate.
    pub(super) torques: BTreeMap<usize, [f64; 2]>,
    /// All degrees of freedom at the file's configuration.
    pub(super) freedoms: Vec<Freedom>,
    /// Springs whose stiffness is still to be found.
    pub(super) pending: Vec<Pending>,
    /// Segments' frames in the world at the file's configuration.
    pub(super) poses: Vec<Isometry3<f64>>,
    /// Whether each segment moves against the ground.
    pub(super) moves: Vec<bool>,
    /// Names that the file gives to bodies and joints, so that made-up ones differ.
    pub(super) given: BTreeSet<&'a str>,
    pub(super) top: Vec<Item<'a>>,
    /// An unnamed free joint has taken the name "root".
    pub(super) root_named: bool,
    pub(super) body_names: BTreeSet<&'a str>,
    pub(super) joint_names: BTreeSet<&'a str>,
    /// Sites by name: segment, `None` for the world, and place in its frame.
    pub(super) sites: BTreeMap<&'a str, (Option<usize>, Vector3<f64>)>,
    /// Geoms by name as surfaces of tendons, or why a geom is none.
    pub(super) geoms: BTreeMap<&'a str, Result<TendonGeom, MjcfError>>,
}

impl<'a> Built<'a> {
    /// Keeps a geom of a segment, `None` for the world, for tendons to name.
    pub(super) fn add_geom(
        &mut self,
        geom: &Attributes<'a, '_>,
        segment: Option<usize>,
        frame: &Isometry3<f64>,
        settings: &Settings,
    ) {
        if let Some(name) = geom.item.attribute("name") {
            self.geoms.entry(name).or_insert_with(|| surface(geom, segment, frame, settings));
        }
    }
}

/// One degree of freedom in the world at the file's configuration.
pub(super) struct Freedom {
    pub(super) segment: usize,
    pub(super) motion: Motion,
    pub(super) armature: f64,
}

/// Motion of a degree of freedom.
pub(super) enum Motion {
    /// About an axis through a point.
    Turn(Vector3<f64>, Vector3<f64>),
    /// Along an axis.
    Slide(Vector3<f64>),
}

/// A spring that waits for its stiffness.
pub(super) struct Pending {
    pub(super) freedom: usize,
    /// Index in [`ModelIr::passive`](crate::model_ir::ModelIr::passive).
    pub(super) spring: usize,
    /// Time constant, s, and damping ratio.
    pub(super) wanted: [f64; 2],
    pub(super) place: Place,
}
