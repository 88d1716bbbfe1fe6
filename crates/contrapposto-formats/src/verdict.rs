//! Writes a verdict as it stands in every JSON file.

use contrapposto::joint_torques::Hazard;
use contrapposto::model::Model;
use contrapposto::suggestions::{Advice, LargestLoad, Suggestion};
use contrapposto::tasks::Unit;
use contrapposto::verdict::{HandLoad, Line, Missed, Verdict};
use serde::Serialize;

/// The answer to a job.
#[derive(Clone, Debug, Serialize)]
pub struct VerdictText {
    /// `cannot_be_done`, `cannot_stand`, `not_reached`, `held_until` or `holds`.
    pub kind: &'static str,
    /// The time of the run or motion, min; less than a file asks where its run settled or was interrupted before.
    pub asked_minutes: Option<f64>,
    /// Time for which the job can be done, min, one that holds with the posture of its end held on; `null`: muscles set no limit, or
    /// the job cannot be done.
    pub minutes: Option<f64>,
    /// Least and greatest time until a group fails first (of people of mean strength that is `who`), min, over published laws of fatigue and two of
    /// three people; `null` in it: never.
    pub minutes_range: Option<[Option<f64>; 2]>,
    /// The muscle group that is too weak or fails first; where none does, the one with the greatest load.
    pub who: Option<String>,
    /// Active torque of that group over its strength.
    pub load: Option<f64>,
    /// The group with the greatest load.
    pub hardest: Option<LoadText>,
    /// Of a run or motion that holds, the group that is most tired at the end.
    pub tired: Option<TiredText>,
    /// Of a run or motion that holds, the group that fails before its end in weaker people, or by another published law.
    pub fails_weaker: Option<String>,
    /// Coordinates that ligaments carry at an angle where that is a hazard.
    pub hazards: Vec<HazardText>,
    /// Hazards of a run that were over at its end, each at the moment when ligaments carried most.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hazards_passed: Vec<PassedHazardText>,
    /// Weights in hands from half of the strength of the grip on, the heaviest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hands: Vec<HandText>,
    /// The first line of every result.
    pub sentence: String,
    /// The findings behind it, each with its name: `Hardest worked: ...`.
    pub lines: Vec<String>,
    /// Targets that are missed, the most important first.
    pub missed: Vec<MissedText>,
}

/// A coordinate that ligaments carry at an angle where that is a hazard.
#[derive(Clone, Debug, Serialize)]
pub struct HazardText {
    /// The coordinate.
    pub coordinate: String,
    /// Angle of the coordinate, deg.
    pub angle_deg: f64,
    /// Share of the external torque that passive tissue carries, 0 to 1.
    pub carried: f64,
    /// The coordinate, the share and the torque, and the finding of a study.
    pub sentence: String,
}

impl HazardText {
    fn new(model: &Model, hazard: &Hazard) -> Self {
        Self {
            coordinate: model.coordinates()[hazard.coordinate].name.clone(),
            angle_deg: hazard.angle.to_degrees(),
            carried: hazard.carried(),
            sentence: format!("{}; {}", hazard.in_words(model), hazard.row.finding),
        }
    }
}

/// A weight in a hand that is much for its grip.
#[derive(Clone, Debug, Serialize)]
pub struct HandText {
    /// The segment of the hand.
    pub segment: String,
    /// The weight, N.
    pub weight_n: f64,
    /// Mean strength of the grip, N: that of men where the sex of the body is not known.
    pub grip_n: f64,
    /// The greatest weight that a hand holds at a handle for a moment, N.
    pub most_n: f64,
}

impl HandText {
    fn new(model: &Model, hand: &HandLoad) -> Self {
        let segment = model.segments()[hand.segment].name.clone();
        Self { segment, weight_n: hand.weight, grip_n: hand.grip(), most_n: hand.most() }
    }
}

/// A hazard of a run that was over at its end.
#[derive(Clone, Debug, Serialize)]
pub struct PassedHazardText {
    /// The hazard at the moment when ligaments carried most.
    #[serde(flatten)]
    pub hazard: HazardText,
    /// Time of that moment, s.
    pub at_s: f64,
    /// Time for which there was a hazard in all, s.
    pub seconds: f64,
}

/// A muscle group with its load.
#[derive(Clone, Debug, Serialize)]
pub struct LoadText {
    /// Name of the group.
    pub who: String,
    /// Active torque over strength.
    pub load: f64,
}

/// A muscle group with its fatigue.
#[derive(Clone, Debug, Serialize)]
pub struct TiredText {
    /// Name of the group.
    pub who: String,
    /// Fatigue, 0 rested to 1 exhausted.
    pub fatigue: f64,
}

/// A change of the job that was tried, and that helps.
#[derive(Clone, Debug, Serialize)]
pub struct SuggestionText {
    /// The change in words.
    pub change: String,
    /// The kind of verdict with it.
    pub kind: &'static str,
    /// Time for which the job can be done with the change, min, one that holds with the posture of its end held on; `null`: muscles set no limit.
    pub minutes: Option<f64>,
    /// Least of that time for two of three people, min; `null`: not known, or no limit.
    pub least_minutes: Option<f64>,
    /// Number of coordinates that ligaments carry in hazard.
    pub hazards: usize,
    /// Number of hands that hold half of the strength of their grip or more, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hands: Option<usize>,
    /// Load of the group that works hardest.
    pub load: Option<f64>,
}

impl From<&Suggestion> for SuggestionText {
    fn from(suggestion: &Suggestion) -> Self {
        Self {
            change: suggestion.change.clone(),
            kind: suggestion.kind.word(),
            minutes: suggestion.seconds.map(|seconds| seconds / 60.0),
            least_minutes: suggestion.least.filter(|least| least.is_finite()).map(|seconds| seconds / 60.0),
            hazards: suggestion.hazards,
            hands: Some(suggestion.hands).filter(|hands| *hands > 0),
            load: suggestion.load,
        }
    }
}

/// The changes of a job that were tried.
#[derive(Clone, Debug, Default, Serialize)]
pub struct AdviceText {
    /// Changes that help, the one that helps most first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub suggestions: Vec<SuggestionText>,
    /// Changes that were not tried because the budget of solver steps was used up, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_tried: Vec<String>,
    /// The largest loads, where they were searched for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_load: Option<LargestLoadText>,
}

/// The largest loads with which a job can be done for the time asked.
#[derive(Clone, Debug, Serialize)]
pub struct LargestLoadText {
    /// The time asked, min.
    pub asked_minutes: f64,
    /// Share of the loads of the job that a person of mean strength holds for it; `null`: not even a hundredth.
    pub share: Option<f64>,
    /// The same of weaker people, one in six.
    pub share_weaker: Option<f64>,
    /// Whether both searches ended within the solver steps; else the shares are lower bounds.
    pub complete: bool,
    /// Both in words.
    pub sentence: String,
}

impl From<&LargestLoad> for LargestLoadText {
    fn from(largest: &LargestLoad) -> Self {
        Self {
            asked_minutes: largest.asked / 60.0,
            share: largest.mean,
            share_weaker: largest.weaker,
            complete: largest.is_cut == [false; 2],
            sentence: largest.in_words(),
        }
    }
}

impl From<&Advice> for AdviceText {
    fn from(advice: &Advice) -> Self {
        Self {
            suggestions: advice.helping.iter().map(SuggestionText::from).collect(),
            not_tried: advice.not_tried.clone(),
            largest_load: advice.largest.as_ref().map(LargestLoadText::from),
        }
    }
}

/// A target that is missed.
#[derive(Clone, Debug, Serialize)]
pub struct MissedText {
    /// The tasks of its priority.
    pub task: String,
    /// By how much, in `unit`.
    pub distance: f64,
    /// `m`, `rad`, or `m and rad` taken together.
    pub unit: &'static str,
    /// Of a single point: where it gets, ground, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_m: Option<[f64; 3]>,
    /// From there to the target, ground, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_target_m: Option<[f64; 3]>,
}

impl VerdictText {
    /// Of a verdict on a body.
    pub fn new(model: &Model, verdict: &Verdict) -> Self {
        let minutes = |seconds: f64| seconds.is_finite().then_some(seconds / 60.0);
        Self {
            kind: verdict.kind.word(),
            asked_minutes: verdict.asked.and_then(minutes),
            minutes: verdict.seconds.and_then(minutes),
            minutes_range: verdict.range.map(|(least, greatest)| [least, greatest].map(minutes)),
            who: verdict.who.map(|who| who.name(model)),
            load: verdict.who.map(|group| group.load),
            hardest: verdict.hardest.map(|who| LoadText { who: who.name(model), load: who.load }),
            tired: verdict.tired.map(|tired| TiredText { who: tired.who.name(model), fatigue: tired.fatigue }),
            fails_weaker: verdict.fails_weaker.map(|who| who.name(model)),
            hazards: verdict.hazards.iter().map(|hazard| HazardText::new(model, hazard)).collect(),
            hazards_passed: verdict
                .passed
                .iter()
                .map(|passed| PassedHazardText {
                    hazard: HazardText::new(model, &passed.hazard),
                    at_s: passed.time,
                    seconds: passed.seconds,
                })
                .collect(),
            hands: verdict.hands.iter().map(|hand| HandText::new(model, hand)).collect(),
            sentence: verdict.sentence.clone(),
            lines: verdict.lines.iter().map(Line::in_words).collect(),
            missed: verdict.missed.iter().map(MissedText::from).collect(),
        }
    }
}

impl From<&Missed> for MissedText {
    fn from(missed: &Missed) -> Self {
        let unit = missed.unit.map_or("m and rad", Unit::symbol);
        Self {
            task: missed.task.clone(),
            distance: missed.distance,
            unit,
            nearest_m: missed.nearest.map(|nearest| nearest.at.into()),
            to_target_m: missed.nearest.map(|nearest| nearest.to_target.into()),
        }
    }
}
