//! Decides whether a support is put elsewhere to relieve a tired muscle group.
//!
//! A step is a relief like the others: its goal is the one of the tables. The search of [`crate::equilibria`] chooses place and posture
//! together. A posture counts where the tired joint is nearer to its goal, its group works less, and the whole body needs clearly less
//! effort than now; of these the body takes the one of least effort to which there is a way in balance, on which the other supports take
//! the weight first.

use nalgebra::Vector3;

use super::ScenarioError;
use super::body_motion::BodyMotion;
use super::easiest::{Budget, Now, Searched, search};
use super::path::Path;
use super::sample::FootStep;
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

/// A step that will be taken.
#[derive(Debug)]
pub(super) struct PlannedStep {
    pub(super) path: Path,
    pub(super) step: FootStep,
}

/// The step that relieves `tired` most, if `budget` of work shows one.
pub(super) fn plan_step(
    body: &mut BodyMotion<'_>,
    posture: &Posture,
    tired: Tired,
    budget: usize,
) -> Result<Searched<Option<PlannedStep>>, ScenarioError> {
    let scenario = body.scenario();
    let (mut left, mut cut) = (budget, false);
    let (effort, mut found) = (body.effort(), vec![]);
    let free: Vec<usize> =
        (0..scenario.supports.len()).filter(|&i| scenario.supports[i].place != Place::Fixed).collect();
    for (k, &i) in free.iter().enumerate() {
        let mut supports = body.supports().to_vec();
        supports[i].place = place_from(body, posture, &scenario.supports[i])?;
        let levels: Vec<PriorityLevel> = body.levels().filter(|level| level.half_spaces.is_empty()).cloned().collect();
        let now = Now { model: &body.model, posture, levels: &levels, loads: body.loads(), effort, aim: Aim::Ways };
        let locked: Vec<usize> = scenario.locked_rates().collect();
        let share = Budget { scattered: 0, work: left / (free.len() - k), carriers_stay: true };
        let Ok(searched) = search(scenario, now, &supports, &locked, share) else { continue };
        left = left.saturating_sub(searched.work);
        cut |= searched.cut;
        found.extend(searched.found.into_iter().map(|candidate| (i, candidate)));
    }
    found.sort_by(|(_, a), (_, b)| a.relaxed.effort.total_cmp(&b.relaxed.effort));
    for (i, candidate) in found {
        let (support, to) = (&scenario.supports[i], &candidate.relaxed.posture);
        let (before, after) = (middle(body, posture, support)?, middle(body, to, support)?);
        let worth = candidate.relaxed.effort < WORTH_A_STEP * effort && relieves(&candidate, posture, tired);
        if !worth || (after - before).norm() < LEAST_SHIFT {
            continue;
        }
        if let Some(path) = body.way(posture, to, Some(i), &mut left) {
            let (coordinate, side) = (tired.coordinate, tired.side);
            let (place, effort) = ((before.into(), after.into()), (effort, candidate.relaxed.effort));
            let step = FootStep { support: i, coordinate, side, time: (0.0, 0.0), place, effort };
            return Ok(Searched { found: Some(PlannedStep { path, step }), minima: vec![], work: budget - left, cut });
        }
    }
    cut |= left == 0;
    Ok(Searched { found: None, minima: vec![], work: budget - left, cut })
}

/// Whether the tired joint is nearer to its goal in a posture, and its group works clearly less.
fn relieves(candidate: &RelaxedPosture, now: &Posture, tired: Tired) -> bool {
    let i = tired.coordinate;
    let change = candidate.relaxed.posture.values()[i] - now.values()[i];
    let work = candidate.work.iter().find(|work| work.coordinate == i && work.side == tired.side);
    change * tired.toward > 0.0 && work.map_or(0.0, |work| work.relative_load()) < WORTH_A_STEP * tired.load
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
