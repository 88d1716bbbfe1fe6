//! SCENARIO on the command line: its bytes, its name, and the model file that it names.

use std::fmt::Write;
use std::path::Path;

use contrapposto::model::Model;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::tissue::{MuscleUse, ScenarioMuscles};
use contrapposto_formats::{MOST_BYTES, ModelFile, scenario_model};
use serde_json::Value;

use crate::args::{ModelArgs, RootChoice};
use crate::fail::Fail;
use crate::input::{confined, read};
use crate::model_file::open_for_scenario;
use crate::output::print_note;

/// A scenario file that was read, not yet understood.
pub(crate) struct ScenarioFile {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    /// The model that it names, if it names one.
    pub(crate) model: Option<Model>,
    /// The muscles of that model, where the scenario uses them.
    pub(crate) muscles: Option<ScenarioMuscles>,
}

impl ScenarioFile {
    pub(crate) fn read(path: &Path) -> Result<Self, Fail> {
        let name = path.display().to_string();
        refuse_model(path, &name)?;
        let bytes = read(path, MOST_BYTES)?;
        let (model, muscles) = model_of(path, &name, &bytes)?.unzip();
        Ok(Self { name, bytes, model, muscles: muscles.flatten() })
    }

    /// From a text; the files that it names are in the present folder.
    pub(crate) fn of_text(text: &str) -> Result<Self, Fail> {
        let name = "scenario.toml".to_owned();
        if text.len() as u64 > MOST_BYTES {
            return Err(Fail::Refused(format!(
                "the scenario is {} bytes long; {MOST_BYTES} at most are read",
                text.len()
            )));
        }
        let (model, muscles) = model_of(Path::new(&name), &name, text.as_bytes())?.unzip();
        Ok(Self { name, bytes: text.as_bytes().to_vec(), model, muscles: muscles.flatten() })
    }

    /// As [`Self::read`]; the body starts in the posture of a result, if one is given.
    pub(crate) fn read_from(path: &Path, start: Option<&Path>) -> Result<Self, Fail> {
        let mut file = Self::read(path)?;
        if let Some(start) = start {
            file.bytes.extend(start_table(start)?.bytes());
        }
        Ok(file)
    }
}

/// Largest result that a start is read from, bytes.
const MOST_RESULT_BYTES: u64 = 64 << 20;

/// The table `[start_from]` of a scenario with the coordinates of `pose.json`, or of the first posture of `relax.json`. At the end of
/// a scenario it leaves all lines where they are.
fn start_table(path: &Path) -> Result<String, Fail> {
    let name = path.display();
    let refused = |why: String| Fail::Refused(format!("--start-from {name}: {why}"));
    let json: Value = serde_json::from_slice(&read(path, MOST_RESULT_BYTES)?)
        .map_err(|error| refused(format!("is no JSON file: {error}")))?;
    let coordinates = json.get("coordinates").or_else(|| json.pointer("/postures/0/coordinates"));
    let coordinates = coordinates.and_then(Value::as_object).ok_or_else(|| {
        refused("has no `coordinates`; `pose.json` has them, and `relax.json` for each of its postures".to_owned())
    })?;
    let mut table = "\n[start_from]\n".to_owned();
    for (coordinate, value) in coordinates {
        let Some(value) = value.as_f64() else {
            return Err(refused(format!("`{coordinate}` of `coordinates` is no number; `pose.json` has one for each")));
        };
        // Names in JSON strings are names in TOML strings.
        let _ = writeln!(table, "{} = {value:?}", Value::String(coordinate.clone()));
    }
    Ok(table)
}

/// Refuses a model file, or a motion, where a scenario is due.
fn refuse_model(path: &Path, name: &str) -> Result<(), Fail> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    if ["mot", "sto", "trc", "c3d"].contains(&ending.as_str()) {
        let why = "is a motion, not a scenario; `contrapposto assess MODEL MOTION` and `torques MODEL MOTION` take it";
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    if !["osim", "urdf", "xml", "mjcf"].contains(&ending.as_str()) {
        return Ok(());
    }
    let why = format!(
        "is a model, not a scenario. A scenario (.toml) names it: [model] file = \"{name}\". Commands for models: inspect, torques, \
         assess, convert"
    );
    Err(Fail::Refused(format!("{name}: {why}")))
}

/// The model file that a scenario names, if it names one, and its muscles in use.
fn model_of(scenario: &Path, name: &str, bytes: &[u8]) -> Result<Option<(Model, Option<ScenarioMuscles>)>, Fail> {
    let Some(file) = scenario_model(name, bytes)? else { return Ok(None) };
    let key = format!("{name}: [model] muscles");
    let uses = file.muscles.or_else(|| file.multiplies_data.then_some(MuscleUse::Off));
    let args = model_args(scenario, name, &file)?;
    let (opened, muscles) = open_for_scenario(&args, ((uses, key.as_str()), file.hip_tract))?;
    let muscles = muscles.map(|muscles| muscles.with_sharing(file.sharing));
    if file.muscles.is_none() && file.multiplies_data && opened.default_muscle_use() != MuscleUse::Off {
        let why =
            "[strength] and [passive] spread multiply the built-in data, so that the model's muscles give nothing";
        print_note("note", why);
    }
    let opened = opened.with_fatigue(&file.fatigue);
    if opened.model.coordinates().iter().all(|coordinate| coordinate.groups.is_none()) {
        let unknown = "no strength of its joints is known: their load, fatigue and effort are unknown, not 0";
        let model = opened.model.name();
        print_note("warning", &format!("`{model}`: {unknown}; lay one over it with `overlay` in [model]"));
    }
    opened.notes.iter().for_each(|note| print_note("note", note));
    Ok(Some((opened.model, muscles)))
}

/// Arguments that open the scenario's model file: the file's paths are seen from the scenario's folder.
fn model_args(scenario: &Path, shown: &str, file: &ModelFile) -> Result<ModelArgs, Fail> {
    let folder = scenario.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = |key: &str, name: &String| {
        confined(folder, name).map_err(|why| Fail::Refused(format!("{shown}: [model] {key} = {name:?}: {why}")))
    };
    Ok(ModelArgs {
        model: path("file", &file.file)?,
        overlay: file.overlay.as_ref().map(|name| path("overlay", name)).transpose()?,
        root: file.root.map(|root| match root {
            RootAttachment::Fixed => RootChoice::Fixed,
            RootAttachment::Free => RootChoice::Free,
        }),
        passive: None,
        no_strength: !file.strength,
        person: Some(file.person),
    })
}
