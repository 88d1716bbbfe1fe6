//! Judges a recorded motion.

use super::spread::spread;
use super::{Failure, Findings, Verdict, Who};
use crate::assessment::{Assessment, GroupAssessment};
use crate::joint_torques::GroupLoad;
use crate::model::Model;

impl Verdict {
    /// Of a motion of `seconds` that was assessed.
    pub fn of_motion(model: &Model, found: &Assessment, seconds: f64) -> Self {
        let hardest = found.groups.iter().max_by(|a, b| a.peak_load.value.total_cmp(&b.peak_load.value));
        let failed = found.groups.iter().filter_map(|group| Some((group, group.exhausted_at?)));
        let fails = failed.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(group, time)| {
            let muscles = &model.coordinates()[group.coordinate].groups.as_ref()?[group.side.index()];
            let (least, greatest) = spread(muscles, &group.loads, 0.0);
            let who = Who { coordinate: group.coordinate, side: group.side, load: group.loads.at(time) };
            Some(Failure { who, time, range: (least.min(time), greatest.max(time)) })
        });
        Findings {
            asked: Some(seconds),
            hardest: hardest.filter(|group| group.peak_load.value > 0.0).map(|g| (load_of(g), Some(g.peak_load.time))),
            missing: found.missing.map(|(missing, time)| (missing, Some(time))),
            fails,
            ..Findings::default()
        }
        .verdict(model)
    }
}

fn load_of(group: &GroupAssessment) -> GroupLoad {
    let load = group.peak_load.value;
    GroupLoad { coordinate: group.coordinate, side: group.side, torque: group.peak_torque, load }
}
