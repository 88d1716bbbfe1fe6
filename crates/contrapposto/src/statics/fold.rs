//! Converts torques of elementary motions into torques of coordinates.
//!
//! By the chain rule, an elementary motion `u = f(q)` gives its coordinate `tau_q = f'(q) tau_u`; a dependent coordinate
//! `q_d = g(q_i)` gives its independent one `g'(q_i) tau_d`. Gradients follow with the second derivatives:
//! `H_q = F^T H_u F + tau_u f''`, then `H_i = G^T H_q G + tau_d g''`. Chains of couplings are folded from their ends, so
//! that `tau_d` contains the torques of the coordinates that depend on it.

use crate::kinematics::Kinematics;
use crate::model::Model;

/// `d external_i / d q_j`, N m/rad (or per m), rows and columns in the order of the model's rates. Rows and columns of
/// dependent coordinates are zero: they are folded into their independent one.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    n: usize,
    entries: Vec<f64>,
    /// The matrix of elementary motions, where it is not the same.
    elements: Vec<f64>,
    /// Torque of each rate with its dependent coordinates folded in, before it is folded itself.
    carried: Vec<f64>,
    /// Entries that plain weights and forces leave at zero may hold something.
    dirty: bool,
    symmetric: bool,
}

impl Gradient {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        let (n, m) = (model.rates.len(), model.elements.len());
        let elements = vec![0.0; if model.direct { 0 } else { m * m }];
        Self { n, entries: vec![0.0; n * n], elements, carried: vec![0.0; n], dirty: false, symmetric: true }
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// `d external_row / d q_column`.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.n + column]
    }

    /// Adds to an entry, and to its image below the diagonal, until the next gradient.
    pub(crate) fn add_symmetric(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.n + column] += value;
        if row != column {
            self.entries[column * self.n + row] += value;
        }
        self.dirty |= self.elements.is_empty();
    }

    /// Row `J tau_e,l` of Eq. 7.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.n..(row + 1) * self.n]
    }

    /// Whether the matrix is symmetric. The gradient of weights and world-fixed forces is, because they have a potential, unless a
    /// ball turns about axes that turn with it.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// The matrix of elementary motions. Entries of pairs on different branches, and of slides nearer the root, are zero; what
    /// couples and body-fixed forces (`twisted`) wrote there is cleared, the rest is overwritten every time.
    pub(super) fn begin(&mut self, model: &Model, twisted: bool) -> &mut [f64] {
        let matrix = if self.elements.is_empty() { &mut self.entries } else { &mut self.elements };
        if self.dirty {
            matrix.fill(0.0);
        }
        self.dirty = twisted;
        self.symmetric = !twisted && !model.has_balls;
        matrix
    }

    /// Folds the matrix of elementary motions into that of the rates. `torques` by element, `raw` by rate.
    pub(super) fn fold(&mut self, model: &Model, kinematics: &Kinematics, torques: &[f64], raw: &[f64]) {
        if model.direct {
            return;
        }
        let (n, m) = (self.n, model.elements.len());
        self.entries.fill(0.0);
        for (i, row) in model.elements.iter().enumerate() {
            let Some(row) = *row else { continue };
            let (slope, curvature) = kinematics.drives[i];
            for (j, column) in model.elements.iter().enumerate() {
                if let Some(column) = *column {
                    self.entries[row * n + column] += slope * kinematics.drives[j].0 * self.elements[i * m + j];
                }
            }
            self.entries[row * n + row] += curvature * torques[i];
        }
        self.carried.copy_from_slice(raw);
        for (coupling, &(slope, curvature)) in model.couplings.iter().zip(&kinematics.couplings).rev() {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) else { continue };
            for row in 0..n {
                let entry = std::mem::take(&mut self.entries[row * n + d]);
                self.entries[row * n + i] += slope * entry;
            }
            for column in 0..n {
                let entry = std::mem::take(&mut self.entries[d * n + column]);
                self.entries[i * n + column] += slope * entry;
            }
            self.entries[i * n + i] += curvature * self.carried[d];
            self.carried[i] += slope * self.carried[d];
        }
    }
}

impl Kinematics {
    /// Torques of elementary motions become torques of rates.
    pub(crate) fn fold_elements(&self, model: &Model, elements: &[f64], rates: &mut [f64]) {
        rates.fill(0.0);
        for ((rate, torque), (slope, _)) in model.elements.iter().zip(elements).zip(&self.drives) {
            if let Some(rate) = *rate {
                rates[rate] += slope * torque;
            }
        }
    }

    /// Folds torques by rate, computed as if nothing were coupled: every dependent coordinate into its independent one.
    pub(crate) fn fold_couplings(&self, model: &Model, raw: &[f64], folded: &mut [f64]) {
        folded.copy_from_slice(raw);
        for (coupling, (slope, _)) in model.couplings.iter().zip(&self.couplings).rev() {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) {
                folded[i] += slope * std::mem::take(&mut folded[d]);
            }
        }
    }
}
