//! Holds numbers of many postures: rows of quantities, in blocks of eight postures.

use super::lanes::{LANES, Lanes};
use crate::model::Model;

/// One row a quantity, one column a posture. Eight neighbouring postures are a block, whose rows of eight numbers follow each other in
/// memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rows: usize,
    postures: usize,
    pub(super) blocks: Vec<Lanes>,
}

impl Table {
    /// The values of all coordinates, one row each, of postures that are all the default one.
    pub fn of_postures(model: &Model, postures: usize) -> Self {
        let defaults = model.coordinates().iter().map(|c| Lanes::all(c.default));
        let blocks = (0..postures.div_ceil(LANES)).flat_map(|_| defaults.clone()).collect();
        Self { rows: model.coordinates().len(), postures, blocks }
    }

    /// Rows of zeros.
    pub(super) fn zeros(rows: usize) -> Self {
        Self { rows, postures: 0, blocks: vec![] }
    }

    /// Makes space for as many postures. Allocates if there were never as many.
    pub(super) fn resize(&mut self, postures: usize) {
        self.postures = postures;
        self.blocks.resize(postures.div_ceil(LANES) * self.rows, Lanes::ZERO);
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of postures.
    pub fn postures(&self) -> usize {
        self.postures
    }

    fn place(&self, row: usize, posture: usize) -> (usize, usize) {
        assert!(row < self.rows && posture < self.postures, "row {row}, posture {posture}: not in the table");
        (posture / LANES * self.rows + row, posture % LANES)
    }

    /// One number.
    ///
    /// # Panics
    /// When the table has no such row or posture.
    pub fn get(&self, row: usize, posture: usize) -> f64 {
        let (at, lane) = self.place(row, posture);
        self.blocks[at].0[lane]
    }

    /// Changes one number.
    ///
    /// # Panics
    /// When the table has no such row or posture.
    pub fn set(&mut self, row: usize, posture: usize, number: f64) {
        let (at, lane) = self.place(row, posture);
        self.blocks[at].0[lane] = number;
    }

    /// Changes all numbers of a posture.
    ///
    /// # Panics
    /// When the table has no such posture or another number of rows.
    pub fn set_posture(&mut self, posture: usize, numbers: &[f64]) {
        assert_eq!(numbers.len(), self.rows, "one number a row");
        for (row, number) in numbers.iter().enumerate() {
            self.set(row, posture, *number);
        }
    }

    /// One row: a number of every posture, in order.
    ///
    /// # Panics
    /// When the table has no such row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = f64> {
        assert!(row < self.rows, "row {row}: not in the table");
        let blocks = self.blocks.chunks_exact(self.rows);
        blocks.flat_map(move |block| block[row].0).take(self.postures)
    }

    /// All numbers of a posture, in order.
    ///
    /// # Panics
    /// When the table has no such posture.
    pub fn posture(&self, posture: usize) -> impl Iterator<Item = f64> {
        assert!(posture < self.postures, "posture {posture}: not in the table");
        let start = posture / LANES * self.rows;
        self.blocks[start..start + self.rows].iter().map(move |lanes| lanes.0[posture % LANES])
    }
}
