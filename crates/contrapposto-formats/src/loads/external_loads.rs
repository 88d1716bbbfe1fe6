//! Reads OpenSim's ExternalLoads files: the table of forces, and the body and columns of every force.

use crate::xml::{self, Limits, Node, XmlError};

/// The forces that an ExternalLoads file names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExternalLoads {
    /// The table, as seen from the file's folder.
    pub table: String,
    /// Its forces.
    pub forces: Vec<ExternalForce>,
}

/// One force of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExternalForce {
    /// The segment that it acts on.
    pub segment: String,
    /// Column names of the force without their last letter.
    pub force: String,
    /// Column names of the point without their last letter.
    pub point: String,
    /// Column names of the couple without their last letter; empty for none.
    pub torque: String,
}

/// Why a file is no ExternalLoads file that can be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExternalLoadsError {
    /// Not XML.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// Another XML file.
    #[error(
        "holds no <ExternalLoads>; --grf is a table of forces (.mot, .sto, .csv) or OpenSim's ExternalLoads (.xml)"
    )]
    Other,
    /// An element is missing or empty.
    #[error("{force}: <{element}> is missing or empty")]
    Missing {
        /// Name of the force, or of the file's element.
        force: String,
        /// The element.
        element: &'static str,
    },
    /// Force or point are not in ground axes.
    #[error("`{force}`: <{element}> is `{found}`; only forces and points in `ground` are read")]
    Frame {
        /// Name of the force.
        force: String,
        /// The element.
        element: &'static str,
        /// What it says.
        found: String,
    },
}

/// Reads an ExternalLoads file. Forces whose `appliesForce` or `isDisabled` switches them off are left out.
///
/// # Errors
/// [`ExternalLoadsError`] says what is missing.
pub fn external_loads(bytes: &[u8]) -> Result<ExternalLoads, ExternalLoadsError> {
    let document = xml::parse(bytes, &Limits::default())?;
    let root = document.root();
    let loads = if root.name() == "ExternalLoads" { Some(root) } else { root.child("ExternalLoads") };
    let loads = loads.ok_or(ExternalLoadsError::Other)?;
    let missing = |element| ExternalLoadsError::Missing { force: "ExternalLoads".to_owned(), element };
    let table = text(loads, "datafile").ok_or_else(|| missing("datafile"))?;
    let objects = loads.child("objects").ok_or_else(|| missing("objects"))?;
    let on = |node: &Node<'_>| {
        let is = |name, word: &str| text(*node, name).is_some_and(|text| text.eq_ignore_ascii_case(word));
        node.name() == "ExternalForce" && !is("appliesForce", "false") && !is("isDisabled", "true")
    };
    let forces: Vec<ExternalForce> = objects.children().filter(on).map(force).collect::<Result<_, _>>()?;
    if forces.is_empty() { Err(missing("ExternalForce")) } else { Ok(ExternalLoads { table, forces }) }
}

fn force(node: Node<'_>) -> Result<ExternalForce, ExternalLoadsError> {
    let name = node.attribute("name").unwrap_or("ExternalForce").to_owned();
    let needed = |element: &'static str| {
        text(node, element).ok_or_else(|| ExternalLoadsError::Missing { force: name.clone(), element })
    };
    for element in ["force_expressed_in_body", "point_expressed_in_body"] {
        if let Some(found) = text(node, element).filter(|found| !found.trim_start_matches('/').eq("ground")) {
            return Err(ExternalLoadsError::Frame { force: name, element, found });
        }
    }
    let segment = needed("applied_to_body")?;
    let segment = segment.rsplit('/').next().unwrap_or_default().to_owned();
    let (force, point) = (needed("force_identifier")?, needed("point_identifier")?);
    let torque = text(node, "torque_identifier").unwrap_or_default();
    Ok(ExternalForce { segment, force, point, torque })
}

/// The text of a child element, if there is any; OpenSim writes `Unassigned` for none.
fn text(node: Node<'_>, element: &str) -> Option<String> {
    let text = node.child(element)?.text().trim().to_owned();
    (!text.is_empty() && text != "Unassigned").then_some(text)
}
