//! What do tests of a descent stand on? The adult on both feet with a load in a hand that is on its way, in one posture after
//! the other, with some joints locked and any contact forces.

#![allow(clippy::unwrap_used, reason = "tests")]

use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::iterate::Iterate;
use super::problem::EffortProblem;
use crate::contact::{ContactForces, Support};
use crate::model::{Adult, Model, adult};
use crate::statics::{FixedIn, Load, LoadKind};
use crate::tasks::PriorityLevel;
use crate::tasks::body::{Body, Needs};
use crate::tasks::{Effort, Placement, Point, Task};

pub(crate) struct StandingAdult {
    pub(crate) model: Model,
    contact: ContactForces,
    effort: PriorityLevel,
    above: PriorityLevel,
    loads: Vec<Load>,
    free: Vec<usize>,
}

impl StandingAdult {
    pub(crate) fn new() -> Self {
        let model = adult(&Adult::default()).unwrap();
        let support = |name: &str| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support { segment, corners, normal: Vector3::y(), friction: 0.6, share_max: 1.0 }
        };
        let contact = ContactForces::new(&model, vec![support("calcn_r"), support("calcn_l")]).unwrap();
        let hand = model.segment("hand_r").unwrap();
        let (point, target) = (Vector3::new(0.01, -0.1, 0.02), Vector3::new(0.4, 1.2, 0.3));
        let above = Task::Point(Point { segment: hand, point, target, axes: [true; 3] }).into();
        let kind = LoadKind::Force(Vector3::new(5.0, -30.0, 10.0), FixedIn::World);
        let loads = vec![Load { segment: hand, point, kind }];
        let effort = Task::Effort(Effort::whole(&model)).into();
        let free = (0..model.rates().len()).filter(|rate| rate % 7 != 3).collect();
        Self { contact, effort, above, loads, free, model }
    }

    /// Shows `look` so many postures inside all ranges; feet are to stay where they are in each.
    pub(crate) fn each(
        &self,
        random: &mut Pcg64Mcg,
        count: usize,
        mut look: impl FnMut(&mut Pcg64Mcg, &EffortProblem<'_>, &Iterate),
    ) {
        for _ in 0..count {
            let mut posture = self.model.default_posture();
            for (value, coordinate) in posture.values_mut().iter_mut().zip(self.model.coordinates()) {
                let (lower, upper) = coordinate.range;
                let wide = upper - lower;
                *value += random.random_range(-0.25..0.25) * wide.min(1.0);
                *value = value.clamp(lower + 0.15 * wide, upper - 0.15 * wide);
            }
            let mut body = Body::new(&self.model);
            body.update(&self.model, &posture, &[], Needs::default()).unwrap();
            let mut places = PriorityLevel::default();
            for support in self.contact.supports() {
                let target = body.kinematics().placement(&self.model, support.segment);
                let task = Placement { segment: support.segment, point: Vector3::zeros(), target };
                places.tasks.push(Task::Placement(task));
            }
            let ask = EffortProblem {
                model: &self.model,
                places: &places,
                above: std::slice::from_ref(&self.above),
                effort: &self.effort,
                loads: &self.loads,
                free: &self.free,
                contact: &self.contact,
            };
            let mut site = Iterate::new(&self.model);
            site.posture = posture;
            let force = |i: usize| if i.is_multiple_of(3) { 0.0..0.25 } else { -0.05..0.05 };
            site.forces = (0..self.contact.forces().len()).map(|i| random.random_range(force(i))).collect();
            site.see(&ask).unwrap();
            look(random, &ask, &site);
        }
    }
}

/// The site after `by` times the step.
pub(crate) fn moved(site: &Iterate, ask: &EffortProblem<'_>, step: &[f64], by: f64) -> Iterate {
    let mut moved = site.clone();
    let mut by_rate = vec![0.0; ask.model.rates().len()];
    ask.free.iter().zip(step).for_each(|(rate, d)| by_rate[*rate] = by * d);
    moved.posture.displace(ask.model, &by_rate);
    moved.forces.iter_mut().zip(&step[ask.free.len()..]).for_each(|(force, d)| *force += by * d);
    moved.see(ask).unwrap();
    moved
}

/// Did no group hand over to another? Where one does, effort has no second derivative.
pub(crate) fn alike(a: &Iterate, b: &Iterate) -> bool {
    a.errors.iter().zip(&b.errors).all(|(a, b)| (*a > 0.0) == (*b > 0.0))
}
