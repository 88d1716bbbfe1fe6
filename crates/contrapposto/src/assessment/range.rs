//! Values outside the range of a coordinate.

/// Share of the instants that counts as nearly all. Assumed.
pub const NEARLY_ALL: f64 = 0.9;
/// Share of the instants outside of its range from which on a coordinate whose opposite lies inside has a wrong sign: a knee that walks is nearly
/// straight in half of them. Assumed.
const OFTEN: f64 = 0.25;
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

/// Whether values lie outside a range in nearly all instants, or often while their opposites lie inside: a wrong sign, unit or zero.
pub fn is_in_doubt(values: &[f64], range: (f64, f64)) -> bool {
    let outside = share_outside(values.iter().copied(), range);
    let opposite = || share_outside(values.iter().map(|value| -value), range);
    outside >= NEARLY_ALL || outside >= OFTEN && opposite() <= 1.0 - NEARLY_ALL
}
