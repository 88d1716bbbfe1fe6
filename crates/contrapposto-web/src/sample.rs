//! Holds the last sample of a run, as far as it is shown.

use contrapposto::simulation::{Sample, Standing};

/// The last sample, as far as it is shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastSample {
    /// The first one is 0.
    pub(crate) number: u64,
    pub(crate) time: f64,
    pub(crate) posture: Vec<f64>,
    pub(crate) external: Vec<f64>,
    pub(crate) passive: Vec<f64>,
    pub(crate) load: Vec<f64>,
    pub(crate) standing: Option<Standing>,
    pub(crate) settled: bool,
    pub(crate) fatigue: Vec<[f64; 2]>,
    /// Coordinate and side of the groups that ask for relief.
    pub(crate) asking: Vec<(usize, usize)>,
}

impl LastSample {
    /// Takes in a sample.
    pub(crate) fn take(&mut self, sample: &Sample<'_>) {
        self.number += u64::from(!self.posture.is_empty());
        (self.time, self.settled) = (sample.time, sample.settled);
        for (own, of_sample) in [
            (&mut self.posture, sample.posture),
            (&mut self.external, sample.external),
            (&mut self.passive, sample.passive),
            (&mut self.load, sample.load),
        ] {
            of_sample.clone_into(own);
        }
        sample.fatigue.clone_into(&mut self.fatigue);
        self.standing = sample.standing.cloned();
        self.asking.clear();
        let asking = sample.asking.iter().enumerate();
        self.asking.extend(asking.filter_map(|(i, side)| side.map(|side| (i, side.index()))));
    }
}
