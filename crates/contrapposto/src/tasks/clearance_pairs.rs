//! Lists the pairs that a body keeps apart: its own parts, and parts and things.
//!
//! Of the parts that may meet ([`Model::meeting_shapes`]) those pairs are left out that overlap in the default posture: of a heavy
//! body the upper arms and the abdomen, say. A part that carries the body, and a part with a sole, is left out with all things, since
//! it touches them; its neighbours are left out with blocks. Against a half-space both ends of a part count, each as a sphere, so
//! that a part that lies flat has two rows; ends of two parts in one place count once, and of the neighbour of a part that carries
//! the body the end at their joint does not.

use super::clearance::{Clearance, ClearancePair, Obstacle};
use super::thing::Thing;
use crate::kinematics::Kinematics;
use crate::model::{Capsule, Model};

/// Least distance, m.
const MARGIN: f64 = 0.0;

/// Distance from which on a pair has no row, m: farther than a hand moves in one step of a run, 0.5 degrees of every joint.
const ACTIVATION: f64 = 0.1;

/// Ends of two parts nearer to each other than this, m, are in one place.
const SAME_END: f64 = 1e-6;

impl Clearance {
    /// The parts of a body apart from each other and from `things`; parts of the `carrying` segments may touch things. `None` for a
    /// body without shapes.
    pub fn of_body(model: &Model, things: &[Thing], carrying: &[usize]) -> Option<Self> {
        let kinematics = Kinematics::new(model);
        let capsule = |shape: usize| model.shapes()[shape].capsule;
        let mut pairs = vec![];
        for &(a, b) in model.meeting_shapes() {
            let pair = ClearancePair { part: capsule(a), other: Obstacle::Part(capsule(b)) };
            if pair.distance(model, &kinematics) >= 0.0 {
                pairs.push(pair);
            }
        }
        for thing in things {
            let free = model.shapes().iter().filter(|shape| !shape.sole).map(|shape| shape.capsule);
            let free: Vec<Capsule> = free.filter(|capsule| !carrying.contains(&capsule.segment)).collect();
            let parts: Vec<Capsule> = match thing {
                Thing::HalfSpace { .. } => ends(model, &kinematics, &free, carrying),
                Thing::Block { .. } => {
                    let joined = |part: &Capsule| carrying.iter().any(|c| joint(model, part.segment, *c).is_some());
                    free.into_iter().filter(|part| !joined(part)).collect()
                }
            };
            pairs.extend(parts.into_iter().map(|part| ClearancePair { part, other: Obstacle::Thing(*thing) }));
        }
        (!pairs.is_empty()).then_some(Self { pairs, margin: MARGIN, activation: ACTIVATION })
    }

    /// The same without the pairs of things and the `carrying` segments, and without those of blocks and neighbours of these segments.
    #[must_use]
    pub fn with_carrying(&self, model: &Model, carrying: &[usize]) -> Self {
        let part_carries = |pair: &ClearancePair| {
            let neighbour = || carrying.iter().any(|c| joint(model, pair.part.segment, *c).is_some());
            match pair.other {
                Obstacle::Part(_) => false,
                Obstacle::Thing(thing) => {
                    carrying.contains(&pair.part.segment) || (matches!(thing, Thing::Block { .. }) && neighbour())
                }
            }
        };
        Self { pairs: self.pairs.iter().filter(|pair| !part_carries(pair)).copied().collect(), ..self.clone() }
    }
}

/// Spheres at the ends of `parts`, none of which carries the body, for rows against a half-space: of ends in one place the largest, and
/// none at joints with the `carrying` segments.
fn ends(model: &Model, kinematics: &Kinematics, parts: &[Capsule], carrying: &[usize]) -> Vec<Capsule> {
    let mut spheres: Vec<Capsule> = vec![];
    let place = |sphere: &Capsule| kinematics.station(model, sphere.segment, sphere.ends[0]);
    for sphere in parts.iter().flat_map(|part| part.ends.map(|end| Capsule { ends: [end; 2], ..*part })) {
        match spheres.iter_mut().find(|other| (place(other) - place(&sphere)).norm() < SAME_END) {
            Some(other) if other.radius < sphere.radius => *other = sphere,
            Some(_) => {}
            None => spheres.push(sphere),
        }
    }
    let mut segments: Vec<usize> = parts.iter().map(|part| part.segment).collect();
    segments.dedup();
    for (&segment, &carrier) in
        segments.iter().flat_map(|segment| carrying.iter().map(move |carrier| (segment, carrier)))
    {
        let Some(child) = joint(model, segment, carrier) else { continue };
        let center = kinematics.station(model, child, model.segments()[child].in_segment.translation.vector);
        let from = |i: usize| (place(&spheres[i]) - center).norm();
        let own = (0..spheres.len()).filter(|i| spheres[*i].segment == segment);
        if let Some(nearest) = own.min_by(|a, b| from(*a).total_cmp(&from(*b))) {
            spheres.remove(nearest);
        }
    }
    spheres
}

/// The one of two segments whose joint connects it with the other; segments without shapes between them are passed over.
fn joint(model: &Model, a: usize, b: usize) -> Option<usize> {
    let above = |child: usize, wanted: usize| {
        let mut next = model.segments()[child].parent;
        while let Some(segment) = next {
            let has_shape = model.shapes().iter().any(|shape| shape.capsule.segment == segment);
            if segment == wanted || has_shape {
                return segment == wanted;
            }
            next = model.segments()[segment].parent;
        }
        false
    };
    if above(a, b) {
        Some(a)
    } else if above(b, a) {
        Some(b)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Adult, Sex, adult};

    /// Every pair of the reference bodies is apart as they stand, so that none is left out; both sides have the same pairs.
    #[test]
    fn reference_adults_have_all_pairs_and_the_same_on_both_sides() {
        for sex in [Sex::Male, Sex::Female] {
            let model = adult(&Adult::reference(sex)).unwrap();
            let clearance = Clearance::of_body(&model, &[], &[]).unwrap();
            let name = |i: usize| &model.shapes()[i].name;
            let kinematics = Kinematics::new(&model);
            for (pair, (a, b)) in clearance.pairs.iter().zip(model.meeting_shapes()) {
                let distance = pair.distance(&model, &kinematics);
                println!("{sex:?} {} {}: {distance:.3} m", name(*a), name(*b));
            }
            assert_eq!(clearance.pairs.len(), model.meeting_shapes().len(), "{sex:?}");
            let side = |end: &str| {
                model
                    .meeting_shapes()
                    .iter()
                    .filter(|(a, b)| [name(*a), name(*b)].iter().any(|name| name.ends_with(end)))
                    .count()
            };
            assert_eq!(side("_r"), side("_l"));
        }
    }

    /// Palms on the ground: hands and the wrist ends of the forearms may touch it; a block may be touched by the forearms, too.
    #[test]
    fn carrying_hands_and_the_ends_next_to_them_may_touch_things() {
        let model = adult(&Adult::default()).unwrap();
        let hands = ["hand_r", "hand_l"].map(|name| model.segment(name).unwrap());
        let kinematics = Kinematics::new(&model);
        let things = |carrying: &[usize], thing: Thing| -> Vec<Capsule> {
            let pairs = Clearance::of_body(&model, &[thing], carrying).unwrap().pairs;
            pairs.iter().filter(|pair| matches!(pair.other, Obstacle::Thing(_))).map(|pair| pair.part).collect()
        };
        let (all, floor) = (things(&[], Thing::floor(0.0)), things(&hands, Thing::floor(0.0)));
        println!("{} and {} spheres", all.len(), floor.len());
        // Wrist and finger tip of each side.
        assert_eq!(floor.len() + 4, all.len());
        let wrist = kinematics.station(&model, hands[0], nalgebra::Vector3::zeros());
        let near = |part: &&Capsule| (kinematics.station(&model, part.segment, part.ends[0]) - wrist).norm() < 1e-6;
        assert!(all.iter().any(|part| near(&part)) && !floor.iter().any(|part| near(&part)));
        let half = nalgebra::Vector3::new(0.3, 0.02, 0.6);
        let block = Thing::Block { placement: nalgebra::Isometry3::translation(0.5, 0.7, 0.0), half };
        let forearm = model.segment("radius_r").unwrap();
        let has = |parts: &[Capsule], segment: usize| parts.iter().any(|part| part.segment == segment);
        let (all, held) = (things(&[], block), things(&hands, block));
        assert!(has(&all, forearm) && has(&all, hands[0]) && !has(&held, forearm) && !has(&held, hands[0]));
        assert!(has(&held, model.segment("humerus_r").unwrap()));
    }
}
