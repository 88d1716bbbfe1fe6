//! `contrapposto muscle`: path, moment arms, fibres and forces of one muscle in a posture, with its force-length curves.

use contrapposto::kinematics::Kinematics;
use contrapposto::muscle::{FiberState, Muscle, PathGeometry};
use contrapposto::posture::Posture;
use contrapposto_formats::nearest;
use contrapposto_formats::tissue::SourcedModel;
use contrapposto_plot::{ForceLength, force_length};

use super::opened::{held_posture, opened_muscles, path_rule};
use crate::args::OneMuscleArgs;
use crate::fail::Fail;
use crate::motion_file::note_values_out_of_range;
use crate::output::{Folder, print, print_note};
use crate::view::text::muscle::{Curves, ShownMuscle, json, readable};

/// Lengths of fibres over which curves are drawn, over the optimal length.
const DRAWN_LENGTHS: (f64, f64) = (0.4, 1.8);
/// Number of their intervals.
const CURVE_PARTS: usize = 140;
/// Most names of muscles in a message.
const LISTED_MUSCLES: usize = 12;

pub(crate) fn muscle(args: &OneMuscleArgs) -> Result<(), Fail> {
    let (opened, mut notes) = opened_muscles(&args.model)?;
    let index = find(&opened, &args.name)?;
    let frame = held_posture(&args.posture, &args.frames, &opened.model, &mut notes)?;
    let warnings = note_values_out_of_range(&opened, std::slice::from_ref(&frame), &mut notes);
    warnings.iter().for_each(|warning| print_note("warning", warning));
    notes.iter().for_each(|note| print_note("note", note));
    let geometry = geometry(&opened, &frame.1, args)?;
    let muscle = &opened.muscles.muscles[index];
    let length = geometry.lengths()[muscle.spec().path];
    let state = |activation: f64| muscle.at_rest(length, activation);
    let mut shown = ShownMuscle {
        index,
        time: frame.0,
        rule: args.rule,
        activation: args.activation.max(muscle.spec().least_activation),
        geometry: &geometry,
        rest: state(args.activation),
        full: state(1.0),
        curves: curves(muscle, length),
        files: vec![],
    };
    if let Some(out) = &args.out {
        shown.files = draw(&Folder::open(out)?, muscle, &shown)?;
    }
    print(&if args.json { json(&opened, &shown)? } else { readable(&opened, &shown) })
}

/// The muscle of a name.
fn find(opened: &SourcedModel, name: &str) -> Result<usize, Fail> {
    let names: Vec<&str> = opened.muscles.muscles.iter().map(|muscle| muscle.spec().name.as_str()).collect();
    if let Some(index) = names.iter().position(|known| *known == name) {
        return Ok(index);
    }
    let hint = nearest(name, names.iter().copied()).map(|near| format!("; did you mean `{near}`?"));
    let mut listed = names.iter().take(LISTED_MUSCLES).copied().collect::<Vec<_>>().join(", ");
    if names.len() > LISTED_MUSCLES {
        listed += &format!(" and {} more, which `contrapposto muscles` lists", names.len() - LISTED_MUSCLES);
    }
    Err(Fail::Refused(format!("there is no muscle `{name}`{}\n  muscles: {listed}", hint.unwrap_or_default())))
}

fn geometry(opened: &SourcedModel, posture: &Posture, args: &OneMuscleArgs) -> Result<PathGeometry, Fail> {
    let (model, paths) = (&opened.model, &opened.muscles.paths);
    let mut kinematics = Kinematics::new(model);
    let refused = |why| Fail::Refused(format!("{}: {why}", args.posture.display()));
    kinematics.update(model, posture).map_err(refused)?;
    let mut geometry = PathGeometry::new(model, paths);
    geometry.update(model, &kinematics, paths, path_rule(args.rule));
    Ok(geometry)
}

/// Forces of the fibres over their length.
fn curves(muscle: &Muscle, path_length: f64) -> Curves {
    let optimal = muscle.spec().optimal_fiber_length;
    let mut curves = Curves::default();
    for i in 0..=CURVE_PARTS {
        let (first, last) = DRAWN_LENGTHS;
        let relative = first + (last - first) * i as f64 / CURVE_PARTS as f64;
        let state = muscle.at_fiber_length(path_length, relative * optimal, 1.0);
        // Fibres that are shorter than their least length, or upright on the tendon, have no such state.
        if (state.fiber_length / optimal - relative).abs() > 1e-9 || state.cos_pennation <= 0.0 {
            continue;
        }
        let [active, passive] = along_fibers(muscle, &state);
        curves.lengths.push(relative);
        curves.active.push(active);
        curves.passive.push(passive);
    }
    curves
}

/// Active and passive force along the fibres, over the greatest isometric force; none of fibres that are upright on the tendon.
fn along_fibers(muscle: &Muscle, state: &FiberState) -> [f64; 2] {
    let along = state.cos_pennation * muscle.spec().max_isometric_force;
    [state.active_force, state.passive_force].map(|force| if along > 0.0 { force / along } else { 0.0 })
}

/// Draws the curves, as SVG and PNG; returns the files' paths.
fn draw(folder: &Folder, muscle: &Muscle, shown: &ShownMuscle<'_>) -> Result<Vec<String>, Fail> {
    let name = &muscle.spec().name;
    let point = |state: &FiberState| {
        let [active, passive] = along_fibers(muscle, state);
        (state.fiber_length / muscle.spec().optimal_fiber_length, active + passive)
    };
    let state = |name: String, state: &FiberState| (name, point(state).0, point(state).1);
    let chart = ForceLength {
        title: format!("Fibres of {name}"),
        subtitle: format!(
            "{}; active force at full activation; dots: the present state, by activation",
            shown.law(muscle)
        ),
        lengths: shown.curves.lengths.clone(),
        active: shown.curves.active.clone(),
        passive: shown.curves.passive.clone(),
        states: vec![
            state(format!("now, at {}", shown.activation), &shown.rest),
            state("now, at 1".to_owned(), &shown.full),
        ],
    };
    let figure = force_length(&chart);
    let safe: String =
        name.chars().map(|c| if c.is_alphanumeric() || c == '_' || c == '-' { c } else { '_' }).collect();
    let files = ["svg", "png"].map(|ending| format!("muscle-{safe}.{ending}"));
    let png = figure.png().map_err(|error| Fail::job("PNG", error))?;
    folder.write(&[(&files[0], figure.svg().into_bytes()), (&files[1], png)])?;
    Ok(files.iter().map(|file| folder.path(file).display().to_string()).collect())
}
