//! Reads which body a scenario has: a model file, or the built-in adult with its passive curves and fatigue laws.

use contrapposto::model::{Adult, AdultError, Model, Part, Sex, adult, data};

use super::error_keys::adult_path;
use super::head::check_head;
use super::names::coordinate;
use super::text::{AdultText, LawText, ModelText, PartText, RootText, ScenarioText, SexText};
use crate::input_error::{InputError, suggestion};
use crate::model_ir::RootAttachment;
use crate::passive_law::passive_curve;
use crate::toml_file::{Located, read_toml};

/// A model file that a scenario names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelFile {
    /// Its path, as seen from the scenario's folder.
    pub file: String,
    /// The overlay's path, as seen from the scenario's folder.
    pub overlay: Option<String>,
    /// How its root is attached, if that is said.
    pub root: Option<RootAttachment>,
}

/// The model file that a scenario names; `None` for the built-in adult. `name` is the scenario's name for messages.
///
/// # Errors
/// [`InputError`] when it is no scenario.
pub fn scenario_model(name: &str, bytes: &[u8]) -> Result<Option<ModelFile>, InputError> {
    read_toml(name, bytes, |at, text: &ScenarioText| {
        check_head(at, text)?;
        model_file(at, &text.model)
    })
}

fn model_file(at: &Located, text: &ModelText) -> Result<Option<ModelFile>, InputError> {
    let Some(file) = &text.file else {
        for (key, given) in [("overlay", text.overlay.is_some()), ("root", text.root.is_some())] {
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
    Ok(Some(ModelFile { file: file.clone(), overlay: text.overlay.clone(), root }))
}

/// The body: that of the model file if there is one, else the built-in adult, with its own passive curves and fatigue laws.
pub(super) fn body(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Model, InputError> {
    let mut model = match (file, &text.model.file) {
        (Some(model), _) => model,
        (None, Some(_)) => return Err(at.key_error(&["model", "file"], "the model file was not opened", None)),
        (None, None) => built_in(at, text)?,
    };
    for (name, passive) in &text.passive {
        let index = coordinate(at, &model, &["passive", name], name)?;
        let curve = passive_curve(at, &["passive", name], &model.coordinates()[index], None, passive)?;
        model = model.with_passive(index, curve);
    }
    Ok(model)
}

fn built_in(at: &Located, text: &ScenarioText) -> Result<Model, InputError> {
    let default = AdultText::default();
    let size = text.model.adult.as_ref().unwrap_or(&default);
    let sex = match size.sex {
        SexText::Female => Sex::Female,
        SexText::Male => Sex::Male,
    };
    let part = match size.part {
        PartText::Whole => Part::Whole,
        PartText::RightArm => Part::RightArm,
    };
    let lengths = size.lengths_m.iter().map(|(name, length)| (name.clone(), *length)).collect();
    let size = Adult { sex, stature: size.stature_m, mass: size.mass_kg, part, lengths };
    let refuse = |error: AdultError| {
        let (path, message) = (adult_path(&error), error.to_string());
        match error {
            // The name of the segment is refused, not its length.
            AdultError::Length { .. } => at.key_error(&path, message, None),
            _ => at.error(&path, message, None),
        }
    };
    with_fatigue_law(at, text, adult(&size).map_err(refuse)?)
}

/// The built-in adult with the fatigue law that the file asks for.
fn with_fatigue_law(at: &Located, text: &ScenarioText, mut model: Model) -> Result<Model, InputError> {
    if text.fatigue.law != LawText::Endurance {
        if text.fatigue.curve.is_some() {
            let help = Some("add `law = \"endurance\"`, or leave `curve` out".to_owned());
            return Err(at.key_error(&["fatigue", "curve"], "an endurance curve needs the endurance law", help));
        }
        return Ok(model);
    }
    let library = data::library();
    for index in 0..model.coordinates().len() {
        let sources = library.sources(&model.coordinates()[index].name);
        let class = sources.and_then(|sources| sources.fatigue_class).unwrap_or("general");
        let name = text.fatigue.curve.clone().unwrap_or_else(|| library.default_endurance(class));
        let Some((law, _)) = library.endurance(&name) else {
            let help = suggestion(&name, library.endurance_names().collect::<Vec<_>>());
            return Err(at.error(&["fatigue", "curve"], format!("there is no endurance curve `{name}`"), help));
        };
        model = model.with_fatigue(index, &law);
    }
    Ok(model)
}
