//! Says a change in words, with the value that it starts from.

use nalgebra::Vector3;

use super::change::{Change, JointAngle};
use super::job::Job;
use crate::hybrid::Strategy;
use crate::joint_torques::posture_in_words;
use crate::model::plain_name;
use crate::verdict::{Amount, MOST_AMOUNTS, amounts, amounts_in_words};

/// A part of a direction below this one is none.
const NO_PART: f64 = 1e-6;

/// A value of a target without and with a change, in words, and the segment of the target.
struct Moved {
    segment: String,
    before: String,
    after: String,
}

impl Change {
    /// `right hand 10 cm lower (height 1.85 m instead of 1.95 m)`, `20 % less load (2.4 kg instead of 3 kg)`.
    pub fn in_words(&self, job: &Job<'_>) -> String {
        match self {
            Self::Targets(by, how) => {
                let mut names: Vec<String> = vec![];
                for (segment, ..) in job.targets() {
                    let name = plain_name(&job.model.segments()[segment].name);
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                format!("{} {how}{}", names.join(" and "), moved_in_words(job, by).unwrap_or_default())
            }
            Self::Joints(angles) => {
                let coordinates = job.model.coordinates();
                let at = |&JointAngle { coordinate, before, angle }: &JointAngle| {
                    let posture = posture_in_words(&coordinates[coordinate].name, angle);
                    format!("{posture} instead of {:.0}°", before.to_degrees().abs())
                };
                angles.iter().map(at).collect::<Vec<_>>().join(" and ")
            }
            Self::Loads(share) => {
                let less = format!("{:.0}\u{a0}% less load", 100.0 * (1.0 - share));
                loads_in_words(job, *share).map_or_else(|| less.clone(), |loads| format!("{less} ({loads})"))
            }
            Self::Strategy(Strategy::Active) => {
                "tired joints moved back to the middle of their range instead of leaning on ligaments".to_owned()
            }
            Self::Strategy(Strategy::Passive) => {
                "tired joints left to lean on ligaments instead of moving back to the middle of their range".to_owned()
            }
            Self::Hand(hand) => {
                let name = plain_name(&job.model.segments()[hand.support.segment].name);
                format!("{name} put down to rest when something is tired ({:.2}\u{a0}m high)", hand.height)
            }
            Self::Both(two) => two.each_ref().map(|one| one.in_words(job)).join(" and "),
            Self::OtherFoot => match job.feet() {
                Some([ahead, behind]) => format!("feet exchanged: the {behind} ahead instead of the {ahead}"),
                None => "the other foot ahead".to_owned(),
            },
        }
    }
}

/// ` (height 1.85 m instead of 1.95 m)`, or ` (horizontal distance from the middle of the body 0.35 m instead of 0.45 m)`, which is its centre of mass
/// at the start; of several targets that of their middle.
fn moved_in_words(job: &Job<'_>, by: &Vector3<f64>) -> Option<String> {
    let up = job.up()?;
    let is_level = by.dot(&up).abs() < 0.5 * by.norm();
    let center = job.center_of_mass().filter(|_| is_level).unwrap_or_default();
    let of = |place: Vector3<f64>| {
        let from_center = place - center;
        if is_level { (from_center - from_center.dot(&up) * up).norm() } else { place.dot(&up) }
    };
    let counts = |k: usize| if is_level { up[k].abs() < 1.0 - NO_PART } else { up[k].abs() > NO_PART };
    let mut all: Vec<Moved> = vec![];
    let targets = job.targets();
    if targets.iter().any(|(.., axes)| (0..3).any(|k| counts(k) && !axes[k])) {
        return None;
    }
    if is_level && targets.len() > 1 {
        // Two hands come nearer by the same step, each along another line.
        let middle = job.middle_of_targets()?;
        let [before, after] = [middle, middle + by].map(of);
        let of_middle = "horizontal distance of their middle from the middle of the body";
        return Some(format!(" ({of_middle} {after:.2}\u{a0}m instead of {before:.2}\u{a0}m)"));
    }
    for (segment, target, _) in targets {
        let segment = plain_name(&job.model.segments()[segment].name);
        let [before, after] =
            [target, target + by].map(|place| format!("{:.2}\u{a0}m", of(place)).replace('-', "\u{2212}"));
        all.push(Moved { segment, before, after });
    }
    let first = all.first()?;
    let is_one = all.iter().all(|moved| (&moved.before, &moved.after) == (&first.before, &first.after));
    let values: Vec<String> = if is_one {
        vec![format!("{} instead of {}", first.after, first.before)]
    } else {
        all.iter().map(|moved| format!("{} {} instead of {}", moved.segment, moved.after, moved.before)).collect()
    };
    let values = values.join(", ");
    Some(match is_level {
        true => format!(" (horizontal distance from the middle of the body {values})"),
        false => format!(" (height {values})"),
    })
}

/// `2.4 kg instead of 3 kg`, `1.6 kg and 16 N instead of 2 kg and 20 N`; of loads that change the first ones. `None` of many loads.
fn loads_in_words(job: &Job<'_>, share: f64) -> Option<String> {
    let sets: Vec<Vec<Amount>> =
        job.loads.iter().filter(|loads| !loads.is_empty()).map(|loads| amounts(loads)).collect();
    let first = sets.first().filter(|first| (1..=MOST_AMOUNTS).contains(&first.len()))?;
    let at_first = if sets.iter().all(|set| set == first) { "" } else { " at first" };
    let [after, before] = [share, 1.0].map(|share| amounts_in_words(first, share));
    Some(format!("{after} instead of {before}{at_first}"))
}
