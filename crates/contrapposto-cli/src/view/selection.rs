//! The coordinates that a view shows, and the one it shows first.

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::simulation::{Scenario, Summary};

/// Coordinates that hold a torque: all with muscles or passive tissue; of a body without any, all.
pub(crate) fn shown(model: &Model) -> Vec<usize> {
    let all = || (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].kind != CoordinateKind::Quaternion);
    let holds = |i: &usize| model.coordinates()[*i].groups.is_some() || model.coordinates()[*i].passive.is_some();
    let holding: Vec<usize> = all().filter(holds).collect();
    if holding.is_empty() { all().collect() } else { holding }
}

/// The coordinate that the story is about: the one most often relieved, of equals a free one, of equals the hardest worked.
pub(crate) fn main_coordinate(scenario: &Scenario, summary: &Summary) -> usize {
    let weight = |i: usize| {
        let coordinate = &summary.coordinates[i];
        (coordinate.iterations.iter().sum::<u64>(), scenario.free[i], coordinate.peak_load)
    };
    let more = |a: &usize, b: &usize| {
        let (a, b) = (weight(*a), weight(*b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    // The first of equals.
    shown(&scenario.model).into_iter().rev().max_by(more).unwrap_or(0)
}
