//! How are the starts of [`super::equilibria`] made, and which of the postures they lead to count?

use super::equilibria::{
    Carried, Equilibria, Hanging, ROUNDS, RelaxedPosture, SAME, SCOUT, SINGLE, Search, SearchError, Work,
};
use super::mirror::Mirror;
use super::stability::stability;
use crate::constraint::HalfSpace;
use crate::contact::{Condition, Missing};
use crate::hybrid::{Problem, Strategy, minimise};
use crate::model::{CoordinateKind, Side};
use crate::posture::Posture;
use crate::posture_solver::{Engine, EngineError, Options, SolvedPosture};
use crate::tasks::PriorityLevel;
use crate::tasks::{Effort, Task};

/// What a task may be farther away than in the best posture, in its units, and how far a support may slip, m and rad: of postures
/// that have settled, and of those on their way.
const YIELDED: [f64; 2] = [1e-5, 0.02];
/// What supports may fall short of by the first steps, and by all of them, body weights (times 1 m).
const ON_ITS_WAY: [f64; 2] = [1e-3, 1e-8];
/// A goal nearer than this is none, rad or m.
const NEAR: f64 = 0.01;
/// The approach to tasks ends when nothing moves by more, rad or m.
const NEARLY: f64 = 1e-6;
/// `R_min`: every active goal that lessens torque is worth a try.
const RATIO: f64 = 0.0;
/// `eps` of the tables, N m.
const TOLERANCE: f64 = 0.05;
/// Smallest torque of weight and loads, N m, of which it is said who carries it.
const WORTH: f64 = 1.0;
/// From this share on a joint hangs on its ligaments.
const HANGS: f64 = 0.5;
/// What is missing in a posture beyond all numbers.
const ALL: Missing = Missing { force: f64::INFINITY, moment: f64::INFINITY, condition: Condition::Other };

/// A posture that was come to.
#[derive(Clone, Debug)]
struct Found {
    relaxed: SolvedPosture,
    /// By how much supports carry more than they should, shares of weight.
    excess: f64,
    /// What weight and loads, and what passive tissue ask of every coordinate with muscles, as shares of strength.
    pulls: Vec<[f64; 2]>,
    /// Starts that led here, in words.
    starts: Vec<String>,
}

/// Engines, and what they have found.
pub(super) struct Finder<'a> {
    search: &'a Search<'a>,
    /// For the first steps, and for all of them.
    engines: [Engine<'a>; 2],
    /// Knows no effort.
    approach: Engine<'a>,
    /// Place of the pushes among the engines' goals.
    slot: usize,
    found: Vec<Found>,
    /// What is missing where the body fell.
    fell: Vec<Missing>,
    /// Why the first posture that has no numbers was refused.
    refused: Option<EngineError>,
    starts: usize,
    steps: usize,
}

impl<'a> Finder<'a> {
    pub(super) fn new(search: &'a Search<'a>, options: Options) -> Result<Self, SearchError> {
        let mut goals = search.goals.to_vec();
        let asks = |goal: &PriorityLevel| goal.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
        let slot = goals.iter().position(asks).unwrap_or(goals.len());
        if slot == goals.len() {
            goals.push(Task::Effort(Effort::whole(search.model)).into());
        }
        goals.insert(slot, PriorityLevel::default());
        // Steps of priorities pass over the small dips in which a descent ends; other valleys are other starts.
        let engine = |max_steps: usize, goals: &[PriorityLevel]| {
            let (supports, goals) = (search.supports.to_vec(), goals.to_vec());
            let options = Options { max_steps, local_minima: 0, ..options };
            let mut engine = Engine::new(search.model, search.start, supports, goals, search.loads, options)?;
            search.locked.iter().for_each(|&rate| engine.lock(rate));
            Ok::<_, SearchError>(engine)
        };
        let mut engines = [engine(SCOUT.min(options.max_steps), &goals)?, engine(options.max_steps, &goals)?];
        engines[0].scout();
        let approach = engine(SCOUT, &goals[..slot])?;
        Ok(Self { search, engines, approach, slot, found: vec![], fell: vec![], refused: None, starts: 0, steps: 0 })
    }

    /// All starts, a few steps each.
    pub(super) fn scout(&mut self) -> Result<(), SearchError> {
        self.run_to_tasks(self.search.start, "the start".to_owned());
        let mut pushed_from: Vec<Found> = vec![];
        for _ in 0..ROUNDS {
            let Some(best) = self.best() else { break };
            if pushed_from.iter().any(|known| same(known, &best)) {
                break;
            }
            self.push_from(&best.relaxed.posture)?;
            pushed_from.push(best);
        }
        if let Some(mirror) = Mirror::of(self.search.model) {
            for i in 0..self.found.len() {
                let mut twin = self.found[i].clone();
                for (c, pull) in self.found[i].pulls.iter().enumerate() {
                    let (partner, sign) = mirror.coordinate(c);
                    twin.pulls[partner] = pull.map(|share| sign * share);
                }
                if !self.found.iter().any(|known| same(known, &twin)) {
                    let label = format!("mirror image of: {}", twin.starts[0]);
                    self.run_to_tasks(&mirror.posture(&twin.relaxed.posture), label);
                }
            }
        }
        Ok(())
    }

    /// What was found settles.
    pub(super) fn settle(&mut self) -> Result<(), SearchError> {
        let counted = self.counted(YIELDED[1]);
        let mut scouted = std::mem::take(&mut self.found);
        let starts = std::mem::take(&mut self.starts);
        for i in counted {
            let Found { relaxed, starts, .. } = scouted[i].clone();
            self.run(1, &relaxed.posture, starts);
        }
        if self.found.is_empty() {
            self.found.append(&mut scouted);
        }
        self.starts = starts;
        Ok(())
    }

    /// Settles from a posture with one of the engines and keeps what is new.
    fn run(&mut self, which: usize, from: &Posture, starts: Vec<String>) {
        let engine = &mut self.engines[which];
        engine.levels_mut()[self.slot].half_spaces.clear();
        self.starts += 1;
        let mut relaxed = match engine.solve(from) {
            Ok(relaxed) => relaxed,
            Err(error) => {
                self.fell.push(ALL);
                self.refused.get_or_insert(error);
                return;
            }
        };
        self.steps += relaxed.steps;
        let missing = engine.contact().missing(self.search.model, engine.body().kinematics());
        let most = ON_ITS_WAY[which] * self.search.model.mass() * self.search.model.gravity().norm();
        if let Some(missing) = missing.filter(|missing| missing.force.max(missing.moment) > most) {
            self.fell.push(missing);
            return;
        }
        relaxed.levels.remove(self.slot);
        let contact = engine.contact();
        let supports = self.search.supports.iter().enumerate();
        let excess = supports.map(|(i, support)| (contact.share(i) - support.share_max).max(0.0)).sum();
        let new = Found { relaxed, excess, starts, pulls: self.pulls(which) };
        let Some(known) = self.found.iter().position(|known| same(known, &new)) else {
            self.found.push(new);
            return;
        };
        let (slot, known) = (self.slot, &mut self.found[known]);
        known.starts.extend(new.starts);
        let far = |relaxed: &SolvedPosture, excess: f64| {
            excess + relaxed.slip + relaxed.levels[..slot].iter().map(|level| level.length).sum::<f64>()
        };
        if new.relaxed.effort < known.relaxed.effort
            && far(&new.relaxed, new.excess) <= far(&known.relaxed, known.excess) + YIELDED[0]
        {
            (known.relaxed, known.excess, known.pulls) = (new.relaxed, new.excess, new.pulls);
        }
    }

    /// First does the tasks, whatever effort it takes: from afar the two would stand in each other's way.
    fn run_to_tasks(&mut self, from: &Posture, start: String) {
        let mut posture = from.clone();
        self.approach.restart();
        for _ in 0..SCOUT {
            self.steps += 1;
            match self.approach.step(&mut posture) {
                Ok(step) if step.largest > NEARLY => {}
                _ => break,
            }
        }
        self.run(0, &posture, vec![start]);
    }

    /// Moves under half-spaces and then without them.
    fn push(&mut self, from: &Posture, goals: &[(usize, f64)], label: String) {
        let n = self.search.model.coordinates().len();
        let mut spaces = vec![];
        for &(coordinate, goal) in goals {
            let mut space = HalfSpace::new(n);
            let mut step = vec![0.0; n];
            step[coordinate] = goal - from.values()[coordinate];
            if space.ask_for(from.values(), &step) {
                spaces.push(space);
            }
        }
        self.engines[0].levels_mut()[self.slot].half_spaces = spaces;
        if let Ok(under) = self.engines[0].solve(from) {
            self.steps += under.steps;
            self.run(0, &under.posture, vec![label]);
        }
    }

    /// The pushes of both strategies from a posture.
    fn push_from(&mut self, posture: &Posture) -> Result<(), SearchError> {
        let mut asked: Vec<(f64, usize, [Option<f64>; 2])> = vec![];
        for i in 0..self.search.model.coordinates().len() {
            let goals = self.goals_of(posture, i)?;
            if goals.iter().any(Option::is_some) {
                let load = self.work(0, i).map_or(0.0, |work| work.relative_load());
                asked.push((load, i, goals));
            }
        }
        for (k, word) in ["active", "passive"].into_iter().enumerate() {
            let all: Vec<(usize, f64)> = asked.iter().filter_map(|(_, i, goals)| Some((*i, goals[k]?))).collect();
            if !all.is_empty() {
                self.push(posture, &all, format!("all {word} goals"));
            }
        }
        // Of equals the first of the model.
        asked.sort_by(|a, b| b.0.total_cmp(&a.0));
        asked.truncate(SINGLE);
        for (_, i, goals) in asked {
            for (goal, word) in goals.into_iter().zip(["active", "passive"]) {
                let Some(goal) = goal else { continue };
                let coordinate = &self.search.model.coordinates()[i];
                let value = match coordinate.kind {
                    CoordinateKind::Rotation => format!("{:.1} deg", goal.to_degrees()),
                    _ => format!("{goal:.3} m"),
                };
                self.push(posture, &[(i, goal)], format!("{word} goal of {}, {value}", coordinate.name));
            }
        }
        Ok(())
    }

    /// Active and passive goal of a coordinate that is not there yet.
    fn goals_of(&mut self, posture: &Posture, i: usize) -> Result<[Option<f64>; 2], SearchError> {
        let coordinate = &self.search.model.coordinates()[i];
        let (Some(law), Some(rate), true) = (&coordinate.passive, coordinate.rate, coordinate.groups.is_some()) else {
            return Ok([None; 2]);
        };
        if self.search.locked.contains(&rate) || coordinate.locked || self.search.model.is_dependent(i) {
            return Ok([None; 2]);
        }
        let Some(external_slope) = self.engines[0].slope_along(posture, rate, self.slot)? else { return Ok([None; 2]) };
        let Some(curve) = law.curve_at(i, posture.values(), coordinate.range) else { return Ok([None; 2]) };
        let goal = |strategy: Strategy| {
            let problem = Problem {
                curve: &curve,
                angle: posture.values()[i],
                external_torque: self.engines[0].body().external_torque().torques()[rate],
                external_slope,
                strategy,
                minimum_decrease_ratio: RATIO,
                torque_tolerance: TOLERANCE,
                accepted: None,
            };
            let goal = minimise(&problem).ok()?.goal?;
            ((goal - problem.angle).abs() > NEAR).then_some(goal)
        };
        let (active, passive) = (goal(Strategy::Active), goal(Strategy::Passive));
        // The tables give both strategies the same answer where there is only one.
        Ok([active.filter(|_| active != passive), passive])
    }

    /// What a coordinate's muscles do in the posture that an engine looked at last.
    fn work(&self, engine: usize, i: usize) -> Option<Work> {
        let (model, engine) = (self.search.model, &self.engines[engine]);
        let coordinate = &model.coordinates()[i];
        let (rate, groups) = (coordinate.rate?, coordinate.groups.as_ref()?);
        if model.is_dependent(i) {
            return None;
        }
        let active = engine.body().active_torque()[rate];
        let side = Side::of(active);
        let group = &groups[side.index()];
        let strength = group.strength.torque(engine.body().kinematics().values()[i]);
        let endurance = group.fatigue.endurance_time(active.abs() / strength);
        Some(Work { coordinate: i, side, active, strength, endurance })
    }

    /// What every coordinate's muscles have to set against, as shares of their strength, in that posture.
    fn pulls(&self, engine: usize) -> Vec<[f64; 2]> {
        let pull = |i: usize| {
            let rate = self.search.model.coordinates()[i].rate?;
            let work = self.work(engine, i)?;
            let engine = &self.engines[engine];
            let torques = [engine.body().external_torque().torques()[rate], engine.passive()[rate]];
            Some(torques.map(|torque| torque / work.strength))
        };
        (0..self.search.model.coordinates().len()).map(|i| pull(i).unwrap_or_default()).collect()
    }

    /// The posture of least effort so far.
    fn best(&self) -> Option<Found> {
        let found = self.counted(YIELDED[1]).into_iter().map(|i| &self.found[i]);
        found.min_by(|a, b| a.relaxed.effort.total_cmp(&b.relaxed.effort)).cloned()
    }

    /// Those with supports in place and tasks as near as in any other one but for `yielded`, level by level.
    fn counted(&self, yielded: f64) -> Vec<usize> {
        let mut counted: Vec<usize> =
            (0..self.found.len()).filter(|&i| self.found[i].relaxed.slip <= yielded).collect();
        for level in 0..=self.slot {
            let error = |i: usize| {
                let found = &self.found[i];
                if level == 0 { found.excess } else { found.relaxed.levels[level - 1].length }
            };
            let least = counted.iter().map(|&i| error(i)).fold(f64::INFINITY, f64::min);
            counted.retain(|&i| error(i) <= least + yielded);
        }
        counted
    }

    /// The list.
    pub(super) fn finish(mut self) -> Result<Equilibria, SearchError> {
        if self.found.is_empty() {
            let size = |missing: &Missing| missing.force.hypot(missing.moment);
            let seen = self.fell.into_iter().filter(|missing| size(missing).is_finite());
            let least = seen.min_by(|a, b| size(a).total_cmp(&size(b)));
            let refused = self.refused.map(SearchError::Relax);
            return Err(least.map(SearchError::CannotStand).or(refused).unwrap_or(SearchError::CannotStand(ALL)));
        }
        let mut counted = self.counted(YIELDED[0]);
        if counted.is_empty() {
            // Everything slips or is on its way: the nearest of it, and its figures say so.
            let slip = |i: &usize| self.found[*i].relaxed.slip;
            counted.extend((0..self.found.len()).min_by(|a, b| slip(a).total_cmp(&slip(b))));
        }
        counted.sort_by(|&a, &b| self.found[a].relaxed.effort.total_cmp(&self.found[b].relaxed.effort));
        let yielded = self.found.len() - counted.len();
        let postures = counted.into_iter().map(|i| self.describe(i)).collect::<Result<_, _>>()?;
        Ok(Equilibria { postures, starts: self.starts, fell: self.fell.len(), yielded, steps: self.steps })
    }

    fn describe(&mut self, i: usize) -> Result<RelaxedPosture, SearchError> {
        let model = self.search.model;
        let Found { relaxed, starts, .. } = self.found[i].clone();
        self.engines[1].evaluate(&relaxed.posture)?;
        let (body, contact) = (self.engines[1].body(), self.engines[1].contact());
        let supports = (0..contact.supports().len()).map(|i| Carried {
            share: contact.share(i),
            force: contact.force(i),
            center_of_pressure: contact.center_of_pressure(model, body.kinematics(), i),
        });
        let mut locked = vec![false; model.rates().len()];
        self.search.locked.iter().for_each(|&rate| locked[rate] = true);
        for (i, rate) in model.rates().iter().enumerate() {
            locked[i] |= rate.coordinate.is_some_and(|c| model.coordinates()[c].locked);
        }
        let stability = stability(model, body, self.search.supports, self.search.loads, &locked);
        let torques = [body.external_torque().torques().to_vec(), self.engines[1].passive().to_vec()];
        let mut work: Vec<Work> = (0..model.coordinates().len()).filter_map(|i| self.work(1, i)).collect();
        work.sort_by(|a, b| b.relative_load().total_cmp(&a.relative_load()));
        let hanging = work.iter().filter_map(|work| {
            let rate = model.coordinates()[work.coordinate].rate?;
            let (external, passive) = (torques[0][rate], torques[1][rate]);
            let hangs = external.abs() >= WORTH && -passive / external >= HANGS;
            hangs.then_some(Hanging { coordinate: work.coordinate, external, passive })
        });
        let mut hanging: Vec<Hanging> = hanging.collect();
        hanging.sort_by(|a, b| b.passive.abs().total_cmp(&a.passive.abs()));
        Ok(RelaxedPosture { supports: supports.collect(), stability, torques, work, hanging, starts, relaxed })
    }
}

/// Are two postures one: does the same pull at every joint?
fn same(a: &Found, b: &Found) -> bool {
    a.pulls.iter().flatten().zip(b.pulls.iter().flatten()).all(|(a, b)| (a - b).abs() <= SAME)
}
