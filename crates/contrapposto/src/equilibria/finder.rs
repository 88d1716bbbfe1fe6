//! Makes the starts of a search, solves from each of them, and selects the different postures of least effort.

use super::candidate::{Candidate, Worth, keep_worth, places};
use super::description::{describe, relative_torques};
use super::hanging_limbs::{hanging_limbs, idle_segments, in_mid_range};
use super::other_places::other_places;
use super::outcome::Equilibria;
use super::raised_limbs::LimbsWithoutTask;
use super::scattered::scattered;
use super::search::{Search, SearchError, Stage};
use super::ways_to_stand::DifferentWays;
use crate::contact::{Condition, Missing};
use crate::effort::hessian::HessianModel;
use crate::kinematics::Kinematics;
use crate::posture::Posture;
use crate::posture_solver::{Engine, EngineError, Options};
use crate::tasks::PriorityLevel;
use crate::tasks::{Effort, Task};

/// Times that goal angles are taken, each time from a better posture.
const ROUNDS: usize = 2;
/// Most postures with a limb held up from which limbs are let hang.
const HUNG: usize = 5;
/// Steps of an exploratory solve.
const EXPLORATORY_STEPS: usize = 20;
/// Steps of an approach to the tasks.
const APPROACH_STEPS: usize = 40;
/// Distance of a task beyond that in the best posture, in its units, and slip of a support, m and rad, that are allowed to
/// exploratory and to converged postures.
const ALLOWED_ERROR: [f64; 2] = [0.02, 1e-5];
/// Missing contact force and moment that are allowed to exploratory and to converged postures, body weights (times 1 m).
const ALLOWED_MISSING: [f64; 2] = [1e-3, 1e-8];
/// Change of every rate below which the approach to the tasks ends, rad or m.
const APPROACH_TOLERANCE: f64 = 1e-6;
/// Distance of the ends of limbs from hanging up to which an approach is not tried in another way, m.
const HANGING: f64 = 0.01;
/// Missing forces of a posture whose numbers are not finite.
const EVERYTHING: Missing = Missing { force: f64::INFINITY, moment: f64::INFINITY, condition: Condition::Other };

/// As [`equilibria`](super::equilibria); `watch` is told the number of postures that have been sought so far, each time that another one is.
///
/// # Errors
/// The same.
pub fn equilibria_watched(
    search: &Search<'_>,
    options: Options,
    watch: &mut dyn FnMut(usize),
) -> Result<Equilibria, SearchError> {
    let mut finder = Finder::new(search, options, watch)?;
    finder.find_limbs_to_hang();
    finder.explore()?;
    finder.converge();
    finder.finish()
}

/// Engines and what they have found.
pub(super) struct Finder<'a> {
    pub(super) search: &'a Search<'a>,
    /// For exploratory and for converging solves.
    pub(super) engines: [Engine<'a>; 2],
    /// Without effort.
    approach: Engine<'a>,
    /// Index of the level of goal angles among the engines' levels.
    pub(super) slot: usize,
    /// Limbs that are not to be held up.
    limbs: LimbsWithoutTask,
    pub(super) found: Vec<Candidate>,
    /// Missing contact forces where the body fell.
    fell: Vec<Missing>,
    /// Error of the first posture whose numbers are not finite.
    refused: Option<EngineError>,
    starts: usize,
    /// Postures sought in all stages, and who is told.
    sought: usize,
    watch: &'a mut dyn FnMut(usize),
    pub(super) steps: usize,
    /// Work beyond the steps.
    pub(super) changes: usize,
    /// A start was left out, since the budget was spent.
    cut: bool,
}

impl<'a> Finder<'a> {
    fn new(search: &'a Search<'a>, options: Options, watch: &'a mut dyn FnMut(usize)) -> Result<Self, SearchError> {
        let mut levels = search.goals.to_vec();
        let asks = |level: &PriorityLevel| level.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
        let slot = levels.iter().position(asks).unwrap_or(levels.len());
        if slot == levels.len() {
            levels.push(Task::Effort(Effort::whole(search.model)).into());
        }
        levels.insert(slot, PriorityLevel::default());
        // Exploratory steps of priorities pass over shallow minima, in which a descent ends.
        let engine = |max_steps: usize, local_minima: usize, levels: &[PriorityLevel]| {
            let (supports, levels) = (search.supports.to_vec(), levels.to_vec());
            let options = Options { max_steps, local_minima, ..options };
            let mut engine =
                Engine::with_supports(search.model, search.start, supports, levels, search.loads, options)?;
            search.locked.iter().for_each(|&rate| engine.lock(rate));
            search.limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
            Ok::<_, SearchError>(engine)
        };
        let exploratory = EXPLORATORY_STEPS.min(options.max_steps);
        let (most, minima) = (options.max_steps, options.local_minima);
        let mut engines = [engine(exploratory, 0, &levels)?, engine(most, minima, &levels)?];
        engines[0].set_hessian_model(HessianModel::Partial);
        let approach = engine(APPROACH_STEPS, 0, &levels[..=slot])?;
        Ok(Self {
            search,
            engines,
            approach,
            slot,
            limbs: LimbsWithoutTask::default(),
            found: vec![],
            fell: vec![],
            refused: None,
            starts: 0,
            sought: 0,
            watch,
            steps: 0,
            changes: 0,
            cut: false,
        })
    }

    fn work(&self) -> usize {
        self.steps + self.changes
    }

    /// Whether no further start may be begun.
    pub(super) fn is_spent(&mut self, stage: Stage) -> bool {
        let most = match stage {
            Stage::Exploratory => self.search.most_work / 4 * 3,
            Stage::Converged => self.search.most_work,
        };
        let spent = self.starts > 0 && self.work() >= most;
        self.cut |= spent;
        spent
    }

    /// Finds the limbs that are not to be held up, and the depth to which they can hang.
    fn find_limbs_to_hang(&mut self) {
        let Some(posture) = self.with_hanging_limbs(self.search.start) else { return };
        let model = self.search.model;
        let [mut start, mut hanging] = [Kinematics::new(model), Kinematics::new(model)];
        if start.update(model, self.search.start).is_ok() && hanging.update(model, &posture).is_ok() {
            self.limbs = LimbsWithoutTask::of(self.search, &start, &hanging);
        }
    }

    /// Solves from all starts, a few steps each.
    fn explore(&mut self) -> Result<(), SearchError> {
        self.solve_from_tasks(self.search.start, "the start".to_owned());
        self.explore_places();
        let mut explored: Vec<Candidate> = vec![];
        for _ in 0..ROUNDS {
            let Some(best) = self.best() else { break };
            if explored.iter().any(|known| known.is_same(&best)) {
                break;
            }
            self.explore_goals(&best.relaxed.posture)?;
            explored.push(best);
        }
        self.explore_scattered();
        self.explore_mirror_images();
        Ok(())
    }

    /// Converges from every different posture that was explored and is worth it, from that of least effort first.
    fn converge(&mut self) {
        let mut candidates = self.selected(Stage::Exploratory);
        candidates.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        keep_worth(&self.found, &mut candidates, Worth::START);
        let mut explored = std::mem::take(&mut self.found);
        let starts = std::mem::take(&mut self.starts);
        for i in candidates {
            let Candidate { relaxed, starts, .. } = explored[i].clone();
            self.solve(Stage::Converged, &relaxed.posture, starts);
        }
        self.hang();
        self.mirror_best();
        if self.found.is_empty() {
            self.found.append(&mut explored);
        }
        self.starts = starts;
    }

    /// Solves from a posture with the engine of a stage, and keeps the result if it is new or better.
    pub(super) fn solve(&mut self, stage: Stage, from: &Posture, starts: Vec<String>) {
        if self.is_spent(stage) {
            return;
        }
        let (model, engine) = (self.search.model, &mut self.engines[stage as usize]);
        engine.levels_mut()[self.slot].half_spaces.clear();
        self.starts += 1;
        self.sought += 1;
        (self.watch)(self.sought);
        let mut relaxed = match engine.solve_watched(from, |step, _| self.changes += step.work() - 1) {
            Ok(relaxed) => relaxed,
            Err(error) => {
                self.fell.push(EVERYTHING);
                self.refused.get_or_insert(error);
                return;
            }
        };
        self.steps += relaxed.steps;
        let missing = engine.contact().missing(model, engine.torques().kinematics());
        let allowed = ALLOWED_MISSING[stage as usize] * model.mass() * model.gravity().norm();
        if let Some(missing) = missing.filter(|missing| missing.force.max(missing.moment) > allowed) {
            self.fell.push(missing);
            return;
        }
        relaxed.levels.remove(self.slot);
        let contact = engine.contact();
        let supports = self.search.supports.iter().enumerate();
        let excess = supports.map(|(i, support)| (contact.share(i) - support.share_max).max(0.0)).sum();
        let (relative_torques, places) =
            (relative_torques(model, engine), places(model, engine.torques().kinematics()));
        let raised_limbs = self.limbs.raised(self.search, engine.torques().kinematics());
        let new = Candidate { relaxed, excess, starts, raised_limbs, relative_torques, places };
        let Some(known) = self.found.iter_mut().find(|known| known.is_same(&new)) else {
            self.found.push(new);
            return;
        };
        let allowed = known.distance(self.slot) + ALLOWED_ERROR[Stage::Converged as usize];
        let better = new.compare(known).is_lt() && new.distance(self.slot) <= allowed;
        let mut starts = std::mem::take(&mut known.starts);
        starts.extend_from_slice(&new.starts);
        if better {
            *known = new;
        }
        known.starts = starts;
    }

    /// Solves from other places of each free support.
    fn explore_places(&mut self) {
        for (task, label) in other_places(self.search.model, self.search.supports) {
            if self.is_spent(Stage::Exploratory) {
                return;
            }
            self.approach.levels_mut()[self.slot].tasks = vec![task];
            let (_, from) = self.approached(self.search.start);
            self.solve(Stage::Exploratory, &from, vec![label]);
        }
    }

    /// Solves from starts that are scattered over the ranges of the joints, where the body stands in some posture: of a body that falls, the
    /// missing force of an ordinary posture is told.
    fn explore_scattered(&mut self) {
        if self.found.is_empty() {
            return;
        }
        for k in 0..self.search.scattered {
            let from = scattered(self.search.model, self.search.start, self.search.locked, k);
            self.solve_from_tasks(&from, format!("scattered start {}", k + 1));
        }
    }

    /// Converges with hanging limbs from the first posture, and from the first of those in which a limb is held up: exploratory steps would leave
    /// limbs that hang.
    fn hang(&mut self) {
        let mut known = self.selected(Stage::Converged);
        known.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        let raised = known.iter().skip(1).filter(|&&i| self.found[i].raised_limbs > 0).take(HUNG);
        let from = known.first().into_iter().chain(raised).map(|&i| self.found[i].relaxed.posture.clone());
        for posture in from.collect::<Vec<_>>() {
            if let Some(from) = self.with_hanging_limbs(&posture) {
                self.solve(Stage::Converged, &from, vec!["limbs that carry nothing hang".to_owned()]);
            }
        }
    }

    /// The posture with limbs that hang as far as tasks allow.
    fn with_hanging_limbs(&mut self, posture: &Posture) -> Option<Posture> {
        let (model, supports) = (self.search.model, self.search.supports);
        let tasks = hanging_limbs(model, supports, posture).ok()?;
        let (distance, near) = self.approached_with(&tasks, posture);
        if distance > HANGING {
            // Along the shortest turn a joint may meet the end of its range: the other way begins in the middle of the ranges.
            let middle = in_mid_range(model, supports, &near);
            let (other, posture) = self.approached_with(&tasks, &middle);
            if other < distance - HANGING {
                return Some(posture);
            }
        }
        Some(near)
    }

    /// Moves to the tasks without regard to effort first: from afar the two would obstruct each other.
    pub(super) fn solve_from_tasks(&mut self, from: &Posture, start: String) {
        if self.is_spent(Stage::Exploratory) {
            return;
        }
        let (_, posture) = self.approached(from);
        self.solve(Stage::Exploratory, &posture, vec![start]);
    }

    /// [`Self::approached`], with these tasks in the last level.
    fn approached_with(&mut self, tasks: &[Task], from: &Posture) -> (f64, Posture) {
        self.approach.levels_mut()[self.slot].tasks = tasks.to_vec();
        self.approached(from)
    }

    /// The posture moved to the tasks, and below them to those of the approach's last level, which are removed, and its distance from them.
    pub(super) fn approached(&mut self, from: &Posture) -> (f64, Posture) {
        let mut posture = from.clone();
        self.approach.restart();
        for _ in 0..APPROACH_STEPS {
            self.steps += 1;
            match self.approach.step(&mut posture) {
                Ok(step) if step.largest > APPROACH_TOLERANCE => self.changes += step.work() - 1,
                _ => break,
            }
        }
        let distance = self.approach.evaluate(&posture).map_or(f64::INFINITY, |()| self.approach.error(self.slot));
        self.approach.levels_mut()[self.slot].tasks.clear();
        (distance, posture)
    }

    /// The posture of least effort so far.
    fn best(&self) -> Option<Candidate> {
        let found = self.selected(Stage::Exploratory).into_iter().map(|i| &self.found[i]);
        found.min_by(|a, b| a.compare(b)).cloned()
    }

    /// Postures with supports in place and, level by level, tasks as near as in any other posture.
    pub(super) fn selected(&self, stage: Stage) -> Vec<usize> {
        let allowed = ALLOWED_ERROR[stage as usize];
        let mut selected: Vec<usize> =
            (0..self.found.len()).filter(|&i| self.found[i].relaxed.slip.length() <= allowed).collect();
        for level in 0..=self.slot {
            let error = |i: usize| {
                let found = &self.found[i];
                if level == 0 { found.excess } else { found.relaxed.levels[level - 1].length }
            };
            let least = selected.iter().map(|&i| error(i)).fold(f64::INFINITY, f64::min);
            selected.retain(|&i| error(i) <= least + allowed);
        }
        selected
    }

    /// The different postures, that of least effort first.
    fn finish(mut self) -> Result<Equilibria, SearchError> {
        if self.found.is_empty() {
            let size = |missing: &Missing| missing.force.hypot(missing.moment);
            let finite = self.fell.into_iter().filter(|missing| size(missing).is_finite());
            let least = finite.min_by(|a, b| size(a).total_cmp(&size(b)));
            let refused = self.refused.map(SearchError::Relax);
            return Err(least
                .map(SearchError::CannotStand)
                .or(refused)
                .unwrap_or(SearchError::CannotStand(EVERYTHING)));
        }
        let mut selected = self.selected(Stage::Converged);
        if selected.is_empty() {
            // All slip or have not converged: the one that slips least, whose figures say so.
            let slip = |i: &usize| self.found[*i].relaxed.slip.length();
            selected.extend((0..self.found.len()).min_by(|a, b| slip(a).total_cmp(&slip(b))));
        }
        selected.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        let yielded = self.found.len() - selected.len();
        let (least, all) = (self.found[selected[0]].raised_limbs, selected.len());
        selected.retain(|&i| self.found[i].raised_limbs == least);
        keep_worth(&self.found, &mut selected, Worth::ANSWER);
        let raised = all - selected.len();
        let (mut answers, engine) =
            (DifferentWays::new(idle_segments(self.search)), &mut self.engines[Stage::Converged as usize]);
        for i in selected {
            let Candidate { relaxed, starts, .. } = self.found[i].clone();
            let posture = describe(self.search, engine, relaxed, starts)?;
            answers.take(self.search.model, engine.torques().kinematics(), posture);
        }
        let DifferentWays { postures, alike, .. } = answers;
        let (starts, fell, steps, work, cut) = (self.starts, self.fell.len(), self.steps, self.work(), self.cut);
        Ok(Equilibria { postures, starts, fell, yielded, alike: alike + raised, steps, work, cut })
    }
}
