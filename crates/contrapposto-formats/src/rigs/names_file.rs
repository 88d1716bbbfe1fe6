//! Reads the file that names a rig's joints: `SEGMENT = "JOINT"` in TOML.

use std::collections::BTreeMap;

use super::Rig;
use super::names::segments;
use crate::input_error::{InputError, nearest, suggestion};
use crate::toml_file::read_toml;

/// Reads a file of names for `rig`: segments of the adult and the joints that move them.
///
/// # Errors
/// [`InputError`] says which segment or joint is not there, and which are.
pub fn read_rig_names(name: &str, bytes: &[u8], rig: &Rig) -> Result<BTreeMap<String, String>, InputError> {
    read_toml(name, bytes, |at, given: &BTreeMap<String, String>| {
        let known: Vec<String> = segments().into_iter().map(|(segment, _)| segment).collect();
        for (segment, joint) in given {
            if !known.contains(segment) {
                let help = suggestion(segment, known.iter().map(String::as_str));
                return Err(at.key_error(&[segment], format!("`{segment}` is no segment that a rig moves"), help));
            }
            if rig.joint(joint).is_none() {
                let names = rig.joints.iter().map(|joint| joint.name.as_str());
                let help = match nearest(joint, names.clone()) {
                    Some(meant) => Some(format!("did you mean `{meant}`?")),
                    None => suggestion(joint, names.collect::<Vec<_>>()),
                };
                return Err(at.error(&[segment], format!("the rig has no joint `{joint}`"), help));
            }
        }
        Ok(given.clone())
    })
}
