//! Finds the largest load with which a job can be done for the time asked.
//!
//! All loads of the job, weights and forces, change in one proportion. Tried are loads of two digits in steps of 5 % at most: 10, 10.5, 11,
//! ... 19.5, 20, 21, ... 99. The search divides the interval between a load that holds and one that does not in three; both loads that
//! it ends with were tried like any other change (`trial.rs`), so that the promised one holds when it is run on its own, and the next one
//! does not. Two loads are tried at a time, on one thread or two, with the same answer. No pair begins after the solver steps of the budget;
//! then the greatest load that held is told as a lower bound.

use super::budget::{Budget, Trial};
use super::change::Change;
use super::job::Job;
use crate::verdict::{Amount, MOST_AMOUNTS, VerdictKind, amounts, amounts_in_words, has_motors, how_long};

/// Loads of one decade: 1.00, 1.05, ... 1.95, then 2.0, 2.1, ... 9.9.
const DECADE: i64 = 100;
/// Loads of a decade below 2.
const BELOW_TWO: i64 = 20;
/// The least load that is tried, in steps below the given one: a hundredth.
const HUNDREDTH: i64 = -2 * DECADE;
/// The greatest one, in steps above it: the tenfold.
const TENFOLD: i64 = DECADE;
/// Distances of the first two trials from the given load, in steps: about the half or double of it, and four times that.
const FIRST_TRIALS: [i64; 2] = [35, 80];

/// The largest loads of a job, as shares of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct LargestLoad {
    /// The time that is asked for, s.
    pub asked: f64,
    /// The share that a person of mean strength holds for that time; `None` where a hundredth of the loads is too much.
    pub mean: Option<f64>,
    /// The share that weaker people hold for that time, one standard deviation below the mean, and by every published law.
    pub weaker: Option<f64>,
    /// Whether the tenfold load, the greatest one tried, holds for a person of mean strength.
    pub is_open: bool,
    /// Whether the budget ended the search before the greatest load was known, of the mean person and of weaker people.
    pub is_cut: [bool; 2],
    /// Whether motors move the body, of which none is weaker.
    motors: bool,
    /// The loads of the job.
    amounts: Vec<Amount>,
}

/// Number of the greatest load of the grid that is not above `load`.
fn index(load: f64) -> i64 {
    let decade = libm::log10(load).floor();
    let mantissa = load / libm::pow(10.0, decade);
    let within = if mantissa < 2.0 { 20.0 * (mantissa - 1.0) } else { 10.0 * mantissa };
    DECADE * decade as i64 + (within + 1e-6).floor() as i64
}

/// The load of a number.
fn load(index: i64) -> f64 {
    let (decade, within) = (index.div_euclid(DECADE), index.rem_euclid(DECADE));
    let mantissa = if within < BELOW_TWO { 1.0 + within as f64 / 20.0 } else { within as f64 / 10.0 };
    mantissa * 10f64.powi(decade as i32)
}

/// The loads that were tried, and how people get on with them.
struct Trials<'a> {
    trial: &'a (dyn Fn(&Change) -> Trial + Sync),
    budget: Budget,
    /// Solver steps of all trials so far.
    used: usize,
    asked: f64,
    /// The amount of the job by which its loads are told.
    amount: f64,
    /// Number of the load, and whether people of mean strength and weaker ones hold it.
    known: Vec<(i64, [bool; 2])>,
}

impl Trials<'_> {
    /// Tries loads, two at a time.
    fn take(&mut self, indices: [i64; 2]) {
        let is_new = |i: &i64| self.known.iter().all(|(known, _)| known != i);
        let mut new: Vec<i64> = indices.into_iter().filter(is_new).collect();
        new.dedup();
        let (trial, amount) = (self.trial, self.amount);
        let outcome = |index: i64| trial(&Change::Loads(load(index) / amount));
        let outcomes: Vec<Trial> = if self.budget.threads > 1 && new.len() > 1 {
            std::thread::scope(|scope| {
                let runs: Vec<_> = new.iter().map(|&index| scope.spawn(move || outcome(index))).collect();
                // A load whose trial ends in a panic is none that holds.
                runs.into_iter().map(|run| run.join().unwrap_or_default()).collect()
            })
        } else {
            new.iter().map(|&index| outcome(index)).collect()
        };
        self.used += outcomes.iter().map(|outcome| outcome.steps).sum::<usize>();
        let held = |outcome: Trial| {
            let holding = outcome.verdict.filter(|verdict| verdict.kind == VerdictKind::Holds);
            let weaker = holding.as_ref().and_then(|verdict| verdict.least).is_some_and(|least| least >= self.asked);
            [holding.is_some(), weaker]
        };
        let found: Vec<_> = new.iter().copied().zip(outcomes.into_iter().map(held)).collect();
        self.known.extend(found);
    }

    /// The greatest load with which these people hold, and which is below all with which they do not, `None` where the least one is too much;
    /// and whether the budget ended the search before.
    fn largest(&mut self, who: usize, start: i64) -> (Option<i64>, bool) {
        let mut next = [start, start];
        loop {
            let is_new = |i: &i64| self.known.iter().all(|(known, _)| known != i);
            if next.iter().any(is_new) && self.used >= self.budget.steps {
                return (self.bounds(who).0, true);
            }
            self.take(next);
            next = match self.bounds(who) {
                (Some(holds), Some(fails)) if holds + 1 >= fails => return (Some(holds), false),
                (Some(holds), Some(fails)) => {
                    let third = ((fails - holds) / 3).max(1);
                    [holds + third, (fails - third).max(holds + 1)]
                }
                (Some(holds), None) if holds >= start + TENFOLD => return (Some(holds), false),
                (Some(holds), None) => FIRST_TRIALS.map(|by| (holds + by).min(start + TENFOLD)),
                (None, Some(fails)) if fails <= start + HUNDREDTH => return (None, false),
                (None, Some(fails)) => FIRST_TRIALS.map(|by| (fails - by).max(start + HUNDREDTH)),
                (None, None) => return (None, false),
            }
        }
    }

    /// The greatest load known to hold below all known to fail, and the least known to fail.
    fn bounds(&self, who: usize) -> (Option<i64>, Option<i64>) {
        let fails = self.known.iter().filter(|(_, holds)| !holds[who]).map(|(index, _)| *index).min();
        let below = |index: i64| fails.is_none_or(|fails| index < fails);
        let holds = self.known.iter().filter(|(index, holds)| holds[who] && below(*index));
        (holds.map(|(index, _)| *index).max(), fails)
    }
}

impl LargestLoad {
    /// Of a job whose changed loads `trial` runs; `None` of a job without loads, where it asks for no time, and where no load was found to
    /// hold before the solver steps of the budget were used up.
    pub fn find(job: &Job<'_>, budget: Budget, trial: impl Fn(&Change) -> Trial + Sync) -> Option<Self> {
        let amounts = job.loads.iter().find(|loads| !loads.is_empty()).map(|loads| amounts(loads))?;
        let (asked, amount) = (job.asked?, amounts.first()?.0);
        if !(amount.is_finite() && amount > 0.0) {
            return None;
        }
        let start = index(amount);
        let mut trials = Trials { trial: &trial, budget, used: 0, asked, amount, known: vec![] };
        let [(mean, mean_is_cut), (weaker, weaker_is_cut)] = [0, 1].map(|who| trials.largest(who, start));
        if mean.is_none() && mean_is_cut {
            return None;
        }
        let share = |index: i64| load(index) / amount;
        Some(Self {
            asked,
            mean: mean.map(share),
            weaker: weaker.map(share),
            is_open: mean.is_some_and(|mean| mean >= start + TENFOLD),
            is_cut: [mean_is_cut, weaker_is_cut],
            motors: has_motors(job.model),
            amounts,
        })
    }

    /// `12 kg (the job has 15 kg) can be held for the 60 s asked by a person of mean strength, 9.5 kg by weaker people (the weakest sixth)`, by
    /// muscles and grip.
    pub fn in_words(&self) -> String {
        let amounts = &self.amounts[..self.amounts.len().min(MOST_AMOUNTS)];
        let of = |share: f64| amounts_in_words(amounts, share);
        let (given, asked) = (of(1.0), how_long(self.asked));
        let Some(mean) = self.mean else {
            return format!("even a hundredth of {given} cannot be held for the {asked} asked");
        };
        let more = if self.is_open { " or more" } else { "" };
        let least = |cut: bool| if cut { "at least " } else { "" };
        let head = format!(
            "{}{}{more} (the job has {given}) can be held for the {asked} asked",
            least(self.is_cut[0]),
            of(mean)
        );
        let weaker = match self.weaker {
            _ if self.motors => return head,
            Some(weaker) => format!("{}{}", least(self.is_cut[1]), of(weaker)),
            None if self.is_cut[1] => "a load that the solver steps did not suffice to find".to_owned(),
            None => "not even a hundredth of it".to_owned(),
        };
        let people = "by a person of mean strength";
        format!(
            "{head} {people}, {weaker} by weaker people (the weakest sixth); hazards for ligaments and discs are not counted"
        )
    }

    /// Name of the finding.
    pub const NAME: &'static str = "Largest load";

    /// The amounts of a share of the loads, in kg, N or N m, with their units.
    pub fn amounts(&self, share: f64) -> Vec<(f64, &'static str)> {
        self.amounts.iter().map(|(amount, unit)| (share * amount, *unit)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_have_two_digits_and_steps_of_five_percent_at_most() {
        for i in -250..250 {
            let (this, next) = (load(i), load(i + 1));
            assert!(next > this && next <= 1.05 * this + 1e-9, "{this} {next}");
            assert_eq!(index(this), i, "{this}");
            assert_eq!(index(0.5 * (this + next)), i, "between {this} and {next}");
        }
        assert_eq!([index(15.0), index(200.0)].map(load), [15.0, 200.0]);
    }
}
