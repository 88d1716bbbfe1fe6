//! Populations: intervals equal published ones, indices those of models with a closed form, counts those by hand, and the plans are those of
//! the people.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

use std::f64::consts::PI;

use contrapposto::math::normal::{cumulative, quantile};
use contrapposto_formats::{Parameter, Value};
use contrapposto_sweep::{
    Answer, MOST_DIMENSIONS, NoSensitivity, Outcome, PARAMETERS, Population, RankRegression, SEXES, Sampler, Study,
    population, ranks, sobol, wilson,
};

const BASE: &str = "format = 1\n[coordinates]\nfree = [\"elbow_flex_r\"]\n\
    [strategy]\nkind = \"active\"\n[run]\nduration_s = 60\n";

fn study(bodies: usize, seed: u32) -> Study {
    Study::in_turn("base.toml", BASE.as_bytes(), &population("base.toml", bodies, seed)).unwrap()
}

#[test]
fn intervals_are_those_that_newcombe_printed() {
    // Newcombe 1998, Stat. Med. 17:857-872, Table I, method 3 (recalled): Wilson's score interval.
    for (count, all, expected) in
        [(81, 263, [0.2553, 0.3662]), (15, 148, [0.0624, 0.1605]), (0, 20, [0.0, 0.1611]), (1, 29, [0.0061, 0.1718])]
    {
        for (end, expected) in wilson(count, all).into_iter().zip(expected) {
            assert!((end - expected).abs() < 5e-5 + 1e-12, "{count} of {all}: {end}, {expected}");
        }
    }
}

/// The shares from which a count is 1.96 standard deviations away, by bisection.
fn by_bisection(count: usize, all: usize) -> [f64; 2] {
    let (n, share) = (all as f64, count as f64 / all as f64);
    let far = |p: f64| (share - p).powi(2) > 1.959_963_984_540_054_f64.powi(2) * p * (1.0 - p) / n;
    [(0.0, share), (1.0, share)].map(|(mut outside, mut inside)| {
        for _ in 0..200 {
            let middle = f64::midpoint(outside, inside);
            if far(middle) { outside = middle } else { inside = middle }
        }
        inside
    })
}

#[test]
fn an_interval_ends_where_the_count_is_just_likely() {
    for all in [1, 2, 7, 100, 1000] {
        for count in [0, 1, all / 3, all / 2, all - 1, all] {
            let [low, high] = wilson(count, all);
            let expected = by_bisection(count, all);
            assert!((low - expected[0]).abs() < 1e-9 && (high - expected[1]).abs() < 1e-9, "{count} of {all}");
            assert!((0.0..=1.0).contains(&low) && low <= high && high <= 1.0);
            let mirrored = wilson(all - count, all);
            assert!((mirrored[0] - (1.0 - high)).abs() < 1e-12);
        }
    }
    assert_eq!(wilson(0, 0), [0.0, 1.0]);
    assert_eq!((wilson(0, 9)[0], wilson(9, 9)[1]), (0.0, 1.0));
}

#[test]
fn ranks_of_equal_values_are_the_mean_of_theirs() {
    assert_eq!(ranks(&[3.0, 1.0, 3.0, f64::INFINITY, 3.0, 0.0]), [4.0, 2.0, 4.0, 6.0, 4.0, 1.0]);
    assert!(ranks(&[]).is_empty());
}

/// Points of as many dimensions, one list each.
fn points(dimensions: usize, count: u32) -> Vec<Vec<f64>> {
    assert!(dimensions <= MOST_DIMENSIONS);
    (0..dimensions).map(|dimension| (1..=count).map(|i| sobol(i, dimension)).collect()).collect()
}

#[test]
fn the_coefficients_of_a_linear_model_of_normal_numbers_are_those_of_its_closed_form() {
    // Of normal numbers with the correlation r the ranks have the correlation 6/pi asin(r/2) (Pearson 1907), and the coefficients of
    // independent parameters are their correlations with the answer.
    let weights = [3.0, -2.0, 1.0, 0.5, 0.0_f64];
    let length = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    let points = points(weights.len(), 4095);
    let answer = |i: usize| weights.iter().zip(&points).map(|(weight, list)| weight * quantile(list[i])).sum::<f64>();
    let answers: Vec<f64> = (0..4095).map(answer).collect();
    let regression = RankRegression::new(&answers, &points, 1).unwrap();
    let expected = weights.map(|weight| 6.0 / PI * libm::asin(weight / length / 2.0));
    for (coefficient, expected) in regression.coefficients.iter().zip(expected) {
        assert!((coefficient.value - expected).abs() < 0.005, "{coefficient:?}: {expected}");
        assert!(coefficient.interval[0] <= coefficient.value && coefficient.value <= coefficient.interval[1]);
        assert!(coefficient.interval[1] - coefficient.interval[0] < 0.05);
    }
    assert_eq!(regression.ceiling, 1.0, "no answers are equal");
    let sum: f64 = expected.map(|coefficient| coefficient * coefficient).iter().sum();
    assert!((regression.explained - sum).abs() < 0.005, "{}: {sum}", regression.explained);
    // Ranks do not change with the scale of the answer.
    let scaled: Vec<f64> = answers.iter().map(|answer| libm::exp(*answer)).collect();
    assert_eq!(RankRegression::new(&scaled, &points, 1).unwrap(), regression);
}

#[test]
fn the_coefficients_of_a_small_table_with_equal_values_are_those_of_two_parameters_by_hand() {
    // Of two parameters: b1 = (r1y - r12 r2y) / (1 - r12^2), with correlations of ranks by a few lines of Python.
    let first = vec![1.0, 2.0, 2.0, 4.0, 5.0, 7.0, 8.0, 8.0];
    let second = vec![0.3, 0.1, 0.9, 0.5, 0.5, 0.2, 0.8, 0.4];
    let answers = [0.0, 0.0, 3.0, 2.0, 5.0, 5.0, 9.0, 5.0];
    let regression = RankRegression::new(&answers, &[first, second], 1).unwrap();
    let expected = BY_HAND;
    for (coefficient, expected) in regression.coefficients.iter().zip([expected.0, expected.1]) {
        assert!((coefficient.value - expected).abs() < 1e-12, "{coefficient:?}: {expected}");
    }
    assert!((regression.explained - expected.2).abs() < 1e-12, "{}", regression.explained);
}

/// Coefficients and R^2.
const BY_HAND: (f64, f64, f64) = (0.8502987787929189, 0.2776279257011436, 0.8859292862652169);

#[test]
fn of_the_ishigami_function_a_small_r_squared_says_that_the_coefficients_are_not_its_indices() {
    // sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1: first-order indices 0.314, 0.442, 0, total ones 0.558, 0.442, 0.244 (closed form).
    let points = points(3, 4095);
    let x = |parameter: usize, i: usize| PI * (2.0 * points[parameter][i] - 1.0);
    let answer = |i: usize| libm::sin(x(0, i)) * (1.0 + 0.1 * x(2, i).powi(4)) + 7.0 * libm::sin(x(1, i)).powi(2);
    let answers: Vec<f64> = (0..4095).map(answer).collect();
    let regression = RankRegression::new(&answers, &points, 1).unwrap();
    let shares: Vec<f64> = regression.coefficients.iter().map(|coefficient| coefficient.share()).collect();
    assert!(shares[0] > 0.1 && shares[1] < 0.01 && shares[2] < 0.01, "{shares:?}");
    assert!(regression.explained < 0.3, "{}", regression.explained);
}

#[test]
fn one_parameter_that_decides_all_explains_the_ceiling_that_equal_answers_leave() {
    let parameter: Vec<f64> = (0..1000).map(f64::from).collect();
    for levels in [vec![100.0], vec![500.0], vec![900.0, 950.0], vec![10.0, 11.0, 400.0], vec![]] {
        let level = |value: f64| levels.iter().filter(|level| value >= **level).count() as f64;
        let answers: Vec<f64> =
            parameter.iter().map(|value| if levels.is_empty() { *value } else { level(*value) }).collect();
        let mut counts = vec![0.0; 1000];
        answers.iter().for_each(|answer| counts[*answer as usize] += 1.0);
        let ties: f64 = counts.iter().map(|t: &f64| t.powi(3) - t).sum();
        let ceiling = 1.0 - ties / (1e9 - 1e3);
        let regression = RankRegression::new(&answers, std::slice::from_ref(&parameter), 1).unwrap();
        assert!((regression.ceiling - ceiling).abs() < 1e-12, "{levels:?}: {} {ceiling}", regression.ceiling);
        assert!((regression.explained - ceiling).abs() < 1e-9 && regression.of_ceiling() > 0.999_999, "{levels:?}");
    }
    // A parameter with the same equal values explains more than that.
    let regression = RankRegression::new(&[1.0, 2.0, 1.0, 2.0], &[vec![1.0, 2.0, 1.0, 2.0]], 1).unwrap();
    assert!((regression.ceiling - 0.8).abs() < 1e-12 && (regression.explained - 1.0).abs() < 1e-12);
    assert_eq!(regression.of_ceiling(), 1.0);
}

#[test]
fn where_nothing_differs_or_parameters_follow_from_each_other_there_is_no_regression() {
    let list: Vec<f64> = (0..50).map(f64::from).collect();
    let odd: Vec<f64> = (0..50).map(|i| f64::from(i * 7 % 50)).collect();
    assert!(RankRegression::new(&[1.0; 50], std::slice::from_ref(&list), 1).is_none());
    assert!(RankRegression::new(&list, &[vec![2.0; 50]], 1).is_none());
    assert!(RankRegression::new(&odd, &[list.clone(), list.clone()], 1).is_none());
    assert!(RankRegression::new(&odd, &[], 1).is_none() && RankRegression::new(&odd, &[vec![1.0]], 1).is_none());
    assert!((RankRegression::new(&odd, &[odd.clone(), list], 1).unwrap().explained - 1.0).abs() < 1e-12);
}

/// The number after a key in a scenario.
fn number(text: &str, key: &str) -> f64 {
    let rest = text.split_once(&format!("{key} = ")).unwrap().1;
    rest.split([',', '\n', ' ', '}']).next().unwrap().parse().unwrap()
}

#[test]
fn bodies_are_women_and_men_in_turn_with_the_moments_of_their_tables() {
    let bodies = 4096;
    let study = study(bodies, 3);
    assert_eq!((study.rows(), study.parts(), study.rows_of(1023)), (4096, 1024, 4092..4096));
    // Of docs/sweeps.md: mean and deviation of stature, median and deviation of the logarithm of mass, correlation.
    for (sex, expected) in [(0, [1.628, 0.0642, 66.9, 0.160, 0.539]), (1, [1.756, 0.0686, 84.4, 0.165, 0.471])] {
        let (mut scores, mut statures) = (vec![], vec![]);
        for row in (sex..bodies).step_by(2) {
            let text = study.scenario(row);
            assert_eq!(text.contains("\"female\""), sex == 0, "{text}");
            statures.push(number(&text, "stature_m"));
            scores.push((
                libm::log(number(&text, "mass_kg")),
                number(&text, "deviations"),
                libm::log(number(&text, "spread")),
            ));
        }
        let n = statures.len() as f64;
        let mean = |list: &[f64]| list.iter().sum::<f64>() / n;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / n - mean(a) * mean(b);
        let mass: Vec<f64> = scores.iter().map(|score| score.0).collect();
        let strength: Vec<f64> = scores.iter().map(|score| score.1).collect();
        let spread: Vec<f64> = scores.iter().map(|score| score.2).collect();
        let deviation = |list: &[f64]| product(list, list).sqrt();
        let correlation = |a: &[f64], b: &[f64]| product(a, b) / deviation(a) / deviation(b);
        let found = [
            mean(&statures),
            deviation(&statures),
            libm::exp(mean(&mass)),
            deviation(&mass),
            correlation(&statures, &mass),
        ];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.01, "{found}, {expected}");
        }
        assert!(mean(&strength).abs() < 0.01 && (deviation(&strength) - 1.0).abs() < 0.01);
        assert!(mean(&spread).abs() < 0.01 && (deviation(&spread) - 0.2).abs() < 0.002);
        assert!(correlation(&statures, &strength).abs() < 0.02 && correlation(&strength, &spread).abs() < 0.02);
    }
}

#[test]
fn more_bodies_begin_with_the_same_ones_and_another_seed_gives_others() {
    let (few, more) = (study(10, 0), study(100, 0));
    assert!((0..10).all(|row| few.scenario(row) == more.scenario(row)));
    assert!((0..2).all(|part| few.key(part) == more.key(part)));
    assert!((0..10).all(|row| few.scenario(row) != study(10, 1).scenario(row)));
    // Women and men have different points, and points stay as even as those of the sequence: one in each of 64 intervals.
    assert!(few.point(0)[0] != few.point(1)[0]);
    for dimension in 0..4 {
        let mut intervals: Vec<usize> =
            (0..128).step_by(2).map(|row| (64.0 * study(128, 5).point(row)[dimension]) as usize).collect();
        intervals.sort_unstable();
        assert_eq!(intervals, (0..64).collect::<Vec<_>>());
    }
}

fn answer(row: usize, kind: &'static str, minutes: Option<f64>, who: Option<&str>, load: f64) -> Answer {
    let who = who.map(str::to_owned);
    Answer { row, outcome: Outcome { kind, minutes, who, load: Some(load), ..Outcome::default() } }
}

#[test]
fn counts_are_those_by_hand() {
    let study = study(16, 0);
    let (elbow, knee) = (Some("elbow"), Some("knee"));
    // Women are the even rows, men the odd ones; ten minutes are asked.
    let answers = [
        answer(0, "holds", None, elbow, 0.1),
        answer(2, "holds", Some(10.0), elbow, 0.3),
        answer(4, "holds", Some(9.9), elbow, 0.3), // A run that settled before.
        answer(6, "held_until", Some(4.0), knee, 0.5),
        answer(8, "held_until", Some(2.0), elbow, 0.6),
        answer(10, "cannot_be_done", None, elbow, 1.2),
        answer(12, "cannot_stand", None, None, 0.2),
        answer(14, "refused", None, None, 0.0),
        answer(1, "holds", Some(30.0), knee, 0.1),
        answer(3, "not_reached", None, knee, 0.4),
        answer(5, "cannot_be_done", None, knee, 0.9),
    ];
    let found = Population::new(&study, &answers, 10.0, 0);
    let [women, men] = &found.sexes;
    assert_eq!(SEXES.len(), 2);
    assert_eq!((women.number, women.not_judged, women.can), (7, 1, 2));
    assert_eq!(women.interval, wilson(2, 7));
    assert_eq!(women.minutes, [0.0, 0.0, 2.0, 4.0, 9.9, 10.0, f64::INFINITY]);
    assert_eq!(
        [0.05, 0.5, 0.95, 1.0].map(|share| women.quantile(share).unwrap()),
        [0.0, 4.0, f64::INFINITY, f64::INFINITY]
    );
    let balance = "balance (the supports do not hold the body)";
    let expected = [("elbow", 3), (balance, 1), ("knee", 1)].map(|(who, count)| (who.to_owned(), count));
    assert_eq!(women.fails, expected);
    assert_eq!((men.number, men.not_judged, men.can, men.share()), (3, 0, 1, Some(1.0 / 3.0)));
    let expected = ["grip of a hand", "reach (the target is missed)"].map(|who| (who.to_owned(), 1));
    assert_eq!(men.fails, expected);
    assert_eq!(found.sensitivity, Err(NoSensitivity::TooFew));
    let nobody = Population::new(&study, &[], 10.0, 0).sexes[0].clone();
    assert_eq!((nobody.share(), nobody.quantile(0.5), nobody.interval), (None, None, [0.0, 1.0]));
}

#[test]
fn an_answer_that_follows_from_one_parameter_depends_on_it_alone() {
    let study = study(200, 2);
    // Stronger people hold it longer; nobody is asked for more than 90 minutes.
    let time = |row: usize| 100.0 * study.point(row)[2];
    let answers: Vec<Answer> = (0..200).map(|row| answer(row, "holds", Some(time(row)), None, 0.1)).collect();
    let found = Population::new(&study, &answers, 90.0, 0).sensitivity.unwrap();
    let shares: Vec<f64> = found.regression.coefficients.iter().map(|coefficient| coefficient.share()).collect();
    assert!(!found.of_load && shares[3] > 0.98, "{shares:?}");
    assert!(shares.iter().enumerate().all(|(i, share)| i == 3 || *share < 0.01), "{shares:?}");
    assert!(found.regression.coefficients[3].value > 0.0);
    // Where all have the same time their load is the answer; by sex it is women who carry more.
    let answers: Vec<Answer> =
        (0..200).map(|row| answer(row, "holds", None, None, if row % 2 == 0 { 0.3 } else { 0.2 })).collect();
    let found = Population::new(&study, &answers, 90.0, 0).sensitivity.unwrap();
    assert!(found.of_load && (found.regression.coefficients[0].value + 1.0).abs() < 1e-3, "{found:?}");
    let same: Vec<Answer> = (0..200).map(|row| answer(row, "holds", None, None, 0.3)).collect();
    assert_eq!(Population::new(&study, &same, 90.0, 0).sensitivity, Err(NoSensitivity::SameAnswers));
    assert!((cumulative(0.0) - 0.5).abs() < 1e-15);
}

#[test]
fn where_nearly_all_have_the_same_time_the_known_loads_are_the_answer_and_bodies_without_one_are_left_out() {
    let study = study(200, 2);
    let strength = |row: usize| study.point(row)[2];
    let fails = |row: usize| if strength(row) < 0.1 { "cannot_stand" } else { "holds" };
    let with_load = |load: fn(f64) -> Option<f64>| {
        let answers = (0..200).map(|row| {
            let answer = answer(row, fails(row), None, None, 0.0);
            Answer { outcome: Outcome { load: load(strength(row)), ..answer.outcome }, ..answer }
        });
        Population::new(&study, &answers.collect::<Vec<_>>(), 90.0, 0).sensitivity
    };
    let few = (0..200).filter(|row| strength(*row) < 0.1).count();
    assert!((15..25).contains(&few));
    let found = with_load(|strength| (strength >= 0.1).then_some(2.0 - strength)).unwrap();
    assert!(found.of_load && found.left_out == few && found.regression.ceiling == 1.0, "{found:?}");
    assert_eq!(found.sorted()[0].0, "strength");
    assert!(found.regression.coefficients[3].value < -0.98 && found.parameters == PARAMETERS, "{found:?}");
    // Without loads the times are the answer: strength explains nearly all that their equality leaves.
    let found = with_load(|_| None).unwrap();
    assert!(!found.of_load && found.left_out == 0 && found.regression.explained < 0.3, "{found:?}");
    assert!(found.regression.of_ceiling() > 0.95 && found.sorted()[0].0 == "strength", "{found:?}");
}

#[test]
fn without_shares_the_reason_is_the_true_one_and_a_parameter_that_does_not_differ_is_left_out() {
    let study = study(200, 2);
    let of = |answers: Vec<Answer>| Population::new(&study, &answers, 90.0, 0);
    let unknown = |row: usize| {
        let answer = answer(row, "holds", None, None, 0.0);
        Answer { outcome: Outcome { load: (row > 170).then_some(0.1 * row as f64), ..answer.outcome }, ..answer }
    };
    assert_eq!(of((0..200).map(unknown).collect()).sensitivity, Err(NoSensitivity::NotKnown), "29 loads are known");
    // All women are refused: sex is one.
    let time = |row: usize| 100.0 * study.point(row)[2];
    let men = |row: usize| match row % 2 {
        0 => {
            Answer { row, outcome: Outcome { kind: "refused", note: Some(format!("no {row}")), ..Outcome::default() } }
        }
        _ => answer(row, "holds", Some(time(row)), None, 0.1),
    };
    let found = of((0..200).map(men).collect());
    assert_eq!(
        (found.sexes[0].not_judged, found.sexes[1].number, found.first_note.as_deref()),
        (100, 100, Some("no 0"))
    );
    let sensitivity = found.sensitivity.unwrap();
    assert_eq!(sensitivity.parameters, PARAMETERS[1..]);
    assert!(sensitivity.sorted()[0].0 == "strength" && sensitivity.regression.coefficients[2].value > 0.98);
    assert_eq!(sensitivity.regression.coefficients.len(), 4);
}

#[test]
fn a_part_is_read_whole_or_not_at_all() {
    let study = study(8, 0);
    let bytes = study.part(1, || true, || {}).unwrap();
    let answers = study.read(1, &bytes).unwrap();
    assert_eq!(answers.iter().map(|answer| answer.row).collect::<Vec<_>>(), [4, 5, 6, 7]);
    let outcome = |row| Outcome::of("base.toml", &study.scenario(row), || true).unwrap();
    assert!(answers.iter().all(|answer| answer.outcome == outcome(answer.row)), "{answers:?}");
    for end in 0..bytes.len() {
        assert!(study.read(1, &bytes[..end]).is_none(), "{end}");
    }
    assert!(study.read(1, &[&bytes[..], b" "].concat()).is_none());
    // The rows of another part, the same rows of other bodies, and fewer rows.
    assert!(study.read(0, &bytes).is_none());
    assert!(self::study(8, 1).read(1, &bytes).is_none() && self::study(6, 0).read(1, &bytes).is_none());
    // Any bit that changes no answer but is another one than the program would write: names, key, meanings, parameters.
    let mut read = 0;
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 1;
        if let Some(other) = study.read(1, &changed) {
            assert_ne!(other, answers, "{place}");
            read += 1;
        }
    }
    assert!((1..bytes.len() / 4).contains(&read), "{read} of {} changes gave other answers", bytes.len());
}

#[test]
fn nobody_is_weaker_or_stronger_than_a_scenario_takes() {
    // Of a normal distribution 4.65 of 10,000 numbers lie beyond 3.5 standard deviations; the other values keep their order and nearly their size.
    let plan = &population("base.toml", 100_000, 0)[0];
    let uncut = contrapposto_formats::Plan {
        parameters: plan.parameters.iter().cloned().map(|p| Parameter { within: None, ..p }).collect(),
        ..plan.clone()
    };
    let [cut, uncut] = [plan, &uncut].map(Sampler::new);
    let deviations = |sampler: &Sampler, row| match sampler.values(row)[2] {
        Value::Number(number) => number,
        ref other => panic!("{other}"),
    };
    let pairs: Vec<(f64, f64)> = (0..50_000).map(|row| (deviations(&cut, row), deviations(&uncut, row))).collect();
    let beyond = pairs.iter().filter(|(_, uncut)| uncut.abs() > 3.5).count();
    assert!((18..=29).contains(&beyond), "{beyond} of 50,000");
    assert!(pairs.iter().all(|(cut, _)| cut.abs() < 3.5));
    assert!(pairs.iter().filter(|(_, uncut)| uncut.abs() < 2.0).all(|(cut, uncut)| (cut - uncut).abs() < 0.005));
    let variance = pairs.iter().map(|(cut, _)| cut * cut).sum::<f64>() / 50_000.0;
    // scipy.stats.truncnorm(-3.5, 3.5).var().
    assert!((variance - 0.993_89).abs() < 1e-4, "{variance}");
}

#[test]
fn the_last_part_of_fewer_bodies_is_known_as_the_beginning_of_a_part_of_more() {
    let [few, more, other] = [study(42, 0), study(100, 0), study(100, 1)];
    assert_ne!(few.key(10), more.key(10));
    assert!(few.keys_of_other_lengths(10).contains(&more.key(10)));
    assert!(more.keys_of_other_lengths(10).contains(&few.key(10)));
    assert!(
        !more.keys_of_other_lengths(10).contains(&other.key(10))
            && !more.keys_of_other_lengths(10).contains(&more.key(10))
    );
    assert!(other.keys_of_other_lengths(10).iter().all(|key| *key != few.key(10) && *key != more.key(10)));
}
