//! Holds the muscles that a file describes, and counts those that were read and those that were not.

use std::collections::BTreeMap;

use contrapposto::model::Model;
use contrapposto::muscle::{Location, Musculature};

use super::ModelIr;

/// Muscles of a file, with the indices of [`ModelIr::coordinates`] and [`ModelIr::segments`].
#[derive(Clone, Debug, Default)]
pub struct MusclesIr {
    /// Muscles that were read.
    pub musculature: Musculature,
    /// Numbers of things that were read, left out and refused, by kind.
    pub tally: MuscleTally,
}

/// Numbers of the muscles, path points, surfaces and springs of a file that were read, left out and refused, by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MuscleTally(pub BTreeMap<String, KindTally>);

/// Numbers of the things of one kind that were read, left out and refused.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct KindTally {
    /// Things that are part of the musculature.
    pub read: usize,
    /// The file switches them off, or nothing uses them.
    pub left_out: usize,
    /// Things that are not supported, or have no meaning.
    pub refused: usize,
    /// Reasons for which things were left out or refused, each once, with the number of things.
    pub reasons: BTreeMap<String, usize>,
}

impl MuscleTally {
    pub(crate) fn read(&mut self, kind: &str) {
        self.0.entry(kind.to_owned()).or_default().read += 1;
    }

    pub(crate) fn left_out(&mut self, kind: &str, why: &str) {
        let tally = self.0.entry(kind.to_owned()).or_default();
        tally.left_out += 1;
        *tally.reasons.entry(why.to_owned()).or_default() += 1;
    }

    pub(crate) fn refused(&mut self, kind: &str, why: String) {
        let tally = self.0.entry(kind.to_owned()).or_default();
        tally.refused += 1;
        *tally.reasons.entry(why).or_default() += 1;
    }
}

impl ModelIr {
    /// The muscles with the indices of the model. Segments have the same order in both.
    pub(super) fn musculature(&self, model: &Model) -> Musculature {
        let mut musculature = self.muscles.musculature.clone();
        let own = |coordinate: &mut usize| {
            let name = &self.coordinates[*coordinate].name;
            *coordinate = model.coordinate(name).unwrap_or(*coordinate);
        };
        for path in &mut musculature.paths.paths {
            path.tendon
                .iter_mut()
                .flat_map(|tendon| &mut tendon.coordinates)
                .for_each(|(coordinate, _)| own(coordinate));
        }
        for point in musculature.paths.paths.iter_mut().flat_map(|path| &mut path.points) {
            match &mut point.location {
                Location::Fixed(_) => {}
                Location::Conditional { coordinate, .. } => own(coordinate),
                Location::Moving(point) => point.coordinate.iter_mut().for_each(own),
            }
        }
        musculature
    }
}
