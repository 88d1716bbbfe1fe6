//! Says the answers of a population: the JSON file, with the sentences.

mod sentences;

use contrapposto::model::data::library;
use contrapposto_formats::{Distribution, Parameter};
use contrapposto_sweep::{People, Population, QUANTILES, RankCoefficient, Sensitivity, Study};
use serde::Serialize;

use self::sentences::{dependence, fails, headline, notes};

/// The job that a population is asked to do.
pub(crate) struct Asked {
    /// Name of the scenario file.
    pub(crate) scenario: String,
    pub(crate) title: String,
    /// s
    pub(crate) seconds: f64,
}

/// The file `population.json`.
#[derive(Serialize)]
pub(crate) struct PopulationText {
    program: &'static str,
    scenario: String,
    pub(crate) title: String,
    /// The answer in one sentence.
    pub(crate) sentence: String,
    /// The causes of failures, and the parameters that count, a sentence each.
    pub(crate) reasons: Vec<String>,
    pub(crate) asked_minutes: f64,
    bodies: usize,
    seed: u32,
    pub(crate) women: PeopleText,
    pub(crate) men: PeopleText,
    /// `null` where `reasons` say why it is not known.
    pub(crate) sensitivity: Option<SensitivityText>,
    pub(crate) parameters: Vec<ParameterText>,
    /// The rules of counting, and the assumptions, a sentence each.
    pub(crate) notes: Vec<String>,
    files: Vec<String>,
}

/// The answers of people of one sex.
#[derive(Serialize)]
pub(crate) struct PeopleText {
    pub(crate) bodies: usize,
    /// Bodies whose values the reader of scenarios refuses, or whose run ends with an error; they are in no other number.
    not_judged: usize,
    can_hold: usize,
    /// `can_hold` over `bodies`; `null` of none.
    pub(crate) share: Option<f64>,
    /// Wilson's 95 % interval of the share.
    pub(crate) interval_95: [f64; 2],
    /// Quantiles of the time, min; `null`: muscles set no limit.
    pub(crate) minutes: MinutesText,
    /// Bodies without a limit by muscles.
    without_limit: usize,
    /// Bodies that do not do the job to its end for another reason than fatigue, at the start or later: they count as 0 min.
    not_done: usize,
    /// Of the bodies that cannot hold the job for the asked time.
    pub(crate) fails_first: Vec<FailsText>,
}

#[derive(Serialize)]
pub(crate) struct MinutesText {
    p5: Option<f64>,
    p50: Option<f64>,
    p95: Option<f64>,
}

/// The muscle group, or another cause, that ends the job.
#[derive(Serialize)]
pub(crate) struct FailsText {
    pub(crate) who: String,
    pub(crate) bodies: usize,
    /// Of those who cannot hold the job for the asked time.
    pub(crate) share: f64,
}

/// The shares of the parameters in the answer.
#[derive(Serialize)]
pub(crate) struct SensitivityText {
    method: &'static str,
    /// `minutes`, at most the asked ones; `load` of the hardest worked group where too many bodies have the same minutes.
    pub(crate) answer: &'static str,
    /// Share of the variance of the ranks that all parameters explain together.
    pub(crate) explained: f64,
    /// Greatest share that one parameter without equal values can explain: less than 1 where answers are equal.
    pub(crate) ceiling: f64,
    /// Judged bodies that are left out, since their load is not known.
    left_out: usize,
    /// The greatest first.
    pub(crate) parameters: Vec<ShareText>,
}

#[derive(Serialize)]
pub(crate) struct ShareText {
    pub(crate) parameter: &'static str,
    /// Squared coefficient: share of the variance of the ranks.
    pub(crate) share: f64,
    /// 95 % interval of it, from rows drawn anew.
    pub(crate) interval_95: [f64; 2],
    /// Above 0 where the answer rises with the parameter; of sex, from women to men.
    coefficient: f64,
}

/// A parameter of the plan.
#[derive(Serialize)]
pub(crate) struct ParameterText {
    pub(crate) key: String,
    pub(crate) women: String,
    pub(crate) men: String,
    pub(crate) status: String,
    pub(crate) source: String,
}

impl PopulationText {
    pub(crate) fn new(asked: &Asked, study: &Study, found: &Population, seed: u32, files: Vec<String>) -> Self {
        let [women, men] = &found.sexes;
        Self {
            program: concat!("contrapposto ", env!("CARGO_PKG_VERSION")),
            scenario: asked.scenario.clone(),
            title: asked.title.clone(),
            sentence: headline(found, asked.seconds),
            reasons: fails(women, men).into_iter().chain([dependence(found)]).collect(),
            asked_minutes: asked.seconds / 60.0,
            bodies: study.rows(),
            seed,
            women: PeopleText::new(women),
            men: PeopleText::new(men),
            sensitivity: found.sensitivity.as_ref().ok().map(SensitivityText::new),
            parameters: parameters(study),
            notes: notes(asked.seconds, found),
            files,
        }
    }
}

impl PeopleText {
    fn new(people: &People) -> Self {
        let cannot = people.number - people.can;
        let [p5, p50, p95] = QUANTILES.map(|share| people.quantile(share).filter(|minutes| minutes.is_finite()));
        let fails = |(who, bodies): &(String, usize)| FailsText {
            who: who.clone(),
            bodies: *bodies,
            share: *bodies as f64 / cannot as f64,
        };
        Self {
            bodies: people.number,
            not_judged: people.not_judged,
            can_hold: people.can,
            share: people.share(),
            interval_95: people.interval,
            minutes: MinutesText { p5, p50, p95 },
            without_limit: people.minutes.iter().filter(|minutes| minutes.is_infinite()).count(),
            not_done: people.minutes.iter().filter(|minutes| **minutes == 0.0).count(),
            fails_first: people.fails.iter().map(fails).collect(),
        }
    }
}

impl SensitivityText {
    fn new(sensitivity: &Sensitivity) -> Self {
        let shown = |(parameter, coefficient): (&'static str, RankCoefficient)| ShareText {
            parameter,
            share: coefficient.share(),
            interval_95: coefficient.share_interval(),
            coefficient: coefficient.value,
        };
        Self {
            method: "squared standardised coefficients of the regression on ranks (SRRC)",
            answer: if sensitivity.of_load { "load" } else { "minutes" },
            explained: sensitivity.regression.explained,
            ceiling: sensitivity.regression.ceiling,
            left_out: sensitivity.left_out,
            parameters: sensitivity.sorted().into_iter().map(shown).collect(),
        }
    }
}

fn parameters(study: &Study) -> Vec<ParameterText> {
    let people = library().people();
    let of = |plan: usize, i: usize| study.plans().nth(plan).map_or(String::new(), |plan| words(&plan.parameters[i]));
    let size = &people.reference;
    let passive = &people.passive_spread.reference;
    let assumed = (
        "assumed",
        "one number of standard deviations for all groups of a person; coefficients of variation in strength.toml",
    );
    let half = ("assumed", "half women, half men");
    study
        .keys()
        .enumerate()
        .map(|(i, key)| {
            let (status, source) = match key {
                "strength.deviations" => (assumed.0.to_owned(), assumed.1.to_owned()),
                "model.adult.sex" => (half.0.to_owned(), half.1.to_owned()),
                "passive.spread" => (passive.status.to_string(), passive.source.clone()),
                _ => (size.status.to_string(), size.source.clone()),
            };
            ParameterText { key: key.to_owned(), women: of(0, i), men: of(1, i), status, source }
        })
        .collect()
}

/// The distribution of a parameter as a plan writes it.
fn words(parameter: &Parameter) -> String {
    let within = parameter.within.map_or_else(String::new, |[low, high]| format!(", within = [{low}, {high}]"));
    let distribution = match &parameter.distribution {
        Distribution::Normal { mean, deviation } => format!("normal = [{mean}, {deviation}]"),
        Distribution::Lognormal { median, deviation } => format!("lognormal = [{median}, {deviation}]"),
        Distribution::Range { low, high } => format!("range = [{low}, {high}]"),
        Distribution::List(list) => list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    };
    distribution + &within
}
