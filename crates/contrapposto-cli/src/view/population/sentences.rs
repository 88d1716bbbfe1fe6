//! Says the answers of a population in sentences.

use contrapposto::model::data::library;
use contrapposto_sweep::{
    LEAST_FOR_SENSITIVITY, NoSensitivity, PARAMETERS, People, Population, RankCoefficient, RankRegression, Sensitivity,
};

use crate::view::words::{how_long, list, percent, sentence, share_in_words};

/// Most causes and parameters that a sentence names.
const MOST_NAMED: usize = 3;
/// Least share of a parameter that is named, at the lower end of its interval.
const LEAST_NAMED: f64 = 0.01;
/// Below that share of the ceiling of the explained variance no parameter is named. Assumed.
const LITTLE_EXPLAINED: f64 = 0.3;
/// Directions of the parameters in words: with more of each the job is held longer, or for less time. Sex is from women to men.
const MORE_OF: [&str; 5] = ["men", "taller people", "heavier people", "stronger people", "people with stiffer tissue"];

/// `39 % of 100 women (...) and 70 % of 100 men (...) can hold it for the 8.0 min asked.`
pub(super) fn headline(found: &Population, asked: f64) -> String {
    let [women, men] = &found.sexes;
    let missing = match not_judged(found) {
        (0, _) => String::new(),
        (missing, all) => format!("; {missing} of {all} bodies could not be judged"),
    };
    format!(
        "{} and {} can hold it for the {} asked{missing}.",
        sentence(&who_can(women, ["woman", "women"], "95\u{a0}% interval ")),
        who_can(men, ["man", "men"], ""),
        how_long(asked)
    )
}

/// Number of bodies that could not be judged, and of all.
fn not_judged(found: &Population) -> (usize, usize) {
    let missing: usize = found.sexes.iter().map(|people| people.not_judged).sum();
    (missing, missing + found.sexes.iter().map(|people| people.number).sum::<usize>())
}

/// `39 % of 100 women (95 % interval 30 % to 49 %)`.
fn who_can(people: &People, [one, many]: [&str; 2], interval: &str) -> String {
    let Some(share) = people.share() else { return format!("no {one} of those that could be judged") };
    let who = if people.number == 1 { one } else { many };
    let [low, high] = people.interval.map(share_in_words);
    format!("{} of {} {who} ({interval}{low} to {high})", share_in_words(share), people.number)
}

/// `Of women who cannot, right shoulder flexion fails first in 90 % and reach in 10 %; of men, ...`; `None` where all can.
pub(super) fn fails(women: &People, men: &People) -> Option<String> {
    let of = |people: &People, name: &str| {
        let cannot = people.number - people.can;
        let share = |count: usize| share_in_words(count as f64 / cannot as f64);
        let named = people.fails.iter().take(MOST_NAMED).map(|(who, count)| format!("{who} in {}", share(*count)));
        let named: Vec<String> = named.collect();
        let more = people.fails.len().saturating_sub(MOST_NAMED);
        let more = if more > 0 { format!(" ({more} more in the table)") } else { String::new() };
        (cannot > 0).then(|| format!("of {name} who cannot ({cannot}) {}{more}", list(&named)))
    };
    let all: Vec<String> = [of(women, "women"), of(men, "men")].into_iter().flatten().collect();
    (!all.is_empty()).then(|| format!("Fails first: {}.", all.join("; ")))
}

/// `The time depends most on strength (58 %, 41 % to 70 %; stronger people hold it longer), then on sex (20 %, ...); shares of ...`
pub(super) fn dependence(found: &Population) -> String {
    let sensitivity = match &found.sensitivity {
        Ok(sensitivity) => sensitivity,
        Err(NoSensitivity::TooFew) => {
            return format!(
                "The parameters on which the time depends are named from {LEAST_FOR_SENSITIVITY} judged bodies on."
            );
        }
        Err(NoSensitivity::SameAnswers) => {
            return "All judged bodies have the same answer, which depends on none of the parameters.".to_owned();
        }
        Err(NoSensitivity::NotKnown) => {
            return "The parameters on which the time depends are not known: too many bodies have the same time, and too few a known load."
                .to_owned();
        }
    };
    let answer =
        if sensitivity.of_load { "Most bodies have the same time; their load depends" } else { "The time depends" };
    let explained = explained(&sensitivity.regression);
    let little = sensitivity.regression.of_ceiling() < LITTLE_EXPLAINED;
    let sorted = sensitivity.sorted();
    let known = |shown: &&(&str, RankCoefficient)| !little && shown.1.share_interval()[0] >= LEAST_NAMED;
    let mut named = sorted.iter().filter(known).take(MOST_NAMED).map(|shown| parameter(sensitivity, shown));
    let Some(first) = named.next() else {
        return format!(
            "{answer} on no parameter that can be named: of the variance of the ranks all together explain {explained}."
        );
    };
    let then: String = named.map(|next| format!(", then on {next}")).collect();
    format!(
        "{answer} most on {first}{then}; shares of the variance of ranks, of which all together explain {explained}."
    )
}

/// `20 %`, and where answers are equal the greatest share that one parameter can explain.
fn explained(regression: &RankRegression) -> String {
    let (explained, ceiling) = (share_in_words(regression.explained), share_in_words(regression.ceiling));
    if regression.ceiling == 1.0 {
        return explained;
    }
    format!("{explained} (since answers are equal, one parameter without equal values can explain {ceiling} at most)")
}

/// `strength (58 %, 41 % to 70 %; stronger people hold it longer)`.
fn parameter(sensitivity: &Sensitivity, (name, coefficient): &(&str, RankCoefficient)) -> String {
    let more = PARAMETERS.iter().position(|parameter| parameter == name).map_or("", |i| MORE_OF[i]);
    let [low, high] = coefficient.share_interval().map(share_in_words);
    let effect = match (sensitivity.of_load, coefficient.value > 0.0) {
        (true, true) => "have more load",
        (true, false) => "have less load",
        (false, true) => "hold it longer",
        (false, false) => "hold it for less time",
    };
    format!("{name} ({}, {low} to {high}; {more} {effect})", share_in_words(coefficient.share()))
}

/// The rules of counting, and the assumptions.
pub(super) fn notes(asked: f64, found: &Population) -> Vec<String> {
    let people = library().people();
    let asked = how_long(asked);
    let mut notes = vec![
        format!(
            "Times: a body that does not do the job to its end since a muscle group is too weak, the supports do not hold it or a target is missed \
             counts as 0 min (\"not done\"), whether that is at the start or later; times beyond the {asked} asked are those of the posture of \
             the end, held on; a body on which muscles set no limit is counted above all times (censored), so that a quantile may be \"no limit\"."
        ),
        format!(
            "Bodies: stature and mass of {} ({}); strength by its coefficients of variation, one number of standard deviations for all \
             groups of a person (assumed); passive torque with a standard deviation of {} (assumed). Targets, supports and loads stay where \
             the scenario has them.",
            people.reference.source.split(" (").next().unwrap_or_default(),
            people.reference.status,
            percent(people.passive_spread.deviation_of_logarithm),
        ),
        "Strength: proportional to body mass in the data, so that \"mass for that stature\" includes strength. The coefficients of variation \
         may count the variation of size a second time (knee: 73 men, size not taken out)."
            .to_owned(),
        "Intervals are Wilson's, as of so many independent people: the number of bodies is in them, faults of the model are not.".to_owned(),
    ];
    if let Ok(sensitivity) = &found.sensitivity {
        notes.push(shares(sensitivity));
    }
    let (missing, all) = not_judged(found);
    if missing > 0 {
        let first = found.first_note.as_ref().map_or(String::new(), |note| format!("; the first: {note}"));
        notes.push(format!(
            "{missing} of {all} bodies could not be judged and are not counted: the reader of scenarios refuses their values, or their run ends with \
             an error (`note` in population.csv{first})."
        ));
    }
    notes
}

/// The note on the shares of parameters.
fn shares(sensitivity: &Sensitivity) -> String {
    let answer =
        if sensitivity.of_load { "the load of the hardest worked group" } else { "minutes, at most the asked ones" };
    let left_out = match sensitivity.left_out {
        0 => String::new(),
        bodies => format!(" Bodies whose load is not known are left out ({bodies})."),
    };
    format!(
        "Shares of parameters: squared standardised coefficients of the regression of the ranks of the answer ({answer}) on those of independent \
         parameters. An effect that rises and then falls, or that needs another parameter, too, is not in them; the rest up to 100\u{a0}% is that, \
         and equal answers.{left_out}"
    )
}

#[cfg(test)]
mod tests {
    use contrapposto_sweep::{Answer, Outcome, Study, population, wilson};

    use super::*;

    const BASE: &str = "format = 1\n[coordinates]\nfree = [\"elbow_flex_r\"]\n\
        [strategy]\nkind = \"active\"\n[run]\nduration_s = 60\n";

    /// 200 bodies, of whom those in the weakest tenth of the strength cannot do it, and all others hold it without a limit.
    fn one_in_ten_fails(load: impl Fn(f64) -> Option<f64>) -> Population {
        let study = Study::in_turn("base.toml", BASE.as_bytes(), &population("base.toml", 200, 4)).unwrap();
        let answer = |row: usize| {
            let strength = study.point(row)[2];
            let kind = if strength < 0.1 { "cannot_be_done" } else { "holds" };
            Answer { row, outcome: Outcome { kind, load: load(strength), ..Outcome::default() } }
        };
        Population::new(&study, &(0..200).map(answer).collect::<Vec<_>>(), 1.0, 0)
    }

    #[test]
    fn the_one_parameter_that_decides_who_fails_is_named() {
        let found = one_in_ten_fails(|_| None);
        let text = dependence(&found);
        assert!(text.starts_with("The time depends most on strength (") && !text.contains("then on"), "{text}");
        let (regression, fail) =
            (&found.sensitivity.as_ref().unwrap().regression, found.sexes.iter().map(|people| people.fails[0].1));
        let [none, all] = [fail.clone().sum::<usize>(), 200 - fail.sum::<usize>()].map(|count| count as f64);
        let ceiling = 1.0 - (all.powi(3) - all + none.powi(3) - none) / (200_f64.powi(3) - 200.0);
        assert!(
            (regression.ceiling - ceiling).abs() < 1e-12 && regression.explained < LITTLE_EXPLAINED,
            "{regression:?}"
        );
        assert!(text.ends_with(&format!("can explain {} at most).", share_in_words(ceiling))), "{text}");
        let found = one_in_ten_fails(|strength| Some(2.0 - strength));
        let text = dependence(&found);
        assert!(text.starts_with("Most bodies have the same time; their load depends most on strength ("), "{text}");
        assert!(text.contains("stronger people have less load") && !text.contains("at most"), "{text}");
    }

    #[test]
    fn the_reason_is_said_for_which_no_parameter_is_named() {
        let found = |reason| Population {
            sexes: [people(20, 20, 0), people(20, 20, 0)],
            sensitivity: Err(reason),
            first_note: None,
        };
        let said = [NoSensitivity::TooFew, NoSensitivity::SameAnswers, NoSensitivity::NotKnown]
            .map(|reason| dependence(&found(reason)));
        for (said, words) in said.iter().zip(["from 40 judged bodies on", "have the same answer", "are not known"]) {
            assert!(said.contains(words), "{said}");
        }
    }

    fn people(number: usize, can: usize, not_judged: usize) -> People {
        People { number, can, not_judged, interval: wilson(can, number), ..People::default() }
    }

    #[test]
    fn the_headline_says_how_many_could_not_be_judged_and_never_100_percent_where_some_cannot() {
        let found = |not_judged, first_note| {
            let sexes = [people(1000, 997, not_judged), people(1000, 1000, 0)];
            Population { sexes, sensitivity: Err(NoSensitivity::NotKnown), first_note }
        };
        let headline = |found: &Population| headline(found, 480.0).replace('\u{a0}', " ");
        let all = found(0, None);
        assert_eq!(
            headline(&all),
            "More than 99 % of 1000 women (95 % interval 99 % to more than 99 %) and 100 % of 1000 men (more than 99 % to 100 %) can hold it for \
             the 8.0 min asked."
        );
        assert!(notes(480.0, &all).iter().all(|note| !note.contains("judged")));
        let some = found(3, Some("no posture".to_owned()));
        assert!(
            headline(&some).ends_with("for the 8.0 min asked; 3 of 2003 bodies could not be judged."),
            "{}",
            headline(&some)
        );
        let said = notes(480.0, &some).pop().unwrap();
        assert!(
            said.starts_with("3 of 2003 bodies could not be judged") && said.contains("the first: no posture"),
            "{said}"
        );
    }
}
