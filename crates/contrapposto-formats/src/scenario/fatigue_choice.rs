//! Reads which fatigue law the muscle groups of a scenario's body have.

use contrapposto::model::data::{self, FatigueSet};

use super::fatigue_text::{FatigueSexText, LawText, ParametersText};
use super::text::ScenarioText;
use crate::input_error::{InputError, suggestion};
use crate::tissue::{FatigueChoice, FatigueSex};
use crate::toml_file::Located;

/// Keys of `[fatigue]` that name the law.
pub(super) const LAW_KEYS: [&str; 4] = ["law", "parameters", "sex", "curve"];

/// The law, with the parameters or the curve that the file names.
pub(super) fn fatigue_choice(at: &Located, text: &ScenarioText) -> Result<FatigueChoice, InputError> {
    let fatigue = &text.fatigue;
    if fatigue.law == LawText::ThreeCompartment {
        if fatigue.curve.is_some() {
            let help = Some("add `law = \"endurance\"`, or leave `curve` out".to_owned());
            return Err(at.key_error(&["fatigue", "curve"], "an endurance curve needs the endurance law", help));
        }
        return three_compartment(at, fatigue.parameters, fatigue.sex);
    }
    for (key, given) in [("parameters", fatigue.parameters.is_some()), ("sex", fatigue.sex.is_some())] {
        if given {
            let help = Some(format!("set `law = \"three_compartment\"`, or leave `{key}` out"));
            let message = format!("`{key}` goes with the three-compartment law");
            return Err(at.key_error(&["fatigue", key], message, help));
        }
    }
    let Some(name) = &fatigue.curve else { return Ok(FatigueChoice::Endurance(None)) };
    let library = data::library();
    let Some((law, _)) = library.endurance(name) else {
        let help = suggestion(name, library.endurance_names().collect::<Vec<_>>());
        return Err(at.error(&["fatigue", "curve"], format!("there is no endurance curve `{name}`"), help));
    };
    Ok(FatigueChoice::Endurance(Some(law)))
}

fn three_compartment(
    at: &Located,
    parameters: Option<ParametersText>,
    sex: Option<FatigueSexText>,
) -> Result<FatigueChoice, InputError> {
    let set = match parameters {
        None | Some(ParametersText::Joint) => FatigueSet::Joint,
        Some(ParametersText::MuscleGroup) => FatigueSet::MuscleGroup,
    };
    if sex.is_some() && set == FatigueSet::Joint {
        let help = Some("add `parameters = \"muscle_group\"`, or leave `sex` out".to_owned());
        return Err(at.key_error(&["fatigue", "sex"], "the parameters of joints are the same for both sexes", help));
    }
    let sex = match sex {
        None => FatigueSex::OfBody,
        Some(FatigueSexText::Female) => FatigueSex::Female,
        Some(FatigueSexText::Male) => FatigueSex::Male,
        Some(FatigueSexText::Any) => FatigueSex::Any,
    };
    Ok(FatigueChoice::ThreeCompartment(set, sex))
}
