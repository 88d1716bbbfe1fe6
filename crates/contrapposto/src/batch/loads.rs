//! Prepares loads for blocks of postures: points and directions in the frames of nodes.

use nalgebra::{Point3, Vector3};

use super::plan::Plan;
use crate::model::Model;
use crate::statics::{FixedIn, Load, LoadKind};

/// A force or couple, N or N m, in ground axes or in those of the node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Effect {
    Force([f64; 3], FixedIn),
    Couple([f64; 3], FixedIn),
}

/// A load on a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    pub(super) node: usize,
    /// Point in the frame of the node, m.
    pub(super) point: [f64; 3],
    pub(super) effect: Effect,
}

/// The loads of all postures of a batch.
#[derive(Clone, Debug, Default)]
pub(super) struct Pulls {
    pub(super) all: Vec<Pull>,
    /// By node: loads act at or beyond it.
    pub(super) beyond: Vec<bool>,
    /// Some load is a couple or fixed in a segment.
    pub(super) twisted: bool,
}

impl Pulls {
    /// Replaces them. The mobility of every load ends a node of `plan`. Does not allocate once there were as many.
    pub(super) fn update(&mut self, model: &Model, plan: &Plan, loads: &[Load]) {
        self.all.clear();
        self.all.extend(loads.iter().filter_map(|load| pull(model, plan, load)));
        self.twisted = self.all.iter().any(|pull| !matches!(pull.effect, Effect::Force(_, FixedIn::World)));
        self.beyond.clear();
        self.beyond.resize(plan.nodes.len(), false);
        for pull in &self.all {
            let mut next = Some(pull.node);
            while let Some(node) = next {
                self.beyond[node] = true;
                next = plan.nodes[node].parent;
            }
        }
    }
}

/// The load on its node; `None` on a segment that is fixed to ground.
fn pull(model: &Model, plan: &Plan, load: &Load) -> Option<Pull> {
    let offset = model.segments[load.segment].offset;
    let node = plan.attached(model, load.segment).node?;
    let direction = |v: Vector3<f64>, fixed| match fixed {
        FixedIn::World => v.into(),
        FixedIn::Segment => (offset.rotation * v).into(),
    };
    let effect = match load.kind {
        LoadKind::Weight(mass) => Effect::Force((mass * model.gravity).into(), FixedIn::World),
        LoadKind::Force(force, fixed) => Effect::Force(direction(force, fixed), fixed),
        LoadKind::Couple(couple, fixed) => Effect::Couple(direction(couple, fixed), fixed),
    };
    Some(Pull { node, point: (offset * Point3::from(load.point)).coords.into(), effect })
}
