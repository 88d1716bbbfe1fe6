//! Finds hands that are free and a table or another block on which one of them could rest.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Vector3};

use super::job::Job;
use crate::contact::{Place, Region, Support};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::simulation::Rest;
use crate::tasks::{Obstacle, Task, Thing};

/// Hands that may rest, and the shoulders that they reach from.
const HANDS: [(&str, &str); 2] = [("hand_r", "humerus_r"), ("hand_l", "humerus_l")];
/// Number of segments of an arm: hand, two of the forearm, upper arm.
const ARM: usize = 4;
/// Friction of a palm on a thing: that of the scenario's supports (assumed).
const FRICTION: f64 = 0.6;
/// Least distance of the middle of a palm from the edges of the thing, m (assumed).
const FROM_THE_EDGE: f64 = 0.06;
/// Greatest level distance of the palm from the shoulder at the start, along each axis of the thing, m (assumed).
const REACH: f64 = 0.45;
/// Least and greatest height of the shoulder above the thing, m (assumed).
const BELOW_THE_SHOULDER: (f64, f64) = (0.15, 0.9);

/// A free hand, and the part of a thing on which it could rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RestingHand {
    /// The hand on the thing; its place is free.
    pub support: Support,
    /// Height of the top, m.
    pub height: f64,
    /// Normal of the palm toward the body, segment frame.
    pub inward: Vector3<f64>,
}

impl RestingHand {
    /// As support number `number` of a scenario.
    pub fn rest(&self, number: usize) -> Rest {
        Rest { support: number, height: self.height, inward: self.inward }
    }

    /// Whether a task wants something of a segment of the arm.
    pub(super) fn is_moved_by(&self, model: &Model, task: &Task) -> bool {
        let parent = |&segment: &usize| model.segments()[segment].parent;
        let mut arm = std::iter::successors(Some(self.support.segment), parent).take(ARM);
        arm.any(|segment| task.wants(segment))
    }

    /// The free hands of a job that reach a thing, the first thing of each.
    pub(super) fn all(job: &Job<'_>) -> Vec<Self> {
        let mut kinematics = Kinematics::new(job.model);
        if kinematics.update(job.model, job.start).is_err() {
            return vec![];
        }
        let free = HANDS.into_iter().filter_map(|(hand, shoulder)| {
            let (hand, shoulder) = (job.model.segment(hand)?, job.model.segment(shoulder)?);
            is_free(job, hand).then_some((hand, kinematics.placement(job.model, shoulder).translation.vector))
        });
        let on_thing = |(hand, shoulder)| blocks(job).find_map(|block| Self::on(job, hand, shoulder, block));
        free.filter_map(on_thing).collect()
    }

    /// A hand on the top of a block; `None` where that is out of reach.
    fn on(
        job: &Job<'_>,
        segment: usize,
        shoulder: Vector3<f64>,
        (placement, half): (Isometry3<f64>, Vector3<f64>),
    ) -> Option<Self> {
        let up = job.up()?;
        let local = placement.rotation.inverse() * up;
        let (vertical, across) = (local.iamax(), [(local.iamax() + 1) % 3, (local.iamax() + 2) % 3]);
        let from = placement.inverse_transform_point(&shoulder.into());
        let top = half[vertical] * local[vertical].signum();
        let span = across.map(|axis| {
            let inside = half[axis] - FROM_THE_EDGE;
            ((from[axis] - REACH).max(-inside), (from[axis] + REACH).min(inside))
        });
        let height = up.dot(&placement.translation.vector) + half[vertical];
        let below = up.dot(&shoulder) - height;
        let reached = span.iter().all(|(least, most)| least < most);
        if !reached || !(BELOW_THE_SHOULDER.0..=BELOW_THE_SHOULDER.1).contains(&below) || local.amax() < 1.0 - 1e-6 {
            return None;
        }
        let [(a, b), (c, d)] = span;
        let corner = |(first, second): (f64, f64)| {
            let mut at = Vector3::zeros();
            (at[vertical], at[across[0]], at[across[1]]) = (top, first, second);
            (placement * nalgebra::Point3::from(at)).coords
        };
        let corners = [(a, c), (b, c), (b, d), (a, d)].map(corner).to_vec();
        let place = Place::Free(Region { corners, turn: (-FRAC_PI_2, FRAC_PI_2) });
        let patch = job.model.segments()[segment].patch.clone();
        let support = Support { segment, corners: patch, normal: up, friction: FRICTION, share_max: 1.0, place };
        let inward = support.inward(job.model)?.into_inner();
        Some(Self { support, height, inward })
    }
}

/// Whether a segment has a patch, carries nothing, is at no work and holds nothing.
fn is_free(job: &Job<'_>, segment: usize) -> bool {
    let at_work = job.levels.iter().flat_map(|level| &level.tasks).any(|task| task.wants(segment));
    let loaded = job.loads.iter().flat_map(|loads| *loads).any(|load| load.segment == segment);
    let has_patch = !job.model.segments()[segment].patch.is_empty();
    has_patch && !at_work && !loaded && !job.carries(segment) && !job.rests.contains(&segment)
}

/// The blocks that the body keeps off, each once.
fn blocks(job: &Job<'_>) -> impl Iterator<Item = (Isometry3<f64>, Vector3<f64>)> {
    let pairs = job.limits.iter().filter_map(|task| match task {
        Task::Clearance(clearance) => Some(&clearance.pairs),
        _ => None,
    });
    let mut known: Vec<(Isometry3<f64>, Vector3<f64>)> = vec![];
    for pair in pairs.flatten() {
        if let Obstacle::Thing(Thing::Block { placement, half }) = pair.other
            && !known.contains(&(placement, half))
        {
            known.push((placement, half));
        }
    }
    known.into_iter()
}
