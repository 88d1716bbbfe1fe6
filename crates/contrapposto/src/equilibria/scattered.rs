//! Makes starts of a search that are scattered over the ranges of the joints.
//!
//! Goal angles, other places and basin hopping search from the postures that are known. A local minimum in which the weight is on the
//! other foot, or a hip hangs on the ligaments of its other side, is reached from none of them.

use super::mirror::Mirror;
use crate::math::next_number;
use crate::model::{Coordinate, CoordinateKind, Model};
use crate::posture::Posture;
use crate::tasks::Height;

/// Usual number of scattered starts: with so many, six of six scenarios reach the least effort that 50 runs of SLSQP reach (docs/benchmarks.md).
pub const SCATTERED_STARTS: usize = 32;

/// Most that a rotation without muscle groups, such as those of the root, is turned, rad. Assumed.
const ROOT_TURN: f64 = 0.5;
/// Most that a translation without muscle groups is moved, m. Assumed.
const ROOT_SLIDE: f64 = 0.3;

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

/// Every coordinate lies a third, two thirds or the whole way (by `k`) from its value in `start` to a random place: of its range, or, where it has
/// no muscle groups, of the surroundings of that value. So do the starts of `scripts/effort_by_slsqp.py`. Coordinates without a finite range stay;
/// shoulders rise with their arms.
fn drawn(model: &Model, start: &Posture, k: usize) -> Posture {
    let way = (k / 2 % 3 + 1) as f64 / 3.0;
    let mut random = k as u64 + 1;
    let mut step = vec![0.0; model.rates().len()];
    let shoulders = Height::shoulder_rhythm(model);
    for (rate, turn) in step.iter_mut().enumerate() {
        if shoulders.iter().any(|(rise, _)| model.rates()[rate].coordinate == Some(*rise)) {
            continue;
        }
        let place = 0.5 * (1.0 + next_number(&mut random));
        let Some(coordinate) = model.rates()[rate].coordinate else { continue };
        let Coordinate { range: (lower, upper), groups, kind, .. } = &model.coordinates()[coordinate];
        if (upper - lower).is_finite() {
            let whole = match (groups, kind) {
                (Some(_), _) => lower + place * (upper - lower) - start.values()[coordinate],
                (None, CoordinateKind::Translation) => (2.0 * place - 1.0) * ROOT_SLIDE,
                (None, _) => (2.0 * place - 1.0) * ROOT_TURN,
            };
            *turn = way * whole;
        }
    }
    let mut posture = start.clone();
    posture.displace(model, &step);
    Height::raise_shoulders(model, [&mut posture]);
    posture
}
