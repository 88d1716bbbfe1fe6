//! Points and rows of plans: Sobol and normal numbers equal scipy's, designs keep their promises, correlations are those of the plan.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

use contrapposto::math::normal::{cumulative, quantile};
use contrapposto_formats::{Plan, Value, read_plan};
use contrapposto_sweep::{MOST_DIMENSIONS, Sampler, sobol};

/// Written by `scripts/sobol_reference.py`.
const SCIPY: &str = include_str!("scipy.csv");

fn plan(design: &str, rows: usize, parameters: &str) -> Plan {
    let text = format!("base = \"a.toml\"\nseed = 3\ndesign = \"{design}\"\nrows = {rows}\n[parameters]\n{parameters}");
    read_plan("plan.toml", text.as_bytes()).unwrap()
}

fn numbers(sampler: &Sampler, row: usize) -> Vec<f64> {
    let number = |value: &Value| if let Value::Number(number) = value { *number } else { f64::NAN };
    sampler.values(row).iter().map(number).collect()
}

#[test]
fn sobol_points_equal_those_of_scipy_to_the_last_bit_in_64_dimensions() {
    let mut checked = 0;
    for line in SCIPY.lines().filter_map(|line| line.strip_prefix("sobol,")) {
        let mut cells = line.split(',');
        let index: u32 = cells.next().unwrap().parse().unwrap();
        for (dimension, cell) in cells.enumerate() {
            assert_eq!(sobol(index, dimension), cell.parse::<f64>().unwrap(), "point {index}, dimension {dimension}");
            checked += 1;
        }
    }
    assert_eq!(checked, 9 * MOST_DIMENSIONS);
}

#[test]
fn normal_distribution_and_its_inverse_equal_those_of_scipy() {
    let mut checked = 0;
    for line in SCIPY.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |i: usize| cells[i].parse::<f64>().unwrap();
        match cells[0] {
            "quantile" => assert!((quantile(cell(1)) - cell(2)).abs() < 1e-14 * (1.0 + cell(2).abs()), "{line}"),
            "cumulative" => assert!((cumulative(cell(1)) - cell(2)).abs() < 1e-15, "{line}"),
            _ => continue,
        }
        checked += 1;
    }
    assert_eq!(checked, 26);
    for x in [-5.0, -1.3, 0.2, 3.0] {
        assert!((quantile(cumulative(x)) - x).abs() < 1e-9);
    }
}

#[test]
fn a_row_of_a_sobol_plan_is_the_next_point_of_the_sequence_without_the_origin() {
    let sampler =
        Sampler::new(&plan("sobol", 7, "a = { range = [2, 4] }\nb = { normal = [10, 2] }\nc = { list = [1, 2] }"));
    assert_eq!(numbers(&sampler, 0), [3.0, 10.0, 2.0]);
    let third = numbers(&sampler, 2);
    assert_eq!((third[0], third[2]), (2.5, 2.0), "point 3 of scipy: 0.25, 0.75, 0.75");
    assert!((third[1] - (10.0 + 2.0 * 0.674_489_750_196_081_7)).abs() < 1e-12);
}

#[test]
fn a_grid_has_every_combination_once_with_both_ends_of_a_range() {
    let text = "base = \"a.toml\"\ndesign = \"grid\"\n[parameters]\na = { range = [0, 1], levels = 3 }\nb = { list = [\"x\", \"y\"] }\n";
    let sampler = Sampler::new(&read_plan("plan.toml", text.as_bytes()).unwrap());
    let rows: Vec<String> = (0..6).map(|row| sampler.values(row).iter().map(Value::to_string).collect()).collect();
    assert_eq!(rows, ["0\"x\"", "0\"y\"", "0.5\"x\"", "0.5\"y\"", "1\"x\"", "1\"y\""]);
}

#[test]
fn a_latin_hypercube_has_one_value_of_every_parameter_in_each_stratum() {
    let sampler = Sampler::new(&plan("latin_hypercube", 50, "a = { range = [0, 50] }\nb = { range = [0, 50] }"));
    for parameter in 0..2 {
        let mut strata: Vec<usize> = (0..50).map(|row| numbers(&sampler, row)[parameter] as usize).collect();
        assert!(strata.windows(2).any(|pair| pair[0] > pair[1]), "in random order");
        strata.sort_unstable();
        assert_eq!(strata, (0..50).collect::<Vec<_>>());
    }
}

#[test]
fn correlated_parameters_have_the_correlation_and_the_moments_of_the_plan() {
    let parameters =
        "a = { normal = [5, 2], correlate = { b = 0.6 } }\nb = { lognormal = [70, 0.2] }\nc = { range = [0, 1] }";
    for (design, count) in [("random", 20_000), ("sobol", 4095), ("latin_hypercube", 4000)] {
        let sampler = Sampler::new(&plan(design, count, parameters));
        let rows: Vec<Vec<f64>> = (0..count).map(|row| numbers(&sampler, row)).collect();
        let mean = |value: &dyn Fn(&Vec<f64>) -> f64| rows.iter().map(value).sum::<f64>() / count as f64;
        let (a, b) = (|row: &Vec<f64>| (row[0] - 5.0) / 2.0, |row: &Vec<f64>| libm::log(row[1] / 70.0) / 0.2);
        let c = |row: &Vec<f64>| (row[2] - 0.5) * 12f64.sqrt();
        // Five standard errors of independent rows.
        let near = 5.0 / (count as f64).sqrt();
        assert!(mean(&a).abs() < near && mean(&b).abs() < near && mean(&c).abs() < near, "{design}");
        assert!((mean(&|r| a(r).powi(2)) - 1.0).abs() < 2.0 * near, "{design}");
        assert!((mean(&|r| b(r).powi(2)) - 1.0).abs() < 2.0 * near, "{design}");
        assert!((mean(&|r| a(r) * b(r)) - 0.6).abs() < 1.2 * near, "{design}: {}", mean(&|r| a(r) * b(r)));
        assert!(mean(&|r| a(r) * c(r)).abs() < near, "{design}");
    }
}

#[test]
fn a_distribution_that_is_cut_off_has_the_values_of_the_whole_one_between_its_ends_and_none_beyond() {
    let text = "a = { normal = [5, 2], within = [3, 6], correlate = { b = 0.6 } }\nb = { lognormal = [70, 0.2], within = [-1, 80] }";
    let (normal, logarithm) = (|a: f64| (a - 5.0) / 2.0, |b: f64| libm::log(b / 70.0) / 0.2);
    for (design, count) in [("random", 20_000), ("shifted_sobol", 4096), ("latin_hypercube", 4000)] {
        let sampler = Sampler::new(&plan(design, count, text));
        let rows: Vec<Vec<f64>> = (0..count).map(|row| numbers(&sampler, row)).collect();
        for (parameter, low, high) in [(0, 3.0, 6.0), (1, 0.0, 80.0)] {
            let score = |x: f64| if parameter == 0 { normal(x) } else { logarithm(x) };
            let [from, to] = [cumulative(score(low)), cumulative(score(high))];
            let mut shares: Vec<f64> =
                rows.iter().map(|row| (cumulative(score(row[parameter])) - from) / (to - from)).collect();
            shares.sort_by(f64::total_cmp);
            assert!(rows.iter().all(|row| (low..=high).contains(&row[parameter])), "{design} {parameter}");
            // Kolmogorov's distance from the distribution of the whole one between the ends; 1.95 / sqrt(n) once in a thousand samples.
            let distance = |(i, share): (usize, &f64)| (share - (i as f64 + 0.5) / count as f64).abs();
            let farthest = shares.iter().enumerate().map(distance).fold(0.0, f64::max);
            assert!(farthest < 1.95 / (count as f64).sqrt(), "{design} {parameter}: {farthest}");
        }
        let heaped = rows.iter().filter(|row| row[0] == 3.0 || row[0] == 6.0 || row[1] == 80.0).count();
        assert_eq!(heaped, 0, "{design}");
        // The scores from which both follow are correlated as the plan says.
        let scores = rows.iter().map(|row| {
            let share = |x: f64, low: f64, high: f64| (x - low) / (high - low);
            let [a, b] = [cumulative(normal(row[0])), cumulative(logarithm(row[1]))];
            quantile(share(a, cumulative(-1.0), cumulative(0.5))) * quantile(share(b, 0.0, cumulative(logarithm(80.0))))
        });
        let correlation = scores.sum::<f64>() / count as f64;
        assert!((correlation - 0.6).abs() < 6.0 / (count as f64).sqrt(), "{design}: {correlation}");
    }
}

#[test]
fn ends_that_nothing_lies_beyond_change_no_value_and_levels_of_a_grid_are_between_them() {
    let whole = Sampler::new(&plan("sobol", 1000, "a = { normal = [5, 2] }"));
    let wide = Sampler::new(&plan("sobol", 1000, "a = { normal = [5, 2], within = [-15, 25] }"));
    for row in 0..1000 {
        assert!((numbers(&whole, row)[0] - numbers(&wide, row)[0]).abs() < 1e-12, "{row}");
    }
    let text =
        "base = \"a.toml\"\ndesign = \"grid\"\n[parameters]\na = { normal = [0, 1], within = [-1, 1], levels = 3 }\n";
    let grid = Sampler::new(&read_plan("plan.toml", text.as_bytes()).unwrap());
    // scipy.stats.truncnorm(-1, 1).ppf of 1/6, 1/2 and 5/6.
    let expected = [-0.605_459_58, 0.0, 0.605_459_58];
    for (row, expected) in expected.into_iter().enumerate() {
        assert!((numbers(&grid, row)[0] - expected).abs() < 1e-8, "{row}");
    }
}
