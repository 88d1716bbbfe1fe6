//! Reads OpenSim's ExternalLoads files: the table of forces, and the body and columns of every force.

use crate::xml::{self, Limits, Node, XmlError};

/// The forces that an ExternalLoads file names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExternalLoads {
    /// The table, as seen from the file's folder.
    pub table: String,
    /// Forces of the file.
    pub forces: Vec<ExternalForce>,
}

/// One force of a table, or one couple, or both. Names of three columns are those without their last letter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExternalForce {
    /// The segment that it acts on.
    pub segment: String,
    /// Columns of the force; `None` of a couple alone.
    pub force: Option<String>,
    /// Columns of the point; `None` for the segment's origin.
    pub point: Option<String>,
    /// Columns of the couple.
    pub torque: Option<String>,
    /// The segment in whose axes force and couple are measured; `None` for ground.
    pub force_in: Option<String>,
    /// The segment in whose frame the point is measured; `None` for ground.
    pub point_in: Option<String>,
}

/// The reason for which a file is no ExternalLoads file that can be used.
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
    let missing = |element: &'static str| {
        let force = node.attribute("name").unwrap_or("ExternalForce").to_owned();
        ExternalLoadsError::Missing { force, element }
    };
    // A body by its path or its name.
    let body = |element| {
        let path = text(node, element)?;
        Some(path.rsplit('/').next().unwrap_or_default().to_owned())
    };
    let segment = body("applied_to_body").ok_or_else(|| missing("applied_to_body"))?;
    let [force, point, torque] = ["force_identifier", "point_identifier", "torque_identifier"].map(|e| text(node, e));
    if force.is_none() && torque.is_none() {
        return Err(missing("force_identifier"));
    }
    let [force_in, point_in] =
        ["force_expressed_in_body", "point_expressed_in_body"].map(|e| body(e).filter(|name| name != "ground"));
    Ok(ExternalForce { segment, force, point, torque, force_in, point_in })
}

/// The text of a child element, if there is any; OpenSim writes `Unassigned` for none.
fn text(node: Node<'_>, element: &str) -> Option<String> {
    let text = node.child(element)?.text().trim().to_owned();
    (!text.is_empty() && text != "Unassigned").then_some(text)
}
