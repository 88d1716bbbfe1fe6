//! Holds one posture by the muscles of a body until they fail, or for the asked time.

use contrapposto::contact::{Balance, ContactForces, root_rates};
use contrapposto::joint_torques::{JointTorques, Quantities, relative_load};
use contrapposto::model::{Model, Side};
use contrapposto::muscle::{MuscleFatigue, hold as held};
use contrapposto::posture::Posture;
use contrapposto_formats::tissue::{MuscleUse, SourcedModel, fatigue_notes};

use super::opened::held_posture;
use crate::args::MusclesArgs;
use crate::commands::assess::{RESIDUAL, WHAT_CARRIES};
use crate::fail::Fail;
use crate::model_file::open_with_muscles;
use crate::motion_file::{loads_of, note_values_out_of_range};
use crate::output::{print, print_note};
use crate::view::text::muscle_hold::{HeldMuscle, HeldPosture, JointLimit, json, readable};

pub(super) fn hold(args: &MusclesArgs, seconds: f64) -> Result<(), Fail> {
    let (opened, muscles, _) = open_with_muscles(&args.model, (Some(MuscleUse::Both), "--hold"))?;
    let mut opened = opened.with_fatigue(&args.hold.fatigue.choice()?);
    let mut notes = std::mem::take(&mut opened.notes);
    notes.extend(fatigue_notes(&opened.model));
    let frame = held_posture(&args.postures, &args.hold.under.frames, &opened.model, &mut notes)?;
    let mut body = JointTorques::with_passive_ranges(&opened.model, &opened.passive_ranges())
        .with_muscles(args.hold.sharing.of(muscles));
    torques(args, &mut opened, &mut body, &frame, &mut notes)?;
    notes.iter().for_each(|note| print_note("note", note));
    let found = by_muscles(&opened.model, &body, seconds)?;
    print(&if args.json { json(&opened.model, &found)? } else { readable(&opened.model, &found) })?;
    if found.is_held() { Ok(()) } else { Err(Fail::Answered) }
}

/// Computes the torques of the posture under its loads, and the strength of the joints in it.
fn torques(
    args: &MusclesArgs,
    opened: &mut SourcedModel,
    body: &mut JointTorques,
    frame: &(f64, Posture),
    notes: &mut Vec<String>,
) -> Result<(), Fail> {
    let refused = |why: &dyn std::fmt::Display| Fail::Refused(format!("{}: {why}", args.postures.display()));
    let frames = std::slice::from_ref(frame);
    let (mut loads, ground) = loads_of(&args.hold.under, &opened.model, frames, notes)?;
    let warnings = note_values_out_of_range(opened, frames, notes);
    warnings.iter().for_each(|warning| print_note("warning", warning));
    let model = &opened.model;
    body.place(model, &frame.1).map_err(|why| refused(&why))?;
    let mut posed = model.clone();
    if let Some(muscles) = body.muscles() {
        muscles.write_strength(&mut posed);
    }
    if let Some(ground) = &ground {
        ground.loads(frame.0, model, body.kinematics(), &mut loads);
    }
    let carried = &args.hold.carried;
    let supports = carried.supports(model)?;
    if supports.is_empty() {
        body.apply(&posed, &loads, Quantities::TORQUES).map_err(|why| refused(&why))?;
    } else {
        let mut contact = ContactForces::new(&posed, supports).map_err(|why| refused(&why))?;
        let placed = body.apply_with_contact(&posed, &loads, &mut contact, Quantities::TORQUES);
        placed.map_err(|why| refused(&why))?;
        if contact.balance() != Balance::Held {
            let missing = contact.missing(&posed, body.kinematics()).map(|missing| format!(": {missing}"));
            let why = format!("the supports cannot hold the body in this posture{}", missing.unwrap_or_default());
            return Err(Fail::Job(why));
        }
    }
    if !carried.fixed_root {
        root_is_held(&posed, body, !carried.support.is_empty() || ground.is_some())?;
    }
    opened.model = posed;
    Ok(())
}

/// Refuses a body that nothing carries; warns where forces of the ground and posture do not agree.
fn root_is_held(model: &Model, body: &JointTorques, carried: bool) -> Result<(), Fail> {
    let size = |turns: bool| {
        let rates = root_rates(model).into_iter().filter(|&rate| model.rates()[rate].rotational == turns);
        rates.map(|rate| body.active_torque()[rate].powi(2)).sum::<f64>().sqrt()
    };
    let (force, moment) = (size(false), size(true));
    if force.max(moment) <= RESIDUAL * (model.mass() * model.gravity().norm()).max(1.0) {
        return Ok(());
    }
    let missing = format!("the root carries {force:.2} N and {moment:.2} N m");
    if carried {
        print_note("warning", &format!("forces of the ground and posture do not agree: {missing}"));
        return Ok(());
    }
    Err(Fail::Refused(format!("nothing holds the body up: {missing}; {WHAT_CARRIES}")))
}

/// The answer of the muscles, and that of the joints' laws.
fn by_muscles(model: &Model, body: &JointTorques, seconds: f64) -> Result<HeldPosture, Fail> {
    let refused = |why: &dyn std::fmt::Display| Fail::Refused(format!("--hold: {why}"));
    let share = body.muscle_share(model).map_err(|why| refused(&why))?;
    let muscles = body.muscles().ok_or_else(|| refused(&"no muscle gives strength"))?;
    let asked = share.asked(muscles);
    let mut table: Vec<HeldMuscle> = muscles.musculature().muscles.iter().map(HeldMuscle::new).collect();
    let mut fatigue = MuscleFatigue::rested(share.laws.clone());
    let end = held(&mut fatigue, &asked, seconds, |time, now| {
        table.iter_mut().enumerate().for_each(|(i, muscle)| muscle.record(i, time, now));
    })
    .map_err(|why| refused(&why))?;
    let first = table.iter().filter_map(|muscle| muscle.exhausted).fold(f64::INFINITY, f64::min);
    let mut again = MuscleFatigue::rested(share.laws.clone());
    // The loads at the first exhaustion, from which others take over.
    if first < end.seconds {
        held(&mut again, &asked, first, |_, _| {}).map_err(|why| refused(&why))?;
        table.iter_mut().zip(again.loads()).for_each(|(muscle, load)| muscle.before_help = *load);
    }
    let capacities: Vec<f64> = fatigue.capacities().collect();
    let (rested, tired) = (asked.strengths(&vec![1.0; capacities.len()]), asked.strengths(&capacities));
    let by_joint = |muscled: bool| {
        let coordinates = (0..model.coordinates().len()).filter(|&i| {
            let rate = model.coordinates()[i].rate;
            !model.is_dependent(i) && rate.is_some_and(|rate| share.rates.contains(&rate) == muscled)
        });
        JointLimit::first(coordinates.filter_map(|i| joint_limit(model, body, i)))
    };
    Ok(HeldPosture {
        asked: seconds,
        groups: asked.group_fatigue(&rested, &tired),
        joint_law: by_joint(true),
        without_muscles: by_joint(false),
        end,
        share,
        rested,
        tired,
        muscles: table,
    })
}

/// The time for which the group of a coordinate holds its torque by the law of its joint.
fn joint_limit(model: &Model, body: &JointTorques, coordinate: usize) -> Option<JointLimit> {
    let of = &model.coordinates()[coordinate];
    let active = body.active_torque()[of.rate?];
    let side = Side::of(active);
    let load = relative_load(of, body.angles()[coordinate], active);
    let seconds = of.groups.as_ref()?[side.index()].fatigue.endurance_time(load);
    Some(JointLimit { coordinate, side, load, seconds })
}
