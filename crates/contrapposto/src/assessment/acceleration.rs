//! Computes the acceleration of the centre of mass, which tells whether a posture may count as held at rest.

use nalgebra::Vector3;

use super::result::Peak;
use crate::posture::Posture;

/// Acceleration is a second difference over at least so much time before and after an instant, s: noise of measured motion would
/// dominate shorter ones.
const SPAN: f64 = 0.05;
/// Acceleration up to which a posture counts as held, m/s^2: a tenth of gravity.
const HELD_ACCELERATION: f64 = 1.0;
/// A motion is fast where more of its instants than this share are above that acceleration. Assumed.
pub const FAST_SHARE: f64 = 0.05;

/// Greatest acceleration of the centre of mass (m/s^2, by second differences over `SPAN` to both sides at least), and the
/// share of the instants in which it is above `HELD_ACCELERATION`.
pub fn acceleration(motion: &[(f64, Posture)], centers: &[Vector3<f64>]) -> (Peak, f64) {
    let mut peak = Peak::default();
    if centers.len() != motion.len() {
        return (peak, 0.0); // a body without mass
    }
    let time = |i: usize| motion[i].0;
    let (mut first, mut last, mut fast) = (0, 0, 0);
    for index in 0..motion.len() {
        let now = time(index);
        while first + 1 < index && now - time(first + 1) >= SPAN {
            first += 1;
        }
        while last < motion.len() && time(last) - now < SPAN {
            last += 1;
        }
        if last == motion.len() {
            break;
        }
        if now - time(first) < SPAN {
            continue;
        }
        let (before, after) = (now - time(first), time(last) - now);
        let change = (centers[last] - centers[index]) / after - (centers[index] - centers[first]) / before;
        let size = 2.0 * change.norm() / (before + after);
        peak.take(size, index, now);
        fast += usize::from(size > HELD_ACCELERATION);
    }
    (peak, fast as f64 / motion.len().max(1) as f64)
}
