//! Makes starts of a search that are scattered over the ranges of the joints.
//!
//! Goal angles, other places and basin hopping search from the postures that are known. A local minimum in which the weight is on the
//! other foot, or a hip hangs on the ligaments of its other side, is reached from none of them.

use super::mirror::Mirror;
use crate::math::next_number;
use crate::model::Model;
use crate::posture::Posture;

/// Usual number of scattered starts: with so many, six of six scenarios reach the least effort that 50 runs of SLSQP reach (docs/benchmarks.md).
pub const SCATTERED_STARTS: usize = 16;

/// Start number `k`. Of each pair the first is drawn, and the second is its mirror image, where the body has one: so the other leg gives the
/// mirror image of an answer.
pub(super) fn scattered(model: &Model, start: &Posture, locked: &[usize], k: usize) -> Posture {
    let mirror = Mirror::of(model).filter(|_| !k.is_multiple_of(2));
    let drawn = match mirror {
        Some(mirror) => mirror.posture(&drawn(model, &mirror.posture(start), k - 1)),
        None => drawn(model, start, k),
    };
    let mut step = vec![0.0; model.rates().len()];
    start.difference(model, &drawn, &mut step);
    for (rate, turn) in step.iter_mut().enumerate() {
        let coordinate = model.rates()[rate].coordinate;
        if locked.contains(&rate) || coordinate.is_some_and(|c| model.coordinates()[c].locked) {
            *turn = 0.0;
        }
    }
    let mut posture = start.clone();
    posture.displace(model, &step);
    posture
}

/// Every coordinate lies a third or two thirds of the way (by `k`) from its value in `start` to a random place of its range; from
/// farther, SLSQP reaches low minima more seldom. Coordinates without a finite range or muscle groups, such as those of the root, stay.
fn drawn(model: &Model, start: &Posture, k: usize) -> Posture {
    let way = (k / 2 % 2 + 1) as f64 / 3.0;
    let mut random = k as u64 + 1;
    let mut step = vec![0.0; model.rates().len()];
    for (rate, turn) in step.iter_mut().enumerate() {
        let place = 0.5 * (1.0 + next_number(&mut random));
        let Some(coordinate) = model.rates()[rate].coordinate else { continue };
        let (lower, upper) = model.coordinates()[coordinate].range;
        if (upper - lower).is_finite() && model.coordinates()[coordinate].groups.is_some() {
            *turn = way * (lower + place * (upper - lower) - start.values()[coordinate]);
        }
    }
    let mut posture = start.clone();
    posture.displace(model, &step);
    posture
}
