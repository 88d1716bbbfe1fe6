//! Says what the changes of a job give, as a table: the times without and with each of them.

use super::trial::{Suggestion, hazards_in_words};
use crate::model::Model;
use crate::verdict::{A_DAY, Verdict, VerdictKind, has_motors, how_long};

/// Names of the columns of times.
const OF_PEOPLE: [&str; 2] = ["lasts (mean strength)", "lasts (weaker people, the weakest sixth)"];

/// Said of hazards and of the grip of a body that falls.
const NOT_JUDGED: &str = "not judged";

/// Changes beside the job as it is, a row each, the job first and then the change that helps most.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gains {
    /// Names of the columns: of the changes, of the times for a person of mean strength and for weaker people, and, where there is something to say,
    /// of hazards for ligaments and of heavy weights in hands.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// A job as it is, or with a change.
struct Row {
    change: String,
    kind: VerdictKind,
    asked: Option<f64>,
    seconds: Option<f64>,
    least: Option<f64>,
    hazards: usize,
    /// The postures in hazard, in words.
    hazard: String,
    hands: usize,
}

impl Gains {
    /// The table of changes that help the job with this verdict.
    pub(super) fn new(model: &Model, heading: &str, before: &Verdict, helping: &[Suggestion]) -> Self {
        let as_it_is = Row {
            change: "as it is".to_owned(),
            kind: before.kind,
            // A run that settled before its end is beside the same time as its changes.
            asked: helping.first().map_or(before.asked, |one| one.asked),
            seconds: before.seconds,
            least: before.least,
            hazards: before.hazards.len(),
            hazard: hazards_in_words(model, before),
            hands: before.hands.len(),
        };
        let people = !has_motors(model);
        let with = |one| Row::new(one, (model, before), people);
        let rows: Vec<Row> = std::iter::once(as_it_is).chain(helping.iter().map(with)).collect();
        let (hazards, hands) = (rows.iter().any(|row| row.hazards > 0), rows.iter().any(|row| row.hands > 0));
        let mut columns = vec![heading];
        columns.extend_from_slice(if people { &OF_PEOPLE } else { &["lasts"] });
        let at_end = if before.asked.is_some() { "hazard for ligaments at the end" } else { "hazard for ligaments" };
        columns.extend(hazards.then_some(at_end));
        columns.extend(hands.then_some("strength of the grip"));
        let cells = |row: &Row| {
            let mut cells = vec![row.change.clone(), row.time()];
            cells.extend(people.then(|| row.time_of_weaker()));
            cells.extend(hazards.then(|| row.hazards_in_words()));
            cells.extend(hands.then(|| row.grip_in_words()));
            cells
        };
        Self { columns: columns.into_iter().map(str::to_owned).collect(), rows: rows.iter().map(cells).collect() }
    }
}

impl Row {
    /// A change; where somebody holds out for less time with it, that is said beside it.
    fn new(with: &Suggestion, (model, before): (&Model, &Verdict), people: bool) -> Self {
        let shorter = match with.shortens(before) {
            [true, true] if people => "; shorter for everybody",
            [true, _] if people => "; shorter for people of mean strength",
            [_, true] if people => "; shorter for weaker people",
            [true, _] => "; shorter",
            _ => "",
        };
        Self {
            change: with.change.clone() + shorter,
            kind: with.kind,
            asked: with.asked,
            seconds: with.seconds,
            least: with.least,
            hazards: with.hazards,
            hazard: with.hazard.clone().unwrap_or_else(|| hazards_in_words(model, before)),
            hands: with.hands,
        }
    }

    /// `6.5 min`, `2.0 min, too short`, `no limit`, or the reason for which it cannot be done.
    fn time(&self) -> String {
        match self.kind {
            VerdictKind::CannotBeDone => "cannot be done".to_owned(),
            VerdictKind::CannotStand => "cannot stand".to_owned(),
            VerdictKind::NotReached => "not reached".to_owned(),
            VerdictKind::HeldUntil => self.beside_asked(self.seconds.unwrap_or(0.0)),
            VerdictKind::Holds => self.beside_asked(self.seconds.unwrap_or(f64::INFINITY)),
        }
    }

    /// As [`Self::time`], of people whose strength is one standard deviation below the mean, or by another published law; `too weak` from the start.
    fn time_of_weaker(&self) -> String {
        match self.least {
            Some(least) if least <= 0.0 => "too weak".to_owned(),
            Some(least) => self.beside_asked(least),
            None => String::new(),
        }
    }

    /// A time beside the asked one.
    fn beside_asked(&self, seconds: f64) -> String {
        let short = self.asked.is_some_and(|asked| seconds < asked);
        let alike = self.asked.map(how_long).is_some_and(|asked| asked == how_long(seconds));
        match (short, alike) {
            _ if seconds >= A_DAY => "no limit".to_owned(),
            (true, true) => format!("just under {}", how_long(seconds)),
            (true, false) => format!("{}, too short", how_long(seconds)),
            (false, _) => how_long(seconds),
        }
    }

    /// `half or more` of the strength of the grip, `less than half`, or that nobody judged a body that falls.
    fn grip_in_words(&self) -> String {
        match (self.hands, self.kind) {
            (1.., _) => "half or more".to_owned(),
            (0, VerdictKind::CannotStand) => NOT_JUDGED.to_owned(),
            (0, _) => "less than half".to_owned(),
        }
    }

    /// `none`, `low back bent forward by 52°`, or that nobody judged a body that falls.
    fn hazards_in_words(&self) -> String {
        match self.hazards {
            0 if self.kind == VerdictKind::CannotStand => NOT_JUDGED.to_owned(),
            0 => "none".to_owned(),
            _ => self.hazard.clone(),
        }
    }
}
