//! Finds the subtrees of a body whose effort no constraint ties to the rest.
//!
//! A subtree of joints that no constraint row moves, such as the free arm and the head of a body that reaches with the other arm,
//! has torques of its own. Of two postures each such subtree can be taken from the one in which its effort is less. The rest
//! carries the subtrees, and so feels the exchange: the mixture is a start for a descent, no more.

use super::iterate::Iterate;
use super::problem::EffortProblem;
use crate::posture::Posture;

/// Subtrees that no constraint row moves, and the rest.
#[derive(Clone, Debug)]
pub(crate) struct DecoupledSubtrees {
    /// The subtree of each segment and of each effort coordinate; 0 is the rest of the body.
    of_segments: Vec<usize>,
    of_efforts: Vec<usize>,
    count: usize,
}

impl DecoupledSubtrees {
    /// The subtrees at `iterate`: branches of which every rate is free and has a zero column in the constraint rows.
    pub(crate) fn of(problem: &EffortProblem<'_>, iterate: &Iterate) -> Self {
        let model = problem.model;
        let (subtrees, count) = subtrees_of_mobilities(problem, iterate);
        let mut of_rates = vec![0; model.rates().len()];
        let mut tied = vec![false; count];
        for (m, subtree) in subtrees.iter().enumerate().rev() {
            model.rates_of(m).for_each(|rate| of_rates[rate] = *subtree);
        }
        // One rate that drives motions in two subtrees ties both to the rest. Couplings are not looked at: dependent rates are
        // not free, so their motions are in the rest already, but their independent ones may still be in a subtree.
        for (m, subtree) in subtrees.iter().enumerate() {
            for rate in model.rates_of(m).filter(|rate| of_rates[*rate] != *subtree) {
                (tied[*subtree], tied[of_rates[rate]]) = (true, true);
            }
        }
        let of = |subtree: usize| if tied[subtree] { 0 } else { subtree };
        let of_coordinate = |c: usize| model.coordinates()[c].rate.map_or(0, |rate| of(of_rates[rate]));
        Self {
            of_segments: model.segments().iter().map(|s| s.mobility.map_or(0, |m| of(subtrees[m]))).collect(),
            of_efforts: problem.effort_coordinates().map(of_coordinate).collect(),
            count,
        }
    }

    /// The objective's part of each subtree: half the sum of squares of its residuals.
    pub(crate) fn objectives(&self, residual: &[f64]) -> Vec<f64> {
        let mut objectives = vec![0.0; self.count];
        self.of_efforts.iter().zip(residual).for_each(|(subtree, r)| objectives[*subtree] += 0.5 * r * r);
        objectives
    }

    /// Copies from `other` to `posture` the subtrees whose objective is lower there: `others` against `objectives`.
    pub(crate) fn mix(
        &self,
        problem: &EffortProblem<'_>,
        posture: &mut Posture,
        objectives: &[f64],
        other: &Posture,
        others: &[f64],
    ) {
        for (segment, &subtree) in problem.model.segments().iter().zip(&self.of_segments) {
            if others[subtree] < objectives[subtree] {
                let place = segment.coordinates.clone();
                posture.values_mut()[place.clone()].copy_from_slice(&other.values()[place]);
            }
        }
    }
}

/// The subtree of every mobility, and the number of subtrees, the rest included.
fn subtrees_of_mobilities(problem: &EffortProblem<'_>, iterate: &Iterate) -> (Vec<usize>, usize) {
    let (model, n) = (problem.model, problem.unknowns());
    let constrained = |rate: usize| {
        let place = problem.free.iter().position(|free| *free == rate);
        place.is_none_or(|i| iterate.constraints.chunks_exact(n).any(|row| row[i] != 0.0))
    };
    let mut carries: Vec<bool> = (0..model.mobilities.len()).map(|m| model.rates_of(m).any(constrained)).collect();
    for (m, mobility) in model.mobilities.iter().enumerate().rev() {
        if let (true, Some(parent)) = (carries[m], mobility.parent) {
            carries[parent] = true;
        }
    }
    let mut subtrees: Vec<usize> = vec![];
    let mut count = 1;
    for (mobility, carries) in model.mobilities.iter().zip(carries) {
        let subtree = match mobility.parent.map_or(0, |parent| subtrees[parent]) {
            0 if carries => 0,
            0 => {
                count += 1;
                count - 1
            }
            inherited => inherited,
        };
        subtrees.push(subtree);
    }
    (subtrees, count)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::reduced_problem::ReducedProblem;
    use super::super::standing_adult::{StandingAdult, evaluated};
    use super::*;

    const SEED: u64 = 37;

    /// Moving one subtree changes its own objective and that of the rest, which carries it, and no other subtree's; mixing two
    /// postures takes the subtree from the posture in which its objective is lower.
    #[test]
    fn of_two_random_postures_each_subtree_is_taken_from_the_one_of_lower_objective() {
        let adult = StandingAdult::new();
        let mut taken = [0, 0];
        adult.each_posture(&mut Pcg64Mcg::new(SEED.into()), 20, |random, problem, whole| {
            let reduced = ReducedProblem::of(problem, &whole.posture).unwrap().unwrap();
            let upper = reduced.problem(problem);
            let iterate = evaluated(&upper, &whole.posture);
            let subtrees = DecoupledSubtrees::of(&upper, &iterate);
            let of = |segment: &str| subtrees.of_segments[problem.model.segment(segment).unwrap()];
            assert_eq!((of("torso"), of("hand_r")), (0, 0));
            assert!(of("hand_l") != of("head") && of("hand_l") * of("head") > 0, "the free arm and the head");
            let objectives = subtrees.objectives(&iterate.residual);
            assert!((objectives.iter().sum::<f64>() - iterate.objective).abs() < 1e-12 * iterate.objective);
            for own in 1..subtrees.count {
                let mut other = whole.posture.clone();
                for (segment, _) in
                    problem.model.segments().iter().zip(&subtrees.of_segments).filter(|(_, p)| **p == own)
                {
                    for value in &mut other.values_mut()[segment.coordinates.clone()] {
                        *value += random.random_range(-0.1..0.1);
                    }
                }
                let found = subtrees.objectives(&evaluated(&upper, &other).residual);
                for (p, (a, b)) in objectives.iter().zip(&found).enumerate() {
                    assert!(p == own || p == 0 || (a - b).abs() <= 1e-12 * a, "subtree {p} of {own}: {a} {b}");
                }
                let less = found[own] < objectives[own];
                taken[usize::from(less)] += 1;
                let mut alone = vec![0.0; subtrees.count];
                alone.clone_from_slice(&objectives);
                alone[own] = found[own];
                let mut mixed = whole.posture.clone();
                subtrees.mix(&upper, &mut mixed, &objectives, &other, &alone);
                assert_eq!(&mixed, if less { &other } else { &whole.posture });
            }
        });
        println!("seed {SEED}: subtrees left and taken: {taken:?}");
        assert!(taken[0] > 5 && taken[1] > 5, "{taken:?}");
    }
}
