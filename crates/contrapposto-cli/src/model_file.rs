//! MODEL on the command line: a file of one of three formats, or the built-in adult; an overlay and the built-in passive
//! library laid over it.

mod adult_text;
mod fill;
mod include;
mod tissue;

use std::path::Path;

use contrapposto::model::Model;
use contrapposto_formats::body::{Body, BodyRoot, Imported};
use contrapposto_formats::xml::{self, Limits};
use contrapposto_formats::{MOST_BYTES, mjcf, osim, overlay, urdf};

use crate::args::{ModelArgs, PassiveFrom, RootChoice};
use crate::fail::Fail;
use crate::input::read;

pub(crate) use adult_text::adult_size;
pub(crate) use tissue::Tissue;

/// Who described the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    OpenSim,
    Urdf,
    Mjcf,
    /// The built-in adult.
    Adult,
}

impl Format {
    /// As in reports.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::OpenSim => "OpenSim",
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Adult => "built-in adult",
        }
    }
}

/// Where a number of a coordinate comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The model file.
    #[default]
    File,
    /// The overlay.
    Overlay,
    /// The built-in data.
    Library,
}

/// Where the numbers of one coordinate come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Origins {
    /// The adult's coordinate whose data are used.
    pub(crate) twin: Option<String>,
    /// Range that the built-in passive law is meant for, in the coordinate's direction.
    pub(crate) meant: Option<(f64, f64)>,
    pub(crate) range: Origin,
    pub(crate) passive: Origin,
    pub(crate) strength: Origin,
    pub(crate) fatigue: Origin,
}

/// A model, ready to compute with.
#[derive(Debug)]
pub(crate) struct Opened {
    pub(crate) model: Model,
    pub(crate) format: Format,
    /// By coordinate.
    pub(crate) origins: Vec<Origins>,
    /// What was read past, changed or laid over it, one plain sentence each.
    pub(crate) notes: Vec<String>,
}

/// Opens MODEL and lays over it what was asked for; `filled` says whether a file's unknown passive laws are filled from the
/// built-in library when nothing is said.
pub(crate) fn open(args: &ModelArgs, filled: bool) -> Result<Opened, Fail> {
    let (imported, format) = match args.model.to_str().and_then(adult_size) {
        Some(size) => (adult(size?, args.root)?, Format::Adult),
        None => file(&args.model, args.root)?,
    };
    let Imported { mut model, notes } = imported;
    let mut notes = gathered(notes);
    let mut origins = vec![Origins::default(); model.coordinates().len()];
    if format == Format::Adult {
        let library = Origin::Library;
        for (origins, coordinate) in origins.iter_mut().zip(model.coordinates()) {
            let (twin, meant) = (Some(coordinate.name.clone()), Some(coordinate.range));
            *origins = Origins { twin, meant, range: library, passive: library, strength: library, fatigue: library };
        }
    }
    if let Some(path) = &args.overlay {
        let laid = overlay(&path.display().to_string(), &read(path, MOST_BYTES)?, model)?;
        model = laid.model;
        for change in laid.changes {
            let origins = &mut origins[change.coordinate];
            for (changed, origin) in [
                (change.range, &mut origins.range),
                (change.passive, &mut origins.passive),
                (change.strength, &mut origins.strength),
                (change.fatigue, &mut origins.fatigue),
            ] {
                if changed {
                    *origin = Origin::Overlay;
                }
            }
            notes.push(change.note);
        }
    }
    let fill = match args.passive {
        Some(from) => from == PassiveFrom::Library,
        None => filled && args.overlay.is_none(),
    };
    if filled && !fill && args.passive.is_none() && format != Format::Adult {
        let text = "with an overlay nothing else is filled from the built-in data; --passive library does so";
        notes.push(text.to_owned());
    }
    if fill && format != Format::Adult {
        model = fill::fill(model, format, &mut origins, &mut notes)?;
    }
    Ok(Opened { model, format, origins, notes })
}

fn adult(size: contrapposto::model::Adult, root: Option<RootChoice>) -> Result<Imported, Fail> {
    refuse_root(root, "the built-in adult has six root coordinates of its own (pelvis_tilt .. pelvis_tz)")?;
    let model = contrapposto::model::adult(&size).map_err(|error| Fail::Refused(error.to_string()))?;
    Ok(Imported { model, notes: vec![] })
}

fn refuse_root(root: Option<RootChoice>, why: &str) -> Result<(), Fail> {
    match root {
        None => Ok(()),
        Some(_) => Err(Fail::Refused(format!("--root goes with URDF and MJCF files; {why}"))),
    }
}

fn file(path: &Path, root: Option<RootChoice>) -> Result<(Imported, Format), Fail> {
    let limits = Limits::default();
    let bytes = read(path, limits.file_bytes as u64)?;
    let shown = path.display().to_string();
    let refuse = |error: &dyn std::fmt::Display| Fail::Refused(format!("{shown}: {error}"));
    let format = format_of(path, &bytes, &limits)?;
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let body: Body = match format {
        Format::OpenSim => {
            refuse_root(root, "an OpenSim model's root is what its joint to ground says")?;
            // Its errors name the file themselves.
            osim::read(&bytes, &shown).map_err(|error| Fail::Refused(error.to_string()))?
        }
        Format::Urdf => {
            let root = root.map_or(BodyRoot::Fixed, RootChoice::body);
            urdf::read(&bytes, &stem, &urdf::Options { root, limits }).map_err(|error| refuse(&error))?
        }
        Format::Mjcf | Format::Adult => {
            let root = root.map(RootChoice::body);
            let mut include = include::confined(path, limits.file_bytes as u64);
            let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            let options = mjcf::Options { root, limits };
            mjcf::read(&bytes, &name, &mut include, &options).map_err(|error| refuse(&error))?
        }
    };
    Ok((body.model().map_err(|error| refuse(&error))?, format))
}

/// By the name's ending where it is telling, else by the outermost element.
fn format_of(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Format, Fail> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("osim") => return Ok(Format::OpenSim),
        Some("urdf") => return Ok(Format::Urdf),
        Some("mjcf") => return Ok(Format::Mjcf),
        _ => {}
    }
    let refuse = |why: String| Fail::Refused(format!("{}: {why}", path.display()));
    let document = xml::parse(bytes, limits).map_err(|error| refuse(error.to_string()))?;
    match document.root().name() {
        "OpenSimDocument" => Ok(Format::OpenSim),
        "robot" => Ok(Format::Urdf),
        // An MJCF file that is included elsewhere may begin otherwise; it is no model on its own.
        "mujoco" => Ok(Format::Mjcf),
        other => Err(refuse(format!(
            "the outermost element is <{other}>; a model is <OpenSimDocument> (.osim), <robot> (.urdf) or <mujoco> (MJCF)"
        ))),
    }
}

/// Notes of what was read past, made one.
fn gathered(notes: Vec<String>) -> Vec<String> {
    let (past, mut rest): (Vec<String>, Vec<String>) = notes.into_iter().partition(|note| note.ends_with(" ignored"));
    if !past.is_empty() {
        let kinds: Vec<&str> = past.iter().map(|note| note.trim_end_matches(" ignored")).collect();
        rest.insert(0, format!("not needed at rest and read past: {}", kinds.join(", ")));
    }
    rest
}
