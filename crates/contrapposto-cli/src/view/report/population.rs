//! Makes the page of a population.

use contrapposto_plot::{BarChart, HoldingCurve, bar_chart, holding_curve};
use contrapposto_report::{Document, Figure, Picture, Table, write_document};
use contrapposto_sweep::{People, Population, QUANTILES};

use crate::view::population::{PeopleText, PopulationText};
use crate::view::words::{holding_time, how_long, share_in_words};

/// The page: the answer, the holding curve, bars of failing groups and of parameters, and the same as tables.
pub(crate) fn report_of_population(text: &PopulationText, found: &Population) -> String {
    let asked = how_long(60.0 * text.asked_minutes);
    write_document(&Document {
        title: text.title.clone(),
        headline: text.sentence.clone(),
        reasons: text.reasons.clone(),
        figures: found.sexes.iter().zip(["Women", "Men"]).flat_map(|(people, name)| figures(people, name)).collect(),
        pictures: [holding(text, found, &asked), Some(failing(text)), depending(text)].into_iter().flatten().collect(),
        tables: [times(found), Some(fails(text)), shares(text), Some(people(text))].into_iter().flatten().collect(),
        notes: text.notes.clone(),
    })
}

fn figures(people: &People, name: &str) -> [Figure; 2] {
    let [low, high] = people.interval.map(share_in_words);
    let value = people.share().map_or("unknown".to_owned(), share_in_words);
    let median = people.quantile(QUANTILES[1]).map_or("unknown".to_owned(), holding_time);
    [
        Figure { label: format!("{name} who can hold it"), value, note: format!("95\u{a0}% interval {low} to {high}") },
        Figure { label: format!("{name}, median time"), value: median, note: format!("of {} bodies", people.number) },
    ]
}

fn holding(text: &PopulationText, found: &Population, asked: &str) -> Option<Picture> {
    let groups = [("women", &found.sexes[0]), ("men", &found.sexes[1])];
    let chart = HoldingCurve {
        title: "How many still hold it".to_owned(),
        subtitle: format!(
            "up to the {asked} asked; 0 min: not done to the end (too weak, off balance, or target missed)"
        ),
        end_min: text.asked_minutes,
        groups: groups.map(|(name, people)| (name.to_owned(), people.minutes.clone())).to_vec(),
    };
    let at_end = |(name, people): (&str, &People)| Some(format!("{} of {name}", share_in_words(people.share()?)));
    let at_end: Vec<String> = groups.into_iter().filter_map(at_end).collect();
    (!at_end.is_empty()).then(|| Picture {
        svg: holding_curve(&chart).svg(),
        words: format!("Share of people who still hold it against time; at {asked}: {}.", at_end.join(", ")),
    })
}

/// Every cause with its shares of women and of men.
fn causes(text: &PopulationText) -> Vec<(String, [f64; 2])> {
    let mut all: Vec<(String, [f64; 2])> = vec![];
    for (sex, people) in [&text.women, &text.men].into_iter().enumerate() {
        for cause in &people.fails_first {
            let place = all.iter().position(|(who, _)| *who == cause.who).unwrap_or_else(|| {
                all.push((cause.who.clone(), [0.0; 2]));
                all.len() - 1
            });
            all[place].1[sex] = cause.share;
        }
    }
    all.sort_by(|a, b| (b.1[0] + b.1[1]).total_cmp(&(a.1[0] + a.1[1])));
    all
}

fn failing(text: &PopulationText) -> Picture {
    let chart = BarChart {
        title: "Fails first".to_owned(),
        subtitle: "share of the women and of the men who cannot hold it for the asked time".to_owned(),
        series: vec!["women".to_owned(), "men".to_owned()],
        rows: causes(text).into_iter().map(|(who, shares)| (who, shares.to_vec())).collect(),
    };
    Picture { svg: bar_chart(&chart).svg(), words: "Bars of who fails first; the table below has the same.".to_owned() }
}

fn depending(text: &PopulationText) -> Option<Picture> {
    let sensitivity = text.sensitivity.as_ref()?;
    let chart = BarChart {
        title: "Sensitivity".to_owned(),
        subtitle: format!(
            "shares of the variance of ranks of the {}; together {}, one alone {} at most",
            sensitivity.answer,
            share_in_words(sensitivity.explained),
            share_in_words(sensitivity.ceiling)
        ),
        series: vec!["share".to_owned()],
        rows: sensitivity.parameters.iter().map(|shown| (shown.parameter.to_owned(), vec![shown.share])).collect(),
    };
    let words = "Bars of the parameters; the table below has the same.".to_owned();
    Some(Picture { svg: bar_chart(&chart).svg(), words })
}

fn strings<const N: usize>(texts: [&str; N]) -> Vec<String> {
    texts.map(str::to_owned).to_vec()
}

fn times(found: &Population) -> Option<Table> {
    let row = |(people, name): (&People, &str)| {
        let quantiles = QUANTILES.map(|share| people.quantile(share).map_or("unknown".to_owned(), holding_time));
        let count = |is: fn(f64) -> bool| people.minutes.iter().filter(|minutes| is(**minutes)).count().to_string();
        let counts = [people.number.to_string(), count(|minutes| minutes == 0.0), count(f64::is_infinite)];
        [name.to_owned()].into_iter().chain(quantiles).chain(counts).collect()
    };
    let columns = strings(["", "P5", "P50", "P95", "bodies", "not done", "no limit"]);
    let rows = found.sexes.iter().zip(["women", "men"]).map(row).collect();
    Some(Table { heading: "Times".to_owned(), columns, rows })
}

fn fails(text: &PopulationText) -> Table {
    let count = |people: &PeopleText, who: &str| {
        people.fails_first.iter().find(|cause| cause.who == who).map_or(0, |cause| cause.bodies)
    };
    let row = |(who, [women, men]): (String, [f64; 2])| {
        let cell = |people: &PeopleText, share: f64| format!("{} ({})", share_in_words(share), count(people, &who));
        vec![who.clone(), cell(&text.women, women), cell(&text.men, men)]
    };
    let rows = causes(text).into_iter().map(row).collect();
    Table {
        heading: "Fails first, of those who cannot (bodies)".to_owned(),
        columns: strings(["", "women", "men"]),
        rows,
    }
}

fn shares(text: &PopulationText) -> Option<Table> {
    let row = |shown: &crate::view::population::ShareText| {
        let [low, high] = shown.interval_95.map(share_in_words);
        vec![shown.parameter.to_owned(), share_in_words(shown.share), format!("{low} to {high}")]
    };
    let rows = text.sensitivity.as_ref()?.parameters.iter().map(row).collect();
    let columns = strings(["parameter", "share of the variance of ranks", "95\u{a0}% interval"]);
    Some(Table { heading: "Sensitivity".to_owned(), columns, rows })
}

fn people(text: &PopulationText) -> Table {
    let rows = text
        .parameters
        .iter()
        .map(|shown| [&shown.key, &shown.women, &shown.men, &shown.status, &shown.source].map(String::clone).to_vec());
    let columns = strings(["key of the scenario", "women", "men", "status", "source"]);
    Table { heading: "The people".to_owned(), columns, rows: rows.collect() }
}
