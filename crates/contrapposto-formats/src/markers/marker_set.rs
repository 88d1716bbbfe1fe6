//! Reads a file of markers (OpenSim's MarkerSet).

use std::collections::HashSet;

use nalgebra::Vector3;

use super::TaskFileError;
use super::tasks::{Reader, text};
use crate::input_error::nearest;
use crate::osim::scaling::SetMarker;
use crate::xml::{self, Limits, Node, shorten};

/// Reads a MarkerSet. `bodies`: those of the model, on one of which every marker lies. `file` stands in errors.
///
/// # Errors
/// [`TaskFileError`] with file, line and column.
pub fn marker_set(file: &str, bytes: &[u8], bodies: &[String]) -> Result<Vec<SetMarker>, TaskFileError> {
    let document =
        xml::parse(bytes, &Limits::default()).map_err(|error| TaskFileError::Xml { file: file.to_owned(), error })?;
    let reader = Reader { file };
    let root = document.root();
    let set = if root.name() == "MarkerSet" { Some(root) } else { root.child("MarkerSet") };
    let Some(set) = set else {
        return Err(reader.error(root, "holds no <MarkerSet>; a file of markers has one".to_owned()));
    };
    let mut markers: Vec<SetMarker> = vec![];
    let mut names = HashSet::new();
    let known: HashSet<&str> = bodies.iter().map(String::as_str).collect();
    for node in set.child("objects").into_iter().flat_map(|objects| objects.children_named("Marker")) {
        let marker = marker(&reader, node, (&known, bodies))?;
        if !names.insert(marker.name.clone()) {
            return Err(reader.error(node, format!("two markers are named `{}`", marker.name)));
        }
        markers.push(marker);
    }
    Ok(markers)
}

/// Reads a marker. `known`: the same bodies.
fn marker(
    reader: &Reader<'_>,
    node: Node<'_>,
    (known, bodies): (&HashSet<&str>, &[String]),
) -> Result<SetMarker, TaskFileError> {
    let name = node.attribute("name").map(str::trim).filter(|name| !name.is_empty() && !name.contains('/'));
    let Some(name) = name.map(str::to_owned) else {
        return Err(reader.error(node, "the <Marker> has no name, or one with `/`".to_owned()));
    };
    let frame = text(node, "socket_parent_frame").or_else(|| text(node, "body")).unwrap_or_default();
    let body = frame.strip_prefix("/bodyset/").unwrap_or(&frame);
    if frame != "/ground" && body != "ground" && !known.contains(body) {
        let meant = nearest(body, bodies.iter().map(String::as_str));
        let meant = meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"));
        let body = shorten(body);
        return Err(reader.error(node, format!("`{name}` lies on `{body}`, which is no body of the model{meant}")));
    }
    let frame = if body == "ground" || frame == "/ground" { "/ground".to_owned() } else { format!("/bodyset/{body}") };
    let location = reader.vector(node, "location")?.unwrap_or_default();
    let fixed = node.child("fixed").is_some() && reader.flag(node, "fixed")?;
    Ok(SetMarker { name, frame, location, fixed })
}

impl Reader<'_> {
    /// Three numbers.
    pub(super) fn vector(&self, node: Node<'_>, element: &str) -> Result<Option<Vector3<f64>>, TaskFileError> {
        let Some(text) = text(node, element) else { return Ok(None) };
        let words: Vec<Option<f64>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        match words[..] {
            [Some(x), Some(y), Some(z)] if [x, y, z].iter().all(|v: &f64| v.abs() <= contrapposto::model::LARGEST) => {
                Ok(Some(Vector3::new(x, y, z)))
            }
            _ => {
                let problem = format!("<{element}> is `{}`; three finite numbers are accepted", shorten(&text));
                Err(self.error(node, problem))
            }
        }
    }
}
