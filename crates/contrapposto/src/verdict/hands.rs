//! Judges the weights that hands hold by the strength of the grip (`data/grip.toml`).
//!
//! The body has no muscles of the fingers. A weight that acts on a hand is taken to hang at a horizontal handle, the easiest way to hold it:
//! more than a hand can hold so for a moment cannot be held. Forces are not judged: a palm that pushes needs no grip. Fatigue of the grip
//! is not judged.

use crate::model::data::library;
use crate::model::{Adult, Model, Sex, plain_name};
use crate::statics::{Load, LoadKind};

/// A weight in one hand that is much for its grip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandLoad {
    /// The segment of the hand.
    pub segment: usize,
    /// The weight, N.
    pub weight: f64,
    /// Sex of the body; `None` where it is not known, and the grip is a man's.
    pub sex: Option<Sex>,
}

impl HandLoad {
    /// The hands whose weights are reported, the heaviest weight first: those with half of the strength of the grip or more.
    pub fn all(model: &Model, loads: &[Load]) -> Vec<Self> {
        let mut hands: Vec<Self> = vec![];
        for load in loads {
            let LoadKind::Weight(mass) = load.kind else { continue };
            if !plain_name(&model.segments()[load.segment].name).ends_with("hand") {
                continue;
            }
            let weight = mass * model.gravity().norm();
            match hands.iter_mut().find(|hand| hand.segment == load.segment) {
                Some(hand) => hand.weight += weight,
                None => hands.push(Self { segment: load.segment, weight, sex: None }),
            }
        }
        if hands.is_empty() {
            return hands;
        }
        let sex = Adult::of(model).map(|size| size.sex);
        hands.iter_mut().for_each(|hand| hand.sex = sex);
        hands.retain(|hand| hand.weight >= library().grip().reported_share * hand.grip());
        hands.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        hands
    }

    /// Mean strength of the grip, N.
    pub fn grip(&self) -> f64 {
        library().grip().strength(self.sex.unwrap_or(Sex::Male))
    }

    /// The greatest weight that such a hand holds at a handle for a moment, N.
    pub fn most(&self) -> f64 {
        library().grip().handle_factor * self.grip()
    }

    /// Whether a hand cannot hold it.
    pub fn is_too_heavy(&self) -> bool {
        self.weight > self.most()
    }

    /// `the right hand would have to hold 1472 N, and a man's hand holds 753 N at a handle at most (...)`.
    pub(super) fn too_heavy_in_words(&self, model: &Model) -> String {
        format!(
            "the {} would have to hold {:.0} N, and the hand of {} holds {:.0} N at a handle at most ({} times the mean strength of the grip)",
            self.name(model),
            self.weight,
            self.person("a woman", "a man"),
            self.most(),
            library().grip().handle_factor
        )
    }

    /// `the right hand holds 245 N, 51 % of the mean strength of a man's grip`.
    pub(super) fn in_words(&self, model: &Model) -> String {
        format!(
            "the {} holds {:.0} N, {:.0}\u{a0}% of the mean strength of {} grip",
            self.name(model),
            self.weight,
            100.0 * self.weight / self.grip(),
            self.person("a woman's", "a man's")
        )
    }

    fn name(&self, model: &Model) -> String {
        plain_name(&model.segments()[self.segment].name)
    }

    fn person(&self, woman: &'static str, man: &'static str) -> &'static str {
        if self.sex == Some(Sex::Female) { woman } else { man }
    }
}
