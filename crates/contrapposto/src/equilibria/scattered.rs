//! Makes starts of a search that are scattered over the ranges of the joints.
//!
//! Goal angles, other places and basin hopping search from the postures that are known. A local minimum in which the weight is on the
//! other foot, or a hip hangs on the ligaments of its other side, is reached from none of them.

use crate::math::next_number;
use crate::model::Model;
use crate::posture::Posture;

/// Usual number of scattered starts: with so many, four of four scenarios reach the least effort that 50 runs of SLSQP reach, with twelve two do
/// (docs/benchmarks.md).
pub const SCATTERED_STARTS: usize = 16;

/// Start number `k`: every coordinate that may move lies a third (even `k`) or two thirds of the way from its value in `start` to a random
/// place of its range; from farther, SLSQP reaches low minima more seldom. Coordinates without a finite range, such as those of the root, stay.
pub(super) fn scattered(model: &Model, start: &Posture, locked: &[usize], k: usize) -> Posture {
    let way = (k % 2 + 1) as f64 / 3.0;
    let mut random = k as u64 + 1;
    let mut step = vec![0.0; model.rates().len()];
    for (rate, turn) in step.iter_mut().enumerate() {
        let place = 0.5 * (1.0 + next_number(&mut random));
        let Some(coordinate) = model.rates()[rate].coordinate else { continue };
        let (lower, upper) = model.coordinates()[coordinate].range;
        let fixed = model.coordinates()[coordinate].locked || locked.contains(&rate) || model.is_dependent(coordinate);
        if !fixed && (upper - lower).is_finite() && model.coordinates()[coordinate].groups.is_some() {
            *turn = way * (lower + place * (upper - lower) - start.values()[coordinate]);
        }
    }
    let mut posture = start.clone();
    posture.displace(model, &step);
    posture
}
