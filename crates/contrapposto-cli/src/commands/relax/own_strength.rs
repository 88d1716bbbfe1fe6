//! Seeks the postures of least effort of a body whose strength and passive torque are those that its muscles have in the posture sought.
//!
//! A search works with the muscles of one posture. From that of the posture before it may lead to another one, whose own muscles lead back. So each
//! posture that a search finds is first settled: sought again from itself, by the muscles that it has then, until these stay. A settled
//! posture counts by its own muscles, and the search is done again from the muscles of the best settled posture until it shows no better one.

use contrapposto::equilibria::{Equilibria, RelaxedPosture, Search, SearchError, equilibria};
use contrapposto::joint_torques::relative_load;
use contrapposto::kinematics::Kinematics;
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
/// Rounds in which a posture is sought by the muscles of the one before, not of one between.
const UNDAMPED: usize = 3;
/// Postures that need more effort are no answers: a factor of the least, and an addition, as in a search.
const MOST_EFFORT: (f64, f64) = (2.0, 0.05);
/// Postures count as one if at no joint a torque differs by more than this share of strength, as in a search.
const SAME_TORQUE: f64 = 0.05;
/// Postures count as two where a segment is farther away in one than in the other, m, as in a search.
const SAME_PLACE: f64 = 0.3;
/// A settled posture is better than another one if its effort is less than this share of the other's.
const BETTER: f64 = 0.999;

/// A posture sought again until its muscles stay.
struct Settled {
    posture: RelaxedPosture,
    /// Change of a strength that is left.
    change: f64,
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
            for (number, one) in (1..).zip(&all).filter(|(_, one)| one.change > UNSAID) {
                print_note("warning", &unsettled(&format!("posture {number}"), one.change));
            }
            let postures = all.into_iter().map(|one| one.posture);
            return Ok(Equilibria { postures: postures.collect(), ..found });
        }
    }
}

/// Seeks a posture again from itself, by the muscles that it has each time, until these stay.
fn settle(scenario: &mut RelaxScenario, mut posture: RelaxedPosture) -> Result<Settled, SearchError> {
    let mut change = scenario.take_strength(&posture.relaxed.posture);
    for round in 0..MOST_STRENGTH_ROUNDS {
        // After the least work that there is the one start is the posture itself.
        let nearby = Search { start: &posture.relaxed.posture, scattered: 0, most_work: 1, ..scenario.search() };
        let found = equilibria(&nearby, RelaxScenario::OPTIONS)?;
        let Some(first) = found.postures.into_iter().next() else { break };
        let before = std::mem::replace(&mut posture, first);
        change = scenario.take_strength(&posture.relaxed.posture);
        if change <= SAME_STRENGTH {
            break;
        }
        if round >= UNDAMPED {
            // Two postures that lead to each other have one between them that leads to itself.
            let mut middle = before.relaxed.posture.clone();
            let mut way = vec![0.0; scenario.model.rates().len()];
            middle.difference(&scenario.model, &posture.relaxed.posture, &mut way);
            way.iter_mut().for_each(|by| *by *= 0.5);
            middle.displace(&scenario.model, &way);
            scenario.take_strength(&middle);
        }
        posture.starts = before.starts;
    }
    Ok(Settled { posture, change })
}

impl Settled {
    fn effort(&self) -> f64 {
        self.posture.relaxed.effort
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
