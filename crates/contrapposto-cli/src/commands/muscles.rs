//! `contrapposto muscles`: path, forces and moment arms of every muscle of a body at rest, and the strength of its joints.

mod hold;
pub(crate) mod one;
mod opened;

use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto::muscle::{FiberState, PathGeometry, bushing_torque, coupled_strength, passive_torque, strength};
use contrapposto::posture::Posture;
use contrapposto_formats::tissue::SourcedModel;

use self::opened::{opened_muscles, path_rule};
use crate::args::{MusclesArgs, RuleChoice};
use crate::fail::Fail;
use crate::motion_file::{note_values_out_of_range, read_motion};
use crate::output::{print, print_note};
use crate::view::text::muscles::{MuscleFrame, json, readable};

pub(crate) fn muscles(args: &MusclesArgs) -> Result<(), Fail> {
    if args.model.model == Path::new("-") && args.postures == Path::new("-") {
        return Err(Fail::Refused("standard input is one file: MODEL or POSTURES, not both".to_owned()));
    }
    if let Some(seconds) = args.hold.hold {
        return hold::hold(args, seconds);
    }
    args.hold.refuse_without_hold()?;
    let (opened, mut notes) = opened_muscles(&args.model)?;
    let model = &opened.model;
    let frames = match args.postures == Path::new("default") {
        true => vec![(0.0, model.default_posture())],
        false => {
            let accepted = "POSTURES is a .mot, .sto or .csv file, or `default`";
            read_motion(&args.postures, accepted, &args.hold.under.frames, model, &mut notes)?
        }
    };
    let warnings = note_values_out_of_range(&opened, &frames, &mut notes);
    warnings.iter().for_each(|warning| print_note("warning", warning));
    notes.iter().for_each(|note| print_note("note", note));
    each_frame(&opened, &frames, (args.rule, args.activation), |frame| {
        print(&if args.json { json(&opened, frame)? } else { readable(&opened, frame) })
    })
}

/// Computes frame after frame, by a rule and at an activation, and shows each to `visit`.
pub(crate) fn each_frame<'a>(
    opened: &SourcedModel,
    frames: impl IntoIterator<Item = &'a (f64, Posture)>,
    (choice, activation): (RuleChoice, f64),
    mut visit: impl FnMut(&MuscleFrame<'_>) -> Result<(), Fail>,
) -> Result<(), Fail> {
    let (model, muscles) = (&opened.model, &opened.muscles);
    let rule = path_rule(choice);
    let mut kinematics = Kinematics::new(model);
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    let (mut strengths, mut passive) = (vec![[0.0; 2]; model.rates().len()], vec![0.0; model.rates().len()]);
    let mut of_bushings = passive.clone();
    let none = vec![0.0; model.rates().len()];
    for (index, (time, posture)) in frames.into_iter().enumerate() {
        kinematics.update(model, posture).map_err(|why| Fail::Refused(format!("instant {index}: {why}")))?;
        geometry.update(model, &kinematics, &muscles.paths, rule);
        let states = |activation: f64| -> Vec<FiberState> {
            let all = muscles.muscles.iter();
            all.map(|muscle| muscle.at_rest(geometry.lengths()[muscle.spec().path], activation)).collect()
        };
        let (rest, full) = (states(activation), states(1.0));
        strength(muscles, &geometry, &rest, &full, &mut strengths);
        passive_torque(muscles, &geometry, &rest, &mut passive);
        bushing_torque(&muscles.bushings, model, &kinematics, &mut of_bushings);
        passive.iter_mut().zip(&of_bushings).for_each(|(passive, more)| *passive += more);
        let coupled = coupled_strength(muscles, &geometry, &rest, &full, &geometry.crossed(model), &none);
        let frame = MuscleFrame {
            index,
            time: *time,
            rule: choice,
            activation,
            geometry: &geometry,
            rest: &rest,
            full: &full,
            strength: &strengths,
            coupled: &coupled,
            passive: &passive,
        };
        visit(&frame)?;
    }
    Ok(())
}
