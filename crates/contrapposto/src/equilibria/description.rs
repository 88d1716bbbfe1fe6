//! Describes a posture of least effort: muscle work, loads of supports, joints on their ligaments, stability.

use super::outcome::{Carried, Hanging, RelaxedPosture, Work};
use super::search::{Search, SearchError};
use super::stability::stability;
use crate::model::{Model, Side};
use crate::posture_solver::{Engine, SolvedPosture};

/// Least external torque, N m, from which a joint can count as hanging on its ligaments.
const LEAST_HANGING_TORQUE: f64 = 1.0;
/// Least share of the external torque that ligaments carry where a joint hangs on them.
const LEAST_HANGING_SHARE: f64 = 0.5;

/// Describes a solved posture, which `engine` evaluates.
pub(super) fn describe(
    search: &Search<'_>,
    engine: &mut Engine<'_>,
    relaxed: SolvedPosture,
    starts: Vec<String>,
) -> Result<RelaxedPosture, SearchError> {
    let model = search.model;
    // What was solved before leaves no trace in the contact forces.
    engine.restart();
    engine.evaluate(&relaxed.posture)?;
    let (body, contact) = (engine.torques(), engine.contact());
    let supports = (0..contact.supports().len()).map(|i| Carried {
        share: contact.share(i),
        force: contact.force(i),
        center_of_pressure: contact.center_of_pressure(model, body.kinematics(), i),
    });
    let mut locked = vec![false; model.rates().len()];
    search.locked.iter().for_each(|&rate| locked[rate] = true);
    for (i, rate) in model.rates().iter().enumerate() {
        locked[i] |= rate.coordinate.is_some_and(|c| model.coordinates()[c].locked);
    }
    let stability = stability(model, body, search.supports, search.loads, &locked);
    let torques = [body.external_about_axes().to_vec(), body.passive_torque().about_axes().to_vec()];
    let mut work: Vec<Work> = (0..model.coordinates().len()).filter_map(|i| work_of(model, engine, i)).collect();
    work.sort_by(|a, b| b.relative_load().total_cmp(&a.relative_load()));
    let hanging = work.iter().filter_map(|work| {
        let rate = model.coordinates()[work.coordinate].rate?;
        let (external, passive) = (torques[0][rate], torques[1][rate]);
        let hangs = external.abs() >= LEAST_HANGING_TORQUE && -passive / external >= LEAST_HANGING_SHARE;
        hangs.then_some(Hanging { coordinate: work.coordinate, external, passive })
    });
    let mut hanging: Vec<Hanging> = hanging.collect();
    hanging.sort_by(|a, b| b.passive.abs().total_cmp(&a.passive.abs()));
    Ok(RelaxedPosture {
        supports: supports.collect(),
        stability,
        torques,
        work,
        hanging,
        starts,
        relaxed,
        mirrored: false,
    })
}

/// Work of a coordinate's muscles in the posture that `engine` evaluated last.
pub(super) fn work_of(model: &Model, engine: &Engine<'_>, i: usize) -> Option<Work> {
    let coordinate = &model.coordinates()[i];
    let (rate, groups) = (coordinate.rate?, coordinate.groups.as_ref()?);
    if model.is_dependent(i) {
        return None;
    }
    let active = engine.torques().active_torque()[rate];
    let side = Side::of(active);
    let group = &groups[side.index()];
    let strength = group.strength.torque(engine.torques().angles()[i]);
    let endurance = group.fatigue.endurance_time(active.abs() / strength);
    Some(Work { coordinate: i, side, active, strength, endurance })
}

/// External and passive torque of every coordinate with muscles as shares of strength, in that posture.
pub(super) fn relative_torques(model: &Model, engine: &Engine<'_>) -> Vec<[f64; 2]> {
    let shares = |i: usize| {
        let rate = model.coordinates()[i].rate?;
        let work = work_of(model, engine, i)?;
        let (external, passive) = engine.torques().external_and_passive(rate);
        Some([external, passive].map(|torque| torque / work.strength))
    };
    (0..model.coordinates().len()).map(|i| shares(i).unwrap_or_default()).collect()
}
