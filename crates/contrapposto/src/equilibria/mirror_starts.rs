//! Solves from the mirror images of postures: the body on its other leg.
//!
//! Where the two limbs of a pair have different roles, as a hand that works and a hand that rests, these limbs keep their angles.

use super::candidate::Candidate;
use super::finder::Finder;
use super::hanging_limbs::{free_limbs, has_task};
use super::mirror::Mirror;
use super::search::{Search, Stage};
use super::solvers::{Start, Way};

/// Best postures whose mirror images are converged from.
const MIRRORED: usize = 3;

impl Finder<'_> {
    /// Solves from the mirror image of each explored posture.
    pub(super) fn explore_mirror_images(&mut self) {
        let Some(mirror) = Mirror::of(self.search.model) else { return };
        let kept = coordinates_of_unlike_limbs(self.search, &mirror);
        let images = self.found.iter().filter_map(|found| found.image(self.search.model, &mirror, &kept));
        self.solve_all(images.map(|image| from_image(Stage::Exploratory, image)).collect());
    }

    /// Converges from the mirror images of the best postures.
    pub(super) fn mirror_best(&mut self) {
        let Some(mirror) = Mirror::of(self.search.model) else { return };
        let kept = coordinates_of_unlike_limbs(self.search, &mirror);
        let mut best = self.selected(Stage::Converged);
        best.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        best.truncate(MIRRORED);
        let images = best.iter().filter_map(|&i| self.found[i].image(self.search.model, &mirror, &kept));
        self.solve_all(
            images.map(|image| Start { unless_found: None, ..from_image(Stage::Converged, image) }).collect(),
        );
    }
}

/// The start at a mirror image, which is left out where its posture was found already.
fn from_image(stage: Stage, image: Candidate) -> Start {
    let labels = vec![format!("mirror image of: {}", image.starts[0])];
    let (from, way) = (image.relaxed.posture.clone(), Way::ToTasks(vec![]));
    Start { stage, from, way, labels, unless_found: Some(image) }
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
