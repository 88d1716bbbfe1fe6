//! Judges a recorded motion.

use super::holding::GroupAtEnd;
use super::spread::spread;
use super::{Failure, Findings, HandLoad, Verdict, Who};
use crate::assessment::{Assessment, FAST_SHARE, GroupAssessment};
use crate::joint_torques::GroupLoad;
use crate::model::Model;
use crate::statics::Load;

impl Verdict {
    /// Of a motion of `seconds` that was assessed. Its times count from the start of the motion, or of the job that repeats it.
    pub fn of_motion(model: &Model, found: &Assessment, seconds: f64) -> Self {
        Self::of_motion_with(model, found, seconds, &[])
    }

    /// As [`Verdict::of_motion`], with loads that the body holds all the time.
    pub fn of_motion_with(model: &Model, found: &Assessment, seconds: f64, held: &[Load]) -> Self {
        let hardest = found.groups.iter().max_by(|a, b| a.peak_load.value.total_cmp(&b.peak_load.value));
        let start = found.groups.first().and_then(|group| group.loads.pieces().first()).map_or(0.0, |(time, _)| *time);
        let failed = found.groups.iter().filter_map(|group| Some((group, group.exhausted_at?)));
        let fails = failed.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(group, time)| {
            let muscles = &model.coordinates()[group.coordinate].groups.as_ref()?[group.side.index()];
            let (least, greatest) = spread(muscles, &group.loads, 0.0);
            let who = Who { coordinate: group.coordinate, side: group.side, load: group.loads.at(time) };
            let range = (least.min(time) - start, greatest.max(time) - start);
            Some(Failure { who, time: time - start, range })
        });
        let mut findings = Findings {
            asked: Some(seconds),
            hardest: hardest
                .filter(|group| group.peak_load.value > 0.0)
                .map(|g| (load_of(g), Some(g.peak_load.time - start))),
            missing: found
                .missing
                .map(|(missing, time)| (missing, Some(time - start)))
                .or(found.uncarried.map(|missing| (missing, None))),
            fast: Some(found.fast_share).filter(|share| *share > FAST_SHARE && !found.dynamics),
            recorded: true,
            dynamics: found.dynamics,
            out_of_range: found.out_of_range.clone(),
            fails,
            hazards: found.hazards.clone(),
            hands: HandLoad::all(model, held),
            loads: held.to_vec(),
            ..Findings::default()
        };
        if found.repetition.is_some() {
            findings.take_repeats(model, found, seconds);
            return findings.verdict(model);
        }
        // The posture at the end of a fast motion is not held on.
        if findings.kind().is_done() && found.fast_share <= FAST_SHARE {
            let groups: Vec<_> = found.groups.iter().filter_map(|group| at_end(model, group)).collect();
            findings.take_end(&groups, (start, start + seconds));
        }
        findings.verdict(model)
    }
}

/// A group at the end of the motion.
fn at_end<'a>(model: &'a Model, group: &'a GroupAssessment) -> Option<GroupAtEnd<'a>> {
    let (coordinate, side) = (group.coordinate, group.side);
    let muscles = &model.coordinates()[coordinate].groups.as_ref()?[side.index()];
    let left = muscles.fatigue.time_left(group.fatigue, group.load);
    Some(GroupAtEnd {
        who: Who { coordinate, side, load: group.load },
        muscles,
        history: &group.loads,
        start: 0.0,
        fatigue: group.fatigue,
        seconds_left: left.is_finite().then_some(left),
        of_people: None,
    })
}

fn load_of(group: &GroupAssessment) -> GroupLoad {
    let load = group.peak_load.value;
    GroupLoad { coordinate: group.coordinate, side: group.side, torque: group.peak_torque, load }
}
