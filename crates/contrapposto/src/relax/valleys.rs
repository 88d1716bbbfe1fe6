//! Which valley of effort lies lowest, of those near the start?
//!
//! Effort has many: arms, neck and spine each rest on their tissue in more than one way. From the bottom of the nearest one
//! the body is moved aside, as far as supports and goals let it to first order, and goes down again; what lies lower is kept
//! (Wales & Doye 1997, "Global optimization by basin-hopping"). The directions come from a fixed sequence of numbers: the same
//! problem has the same answer. A descent ends as soon as it is out of sight of the lowest bottom.

use super::descent::{Bottom, Descent, Manner};
use super::site::Ask;
use crate::ik::body::BodyError;
use crate::model::Model;
use crate::posture::Posture;

/// The way to the nearest valley.
const NEAR: Manner = Manner { pace: 0.15, plain: 0, reach: 0.3, steps: 100, gain: 1e-4, below: f64::INFINITY };
/// The way down from aside, where goals are still near.
const ASIDE: Manner = Manner { pace: 0.4, plain: 5, reach: 0.3, steps: 20, gain: 1e-3, below: f64::INFINITY };
/// The way to the very bottom.
const LAST: Manner = Manner { pace: 0.4, plain: 0, reach: 0.3, steps: 100, gain: 1e-13, below: f64::INFINITY };
/// How far aside, as a share of the range of each coordinate.
const FAR: f64 = 0.7;
/// Share of the coordinates that go aside, neighbours in the model's order: a limb or two.
const PART: f64 = 0.5;
/// Largest range that counts, rad or m.
const WIDE: f64 = 2.0;
/// A bottom counts when it is lower by this share.
const LOWER: f64 = 1e-3;
/// What must hold may be missed by so much on the way, and at the end.
const ROUGH: f64 = 1e-3;
const EXACT: f64 = 1e-9;

/// A descent, and the lowest place so far. Keeps its space.
#[derive(Clone, Debug)]
pub(super) struct Valleys {
    descent: Descent,
    posture: Posture,
    forces: Vec<f64>,
    multipliers: Vec<f64>,
    aside: Posture,
    aside_forces: Vec<f64>,
    wish: Vec<f64>,
}

impl Valleys {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            descent: Descent::new(model),
            posture: model.default_posture(),
            forces: vec![],
            multipliers: vec![],
            aside: model.default_posture(),
            aside_forces: vec![],
            wish: vec![],
        }
    }

    /// Looks into so many valleys, at least one, and moves `posture` to the lowest bottom; `None` leaves it where it is: what
    /// must hold cannot be reached from there.
    pub(super) fn find(
        &mut self,
        ask: &Ask<'_>,
        posture: &mut Posture,
        count: usize,
    ) -> Result<Option<Bottom>, BodyError> {
        self.forces.clear();
        self.forces.extend_from_slice(ask.contact.forces());
        self.posture.values_mut().copy_from_slice(posture.values());
        self.multipliers.clear();
        let mut best = self.descent.go(ask, &self.posture, &self.forces, &self.multipliers, &NEAR)?;
        let mut steps = best.steps;
        if best.violation > ROUGH {
            // Another way down.
            best = self.descent.go(ask, &self.posture, &self.forces, &[], &Manner { steps: 100, ..ASIDE })?;
            steps += best.steps;
        }
        if best.violation > ROUGH {
            return Ok(None);
        }
        self.keep();
        let mut random = 0;
        for _ in 1..count {
            self.wish(ask, &mut random);
            if self.descent.aside(ask, &self.posture, &self.forces, &self.wish).is_err() {
                continue;
            }
            self.aside.values_mut().copy_from_slice(self.descent.at.posture.values());
            self.aside_forces.clone_from(&self.descent.at.forces);
            let lower = best.effort * (1.0 - LOWER);
            let manner = Manner { below: lower, ..ASIDE };
            let Ok(bottom) = self.descent.go(ask, &self.aside, &self.aside_forces, &[], &manner) else { continue };
            steps += bottom.steps;
            if bottom.violation <= ROUGH && bottom.effort < lower {
                best = bottom;
                self.keep();
            }
        }
        let last = self.descent.go(ask, &self.posture, &self.forces, &self.multipliers, &LAST)?;
        if last.violation > ROUGH {
            return Ok(None);
        }
        posture.values_mut().copy_from_slice(self.descent.at.posture.values());
        Ok(Some(Bottom { steps: steps + last.steps, settled: last.settled && last.violation <= EXACT, ..last }))
    }

    /// Where the descent is now is the lowest place so far.
    fn keep(&mut self) {
        self.posture.values_mut().copy_from_slice(self.descent.at.posture.values());
        self.forces.clone_from(&self.descent.at.forces);
        self.multipliers.clone_from(&self.descent.multipliers);
    }

    /// A direction for every unknown: numbers from -1 to 1, times how far each coordinate of a part of the body may go.
    fn wish(&mut self, ask: &Ask<'_>, random: &mut u64) {
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
