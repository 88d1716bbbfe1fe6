//! Computes the passive torque of one joint along its own motion: a coordinate over its range, or a three-axis joint turned about
//! one of its axes.
//!
//! From the orientation `R` of a three-axis joint the arc is `R exp(s e_k)`, as far as all its angles stay in their ranges. Passive
//! torque is known over that whole arc. Its table has the angle about the axis now, plus `s`; where the moment of several laws rises
//! along the arc, away from here, the table stays level, because the tables of goal angles need a falling curve.

use std::borrow::Cow;

use nalgebra::UnitQuaternion;

use super::PassiveTorque;
use super::passive_torque::extended;
use crate::kinematics::Kinematics;
use crate::math::Angles;
use crate::model::{Model, ThreeAxisJoint};
use crate::passive::{PassiveCurve, PassiveLaw, Tabulated};

/// Rows of the table on each side of the present angle.
const ROWS_ON_EACH_SIDE: usize = 32;
/// Steps in which half a turn is searched for the end of an arc.
const SEARCH_STEPS: usize = 90;
/// Bisections of the step in which an arc ends.
const ARC_BISECTIONS: usize = 30;
/// Shortest arc that has a table, rad.
const SHORTEST_ARC: f64 = 1e-6;

/// One three-axis joint about one of its axes.
struct Arc<'a> {
    model: &'a Model,
    passive: &'a PassiveTorque,
    joint: &'a ThreeAxisJoint,
    /// Orientation now.
    rotation: UnitQuaternion<f64>,
    /// Place of the axis in the joint.
    axis: usize,
}

impl Arc<'_> {
    fn rotation_after(&self, turn: f64) -> UnitQuaternion<f64> {
        self.rotation * UnitQuaternion::from_scaled_axis(turn * self.joint.axes[self.axis])
    }

    /// Whether all angles are in their ranges, or no farther outside than now.
    fn is_inside(&self, turn: f64) -> bool {
        let now = self.passive.angles();
        let values = self.joint.swing_twist.values(&self.rotation_after(turn));
        self.joint.coordinates.iter().zip(values).all(|(&i, angle)| {
            let (low, high) = self.model.coordinates()[i].range;
            (low.min(now[i])..=high.max(now[i])).contains(&angle)
        })
    }

    /// The end of the arc in the sense of `sign`, rad.
    fn end(&self, sign: f64) -> f64 {
        let step = |k: usize| sign * std::f64::consts::PI * k as f64 / SEARCH_STEPS as f64;
        let Some(first) = (1..=SEARCH_STEPS).find(|&k| !self.is_inside(step(k))) else { return step(SEARCH_STEPS) };
        let (mut inside, mut outside) = (step(first - 1), step(first));
        for _ in 0..ARC_BISECTIONS {
            let middle = f64::midpoint(inside, outside);
            *if self.is_inside(middle) { &mut inside } else { &mut outside } = middle;
        }
        inside
    }

    /// Passive torque about the axis after the turn, N m; `values` is space for the angles of all coordinates.
    fn torque(&self, turn: f64, values: &mut [f64]) -> f64 {
        let angles = self.joint.swing_twist.angles(&self.rotation_after(turn));
        self.passive.torque_at(self.model, self.joint, &angles, self.axis, values)
    }

    /// The table over the arc, at the angle now plus the turn.
    fn curve(&self) -> Option<PassiveCurve> {
        let (low, high) = (self.end(-1.0), self.end(1.0));
        if high - low < SHORTEST_ARC {
            return None;
        }
        let now = self.passive.angles()[self.joint.coordinates[self.axis]];
        let mut values = self.passive.values().to_vec();
        let here = self.torque(0.0, &mut values);
        let mut side = |end: f64, keep: fn(f64, f64) -> f64| {
            let mut last = here;
            let rows: Vec<(f64, f64)> = (1..=ROWS_ON_EACH_SIDE)
                .map(|k| {
                    let turn = end * k as f64 / ROWS_ON_EACH_SIDE as f64;
                    last = keep(last, self.torque(turn, &mut values));
                    (now + turn, last)
                })
                .collect();
            if end.abs() < SHORTEST_ARC { vec![] } else { rows }
        };
        let mut rows = side(low, f64::max);
        rows.reverse();
        rows.push((now, here));
        rows.extend(side(high, f64::min));
        let range = (rows[0].0, rows[rows.len() - 1].0);
        PassiveCurve::new(Tabulated::new(&rows).ok()?.form(), range, None).ok()
    }
}

impl PassiveTorque {
    /// The falling curve of the passive torque of a coordinate over `range` (rad) with its neighbours held, or along the arc of its
    /// three-axis joint about its axis; `None` where a law is a sum of a file's terms, which need not fall, or no arc is left. The
    /// present angle in it is that of [`PassiveTorque::angles`].
    pub fn curve_about_axis<'m>(
        &self,
        model: &'m Model,
        kinematics: &Kinematics,
        coordinate: usize,
        range: (f64, f64),
    ) -> Option<Cow<'m, PassiveCurve>> {
        let law = model.coordinates()[coordinate].passive.as_ref()?;
        let Some(arc) = self.arc(model, kinematics, coordinate) else {
            return law.curve_at(coordinate, self.values(), range);
        };
        let falls = |i: &usize| !matches!(model.coordinates()[*i].passive, Some(PassiveLaw::Sum(_)));
        arc.joint.coordinates.iter().all(falls).then(|| arc.curve().map(Cow::Owned)).flatten()
    }

    /// Torque of the law of a coordinate about its axis, nothing coupled, after the joint alone has turned by `turn` (rad) about it,
    /// N m; `values` is space for the angles of all coordinates.
    pub fn torque_after_turn(
        &self,
        (model, kinematics): (&Model, &Kinematics),
        coordinate: usize,
        turn: f64,
        values: &mut [f64],
    ) -> f64 {
        if let Some(arc) = self.arc(model, kinematics, coordinate) {
            return arc.torque(turn, values);
        }
        values.copy_from_slice(self.values());
        values[coordinate] += turn;
        model.coordinates()[coordinate].passive.as_ref().map_or(0.0, |law| law.torque(coordinate, values))
    }

    fn arc<'a>(&'a self, model: &'a Model, kinematics: &Kinematics, coordinate: usize) -> Option<Arc<'a>> {
        let (joint, axis) = model.three_axis_joint_of(coordinate)?;
        let joint = &model.three_axis_joints()[joint];
        Some(Arc { model, passive: self, joint, rotation: joint.rotation(kinematics.values()), axis })
    }

    /// Passive torque about axis `axis` of a three-axis joint that has the given angles, N m; `values` is space for those of all
    /// coordinates.
    fn torque_at(
        &self,
        model: &Model,
        joint: &ThreeAxisJoint,
        angles: &Angles,
        axis: usize,
        values: &mut [f64],
    ) -> f64 {
        values.copy_from_slice(self.values());
        for (&i, angle) in joint.coordinates.iter().zip(angles.values) {
            let (low, high) = self.range(model, i);
            values[i] = angle.max(low).min(high);
        }
        let places = joint.coordinates.into_iter().enumerate();
        places.fold(0.0, |sum, (j, i)| {
            let beyond = self.beyond(i, angles.values[j], values[i]);
            sum + angles.first[(j, axis)] * extended(model, i, values, beyond, |_, _| {})
        })
    }
}
