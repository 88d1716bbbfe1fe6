//! Computes the interval of a share that was counted in a sample.

use contrapposto::math::normal::quantile;

/// Share of all samples whose interval holds the true share.
pub const CONFIDENCE: f64 = 0.95;

/// The interval of Wilson (1927) of a share that `count` of `all` independent draws have: the shares from which the count is at most as
/// many standard deviations away as [`CONFIDENCE`] says. From 0 to 1 where there is no draw.
pub fn wilson(count: usize, all: usize) -> [f64; 2] {
    if all == 0 {
        return [0.0, 1.0];
    }
    let (n, share) = (all as f64, count as f64 / all as f64);
    let z = quantile(0.5 + CONFIDENCE / 2.0);
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let end = |end: f64| (end / (1.0 + z * z / n)).clamp(0.0, 1.0);
    // At the ends the sums are exact only up to rounding.
    let low = if count == 0 { 0.0 } else { end(middle - half) };
    [low, if count == all { 1.0 } else { end(middle + half) }]
}
