//! Values outside the range of a coordinate.

/// Share of the instants that counts as nearly all. Assumed.
pub const NEARLY_ALL: f64 = 0.9;
/// A value that leaves its range by less than this, rad or m, counts as inside. Assumed: files hold rounded angles.
const SLACK: f64 = 1e-3;

/// The share of values that lie outside a range, 0..=1; 0 without values.
pub fn share_outside(values: impl IntoIterator<Item = f64>, (min, max): (f64, f64)) -> f64 {
    let (mut outside, mut all) = (0, 0);
    for value in values {
        all += 1;
        outside += usize::from(value < min - SLACK || value > max + SLACK);
    }
    outside as f64 / all.max(1) as f64
}
