//! Counts the limbs that are held up without a task, though they hang in the start.
//!
//! An arm held straight up, with a bag or without, needs little torque but constant attention, since its balance is unstable, or the ligaments at
//! the end of the shoulder's range. Effort charges neither. So of two postures that with fewer such limbs comes first, whatever their efforts.

use super::hanging_limbs::{free_limbs, has_task};
use super::search::Search;
use crate::kinematics::Kinematics;
use crate::statics::LoadKind;

/// Share of the depth to which a limb can hang, at which its centre of mass lies below its joint at least in a limb that counts as hanging.
/// Assumed: a straight arm hangs within 60 deg of the vertical, an arm with the elbow bent by a right angle has 0.6.
const LEAST_DEPTH: f64 = 0.5;

/// The limbs that move no support, have no task and bear nothing but weights, and that hang in the start: a trunk or a head that is upright there
/// may stay so.
#[derive(Clone, Debug, Default)]
pub(super) struct LimbsWithoutTask {
    limbs: Vec<Limb>,
}

#[derive(Clone, Debug)]
struct Limb {
    segments: Vec<usize>,
    /// Depth of the centre of mass below the joint where the limb begins up to which the limb is held up, m.
    least_depth: f64,
}

impl LimbsWithoutTask {
    /// `start` and a posture in which limbs hang as far as they can.
    pub(super) fn of(search: &Search<'_>, start: &Kinematics, hanging: &Kinematics) -> Self {
        let pulls = search.loads.iter().filter(|load| !matches!(load.kind, LoadKind::Weight(_)));
        let limb = |segments: Vec<usize>| {
            let [depth, at_start] = [hanging, start].map(|kinematics| depth(search, kinematics, &segments));
            let (depth, at_start) = (depth?, at_start?);
            let hangs = depth > 0.0 && at_start > 0.0;
            let is_pulled = pulls.clone().any(|load| segments.contains(&load.segment));
            let counts = hangs && !is_pulled && !has_task(search, &segments);
            counts.then_some(Limb { segments, least_depth: LEAST_DEPTH * depth })
        };
        Self { limbs: free_limbs(search.model, search.supports).into_iter().filter_map(limb).collect() }
    }

    /// Number of these limbs that do not hang.
    pub(super) fn raised(&self, search: &Search<'_>, kinematics: &Kinematics) -> usize {
        let is_raised =
            |limb: &&Limb| depth(search, kinematics, &limb.segments).is_some_and(|depth| depth < limb.least_depth);
        self.limbs.iter().filter(is_raised).count()
    }
}

/// Depth of the centre of mass of a limb and of the weights on it, below the joint where the limb begins, m; `None` without mass or gravity.
fn depth(search: &Search<'_>, kinematics: &Kinematics, segments: &[usize]) -> Option<f64> {
    let model = search.model;
    let down = model.gravity().try_normalize(0.0)?;
    let joint = kinematics.placement(model, *segments.first()?).translation.vector;
    let own = segments.iter().map(|&i| (i, model.segments()[i].center_of_mass, model.segments()[i].mass));
    let weights = search.loads.iter().filter_map(|load| match load.kind {
        LoadKind::Weight(mass) if segments.contains(&load.segment) => Some((load.segment, load.point, mass)),
        _ => None,
    });
    let (mut mass, mut moment) = (0.0, 0.0);
    for (segment, point, of) in own.chain(weights) {
        mass += of;
        moment += of * (kinematics.station(model, segment, point) - joint).dot(&down);
    }
    (mass > 0.0).then_some(moment / mass)
}
