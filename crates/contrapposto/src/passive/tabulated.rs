//! Interpolates a measured table of passive torque.
//!
//! A monotone cubic (Fritsch & Carlson 1980) through the rows: smooth, and never outside the two neighbouring values.

use super::{Form, PassiveError};
use crate::math::{MonotoneCubic, Piece};

/// Measured torque against angle.
///
/// ```
/// use contrapposto::passive::{PassiveCurve, PassiveError, Tabulated};
/// let rows = [(0.0, 6.0), (0.5, 1.0), (1.0, 0.0), (1.5, 0.0), (2.0, -4.0)]; // rad, N m
/// let curve = PassiveCurve::new(Tabulated::new(&rows)?.form(), (0.0, 2.0), None)?;
/// assert_eq!(curve.torque(0.5), 1.0);
/// assert_eq!(curve.flattest_zone(), (1.0, 1.5));
/// assert!(matches!(Tabulated::new(&[(0.0, 1.0), (1.0, 2.0)]), Err(PassiveError::Rises { angle: 0.0, .. })));
/// # Ok::<(), PassiveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    cubic: MonotoneCubic,
    /// Energy at the start of each piece.
    energies: Vec<f64>,
}

impl Tabulated {
    /// A table of (angle rad, torque N m), angles strictly rising, torques never rising, two rows at least.
    ///
    /// # Errors
    /// [`PassiveError::Table`] names the row; [`PassiveError::Rises`] the angle where the torque begins to rise.
    pub fn new(rows: &[(f64, f64)]) -> Result<Self, PassiveError> {
        for (i, row) in rows.iter().enumerate() {
            if !row.0.is_finite() || !row.1.is_finite() {
                return Err(PassiveError::Table { row: i + 1, problem: "angle and torque must be finite" });
            }
            let Some(before) = i.checked_sub(1).map(|j| rows[j]) else { continue };
            if row.0 <= before.0 {
                return Err(PassiveError::Table { row: i + 1, problem: "its angle must be above the one before" });
            }
            if row.1 > before.1 {
                return Err(PassiveError::Rises { angle: before.0, slope: (row.1 - before.1) / (row.0 - before.0) });
            }
        }
        if rows.len() < 2 {
            return Err(PassiveError::Table { row: rows.len(), problem: "a table needs two rows at least" });
        }
        let cubic = MonotoneCubic::new(rows).ok_or(PassiveError::Table {
            row: 1,
            problem: "the steps between rows are too steep for numbers to hold",
        })?;
        let mut energies = Vec::with_capacity(cubic.pieces().len());
        let mut energy = 0.0;
        for piece in cubic.pieces() {
            energies.push(energy);
            energy -= piece.integral(piece.end);
        }
        Ok(Self { cubic, energies })
    }

    /// The cubic pieces from left to right, rad and N m.
    pub fn pieces(&self) -> &[Piece] {
        self.cubic.pieces()
    }

    /// The same table with `times` the torque at every angle.
    pub(super) fn scaled(&self, times: f64) -> Self {
        Self { cubic: self.cubic.scaled(times), energies: self.energies.iter().map(|energy| times * energy).collect() }
    }

    /// The evaluable form.
    pub fn form(self) -> Form {
        Form::Tabulated(self)
    }

    pub(super) fn check_covers(&self, range: (f64, f64)) -> Result<(), PassiveError> {
        let pieces = self.cubic.pieces();
        if pieces[0].start > range.0 {
            return Err(PassiveError::Table {
                row: 1,
                problem: "the table must begin at or below the range's lower limit",
            });
        }
        if pieces[pieces.len() - 1].end < range.1 {
            let problem = "the table must end at or above the range's upper limit";
            return Err(PassiveError::Table { row: pieces.len() + 1, problem });
        }
        Ok(())
    }

    pub(super) fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        let (torque, slope) = self.cubic.piece_at(q).value_and_slope(q);
        (torque, slope.min(0.0)) // the slope is never positive; a last bit of rounding is cut
    }

    pub(super) fn energy(&self, q: f64) -> f64 {
        let piece = self.cubic.piece_at(q);
        let i = self.cubic.pieces().partition_point(|p| p.start < piece.start);
        self.energies[i] - piece.integral(q)
    }

    pub(super) fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        // On each piece the slope is a parabola: greatest at an end or at its vertex; straight pieces are zones.
        let mut best = ((from, from), f64::NEG_INFINITY);
        for piece in self.cubic.pieces().iter().filter(|p| p.end >= from && p.start <= to) {
            let (a, b) = (piece.start.max(from), piece.end.min(to));
            let at = |q| (q, q, if q == piece.end { piece.end_slope } else { piece.value_and_slope(q).1 }.min(0.0));
            let straight = piece.coefficients[2] == 0.0 && piece.coefficients[3] == 0.0;
            let candidates = [
                Some(at(a)),
                Some(at(b)),
                piece.slope_vertex().filter(|q| (a..=b).contains(q)).map(at),
                straight.then(|| (a, b, piece.coefficients[1])),
            ];
            for (lower, upper, slope) in candidates.into_iter().flatten() {
                // Straight pieces side by side make one zone.
                let lower = if slope == best.1 && lower == best.0.1 { best.0.0 } else { lower };
                let longer = upper - lower > best.0.1 - best.0.0;
                if slope > best.1 || (slope == best.1 && longer) {
                    best = ((lower, upper), slope);
                }
            }
        }
        best.0
    }

    pub(super) fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        for piece in self.cubic.pieces() {
            piece.crossings(slope, &mut visit);
        }
    }
}
