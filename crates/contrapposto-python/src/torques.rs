//! Computes the torques of many postures in blocks, between which Ctrl-C is seen.

use std::sync::{Arc, Mutex, PoisonError};

use contrapposto::joint_torques::{JointMuscles, JointTorquesError};
use contrapposto::statics::Load;
use contrapposto_cli::library::RestTorques;
use contrapposto_formats::tissue::SourcedModel;
use pyo3::prelude::*;

use crate::errors::refused_row;
use crate::loads::Loading;

/// Postures of a part: threads take parts in turn, so a thread that is held up leaves its share to the others.
const PART: usize = 128;
/// Parts of one thread between two looks for Ctrl-C.
const PARTS_OF_ROUND: usize = 16;

/// A body with its muscles, where they are used.
pub(crate) struct Body {
    pub(crate) opened: Arc<SourcedModel>,
    pub(crate) muscles: Option<JointMuscles>,
}

/// Postures, and all that acts on the body in them.
pub(crate) struct Given {
    /// Values of the coordinates, row after row.
    pub(crate) values: Vec<f64>,
    pub(crate) width: usize,
    pub(crate) loads: Vec<Loading>,
    /// Generalised forces of a device, row after row; empty for none.
    pub(crate) device: Vec<f64>,
    pub(crate) threads: usize,
}

/// External, passive and active torque, row after row.
pub(crate) type Torques = [Vec<f64>; 3];

/// A refused row, and why.
type Refused = (usize, JointTorquesError);

impl Given {
    fn postures(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// Torques of all postures, `rates` a posture. The number of threads changes no bit of them.
    pub(crate) fn torques(&self, py: Python<'_>, body: &Body, rates: usize) -> PyResult<Torques> {
        let mut all = [(); 3].map(|()| vec![0.0; self.postures() * rates]);
        let [external, passive, active] = &mut all;
        let size = (PART * rates).max(1);
        let parts = external.chunks_mut(size).zip(passive.chunks_mut(size)).zip(active.chunks_mut(size));
        let parts = parts.enumerate().map(|(i, ((external, passive), active))| (i * PART, [external, passive, active]));
        self.in_blocks(py, body, parts, |rest, loads, row, [external, passive, active], at| {
            let here = at * rates..(at + 1) * rates;
            let out = [&mut external[here.clone()], &mut passive[here.clone()], &mut active[here]];
            let device = if self.device.is_empty() { &[] } else { &self.device[row * rates..(row + 1) * rates] };
            rest.update(&body.opened.model, self.row(row), loads, device, out)
        })?;
        Ok(all)
    }

    /// Gradients of external torque of all postures, `rates * rates` numbers a posture.
    pub(crate) fn gradients(&self, py: Python<'_>, body: &Body, rates: usize) -> PyResult<Vec<f64>> {
        let square = rates * rates;
        let mut all = vec![0.0; self.postures() * square];
        let parts = all.chunks_mut((PART * square).max(1)).enumerate().map(|(i, part)| (i * PART, part));
        self.in_blocks(py, body, parts, |rest, loads, row, part, at| {
            rest.gradient(&body.opened.model, self.row(row), loads, &mut part[at * square..(at + 1) * square])
        })?;
        Ok(all)
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.width..(row + 1) * self.width]
    }

    /// Fills parts of at most [`PART`] postures, several at once, without the lock; `fill` computes one posture, given its number and
    /// its place in its part.
    fn in_blocks<P: Send>(
        &self,
        py: Python<'_>,
        body: &Body,
        mut parts: impl Iterator<Item = (usize, P)>,
        fill: impl Fn(&mut RestTorques, &[Load], usize, &mut P, usize) -> Result<(), JointTorquesError> + Sync,
    ) -> PyResult<()> {
        let mut bodies: Vec<RestTorques> =
            (0..self.threads.max(1)).map(|_| RestTorques::new(&body.opened, body.muscles.as_ref())).collect();
        let part_of = |rest: &mut RestTorques, (first, mut part): (usize, P)| -> Result<(), Refused> {
            let mut loads = vec![];
            for (at, row) in (first..self.postures().min(first + PART)).enumerate() {
                loads.clear();
                loads.extend(self.loads.iter().map(|load| load.at(row)));
                fill(rest, &loads, row, &mut part, at).map_err(|error| (row, error))?;
            }
            Ok(())
        };
        loop {
            let round: Vec<(usize, P)> = parts.by_ref().take(bodies.len() * PARTS_OF_ROUND).collect();
            if round.is_empty() {
                return Ok(());
            }
            let done = py.detach(|| at_once(&mut bodies, round, &part_of));
            done.map_err(|(row, error)| refused_row(py, &body.opened.model, row, &error))?;
            py.check_signals()?;
        }
    }
}

/// Computes the parts, in as many threads as there are bodies; the error of the first row counts.
fn at_once<P: Send>(
    bodies: &mut [RestTorques],
    parts: Vec<(usize, P)>,
    part_of: &(impl Fn(&mut RestTorques, (usize, P)) -> Result<(), Refused> + Sync),
) -> Result<(), Refused> {
    let Some((first, others)) = bodies.split_first_mut() else { return Ok(()) };
    let most = others.len().min(parts.len().saturating_sub(1));
    let others = &mut others[..most];
    let parts = Mutex::new(parts.into_iter());
    // Parts are taken in their order, and each that was taken is ended: the first refused row is always found.
    let work = |body: &mut RestTorques| -> Result<(), Refused> {
        loop {
            let part = parts.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(part) = part else { return Ok(()) };
            part_of(body, part)?;
        }
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = others.iter_mut().map(|body| scope.spawn(|| work(body))).collect();
        let mut results = vec![work(first)];
        let panicked = |panic| std::panic::resume_unwind(panic);
        results.extend(others.into_iter().map(|other| other.join().unwrap_or_else(panicked)));
        results.into_iter().filter_map(Result::err).min_by_key(|(row, _)| *row).map_or(Ok(()), Err)
    })
}
