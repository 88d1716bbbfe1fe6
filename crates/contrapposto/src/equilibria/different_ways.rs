//! Decides which of the postures that a search has found are its answers: the first of each way to stand ([`WayToStand`]), five at most.
//!
//! A posture in which a group would need more than its strength is no answer where another posture needs less. The same with left and right
//! exchanged, at the same effort, is one way to stand where that is asked for.

use super::candidate::Candidate;
use super::hanging_limbs::idle_segments;
use super::mirror::Mirror;
use super::search::Search;
use super::way_to_stand::WayToStand;

/// Difference between the efforts of two mirror images, as a share: both sides of a symmetric task take the same, but for where steps end.
const SAME_EFFORT: f64 = 0.01;

/// Most postures of an answer.
pub(super) const MOST_POSTURES: usize = 5;

/// Decides which of the postures found are an answer: the first of each way to stand.
#[derive(Debug)]
pub(super) struct DifferentWays {
    /// By segment: its joint does not count.
    idle: Vec<bool>,
    /// Segments of the supports.
    supports: Vec<usize>,
    /// Set where mirror images are one way to stand.
    mirror: Option<Mirror>,
    pub(super) answers: Vec<Answer>,
    /// Postures left out.
    pub(super) alike: usize,
}

/// The first posture of a way to stand.
#[derive(Debug)]
pub(super) struct Answer {
    way: WayToStand,
    effort: f64,
    /// The same with left and right exchanged was left out.
    pub(super) mirrored: bool,
}

impl DifferentWays {
    /// `mirror`: where mirror images are one way to stand.
    pub(super) fn new(search: &Search<'_>, mirror: Option<Mirror>) -> Self {
        let supports = search.supports.iter().map(|support| support.segment).collect();
        Self { idle: idle_segments(search), supports, mirror, answers: vec![], alike: 0 }
    }

    /// Takes the next posture, of more effort than those before; returns whether it is an answer.
    pub(super) fn take(&mut self, found: &Candidate) -> bool {
        let (way, effort) = (&found.way, found.relaxed.effort);
        let is_known = |way: &WayToStand| self.answers.iter().position(|known| known.way.is_like(way, &self.idle));
        let is_near = |known: &usize| effort <= (1.0 + SAME_EFFORT) * self.answers[*known].effort;
        let image = self.mirror.as_ref().and_then(|mirror| way.image(mirror, &self.supports));
        let mirrored = image.and_then(|image| is_known(&image)).filter(is_near);
        let known = is_known(way);
        if let (None, Some(known)) = (known, mirrored) {
            self.answers[known].mirrored = true;
        }
        let has_room = self.answers.len() < MOST_POSTURES;
        let is_new = has_room && found.is_held() && known.is_none() && mirrored.is_none();
        let is_answer = self.answers.is_empty() || is_new;
        if is_answer {
            self.answers.push(Answer { way: way.clone(), effort, mirrored: false });
        } else {
            self.alike += 1;
        }
        is_answer
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::model::{Adult, adult};

    /// The arms (degrees) of the ways among postures with these arms and loads, and the number of postures left out.
    fn ways(all: &[(f64, f64)]) -> (Vec<f64>, usize) {
        let model = adult(&Adult::default()).unwrap();
        let idle = vec![false; model.segments().len()];
        let mut ways = DifferentWays { idle, supports: vec![], mirror: None, answers: vec![], alike: 0 };
        let taken =
            all.iter().filter(|(degrees, load)| ways.take(&Candidate::with_arm(&model, *degrees, (0.0, *load))));
        let arms: Vec<f64> = taken.map(|(degrees, _)| *degrees).collect();
        (arms, ways.alike)
    }

    #[test]
    fn a_posture_that_is_known_beyond_strength_or_a_sixth_one_is_no_other_way_to_stand() {
        assert_eq!(ways(&[(0.0, 0.5), (2.0, 0.5), (40.0, 0.5), (41.0, 0.5)]), (vec![0.0, 40.0], 2));
        assert_eq!(ways(&[(0.0, 0.5), (40.0, 1.1), (80.0, 1.0)]), (vec![0.0, 80.0], 1));
        assert_eq!(ways(&[(0.0, 1.1)]), (vec![0.0], 0), "where no posture needs less");
        let seven: Vec<(f64, f64)> = (0..7).map(|k| (20.0 * f64::from(k), 0.5)).collect();
        assert_eq!(ways(&seven), (vec![0.0, 20.0, 40.0, 60.0, 80.0], 2));
    }
}
