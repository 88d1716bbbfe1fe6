//! Decides whether a support is put elsewhere, put down or taken off to relieve a tired muscle group, and whether a hand that rests is taken off
//! because it keeps the body from a task.
//!
//! A step is a relief like the others: its goal is the one of the tables. The search of [`crate::equilibria`] chooses place and posture
//! together. A posture counts where the tired group works less, its joint is nearer to its goal (of a step; for a hand that is put down or
//! taken off the joint may move either way), and the whole body needs clearly less effort than now; of these the body takes the one of least
//! effort to which there is a way in balance, on which the other supports take the weight first.

use std::cell::Cell;

use nalgebra::Vector3;

use super::ScenarioError;
use super::body_motion::{BodyMotion, is_effort};
use super::easiest::{Budget, Now, Searched, is_better, search};
use super::offer::Offer;
use super::path::{Path, Planner};
use super::rest::Rest;
use super::sample::{FootStep, StepKind};
use crate::contact::{Place, Support};
use crate::equilibria::{Aim, RelaxedPosture};
use crate::kinematics::Kinematics;
use crate::model::Side;
use crate::posture::Posture;
use crate::tasks::{PriorityLevel, turned_since};

/// A step must bring effort, and the load of the tired group, below this share of what they are (assumed).
const WORTH_A_STEP: f64 = 0.8;
/// A support that would be shifted by less is left where it is, m (assumed).
const LEAST_SHIFT: f64 = 0.02;

/// One part in so many of the budget is kept for ways to what was found (assumed).
const SHARE_OF_WAYS: usize = 8;

/// The relief that asks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tired {
    pub(super) coordinate: usize,
    pub(super) side: Side,
    /// Relative load of the group.
    pub(super) load: f64,
    /// From the present angle to the goal, rad.
    pub(super) toward: f64,
}

/// Purpose of a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose<'a> {
    /// A tired muscle group works less.
    Relief(Tired),
    /// A task that a hand at rest keeps the body from comes nearer; the errors of the tasks, as [`BodyMotion::missed`] gives them.
    Reach(&'a [f64]),
}

/// A step that will be taken.
#[derive(Debug)]
pub(super) struct PlannedStep {
    pub(super) path: Path,
    pub(super) step: FootStep,
}

/// The postures after a change of a support, that of least effort first.
pub(super) type Changes = Vec<(Offer, RelaxedPosture)>;

/// Searches, for `budget` of work, for the postures after every change that the supports allow. Whose relief asks plays no part.
pub(super) fn search_changes(
    body: &BodyMotion<'_>,
    posture: &Posture,
    purpose: Purpose<'_>,
    budget: usize,
) -> Result<Searched<Changes>, ScenarioError> {
    let scenario = body.scenario();
    let (effort, mut left, mut searched) = (body.effort(), budget, Searched::<Changes>::default());
    let offers = offers(body, purpose);
    for (k, &offer) in offers.iter().enumerate() {
        let Some(changed) = Changed::by(body, posture, offer, &mut left)? else { continue };
        let mut levels = body.levels_with(&changed.numbers);
        levels.retain(|level| level.half_spaces.is_empty());
        let (loads, aim) = (body.loads(), purpose.aim());
        let now = Now { model: &body.model, posture: &changed.posture, levels: &levels, loads, effort, aim };
        let locked: Vec<usize> = scenario.locked_rates().collect();
        let work = left.saturating_sub(budget / SHARE_OF_WAYS) / (offers.len() - k);
        let share = Budget { scattered: 0, work, carriers_stay: true };
        let limits = scenario.limits_with(&changed.numbers);
        let Ok(ways) = search(scenario, now, (&changed.supports, &limits), &locked, share) else { continue };
        left = left.saturating_sub(ways.work);
        searched.cut |= ways.cut;
        searched.found.extend(ways.found.into_iter().map(|candidate| (offer, candidate)));
    }
    searched.found.sort_by(|(_, a), (_, b)| a.relaxed.effort.total_cmp(&b.relaxed.effort));
    searched.work = budget - left;
    Ok(searched)
}

/// The step of least effort afterwards that serves its purpose, of the `changes` that were found, if `budget` of work shows a way to one.
pub(super) fn plan_step(
    body: &BodyMotion<'_>,
    posture: &Posture,
    purpose: Purpose<'_>,
    changes: &Changes,
    budget: usize,
) -> Result<Searched<Option<PlannedStep>>, ScenarioError> {
    let scenario = body.scenario();
    let (effort, mut left) = (body.effort(), budget);
    for (offer, candidate) in changes {
        let (support, to) = (&scenario.supports[offer.number], &candidate.relaxed.posture);
        let (before, after) = (middle(body, posture, support)?, middle(body, to, support)?);
        let worth = match purpose {
            Purpose::Relief(tired) => {
                let easier = candidate.relaxed.effort < WORTH_A_STEP * effort;
                easier && relieves(candidate, offer.kind, posture, tired)
            }
            // The effort of a posture that misses its task says nothing: it only has to be nearer.
            Purpose::Reach(errors) => is_better(&candidate.relaxed, 0.0, errors),
        };
        if !worth || (after - before).norm() < LEAST_SHIFT {
            continue;
        }
        if let Some(path) = body.way(posture, to, Some(*offer), &mut left) {
            let (relieves, kind) = (purpose.relieves(), offer.kind);
            let (place, effort) = ((before.into(), after.into()), (effort, candidate.relaxed.effort));
            let step = FootStep { support: offer.number, kind, relieves, time: (0.0, 0.0), place, effort };
            let found = Some(PlannedStep { path, step });
            return Ok(Searched { found, minima: vec![], work: budget - left, cut: false });
        }
    }
    Ok(Searched { found: None, minima: vec![], work: budget - left, cut: left == 0 })
}

impl Purpose<'_> {
    /// The coordinate and the muscle group that are relieved, if any.
    fn relieves(self) -> Option<(usize, Side)> {
        if let Self::Relief(tired) = self { Some((tired.coordinate, tired.side)) } else { None }
    }

    /// The postures that the search is for.
    fn aim(self) -> Aim<'static> {
        match self {
            Self::Relief(_) => Aim::Ways,
            Self::Reach(_) => Aim::Least(&[]),
        }
    }
}

/// The changes that the supports allow: those whose place is free may be put elsewhere, rests may be put down or taken off. For a task to come
/// nearer, rests may be taken off.
fn offers(body: &BodyMotion<'_>, purpose: Purpose<'_>) -> Vec<Offer> {
    if let Purpose::Reach(_) = purpose {
        let taken_off = body.offers_of_rests().filter(|offer| offer.kind == StepKind::TakenOff);
        return taken_off.map(|offer| Offer { for_a_task: true, ..offer }).collect();
    }
    let free = |number: &&usize| body.scenario().supports[**number].place != Place::Fixed;
    let elsewhere =
        body.in_use.iter().filter(free).map(|&number| Offer { number, kind: StepKind::Elsewhere, for_a_task: false });
    elsewhere.chain(body.offers_of_rests()).collect()
}

/// Start of a search for the place of a support that changes.
#[derive(Debug)]
struct Changed {
    /// Numbers of the supports after the change.
    numbers: Vec<usize>,
    /// The same supports; the changed one is free.
    supports: Vec<Support>,
    posture: Posture,
}

impl Changed {
    /// After an offer; `None` where a patch cannot be laid on its plane.
    fn by(
        body: &BodyMotion<'_>,
        posture: &Posture,
        offer: Offer,
        left: &mut usize,
    ) -> Result<Option<Self>, ScenarioError> {
        let scenario = body.scenario();
        let (mut numbers, mut supports) = body.with_change(Some(offer));
        let Some(local) = numbers.iter().position(|number| *number == offer.number) else { return Ok(None) };
        let rest = scenario.rests.iter().find(|rest| rest.support == offer.number);
        let free = &scenario.supports[offer.number];
        let mut from = posture.clone();
        match (offer.kind, rest) {
            (StepKind::TakenOff, _) => {
                numbers.remove(local);
                supports.remove(local);
            }
            (StepKind::PutDown, Some(rest)) => {
                let Some(laid) = body.laid(posture, rest, left) else { return Ok(None) };
                supports[local].place = free.place.clone();
                from = laid;
            }
            // The turn of a rest is counted from where it lies, that of another support from the start.
            (_, Some(_)) => supports[local].place = free.place.clone(),
            (_, None) => supports[local].place = place_from(body, posture, free)?,
        }
        Ok(Some(Self { numbers, supports, posture: from }))
    }
}

/// Whether the tired group works clearly less in a posture; after a step its joint must also be nearer to its goal.
fn relieves(candidate: &RelaxedPosture, kind: StepKind, now: &Posture, tired: Tired) -> bool {
    let i = tired.coordinate;
    let change = candidate.relaxed.posture.values()[i] - now.values()[i];
    let work = candidate.work.iter().find(|work| work.coordinate == i && work.side == tired.side);
    let nearer = kind != StepKind::Elsewhere || change * tired.toward > 0.0;
    nearer && work.map_or(0.0, |work| work.relative_load()) < WORTH_A_STEP * tired.load
}

/// Middle of a support's patch in a posture, ground, m.
fn middle(body: &BodyMotion<'_>, posture: &Posture, support: &Support) -> Result<Vector3<f64>, ScenarioError> {
    Ok(evaluated(body, posture)?.station(&body.scenario().model, support.segment, support.middle()))
}

/// The places that a support may take from a posture, the limits of its turn counted from the scenario's start.
fn place_from(body: &BodyMotion<'_>, posture: &Posture, support: &Support) -> Result<Place, ScenarioError> {
    let (start, now) = (evaluated(body, &body.scenario().start)?, evaluated(body, posture)?);
    Ok(turned_since(support, &body.scenario().model, &start, &now).place)
}

fn evaluated(body: &BodyMotion<'_>, posture: &Posture) -> Result<Kinematics, ScenarioError> {
    let model = &body.scenario().model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).map_err(crate::joint_torques::JointTorquesError::from)?;
    Ok(kinematics)
}

impl BodyMotion<'_> {
    /// The rests that may be put on their planes, and those in use that may be taken off.
    pub(super) fn offers_of_rests(&self) -> impl Iterator<Item = Offer> {
        self.scenario.rests.iter().map(|rest| {
            let kind = if self.in_use.contains(&rest.support) { StepKind::TakenOff } else { StepKind::PutDown };
            Offer { number: rest.support, kind, for_a_task: false }
        })
    }

    /// The posture nearest to `posture` in which the patch of a rest lies in its region, the supports in use stay where they are and tasks are
    /// done as far as that allows; `None` where there is none. `left` of a budget of work becomes less.
    pub(super) fn laid(&self, posture: &Posture, rest: &Rest, left: &mut usize) -> Option<Posture> {
        let (numbers, _) =
            self.with_change(Some(Offer { number: rest.support, kind: StepKind::PutDown, for_a_task: false }));
        let above = self.levels_with(&numbers).into_iter().take_while(|level| !is_effort(level));
        let levels: Vec<PriorityLevel> = above.filter(|level| level.half_spaces.is_empty()).collect();
        let planner = Planner {
            scenario: self.scenario,
            model: &self.model,
            supports: &self.supports,
            numbers: &self.in_use,
            limits: &self.scenario.limits_with(&numbers),
            levels: &levels,
            loads: self.engine.loads(),
            most_load: 1.0,
            left: Cell::new(*left),
        };
        let laid = planner.nearest(posture, rest.lies(&self.scenario.supports[rest.support]));
        *left = planner.left.get();
        laid.ok().flatten()
    }
}
