//! Computes the gradient of external torque of one block of postures, for weights and forces fixed in ground.
//!
//! The formulas are those of [`crate::statics::ExternalTorque::gradient`]: one vector a rate, one dot product a pair of rates on one
//! chain, both entries of which are the same.

use multiversion::multiversion;

use super::kernel::Frames;
use super::lanes::{Lanes, Rotations, Vectors};
use super::loads::{Effect, Pulls};
use super::plan::{Node, Plan, Way};
use crate::model::Model;
use crate::statics::FixedIn;

/// Sums over the loads at and beyond every node of one block.
#[derive(Clone, Debug)]
pub(super) struct Virials(Vec<Rotations>);

impl Virials {
    pub(super) fn new(plan: &Plan) -> Self {
        Self(vec![Rotations::ZERO; plan.nodes.len()])
    }
}

/// Computes all entries, row after row, once [`super::kernel::statics`] has computed the block. The model has as many rates as
/// elementary rates and no load is a couple or fixed in a segment.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub(super) fn gradient(
    model: &Model,
    plan: &Plan,
    pulls: &Pulls,
    frames: &Frames,
    virials: &mut Virials,
    entries: &mut [Lanes],
) {
    entries.fill(Lanes::ZERO);
    gather(pulls, frames, virials);
    for (i, node) in plan.nodes.iter().enumerate().rev() {
        let virial = virials.0[i];
        if let Some(parent) = node.parent.filter(|_| pulls.beyond[i]) {
            virials.0[parent] = virials.0[parent].plus(virial);
        }
        write_node(model, plan, frames, (i, node), pulls.beyond[i].then_some(virial), entries);
    }
}

/// `sum x f^T` of the loads on every node alone, by its columns.
#[inline(always)]
fn gather(pulls: &Pulls, frames: &Frames, virials: &mut Virials) {
    if pulls.all.is_empty() {
        return;
    }
    virials.0.fill(Rotations::ZERO);
    for pull in &pulls.all {
        let Effect::Force([x, y, z], FixedIn::World) = pull.effect else { continue };
        let point = frames.rotations[pull.node].turn_all(pull.point) + frames.origins[pull.node];
        virials.0[pull.node] = virials.0[pull.node].plus(Rotations([point * x, point * y, point * z]));
    }
}

/// The entries of pairs of which the farther one is a motion of a node.
#[inline(always)]
fn write_node(
    model: &Model,
    plan: &Plan,
    frames: &Frames,
    (i, node): (usize, &Node),
    virial: Option<Rotations>,
    entries: &mut [Lanes],
) {
    let (n, point) = (frames.axes.len(), frames.origins[i]);
    let lever = frames.moments[i] - point * node.carried;
    let along = lever.dot_all(plan.gravity);
    let force = if virial.is_some() { frames.forces[i][0] } else { Vectors::ZERO };
    let virial = virial.map(|Rotations([x, y, z])| {
        let [fx, fy, fz] = force.0;
        Rotations([x - point * fx, y - point * fy, z - point * fz])
    });
    for mobility in node.motions.clone() {
        let step = &plan.steps[mobility];
        let slides = matches!(step.way, Way::Slide(_));
        let own = step.element..step.element + if matches!(step.way, Way::Ball) { 3 } else { 1 };
        let nearer = &model.ancestors[model.ancestor_starts[mobility]..model.ancestor_starts[mobility + 1]];
        for element in own.clone() {
            let axis = frames.axes[element];
            let mut bend = if slides {
                axis.cross_all(plan.gravity) * node.carried + axis.cross(force)
            } else {
                lever * axis.dot_all(plan.gravity) - axis * along
            };
            if let Some(virial) = virial.filter(|_| !slides) {
                bend = bend + (virial.turn(axis) - axis * virial.trace());
            }
            for other in own.clone().filter(|_| !slides) {
                entries[element * n + other] = frames.axes[other].dot(bend);
            }
            for &other in nearer {
                let entry = frames.axes[other].dot(bend);
                entries[element * n + other] = entry;
                entries[other * n + element] = entry;
            }
        }
    }
}
