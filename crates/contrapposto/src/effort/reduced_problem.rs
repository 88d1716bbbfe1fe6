//! Which parts of a body can be brought to rest by themselves?
//!
//! What moves no support, of a standing body all above the pelvis, has torques of its own that do not depend on the forces
//! below: it can look for its valleys as a small problem, on a body of which all the rest is welded, while supports and their
//! forces stay. What hangs on that and is no goal's concern, the free arm and the head of somebody who reaches, rests by itself
//! as well: of two postures each such part is taken from the one where it works less.

use super::iterate::Iterate;
use super::problem::EffortProblem;
use super::weld::weld;
use crate::contact::ContactForces;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::tasks::PriorityLevel;
use crate::tasks::body::BodyError;
use crate::tasks::{Effort, Task};

/// What moves no support, and what is asked of it.
#[derive(Debug)]
pub(crate) struct ReducedProblem {
    /// The body with the rest of it welded.
    pub(crate) model: Model,
    rates: Vec<usize>,
    effort: PriorityLevel,
    still: PriorityLevel,
    above: Vec<PriorityLevel>,
    contact: ContactForces,
}

impl ReducedProblem {
    /// Of a body in `posture`: without supports everything that may move. `None` where nothing that has muscles moves without
    /// moving a support, or the root is free and nothing holds it.
    ///
    /// # Errors
    /// [`BodyError`] when the posture is none of the model's.
    pub(crate) fn of(ask: &EffortProblem<'_>, posture: &Posture) -> Result<Option<Self>, BodyError> {
        let model = ask.model;
        let mut holds = vec![false; model.rates().len()];
        for support in ask.contact.supports() {
            let mut carrier = model.segments()[support.segment].mobility;
            while let Some(mobility) = carrier {
                model.rates_of(mobility).for_each(|rate| holds[rate] = true);
                carrier = model.mobilities[mobility].parent;
            }
        }
        let rate = |c: &usize| model.coordinates()[*c].rate;
        // Who leads a joint that holds a support holds it, too.
        for coupling in model.couplings().iter().rev() {
            if let (Some(leader), Some(follower)) = (rate(&coupling.independent), rate(&coupling.dependent)) {
                holds[leader] |= holds[follower];
            }
        }
        let coordinates: Vec<usize> = ask.efforts().filter(|c| rate(c).is_some_and(|rate| !holds[rate])).collect();
        let free = || ask.free.iter().filter(|rate| !holds[**rate]);
        let falls = free().any(|rate| ask.contact.root().contains(rate));
        if falls || coordinates.is_empty() || free().next().is_none() {
            return Ok(None);
        }
        let mut moves = vec![false; model.rates().len()];
        free().copied().chain(coordinates.iter().filter_map(rate)).for_each(|rate| moves[rate] = true);
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture)?;
        let (welded, places) = weld(model, &kinematics, &moves);
        let mut above = ask.above.to_vec();
        for task in above.iter_mut().flat_map(|goal| &mut goal.tasks) {
            if let Task::Posture(task) = task {
                let mut place = places.iter();
                task.weights.retain(|_| place.next().is_some_and(Option::is_some));
            }
        }
        Ok(Some(Self {
            rates: free().filter_map(|rate| places[*rate]).collect(),
            contact: ContactForces::of_a_limb(&welded),
            model: welded,
            effort: Task::Effort(Effort { coordinates }).into(),
            still: PriorityLevel::default(),
            above,
        }))
    }

    /// What is asked of them by themselves.
    pub(crate) fn ask<'b>(&'b self, ask: &EffortProblem<'b>) -> EffortProblem<'b> {
        EffortProblem {
            model: &self.model,
            places: &self.still,
            above: &self.above,
            effort: &self.effort,
            free: &self.rates,
            contact: &self.contact,
            ..*ask
        }
    }
}

/// DecoupledSubtrees that rest by themselves.
#[derive(Clone, Debug)]
pub(crate) struct DecoupledSubtrees {
    /// The part of each segment and of each coordinate that counts as effort; 0 is all that goals concern.
    of_segments: Vec<usize>,
    of_efforts: Vec<usize>,
    count: usize,
}

impl DecoupledSubtrees {
    /// As the rows of what must hold say in `at`.
    pub(crate) fn of(ask: &EffortProblem<'_>, at: &Iterate) -> Self {
        let (model, n) = (ask.model, ask.unknowns());
        let concerns = |rate: usize| {
            let place = ask.free.iter().position(|free| *free == rate);
            place.is_none_or(|i| at.rows.chunks_exact(n).any(|row| row[i] != 0.0))
        };
        let mut carries: Vec<bool> = (0..model.mobilities.len()).map(|m| model.rates_of(m).any(concerns)).collect();
        for (m, mobility) in model.mobilities.iter().enumerate().rev() {
            if let (true, Some(parent)) = (carries[m], mobility.parent) {
                carries[parent] = true;
            }
        }
        let mut parts: Vec<usize> = vec![];
        let mut count = 1;
        for (mobility, carries) in model.mobilities.iter().zip(carries) {
            let part = match mobility.parent.map_or(0, |parent| parts[parent]) {
                0 if carries => 0,
                0 => {
                    count += 1;
                    count - 1
                }
                above => above,
            };
            parts.push(part);
        }
        let mut of_rates = vec![0; model.rates().len()];
        let mut tied = vec![false; count];
        for (m, part) in parts.iter().enumerate().rev() {
            model.rates_of(m).for_each(|rate| of_rates[rate] = *part);
        }
        // A follower of a leader in another part ties the two to the rest.
        for (m, part) in parts.iter().enumerate() {
            for rate in model.rates_of(m).filter(|rate| of_rates[*rate] != *part) {
                (tied[*part], tied[of_rates[rate]]) = (true, true);
            }
        }
        let of = |part: usize| if tied[part] { 0 } else { part };
        Self {
            of_segments: model.segments().iter().map(|s| s.mobility.map_or(0, |m| of(parts[m]))).collect(),
            of_efforts: ask
                .efforts()
                .map(|c| model.coordinates()[c].rate.map_or(0, |rate| of(of_rates[rate])))
                .collect(),
            count,
        }
    }

    /// Half the sum of squares of the errors of each part.
    pub(crate) fn efforts(&self, errors: &[f64]) -> Vec<f64> {
        let mut efforts = vec![0.0; self.count];
        self.of_efforts.iter().zip(errors).for_each(|(part, error)| efforts[*part] += 0.5 * error * error);
        efforts
    }

    /// Gives `posture` those parts of `other` that work less there.
    pub(crate) fn mix(
        &self,
        ask: &EffortProblem<'_>,
        posture: &mut Posture,
        efforts: &[f64],
        other: &Posture,
        others: &[f64],
    ) {
        for (segment, &part) in ask.model.segments().iter().zip(&self.of_segments) {
            if others[part] < efforts[part] {
                let place = segment.coordinates.clone();
                posture.values_mut()[place.clone()].copy_from_slice(&other.values()[place]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::standing_adult::StandingAdult;
    use super::*;

    const SEED: u64 = 37;

    fn seen(ask: &EffortProblem<'_>, posture: &Posture) -> Iterate {
        let mut site = Iterate::new(ask.model);
        site.posture = posture.clone();
        site.see(ask).unwrap();
        site
    }

    /// What limbs ask by themselves is what they ask on the whole body, whatever the forces below.
    #[test]
    fn limbs_work_as_they_do_on_the_body() {
        let ground = StandingAdult::new();
        let mut worst = 0f64;
        ground.each(&mut Pcg64Mcg::new(SEED.into()), 20, |_, ask, whole| {
            let limbs = ReducedProblem::of(ask, &whole.posture).unwrap().unwrap();
            assert!((11..ask.free.len()).contains(&limbs.rates.len()));
            let part = limbs.ask(ask);
            let site = seen(&part, &whole.posture);
            assert!(!site.errors.is_empty() && site.rows.len() == 3 * part.unknowns());
            let of_limb = |c: usize| part.efforts().position(|own| own == c);
            for (c, (error, row)) in
                ask.efforts().zip(whole.errors.iter().zip(whole.slopes.chunks_exact(ask.unknowns())))
            {
                let forces = &row[ask.free.len()..];
                let Some(own) = of_limb(c) else { continue };
                assert!(forces.iter().all(|entry| *entry == 0.0), "{}", ask.model.coordinates()[c].name);
                assert!(error.is_finite() && site.errors[own].is_finite());
                worst = worst.max((site.errors[own] - error).abs() / (1.0 + error.abs()));
            }
        });
        println!("seed {SEED}: off by {worst:.1e} at most");
        assert!(worst < 1e-12, "{worst}");
    }

    /// A part that moves changes its own effort and that of what carries it, no other part's; the mixture of two postures takes
    /// it from the one where it works less.
    #[test]
    fn parts_are_taken_from_where_they_work_less() {
        let ground = StandingAdult::new();
        let mut taken = [0, 0];
        ground.each(&mut Pcg64Mcg::new(SEED.into()), 20, |random, ask, whole| {
            let limbs = ReducedProblem::of(ask, &whole.posture).unwrap().unwrap();
            let part = limbs.ask(ask);
            let site = seen(&part, &whole.posture);
            let parts = DecoupledSubtrees::of(&part, &site);
            let of = |segment: &str| parts.of_segments[ask.model.segment(segment).unwrap()];
            assert_eq!((of("torso"), of("hand_r")), (0, 0));
            assert!(of("hand_l") != of("head") && of("hand_l") * of("head") > 0, "the free arm and the head");
            let efforts = parts.efforts(&site.errors);
            assert!((efforts.iter().sum::<f64>() - site.effort).abs() < 1e-12 * site.effort);
            for own in 1..parts.count {
                let mut other = whole.posture.clone();
                for (segment, _) in ask.model.segments().iter().zip(&parts.of_segments).filter(|(_, p)| **p == own) {
                    for value in &mut other.values_mut()[segment.coordinates.clone()] {
                        *value += random.random_range(-0.1..0.1);
                    }
                }
                let found = parts.efforts(&seen(&part, &other).errors);
                for (p, (a, b)) in efforts.iter().zip(&found).enumerate() {
                    assert!(p == own || p == 0 || (a - b).abs() <= 1e-12 * a, "part {p} of {own}: {a} {b}");
                }
                let less = found[own] < efforts[own];
                taken[usize::from(less)] += 1;
                let mut alone = vec![0.0; parts.count];
                alone.clone_from_slice(&efforts);
                alone[own] = found[own];
                let mut mixed = whole.posture.clone();
                parts.mix(&part, &mut mixed, &efforts, &other, &alone);
                assert_eq!(&mixed, if less { &other } else { &whole.posture });
            }
        });
        println!("seed {SEED}: parts left as they were and taken: {taken:?}");
        assert!(taken[0] > 5 && taken[1] > 5, "{taken:?}");
    }
}
