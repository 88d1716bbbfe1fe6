//! Reads held weights and forces.

use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;

use super::error_keys::load_key;
use super::names::segment;
use super::text::{FixedInText, LoadText};
use crate::input_error::InputError;
use crate::toml_file::Located;

/// The load that the table at `table` describes.
pub(super) fn load(at: &Located, model: &Model, table: &[&str], text: &LoadText) -> Result<Load, InputError> {
    let path = |key| table.iter().copied().chain([key]).collect::<Vec<&str>>();
    let segment = segment(at, model, &path("segment"), &text.segment)?;
    let point = text.at_m.map_or(model.segments()[segment].center_of_mass, Vector3::from);
    let kind = match (text.mass_kg, text.force_n) {
        (Some(mass), None) if text.fixed_in.is_none() => LoadKind::Weight(mass),
        (Some(_), None) => {
            let help = Some("leave `fixed_in` out".to_owned());
            return Err(at.key_error(&path("fixed_in"), "a weight always pulls along gravity", help));
        }
        (None, Some(force)) => {
            let fixed_in = match text.fixed_in {
                Some(FixedInText::Segment) => FixedIn::Segment,
                _ => FixedIn::World,
            };
            LoadKind::Force(Vector3::from(force), fixed_in)
        }
        _ => {
            let help = Some("give one of `mass_kg` and `force_n`".to_owned());
            return Err(at.error(table, "a load is either a weight or a force", help));
        }
    };
    let load = Load { segment, point, kind };
    load.check(model).map_err(|error| at.error(&path(load_key(&error)), error.to_string(), None))?;
    Ok(load)
}
