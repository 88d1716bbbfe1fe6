//! Provides problems of least effort to the tests: the adult on both feet with a load in a hand that reaches, in random postures
//! with random contact forces, some joints locked, the left foot free to shift and turn.

#![allow(clippy::unwrap_used, reason = "tests")]

use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::iterate::Iterate;
use super::problem::EffortProblem;
use crate::contact::{ContactForces, Place, Region, Support};
use crate::joint_torques::{JointTorques, Quantities};
use crate::model::{Adult, Model, adult};
use crate::posture::Posture;
use crate::statics::{FixedIn, Load, LoadKind};
use crate::tasks::PriorityLevel;
use crate::tasks::{Effort, Point, Task, held_place};

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
        let free = Place::Free(Region { corners: vec![], turn: (-0.5, 0.5) });
        let support = |name: &str| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support {
                segment,
                corners,
                normal: Vector3::y(),
                friction: 0.6,
                share_max: 1.0,
                place: if name == "calcn_l" { free.clone() } else { Place::Fixed },
            }
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

    /// Calls `test` with `count` random postures inside all ranges; in each the feet are to stay where they are.
    pub(crate) fn each_posture(
        &self,
        random: &mut Pcg64Mcg,
        count: usize,
        mut test: impl FnMut(&mut Pcg64Mcg, &EffortProblem<'_>, &Iterate),
    ) {
        for _ in 0..count {
            let mut posture = self.model.default_posture();
            for (value, coordinate) in posture.values_mut().iter_mut().zip(self.model.coordinates()) {
                let (lower, upper) = coordinate.range;
                let wide = upper - lower;
                *value += random.random_range(-0.25..0.25) * wide.min(1.0);
                *value = value.clamp(lower + 0.15 * wide, upper - 0.15 * wide);
            }
            let mut body = JointTorques::new(&self.model);
            body.update(&self.model, &posture, &[], Quantities::default()).unwrap();
            let mut places = PriorityLevel::default();
            for support in self.contact.supports() {
                places.tasks.push(held_place(support, &self.model, body.kinematics()));
            }
            let problem = EffortProblem {
                model: &self.model,
                places: &places,
                limits: &PriorityLevel::default(),
                above: std::slice::from_ref(&self.above),
                shortfall: &[],
                effort: &self.effort,
                loads: &self.loads,
                free: &self.free,
                contact: &self.contact,
            };
            let mut iterate = Iterate::new(&self.model);
            iterate.posture = posture;
            let force = |i: usize| if i.is_multiple_of(3) { 0.0..0.25 } else { -0.05..0.05 };
            iterate.forces = (0..self.contact.forces().len()).map(|i| random.random_range(force(i))).collect();
            iterate.evaluate(&problem).unwrap();
            test(random, &problem, &iterate);
        }
    }
}

/// The iterate after `by` times the step.
pub(super) fn displaced(iterate: &Iterate, problem: &EffortProblem<'_>, step: &[f64], by: f64) -> Iterate {
    let mut displaced = iterate.clone();
    let mut by_rate = vec![0.0; problem.model.rates().len()];
    problem.free.iter().zip(step).for_each(|(rate, d)| by_rate[*rate] = by * d);
    displaced.posture.displace(problem.model, &by_rate);
    displaced.forces.iter_mut().zip(&step[problem.free.len()..]).for_each(|(force, d)| *force += by * d);
    displaced.evaluate(problem).unwrap();
    displaced
}

/// The problem evaluated in a posture without contact forces.
pub(super) fn evaluated(problem: &EffortProblem<'_>, posture: &Posture) -> Iterate {
    let mut iterate = Iterate::new(problem.model);
    iterate.posture = posture.clone();
    iterate.evaluate(problem).unwrap();
    iterate
}

/// Whether every coordinate has the same active muscle group in both iterates. Where the group changes, effort has no second
/// derivative.
pub(super) fn same_groups(a: &Iterate, b: &Iterate) -> bool {
    a.residual.iter().zip(&b.residual).all(|(a, b)| (*a > 0.0) == (*b > 0.0))
}
