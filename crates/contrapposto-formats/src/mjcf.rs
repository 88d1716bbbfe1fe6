//! Reads MJCF, MuJoCo's model files, as a [`ModelIr`].
//!
//! Defaults and classes, includes, frames, degrees, Euler sequences, orientations of five kinds and masses from geoms are
//! resolved as MuJoCo 4.0 resolves them. Parts that matter to quasi-static torque and are not supported are refused with their place;
//! the rest is counted in [`ModelIr::ignored`].

mod actuator;
mod attributes;
mod built;
mod chain;
mod compiler;
mod defaults;
mod equality;
mod error;
mod files;
mod geom;
mod inertial;
mod item;
mod joint;
mod muscle;
mod options;
mod orientation;
mod schema;
mod site;
mod springdamper;
mod tendon;
mod tree;
mod value;

pub use error::{IncludeRule, MjcfError, MjcfRule, Unsupported};
pub use options::Options;
pub(crate) use schema::LEAST_MASS;

use crate::model_ir::{Ignored, ModelIr, first_too_large, unique_coordinates};
use attributes::Attributes;
use compiler::Settings;
use defaults::Classes;
use item::Item;

/// Reads an MJCF file. `include` gives the bytes of an included file, named relative to the main file's folder; names that
/// lead out of it never reach `include`. `file_name` serves as the body's name if the model has none.
///
/// # Errors
/// [`MjcfError`] with the place.
pub fn read(
    bytes: &[u8],
    file_name: &str,
    include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    options: &Options,
) -> Result<ModelIr, MjcfError> {
    let files = files::load(bytes, file_name, include, &options.limits)?;
    let root = files.root();
    if root.name() != "mujoco" {
        return Err(MjcfError::Root { place: root.place() });
    }
    let mut body = ModelIr { name: file_name.to_owned(), ..ModelIr::default() };
    if let Some(name) = root.attribute("model").filter(|n| !n.is_empty()) {
        name.clone_into(&mut body.name);
    }
    let settings = Settings::read(root)?;
    body.gravity = settings.gravity;
    let classes = Classes::read(root, &options.limits)?;
    let mut ignored = Ignored::default();
    let mut walk = tree::Walk::new(&mut body, &settings, &classes, options, &mut ignored, root);
    for section in root.children() {
        if section.name() == "worldbody" {
            walk.world(section)?;
        }
    }
    let built = walk.finish(root)?;
    other_sections(root, &mut body, (&settings, &classes, &built), &mut ignored)?;
    body.muscles = muscle::read(root, (&settings, &classes, &built))?;
    springdamper::apply(&mut body, &built, root)?;
    unique_coordinates(&body).map_err(|value| MjcfError::DuplicateName { place: root.place(), value })?;
    if let Some(segment) = first_too_large(&body) {
        let value = body.segments.get(segment).map_or_else(String::new, |s| s.name.clone());
        let place = built.places.get(segment).cloned().unwrap_or_else(|| root.place());
        return Err(MjcfError::Invalid { place, value, needs: MjcfRule::Overflow });
    }
    ignored.add("sites", body.stations.len());
    body.ignored = ignored.into_list();
    Ok(body)
}

/// Reads the sections beside bodies and settings: couplings and the strength of motors; the rest is counted.
fn other_sections<'a>(
    root: Item<'a>,
    body: &mut ModelIr,
    (settings, classes, built): (&Settings, &Classes<'a>, &built::Built<'a>),
    ignored: &mut Ignored,
) -> Result<(), MjcfError> {
    let mut couplings = vec![];
    let mut motors = actuator::Motors::new();
    for section in root.children() {
        match section.name() {
            "worldbody" | "compiler" | "option" | "default" => {}
            "equality" => equality::read(section, body, settings, classes, built, &mut couplings, ignored)?,
            "actuator" => actuator::read(section, body, settings, classes, built, &mut motors, ignored)?,
            "tendon" => tendons(section, settings, classes, ignored)?,
            "deformable" => {
                for child in section.children() {
                    match child.name() {
                        "skin" => ignored.add("skin", 1),
                        _ => return Err(Unsupported::Deformable.at(child)),
                    }
                }
            }
            name if schema::SECTIONS.contains(&name) => ignored.add(name, section.children().len()),
            _ => return Err(MjcfError::unknown_element(section, schema::SECTIONS)),
        }
    }
    actuator::finish(body, built, motors, ignored);
    equality::close(body, couplings)
}

/// Springs of tendons act on several joints and are not represented.
fn tendons<'a>(
    section: Item<'a>,
    settings: &Settings,
    classes: &Classes<'a>,
    ignored: &mut Ignored,
) -> Result<(), MjcfError> {
    for tendon in section.children() {
        if !matches!(tendon.name(), "spatial" | "fixed") {
            return Err(MjcfError::unknown_element(tendon, &["spatial", "fixed"]));
        }
        let attributes = Attributes::new(tendon, schema::Tag::Tendon, classes, classes.main())?;
        if settings.springs && attributes.merged("stiffness")?.iter().any(|&k| k != 0.0) {
            return Err(Unsupported::TendonSpring.at_attribute(tendon, "stiffness"));
        }
        if attributes.limits("range", "limited", settings.automatic_limits)?.is_some() {
            ignored.add("limit of a tendon", 1);
        }
    }
    Ok(())
}
