//! States the tasks by which limbs that carry nothing hang: a start of a search.

use crate::contact::{Support, rates_that_move};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::{Posture, PostureError};
use crate::tasks::{Point, Task};

/// For the last segment of every limb that moves no support: its centre of mass straight below the joint where the limb begins, as
/// far as it is from that joint in `posture`.
pub(super) fn hanging_limbs(model: &Model, supports: &[Support], posture: &Posture) -> Result<Vec<Task>, PostureError> {
    let Some(down) = model.gravity().try_normalize(0.0) else { return Ok(vec![]) };
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture)?;
    let moves = rates_that_move(model, supports);
    let carries = |segment: usize| {
        let rates = model.segments()[segment].mobility.map(|mobility| model.rates_of(mobility));
        rates.is_none_or(|mut rates| rates.any(|rate| moves[rate]))
    };
    let children = |segment: usize| model.segments().iter().filter(move |other| other.parent == Some(segment)).count();
    let mut tasks = vec![];
    for (leaf, last) in model.segments().iter().enumerate() {
        if children(leaf) > 0 || carries(leaf) || last.mass <= 0.0 {
            continue;
        }
        let mut first = leaf;
        while let Some(parent) = model.segments()[first].parent {
            if carries(parent) || children(parent) > 1 {
                break;
            }
            first = parent;
        }
        let joint = kinematics.placement(model, first).translation.vector;
        let end = kinematics.station(model, leaf, last.center_of_mass);
        let target = joint + (end - joint).norm() * down;
        tasks.push(Task::Point(Point { segment: leaf, point: last.center_of_mass, target, axes: [true; 3] }));
    }
    Ok(tasks)
}
