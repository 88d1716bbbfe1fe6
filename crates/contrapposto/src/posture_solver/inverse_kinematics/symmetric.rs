//! Axes and eigenvalues of a small symmetric matrix, in space that is kept: turns in planes that each clear one entry
//! (Jacobi 1846; Golub & Van Loan, "Matrix Computations", section 8.5).

/// Sweeps over all planes; five or six are enough.
const SWEEPS: usize = 30;

/// See the module's text.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    n: usize,
    matrix: Vec<f64>,
    /// One axis a row.
    axes: Vec<f64>,
}

impl Axes {
    /// Space for matrices up to `n` by `n`.
    pub(super) fn new(n: usize) -> Self {
        Self { n: 0, matrix: Vec::with_capacity(n * n), axes: Vec::with_capacity(n * n) }
    }

    /// Finds those of the matrix with these entries.
    pub(super) fn find(&mut self, n: usize, entry: impl Fn(usize, usize) -> f64) {
        self.n = n;
        let Self { matrix: a, axes, .. } = self;
        a.clear();
        a.extend((0..n * n).map(|k| entry(k / n, k % n)));
        axes.clear();
        axes.extend((0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }));
        let size = a.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for _ in 0..SWEEPS {
            let mut clear = true;
            for p in 0..n {
                for q in p + 1..n {
                    if a[p * n + q].abs() <= 1e-17 * size {
                        continue;
                    }
                    clear = false;
                    let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
                    let t = 1.0_f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
                    let c = 1.0 / t.hypot(1.0);
                    turn_rows(a, n, p, q, c, t * c);
                    for row in a.chunks_exact_mut(n) {
                        (row[p], row[q]) = (c * row[p] - t * c * row[q], t * c * row[p] + c * row[q]);
                    }
                    (a[p * n + q], a[q * n + p]) = (0.0, 0.0);
                    turn_rows(axes, n, p, q, c, t * c);
                }
            }
            if clear {
                break;
            }
        }
    }

    /// Eigenvalues and their axes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let n = self.n;
        (0..n).map(move |i| (self.matrix[i * n + i], &self.axes[i * n..(i + 1) * n]))
    }
}

/// Rows `p < q` of a square matrix, turned against each other.
fn turn_rows(matrix: &mut [f64], n: usize, p: usize, q: usize, c: f64, s: f64) {
    let (head, tail) = matrix.split_at_mut(q * n);
    for (x, y) in head[p * n..(p + 1) * n].iter_mut().zip(&mut tail[..n]) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::Axes;

    #[test]
    fn axes_and_eigenvalues_give_the_matrix_back() {
        let mut random = Pcg64Mcg::new(3);
        let mut axes = Axes::new(20);
        for n in 0..=20 {
            let half = DMatrix::from_fn(n, n, |_, _| random.random_range(-1.0..1.0));
            let matrix = &half + half.transpose();
            axes.find(n, |i, j| matrix[(i, j)]);
            let mut back = DMatrix::zeros(n, n);
            let mut square = DMatrix::zeros(n, n);
            for (value, axis) in axes.iter() {
                let axis = DMatrix::from_column_slice(n, 1, axis);
                back += value * &axis * axis.transpose();
                square += &axis * axis.transpose();
            }
            assert!((back - &matrix).abs().max() < 1e-13 || n == 0);
            assert!((square - DMatrix::identity(n, n)).abs().max() < 1e-13 || n == 0);
        }
    }
}
