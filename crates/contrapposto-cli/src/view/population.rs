//! Says the answers of a population: the sentences, and the JSON file.

use contrapposto::model::data::library;
use contrapposto_formats::Distribution;
use contrapposto_sweep::{HangsOn, LEAST_FOR_INDICES, PARAMETERS, People, Population, QUANTILES, Study};
use serde::Serialize;

use super::words::{how_long, list, percent, sentence};

/// Most causes and parameters that a sentence names.
const MOST_NAMED: usize = 3;
/// Least share of a parameter that is named, at the lower end of its interval.
const LEAST_NAMED: f64 = 0.01;
/// Below that share of explained variance the answer has no parameter that it hangs on most.
const LITTLE_EXPLAINED: f64 = 0.3;
/// Directions of the parameters in words: with more of each the job is held longer, or for less time. Sex is from women to men.
const MORE_OF: [&str; 5] = ["men", "taller people", "heavier people", "stronger people", "people with stiffer tissue"];

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
    /// `null` of too few bodies, or where no answer differs.
    pub(crate) hangs_on: Option<HangsOnText>,
    pub(crate) parameters: Vec<ParameterText>,
    /// The rules of counting, and the assumptions, a sentence each.
    pub(crate) notes: Vec<String>,
    files: Vec<String>,
}

/// The answers of people of one sex.
#[derive(Serialize)]
pub(crate) struct PeopleText {
    pub(crate) bodies: usize,
    /// Bodies whose values the reader of scenarios refuses; they are in no other number.
    refused: usize,
    can_hold: usize,
    /// `can_hold` over `bodies`; `null` of none.
    pub(crate) share: Option<f64>,
    /// Wilson's 95 % interval of the share.
    pub(crate) interval_95: [f64; 2],
    /// Quantiles of the time, min; `null`: muscles set no limit.
    pub(crate) minutes: MinutesText,
    /// Bodies without a limit by muscles.
    without_limit: usize,
    /// Bodies that cannot do the job at all: their time is 0.
    cannot: usize,
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
pub(crate) struct HangsOnText {
    method: &'static str,
    /// `minutes`, at most the asked ones; `load` of the hardest worked group where all bodies have the same minutes.
    answer: &'static str,
    /// Share of the variance of the ranks that all parameters explain together.
    pub(crate) explained: f64,
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
        let hangs_on = found.hangs_on.as_ref().map(HangsOnText::new);
        let reasons = [fails(women, men), Some(hangs(hangs_on.as_ref(), found))];
        Self {
            program: concat!("contrapposto ", env!("CARGO_PKG_VERSION")),
            scenario: asked.scenario.clone(),
            title: asked.title.clone(),
            sentence: format!(
                "{} and {} can hold it for the {} asked.",
                sentence(&who_can(women, ["woman", "women"], "95\u{a0}% interval ")),
                who_can(men, ["man", "men"], ""),
                how_long(asked.seconds)
            ),
            reasons: reasons.into_iter().flatten().collect(),
            asked_minutes: asked.seconds / 60.0,
            bodies: study.rows(),
            seed,
            women: PeopleText::new(women),
            men: PeopleText::new(men),
            hangs_on,
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
            refused: people.refused,
            can_hold: people.can,
            share: people.share(),
            interval_95: people.interval,
            minutes: MinutesText { p5, p50, p95 },
            without_limit: people.minutes.iter().filter(|minutes| minutes.is_infinite()).count(),
            cannot: people.minutes.iter().filter(|minutes| **minutes == 0.0).count(),
            fails_first: people.fails.iter().map(fails).collect(),
        }
    }
}

impl HangsOnText {
    fn new(hangs_on: &HangsOn) -> Self {
        let coefficients = &hangs_on.regression.coefficients;
        let mut parameters: Vec<ShareText> = PARAMETERS
            .into_iter()
            .zip(coefficients)
            .map(|(parameter, coefficient)| ShareText {
                parameter,
                share: coefficient.share(),
                interval_95: coefficient.share_interval(),
                coefficient: coefficient.value,
            })
            .collect();
        parameters.sort_by(|a, b| b.share.total_cmp(&a.share));
        Self {
            method: "squared standardised coefficients of the regression on ranks (SRRC)",
            answer: if hangs_on.of_load { "load" } else { "minutes" },
            explained: hangs_on.regression.explained,
            parameters,
        }
    }
}

/// `39 % of 100 women (95 % interval 30 % to 49 %)`.
fn who_can(people: &People, [one, many]: [&str; 2], interval: &str) -> String {
    let Some(share) = people.share() else { return format!("no {one} of those that could be judged") };
    let who = if people.number == 1 { one } else { many };
    let [low, high] = people.interval.map(percent);
    format!("{} of {} {who} ({interval}{low} to {high})", percent(share), people.number)
}

/// `Of women who cannot, right shoulder flexion fails first in 90 % and reach in 10 %; of men, ...`; `None` where all can.
fn fails(women: &People, men: &People) -> Option<String> {
    let of = |people: &People, name: &str| {
        let cannot = people.number - people.can;
        let share = |count: usize| percent(count as f64 / cannot as f64);
        let named = people.fails.iter().take(MOST_NAMED).map(|(who, count)| format!("{who} in {}", share(*count)));
        let named: Vec<String> = named.collect();
        let more = people.fails.len().saturating_sub(MOST_NAMED);
        let more = if more > 0 { format!(" ({more} more in the table)") } else { String::new() };
        (cannot > 0).then(|| format!("of {name} who cannot ({cannot}) {}{more}", list(&named)))
    };
    let all: Vec<String> = [of(women, "women"), of(men, "men")].into_iter().flatten().collect();
    (!all.is_empty()).then(|| format!("Fails first: {}.", all.join("; ")))
}

/// `It hangs most on strength (58 % of the variance of ranks; stronger people hold it longer), then on sex (20 %).`
fn hangs(hangs_on: Option<&HangsOnText>, found: &Population) -> String {
    let Some(hangs_on) = hangs_on else {
        let few = found.sexes.iter().map(|people| people.number).sum::<usize>() < LEAST_FOR_INDICES;
        return match few {
            true => format!("What it hangs on is said from {LEAST_FOR_INDICES} bodies on."),
            false => "All bodies have the same answer: it hangs on none of the parameters.".to_owned(),
        };
    };
    let explained = percent(hangs_on.explained);
    if hangs_on.explained < LITTLE_EXPLAINED {
        return format!("No parameter rules it alone: all together explain {explained} of the variance of the ranks.");
    }
    let known = |parameter: &&ShareText| parameter.interval_95[0] >= LEAST_NAMED;
    let mut named = hangs_on.parameters.iter().filter(known).take(MOST_NAMED).map(|parameter| {
        let more = PARAMETERS.iter().position(|name| *name == parameter.parameter).map_or("", |i| MORE_OF[i]);
        let [low, high] = parameter.interval_95.map(percent);
        let rises = parameter.coefficient > 0.0;
        let effect = match (hangs_on.answer, rises) {
            ("load", true) => "have more load",
            ("load", false) => "have less load",
            (_, true) => "hold it longer",
            (_, false) => "hold it for less time",
        };
        format!("{} ({}, {low} to {high}; {more} {effect})", parameter.parameter, percent(parameter.share))
    });
    let Some(first) = named.next() else {
        return format!("No parameter stands out: all together explain {explained} of the variance of the ranks.");
    };
    let what = if hangs_on.answer == "load" { "All have the same time; their load hangs" } else { "It hangs" };
    let then: String = named.map(|next| format!(", then on {next}")).collect();
    format!("{what} most on {first}{then}; shares of the variance of ranks, of which {explained} are explained.")
}

fn parameters(study: &Study) -> Vec<ParameterText> {
    let people = library().people();
    let of = |plan: usize, i: usize| {
        study.plans().nth(plan).map_or(String::new(), |plan| words(&plan.parameters[i].distribution))
    };
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

/// A distribution as a plan writes it.
fn words(distribution: &Distribution) -> String {
    match distribution {
        Distribution::Normal { mean, deviation } => format!("normal = [{mean}, {deviation}]"),
        Distribution::Lognormal { median, deviation } => format!("lognormal = [{median}, {deviation}]"),
        Distribution::Range { low, high } => format!("range = [{low}, {high}]"),
        Distribution::List(list) => list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    }
}

fn notes(asked: f64, found: &Population) -> Vec<String> {
    let people = library().people();
    let asked = how_long(asked);
    let mut notes = vec![
        format!(
            "Times: a body that cannot do the job at all has 0 min; times beyond the {asked} asked are those of the posture of the end, held on; \
             a body on which muscles set no limit is counted above all times (censored), so that a quantile may be \"no limit\"."
        ),
        format!(
            "Bodies: stature and mass of {} ({}); strength by its coefficients of variation, one number of standard deviations for all \
             groups of a person (assumed); passive torque with a standard deviation of {} (assumed). Targets, supports and loads stay where \
             the scenario has them.",
            people.reference.source.split(" (").next().unwrap_or_default(),
            people.reference.status,
            percent(people.passive_spread.deviation_of_logarithm),
        ),
        "Intervals are Wilson's, as of so many independent people: the number of bodies is in them, faults of the model are not.".to_owned(),
    ];
    if found.hangs_on.is_some() {
        notes.push(
            "Shares of parameters: squared standardised coefficients of the regression of the ranks of the answer (minutes, at most the asked \
             ones) on those of independent parameters. What makes the answer rise and then fall, or works only together with another parameter, is \
             not in them; the rest up to 100\u{a0}% is that, and equal answers."
                .to_owned(),
        );
    }
    let refused: usize = found.sexes.iter().map(|people| people.refused).sum();
    if refused > 0 {
        notes.push(format!(
            "{refused} bodies were refused by the reader of scenarios (`note` in population.csv) and are not counted."
        ));
    }
    notes
}
