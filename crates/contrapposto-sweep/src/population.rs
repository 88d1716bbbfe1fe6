//! Makes the plans of a population, and counts its answers: the share of women and of men who can hold a job, the times, who fails first,
//! and how much the answer depends on each parameter.

use contrapposto::model::Sex;
use contrapposto::model::data::{PeopleOfSex, library};
use contrapposto::verdict::VerdictKind;
use contrapposto_formats::{Design, Distribution, Parameter, Plan, STRENGTH_DEVIATIONS, Value};

use super::interval::wilson;
use super::outcome::{Outcome, REFUSED};
use super::part::Study;
use super::sensitivity::{Body, NoSensitivity, PARAMETERS, Sensitivity};
use super::table::Answer;

/// Most bodies of a population.
pub const MOST_BODIES: usize = 100_000;
/// Rows of a part: a kill loses at most so many runs of each thread.
const BODIES_PER_PART: usize = 4;
/// Shares of people of the quantiles that are given.
pub const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];
/// The sexes in the order of rows.
pub const SEXES: [Sex; 2] = [Sex::Female, Sex::Male];

/// Plans of as many women as men, `bodies` in all.
pub fn population(base: &str, bodies: usize, seed: u32) -> [Plan; 2] {
    SEXES.map(|sex| {
        let people = library().people().of_sex(sex);
        // Each sex has its own shift.
        let seed = seed.wrapping_mul(2).wrapping_add(u32::from(sex == Sex::Male));
        Plan {
            base: base.to_owned(),
            seed,
            design: Design::ShiftedSobol,
            rows: bodies / 2,
            rows_per_part: BODIES_PER_PART,
            parameters: parameters(sex, people),
            mixing: Some(mixing(people.correlation)),
        }
    })
}

fn parameters(sex: Sex, people: &PeopleOfSex) -> Vec<Parameter> {
    let spread = &library().people().passive_spread;
    let (stature, mass) = (people.stature_m, people.mass_kg);
    let name = if sex == Sex::Female { "female" } else { "male" };
    let lognormal = |median, deviation| Distribution::Lognormal { median, deviation };
    let all = [
        ("model.adult.stature_m", Distribution::Normal { mean: stature.mean, deviation: stature.deviation }),
        ("model.adult.mass_kg", lognormal(mass.median, mass.deviation_of_logarithm)),
        ("strength.deviations", Distribution::Normal { mean: 0.0, deviation: 1.0 }),
        ("passive.spread", lognormal(spread.median, spread.deviation_of_logarithm)),
        ("model.adult.sex", Distribution::List(vec![Value::Text(name.to_owned())])),
    ];
    // Nobody is weaker or stronger than a scenario takes; of a normal distribution 5 in 10,000 people are.
    let accepted = [*STRENGTH_DEVIATIONS.start(), *STRENGTH_DEVIATIONS.end()];
    let within = |key| (key == "strength.deviations").then_some(accepted);
    all.map(|(key, distribution)| Parameter { key: key.to_owned(), distribution, within: within(key), levels: 0 })
        .to_vec()
}

/// Cholesky factor of the correlation of stature and mass; all others are independent.
fn mixing(correlation: f64) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> =
        (0..PARAMETERS.len()).map(|i| (0..PARAMETERS.len()).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    rows[1][0] = correlation;
    rows[1][1] = (1.0 - correlation * correlation).sqrt();
    rows
}

/// The answers of a population.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    /// Women and men.
    pub sexes: [People; 2],
    /// The shares of the parameters in the answer, or the reason for which there are none.
    pub sensitivity: Result<Sensitivity, NoSensitivity>,
    /// The reason for which the first of the bodies that could not be judged was not.
    pub first_note: Option<String>,
}

/// The answers of people of one sex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct People {
    /// Number of people whose run has a verdict.
    pub number: usize,
    /// Number of others, whose scenario is refused or whose run ends with an error; they are in no other number.
    pub not_judged: usize,
    /// Number who can hold the job for the asked time.
    pub can: usize,
    /// 95 % interval of the share who can.
    pub interval: [f64; 2],
    /// Minutes in rising order: 0 of those who do not do the job to its end for another reason than fatigue, whenever that is; infinite where
    /// muscles set no limit.
    pub minutes: Vec<f64>,
    /// The muscle groups or other causes that end the job of those who cannot hold it, with the number of people; the most frequent first.
    pub fails: Vec<(String, usize)>,
}

impl Population {
    /// Of the answers to a job that is asked for `asked` minutes.
    pub fn new(study: &Study, answers: &[Answer], asked: f64, seed: u32) -> Self {
        let of = |sex: usize| answers.iter().filter(move |answer| study.plan_of(answer.row) == sex);
        let sexes = [0, 1].map(|sex| People::new(of(sex).map(|answer| &answer.outcome), asked));
        let body = |answer: &Answer| {
            let minutes = minutes(&answer.outcome)?.min(asked);
            Some(Body { row: answer.row, minutes, load: answer.outcome.load })
        };
        let bodies: Vec<Body> = answers.iter().filter_map(body).collect();
        let not_judged = answers.iter().find(|answer| answer.outcome.kind == REFUSED);
        Self {
            sexes,
            sensitivity: Sensitivity::new(study, &bodies, seed),
            first_note: not_judged.and_then(|answer| answer.outcome.note.clone()),
        }
    }
}

impl People {
    fn new<'a>(outcomes: impl Iterator<Item = &'a Outcome>, asked: f64) -> Self {
        let mut people = Self::default();
        for outcome in outcomes {
            let Some(minutes) = minutes(outcome) else {
                people.not_judged += 1;
                continue;
            };
            people.minutes.push(minutes);
            if holds(outcome, asked) {
                people.can += 1;
                continue;
            }
            let end = end(outcome);
            match people.fails.iter_mut().find(|(name, _)| *name == end) {
                Some((_, count)) => *count += 1,
                None => people.fails.push((end, 1)),
            }
        }
        people.number = people.minutes.len();
        people.interval = wilson(people.can, people.number);
        people.minutes.sort_by(f64::total_cmp);
        people.fails.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        people
    }

    /// Share who can hold the job for the asked time; `None` of nobody.
    pub fn share(&self) -> Option<f64> {
        (self.number > 0).then(|| self.can as f64 / self.number as f64)
    }

    /// The least minutes that at least this share of people do not exceed; `None` of nobody.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let place = (share * self.number as f64).ceil() as usize;
        self.minutes.get(place.max(1) - 1).or(self.minutes.last()).copied()
    }
}

/// Minutes for which the job can be done, 0 where it is not done to its end for another reason than fatigue; `None` of a body that could not
/// be judged.
fn minutes(outcome: &Outcome) -> Option<f64> {
    match outcome.kind {
        REFUSED => None,
        _ if is_done(outcome) => Some(outcome.minutes.unwrap_or(f64::INFINITY)),
        _ => Some(0.0),
    }
}

fn is_done(outcome: &Outcome) -> bool {
    VerdictKind::ALL.into_iter().any(|kind| kind.is_done() && kind.word() == outcome.kind)
}

/// Whether the job is held for `asked` minutes. A run that settles before has the time of its posture held on.
fn holds(outcome: &Outcome, asked: f64) -> bool {
    outcome.kind == VerdictKind::Holds.word() && outcome.minutes.is_none_or(|minutes| minutes >= asked)
}

/// The muscle group, or another cause, that ends the job of a body.
fn end(outcome: &Outcome) -> String {
    let kind = |kind: VerdictKind| outcome.kind == kind.word();
    let words = if kind(VerdictKind::CannotStand) {
        "balance (the supports do not hold the body)"
    } else if kind(VerdictKind::NotReached) {
        "reach (the target is missed)"
    } else if kind(VerdictKind::CannotBeDone) && outcome.load.is_some_and(|load| load <= 1.0) {
        // No muscle group of the model is too weak: the weight is more than a hand can hold.
        "grip of a hand"
    } else {
        outcome.who.as_deref().unwrap_or("unknown")
    };
    words.to_owned()
}
