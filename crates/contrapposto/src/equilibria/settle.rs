//! Settles in postures near a minimum, until there are enough ways to stand for an answer.

use super::candidate::{Candidate, Worth, keep_worth};
use super::different_ways::{DifferentWays, MOST_POSTURES};
use super::finder::{Finder, posture_and_labels};
use super::mirror::Mirror;
use super::search::Stage;

/// Postures that are settled at once; only then is it seen whether more are wanted. Assumed.
const SETTLED_AT_ONCE: usize = 4;

impl Finder<'_> {
    /// Settles in further postures near a minimum, that of least effort first and a few at a time, until as many ways to stand as an answer has
    /// take no more effort than the next one.
    pub(super) fn settle(&mut self, mut others: Vec<Candidate>) {
        while let Some(next) = others.first() {
            if self.ways_up_to(next.relaxed.effort) >= MOST_POSTURES {
                break;
            }
            let later = others.split_off(SETTLED_AT_ONCE.min(others.len()));
            self.solve_straight(Stage::Settled, others.into_iter().map(posture_and_labels).collect());
            others = later;
        }
    }

    /// Number of ways to stand that take no more effort, five at most. Mirror images count once even where both are answers, so that every aim
    /// finds the same postures.
    fn ways_up_to(&self, effort: f64) -> usize {
        let mut ways = DifferentWays::new(self.search, Mirror::of(self.search.model));
        let of_less = self.worth_an_answer().into_iter().filter(|&i| self.found[i].relaxed.effort <= effort);
        of_less.for_each(|i| _ = ways.take(&self.found[i]));
        ways.answers.len()
    }

    /// Converged postures that are worth an answer, that of least effort first, with as few limbs held up as in any other.
    pub(super) fn worth_an_answer(&self) -> Vec<usize> {
        let mut selected = self.selected(Stage::Converged);
        if selected.is_empty() {
            // All slip or have not converged: the one that slips least, whose figures say so.
            let slip = |i: &usize| self.found[*i].relaxed.slip.length();
            selected.extend((0..self.found.len()).min_by(|a, b| slip(a).total_cmp(&slip(b))));
        }
        selected.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        let least = selected.first().map_or(0, |&i| self.found[i].raised_limbs);
        selected.retain(|&i| self.found[i].raised_limbs == least);
        keep_worth(&self.found, &mut selected, Worth::ANSWER);
        selected
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::super::search::Aim;
    use super::*;
    use crate::equilibria::{SCATTERED_STARTS, Search};
    use crate::model::{Adult, adult};
    use crate::posture_solver::Options;

    #[test]
    fn ways_to_stand_of_no_more_effort_are_counted_once() {
        let model = adult(&Adult::default()).unwrap();
        let start = model.default_posture();
        let search = Search {
            model: &model,
            start: &start,
            supports: &[],
            limits: &[],
            goals: &[],
            loads: &[],
            locked: &[],
            scattered: SCATTERED_STARTS,
            most_work: usize::MAX,
            aim: Aim::Ways,
            threads: 1,
        };
        let mut watch = |_| ();
        let mut finder = Finder::new(&search, Options::least_effort(), &mut watch).unwrap();
        let arms =
            [(0.0, 0.01), (1.0, 0.011), (30.0, 0.012), (60.0, 0.013), (90.0, 0.014), (120.0, 0.015), (150.0, 0.016)];
        finder.found = arms.map(|(degrees, effort)| Candidate::with_arm(&model, degrees, (effort, 0.5))).to_vec();
        let counted = [0.009, 0.011, 0.012, 0.0145, 0.015, 1.0].map(|effort| finder.ways_up_to(effort));
        assert_eq!(counted, [0, 1, 2, 4, 5, 5]);
        // Beyond its strength a posture is no answer.
        finder.found[2] = Candidate::with_arm(&model, 30.0, (0.012, 1.1));
        assert_eq!(finder.ways_up_to(0.015), 4);
    }
}
