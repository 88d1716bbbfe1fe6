//! Reads the tasks of marker tracking: OpenSim's IKTaskSet, alone or in the setup file of its InverseKinematicsTool.

use std::collections::HashSet;

use super::NamedFile;
use crate::xml::{self, Limits, Node, Position, XmlError};

/// A marker that is tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerTask {
    /// Name of the marker.
    pub name: String,
    /// Weight of its squared distance; 0 where the file gives none.
    pub weight: f64,
    /// Place in the file.
    pub place: Position,
}

/// A coordinate with a wanted value.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateTask {
    /// Name of the coordinate.
    pub name: String,
    /// Weight of its squared error, rad or m.
    pub weight: f64,
    /// The wanted value.
    pub value: TaskValue,
    /// Place in the file.
    pub place: Position,
}

/// Source of a wanted value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TaskValue {
    /// The coordinate's default.
    Default,
    /// Given, rad or m.
    Manual(f64),
}

/// The tasks that a file applies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackingTasks {
    /// Markers; others are not tracked.
    pub markers: Vec<MarkerTask>,
    /// Coordinates.
    pub coordinates: Vec<CoordinateTask>,
    /// Names of tasks without a weight, which is 0 then, as in OpenSim.
    pub weightless: Vec<String>,
    /// First and last time of a setup file, s; infinite where it has none.
    pub time_range: Option<(f64, f64)>,
    /// Things of the file that are done otherwise here, a sentence each.
    pub notes: Vec<String>,
    /// Model and markers that a setup file names.
    pub named: Vec<NamedFile>,
}

/// The reason for which a file holds no tasks that can be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaskFileError {
    /// Not XML.
    #[error("{file}: {error}")]
    Xml {
        /// Name of the file.
        file: String,
        /// The reason.
        error: XmlError,
    },
    /// An element has no meaning here.
    #[error("{file}:{}:{}: {problem}", place.line, place.column)]
    Element {
        /// Name of the file.
        file: String,
        /// Place of the element.
        place: Position,
        /// The problem, and the values that would be accepted.
        problem: String,
    },
}

/// Reads an IKTaskSet, or the setup file of an InverseKinematicsTool that holds one. Tasks that are not applied are left out. `file`
/// stands in errors.
///
/// # Errors
/// [`TaskFileError`] with file, line and column.
pub fn tracking_tasks(file: &str, bytes: &[u8]) -> Result<TrackingTasks, TaskFileError> {
    let document =
        xml::parse(bytes, &Limits::default()).map_err(|error| TaskFileError::Xml { file: file.to_owned(), error })?;
    let reader = Reader { file };
    let root = document.root();
    let inside = |name: &str| if root.name() == name { Some(root) } else { root.child(name) };
    let tool = inside("InverseKinematicsTool");
    let Some(set) = tool.map_or_else(|| inside("IKTaskSet"), |tool| tool.child("IKTaskSet")) else {
        let accepted = "an IKTaskSet, or the setup file of an InverseKinematicsTool with one in it, is accepted";
        return Err(reader.error(tool.unwrap_or(root), format!("holds no <IKTaskSet>; {accepted}")));
    };
    if let Some(other) = set.attribute("file") {
        let message = format!("the tasks are in the file {other:?}; give that file as --tasks");
        return Err(reader.error(set, message));
    }
    let mut tasks = reader.tasks(set)?;
    if let Some(tool) = tool {
        for element in ["model_file", "marker_file"] {
            tasks.named.extend(text(tool, element).map(|name| NamedFile { element, name }));
        }
        tasks.time_range = reader.time_range(tool)?;
        let weight = text(tool, "constraint_weight").map(|weight| weight.to_ascii_lowercase());
        if weight.is_some_and(|weight| weight.parse::<f64>().is_ok_and(f64::is_finite)) {
            let said = "<constraint_weight> is not used: couplings and locks hold exactly";
            tasks.notes.push(format!("{file}: {said}"));
        }
    }
    Ok(tasks)
}

/// Reads elements of setup files.
pub(super) struct Reader<'f> {
    pub(super) file: &'f str,
}

impl Reader<'_> {
    /// The tasks of an IKTaskSet.
    pub(super) fn tasks(&self, set: Node<'_>) -> Result<TrackingTasks, TaskFileError> {
        let mut tasks = TrackingTasks::default();
        let mut names = HashSet::new();
        for node in set.child("objects").into_iter().flat_map(Node::children) {
            self.task(node, &mut names, &mut tasks)?;
        }
        Ok(tasks)
    }

    pub(super) fn error(&self, node: Node<'_>, problem: String) -> TaskFileError {
        TaskFileError::Element { file: self.file.to_owned(), place: node.position(), problem }
    }

    /// Reads a task. `names`: kinds and names of those before it.
    fn task<'a>(
        &self,
        node: Node<'a>,
        names: &mut HashSet<(&'a str, &'a str)>,
        tasks: &mut TrackingTasks,
    ) -> Result<(), TaskFileError> {
        let kind = node.name();
        if !["IKMarkerTask", "IKCoordinateTask"].contains(&kind) {
            let problem = format!("<{kind}> is no task; IKMarkerTask and IKCoordinateTask are accepted");
            return Err(self.error(node, problem));
        }
        if !self.flag(node, "apply")? {
            return Ok(());
        }
        let name = node.attribute("name").map(str::trim).filter(|name| !name.is_empty());
        let Some(name) = name else {
            return Err(self.error(node, format!("the <{kind}> has no name")));
        };
        if !names.insert((kind, name)) {
            return Err(self.error(node, format!("two tasks are named `{name}`; each may stand once")));
        }
        let name = name.to_owned();
        // OpenSim's own default: such a task pulls at nothing.
        let given = self.number(node, "weight")?;
        let weight = given.unwrap_or(0.0);
        if given.is_none() {
            tasks.weightless.push(name.clone());
        }
        if !(0.0..=1e12).contains(&weight) {
            let problem = format!("`{name}`: the weight is {weight}; it must be between 0 and 1e12");
            return Err(self.error(node, problem));
        }
        let place = node.position();
        if kind == "IKMarkerTask" {
            tasks.markers.push(MarkerTask { name, weight, place });
            return Ok(());
        }
        let value = match text(node, "value_type").as_deref() {
            None | Some("default_value") => TaskValue::Default,
            Some("manual_value") => TaskValue::Manual(self.number(node, "value")?.unwrap_or(0.0)),
            Some(other) => {
                let accepted = "`default_value` and `manual_value` are accepted";
                let problem =
                    format!("`{name}`: values of the kind `{}` are not read; {accepted}", xml::shorten(other));
                return Err(self.error(node, problem));
            }
        };
        tasks.coordinates.push(CoordinateTask { name, weight, value, place });
        Ok(())
    }

    /// `true` where it is left out.
    pub(super) fn flag(&self, node: Node<'_>, element: &str) -> Result<bool, TaskFileError> {
        match text(node, element).map(|text| text.to_ascii_lowercase()).as_deref() {
            None | Some("true" | "1") => Ok(true),
            Some("false" | "0") => Ok(false),
            Some(other) => {
                let problem = format!("<{element}> is `{}`; `true` or `false` is accepted", xml::shorten(other));
                Err(self.error(node, problem))
            }
        }
    }

    pub(super) fn number(&self, node: Node<'_>, element: &str) -> Result<Option<f64>, TaskFileError> {
        let Some(text) = text(node, element) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(value) if value.abs() <= contrapposto::model::LARGEST.max(1e12) => Ok(Some(value)),
            _ => {
                let problem = format!("<{element}> is `{}`; a finite number is accepted", xml::shorten(&text));
                Err(self.error(node, problem))
            }
        }
    }

    pub(super) fn time_range(&self, tool: Node<'_>) -> Result<Option<(f64, f64)>, TaskFileError> {
        let Some(text) = text(tool, "time_range") else { return Ok(None) };
        let mut words = text.split_ascii_whitespace().map(str::parse::<f64>);
        match (words.next(), words.next(), words.next()) {
            (Some(Ok(from)), Some(Ok(to)), None) if from <= to => Ok(Some((from, to))),
            _ => {
                let problem = format!("<time_range> is `{}`; two times in order are accepted", xml::shorten(&text));
                Err(self.error(tool, problem))
            }
        }
    }
}

/// The text of a child element, if there is any.
pub(super) fn text(node: Node<'_>, element: &str) -> Option<String> {
    node.child(element).map(Node::text).filter(|text| !text.is_empty() && text != "Unassigned")
}
