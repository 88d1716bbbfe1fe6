//! Computes frames and torques of many postures of one model.

use nalgebra::{Matrix3, Vector3};

use super::error::BatchError;
use super::lanes::LANES;
use super::loads::Pulls;
use super::plan::{Attached, Plan};
use super::rows::Rows;
use super::table::Table;
use super::worker::{Given, Worker};
use crate::model::Model;
use crate::statics::Load;

/// The quantities that a batch computes beyond external torque and centre of mass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Segments whose placements are computed.
    pub placements: Vec<usize>,
    /// Passive and active torque, relative loads and effort.
    pub active_torque: bool,
    /// Gradient of external torque.
    pub gradient: bool,
}

/// Statics of many postures of one model under the same loads. Filled by [`Statics::update`].
///
/// External torque, centre of mass and placements are computed for eight postures at a time, whatever the motions of the model; so is
/// the gradient, unless functions drive motions, coordinates are coupled, or a load is a couple or fixed in a segment. All functions,
/// passive laws, strengths and other gradients are computed posture by posture.
#[derive(Clone, Debug)]
pub struct Statics {
    wanted: Wanted,
    plan: Plan,
    placed: Vec<Attached>,
    pulls: Pulls,
    rows: Rows,
    results: Table,
    workers: Vec<Worker>,
}

impl Statics {
    /// Space for `model`.
    ///
    /// # Errors
    /// [`BatchError::Segment`] for a placement of a segment that is not there.
    pub fn new(model: &Model, wanted: Wanted) -> Result<Self, BatchError> {
        let count = model.segments.len();
        if let Some(&segment) = wanted.placements.iter().find(|&&segment| segment >= count) {
            return Err(BatchError::Segment { segment, count });
        }
        let plan = Plan::new(model, &frames(model, &wanted, &[]));
        let rows = Rows::new(model, wanted.placements.len(), wanted.active_torque, wanted.gradient);
        Ok(Self {
            placed: wanted.placements.iter().map(|&segment| plan.attached(model, segment)).collect(),
            workers: vec![Worker::new(model, &plan, &rows)],
            results: Table::zeros(rows.count),
            pulls: Pulls::default(),
            wanted,
            plan,
            rows,
        })
    }

    /// Computes all postures, under gravity and `loads`, in as many `threads` (0 counts as 1), each of which computes a contiguous part.
    /// Each result depends on its posture alone: number and order of postures and number of threads do not change a bit of it. With
    /// one thread nothing is allocated once there were as many postures and loads on the same segments.
    ///
    /// # Errors
    /// [`BatchError`] for a table, a load or a posture that does not fit the model, or where a passive law gives no torque. The results
    /// are unknown then.
    pub fn update(
        &mut self,
        model: &Model,
        postures: &Table,
        loads: &[Load],
        threads: usize,
    ) -> Result<(), BatchError> {
        let needed = model.coordinates.len();
        if postures.rows() != needed {
            return Err(BatchError::Rows { given: postures.rows(), needed });
        }
        loads.iter().try_for_each(|load| load.check(model))?;
        self.fit_plan(model, loads);
        self.pulls.update(model, &self.plan, loads);
        self.results.resize(postures.postures());
        let blocks = postures.postures().div_ceil(LANES);
        let threads = threads.clamp(1, blocks.max(1));
        while self.workers.len() < threads {
            self.workers.push(Worker::new(model, &self.plan, &self.rows));
        }
        let given = Given {
            model,
            plan: &self.plan,
            pulls: &self.pulls,
            loads,
            placed: &self.placed,
            rows: &self.rows,
            load_inside_joint: loads.iter().any(|load| is_inside_joint(model, load)),
        };
        let each = blocks.div_ceil(threads);
        let parts = self.results.blocks.chunks_mut((each * self.rows.count).max(1));
        let jobs = self.workers.iter_mut().zip(parts).enumerate().map(|(i, (worker, results))| {
            let first = i * each * LANES;
            let count = (each * LANES).min(postures.postures() - first);
            let values = &postures.blocks[i * each * needed..(i * each + results.len() / given.rows.count) * needed];
            move || worker.run(given, (first, count), values, results)
        });
        in_threads(threads, jobs)
    }

    /// Arranges the model anew if a load pulls where the plan has no frame.
    fn fit_plan(&mut self, model: &Model, loads: &[Load]) {
        let mobility = |load: &Load| model.segments[load.segment].mobility;
        if loads.iter().filter_map(mobility).all(|m| self.plan.ends_node(m)) {
            return;
        }
        self.plan = Plan::new(model, &frames(model, &self.wanted, loads));
        self.placed = self.wanted.placements.iter().map(|&segment| self.plan.attached(model, segment)).collect();
        self.workers.iter_mut().for_each(|worker| worker.set_plan(model, &self.plan));
    }

    /// Number of postures of the last update.
    pub fn postures(&self) -> usize {
        self.results.postures()
    }

    /// External torque of a rate, N m (N for slides), of every posture: see [`crate::statics::ExternalTorque::torques`].
    ///
    /// # Panics
    /// When the model has no such rate.
    pub fn external_torque(&self, rate: usize) -> impl Iterator<Item = f64> {
        self.results.row(self.of_rate(0, rate))
    }

    /// The centre of mass of a posture in ground, m; `None` for a body without mass.
    ///
    /// # Panics
    /// When there is no such posture.
    pub fn center_of_mass(&self, posture: usize) -> Option<Vector3<f64>> {
        (self.plan.mass > 0.0).then(|| self.vector(self.rows.center_of_mass(), posture))
    }

    /// Rotation and origin, m, in ground of a frame of [`Wanted::placements`], given by its place there, in a posture.
    ///
    /// # Panics
    /// When there is no such placement or posture.
    pub fn placement(&self, which: usize, posture: usize) -> (Matrix3<f64>, Vector3<f64>) {
        assert!(which < self.placed.len(), "placement {which}: not wanted");
        let row = self.rows.placement(which);
        let columns = [0, 3, 6].map(|column| self.vector(row + column, posture));
        (Matrix3::from_columns(&columns), self.vector(row + 9, posture))
    }

    /// External torque of a rate about its axis, N m: see [`crate::joint_torques::JointTorques::external_about_axes`].
    ///
    /// # Panics
    /// When the model has no such rate, or active torque is not wanted.
    pub fn external_about_axis(&self, rate: usize) -> impl Iterator<Item = f64> {
        self.results.row(self.of_rate(self.of_active_torque(Rows::external_about_axes), rate))
    }

    /// Passive torque of a rate about its axis, N m: see [`crate::statics::PassiveTorque::about_axes`].
    ///
    /// # Panics
    /// As [`Statics::external_about_axis`].
    pub fn passive_about_axis(&self, rate: usize) -> impl Iterator<Item = f64> {
        self.results.row(self.of_rate(self.of_active_torque(Rows::passive_about_axes), rate))
    }

    /// Active torque of a rate about its axis, N m: see [`crate::joint_torques::JointTorques::active_torque`].
    ///
    /// # Panics
    /// As [`Statics::external_about_axis`].
    pub fn active_torque(&self, rate: usize) -> impl Iterator<Item = f64> {
        self.results.row(self.of_rate(self.of_active_torque(Rows::active), rate))
    }

    /// Relative load of a coordinate: see [`crate::joint_torques::relative_load`].
    ///
    /// # Panics
    /// When the model has no such coordinate, or active torque is not wanted.
    pub fn relative_load(&self, coordinate: usize) -> impl Iterator<Item = f64> {
        let row = self.of_active_torque(Rows::loads) + coordinate;
        assert!(row < self.rows.effort(), "coordinate {coordinate}: not in the model");
        self.results.row(row)
    }

    /// Effort: the sum of squares of the relative loads of all coordinates.
    ///
    /// # Panics
    /// When active torque is not wanted.
    pub fn effort(&self) -> impl Iterator<Item = f64> {
        self.results.row(self.of_active_torque(Rows::effort))
    }

    /// `d external_row / d q_column`, N m/rad, of every posture: see [`crate::statics::Gradient`].
    ///
    /// # Panics
    /// When the model has no such rates, or the gradient is not wanted.
    pub fn gradient(&self, row: usize, column: usize) -> impl Iterator<Item = f64> {
        assert!(self.wanted.gradient, "the gradient is not wanted");
        let start = self.rows.gradient_row();
        self.results.row(self.of_rate(self.of_rate(start, row) - row + row * self.rows.rates, column))
    }

    /// The row of a rate among those that begin with `start`.
    fn of_rate(&self, start: usize, rate: usize) -> usize {
        assert!(rate < self.rows.rates, "rate {rate}: not in the model");
        start + rate
    }

    fn of_active_torque(&self, row: impl Fn(&Rows) -> usize) -> usize {
        assert!(self.wanted.active_torque, "active torque is not wanted");
        row(&self.rows)
    }

    fn vector(&self, row: usize, posture: usize) -> Vector3<f64> {
        Vector3::from([0, 1, 2].map(|k| self.results.get(row + k, posture)))
    }
}

/// Runs the jobs, each in a thread of its own but the first, which the calling thread runs; the first error counts.
fn in_threads<J>(threads: usize, mut jobs: impl Iterator<Item = J>) -> Result<(), BatchError>
where
    J: FnOnce() -> Result<(), BatchError> + Send,
{
    let first = jobs.next();
    if threads == 1 {
        return first.map_or(Ok(()), |job| job());
    }
    std::thread::scope(|scope| {
        let others: Vec<_> = jobs.map(|job| scope.spawn(job)).collect();
        let first = first.map_or(Ok(()), |job| job());
        let panicked = |panic| std::panic::resume_unwind(panic);
        others.into_iter().fold(first, |found, other| {
            let result = other.join().unwrap_or_else(panicked);
            found.and(result)
        })
    })
}

/// Mobilities whose frames are needed: those of wanted placements and of loads.
fn frames(model: &Model, wanted: &Wanted, loads: &[Load]) -> Vec<usize> {
    let loaded = loads.iter().map(|load| load.segment);
    loaded.chain(wanted.placements.iter().copied()).filter_map(|segment| model.segments[segment].mobility).collect()
}

/// Whether a load acts between the hinges of a three-axis joint, where the body with balls has no frame of its own.
fn is_inside_joint(model: &Model, load: &Load) -> bool {
    let Some(mobility) = model.segments[load.segment].mobility else { return false };
    let crate::model::Drive::Coordinate(c) = model.mobilities[mobility].drive else { return false };
    model.three_axis_joint_of(c).is_some_and(|(_, place)| place < 2)
}
