//! Reads the places where a run may put a hand when a muscle group is tired.

use std::f64::consts::FRAC_PI_2;

use contrapposto::contact::{Place, Region, Support};
use contrapposto::model::Model;
use contrapposto::simulation::Rest;
use nalgebra::Vector3;

use super::levels::Level;
use super::rest_text::RestText;
use super::surface::Resting;
use crate::input_error::InputError;
use crate::toml_file::{Alias, Located};

/// The aliases by which errors of the rests' supports, after `before` others, are placed at the tables of the file.
pub(super) fn aliases(before: usize, paths: &[Vec<String>]) -> impl Iterator<Item = Alias> {
    paths
        .iter()
        .enumerate()
        .map(move |(i, from)| Alias { entry: ("support", (before + i).to_string()), from: from.clone() })
}

/// The supports of rests, which follow on `before` others, with their planes.
pub(super) fn rests(
    at: &Located,
    model: &Model,
    (texts, before): (&[RestText], usize),
    resting: Vec<Resting>,
) -> Result<Vec<(Support, Rest)>, InputError> {
    let read = |(i, (text, resting)): (usize, (&RestText, Resting))| {
        let number = (before + i).to_string();
        let name = &text.segment;
        let Some(inward) = resting.support.inward(model) else {
            let message = format!(
                "the patch of `{name}` has no area or its plane goes through the centre of mass of the segment: nobody can say how it lies"
            );
            return Err(at.error(&["support", &number, "corners_m"], message, None));
        };
        let Some(height) = resting.height else {
            let message = "the plane of a rest needs `point_m`, a point of it";
            return Err(at.error(&["support", &number, "on"], message, None));
        };
        let corners = text.region_m.iter().copied().map(Vector3::from).collect();
        let place = Place::Free(Region { corners, turn: (-FRAC_PI_2, FRAC_PI_2) });
        let support = Support { place, ..resting.support };
        Ok((support, Rest { support: before + i, height, inward: inward.into_inner() }))
    };
    texts.iter().zip(resting).enumerate().map(read).collect()
}

/// A sentence on the rests, for commands that leave them out.
pub(super) fn left_out(model: &Model, rests: &[(Support, Rest)]) -> Option<String> {
    let names: Vec<&str> = rests.iter().map(|(support, _)| model.segments()[support.segment].name.as_str()).collect();
    (!names.is_empty())
        .then(|| format!("only `simulate` puts {} down to rest; here it stays free", names.join(" and ")))
}

/// Refuses a rest for a segment that a task wants somewhere: a hand at work does not rest.
pub(super) fn check_free(
    at: &Located,
    model: &Model,
    rests: &[(Support, Rest)],
    levels: &[Level],
) -> Result<(), InputError> {
    for (support, rest) in rests {
        let mut tasks = levels.iter().flat_map(|level| level.tasks.tasks.iter().zip(&level.labels));
        if let Some((_, label)) = tasks.find(|(task, _)| task.wants(support.segment)) {
            let name = &model.segments()[support.segment].name;
            let message = format!("`{name}` is at work (`{label}`); a hand at work does not rest");
            let help = Some("leave the hand out, or its task".to_owned());
            return Err(at.error(&["support", &rest.support.to_string(), "segment"], message, help));
        }
    }
    Ok(())
}
