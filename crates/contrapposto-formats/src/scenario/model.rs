//! Reads which body a scenario has: a model file, or the built-in adult with its passive curves and fatigue laws.

use contrapposto::model::{Adult, AdultError, Model, Part, adult};
use contrapposto::muscle::Sharing;

use super::error_keys::adult_path;
use super::fatigue_choice::fatigue_choice;
use super::head::check_head;
use super::names::coordinate;
use super::spread::with_spread;
use super::text::{AdultText, ModelText, MusclesText, PartText, PersonText, RootText, ScenarioText, SexText};
use crate::input_error::InputError;
use crate::model_ir::RootAttachment;
use crate::passive_law::passive_curve;
use crate::tissue::{FatigueChoice, HipTissue, MuscleUse, Person, SourcedModel};
use crate::toml_file::{Located, read_toml, shown};

/// A model file that a scenario names.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// Path of the file, as seen from the scenario's folder.
    pub file: String,
    /// The overlay's path, as seen from the scenario's folder.
    pub overlay: Option<String>,
    /// Attachment of the root, if the scenario gives one.
    pub root: Option<RootAttachment>,
    /// Whether its joints have the strength that the file gives to their motors.
    pub strength: bool,
    /// Fatigue law of its muscle groups, for [`SourcedModel::with_fatigue`].
    pub fatigue: FatigueChoice,
    /// Use of the file's muscles; the model's default ([`SourcedModel::default_muscle_use`]) where the scenario says none.
    pub muscles: Option<MuscleUse>,
    /// Capsule and iliotibial tract of the hips beside these muscles, for [`SourcedModel::add_hip_tracts`].
    pub hip_tract: HipTissue,
    /// The measure by which these muscles share torques.
    pub sharing: Sharing,
    /// Whether the scenario multiplies strength or passive torque of the data, so that by default muscles give nothing.
    pub multiplies_data: bool,
    /// The person whom it stands for.
    pub person: Person,
}

/// The model file that a scenario names; `None` for the built-in adult. `name` is the scenario's name for messages.
///
/// # Errors
/// [`InputError`] when it is no scenario.
pub fn scenario_model(name: &str, bytes: &[u8]) -> Result<Option<ModelFile>, InputError> {
    read_toml(name, bytes, |at, text: &ScenarioText| {
        check_head(at, text)?;
        model_file(at, text)
    })
}

fn model_file(at: &Located, scenario: &ScenarioText) -> Result<Option<ModelFile>, InputError> {
    let text: &ModelText = &scenario.model;
    let Some(file) = &text.file else {
        let given = [
            ("overlay", text.overlay.is_some()),
            ("root", text.root.is_some()),
            ("file_strength", text.file_strength.is_some()),
            ("muscles", text.muscles.is_some()),
            ("hip_tract", text.hip_tract.is_some()),
            ("sharing", text.sharing.is_some()),
            ("person", text.person.is_some()),
        ];
        for (key, given) in given {
            if given {
                let help = Some("add `file = \"MODEL\"`, or leave it out".to_owned());
                return Err(at.key_error(&["model", key], format!("`{key}` goes with a model file"), help));
            }
        }
        return Ok(None);
    };
    if text.adult.is_some() {
        let help = Some("keep one of `file` and `adult`".to_owned());
        return Err(at.key_error(&["model", "adult"], "the body is either a file or the built-in adult", help));
    }
    for (key, path) in [("file", Some(file)), ("overlay", text.overlay.as_ref())] {
        if path.is_some_and(|path| path.is_empty() || path.chars().any(char::is_control)) {
            return Err(at.error(&["model", key], format!("`{key}` is no name of a file"), None));
        }
    }
    let root = text.root.map(|root| match root {
        RootText::Fixed => RootAttachment::Fixed,
        RootText::Free => RootAttachment::Free,
    });
    let fatigue = fatigue_choice(at, scenario)?;
    let person = text.person.as_ref().map_or(Ok(Person::default()), |text| person(at, text))?;
    let strength = text.file_strength.unwrap_or(true);
    let (muscles, multiplies_data) = muscles(at, scenario)?;
    let hip_tract = text.hip_tract.unwrap_or(HipTissue::Off);
    if hip_tract != HipTissue::Off && muscles.is_some_and(|uses| !uses.gives_passive()) {
        let message = "`hip_tract` stands beside the passive torque of muscles, which give none here";
        let help = Some("leave it out, or write muscles = \"both\" or \"passive\"".to_owned());
        return Err(at.key_error(&["model", "hip_tract"], message, help));
    }
    let sharing = sharing(at, text, muscles)?;
    let (file, overlay) = (file.clone(), text.overlay.clone());
    Ok(Some(ModelFile { file, overlay, root, strength, fatigue, muscles, hip_tract, sharing, multiplies_data, person }))
}

/// The measure by which muscles share torques.
fn sharing(at: &Located, text: &ModelText, muscles: Option<MuscleUse>) -> Result<Sharing, InputError> {
    if text.sharing.is_some() && muscles.is_some_and(|uses| !uses.gives_strength()) {
        let message = "`sharing` is the measure by which muscles share torques, and they give no strength here";
        let help = Some("leave it out, or write muscles = \"both\" or \"strength\"".to_owned());
        return Err(at.key_error(&["model", "sharing"], message, help));
    }
    Ok(text.sharing.map_or(Sharing::Squares, Sharing::from))
}

/// The use of muscles that a scenario asks for, and whether it multiplies the strength or the passive torque of the data.
fn muscles(at: &Located, scenario: &ScenarioText) -> Result<(Option<MuscleUse>, bool), InputError> {
    let asked = scenario.model.muscles.map(|text| match text {
        MusclesText::Off => MuscleUse::Off,
        MusclesText::Strength => MuscleUse::Strength,
        MusclesText::Passive => MuscleUse::Passive,
        MusclesText::Both => MuscleUse::Both,
    });
    let spread = scenario.passive.spread.is_some();
    let (of_strength, of_passive) = asked.map_or((false, false), |uses| (uses.gives_strength(), uses.gives_passive()));
    for (key, refused, quantity) in [
        (&["strength"][..], of_strength && at.holds(&["strength"]), "strength"),
        (&["passive", "spread"][..], of_passive && spread, "passive torque"),
    ] {
        if refused {
            let name = format!("[{}] {}", key[0], key[1..].join(" "));
            let name = name.trim_end();
            let help = Some(format!("leave {name} out, or write muscles = \"off\""));
            let message = format!("{name} multiplies the {quantity} of the data, not that of muscles");
            return Err(at.key_error(key, message, help));
        }
    }
    Ok((asked, at.holds(&["strength"]) || spread))
}

fn person(at: &Located, text: &PersonText) -> Result<Person, InputError> {
    for (key, value, sizes) in
        [("stature_m", text.stature_m, Adult::STATURES), ("mass_kg", text.mass_kg, Adult::MASSES)]
    {
        if value.is_some_and(|value| !sizes.contains(&value)) {
            let message = format!("`{key}` must lie in {}..{}", sizes.start(), sizes.end());
            let help = value.and_then(|value| stature_in_metres(key, value));
            return Err(at.error(&["model", "person", key], message, help));
        }
    }
    let sex = text.sex.map(SexText::sex);
    Ok(Person { sex, stature: text.stature_m, mass: text.mass_kg })
}

/// The body: that of the model file if there is one, as it is, else the built-in adult with the fatigue law of the file; both with
/// the passive curves of the file.
pub(super) fn body(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Model, InputError> {
    let mut model = match (file, &text.model.file) {
        (Some(model), _) => model,
        (None, Some(_)) => return Err(at.key_error(&["model", "file"], "the model file was not opened", None)),
        (None, None) => built_in(at, text)?,
    };
    for (name, passive) in &text.passive.curves {
        let index = coordinate(at, &model, &["passive", name], name)?;
        let curve = passive_curve(at, &["passive", name], &model.coordinates()[index], None, passive)?;
        model = model.with_passive(index, curve);
    }
    with_spread(at, model, &text.strength, &text.passive)
}

/// Keys of a scenario that belong to its body as MODEL.
const OF_THE_BODY: [&str; 3] = ["format", "title", "model"];

/// The built-in adult that a scenario describes in `[model] adult`: MODEL of the commands that take one. With the names of the tables that
/// count in runs of the scenario only.
///
/// # Errors
/// [`InputError`] when it is no scenario, has a model file, or changes strength, passive torque or fatigue.
pub fn scenario_adult(name: &str, bytes: &[u8]) -> Result<(Adult, Vec<String>), InputError> {
    read_toml(name, bytes, |at, text: &ScenarioText| {
        check_head(at, text)?;
        if text.model.file.is_some() {
            let help = Some("name that file instead, or describe the adult: adult = { ... }".to_owned());
            return Err(at.key_error(&["model", "file"], "as MODEL a scenario gives the built-in adult only", help));
        }
        if let Some(table) = ["passive", "strength", "fatigue"].into_iter().find(|table| at.holds(&[table])) {
            let help = Some("leave it out, and use --overlay and --fatigue".to_owned());
            return Err(at.key_error(&[table], format!("[{table}] counts in runs of the scenario only"), help));
        }
        let size = size(text);
        adult(&size).map_err(|error| refused_adult(at, &error))?;
        let others = at.outermost().into_iter().filter(|key| !OF_THE_BODY.contains(key)).map(str::to_owned);
        Ok((size, others.collect()))
    })
}

fn size(text: &ScenarioText) -> Adult {
    let default = AdultText::default();
    let size = text.model.adult.as_ref().unwrap_or(&default);
    let sex = size.sex.sex();
    let part = match size.part {
        PartText::Whole => Part::Whole,
        PartText::RightArm => Part::RightArm,
    };
    let lengths = size.lengths_m.iter().map(|(name, length)| (name.clone(), *length)).collect();
    Adult { sex, stature: size.stature_m, mass: size.mass_kg, part, lengths }
}

fn refused_adult(at: &Located, error: &AdultError) -> InputError {
    let (path, message) = (adult_path(error), error.to_string());
    match error {
        // The name of the segment is refused, not its length.
        AdultError::Length { .. } => at.key_error(&path, message, None),
        AdultError::Size { value, .. } => {
            let help = path.last().and_then(|key| stature_in_metres(key, *value));
            at.error(&path, message, help)
        }
        _ => at.error(&path, message, None),
    }
}

fn built_in(at: &Located, text: &ScenarioText) -> Result<Model, InputError> {
    let choice = fatigue_choice(at, text)?;
    Ok(SourcedModel::adult(&size(text)).map_err(|error| refused_adult(at, &error))?.with_fatigue(&choice).model)
}

/// A question whether the stature was written in centimetres.
fn stature_in_metres(key: &str, value: f64) -> Option<String> {
    let metres = value / 100.0;
    (key == "stature_m" && Adult::STATURES.contains(&metres))
        .then(|| format!("{} m? lengths are in metres", shown(metres)))
}
