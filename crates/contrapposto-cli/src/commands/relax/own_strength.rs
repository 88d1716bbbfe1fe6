//! Seeks the postures of least effort of a body whose strength and passive torque are those that its muscles have in the posture sought.
//!
//! A search works with the muscles of one posture, and leads to another one, whose own muscles may lead back. So each posture that a search finds
//! is sought again from itself, by muscles that follow it, until these stay or no posture is better than the best so far. Every posture
//! counts by its own muscles, and the search is done again from the muscles of the best one until it shows no better one.

use contrapposto::contact::Support;
use contrapposto::equilibria::{Equilibria, RelaxedPosture, Search, SearchError, described_anew, equilibria};
use contrapposto::joint_torques::{JointTorquesError, relative_load};
use contrapposto::kinematics::Kinematics;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::EngineError;
use contrapposto::tasks::turned_since;
use contrapposto_formats::RelaxScenario;

use super::super::trials::cores;
use crate::output::print_note;
use crate::view::words::percent;

/// Most times that a posture is sought again with the strength that muscles have in the one before.
pub(crate) const MOST_STRENGTH_ROUNDS: usize = 20;
/// Change of a strength, as a share, from which on a posture is sought again.
pub(crate) const SAME_STRENGTH: f64 = 1e-6;
/// Change of a strength that is left after all rounds up to which nothing is said of it: half of the percent to which loads are shown.
const UNSAID: f64 = 5e-3;
/// Most searches over all starts.
const MOST_SEARCHES: usize = 6;
/// Most times that a posture is sought again here.
const MOST_ROUNDS: usize = 60;
/// The last of so many postures that are no better ends the rounds.
const MOST_IN_VAIN: usize = 6;
/// Least share of the way.
const LEAST_SHARE: f64 = 0.25;
/// Postures that need more effort are no answers: a factor of the least, and an addition, as in a search.
const MOST_EFFORT: (f64, f64) = (2.0, 0.05);
/// Postures count as one if at no joint a torque differs by more than this share of strength, as in a search.
const SAME_TORQUE: f64 = 0.05;
/// Postures count as two where a segment is farther away in one than in the other, m, as in a search.
const SAME_PLACE: f64 = 0.3;
/// A settled posture is better than another one if its effort is less than this share of the other's.
const BETTER: f64 = 0.999;

/// The best of the postures to which seeking again has led.
struct Settled {
    posture: RelaxedPosture,
    /// Change of a strength between its own muscles and those by which it was sought.
    change: f64,
    /// Whether the effort of the posture still fell when the rounds ended.
    falls: bool,
}

/// The postures of least effort, each by its own muscles.
pub(crate) fn find(scenario: &mut RelaxScenario) -> Result<Equilibria, SearchError> {
    let mut all: Vec<Settled> = vec![];
    let mut searches = 0;
    loop {
        let found = equilibria(&Search { threads: cores(), ..scenario.search() }, RelaxScenario::OPTIONS)?;
        searches += 1;
        let Some(first) = found.postures.first() else { return Ok(found) };
        if scenario.take_strength(&first.relaxed.posture) <= SAME_STRENGTH && all.is_empty() {
            return Ok(found);
        }
        let before = all.first().map(Settled::effort);
        for posture in &found.postures {
            let settled = settle(scenario, posture.clone())?;
            match all.iter_mut().find(|other| other.is_like(&settled, scenario)) {
                Some(other) if settled.effort() < other.effort() => *other = settled,
                Some(_) => {}
                None => all.push(settled),
            }
        }
        all.sort_by(|a, b| a.effort().total_cmp(&b.effort()));
        let best = &all[0];
        scenario.take_strength(&best.posture.relaxed.posture);
        if searches == MOST_SEARCHES || before.is_some_and(|before| best.effort() >= BETTER * before) {
            let most = MOST_EFFORT.0 * best.effort() + MOST_EFFORT.1;
            all.retain(|one| one.effort() <= most);
            (1..).zip(&all).for_each(|(number, one)| one.say(number));
            let postures = all.into_iter().map(|one| one.posture);
            return Ok(Equilibria { postures: postures.collect(), ..found });
        }
    }
}

/// Seeks a posture again from itself, by the muscles of a posture `at` that follows it. Of all that are found this is the one of least effort, each by its
/// own muscles. `at` follows by a shorter part of the way after a posture that is no better, and the end is where none was for a while.
fn settle(scenario: &mut RelaxScenario, mut posture: RelaxedPosture) -> Result<Settled, SearchError> {
    let change = scenario.take_strength(&posture.relaxed.posture);
    let mut best = Settled::by_own_muscles(scenario, &posture, change)?;
    let mut at = posture.relaxed.posture.clone();
    let (mut share, mut in_vain) = (1.0, 0);
    for round in 0..MOST_ROUNDS {
        // After the least work that there is the one start is the posture itself.
        let supports = supports_from(scenario, &posture.relaxed.posture)?;
        let search = scenario.search();
        let start = &posture.relaxed.posture;
        let nearby = Search { start, supports: &supports, scattered: 0, most_work: 1, ..search };
        let found = equilibria(&nearby, RelaxScenario::OPTIONS)?;
        let Some(first) = found.postures.into_iter().next() else { break };
        let starts = std::mem::replace(&mut posture, first).starts;
        posture.starts = starts;
        let change = scenario.take_strength(&posture.relaxed.posture);
        let settled = Settled::by_own_muscles(scenario, &posture, change)?;
        let is_better = settled.effort() < BETTER * best.effort();
        (share, in_vain) =
            if is_better { (f64::min(2.0 * share, 1.0), 0) } else { (f64::max(0.5 * share, LEAST_SHARE), in_vain + 1) };
        let at_rest = change <= SAME_STRENGTH;
        if settled.effort() < best.effort() || at_rest && BETTER * settled.effort() < best.effort() {
            best = settled;
        }
        if at_rest || in_vain == MOST_IN_VAIN {
            break;
        }
        best.falls = round + 1 == MOST_ROUNDS;
        let mut way = vec![0.0; scenario.model.rates().len()];
        at.difference(&scenario.model, &posture.relaxed.posture, &mut way);
        way.iter_mut().for_each(|by| *by *= share);
        at.displace(&scenario.model, &way);
        scenario.take_strength(&at);
    }
    Ok(best)
}

/// The supports of the scenario, a search for which begins in another posture: the limits of their turns are those of the scenario's start.
fn supports_from(scenario: &RelaxScenario, posture: &Posture) -> Result<Vec<Support>, SearchError> {
    let model = &scenario.model;
    let kinematics = |posture| {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).map_err(|error| EngineError::from(JointTorquesError::from(error)))?;
        Ok::<_, SearchError>(kinematics)
    };
    let (start, now) = (kinematics(&scenario.start)?, kinematics(posture)?);
    Ok(scenario.supports.iter().map(|support| turned_since(support, model, &start, &now)).collect())
}

impl Settled {
    /// A posture by the muscles that the body has now; `change`: of a strength since it was sought.
    fn by_own_muscles(scenario: &RelaxScenario, posture: &RelaxedPosture, change: f64) -> Result<Self, SearchError> {
        let at_posture = Search { start: &posture.relaxed.posture, ..scenario.search() };
        Ok(Self { posture: described_anew(&at_posture, RelaxScenario::OPTIONS, posture)?, change, falls: false })
    }

    fn effort(&self) -> f64 {
        self.posture.relaxed.effort
    }

    /// Says of the posture of this number what its muscles leave in doubt.
    fn say(&self, number: usize) {
        if self.falls {
            print_note(
                "warning",
                &format!(
                    "posture {number}: its effort still fell when it had been sought again {MOST_ROUNDS} times by the muscles of the posture before; \
                     one nearby may need less"
                ),
            );
        } else if self.change > UNSAID {
            print_note(
                "note",
                &format!(
                    "posture {number} was sought with strengths and passive torques of which one differs by {} of a strength from those of its own \
                     muscles, by which all its numbers are; none that was found nearby needs less effort",
                    percent(self.change)
                ),
            );
        }
    }

    /// Whether another posture is the same, as a search sees it: no torque differs by more than a share of strength, and no segment is far away.
    fn is_like(&self, other: &Self, scenario: &RelaxScenario) -> bool {
        let model = &scenario.model;
        let postures = [&self.posture, &other.posture];
        let torque_of = |i: usize, kind: usize| {
            let rate = model.coordinates()[i].rate?;
            let [a, b] = postures.map(|posture| posture.torques[kind][rate]);
            Some(relative_load(&model.coordinates()[i], postures[0].relaxed.posture.values()[i], a - b))
        };
        let alike = |i: usize| [0, 1].iter().all(|&kind| torque_of(i, kind).is_none_or(|share| share <= SAME_TORQUE));
        let places = postures.map(|posture| {
            let mut kinematics = Kinematics::new(model);
            // A posture that was found fits its model.
            let _ = kinematics.update(model, &posture.relaxed.posture);
            let centers = model.segments().iter().enumerate();
            centers.map(|(i, segment)| kinematics.station(model, i, segment.center_of_mass)).collect::<Vec<_>>()
        });
        let near = places[0].iter().zip(&places[1]).all(|(a, b)| (a - b).norm() <= SAME_PLACE);
        near && (0..model.coordinates().len()).all(alike)
    }
}

/// A warning that the strength of muscles changes by this share still.
pub(crate) fn unsettled(posture: &str, change: f64) -> String {
    format!(
        "strength and passive torque of the muscles have not settled in {MOST_STRENGTH_ROUNDS} rounds: in {posture} one of them differs by {} \
         of a strength from that by which the posture was found",
        percent(change)
    )
}
