//! Computes singular values by one-sided Jacobi rotations (Hestenes 1958): slow, short and exact. That of nalgebra 0.35 was tried,
//! and is off by up to a few percent where singular values coincide.

use nalgebra::{DMatrix, DVector};

/// `a v = u diag(values)`, `v` square and orthogonal; the columns of `u` where a value is not zero are orthonormal.
pub struct Svd {
    pub u: DMatrix<f64>,
    pub values: Vec<f64>,
    pub v: DMatrix<f64>,
}

pub fn svd(a: &DMatrix<f64>) -> Svd {
    let n = a.ncols();
    let (mut u, mut v) = (a.clone(), DMatrix::identity(n, n));
    let negligible = 1e-18 * a.norm_squared();
    loop {
        let mut turned = false;
        for j in 1..n {
            for i in 0..j {
                let (ii, jj, ij) =
                    (u.column(i).norm_squared(), u.column(j).norm_squared(), u.column(i).dot(&u.column(j)));
                if ij.abs() <= negligible || ij.abs() <= 1e-15 * (ii * jj).sqrt() {
                    continue;
                }
                turned = true;
                let zeta = (jj - ii) / (2.0 * ij);
                let t = if zeta < 0.0 { -1.0 } else { 1.0 } / (zeta.abs() + libm::hypot(zeta, 1.0));
                let c = 1.0 / libm::hypot(t, 1.0);
                for matrix in [&mut u, &mut v] {
                    let (mut left, mut right) = matrix.columns_range_pair_mut(i, j);
                    for (x, y) in left.iter_mut().zip(right.iter_mut()) {
                        (*x, *y) = (c * (*x - t * *y), c * (*y + t * *x));
                    }
                }
            }
        }
        if !turned {
            break;
        }
    }
    let values: Vec<f64> = u.column_iter().map(|column| column.norm()).collect();
    for (mut column, value) in u.column_iter_mut().zip(&values) {
        column /= value.max(f64::MIN_POSITIVE);
    }
    Svd { u, values, v }
}

/// The part of the space of `free` (orthonormal columns) in the null space of the rows; none where a singular value lies
/// between `nothing` and `clear`.
pub fn null_space(rows: &DMatrix<f64>, free: &DMatrix<f64>, clear: f64, nothing: f64) -> Option<DMatrix<f64>> {
    if free.ncols() == 0 || rows.nrows() == 0 {
        return Some(free.clone());
    }
    let svd = svd(&(rows * free));
    if svd.values.iter().any(|s| (nothing..clear).contains(s)) {
        return None;
    }
    let kept: Vec<usize> = (0..svd.values.len()).filter(|i| svd.values[*i] < nothing).collect();
    Some(free * svd.v.select_columns(&kept))
}

/// The shortest `x` with the least `|a x - b|`, singular values below `nothing` taken as zero.
pub fn least_squares(a: &DMatrix<f64>, b: &DVector<f64>, nothing: f64) -> DVector<f64> {
    let mut x = DVector::zeros(a.ncols());
    // Rotating the shorter side is quicker.
    if a.nrows() < a.ncols() {
        let svd = svd(&a.transpose());
        for (i, s) in svd.values.iter().enumerate().filter(|(_, s)| **s > nothing) {
            x += svd.u.column(i) * (svd.v.column(i).dot(b) / s);
        }
    } else {
        let svd = svd(a);
        for (i, s) in svd.values.iter().enumerate().filter(|(_, s)| **s > nothing) {
            x += svd.v.column(i) * (svd.u.column(i).dot(b) / s);
        }
    }
    x
}
