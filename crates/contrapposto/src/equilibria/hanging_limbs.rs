//! Finds the limbs that carry nothing, and states the tasks by which they hang: a start of a search.

use crate::contact::{Support, rates_that_move};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::{Posture, PostureError};
use crate::tasks::{Point, Task};

use super::search::Search;

/// The limbs that move no support: each a chain of segments, from the joint where the limb begins to its last segment.
pub(super) fn free_limbs(model: &Model, supports: &[Support]) -> Vec<Vec<usize>> {
    let moves = rates_that_move(model, supports);
    let carries = |segment: usize| {
        let rates = model.segments()[segment].mobility.map(|mobility| model.rates_of(mobility));
        rates.is_none_or(|mut rates| rates.any(|rate| moves[rate]))
    };
    let children = |segment: usize| model.segments().iter().filter(move |other| other.parent == Some(segment)).count();
    let ends = (0..model.segments().len()).filter(|&last| children(last) == 0 && !carries(last));
    let limb = |last: usize| {
        let parent = |segment: &usize| model.segments()[*segment].parent;
        let belongs = |parent: &usize| !carries(*parent) && children(*parent) == 1;
        let mut limb: Vec<usize> =
            std::iter::successors(Some(last), |segment| parent(segment).filter(belongs)).collect();
        limb.reverse();
        limb
    };
    ends.map(limb).collect()
}

/// Whether each segment belongs to a limb that moves no support, bears no load and has no task: the posture of such a limb is no other way to
/// stand. Without supports there is none.
pub(super) fn idle_segments(search: &Search<'_>) -> Vec<bool> {
    let mut idle = vec![false; search.model.segments().len()];
    if search.supports.is_empty() {
        return idle;
    }
    for limb in free_limbs(search.model, search.supports) {
        let is_loaded = limb.iter().any(|segment| search.loads.iter().any(|load| load.segment == *segment));
        let is_idle = !is_loaded && !has_task(search, &limb);
        // The joint where the limb begins belongs to the body.
        limb.iter().skip(1).for_each(|&segment| idle[segment] = is_idle);
    }
    idle
}

/// Whether a task concerns a segment of a limb. One that asks it to hang is none.
pub(super) fn has_task(search: &Search<'_>, limb: &[usize]) -> bool {
    let tasks = search.goals.iter().flat_map(|level| &level.tasks);
    let mut work = tasks.filter(|task| !task.hangs(search.model));
    work.any(|task| limb.iter().any(|&segment| task.concerns(search.model, segment)))
}

/// For the last segment with mass of every limb that moves no support: its centre of mass straight below the joint where the limb begins, as
/// far as it is from that joint in `posture`.
pub(super) fn hanging_limbs(model: &Model, supports: &[Support], posture: &Posture) -> Result<Vec<Task>, PostureError> {
    let Some(down) = model.gravity().try_normalize(0.0) else { return Ok(vec![]) };
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture)?;
    let task = |limb: Vec<usize>| {
        let first = *limb.first()?;
        let segment = limb.into_iter().rfind(|&segment| model.segments()[segment].mass > 0.0)?;
        let last = &model.segments()[segment];
        let joint = kinematics.placement(model, first).translation.vector;
        let end = kinematics.station(model, segment, last.center_of_mass);
        let target = joint + (end - joint).norm() * down;
        Some(Task::Point(Point { segment, point: last.center_of_mass, target, axes: [true; 3] }))
    };
    Ok(free_limbs(model, supports).into_iter().filter_map(task).collect())
}

/// `posture` with the limbs that move no support in the middle of their finite ranges.
pub(super) fn in_mid_range(model: &Model, supports: &[Support], posture: &Posture) -> Posture {
    let mut step = vec![0.0; model.rates().len()];
    for segment in free_limbs(model, supports).concat() {
        let rates = model.segments()[segment].mobility.map(|mobility| model.rates_of(mobility));
        for rate in rates.into_iter().flatten() {
            let Some(coordinate) = model.rates()[rate].coordinate else { continue };
            let (lower, upper) = model.coordinates()[coordinate].range;
            if (upper - lower).is_finite() && !model.coordinates()[coordinate].locked && !model.is_dependent(coordinate)
            {
                step[rate] = 0.5 * (lower + upper) - posture.values()[coordinate];
            }
        }
    }
    let mut middle = posture.clone();
    middle.displace(model, &step);
    middle
}
