//! Solves from one start of a search. The result depends on the search and the start alone, so that starts may be solved in any order.

use super::candidate::{Candidate, places};
use super::description::relative_torques;
use super::hanging_limbs::{hanging_limbs, in_mid_range};
use super::raised_limbs::LimbsWithoutTask;
use super::search::{Search, SearchError, Stage};
use super::way_to_stand::WayToStand;
use crate::contact::{Condition, Missing};
use crate::effort::hessian::HessianModel;
use crate::posture::Posture;
use crate::posture_solver::{Engine, EngineError, Options, first_difference};
use crate::tasks::{Effort, PriorityLevel, Task};

/// Steps of an exploratory solve.
const EXPLORATORY_STEPS: usize = 20;
/// Largest change of a rate below which an exploratory solve ends, rad or m: a descent takes its posture on from there.
const EXPLORATORY_TOLERANCE: f64 = 1e-5;
/// Steps of an approach to the tasks.
const APPROACH_STEPS: usize = 20;
/// Missing contact force and moment that are allowed to postures of each stage, body weights (times 1 m).
const ALLOWED_MISSING: [f64; 4] = [1e-3, 1e-3, 1e-8, 1e-8];
/// Change of every rate below which the approach to the tasks ends, rad or m.
const APPROACH_TOLERANCE: f64 = 1e-6;
/// A start is given up where its way ends farther from the tasks by so much than the way from the start of the search, in their units. Assumed.
const FARTHER: f64 = 0.05;
/// Distance of the ends of limbs from hanging up to which an approach is not tried in another way, m.
const HANGING: f64 = 0.01;

/// A start of a search.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) stage: Stage,
    pub(super) from: Posture,
    /// Way to the posture where effort begins to count.
    pub(super) way: Way,
    /// In words: how it was found.
    pub(super) labels: Vec<String>,
    /// The start is left out where this posture was found already.
    pub(super) unless_found: Option<Candidate>,
    /// The start is given up where the local minimum of effort near it takes more.
    pub(super) most_effort: f64,
}

impl Start {
    /// The start at a posture as it is.
    pub(super) fn at(stage: Stage, from: Posture, labels: Vec<String>) -> Self {
        Self { stage, from, way: Way::Nothing, labels, unless_found: None, most_effort: f64::INFINITY }
    }
}

/// Way from the start to the posture where effort begins to count.
#[derive(Clone, Debug)]
pub(super) enum Way {
    Nothing,
    /// The body moves to the tasks of the search, and below them to these tasks and goal angles: from afar tasks and effort would obstruct each
    /// other. The start is given up where this ends farther from the tasks than it does from the start of the search.
    To(PriorityLevel),
    /// The limbs that carry nothing hang as far as tasks allow.
    Hanging,
}

/// Steps of solves, and their work ([`Engine::work`]).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Steps {
    pub(super) steps: usize,
    pub(super) work: usize,
}

impl std::ops::AddAssign for Steps {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.work += other.work;
    }
}

/// Result of a start.
#[derive(Debug)]
pub(super) struct Attempt {
    /// Of the way to the posture where effort begins to count.
    pub(super) before: Steps,
    /// `None` where the start was given up.
    pub(super) solved: Option<Solved>,
}

#[derive(Debug)]
pub(super) struct Solved {
    pub(super) steps: Steps,
    pub(super) outcome: Outcome,
}

#[derive(Debug)]
pub(super) enum Outcome {
    /// The supports hold the body.
    Stands(Box<Candidate>),
    Fell(Missing),
    Refused(EngineError),
}

impl Attempt {
    pub(super) fn work(&self) -> usize {
        self.before.work + self.solved.as_ref().map_or(0, |solved| solved.steps.work)
    }
}

/// The engines of one thread.
#[derive(Clone, Debug)]
pub(super) struct Solvers<'a> {
    search: &'a Search<'a>,
    /// For exploratory solves, for settling and for converging.
    engines: [Engine<'a>; 3],
    /// Without effort.
    approach: Engine<'a>,
    /// Index of the level below the tasks of the search that a way may ask for, among the engines' levels.
    pub(super) slot: usize,
    /// By level above that: distance from the tasks at which the way from the start of the search ends. Empty until it is known.
    reached: Vec<f64>,
}

impl<'a> Solvers<'a> {
    pub(super) fn new(search: &'a Search<'a>, options: Options) -> Result<Self, SearchError> {
        let mut levels = search.goals.to_vec();
        let asks = |level: &PriorityLevel| level.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
        let slot = levels.iter().position(asks).unwrap_or(levels.len());
        if slot == levels.len() {
            levels.push(Task::Effort(Effort::whole(search.model)).into());
        }
        levels.insert(slot, PriorityLevel::default());
        // Exploratory steps of priorities pass over shallow minima, in which a descent ends.
        let engine = |options: Options, levels: &[PriorityLevel]| {
            let (supports, levels) = (search.supports.to_vec(), levels.to_vec());
            let mut engine =
                Engine::with_supports(search.model, search.start, supports, levels, search.loads, options)?;
            search.locked.iter().for_each(|&rate| engine.lock(rate));
            search.limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
            Ok::<_, SearchError>(engine)
        };
        let exploratory = Options {
            max_steps: EXPLORATORY_STEPS.min(options.max_steps),
            local_minima: 0,
            step_tolerance: EXPLORATORY_TOLERANCE.max(options.step_tolerance),
            ..options
        };
        let settling = Options { local_minima: options.local_minima.min(1), ..options };
        let mut engines = [engine(exploratory, &levels)?, engine(settling, &levels)?, engine(options, &levels)?];
        engines[0].set_hessian_model(HessianModel::Partial);
        let mut approach = engine(Options { local_minima: 0, ..options }, &levels[..=slot])?;
        approach.leave_effort_of_forces_out();
        Ok(Self { search, engines, approach, slot, reached: vec![] })
    }

    /// The engine of a stage.
    pub(super) fn engine(&mut self, stage: Stage) -> &mut Engine<'a> {
        &mut self.engines[match stage {
            Stage::Exploratory => 0,
            Stage::Nearest | Stage::Settled => 1,
            Stage::Converged => 2,
        }]
    }

    /// Finds out how near the tasks are from the start of the search.
    pub(super) fn reach_from_start(&mut self, steps: &mut Steps) {
        self.approached(&PriorityLevel::default(), self.search.start, steps);
        self.reached = (0..self.slot).map(|level| self.approach.error(level)).collect();
    }

    /// Solves from a start.
    pub(super) fn attempt(&mut self, start: &Start, limbs: &LimbsWithoutTask) -> Attempt {
        let mut before = Steps::default();
        let from = match &start.way {
            Way::Nothing => Some(start.from.clone()),
            Way::To(level) => self.near_tasks(level, &start.from, &mut before),
            Way::Hanging => self.with_hanging_limbs(&start.from, &mut before),
        };
        let from = from.and_then(|from| self.worth_solving(start, from, &mut before));
        Attempt { before, solved: from.map(|from| self.solve(start.stage, &from, limbs)) }
    }

    /// The posture moved to the tasks of the search, and below them to a level; `None` where that ends farther from the tasks than the way from
    /// the start of the search does.
    fn near_tasks(&mut self, below: &PriorityLevel, from: &Posture, steps: &mut Steps) -> Option<Posture> {
        let (_, posture) = self.approached(below, from, steps);
        let errors = (0..self.slot).map(|level| self.approach.error(level));
        (first_difference(errors, self.reached.iter().copied(), FARTHER) <= 0.0).then_some(posture)
    }

    /// The posture itself, or, where the effort of the start is limited, the local minimum near it; `None` where that takes more.
    fn worth_solving(&mut self, start: &Start, from: Posture, steps: &mut Steps) -> Option<Posture> {
        if start.most_effort == f64::INFINITY {
            return Some(from);
        }
        let engine = self.engine(Stage::Nearest);
        let before = engine.work();
        let near = engine.near_minimum(&from);
        steps.work += engine.work() - before;
        let near = near.ok()?;
        steps.steps += near.steps;
        (near.effort <= start.most_effort).then_some(near.posture)
    }

    /// Solves from a posture with the engine of a stage.
    fn solve(&mut self, stage: Stage, from: &Posture, limbs: &LimbsWithoutTask) -> Solved {
        let (search, slot) = (self.search, self.slot);
        let engine = self.engine(stage);
        let before = engine.work();
        let solved = match stage {
            Stage::Nearest => engine.near_minimum(from),
            _ => engine.solve(from),
        };
        let mut steps = Steps { steps: 0, work: engine.work() - before };
        let mut relaxed = match solved {
            Ok(relaxed) => relaxed,
            Err(error) => return Solved { steps, outcome: Outcome::Refused(error) },
        };
        steps.steps = relaxed.steps;
        let (model, kinematics, contact) = (search.model, engine.torques().kinematics(), engine.contact());
        let allowed = ALLOWED_MISSING[stage as usize] * model.mass() * model.gravity().norm();
        let missing = contact.missing(model, kinematics);
        if let Some(missing) = missing.filter(|missing| missing.force.max(missing.moment) > allowed) {
            return Solved { steps, outcome: Outcome::Fell(missing) };
        }
        relaxed.levels.remove(slot);
        let shares = (0..search.supports.len()).map(|i| contact.share(i)).collect();
        let candidate = Candidate {
            excess: contact.beyond_shares(),
            raised_limbs: limbs.raised(search, kinematics),
            relative_torques: relative_torques(model, engine),
            places: places(model, kinematics),
            way: WayToStand::of(model, kinematics, shares),
            starts: vec![],
            relaxed,
        };
        Solved { steps, outcome: Outcome::Stands(Box::new(candidate)) }
    }

    /// The posture with limbs that hang as far as tasks allow.
    pub(super) fn with_hanging_limbs(&mut self, posture: &Posture, steps: &mut Steps) -> Option<Posture> {
        let (model, supports) = (self.search.model, self.search.supports);
        let tasks = hanging_limbs(model, supports, posture).ok()?;
        let hanging = PriorityLevel { tasks, ..PriorityLevel::default() };
        let (distance, near) = self.approached(&hanging, posture, steps);
        if distance > HANGING {
            // Along the shortest turn a joint may meet the end of its range: the other way begins in the middle of the ranges.
            let middle = in_mid_range(model, supports, &near);
            let (other, posture) = self.approached(&hanging, &middle, steps);
            if other < distance - HANGING {
                return Some(posture);
            }
        }
        Some(near)
    }

    /// The posture moved to the tasks of the search, and below them to a level, and its distance from that.
    fn approached(&mut self, below: &PriorityLevel, from: &Posture, steps: &mut Steps) -> (f64, Posture) {
        self.approach.levels_mut()[self.slot].clone_from(below);
        let mut posture = from.clone();
        self.approach.restart();
        let before = self.approach.work();
        for _ in 0..APPROACH_STEPS {
            steps.steps += 1;
            match self.approach.step(&mut posture) {
                Ok(step) if step.largest > APPROACH_TOLERANCE => {}
                _ => break,
            }
        }
        steps.work += self.approach.work() - before;
        let distance = self.approach.evaluate(&posture).map_or(f64::INFINITY, |()| self.approach.error(self.slot));
        self.approach.levels_mut()[self.slot] = PriorityLevel::default();
        (distance, posture)
    }
}

/// Missing forces of a posture whose numbers are not finite.
pub(super) const EVERYTHING: Missing =
    Missing { force: f64::INFINITY, moment: f64::INFINITY, condition: Condition::Other };
