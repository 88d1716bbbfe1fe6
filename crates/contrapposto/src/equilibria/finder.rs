//! Makes the starts of a search, has them solved, and selects the different postures of least effort.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::candidate::{Candidate, Worth, keep_worth};
use super::description::describe;
use super::different_ways::DifferentWays;
use super::mirror::Mirror;
use super::other_places::other_places;
use super::outcome::{Equilibria, MOST_MINIMA, RelaxedPosture};
use super::raised_limbs::LimbsWithoutTask;
use super::scattered::scattered;
use super::search::{Aim, Search, SearchError, Stage};
use super::solvers::{Attempt, EVERYTHING, Outcome, Solvers, Start, Steps, Way};
use crate::batch;
use crate::contact::Missing;
use crate::kinematics::Kinematics;
use crate::posture::Posture;
use crate::posture_solver::{EngineError, Options};
use crate::tasks::PriorityLevel;

/// Times that goal angles are taken, each time from a better posture.
const ROUNDS: usize = 2;
/// Most postures with a limb held up from which limbs are let hang.
const HUNG: usize = 5;
/// Most local minima from which lower ones are sought where all ways to stand are wanted, those of least effort. Assumed.
const HOPPED_OF_ALL: usize = 3;
/// Most local minima from which lower ones are sought where only the posture of least effort is wanted. Assumed.
const HOPPED_TO_LEAST: usize = 5;
/// Distance of a task beyond that in the best posture, in its units, and slip of a support, m and rad, that are allowed to
/// postures of each stage.
const ALLOWED_ERROR: [f64; 4] = [0.02, 0.02, 1e-5, 1e-5];

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
    pub(super) solvers: Solvers<'a>,
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
    steps: Steps,
    /// A start was left out, since the budget was spent.
    cut: bool,
    minima: Vec<Posture>,
}

impl<'a> Finder<'a> {
    pub(super) fn new(
        search: &'a Search<'a>,
        options: Options,
        watch: &'a mut dyn FnMut(usize),
    ) -> Result<Self, SearchError> {
        Ok(Self {
            search,
            solvers: Solvers::new(search, options)?,
            limbs: LimbsWithoutTask::default(),
            found: vec![],
            fell: vec![],
            refused: None,
            starts: 0,
            sought: 0,
            watch,
            steps: Steps::default(),
            cut: false,
            minima: vec![],
        })
    }

    /// Work from which on no further start of a stage is begun.
    fn most_work(&self, stage: Stage) -> usize {
        match stage {
            Stage::Exploratory => self.search.most_work / 4 * 3,
            _ => self.search.most_work,
        }
    }

    /// Whether no further start may be begun.
    fn is_spent(&mut self, stage: Stage) -> bool {
        let spent = self.starts > 0 && self.steps.work >= self.most_work(stage);
        self.cut |= spent;
        spent
    }

    /// Finds the limbs that are not to be held up, and the depth to which they can hang.
    fn find_limbs_to_hang(&mut self) {
        let model = self.search.model;
        let Some(posture) = self.solvers.with_hanging_limbs(self.search.start, &mut self.steps) else { return };
        let [mut start, mut hanging] = [Kinematics::new(model), Kinematics::new(model)];
        if start.update(model, self.search.start).is_ok() && hanging.update(model, &posture).is_ok() {
            self.limbs = LimbsWithoutTask::of(self.search, &start, &hanging);
        }
    }

    /// Solves from all starts, a few steps each.
    fn explore(&mut self) -> Result<(), SearchError> {
        let places = other_places(self.search.model, self.search.supports).into_iter();
        let at_start = (PriorityLevel::default(), "the start".to_owned());
        let places = std::iter::once(at_start).chain(places.map(|(task, label)| (task.into(), label)));
        self.solvers.reach_from_start(&mut self.steps);
        self.solve_all(
            places.map(|(level, label)| self.exploratory(self.search.start, Way::To(level), label)).collect(),
        );
        let mut explored: Vec<Candidate> = vec![];
        for _ in 0..if self.is_told() { 1 } else { ROUNDS } {
            let Some(best) = self.best() else { break };
            if explored.iter().any(|known| known.is_same(&best)) {
                break;
            }
            self.explore_goals(&best.relaxed.posture)?;
            explored.push(best);
        }
        if !self.is_told() {
            self.explore_scattered();
            self.explore_mirror_images();
        }
        Ok(())
    }

    /// Whether postures of an earlier search stand in for exploring.
    pub(super) fn is_told(&self) -> bool {
        !self.search.aim.known().is_empty()
    }

    pub(super) fn exploratory(&self, from: &Posture, way: Way, label: String) -> Start {
        Start { way, ..Start::at(Stage::Exploratory, from.clone(), vec![label]) }
    }

    /// Descends from every different posture that was explored and is worth it, and from those that are known; seeks lower local minima from
    /// the different ones of least effort, and settles in others where all ways to stand are wanted.
    fn converge(&mut self) {
        let starts = self.starts;
        let mut explored: Vec<(Posture, Vec<String>)> =
            self.worth(Stage::Exploratory, Worth::START).into_iter().map(posture_and_labels).collect();
        let known = self.search.aim.known().iter();
        explored.extend(known.map(|posture| (posture.clone(), vec!["an earlier posture".to_owned()])));
        let mut before = self.begin_stage();
        self.solve_straight(Stage::Nearest, explored);
        let mut least = self.worth(Stage::Nearest, Worth::ANSWER);
        let near = self.begin_stage();
        if !near.is_empty() {
            before = near;
        }
        let all_ways = matches!(self.search.aim, Aim::Ways | Aim::WaysOnEitherSide);
        let hopped = if all_ways { HOPPED_OF_ALL } else { HOPPED_TO_LEAST };
        let others = least.split_off(hopped.min(least.len()));
        self.solve_straight(Stage::Converged, least.into_iter().map(posture_and_labels).collect());
        if all_ways {
            self.settle(others);
        }
        self.hang(if all_ways { HUNG } else { 0 });
        if all_ways {
            self.mirror_best();
        }
        self.minima = self.minima_with(&before);
        if self.found.is_empty() {
            self.found = before;
        }
        self.starts = starts;
    }

    /// The different local minima found, and those of `near` that differ from all of them, each from that of least effort first.
    fn minima_with(&self, near: &[Candidate]) -> Vec<Posture> {
        let by_effort = |a: &&Candidate, b: &&Candidate| a.compare(b);
        let mut found: Vec<&Candidate> = self.selected(Stage::Settled).into_iter().map(|i| &self.found[i]).collect();
        found.sort_by(by_effort);
        let mut others: Vec<&Candidate> =
            near.iter().filter(|near| !found.iter().any(|known| known.is_same(near))).collect();
        others.sort_by(by_effort);
        let minima = found.into_iter().chain(others).take(MOST_MINIMA);
        minima.map(|minimum| minimum.relaxed.posture.clone()).collect()
    }

    /// Solves in a stage from postures as they are.
    pub(super) fn solve_straight(&mut self, stage: Stage, from: Vec<(Posture, Vec<String>)>) {
        let start = |(from, labels)| Start::at(stage, from, labels);
        self.solve_all(from.into_iter().map(start).collect());
    }

    /// The postures of a stage that are worth going on from, that of least effort first.
    pub(super) fn worth(&self, stage: Stage, worth: Worth) -> Vec<Candidate> {
        let mut candidates = self.selected(stage);
        candidates.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        keep_worth(&self.found, &mut candidates, worth);
        candidates.into_iter().map(|i| self.found[i].clone()).collect()
    }

    /// Begins a stage with nothing found; returns what was found before.
    fn begin_stage(&mut self) -> Vec<Candidate> {
        self.starts = 0;
        std::mem::take(&mut self.found)
    }

    /// Solves from starts of one stage, and takes the attempts in their order. With several threads they are solved beforehand: those that
    /// turn out to be needless, since the budget is spent or their posture was found meanwhile, are passed over as if they had not been solved.
    pub(super) fn solve_all(&mut self, starts: Vec<Start>) {
        let attempts = self.solved_beforehand(&starts);
        for (start, attempt) in starts.into_iter().zip(attempts) {
            if self.is_spent(start.stage) {
                return;
            }
            if !start.unless_found.as_ref().is_some_and(|image| self.found.iter().any(|known| known.is_same(image))) {
                let attempt = attempt.unwrap_or_else(|| self.solvers.attempt(&start, &self.limbs));
                self.take(start, attempt);
            }
        }
    }

    /// The attempt from each start, on the threads of the search; `None` with one thread, and where the budget is spent by the starts before.
    fn solved_beforehand(&self, starts: &[Start]) -> Vec<Option<Attempt>> {
        let (threads, Some(first)) = (self.search.threads, starts.first()) else { return vec![] };
        if threads <= 1 || starts.len() == 1 {
            return starts.iter().map(|_| None).collect();
        }
        let (solvers, limbs, nothing_yet) = (&self.solvers, &self.limbs, self.starts == 0);
        let (work, most) = (AtomicUsize::new(self.steps.work), self.most_work(first.stage));
        let solve = |solvers: &mut Solvers<'_>, start: &Start| {
            let is_spent = work.load(Ordering::Relaxed) >= most && !(nothing_yet && std::ptr::eq(start, first));
            (!is_spent).then(|| {
                let attempt = solvers.attempt(start, limbs);
                work.fetch_add(attempt.work(), Ordering::Relaxed);
                attempt
            })
        };
        batch::over(starts, threads, || solvers.clone(), solve)
    }

    /// Takes the posture of an attempt, if it is new or better.
    fn take(&mut self, start: Start, attempt: Attempt) {
        self.steps += attempt.before;
        let Some(solved) = attempt.solved else { return };
        self.starts += 1;
        self.sought += 1;
        (self.watch)(self.sought);
        self.steps += solved.steps;
        let mut new = match solved.outcome {
            Outcome::Stands(candidate) => *candidate,
            Outcome::Fell(missing) => return self.fell.push(missing),
            Outcome::Refused(error) => {
                self.fell.push(EVERYTHING);
                self.refused.get_or_insert(error);
                return;
            }
        };
        let Some(known) = self.found.iter_mut().find(|known| known.is_same(&new)) else {
            new.starts = start.labels;
            self.found.push(new);
            return;
        };
        let slot = self.solvers.slot;
        let allowed = known.distance(slot) + ALLOWED_ERROR[Stage::Converged as usize];
        let better = new.compare(known).is_lt() && new.distance(slot) <= allowed;
        let mut starts = std::mem::take(&mut known.starts);
        starts.extend(start.labels);
        if better {
            *known = new;
        }
        known.starts = starts;
    }

    /// Solves from starts that are scattered over the ranges of the joints, where the body stands in some posture: of a body that falls, the
    /// missing force of an ordinary posture is told.
    fn explore_scattered(&mut self) {
        if self.found.is_empty() {
            return;
        }
        let Search { model, start, locked, scattered: count, .. } = *self.search;
        let from = |k| scattered(model, start, locked, k);
        let start =
            |k| self.exploratory(&from(k), Way::To(PriorityLevel::default()), format!("scattered start {}", k + 1));
        self.solve_all((0..count).map(start).collect());
    }

    /// Converges with hanging limbs from the first posture, and from the first `most` of those in which a limb is held up: exploratory steps would leave
    /// limbs that hang.
    fn hang(&mut self, most: usize) {
        let mut known = self.selected(Stage::Converged);
        known.sort_by(|&a, &b| self.found[a].compare(&self.found[b]));
        let raised = known.iter().skip(1).filter(|&&i| self.found[i].raised_limbs > 0).take(most);
        let worth = known.first().map_or(f64::INFINITY, |&first| Worth::START.limit(self.found[first].relaxed.effort));
        let start = |&i: &usize| {
            let known = &self.found[i];
            let labels = vec!["limbs that carry nothing hang".to_owned()];
            let start = Start::at(Stage::Converged, known.relaxed.posture.clone(), labels);
            Start {
                way: Way::Hanging,
                most_effort: if known.raised_limbs == 0 { worth } else { f64::INFINITY },
                ..start
            }
        };
        self.solve_all(known.first().into_iter().chain(raised).map(start).collect());
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
        for level in 0..=self.solvers.slot {
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
            let size = |missing: &Missing| libm::hypot(missing.force, missing.moment);
            let finite = self.fell.into_iter().filter(|missing| size(missing).is_finite());
            let least = finite.min_by(|a, b| size(a).total_cmp(&size(b)));
            let refused = self.refused.map(SearchError::Relax);
            return Err(least
                .map(SearchError::CannotStand)
                .or(refused)
                .unwrap_or(SearchError::CannotStand(EVERYTHING)));
        }
        // Of postures that yielded, slipped or have not converged one is shown where there is no other.
        let yielded = self.found.len() - self.selected(Stage::Converged).len().max(1);
        let worth = self.worth_an_answer();
        let mirror = matches!(self.search.aim, Aim::WaysOnEitherSide).then(|| Mirror::of(self.search.model)).flatten();
        let mut ways = DifferentWays::new(self.search, mirror);
        let answers: Vec<usize> = worth.iter().copied().filter(|&i| ways.take(&self.found[i])).collect();
        let raised = self.found.len() - yielded - worth.len();
        let engine = self.solvers.engine(Stage::Converged);
        let mut postures = vec![];
        for (i, way) in answers.into_iter().zip(&ways.answers) {
            let Candidate { relaxed, starts, .. } = self.found[i].clone();
            let posture = describe(self.search, engine, relaxed, starts)?;
            postures.push(RelaxedPosture { mirrored: way.mirrored, ..posture });
        }
        let (starts, fell, steps, work, cut) =
            (self.starts, self.fell.len(), self.steps.steps, self.steps.work, self.cut);
        let minima = self.minima;
        Ok(Equilibria { postures, minima, starts, fell, yielded, alike: ways.alike + raised, steps, work, cut })
    }
}

/// The posture in which a solve of the next stage starts, and its labels.
pub(super) fn posture_and_labels(found: Candidate) -> (Posture, Vec<String>) {
    (found.relaxed.posture, found.starts)
}
