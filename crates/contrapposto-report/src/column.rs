//! Writes numbers over time in few characters: whole multiples of a visible step, each as the difference from the one before.

use serde_json::{Value, json};

/// Largest multiple: beyond it a browser loses digits.
const LARGEST: f64 = 1e12;
/// Steps to which lengths, turns (parts of a quaternion) and shares are rounded: the smallest visible differences.
pub(crate) const METRES: f64 = 1e-4;
pub(crate) const TURN: f64 = 2e-4;
pub(crate) const SHARE: f64 = 1e-3;

/// `count` numbers, rounded to multiples of `step`; trailing zero differences are left out.
pub(crate) fn column(values: impl IntoIterator<Item = f64>, count: usize, step: f64) -> Value {
    let mut before = 0;
    let mut differences: Vec<i64> = vec![];
    for value in values.into_iter().take(count) {
        let multiple = (value / step).round().clamp(-LARGEST, LARGEST);
        let multiple = if multiple.is_nan() { 0 } else { multiple as i64 };
        differences.push(multiple - before);
        before = multiple;
    }
    while differences.last() == Some(&0) {
        differences.pop();
    }
    json!({ "step": step, "by": differences })
}

/// A column for each component.
pub(crate) fn columns<const N: usize>(rows: &[[f64; N]], count: usize, step: [f64; N]) -> Value {
    (0..N).map(|k| column(rows.iter().map(|row| row[k]), count, step[k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(column: &Value, count: usize) -> Vec<f64> {
        let by = column["by"].as_array().unwrap();
        let mut sum = 0;
        let step = column["step"].as_f64().unwrap();
        (0..count)
            .map(|i| by.get(i).map_or(0, |d| d.as_i64().unwrap()))
            .map(|d| {
                sum += d;
                sum as f64 * step
            })
            .collect()
    }

    #[test]
    fn values_come_back_rounded_to_the_step() {
        let values = [1.2345, -3.0, -3.0, 7.77];
        for (a, b) in values.iter().zip(back(&column(values, 4, 0.01), 4)) {
            assert!((a - b).abs() <= 0.005 + 1e-12, "{a} came back as {b}");
        }
    }

    #[test]
    fn a_constant_column_is_one_difference() {
        assert_eq!(column([5.0; 1000], 1000, 1.0), json!({ "step": 1.0, "by": [5] }));
    }

    #[test]
    fn infinite_and_missing_numbers_give_bounded_differences() {
        let odd = column([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300], 4, 1e-3);
        assert!(odd["by"].as_array().unwrap().iter().all(|d| d.as_i64().unwrap().abs() <= 2_000_000_000_000));
    }
}
