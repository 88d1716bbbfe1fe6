//! `contrapposto scale`: a model of the size of a person, by the markers of a static trial.

mod doubts;
mod files;
mod measured;
mod placing;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto::muscle::{PathGeometry, PathRule};
use contrapposto_formats::markers::{ScaleSetup, marker_set, read_markers, scale_setup};
use contrapposto_formats::motion::MOST_TABLE_BYTES;
use contrapposto_formats::osim::scaling::{self, Scaling};
use contrapposto_formats::tissue::SourcedModel;
use contrapposto_formats::xml::Limits;

use super::track::print_other_files;
use crate::args::ScaleArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::model_file::confined;
use crate::output::{Folder, folder_and_name, print, print_note};
use files::{frames, opened, refused, time_range};
use measured::Measured;

/// Largest mass of a person, kg (assumed: above all that live).
const MOST_MASS: f64 = 1000.0;

pub(crate) fn scale(args: &ScaleArgs) -> Result<(), Fail> {
    check(args)?;
    let setup = setup(args)?;
    let mass = mass(args, &setup)?;
    let shown = args.model.display().to_string();
    let bytes = read(&args.model, Limits::default().file_bytes as u64)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| Fail::Refused(format!("{shown}: {error}")))?;
    let bodies = scaling::bodies(text, &shown).map_err(refused)?;
    let text = with_marker_set(args, &setup, text.to_owned(), (&shown, &bodies))?;
    let name = args.markers.display().to_string();
    let units = args.units.map(crate::args::UnitChoice::unit);
    let markers = read_markers(&name, &read(&args.markers, MOST_TABLE_BYTES as u64)?, units)?;
    print_other_files(args.setup.as_deref(), &setup.named, [&args.model, &args.markers]);
    markers.warnings.iter().for_each(|warning| print_note("warning", warning));
    let before = opened(&shown, &text)?;
    let averaged = frames(&markers, &name, time_range(args, setup.time_range))?;
    doubts::refuse_other_unit(&before, (&markers, &name), averaged.clone())?;
    let measured = Measured::new(args, &setup, (&before, &bodies), (&markers, &name))?;
    let scaling = Scaling {
        factors: measured.factors.clone(),
        preserve_mass_distribution: setup.preserve_mass_distribution || args.preserve_mass_distribution,
        mass,
        name: setup.name.clone(),
    };
    let scaled = scaled(&shown, &text, &before, &scaling)?;
    let swapped = doubts::sides(&opened(&shown, &scaled)?, (&markers, &name), setup.placing.as_ref(), averaged);
    swapped.iter().for_each(|warning| print_note("warning", warning));
    let mut answer = first_line(args, &before, (&measured, bodies.len()), &scaled)?;
    let text = if setup.placing.is_some() || args.place_markers {
        let placed = placing::place(args, &setup, &scaled, (&markers, &name))?;
        answer.push_str(&placed.line);
        placed.text
    } else {
        scaled
    };
    answer.push_str(&measured.lines());
    let (folder, file) = folder_and_name(&args.out)?;
    Folder::open(&folder)?.write(&[(&file, text.as_bytes())])?;
    print(&answer)?;
    print(&format!("{}\n", args.out.display()))
}

/// Refuses arguments that cannot be meant.
fn check(args: &ScaleArgs) -> Result<(), Fail> {
    let is = |path: &Path, ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    let (model, markers, out) = (args.model.display(), args.markers.display(), args.out.display());
    if is(&args.model, "trc") || is(&args.model, "c3d") || is(&args.markers, "osim") {
        let why = format!("the model comes first, then the markers: contrapposto scale {markers} {model} ...");
        return Err(Fail::Refused(format!("{model}: {why}")));
    }
    if !is(&args.out, "osim") {
        return Err(Fail::Refused(format!("{out}: the name must end in .osim")));
    }
    let same = |a: &Path, b: &Path| a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b);
    if same(&args.model, &args.out) {
        return Err(Fail::Refused(format!("{out}: is the model file itself; give another name")));
    }
    Ok(())
}

/// Mass that the person is said to have, kg.
fn mass(args: &ScaleArgs, setup: &ScaleSetup) -> Result<Option<f64>, Fail> {
    let Some(mass) = args.mass.or(setup.mass) else { return Ok(None) };
    if mass > 0.0 && mass <= MOST_MASS {
        return Ok(Some(mass));
    }
    let said = match (&args.mass, &args.setup) {
        (None, Some(path)) => format!("{}: <mass>", path.display()),
        _ => "--mass".to_owned(),
    };
    Err(Fail::Refused(format!("{said}: is {mass} kg; above 0 kg to {MOST_MASS} kg is accepted")))
}

fn setup(args: &ScaleArgs) -> Result<ScaleSetup, Fail> {
    let Some(path) = &args.setup else { return Ok(ScaleSetup::default()) };
    let bytes = read(path, Limits::default().file_bytes as u64)?;
    scale_setup(&path.display().to_string(), &bytes).map_err(refused)
}

/// The model with the markers that the setup file gives it.
fn with_marker_set(
    args: &ScaleArgs,
    setup: &ScaleSetup,
    text: String,
    (shown, bodies): (&str, &[String]),
) -> Result<String, Fail> {
    let (Some(file), Some(path)) = (&setup.marker_set_file, &args.setup) else { return Ok(text) };
    let most = Limits::default().file_bytes as u64;
    let bytes = confined(path, most)(file).map_err(|why| {
        let setup = path.display();
        Fail::Refused(format!(
            "{setup}: <marker_set_file> `{file}`: {why}; a file in the folder of the setup file is accepted"
        ))
    })?;
    let markers = marker_set(file, &bytes, bodies).map_err(refused)?;
    scaling::with_markers(&text, shown, &markers).map_err(refused)
}

/// The scaled text, with the lengths of muscles; counts all that was not scaled.
fn scaled(shown: &str, text: &str, before: &SourcedModel, scaling: &Scaling) -> Result<String, Fail> {
    let bodies = scaling::scaled(text, shown, scaling).map_err(refused)?;
    let after = opened(shown, &bodies.text)?;
    let (old, new) = (path_lengths(before), path_lengths(&after));
    let growth = |name: &str| {
        let growth = new.get(name)? / old.get(name)?;
        (growth.is_finite() && growth > 0.0).then_some(growth)
    };
    let paths = scaling::with_path_lengths(&bodies.text, shown, &growth).map_err(refused)?;
    for (kind, count) in bodies.left.iter().chain(&paths.left) {
        print_note("warning", &format!("{shown}: {count} {kind} were not scaled"));
    }
    Ok(paths.text)
}

/// Lengths of the paths of muscles, ligaments and springs in the default posture, m, by OpenSim's rule.
fn path_lengths(opened: &SourcedModel) -> HashMap<&str, f64> {
    let (model, muscles) = (&opened.model, &opened.muscles);
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    geometry.update(model, &Kinematics::new(model), &muscles.paths, PathRule::OpenSim);
    let of_muscles = muscles.muscles.iter().map(|muscle| (muscle.spec().name.as_str(), muscle.spec().path));
    let of_ligaments = muscles.ligaments.iter().map(|ligament| (ligament.name.as_str(), ligament.path));
    of_muscles.chain(of_ligaments).map(|(name, path)| (name, geometry.lengths()[path])).collect()
}

/// The first line: mass and factors.
fn first_line(
    args: &ScaleArgs,
    before: &SourcedModel,
    (measured, bodies): (&Measured<'_>, usize),
    text: &str,
) -> Result<String, Fail> {
    let after = opened(&args.model.display().to_string(), text)?;
    let (was, is) = (before.model.mass(), after.model.mass());
    let count = measured.factors.len();
    let mut line = format!("Scaled {count} of {bodies} bodies: {is:.2} kg (was {was:.2} kg)");
    if let Some([(least, of_least), (most, of_most)]) = measured.extremes() {
        let _ = write!(line, ", factors from {least:.3} (`{of_least}`) to {most:.3} (`{of_most}`)");
    }
    line.push_str(".\n");
    Ok(line)
}
