//! Computes when a muscle group reaches a fatigue under a load that is repeated, cycle after cycle, for hours.
//!
//! As long as the group has not failed, a cycle changes its state by one affine map ([`LinearStep`]). Its `MA` forgets the start within a few
//! cycles; from there on `MF` rises or falls from cycle to cycle without turning. So the first cycle in which a fatigue is reached is found by
//! bisection over powers of the map, and only that cycle is stepped. With breaks the map of a stretch of work and its break is treated likewise.

use super::linear_step::{LinearStep, Shares};
use super::{FatigueLaw, FatigueState, LoadCycle};

/// Times beyond this, s, count as for ever: thirty years.
const FOR_EVER: f64 = 1e9;
/// Share of its start that `MA` may keep when it counts as forgotten.
const FORGOTTEN: f64 = 1e-18;
/// Most cycles until then.
const MOST_TRANSIENT: u64 = 10_000;

/// Rests in a job that is repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breaks {
    /// Work before each break, s: as many whole cycles as it holds; the rest of it is a part of the break.
    pub work: f64,
    /// Length of a break, s.
    pub rest: f64,
}

impl Breaks {
    /// A minute after every ten minutes: the breaks that are suggested (assumed).
    pub const SUGGESTED: Self = Self { work: 600.0, rest: 60.0 };
}

/// A cycle that is repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repetition {
    /// Length of the job, breaks included, s.
    pub seconds: f64,
    /// Time from the start of a cycle to that of the next, s; what it is longer than the cycle is a pause without load.
    pub every: f64,
    /// Breaks without load; `None`: one cycle after the other.
    pub breaks: Option<Breaks>,
}

impl Repetition {
    /// Whole cycles of a stretch of work, and its length with the break, s. Without breaks the stretch never ends.
    fn stretch(&self) -> (u64, f64) {
        match self.breaks {
            Some(Breaks { work, rest }) => (whole(work, self.every).max(1), work + rest),
            None => (whole(FOR_EVER, self.every), FOR_EVER),
        }
    }

    /// Number of whole cycles in the job.
    pub fn cycles(&self) -> u64 {
        let (cycles, length) = self.stretch();
        let stretches = (self.seconds / length).floor();
        stretches as u64 * cycles + whole(self.seconds - stretches * length, self.every).min(cycles)
    }
}

/// Number of whole cycles in a time, s; rounding of the quotient leaves none out.
fn whole(seconds: f64, every: f64) -> u64 {
    (seconds / every + 1e-9).floor() as u64
}

/// One group, its cycle and how it is repeated.
#[derive(Clone, Debug)]
pub struct Repeated<'a> {
    law: &'a FatigueLaw,
    cycle: &'a LoadCycle,
    strength: f64,
    repetition: Repetition,
    /// From the start of a cycle to its start and to the end of each of its pieces, with the load there.
    steps: Vec<(LinearStep, f64)>,
    /// A cycle with its pause.
    whole: LinearStep,
}

impl<'a> Repeated<'a> {
    /// A group with `strength` times the strength that the loads of `cycle` are shares of.
    pub fn new(law: &'a FatigueLaw, cycle: &'a LoadCycle, strength: f64, repetition: Repetition) -> Self {
        let mut step = LinearStep::IDENTITY;
        let mut steps = vec![(step, cycle.first() / strength)];
        for interval in cycle.intervals(strength).filter(|interval| interval.seconds > 0.0) {
            for piece in interval.pieces() {
                let (load, seconds) = interval.constant(piece);
                step = step.then(law.linear_step(load, seconds));
                steps.push((step, interval.load_at(piece.1)));
            }
        }
        let pause = (repetition.every - cycle.seconds()).max(0.0);
        Self { law, cycle, strength, repetition, steps, whole: step.then(law.linear_step(0.0, pause)) }
    }

    /// The time at which the fatigue of a group, `start` (0..=1) at first, reaches `level`, s from the start of the job; infinite where it never does. A
    /// load above the strength reaches every level.
    pub fn time_of(&self, start: f64, level: f64) -> f64 {
        if self.cycle.is_idle() {
            return f64::INFINITY;
        }
        let (cycles, length) = self.repetition.stretch();
        let mut state = self.law.shares(self.law.start(start, self.steps[0].1));
        let mut before = 0.0;
        if self.repetition.breaks.is_some() {
            let stretch = self.stretch();
            let reached = |state| self.first_cycle(state, level, cycles, false).is_some();
            let Some(number) = first(state, &stretch, whole(FOR_EVER, length), true, reached) else {
                return f64::INFINITY;
            };
            state = stretch.repeated(number).apply(state);
            before = number as f64 * length;
        }
        let Some(number) = self.first_cycle(state, level, cycles, true) else { return f64::INFINITY };
        state = self.whole.repeated(number).apply(state);
        before + number as f64 * self.repetition.every + self.time_in_cycle(state, level)
    }

    /// Fatigue at the end of the last whole cycle of the job, of a group that had the fatigue `start` at first; and the greatest one in that
    /// cycle. Before the group fails.
    pub fn at_end(&self, start: f64) -> (f64, f64) {
        let cycles = self.repetition.cycles().max(1);
        self.in_cycle(start, cycles - 1)
    }

    /// Fatigue at the end of a cycle, counted from 0, and the greatest one in it, of a group that had the fatigue `start` at first.
    pub fn in_cycle(&self, start: f64, number: u64) -> (f64, f64) {
        let (cycles, _) = self.repetition.stretch();
        let stretches = if self.repetition.breaks.is_some() { number / cycles } else { 0 };
        let mut state = self.law.shares(self.law.start(start, self.steps[0].1));
        if stretches > 0 {
            state = self.stretch().repeated(stretches).apply(state);
        }
        state = self.whole.repeated(number - stretches * cycles).apply(state);
        let level = |(step, load): &(LinearStep, f64)| self.law.state_of(step.apply(state)).level(*load);
        let greatest = self.steps.iter().map(level).fold(0.0, f64::max);
        (self.steps.last().map_or(0.0, level), greatest)
    }

    /// A stretch of work with the break after it.
    fn stretch(&self) -> LinearStep {
        let (cycles, length) = self.repetition.stretch();
        let rest = length - cycles as f64 * self.repetition.every;
        self.whole.repeated(cycles).then(self.law.linear_step(0.0, rest.max(0.0)))
    }

    /// The first of so many cycles in which the level is reached; where only the fact counts (`exact` is false), some cycle.
    fn first_cycle(&self, state: Shares, level: f64, count: u64, exact: bool) -> Option<u64> {
        let reached = |state| {
            self.steps.iter().any(|(step, load)| *load > 1.0 || step.apply(state).1 >= self.law.threshold(level, *load))
        };
        first(state, &self.whole, count, exact, reached)
    }

    /// Time at which the level is reached in a cycle that begins in this state, s.
    fn time_in_cycle(&self, state: Shares, level: f64) -> f64 {
        let mut state: FatigueState = self.law.state_of(state);
        let (mut time, load) = (0.0, self.steps[0].1);
        if load > 1.0 || state.level(load) >= level {
            return time;
        }
        for interval in self.cycle.intervals(self.strength) {
            for piece in interval.pieces() {
                let (next, fatigue) = interval.advance(self.law, state, piece);
                if interval.load_at(piece.1) > 1.0 || fatigue >= level {
                    return time + interval.share_of(self.law, state, piece, level) * interval.seconds;
                }
                state = next;
            }
            time += interval.seconds;
        }
        time
    }
}

/// The first of `count` repeats of a step, counted from 0, from whose start on a condition is met; some of them if `exact` is false.
fn first(mut state: Shares, step: &LinearStep, count: u64, exact: bool, met: impl Fn(Shares) -> bool) -> Option<u64> {
    let (mut number, mut kept) = (0, 1.0);
    while number < count && number < MOST_TRANSIENT {
        if met(state) {
            return Some(number);
        }
        if kept < FORGOTTEN {
            break;
        }
        (state, number, kept) = (step.apply(state), number + 1, kept * step.active[0]);
    }
    if number >= count || !met(step.repeated(count - 1 - number).apply(state)) {
        return None;
    }
    let (mut before, mut after) = (number, count - 1);
    while exact && after - before > 1 {
        let middle = before + (after - before) / 2;
        if met(step.repeated(middle - number).apply(state)) { after = middle } else { before = middle }
    }
    Some(after)
}
