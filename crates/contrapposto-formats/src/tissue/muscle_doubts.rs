//! Warns of muscles that a model file may leave out.

use contrapposto::model::{Side, plain_group_name};

use super::SourcedModel;
use super::origin::Origin;

/// Share of the built-in strength below which the strength of a model's muscles is doubted. Assumed: people differ by less.
const DOUBTED_SHARE: f64 = 1.0 / 3.0;
/// Most groups that a warning names.
const MOST_GROUPS: usize = 4;

impl SourcedModel {
    /// Warnings about the muscles in use: those that could not be read, and joints that are far weaker in the default posture than in
    /// `library`, the same model without its muscles. A model of an arm, say, has the biceps but no deltoid.
    pub fn muscle_doubts(&self, library: &Self) -> Vec<String> {
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
        let weak = self.weaker_than(library);
        if !weak.is_empty() {
            let more = if weak.len() > MOST_GROUPS { ", ..." } else { "" };
            doubts.push(format!(
                "the model's muscles are far weaker than people in the default posture: {}{more}. Does the model leave muscles out? \
                 --muscles off takes built-in strength",
                weak[..weak.len().min(MOST_GROUPS)].join(", ")
            ));
        }
        doubts
    }

    /// `right shoulder flexion 6 of 62 N m`, of the groups below the doubted share, the weakest first.
    fn weaker_than(&self, library: &Self) -> Vec<String> {
        let posture = self.model.default_posture();
        let mut weak = vec![];
        for (i, (own, other)) in self.model.coordinates().iter().zip(library.model.coordinates()).enumerate() {
            let (Some(own_groups), Some(groups)) = (&own.groups, &other.groups) else { continue };
            if self.origins[i].strength != Origin::Muscles {
                continue;
            }
            for side in Side::BOTH.map(Side::index) {
                let angle = posture.values()[i];
                let (of_muscles, built_in) =
                    (own_groups[side].strength.torque(angle), groups[side].strength.torque(angle));
                if of_muscles < DOUBTED_SHARE * built_in {
                    let name = plain_group_name(&groups[side].name, &own.name);
                    weak.push((of_muscles / built_in, format!("{name} {of_muscles:.1} of {built_in:.0} N m")));
                }
            }
        }
        weak.sort_by(|a, b| a.0.total_cmp(&b.0));
        weak.into_iter().map(|(_, text)| text).collect()
    }
}
