//! Interpolates measured forces between the rows of their table.

use contrapposto::math::{Spline, SplineError};

use crate::motion::Table;

/// Values between two rows.
#[derive(Clone, Debug)]
pub(super) enum Interpolation {
    /// Straight lines.
    Lines,
    /// A natural cubic spline for each column.
    Splines(Vec<Spline>),
}

impl Interpolation {
    /// The value of a column at a time, s; beyond the table's ends that of its first or last row.
    pub(super) fn at<'a>(&'a self, table: &'a Table, time: f64) -> impl Fn(usize) -> f64 + Copy + 'a {
        let Table { times, rows, .. } = table;
        let after = times.partition_point(|t| *t <= time).min(times.len() - 1);
        let before = after.saturating_sub(1);
        let span = times[after] - times[before];
        let share = if span > 0.0 { ((time - times[before]) / span).clamp(0.0, 1.0) } else { 0.0 };
        let within = time.clamp(times[0], times[times.len() - 1]);
        move |column| match self {
            Self::Lines => rows[before][column] + share * (rows[after][column] - rows[before][column]),
            Self::Splines(splines) => splines[column].value(within),
        }
    }

    /// Natural cubic splines through the rows.
    pub(super) fn splines(table: &Table) -> Result<Self, SplineError> {
        let column = |column: usize| -> Vec<f64> { table.rows.iter().map(|row| row[column]).collect() };
        let splines = (0..table.columns.len()).map(|k| Spline::natural(&table.times, &column(k)));
        Ok(Self::Splines(splines.collect::<Result<_, _>>()?))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Lines by hand, and splines by second derivatives from a dense system of equations; both keep the ends' values beyond them.
    #[test]
    fn values_between_rows_are_those_of_lines_and_of_natural_splines() {
        let times = vec![0.0, 0.1, 0.25, 0.3, 0.5, 0.6];
        let values: Vec<f64> = times.iter().map(|time: &f64| 700.0 * libm::sin(9.0 * time) + 40.0).collect();
        let rows = values.iter().map(|value| vec![-1.0, *value]).collect();
        let columns = vec!["other".to_owned(), "force".to_owned()];
        let table =
            Table { name: String::new(), in_degrees: None, columns, warnings: vec![], times: times.clone(), rows };
        let n = times.len();
        let h: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut matrix = DMatrix::identity(n, n);
        let mut right = DVector::zeros(n);
        for i in 1..n - 1 {
            (matrix[(i, i - 1)], matrix[(i, i)], matrix[(i, i + 1)]) = (h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]);
            right[i] = 6.0 * ((values[i + 1] - values[i]) / h[i] - (values[i] - values[i - 1]) / h[i - 1]);
        }
        let bend = matrix.lu().solve(&right).unwrap();
        let splines = Interpolation::splines(&table).unwrap();
        for step in 0..=120 {
            let time = 0.005 * f64::from(step);
            let i = (0..n - 2).find(|&i| time < times[i + 1]).unwrap_or(n - 2);
            let (a, b) = ((times[i + 1] - time) / h[i], (time - times[i]) / h[i]);
            let line = a * values[i] + b * values[i + 1];
            let curve = line + ((a.powi(3) - a) * bend[i] + (b.powi(3) - b) * bend[i + 1]) * h[i] * h[i] / 6.0;
            assert!((Interpolation::Lines.at(&table, time)(1) - line).abs() < 1e-9, "{time}");
            assert!((splines.at(&table, time)(1) - curve).abs() < 1e-9, "{time}");
            assert!((splines.at(&table, time)(0) + 1.0).abs() < 1e-12, "{time}");
        }
        for (beyond, end) in [(-0.1, values[0]), (0.7, values[n - 1])] {
            assert!((splines.at(&table, beyond)(1) - end).abs() < 1e-12);
            assert!((Interpolation::Lines.at(&table, beyond)(1) - end).abs() < 1e-12);
        }
        let twice = Table { times: vec![0.0, 0.1, 0.1, 0.3, 0.5, 0.6], ..table };
        assert!(matches!(Interpolation::splines(&twice), Err(SplineError::Stays { .. })));
    }
}
