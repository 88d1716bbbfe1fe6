//! MODEL on the command line: a file of one of three formats, or the built-in adult; an overlay and the built-in passive
//! library laid over it.

mod include;

use std::path::Path;

use contrapposto::joint_torques::JointMuscles;
use contrapposto::model::Adult;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::tissue::{HipTissue, MuscleUse, ScenarioMuscles, SourcedModel};
use contrapposto_formats::xml::Limits;
use contrapposto_formats::{MOST_BYTES, ModelFileError, ModelFormat, adult_size, scenario_adult};

use crate::args::{ModelArgs, PassiveFrom, RootChoice, use_muscles};
use crate::fail::Fail;
use crate::input::read;
use crate::output::print_note;

pub(crate) use include::confined;

/// Opens MODEL, with --overlay and --passive. `filled`: unknown passive laws of a file are filled in from the built-in library
/// where neither --passive nor --overlay is given.
pub(crate) fn open(args: &ModelArgs, filled: bool) -> Result<SourcedModel, Fail> {
    Ok(open_with(args, filled, None, SourcedModel::read)?.0)
}

/// Opens MODEL, what is unknown filled in, and gives its muscles what is asked of them under some name; with warnings about these muscles.
pub(crate) fn open_with_muscles(
    args: &ModelArgs,
    muscles: (Option<MuscleUse>, &str),
) -> Result<(SourcedModel, Option<JointMuscles>, Vec<String>), Fail> {
    with_joint_muscles(open_with(args, true, Some(muscles), SourcedModel::read)?)
}

/// A model with the muscles of its joints, from the model and the same one without muscles; with warnings about these muscles.
pub(crate) fn with_joint_muscles(
    (mut opened, library): (SourcedModel, Option<SourcedModel>),
) -> Result<(SourcedModel, Option<JointMuscles>, Vec<String>), Fail> {
    let (muscles, doubts) = library.map_or((None, vec![]), |library| opened.joint_muscles(&library));
    doubts.iter().for_each(|doubt| print_note("warning", doubt));
    Ok((opened, muscles, doubts))
}

/// As [`open_with_muscles`], for a scenario.
pub(crate) fn open_for_scenario(
    args: &ModelArgs,
    (muscles, hip_tract): ((Option<MuscleUse>, &str), HipTissue),
) -> Result<(SourcedModel, Option<ScenarioMuscles>), Fail> {
    let (mut opened, library) = open_with(args, true, Some(muscles), SourcedModel::read)?;
    let no_muscles = || Fail::Refused(format!("{}: there are none, which `hip_tract` would stand beside", muscles.1));
    let Some(library) = library else {
        return if hip_tract == HipTissue::Off { Ok((opened, None)) } else { Err(no_muscles()) };
    };
    opened.add_hip_tracts(&library, hip_tract).map_err(|why| Fail::Refused(format!("{}: {why}", muscles.1)))?;
    let refused = |error| Fail::Refused(format!("{}: {error}; write \"strength\" or \"off\"", muscles.1));
    let (muscles, doubts) = opened.scenario_muscles(&library).map_err(refused)?;
    doubts.iter().for_each(|doubt| print_note("warning", doubt));
    Ok((opened, muscles))
}

/// Opens MODEL for a command in which mass has no part, or which says that it is missing: a body whose mass comes from a mesh has none.
pub(crate) fn open_without_mesh_mass(args: &ModelArgs, filled: bool) -> Result<SourcedModel, Fail> {
    Ok(open_with(args, filled, None, SourcedModel::read_without_mesh_mass)?.0)
}

/// A function that reads a model file.
type Read = fn(
    &str,
    &[u8],
    Option<RootAttachment>,
    &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<SourcedModel, ModelFileError>;

/// The model, and where muscles are in question the same model without them.
fn open_with(
    args: &ModelArgs,
    filled: bool,
    muscles: Option<(Option<MuscleUse>, &str)>,
    read_file: Read,
) -> Result<(SourcedModel, Option<SourcedModel>), Fail> {
    let root = args.root.map(RootChoice::body);
    let mut opened = match built_in(&args.model)? {
        Some(_) if root.is_some() => {
            let why = "the built-in adult has six root coordinates of its own (pelvis_tilt .. pelvis_tz)";
            return Err(Fail::Refused(format!("--root: {}", ModelFileError::RootGiven(why))));
        }
        Some(_) if args.person.is_some() => {
            let why = "the built-in adult has a size of its own: `adult:female,1.65m,60kg`";
            return Err(Fail::Refused(format!("--person: {why}")));
        }
        Some(size) => SourcedModel::adult(&size).map_err(refused)?,
        None if args.no_strength => file(&args.model, root, read_file)?.without_strength(),
        None => file(&args.model, root, read_file)?,
    };
    opened.warnings().iter().for_each(|warning| print_note("warning", warning));
    if let Some(path) = &args.overlay {
        opened = opened.lay_over(&path.display().to_string(), &read(path, MOST_BYTES)?)?;
    }
    let fill = match args.passive {
        Some(from) => from == PassiveFrom::Library,
        None => filled && args.overlay.is_none(),
    };
    if filled && !fill && args.passive.is_none() && opened.format != ModelFormat::Adult {
        let text = "with an overlay nothing else is filled from the built-in data; --passive library does so";
        opened.notes.push(text.to_owned());
    }
    let person = args.person.unwrap_or_default();
    completed(opened, muscles, |opened| {
        let refused = |error| Fail::Refused(format!("--person: {error}"));
        if fill { opened.fill(&person).map_err(refused) } else { Ok(opened) }
    })
}

/// Gives the muscles of a model what is asked of them, and completes it by `filled`; where muscles are in question the same model without
/// them, too.
pub(crate) fn completed(
    mut opened: SourcedModel,
    muscles: Option<(Option<MuscleUse>, &str)>,
    filled: impl Fn(SourcedModel) -> Result<SourcedModel, Fail>,
) -> Result<(SourcedModel, Option<SourcedModel>), Fail> {
    let library = muscles.map(|_| opened.clone());
    if let Some(muscles) = muscles {
        use_muscles(&mut opened, muscles)?;
    }
    Ok((filled(opened)?, library.map(filled).transpose()?))
}

/// Size of the built-in adult that MODEL names: as a text, or as a scenario (.toml) that describes it.
pub(crate) fn built_in(model: &Path) -> Result<Option<Adult>, Fail> {
    if let Some(size) = model.to_str().and_then(adult_size) {
        return size.map(Some).map_err(refused);
    }
    if model.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        let bytes = read(model, MOST_BYTES)?;
        let name = model.display().to_string();
        let (size, others) = scenario_adult(&name, &bytes)?;
        if !others.is_empty() {
            let list = others.iter().map(|table| format!("[{table}]")).collect::<Vec<_>>().join(", ");
            print_note("note", &format!("{name}: as MODEL it gives its body only; not used: {list}"));
        }
        return Ok(Some(size));
    }
    Ok(None)
}

fn refused(error: impl std::fmt::Display) -> Fail {
    Fail::Refused(error.to_string())
}

fn file(path: &Path, root: Option<RootAttachment>, read_file: Read) -> Result<SourcedModel, Fail> {
    let most = Limits::default().file_bytes as u64;
    let bytes = read(path, most)?;
    let name = path.display().to_string();
    read_file(&name, &bytes, root, &mut confined(path, most)).map_err(|error| refused_file(&name, error))
}

/// The failure that a model file of that name is.
pub(crate) fn refused_file(name: &str, error: ModelFileError) -> Fail {
    match error {
        ModelFileError::RootGiven(_) => Fail::Refused(format!("--root: {error}")),
        // These name the file themselves.
        ModelFileError::OpenSim(_) => refused(error),
        error => Fail::Refused(format!("{name}: {error}")),
    }
}
