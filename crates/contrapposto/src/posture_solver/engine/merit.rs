//! Did a step make things better, and how does effort bend where it begins?
//!
//! Merit is `|e|^2/2 + price sum |errors of the levels above|`, the price above every multiplier.

use super::{BEFORE, Engine};
use crate::effort::problem::EffortProblem;

impl Engine<'_> {
    /// Merit of the present posture (0) or of the one before the last step (1).
    pub(super) fn merit(&self, when: usize) -> f64 {
        let last = self.effort_goal.map_or(0, |goal| BEFORE + goal);
        let errors = &self.errors[when];
        if errors.is_empty() || !errors[0].is_finite() {
            return f64::INFINITY;
        }
        self.effort[when] + self.price * errors[..last].iter().sum::<f64>()
    }

    /// Did the last step make things worse?
    pub(super) fn went_wrong(&mut self) -> bool {
        if self.effort_goal.is_none() || !self.merit(1).is_finite() {
            return false;
        }
        let wrong = self.merit(0) > self.merit(1) * (1.0 + 1e-12) && self.largest > 1e-10;
        let shift = self.curvature.shift();
        *shift = if wrong { (4.0 * *shift).max(1e-3) } else { 0.25 * *shift };
        if *shift < 1e-6 {
            *shift = 0.0;
        }
        self.reach = if wrong { 0.3 * self.largest } else { (2.0 * self.reach).min(self.options.max_step) };
        if wrong && self.options.reject_steps {
            // What was before is now again.
            self.errors.swap(0, 1);
            self.effort[0] = self.effort[1];
        }
        wrong && self.options.reject_steps
    }

    /// Gives the effort level its second derivative.
    pub(super) fn bend(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let ask = EffortProblem {
            model: self.model,
            places: &self.places,
            above: &self.goals[..goal],
            effort: &self.goals[goal],
            loads: &self.loads,
            free: &self.rates,
            contact: &self.contact,
        };
        let last = self.solver.multipliers(BEFORE + goal);
        self.curvature.bend(&ask, &self.body, self.body.loads(), &mut self.problem, last);
    }

    pub(super) fn raise_price(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let rows = self.solver.multipliers(BEFORE + goal).rows;
        let most = rows.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        self.price = (0.7 * self.price).max(1.5 * most);
    }
}
