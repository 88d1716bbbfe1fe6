//! Builds the problem of least effort of the part of a body that moves no support.
//!
//! On a standing body that part is everything above the pelvis. Its torques do not depend on the contact forces, so local minima
//! can be searched for in a smaller problem, on the reduced model in which all other joints are fixed.

use super::iterate::Iterate;
use super::problem::EffortProblem;
use crate::contact::{ContactForces, rates_that_move};
use crate::joint_torques::JointTorquesError;
use crate::kinematics::Kinematics;
use crate::model::{Model, reduced};
use crate::passive::PassiveLaw;
use crate::posture::Posture;
use crate::tasks::PriorityLevel;
use crate::tasks::{Effort, Task};

/// The reduced model, and its levels.
#[derive(Debug)]
pub(crate) struct ReducedProblem {
    pub(crate) model: Model,
    free: Vec<usize>,
    effort: PriorityLevel,
    /// No supports: an empty level.
    places: PriorityLevel,
    limits: PriorityLevel,
    above: Vec<PriorityLevel>,
    shortfall: Vec<f64>,
    contact: ContactForces,
}

/// Holds the angles of fixed three-axis joints in the laws of muscles: the reduced model does not know these joints.
fn hold_slices(model: &Model, values: &[f64], reduced: &mut Model) {
    for joint in model.three_axis_joints() {
        if reduced.three_axis_joint_of(joint.coordinates[0]).is_some() {
            continue;
        }
        for (i, angle) in joint.coordinates.into_iter().zip(joint.orientation(values).angles.values) {
            let (low, high) = model.coordinates()[i].range;
            for coordinate in &mut reduced.coordinates {
                if let Some(PassiveLaw::Slice(slice)) = &mut coordinate.passive {
                    slice.hold(i, angle.max(low).min(high));
                }
            }
        }
    }
}

impl ReducedProblem {
    /// The reduced problem of a body in `posture`; without supports all free rates remain. `None` where no coordinate with muscles
    /// moves without moving a support, or where the root is free and no support holds it.
    ///
    /// # Errors
    /// [`JointTorquesError`] when the posture does not fit the model.
    pub(crate) fn of(problem: &EffortProblem<'_>, posture: &Posture) -> Result<Option<Self>, JointTorquesError> {
        let model = problem.model;
        let fixed = rates_that_move(model, problem.contact.supports());
        let rate = |c: &usize| model.coordinates()[*c].rate;
        let coordinates = problem.effort_coordinates();
        let coordinates: Vec<usize> = coordinates.filter(|c| rate(c).is_some_and(|rate| !fixed[rate])).collect();
        let free = || problem.free.iter().filter(|rate| !fixed[**rate]);
        let falls = free().any(|rate| problem.contact.root().contains(rate));
        if falls || coordinates.is_empty() || free().next().is_none() {
            return Ok(None);
        }
        let mut moves = vec![false; model.rates().len()];
        free().copied().chain(coordinates.iter().filter_map(rate)).for_each(|rate| moves[rate] = true);
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture)?;
        let (mut reduced, places) = reduced(model, &kinematics.rotations, &kinematics.origins, &moves);
        hold_slices(model, kinematics.values(), &mut reduced);
        // The regions of free supports: nothing here moves a support.
        let moves = |task: &&Task| !matches!(task, Task::Bounds(_));
        let limits = problem.limits.tasks.iter().filter(moves).cloned().collect();
        let mut above = problem.above.to_vec();
        for task in above.iter_mut().flat_map(|level| &mut level.tasks) {
            if let Task::Posture(task) = task {
                // A coordinate that remains only because its joint turns about three axes cannot be moved to its goal.
                for (rate, weight) in task.weights.iter_mut().enumerate() {
                    *weight = if free().any(|free| *free == rate) { *weight } else { 0.0 };
                }
                let mut place = places.iter();
                task.weights.retain(|_| place.next().is_some_and(Option::is_some));
            }
        }
        let mut reduced = Self {
            free: free().filter_map(|rate| places[*rate]).collect(),
            contact: ContactForces::without_supports(&reduced),
            model: reduced,
            effort: Task::Effort(Effort { coordinates }).into(),
            places: PriorityLevel::default(),
            limits: PriorityLevel { tasks: limits, ..PriorityLevel::default() },
            above,
            shortfall: vec![],
        };
        if !problem.shortfall.is_empty() {
            let part = reduced.problem(problem);
            let mut iterate = Iterate::new(&reduced.model);
            iterate.posture.values_mut().copy_from_slice(posture.values());
            iterate.evaluate(&part)?;
            reduced.shortfall = iterate.shortfall(&part);
        }
        Ok(Some(reduced))
    }

    /// The problem to be solved, under the loads of the whole `problem`.
    pub(crate) fn problem<'b>(&'b self, problem: &EffortProblem<'b>) -> EffortProblem<'b> {
        EffortProblem {
            model: &self.model,
            places: &self.places,
            limits: &self.limits,
            above: &self.above,
            shortfall: &self.shortfall,
            effort: &self.effort,
            free: &self.free,
            contact: &self.contact,
            ..*problem
        }
    }
}

#[cfg(test)]
#[path = "../../tests/trees/mod.rs"]
#[allow(dead_code, unreachable_pub, clippy::print_stdout, clippy::unwrap_used, reason = "the test uses a part")]
mod trees;

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::standing_adult::{StandingAdult, evaluated};
    use super::*;
    use crate::kinematics::CenterOfMass;
    use crate::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};

    const SEED: u64 = 37;

    /// Relative loads of the reduced problem and their slopes are those of the whole body under any contact forces.
    #[test]
    fn relative_loads_of_the_reduced_problem_are_those_of_the_whole_body() {
        let adult = StandingAdult::new();
        let mut worst = 0f64;
        adult.each_posture(&mut Pcg64Mcg::new(SEED.into()), 20, |_, problem, whole| {
            let reduced = ReducedProblem::of(problem, &whole.posture).unwrap().unwrap();
            assert!((11..problem.free.len()).contains(&reduced.free.len()));
            let part = reduced.problem(problem);
            let iterate = evaluated(&part, &whole.posture);
            assert!(!iterate.residual.is_empty() && iterate.constraints.len() == 3 * part.unknowns());
            let of_part = |c: usize| part.effort_coordinates().position(|own| own == c);
            for (c, (error, row)) in problem
                .effort_coordinates()
                .zip(whole.residual.iter().zip(whole.jacobian.chunks_exact(problem.unknowns())))
            {
                let forces = &row[problem.free.len()..];
                let Some(own) = of_part(c) else { continue };
                assert!(forces.iter().all(|entry| *entry == 0.0), "{}", problem.model.coordinates()[c].name);
                assert!(error.is_finite() && iterate.residual[own].is_finite());
                worst = worst.max((iterate.residual[own] - error).abs() / (1.0 + error.abs()));
                let name = |model: &Model, rate: usize| model.rates()[rate].name.clone();
                let of_own = &iterate.jacobian[own * part.unknowns()..];
                for (rate, slope) in reduced.free.iter().zip(of_own) {
                    let same =
                        |rate_of_whole: &&usize| name(problem.model, **rate_of_whole) == name(&reduced.model, *rate);
                    let place = problem.free.iter().position(|rate| same(&rate)).unwrap();
                    worst = worst.max((slope - row[place]).abs() / (1.0 + slope.abs()));
                }
            }
        });
        println!("seed {SEED}: off by {worst:.1e} at most");
        assert!(worst < 1e-12, "{worst}");
    }

    /// With the errors of a posture kept, the levels above effort are met there in the whole problem and in the reduced one; what holds the body is
    /// asked for as before.
    #[test]
    fn levels_are_met_where_their_errors_are_kept() {
        let mut most = 0f64;
        StandingAdult::new().each_posture(&mut Pcg64Mcg::new(SEED.into()), 20, |_, problem, whole| {
            let shortfall = whole.shortfall(problem);
            let keeps = EffortProblem { shortfall: &shortfall, ..*problem };
            let reduced = ReducedProblem::of(&keeps, &whole.posture).unwrap().unwrap();
            let rows = |levels: &[PriorityLevel]| levels.iter().map(PriorityLevel::rows).sum::<usize>();
            let held = problem.contact.root().len() + problem.places.rows();
            let mut kept = Iterate::new(problem.model);
            (kept.posture, kept.forces) = (whole.posture.clone(), whole.forces.clone());
            kept.evaluate(&keeps).unwrap();
            let part = evaluated(&reduced.problem(&keeps), &whole.posture);
            for (limits, own) in [(&kept.lower, &whole.lower), (&kept.upper, &whole.upper)] {
                assert_eq!(limits[..held], own[..held]);
                assert_eq!(limits[held + rows(problem.above)..], own[held + rows(problem.above)..]);
                assert!(limits[held..held + rows(problem.above)].iter().all(|limit| limit.abs() < 1e-12));
                most = own[held..held + rows(problem.above)].iter().fold(most, |most, limit| most.max(limit.abs()));
            }
            assert!(part.violation() < 1e-12, "seed {SEED}: {}", part.violation());
        });
        assert!(most > 0.01, "seed {SEED}: {most}");
    }

    /// Placements, torques and gradients by rate and entry, and the centre of mass.
    fn evaluate_statics(
        model: &Model,
        posture: &crate::posture::Posture,
        loads: &[Load],
    ) -> (Vec<f64>, Vec<f64>, Gradient) {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).unwrap();
        let mut torque = ExternalTorque::new(model);
        torque.update(model, &kinematics, loads).unwrap();
        let mut gradient = Gradient::new(model);
        torque.gradient(model, &kinematics, &mut gradient);
        for (i, j) in (0..gradient.size().pow(2)).map(|k| (k / gradient.size(), k % gradient.size())) {
            let off = (gradient.get(i, j) - gradient.get(j, i)).abs();
            assert!(!gradient.is_symmetric() || off <= 1e-9 * (1.0 + gradient.get(i, j).abs()), "{off}");
        }
        let mut center = CenterOfMass::new(model);
        center.update(model, &kinematics);
        let mut places: Vec<f64> = center.position().iter().flatten().copied().collect();
        for segment in 0..model.segments().len() {
            let corner = [0.3, -0.2, 0.1].into();
            places.extend(kinematics.station(model, segment, corner).iter());
            places.extend(kinematics.direction(model, segment, corner).iter());
        }
        (places, torque.torques().to_vec(), gradient)
    }

    /// After equal motions of the remaining joints the reduced model has the placements, torques and gradients of the whole model.
    #[test]
    fn random_tree_with_random_joints_fixed_has_the_statics_of_the_whole_tree() {
        let mut random = trees::random("weld");
        let (mut worst, mut gone) = (0f64, 0);
        for _ in 0..200 {
            let segments = random.random_range(1..12);
            let model = trees::tree(&mut random, segments, true);
            let (n, m) = (model.rates().len(), model.segments().len());
            let posture = trees::posture(&mut random, &model);
            let moves: Vec<bool> = (0..n).map(|_| random.random_range(0..2) == 0).collect();
            let mut kinematics = Kinematics::new(&model);
            kinematics.update(&model, &posture).unwrap();
            let (reduced, places) = reduced(&model, &kinematics.rotations, &kinematics.origins, &moves);
            let follows = |rate: usize| model.rates()[rate].coordinate.is_some_and(|c| model.is_dependent(c));
            assert!((0..n).all(|rate| !moves[rate] || places[rate].is_some() || follows(rate)));
            gone += n - reduced.rates().len();
            let loads: Vec<Load> = (0..3)
                .map(|k| {
                    let (force, point) = (trees::vector(&mut random, 50.0), trees::vector(&mut random, 0.3));
                    let kind = match k {
                        0 => LoadKind::Force(force, FixedIn::World),
                        1 => LoadKind::Force(force, FixedIn::Segment),
                        _ => LoadKind::Couple(force, FixedIn::World),
                    };
                    Load { segment: random.random_range(0..m), point, kind }
                })
                .collect();
            let step: Vec<f64> =
                moves.iter().map(|moves| if *moves { random.random_range(-1.0..1.0) } else { 0.0 }).collect();
            let mut short = vec![0.0; reduced.rates().len()];
            places.iter().zip(&step).for_each(|(place, by)| place.iter().for_each(|place| short[*place] = *by));
            let (mut whole, mut part) = (posture.clone(), posture.clone());
            whole.displace(&model, &step);
            part.displace(&reduced, &short);
            let (whole, part) = (evaluate_statics(&model, &whole, &loads), evaluate_statics(&reduced, &part, &loads));
            let mut compare = |a: f64, b: f64| {
                assert!(a.is_finite() && b.is_finite(), "{a} {b}");
                worst = worst.max((a - b).abs() / (1.0 + a.abs()));
            };
            assert_eq!(whole.0.len(), part.0.len());
            whole.0.iter().zip(&part.0).for_each(|(a, b)| compare(*a, *b));
            for (i, place) in places.iter().enumerate() {
                let Some(row) = *place else { continue };
                compare(whole.1[i], part.1[row]);
                for (j, place) in places.iter().enumerate() {
                    place.iter().for_each(|column| compare(whole.2.get(i, j), part.2.get(row, *column)));
                }
            }
        }
        println!("off by {worst:.1e} at most, {gone} rates fixed");
        assert!(worst < 1e-10 && gone > 500, "{worst} {gone}");
    }
}
