//! Warns of muscles that a model file may leave out, and finds the joints that are too weak without them.

use contrapposto::model::{MuscleGroup, Side, plain_group_name};

use super::SourcedModel;
use super::origin::Origin;

/// Share of the built-in strength below which a joint keeps that strength instead of its muscles'. Assumed: people differ by less.
const DOUBTED_SHARE: f64 = 1.0 / 3.0;
/// Most groups that a warning names.
const MOST_GROUPS: usize = 4;

impl SourcedModel {
    /// Warnings about the muscles in use: those that could not be read, and the coordinates that are too `weak` by them.
    pub(super) fn muscle_doubts(&self, weak: Vec<(usize, String)>) -> Vec<String> {
        let mut doubts = vec![];
        let of_muscles = || self.muscle_tally.0.iter().filter(|(kind, _)| kind.ends_with("uscle"));
        let refused: usize = of_muscles().map(|(_, tally)| tally.refused).sum();
        if refused > 0 {
            let all: usize = of_muscles().map(|(_, tally)| tally.refused + tally.read).sum();
            doubts.push(format!(
                "{refused} of {all} muscles could not be read, and joints that they cross are too weak; `contrapposto inspect` says why; \
                 --muscles off takes built-in strength"
            ));
        }
        if !weak.is_empty() {
            let more = if weak.len() > MOST_GROUPS { ", ..." } else { "" };
            let named: Vec<String> = weak.into_iter().take(MOST_GROUPS).map(|(_, text)| text).collect();
            doubts.push(format!(
                "the model's muscles are far weaker than people in the default posture: {}{more}; these joints keep the built-in strength. \
                 Does the model leave muscles out?",
                named.join(", ")
            ));
        }
        doubts
    }

    /// The coordinates of which a group has less than the doubted share of its strength in `library`, each with `right shoulder flexion
    /// 6 of 62 N m` of its weaker group; the weakest first.
    pub(super) fn weaker_than(&self, library: &Self) -> Vec<(usize, String)> {
        let posture = self.model.default_posture();
        let mut weak = vec![];
        for (i, (own, other)) in self.model.coordinates().iter().zip(library.model.coordinates()).enumerate() {
            let (Some(own_groups), Some(groups)) = (&own.groups, &other.groups) else { continue };
            if self.origins[i].strength != Origin::Muscles {
                continue;
            }
            let angle = posture.values()[i];
            let strengths = |side: Side| {
                let of = |group: &MuscleGroup| group.strength.torque(angle);
                (of(&own_groups[side.index()]), of(&groups[side.index()]), side)
            };
            let share = |(of_muscles, built_in, _): &(f64, f64, Side)| of_muscles / built_in;
            let weaker = Side::BOTH.map(strengths).into_iter().min_by(|a, b| share(a).total_cmp(&share(b)));
            let Some(weaker) = weaker.filter(|weaker| share(weaker) < DOUBTED_SHARE) else { continue };
            let (of_muscles, built_in, side) = weaker;
            let name = plain_group_name(&groups[side.index()].name, &own.name);
            weak.push((share(&weaker), (i, format!("{name} {of_muscles:.1} of {built_in:.0} N m"))));
        }
        weak.sort_by(|a, b| a.0.total_cmp(&b.0));
        weak.into_iter().map(|(_, found)| found).collect()
    }
}
