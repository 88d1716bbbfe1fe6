//! Finds measured forces that cannot act on the segments that are given: sides that are swapped, points in another unit, a foot in the air.
//!
//! A force that pushes up and its couple act along one line; its point on the level of the segment is the centre of pressure. Over the motion it lies
//! near the foot that stands, and the foot that alone carries the body is the lower one.

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;

use super::force_plates::GREATEST_DISTANCE;
use super::ground_reaction::GroundReaction;
use crate::markers::LEAST_FORCE;

/// Share of the distance from the given foot within which the other foot must lie to be the one that is meant (assumed).
const NEARER: f64 = 0.5;
/// Distance, m, from which on a force may belong to the other foot (assumed: the centre of pressure lies within a foot's length).
const DOUBTFUL: f64 = 0.1;
/// Mean height of the foot that carries above the one that does not, m, from which on it is in the air (assumed: twice what markers move).
const IN_THE_AIR: f64 = 0.03;
/// Metres of a millimetre, the unit that is most often taken for one.
const MILLIMETRE: f64 = 1e-3;

/// Sums over the motion of the forces on one segment, weighted by the force that pushes up.
#[derive(Clone, Copy, Default)]
struct Sums {
    force: f64,
    /// Distance along the floor from the segment's centre of mass, and from that of the other side, N m.
    own: f64,
    other: f64,
    /// Distance from the segment if the point is in millimetres, N m.
    millimetres: f64,
    /// Force in frames in which the other side carries nothing, N, and that times the height above the other side, N m.
    alone: f64,
    height: f64,
}

impl GroundReaction {
    /// Sentences about forces that seem to act on another segment, or at another place, than the motion lets expect. Each names the segment.
    pub fn doubts(&self, model: &Model, motion: &[(f64, Posture)]) -> Vec<String> {
        let sums = self.sums(model, motion);
        let name = |segment: usize| model.segments()[segment].name.as_str();
        let (mut swapped, mut found) = (vec![], vec![]);
        for (&segment, sums) in &sums {
            let Some(other) = other_side(model, segment).filter(|_| sums.force > 0.0) else { continue };
            let mean = |sum: f64| sum / sums.force;
            let (own, on_other, millimetres) = (mean(sums.own), mean(sums.other), mean(sums.millimetres));
            let height = if sums.alone > 0.0 { sums.height / sums.alone } else { 0.0 };
            let here = name(segment);
            if own > GREATEST_DISTANCE && millimetres < NEARER * own && millimetres < GREATEST_DISTANCE {
                found.push(format!(
                    "the forces on `{here}` act {own:.1} m away from it: are their points in mm? {} takes them in m",
                    self.name()
                ));
            } else if own > DOUBTFUL && on_other < NEARER * own {
                swapped.push(format!(
                    "those on `{here}` act {:.0} cm away from it along the floor, {:.0} cm from `{}`",
                    100.0 * own,
                    100.0 * on_other,
                    name(other)
                ));
            } else if height > IN_THE_AIR && !(self.places(segment) && own < NEARER * on_other) {
                swapped.push(format!(
                    "`{here}` carries the body alone while it is {:.0} cm above `{}`, which carries nothing",
                    100.0 * height,
                    name(other)
                ));
            } else if own > GREATEST_DISTANCE {
                found.push(format!(
                    "the forces on `{here}` act {own:.2} m away from it along the floor: are motion and forces in the same axes, and of one trial?"
                ));
            }
        }
        if !swapped.is_empty() {
            let why = swapped.join("; ");
            found.insert(0, format!("left and right seem to be swapped in the forces of {}: {why}", self.name()));
        }
        found
    }

    /// Whether points that are measured apart from the segment tell where forces on it act.
    fn places(&self, segment: usize) -> bool {
        let mut on = self.plates().iter().filter(|plate| plate.segment == segment);
        on.any(|plate| plate.point.is_some() && plate.point_in != Some(segment))
    }

    /// Sums over the frames that the table covers, by segment.
    fn sums(&self, model: &Model, motion: &[(f64, Posture)]) -> BTreeMap<usize, Sums> {
        let (mut kinematics, mut loads) = (Kinematics::new(model), vec![]);
        let mut all: BTreeMap<usize, Sums> = BTreeMap::new();
        let Some(up) = (-model.gravity()).try_normalize(1e-9) else { return all };
        for (time, posture) in motion.iter().filter(|(time, _)| self.covers(*time)) {
            if kinematics.update(model, posture).is_err() {
                continue;
            }
            loads.clear();
            self.loads(*time, model, &kinematics, &mut loads);
            let carried: BTreeMap<usize, Pressed> = pressed(model, &kinematics, &loads)
                .into_iter()
                .filter(|(_, on)| on.force.dot(&up) >= LEAST_FORCE)
                .collect();
            for (&segment, on) in &carried {
                let Some(other) = other_side(model, segment) else { continue };
                let push = on.force.dot(&up);
                // The moment about the origin of ground that the line of action leaves along the floor.
                let at = up.cross(&on.moment) / push;
                let place = |of: usize| kinematics.station(model, of, model.segments()[of].center_of_mass);
                let away = |from: Vector3<f64>, at: Vector3<f64>| {
                    let away = at - from;
                    (away - up * away.dot(&up)).norm()
                };
                // The line of action, where it crosses the level of the foot.
                let on_level = |of: Vector3<f64>, at: Vector3<f64>| at + on.force * ((of - at).dot(&up) / push);
                let [own, others] = [segment, other].map(place);
                let sums = all.entry(segment).or_default();
                sums.force += push;
                sums.own += push * away(own, on_level(own, at));
                sums.other += push * away(others, on_level(others, at));
                sums.millimetres += push * away(own, on_level(own, MILLIMETRE * at));
                if !carried.contains_key(&other) {
                    sums.alone += push;
                    sums.height += push * (own - others).dot(&up);
                }
            }
        }
        all
    }
}

/// Force (N) on a segment, and its moment about the origin of ground (N m).
#[derive(Clone, Copy, Default)]
struct Pressed {
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

/// The sums of all loads on each segment.
fn pressed(model: &Model, kinematics: &Kinematics, loads: &[Load]) -> BTreeMap<usize, Pressed> {
    let mut all: BTreeMap<usize, Pressed> = BTreeMap::new();
    for load in loads {
        let in_ground = |vector: Vector3<f64>, fixed: FixedIn| match fixed {
            FixedIn::World => vector,
            FixedIn::Segment => kinematics.direction(model, load.segment, vector),
        };
        let on = all.entry(load.segment).or_default();
        match load.kind {
            LoadKind::Force(force, fixed) => {
                let force = in_ground(force, fixed);
                on.force += force;
                on.moment += kinematics.station(model, load.segment, load.point).cross(&force);
            }
            LoadKind::Couple(couple, fixed) => on.moment += in_ground(couple, fixed),
            _ => {}
        }
    }
    all
}

/// The segment of the other side, by its name: `calcn_r` and `calcn_l`, `RightFoot` and `LeftFoot`.
fn other_side(model: &Model, segment: usize) -> Option<usize> {
    let name = &model.segments()[segment].name;
    let sides = [("right", "left"), ("Right", "Left"), ("r", "l"), ("R", "L")];
    let both = sides.into_iter().flat_map(|(one, other)| [(one, other), (other, one)]);
    let mut other = both.flat_map(|(from, to)| {
        [
            name.strip_prefix(from).map(|rest| format!("{to}{rest}")),
            name.strip_suffix(from).map(|rest| format!("{rest}{to}")),
        ]
    });
    other.find_map(|other| model.segment(&other?))
}
