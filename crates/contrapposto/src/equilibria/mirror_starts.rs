//! Solves from the mirror images of postures: the body on its other leg.
//!
//! Where the two limbs of a pair have different roles, as a hand that works and a hand that rests, these limbs keep their angles.

use super::candidate::{Candidate, Worth};
use super::finder::Finder;
use super::hanging_limbs::{free_limbs, has_task};
use super::mirror::Mirror;
use super::search::{Search, Stage};
use super::solvers::{Start, Way};
use crate::tasks::PriorityLevel;

/// Best postures whose mirror images are converged from.
const MIRRORED: usize = 3;

impl Finder<'_> {
    /// Solves from the mirror image of each explored posture that takes little enough effort for an answer and whose image was not found itself.
    pub(super) fn explore_mirror_images(&mut self) {
        let images = self.images(&self.worth(Stage::Exploratory, Worth::ANSWER));
        let start = |image: Candidate| {
            let start = from_image(Stage::Exploratory, &image);
            Start { unless_found: Some(image), ..start }
        };
        self.solve_all(images.into_iter().map(start).collect());
    }

    /// Converges from the mirror images of the best postures.
    pub(super) fn mirror_best(&mut self) {
        let mut best = self.selected(Stage::Converged);
        best.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        let images = self.images(best.into_iter().take(MIRRORED).map(|i| &self.found[i]));
        let worth = images.first().map_or(f64::INFINITY, |best| Worth::START.limit(best.relaxed.effort));
        let start = |image| Start { most_effort: worth, ..from_image(Stage::Settled, image) };
        self.solve_all(images.iter().map(start).collect());
    }

    /// The mirror images of postures, where the body has them.
    fn images<'c>(&self, postures: impl IntoIterator<Item = &'c Candidate>) -> Vec<Candidate> {
        let Some(mirror) = Mirror::of(self.search.model) else { return vec![] };
        let kept = coordinates_of_unlike_limbs(self.search, &mirror);
        postures.into_iter().filter_map(|posture| posture.image(self.search.model, &mirror, &kept)).collect()
    }
}

/// The start at a mirror image.
fn from_image(stage: Stage, image: &Candidate) -> Start {
    let labels = vec![format!("mirror image of: {}", image.starts[0])];
    Start { way: Way::To(PriorityLevel::default()), ..Start::at(stage, image.relaxed.posture.clone(), labels) }
}

/// The coordinates of limbs that have another role than their partners: of the two, one has a support, a task or a load more.
fn coordinates_of_unlike_limbs(search: &Search<'_>, mirror: &Mirror) -> Vec<usize> {
    let model = search.model;
    let role = |limb: &[usize]| {
        let supported = search.supports.iter().any(|support| limb.contains(&support.segment));
        let loaded = search.loads.iter().any(|load| limb.contains(&load.segment));
        [supported, loaded, has_task(search, limb)]
    };
    let unlike = |limb: &Vec<usize>| {
        let partner: Vec<usize> = limb.iter().map(|&segment| mirror.segment(segment)).collect();
        role(limb) != role(&partner)
    };
    let limbs = free_limbs(model, &[]).into_iter().filter(unlike);
    let mobilities = limbs.flatten().filter_map(|segment| model.segments()[segment].mobility);
    let rates = mobilities.flat_map(|mobility| model.rates_of(mobility));
    rates.filter_map(|rate| model.rates()[rate].coordinate).collect()
}
