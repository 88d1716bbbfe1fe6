//! Carries a lifted support to another place: a foot along an arc, a hand round the thing that it is put on.

use nalgebra::{UnitQuaternion, Vector3};

use super::path::{AT_POSTURE, MOST_STEPS_OF_PART, Path, Planner, SPEED};
use super::sample::StepKind;
use crate::contact::Support;
use crate::kinematics::Kinematics;
use crate::model::{Capsule, Placement};
use crate::posture::Posture;
use crate::posture_solver::EngineError;
use crate::tasks::{ClearancePair, Obstacle, Task};

/// Time that a lifted support is in the air, s (assumed: a slow step).
const SWING_TIME: f64 = 1.0;
/// Greatest speed of a hand that is put down or taken off, m/s (assumed).
const HAND_SPEED: f64 = 0.3;
/// Height of the arc above the line between both places, m (assumed).
const LIFT: f64 = 0.03;
/// A lifted support has arrived when its place and rotation differ by no more, m and rad.
const PLACED: f64 = 1e-6;
/// A patch that is deeper in a thing than this has entered it, m.
const DEEPEST: f64 = 1e-3;
/// A hand that comes from below a thing passes its edge at this distance, and rises so far above its top, m (assumed).
const PAST_THE_EDGE: f64 = 0.10;
/// Step in which the edge of a thing is looked for, m.
const EDGE_STEP: f64 = 0.01;
/// Depth to which a thing is looked for under a place, m: its top is there but for rounding (assumed).
const LOOKED_BELOW: f64 = 0.10;
/// Farthest distance of an edge that is looked for, m (assumed).
const FARTHEST_EDGE: f64 = 1.0;

/// The places that a lifted support passes.
type Line = Vec<Vector3<f64>>;

impl Planner<'_> {
    /// Carries the lifted support to its place in `to`, while the body moves toward `to`: of the ways that there are the first on which the body is
    /// held and no patch enters a thing.
    pub(super) fn swing(
        &self,
        from: &Posture,
        to: &Posture,
        (lifted, kind): (usize, StepKind),
        path: &mut Path,
    ) -> Result<Option<Posture>, EngineError> {
        let ends = (self.placement(from, lifted)?, self.placement(to, lifted)?);
        let straight = vec![ends.0.translation.vector, ends.1.translation.vector];
        let mut lines = vec![straight];
        if kind != StepKind::Elsewhere {
            lines.extend(self.round_the_edge(from, &ends, lifted, kind)?);
        }
        for line in lines {
            let mut way = path.clone();
            if let Some(landed) = self.swing_along(&line, (from, to), (lifted, kind), &mut way)? {
                *path = way;
                return Ok(Some(landed));
            }
        }
        Ok(None)
    }

    /// The way of a hand round the edge of the thing under its place: on the body's side, above its top.
    fn round_the_edge(
        &self,
        from: &Posture,
        ends: &(Placement, Placement),
        lifted: usize,
        kind: StepKind,
    ) -> Result<Option<Line>, EngineError> {
        let mut kinematics = Kinematics::new(self.model);
        kinematics.update(self.model, from).map_err(crate::joint_torques::JointTorquesError::from)?;
        let normal = self.supports[lifted].normal;
        let (begin, end) = (ends.0.translation.vector, ends.1.translation.vector);
        let rests_at = if kind == StepKind::PutDown { end } else { begin };
        let Some(body) = kinematics.center_of_mass(self.model) else { return Ok(None) };
        let toward = body - rests_at;
        let Some(toward) = (toward - normal * normal.dot(&toward)).try_normalize(1e-6) else { return Ok(None) };
        // A point below the top: inside the thing, or below it, as long as the thing is there.
        let mut distance = 0.0;
        while distance < FARTHEST_EDGE && self.is_above_a_thing(rests_at + distance * toward, normal) {
            distance += EDGE_STEP;
        }
        let via = rests_at + (distance + PAST_THE_EDGE) * toward + PAST_THE_EDGE * normal;
        Ok(Some(vec![begin, via, end]))
    }

    /// Whether a thing is under a place, within [`LOOKED_BELOW`].
    fn is_above_a_thing(&self, place: Vector3<f64>, normal: Vector3<f64>) -> bool {
        let count = (LOOKED_BELOW / EDGE_STEP).round() as usize;
        let mut below = (0..=count).map(|k| place - k as f64 * EDGE_STEP * normal);
        below.any(|point| self.things().any(|thing| thing.holds(point)))
    }

    /// The way along `line`, and the posture at its end.
    fn swing_along(
        &self,
        line: &Line,
        (from, to): (&Posture, &Posture),
        (lifted, kind): (usize, StepKind),
        path: &mut Path,
    ) -> Result<Option<Posture>, EngineError> {
        let (begin, end) = (self.placement(from, lifted)?, self.placement(to, lifted)?);
        let Some(over_the_others) = self.over_the_others(from, (lifted, kind))? else { return Ok(None) };
        let first = vec![self.held_at(begin, lifted), over_the_others];
        let mut engine = self.engine(from, &self.without(lifted), first, to)?;
        let angle = begin.rotation.angle_to(&end.rotation);
        let samples = (swing_time(line, angle, kind) / self.scenario.run.step).ceil().max(1.0);
        let steps = self.steps_of_sample().max((20.0 / samples).ceil() as usize);
        let count = samples as usize * steps;
        let mut posture = from.clone();
        for k in 1..=count {
            let share = k as f64 / count as f64;
            let height = LIFT * 4.0 * share * (1.0 - share) * self.supports[lifted].normal;
            let rotation = UnitQuaternion::slerp(&begin.rotation, &end.rotation, share);
            let target = Placement::from_parts((along(line, share) + height).into(), rotation);
            engine.levels_mut()[0].tasks[0] = self.held_at(target, lifted);
            let Some(_) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if k % steps == 0 {
                let held = self.is_held(&mut engine, &posture)?;
                if !held || self.enters_a_thing(lifted, engine.torques().kinematics()) {
                    return Ok(None);
                }
                path.push(&posture, Some(self.numbers[lifted]));
            }
        }
        // The last of the way: until the support has come to rest on its place.
        for k in 1..=MOST_STEPS_OF_PART {
            let Some(largest) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if largest <= AT_POSTURE && engine.report(&posture)?.first().is_some_and(|level| level.length <= PLACED) {
                break;
            }
            if k % steps == 0 {
                if !self.is_held(&mut engine, &posture)? {
                    return Ok(None);
                }
                path.push(&posture, Some(self.numbers[lifted]));
            }
        }
        let missed = engine.report(&posture)?.first().map_or(0.0, |level| level.length);
        if !self.is_held(&mut engine, &posture)? || missed > PLACED {
            return Ok(None);
        }
        path.push(&posture, Some(self.numbers[lifted]));
        Ok(Some(posture))
    }

    /// Whether a corner of a support's patch is inside a thing that its segment keeps off.
    fn enters_a_thing(&self, support: usize, kinematics: &Kinematics) -> bool {
        let Support { segment, corners, .. } = &self.supports[support];
        self.pairs_with_things().filter(|pair| pair.part.segment == *segment).any(|pair| {
            corners.iter().any(|corner| {
                let part = Capsule { segment: *segment, ends: [*corner; 2], radius: 0.0 };
                ClearancePair { part, other: pair.other }.distance(self.model, kinematics) < -DEEPEST
            })
        })
    }

    fn pairs_with_things(&self) -> impl Iterator<Item = &ClearancePair> {
        let pairs = self.scenario.limits.iter().filter_map(|task| match task {
            Task::Clearance(clearance) => Some(&clearance.pairs),
            _ => None,
        });
        pairs.flatten().filter(|pair| matches!(pair.other, Obstacle::Thing(_)))
    }

    /// Blocks among the things that the body keeps off.
    fn things(&self) -> impl Iterator<Item = crate::tasks::Thing> {
        self.pairs_with_things().filter_map(|pair| match pair.other {
            Obstacle::Thing(thing @ crate::tasks::Thing::Block { .. }) => Some(thing),
            _ => None,
        })
    }
}

/// The point after a share of a line's length.
fn along(line: &Line, share: f64) -> Vector3<f64> {
    if let [begin, end] = line[..] {
        return begin.lerp(&end, share);
    }
    let mut left = share * length(line);
    for ends in line.windows(2) {
        let part = (ends[1] - ends[0]).norm();
        if left <= part && part > 0.0 {
            return ends[0].lerp(&ends[1], left / part);
        }
        left -= part;
    }
    line.last().copied().unwrap_or_default()
}

fn length(line: &Line) -> f64 {
    line.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
}

/// Time for which a support is in the air, s: a step has [`SWING_TIME`]; a hand has as long as its speeds ask for.
fn swing_time(line: &Line, angle: f64, kind: StepKind) -> f64 {
    match kind {
        StepKind::Elsewhere => SWING_TIME,
        _ => SWING_TIME.max((length(line) + LIFT) / HAND_SPEED).max(angle / SPEED),
    }
}
