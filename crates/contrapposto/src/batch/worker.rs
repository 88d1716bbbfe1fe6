//! Computes the blocks of one thread.

use super::coordinates::{Driven, are_rotations, are_small};
use super::error::BatchError;
use super::gradient::{Virials, gradient};
use super::kernel::{self, Frames, Results};
use super::lanes::{LANES, Lanes};
use super::loads::Pulls;
use super::plan::{Attached, Plan};
use super::rows::Rows;
use super::sin_cos::LARGEST_ANGLE;
use crate::joint_torques::{AboutAxes, JointTorquesError, active_torque, relative_load};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load, PassiveTorque};

/// The given values of a batch, common to all threads.
#[derive(Clone, Copy)]
pub(super) struct Given<'a> {
    pub(super) model: &'a Model,
    pub(super) plan: &'a Plan,
    pub(super) pulls: &'a Pulls,
    pub(super) loads: &'a [Load],
    pub(super) placed: &'a [Attached],
    pub(super) rows: &'a Rows,
    /// A load acts between the hinges of a three-axis joint.
    pub(super) load_inside_joint: bool,
}

/// The workspace of one thread.
#[derive(Clone, Debug)]
pub(super) struct Worker {
    frames: Frames,
    driven: Driven,
    /// By elementary rate, where those are not the rates.
    elements: Vec<Lanes>,
    /// By three-axis joint, about its three axes.
    about_axes: Vec<Lanes>,
    posture: Posture,
    kinematics: Kinematics,
    passive: Option<PassiveTorque>,
    axes: Option<AboutAxes>,
    virials: Virials,
    gradient: Option<(ExternalTorque, Gradient)>,
}

impl Worker {
    pub(super) fn new(model: &Model, plan: &Plan, rows: &Rows) -> Self {
        let elements = model.elements.len();
        let axes = if rows.active_torque { 3 * plan.joints.len() } else { 0 };
        Self {
            frames: Frames::new(plan, elements),
            driven: Driven::new(model),
            elements: vec![Lanes::ZERO; if model.direct { 0 } else { elements }],
            about_axes: vec![Lanes::ZERO; axes],
            posture: model.default_posture(),
            kinematics: Kinematics::new(model),
            passive: rows.active_torque.then(|| PassiveTorque::new(model)),
            axes: rows.active_torque.then(|| AboutAxes::new(model)),
            virials: Virials::new(plan),
            gradient: rows.gradient.then(|| (ExternalTorque::new(model), Gradient::new(model))),
        }
    }

    /// Fits the workspace to another plan of the same model.
    pub(super) fn set_plan(&mut self, model: &Model, plan: &Plan) {
        self.frames = Frames::new(plan, model.elements.len());
        self.virials = Virials::new(plan);
    }

    /// Computes the blocks from the values of their coordinates, of which the first `count` postures count; the first of them has
    /// the number `first`.
    pub(super) fn run(
        &mut self,
        given: Given<'_>,
        (first, count): (usize, usize),
        values: &[Lanes],
        results: &mut [Lanes],
    ) -> Result<(), BatchError> {
        let coordinates = given.model.coordinates.len();
        for (block, rows) in results.chunks_exact_mut(given.rows.count).enumerate() {
            let values = &values[block * coordinates..(block + 1) * coordinates];
            let start = block * LANES;
            let lanes = LANES.min(count - start);
            self.block(given, lanes, values, rows).map_err(|(lane, problem)| {
                let posture = first + start + lane;
                BatchError::Posture { posture, problem }
            })?;
        }
        Ok(())
    }

    fn block(
        &mut self,
        given: Given<'_>,
        lanes: usize,
        values: &[Lanes],
        rows: &mut [Lanes],
    ) -> Result<(), (usize, JointTorquesError)> {
        let Given { model, plan, .. } = given;
        let small = are_small(values);
        if !small || !are_rotations(model, values) {
            for lane in 0..lanes {
                self.take_posture(values, lane);
                self.posture.check(model).map_err(|problem| (lane, problem.into()))?;
            }
        }
        let (torques, center_of_mass, placements, rest) = given.rows.split(rows);
        if !model.direct {
            self.driven.update(model, values, &mut self.frames.driven);
        }
        let fixed_small = plan.fixed.iter().all(|value| value.abs() <= LARGEST_ANGLE);
        self.frames.any_angle =
            !(small && fixed_small && are_small(&self.frames.driven) && are_small(&self.driven.values));
        let coupled = &self.driven.values;
        let results = Results {
            torques: if model.direct { &mut *torques } else { &mut self.elements },
            center_of_mass,
            placements,
            about_axes: &mut self.about_axes,
        };
        let of_motions = if coupled.is_empty() { values } else { coupled };
        kernel::statics(plan, given.pulls, given.placed, &mut self.frames, of_motions, results);
        if !model.direct {
            self.driven.fold(model, &self.elements, torques);
        }
        let one_by_one = given.rows.gradient && (!model.direct || given.pulls.twisted);
        if given.rows.gradient && !one_by_one {
            let entries = given.rows.split_gradient(rest);
            gradient(model, plan, given.pulls, &self.frames, &mut self.virials, entries);
        }
        for lane in 0..lanes {
            if given.rows.active_torque || one_by_one {
                self.take_posture(values, lane);
            }
            self.add_active_torque(given, lane, torques, rest).map_err(|problem| (lane, problem))?;
            if one_by_one {
                self.add_gradient(given, lane, rest).map_err(|problem| (lane, problem))?;
            }
        }
        Ok(())
    }

    fn take_posture(&mut self, values: &[Lanes], lane: usize) {
        for (value, lanes) in self.posture.values_mut().iter_mut().zip(values) {
            *value = lanes.0[lane];
        }
    }

    /// Torques about axes, relative loads and effort of one posture.
    fn add_active_torque(
        &mut self,
        given: Given<'_>,
        lane: usize,
        torques: &[Lanes],
        rows: &mut [Lanes],
    ) -> Result<(), JointTorquesError> {
        let (Some(passive), Some(axes)) = (&mut self.passive, &mut self.axes) else { return Ok(()) };
        let Given { model, plan, .. } = given;
        self.kinematics.fill_values(model, self.posture.values());
        passive.update(model, &self.kinematics)?;
        let [external, of_passive, active, loads, effort] = given.rows.split_active_torque(rows);
        external.iter_mut().zip(torques).for_each(|(external, torque)| external.0[lane] = torque.0[lane]);
        if given.load_inside_joint {
            axes.update(model, &self.posture, given.loads, false)?;
            external.iter_mut().zip(axes.external().torques()).for_each(|(to, torque)| to.0[lane] = *torque);
        } else {
            for (joint, about) in plan.joints.iter().zip(self.about_axes.chunks_exact(3)) {
                joint.rates.iter().zip(about).for_each(|(&rate, torque)| external[rate].0[lane] = torque.0[lane]);
            }
        }
        for (rate, torque) in passive.about_axes().iter().enumerate() {
            of_passive[rate].0[lane] = *torque;
            active[rate].0[lane] = active_torque(external[rate].0[lane], *torque);
        }
        let mut sum = 0.0;
        for ((coordinate, load), angle) in model.coordinates.iter().zip(loads).zip(passive.angles()) {
            let torque = coordinate.rate.map_or(0.0, |rate| active[rate].0[lane]);
            load.0[lane] = relative_load(coordinate, *angle, torque);
            sum += load.0[lane] * load.0[lane];
        }
        effort[0].0[lane] = sum;
        Ok(())
    }

    /// The gradient of external torque of one posture.
    fn add_gradient(&mut self, given: Given<'_>, lane: usize, rows: &mut [Lanes]) -> Result<(), JointTorquesError> {
        let Some((external, gradient)) = &mut self.gradient else { return Ok(()) };
        self.kinematics.update(given.model, &self.posture)?;
        external.update(given.model, &self.kinematics, given.loads)?;
        external.gradient(given.model, &self.kinematics, gradient);
        let entries = given.rows.split_gradient(rows).chunks_exact_mut(gradient.size().max(1)).enumerate();
        for (i, row) in entries {
            row.iter_mut().zip(gradient.row(i)).for_each(|(to, entry)| to.0[lane] = *entry);
        }
        Ok(())
    }
}
