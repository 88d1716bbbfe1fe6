//! Holds the results of the walk through the bodies that later steps need.

use super::item::Item;
use crate::xml::Place;
use nalgebra::{Isometry3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Results of the walk that later steps need.
#[derive(Default)]
pub(super) struct Built<'a> {
    /// Where each segment stands in the file.
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
    pub(super) site_names: BTreeSet<&'a str>,
}

/// One degree of freedom in the world at the file's configuration.
pub(super) struct Freedom {
    pub(super) segment: usize,
    pub(super) motion: Motion,
    pub(super) armature: f64,
}

/// How it moves.
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
