//! Did a step make things better, and how does effort bend where it begins?
//!
//! Merit is `|e|^2/2 + price sum |errors of the levels above|`, the price above every multiplier.

use super::{BEFORE, Engine};
use crate::ik::task::{Task, share_of_strength};

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
        if wrong && self.options.guarded {
            // What was before is now again.
            self.errors.swap(0, 1);
            self.effort[0] = self.effort[1];
        }
        wrong && self.options.guarded
    }

    /// Gives the effort level its second derivative.
    pub(super) fn bend(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let k = BEFORE + goal;
        let mut start = 0;
        self.starts.clear();
        for level in &self.problem.levels[..=k] {
            self.starts.push(start);
            start += level.rows();
        }
        if self.multipliers.len() != self.starts[k] {
            self.multipliers.clear();
            self.multipliers.resize(self.starts[k], 0.0);
        }
        let weights = self.curvature.weights();
        weights.fill(0.0);
        let root = self.contact.root();
        for (rate, y) in root.iter().zip(&self.multipliers[self.starts[1] - root.len()..]) {
            weights[*rate] = y / self.contact.weight();
        }
        for task in &self.goals[goal].tasks {
            let Task::Effort(effort) = task else { continue };
            for &coordinate in &effort.coordinates {
                let Some(rate) = self.model.coordinates()[coordinate].rate else { continue };
                let active = -(self.body.external_torque().torques()[rate] + self.passive.torques()[rate]);
                let share = share_of_strength(self.model, &self.body, coordinate);
                weights[rate] = -active * share * share;
            }
        }
        let (multipliers, starts) = (&self.multipliers, &self.starts);
        let places = std::iter::once((&self.places, &multipliers[starts[1]..starts[2]]));
        let goals = self.goals[..goal].iter().enumerate();
        let goals = goals.map(|(i, goal)| (goal, &multipliers[starts[BEFORE + i]..starts[BEFORE + i + 1]]));
        let goals = places.chain(goals);
        self.curvature.bend(self.model, &self.body, &self.all_loads, goals, &mut self.problem, k);
    }

    pub(super) fn raise_price(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        let rows = self.solver.multipliers(BEFORE + goal).rows;
        self.multipliers.clear();
        self.multipliers.extend_from_slice(rows);
        let most = rows.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        self.price = (0.7 * self.price).max(1.5 * most);
    }
}
