//! Computes eigenvalues and eigenvectors of a small symmetric matrix by rotations in planes that each clear one entry
//! (Jacobi 1846; Golub & Van Loan 2013, "Matrix Computations", section 8.5).

use crate::tolerances::{OFF_DIAGONAL, SWEEPS};

/// Workspace and result of the eigenvalue decomposition `A = sum_i lambda_i v_i v_i^T`.
#[derive(Clone, Debug)]
pub struct SymmetricEigen {
    n: usize,
    matrix: Vec<f64>,
    /// One eigenvector a row.
    vectors: Vec<f64>,
}

impl SymmetricEigen {
    /// Space for matrices up to `n` by `n`.
    pub fn new(n: usize) -> Self {
        Self { n: 0, matrix: Vec::with_capacity(n * n), vectors: Vec::with_capacity(n * n) }
    }

    /// Decomposes the symmetric `n` by `n` matrix with these entries.
    pub fn decompose(&mut self, n: usize, entry: impl Fn(usize, usize) -> f64) {
        self.n = n;
        let Self { matrix: a, vectors, .. } = self;
        a.clear();
        a.extend((0..n * n).map(|k| entry(k / n, k % n)));
        vectors.clear();
        vectors.extend((0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }));
        let size = a.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for _ in 0..SWEEPS {
            let mut diagonal = true;
            for p in 0..n {
                for q in p + 1..n {
                    if a[p * n + q].abs() <= OFF_DIAGONAL * size {
                        continue;
                    }
                    diagonal = false;
                    let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
                    let t = 1.0_f64.copysign(theta) / (theta.abs() + libm::hypot(theta, 1.0));
                    let c = 1.0 / libm::hypot(t, 1.0);
                    rotate_rows(a, n, p, q, c, t * c);
                    for row in a.chunks_exact_mut(n) {
                        (row[p], row[q]) = (c * row[p] - t * c * row[q], t * c * row[p] + c * row[q]);
                    }
                    (a[p * n + q], a[q * n + p]) = (0.0, 0.0);
                    rotate_rows(vectors, n, p, q, c, t * c);
                }
            }
            if diagonal {
                break;
            }
        }
    }

    /// Eigenvalues, each with its eigenvector of unit length.
    pub fn iter(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let n = self.n;
        (0..n).map(move |i| (self.matrix[i * n + i], &self.vectors[i * n..(i + 1) * n]))
    }
}

/// Rotates the rows `p < q` of a square matrix by the angle with cosine `c` and sine `s`.
fn rotate_rows(matrix: &mut [f64], n: usize, p: usize, q: usize, c: f64, s: f64) {
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

    use super::SymmetricEigen;

    #[test]
    fn eigenvalues_and_eigenvectors_give_the_matrix_back() {
        let mut random = Pcg64Mcg::new(3);
        let mut eigen = SymmetricEigen::new(20);
        for n in 0..=20 {
            let half = DMatrix::from_fn(n, n, |_, _| random.random_range(-1.0..1.0));
            let matrix = &half + half.transpose();
            eigen.decompose(n, |i, j| matrix[(i, j)]);
            let mut back = DMatrix::zeros(n, n);
            let mut square = DMatrix::zeros(n, n);
            for (value, vector) in eigen.iter() {
                let vector = DMatrix::from_column_slice(n, 1, vector);
                back += value * &vector * vector.transpose();
                square += &vector * vector.transpose();
            }
            assert!((back - &matrix).abs().max() < 1e-13 || n == 0);
            assert!((square - DMatrix::identity(n, n)).abs().max() < 1e-13 || n == 0);
        }
    }
}
