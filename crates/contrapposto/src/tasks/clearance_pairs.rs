//! Lists the pairs that a body keeps apart: its own parts, and parts and things.
//!
//! Of the parts that may meet ([`Model::meeting_shapes`]) those pairs are left out that overlap in the default posture: of a heavy
//! body the upper arms and the abdomen, say. A part that carries the body,
//! and a part with a sole, is left out with all things, since it touches them.
//! Against a half-space both ends of a part count, each as a sphere, so that a part that lies flat has two rows; ends of two parts
//! in one place count once.

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
            let parts = match thing {
                Thing::HalfSpace { .. } => ends(model, &kinematics, &free),
                Thing::Block { .. } => free,
            };
            pairs.extend(parts.into_iter().map(|part| ClearancePair { part, other: Obstacle::Thing(*thing) }));
        }
        (!pairs.is_empty()).then_some(Self { pairs, margin: MARGIN, activation: ACTIVATION })
    }
}

/// Spheres at the ends of the parts; of ends in one place the largest.
fn ends(model: &Model, kinematics: &Kinematics, parts: &[Capsule]) -> Vec<Capsule> {
    let mut spheres: Vec<Capsule> = vec![];
    let place = |sphere: &Capsule| kinematics.station(model, sphere.segment, sphere.ends[0]);
    for sphere in parts.iter().flat_map(|part| part.ends.map(|end| Capsule { ends: [end; 2], ..*part })) {
        match spheres.iter_mut().find(|other| (place(other) - place(&sphere)).norm() < SAME_END) {
            Some(other) if other.radius < sphere.radius => *other = sphere,
            Some(_) => {}
            None => spheres.push(sphere),
        }
    }
    spheres
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
}
