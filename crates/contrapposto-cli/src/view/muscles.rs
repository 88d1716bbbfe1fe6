//! The muscle groups of a moment: the one that works, the hardest worked, the most tired, and the first to fail.

use contrapposto::model::{Model, Side};
use contrapposto::simulation::Summary;

use super::frame::Frame;
use super::words::{group, plain};

/// The group that works hardest, and its load.
pub(crate) fn hardest(model: &Model, frame: &Frame) -> Option<(String, f64)> {
    let i = (0..frame.load.len()).max_by(|&a, &b| frame.load[a].total_cmp(&frame.load[b]))?;
    let name = working(model, i, frame).unwrap_or_else(|| plain(&model.coordinates()[i].name));
    Some((name, frame.load[i]))
}

/// The group that works hardest in a run while no support is put elsewhere, its load, and when, s.
pub(crate) fn hardest_of_run(model: &Model, summary: &Summary) -> Option<(String, f64, f64)> {
    let (hardest, time) = summary.hardest?;
    let coordinate = &model.coordinates()[hardest.coordinate];
    let groups = coordinate.groups.as_ref()?;
    Some((group(&groups[hardest.side.index()].name, &coordinate.name), hardest.load, time))
}

/// The group that fails first when a posture is held from a rested start, and after how many seconds; `None` where all groups hold
/// without limit.
pub(crate) fn fails_first(model: &Model, frame: &Frame) -> Option<(String, f64)> {
    let time = |i: usize| {
        let groups = model.coordinates()[i].groups.as_ref()?;
        let time = groups[Side::of(frame.active(i)).index()].fatigue.endurance_time(frame.load[i]);
        time.is_finite().then_some((i, time))
    };
    let (i, time) = (0..frame.load.len()).filter_map(time).min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((working(model, i, frame)?, time))
}

/// The name of the group of a coordinate that works.
pub(crate) fn working(model: &Model, i: usize, frame: &Frame) -> Option<String> {
    let coordinate = &model.coordinates()[i];
    let groups = coordinate.groups.as_ref()?;
    Some(group(&groups[Side::of(frame.active(i)).index()].name, &coordinate.name))
}

/// The name of the more tired group of a coordinate, and how tired it is.
pub(crate) fn tired(model: &Model, i: usize, frame: &Frame) -> Option<(String, f64)> {
    let coordinate = &model.coordinates()[i];
    let [positive, negative] = frame.fatigue.as_ref()?[i];
    let side = usize::from(negative > positive);
    let groups = coordinate.groups.as_ref()?;
    Some((group(&groups[side].name, &coordinate.name), positive.max(negative)))
}
