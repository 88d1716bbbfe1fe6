//! Scales the lengths of muscles, ligaments and springs with the lengths of their paths.

use super::edits::{Edits, number};
use super::{Scaled, unmarked, with_parts};
use crate::osim::error::OsimError;

/// Properties that grow with the path, with OpenSim's default, by the end of the kind's name; the first that fits.
const LENGTHS: [(&str, &[(&str, f64)]); 6] = [
    // OpenSim leaves this one.
    ("RigidTendonMuscle", &[]),
    ("Blankevoort1991Ligament", &[("slack_length", 0.0)]),
    ("Ligament", &[("resting_length", 0.0)]),
    ("PathSpring", &[("resting_length", 0.0)]),
    ("ExpressionBasedPathForce", &[("resting_length", 0.0)]),
    ("", &[("optimal_fiber_length", 0.1), ("tendon_slack_length", 0.2)]),
];

/// Multiplies optimal lengths of fibres and slack lengths of tendons, ligaments and springs by the growth of their path. `growth`: length
/// of the scaled path over that before, by the name of the force; `None` where it is not known.
///
/// # Errors
/// [`OsimError`] for a file that is no model of OpenSim, or of a version below 30500.
pub fn with_path_lengths(
    text: &str,
    file_name: &str,
    growth: &dyn Fn(&str) -> Option<f64>,
) -> Result<Scaled, OsimError> {
    let text = unmarked(text);
    with_parts(text, file_name, |parts| {
        let mut edits = Edits::new(text);
        let mut left = std::collections::BTreeMap::new();
        for &force in &parts.scene.forces {
            let kind = force.name();
            let has_lengths = kind.contains("Muscle") || LENGTHS[..5].iter().any(|(known, _)| *known == kind);
            let Some((_, properties)) = LENGTHS.iter().find(|(end, _)| has_lengths && kind.ends_with(end)) else {
                continue;
            };
            let Some(growth) = growth(&parts.reader.name(force)?) else {
                *left.entry("muscles and ligaments whose path is not known").or_default() += 1;
                continue;
            };
            let mut scaled = vec![];
            for &(name, default) in *properties {
                scaled.push((name, number(parts.reader.number(force, name, Some(default))? * growth)));
            }
            edits.set_properties(force, &scaled);
        }
        Ok(Scaled { text: edits.apply(), left })
    })
}
