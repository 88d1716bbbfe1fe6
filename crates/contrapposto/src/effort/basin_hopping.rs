//! Which valley of effort lies lowest, of those near the start?
//!
//! Effort has many: arms, neck and spine each rest on their tissue in more than one way. From the bottom of the nearest one
//! the limbs are moved aside, as far as goals let them to first order, and go down again; what lies lower is kept (Wales & Doye
//! 1997, "Global optimization by basin-hopping"), part by part where parts rest by themselves ([`super::reduced_problem`]). The directions
//! come from a fixed sequence of numbers: the same problem has the same answer.

use super::problem::EffortProblem;
use super::reduced_problem::{DecoupledSubtrees, ReducedProblem};
use super::sqp::{LocalMinimum, Sqp, SqpOptions};
use crate::model::Model;
use crate::posture::Posture;
use crate::tasks::body::BodyError;

/// The way to the nearest valley.
const NEAR: SqpOptions = SqpOptions { pace: 0.15, plain: 0, reach: 0.3, longer: true, steps: 100, gain: 1e-3 };
/// The way down from aside, where goals are still near; whoever must go far there does not end low.
const ASIDE: SqpOptions = SqpOptions { pace: 0.4, plain: 5, reach: 0.6, longer: false, steps: 20, gain: 0.05 };
/// Another way to a valley whose goals are far.
const AGAIN: SqpOptions = SqpOptions { reach: 0.3, longer: true, steps: 100, gain: 1e-3, ..ASIDE };
/// The way down from a posture put together from parts.
const MIXED: SqpOptions = SqpOptions { plain: 0, reach: 0.3, ..ASIDE };
/// The way to the bottom of a posture that hardly moves any more: a step that gains a millionth is not worth a move.
const SINK: SqpOptions = SqpOptions { pace: 0.4, plain: 0, reach: 0.1, longer: true, steps: 40, gain: 1e-6 };
/// The way to the very bottom.
const LAST: SqpOptions = SqpOptions { pace: 0.4, plain: 0, reach: 0.3, longer: true, steps: 100, gain: 1e-13 };
/// How far aside, as a share of the range of each coordinate.
const FAR: f64 = 0.7;
/// Share of the coordinates that go aside, neighbours in the model's order.
const PART: f64 = 0.7;
/// Largest range that counts, rad or m.
const WIDE: f64 = 2.0;
/// A bottom counts when it is lower by this share.
const LOWER: f64 = 1e-3;
/// What must hold may be missed by so much on the way, and at the end.
const ROUGH: f64 = 1e-3;
const EXACT: f64 = 1e-9;

/// A descent, and the lowest place so far. Keeps its space, but for what welded bodies need.
#[derive(Clone, Debug)]
pub(crate) struct BasinHopping {
    descent: Sqp,
    lowest: Candidate,
    /// The bottom of the nearest valley.
    near: Posture,
    look: Perturbations,
}

/// A posture with its forces, and the multipliers of what must hold there.
#[derive(Clone, Debug)]
struct Candidate {
    posture: Posture,
    forces: Vec<f64>,
    multipliers: Vec<f64>,
}

/// Looks for other valleys.
#[derive(Clone, Debug)]
struct Perturbations {
    aside: Candidate,
    wish: Vec<f64>,
}

impl BasinHopping {
    pub(crate) fn new(model: &Model) -> Self {
        let place = Candidate { posture: model.default_posture(), forces: vec![], multipliers: vec![] };
        Self {
            descent: Sqp::new(model),
            lowest: place.clone(),
            near: model.default_posture(),
            look: Perturbations { aside: place, wish: vec![] },
        }
    }

    /// Looks into so many valleys, at least one, and moves `posture` to the lowest bottom; `None` leaves it where it is: what
    /// must hold cannot be reached from there.
    pub(crate) fn find(
        &mut self,
        ask: &EffortProblem<'_>,
        posture: &mut Posture,
        count: usize,
    ) -> Result<Option<LocalMinimum>, BodyError> {
        let mut limbs = ReducedProblem::of(ask, posture)?;
        if ask.contact.supports().is_empty() {
            let welded = limbs.take().filter(|limbs| limbs.model.rates().len() < ask.model.rates().len());
            if let Some(limbs) = welded {
                return Self::new(&limbs.model).find(&limbs.ask(ask), posture, count);
            }
        }
        let (descent, lowest) = (&mut self.descent, &mut self.lowest);
        lowest.forces.clear();
        lowest.forces.extend_from_slice(ask.contact.forces());
        lowest.posture.values_mut().copy_from_slice(posture.values());
        let mut steps = 0;
        if let Some(limbs) = &limbs {
            // First what limbs can do by themselves: the rest of the body has less to do then.
            let mut descent = Sqp::new(&limbs.model);
            let bottom = descent.go(&limbs.ask(ask), posture, &[], &[], &NEAR)?;
            steps += bottom.steps;
            if bottom.violation <= ROUGH {
                lowest.keep_posture(&descent);
            }
        }
        let mut near = descent.go(ask, &lowest.posture, &lowest.forces, &[], &NEAR)?;
        steps += near.steps;
        if near.violation > ROUGH {
            near = descent.go(ask, &lowest.posture, &lowest.forces, &[], &AGAIN)?;
            steps += near.steps;
        }
        if near.violation > ROUGH {
            return Ok(None);
        }
        lowest.keep(descent);
        self.near.values_mut().copy_from_slice(lowest.posture.values());
        if limbs.is_some() {
            limbs = ReducedProblem::of(ask, &lowest.posture)?; // the rest may have moved
        }
        if let Some(limbs) = &limbs {
            let mut alone = Candidate { forces: vec![], ..lowest.clone() };
            steps += self.look.search(&limbs.ask(ask), &mut Sqp::new(&limbs.model), &mut alone, count)?;
            lowest.posture = alone.posture;
        } else {
            steps += self.look.search(ask, descent, lowest, count)?;
        }
        let mut last = descent.go(ask, &lowest.posture, &lowest.forces, &lowest.multipliers, &LAST)?;
        steps += last.steps;
        let moved = lowest.posture != self.near;
        if limbs.is_some() && moved && (last.violation > ROUGH || last.effort > near.effort) {
            // What the limbs gained cost the rest more.
            last = descent.go(ask, &self.near, &lowest.forces, &lowest.multipliers, &LAST)?;
            steps += last.steps;
        }
        if last.violation > ROUGH {
            return Ok(None);
        }
        posture.values_mut().copy_from_slice(descent.at.posture.values());
        Ok(Some(LocalMinimum { steps, settled: last.settled && last.violation <= EXACT, ..last }))
    }

    /// Moves `posture` to the bottom of its own valley, and says whether it did: not if that lies farther away than `most` in any
    /// coordinate, or something that must hold does not.
    pub(crate) fn sink(
        &mut self,
        ask: &EffortProblem<'_>,
        posture: &mut Posture,
        most: f64,
    ) -> Result<bool, BodyError> {
        let forces = &mut self.lowest.forces;
        forces.clear();
        forces.extend_from_slice(ask.contact.forces());
        let bottom = self.descent.go(ask, posture, forces, &[], &SINK)?;
        let end = &self.descent.at.posture;
        let near = end.values().iter().zip(posture.values()).all(|(a, b)| (a - b).abs() <= most);
        let there = bottom.settled && bottom.violation <= EXACT && near;
        if there {
            posture.values_mut().copy_from_slice(end.values());
        }
        Ok(there)
    }
}

impl Candidate {
    /// It is where the descent is now.
    fn keep(&mut self, descent: &Sqp) {
        self.keep_posture(descent);
        self.forces.clone_from(&descent.at.forces);
        self.multipliers.clone_from(&descent.multipliers);
    }

    fn keep_posture(&mut self, descent: &Sqp) {
        self.posture.values_mut().copy_from_slice(descent.at.posture.values());
    }
}

impl Perturbations {
    /// Moves `lowest` to the lowest of so many valleys and returns the number of steps that took.
    fn search(
        &mut self,
        ask: &EffortProblem<'_>,
        descent: &mut Sqp,
        lowest: &mut Candidate,
        count: usize,
    ) -> Result<usize, BodyError> {
        descent.begin(ask, &lowest.posture, &lowest.forces)?;
        let parts = DecoupledSubtrees::of(ask, &descent.at);
        let mut efforts = parts.efforts(&descent.at.errors);
        let (mut best, mut steps, mut random) = (descent.at.effort, 0, 0);
        for _ in 1..count {
            self.wish(ask, &mut random);
            if descent.aside(ask, &lowest.posture, &lowest.forces, &self.wish).is_err() {
                continue;
            }
            self.aside.keep(descent);
            let Ok(bottom) = descent.go(ask, &self.aside.posture, &self.aside.forces, &[], &ASIDE) else { continue };
            steps += bottom.steps;
            if bottom.violation > ROUGH {
                continue;
            }
            let found = parts.efforts(&descent.at.errors);
            let mixed: f64 = efforts.iter().zip(&found).map(|(a, b)| a.min(*b)).sum();
            self.aside.posture.values_mut().copy_from_slice(lowest.posture.values());
            parts.mix(ask, &mut self.aside.posture, &efforts, &descent.at.posture, &found);
            self.aside.forces.clone_from(&descent.at.forces);
            if bottom.effort < best * (1.0 - LOWER) {
                (best, efforts) = (bottom.effort, found);
                lowest.keep(descent);
            }
            if mixed < best * (1.0 - LOWER) {
                let Ok(bottom) = descent.go(ask, &self.aside.posture, &self.aside.forces, &[], &MIXED) else {
                    continue;
                };
                steps += bottom.steps;
                if bottom.violation <= ROUGH && bottom.effort < best * (1.0 - LOWER) {
                    (best, efforts) = (bottom.effort, parts.efforts(&descent.at.errors));
                    lowest.keep(descent);
                }
            }
        }
        Ok(steps)
    }

    /// A direction for every unknown: numbers from -1 to 1, times how far each coordinate of a part of the body may go.
    fn wish(&mut self, ask: &EffortProblem<'_>, random: &mut u64) {
        self.wish.clear();
        let count = ask.free.len() as f64;
        let start = 0.5 * (1.0 + number(random));
        self.wish.extend(ask.free.iter().enumerate().map(|(i, &rate)| {
            let by = number(random);
            let inside = (i as f64 / count - start).rem_euclid(1.0) < PART;
            let range = ask.model.rates()[rate].coordinate.map(|c| ask.model.coordinates()[c].range);
            let wide = range.map_or(0.0, |(lower, upper)| upper - lower);
            if inside && wide.is_finite() { FAR * wide.min(WIDE) * by } else { 0.0 }
        }));
        self.wish.resize(ask.unknowns(), 0.0);
    }
}

/// The next number from -1 to 1 (Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators").
fn number(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
