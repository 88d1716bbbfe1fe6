//! Writes rows of tasks into a level.

use nalgebra::{Matrix3, Vector3};

use crate::model::Model;
use hierarchical_least_squares::Level;

/// The entries of the asked axes.
pub(super) fn chosen(axes: [bool; 3], v: Vector3<f64>) -> impl Iterator<Item = f64> {
    (0..3).filter(move |&k| axes[k]).map(move |k| v[k])
}

/// `count` more rows of zeros at the end of a level's matrix, to be filled; their limits are still to come.
pub(super) fn append<'a>(level: &'a mut Level, model: &Model, count: usize) -> &'a mut [f64] {
    let start = level.matrix.len();
    level.matrix.resize(start + count * model.rates().len(), 0.0);
    &mut level.matrix[start..]
}

/// Limits of an equation for the row last appended: `row . step = -error`.
pub(super) fn equation(level: &mut Level, error: f64) {
    level.lower.push(-error);
    level.upper.push(-error);
}

/// Three equations from the three rows last appended, of which those of the other axes are removed.
pub(super) fn equations(level: &mut Level, model: &Model, axes: [bool; 3], error: Vector3<f64>) {
    let n = model.rates().len();
    let start = level.matrix.len() - 3 * n;
    let mut end = start;
    for k in (0..3).filter(|&k| axes[k]) {
        level.matrix.copy_within(start + k * n..start + (k + 1) * n, end);
        end += n;
        equation(level, error[k]);
    }
    level.matrix.truncate(end);
}

/// Replaces three rows by `matrix` times them.
pub(super) fn multiply(matrix: &Matrix3<f64>, rows: &mut [f64], n: usize) {
    let (x, rest) = rows.split_at_mut(n);
    let (y, z) = rest.split_at_mut(n);
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let column = matrix * Vector3::new(*x, *y, *z);
        (*x, *y, *z) = (column.x, column.y, column.z);
    }
}

/// Adds `v . rows` of three rows, one after the other, to one row.
pub(super) fn add_along(row: &mut [f64], v: &Vector3<f64>, rows: &[f64]) {
    let (x, rest) = rows.split_at(row.len());
    let (y, z) = rest.split_at(row.len());
    for (((entry, x), y), z) in row.iter_mut().zip(x).zip(y).zip(z) {
        *entry += v.x * x + v.y * y + v.z * z;
    }
}
