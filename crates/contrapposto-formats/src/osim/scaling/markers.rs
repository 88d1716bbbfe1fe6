//! Adds, moves and removes the markers of a model file.

use nalgebra::{Point3, Vector3};

use super::edits::{Edits, escaped, vector};
use super::{unmarked, with_parts};
use crate::osim::error::OsimError;

/// A marker of a file of markers.
#[derive(Clone, Debug, PartialEq)]
pub struct SetMarker {
    /// Unique name.
    pub name: String,
    /// The body that carries it, as a path: `/bodyset/torso`.
    pub frame: String,
    /// Place in this frame, m.
    pub location: Vector3<f64>,
    /// The marker stays where it is when markers are placed.
    pub fixed: bool,
}

/// A model with placed markers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedMarkers {
    /// Text of the file.
    pub text: String,
    /// Markers that were moved, with the distance, m.
    pub moved: Vec<(String, f64)>,
    /// Markers that were removed.
    pub removed: Vec<String>,
}

/// Adds markers to a model; one of the same name gives way.
///
/// # Errors
/// [`OsimError`] for a file that is no model of OpenSim, or of a version below 30500.
pub fn with_markers(text: &str, file_name: &str, markers: &[SetMarker]) -> Result<String, OsimError> {
    let text = unmarked(text);
    with_parts(text, file_name, |parts| {
        let mut edits = Edits::new(text);
        for &node in parts.scene.markers() {
            let name = parts.reader.name(node)?;
            if markers.iter().any(|marker| marker.name == name) {
                edits.remove(node);
            }
        }
        let mut added = String::new();
        for SetMarker { name, frame, location, fixed } in markers {
            let (name, frame, location) = (escaped(name), escaped(frame), vector(*location));
            added.push_str(&format!(
                "<Marker name=\"{name}\"><socket_parent_frame>{frame}</socket_parent_frame><location>{location}</location>\
                 <fixed>{fixed}</fixed></Marker>\n"
            ));
        }
        let set = parts.model.child("MarkerSet");
        match (set.and_then(|set| set.child("objects")), set) {
            (Some(objects), _) => edits.append(objects, &added),
            (None, Some(set)) => edits.append(set, &format!("<objects>{added}</objects>")),
            (None, None) => {
                let set = format!("<MarkerSet name=\"markerset\"><objects>{added}</objects></MarkerSet>\n");
                edits.append(parts.model, &set);
            }
        }
        Ok(edits.apply())
    })
}

/// Moves markers that are not fixed, and removes others. `place`: the new place in the frame of the marker's body, m; `None` where it stays.
///
/// # Errors
/// [`OsimError`] for a file that is no model of OpenSim, or of a version below 30500.
pub fn with_placed_markers(
    text: &str,
    file_name: &str,
    place: &dyn Fn(&str) -> Option<Vector3<f64>>,
    keep: &dyn Fn(&str) -> bool,
) -> Result<PlacedMarkers, OsimError> {
    let text = unmarked(text);
    with_parts(text, file_name, |parts| {
        let mut edits = Edits::new(text);
        let (mut moved, mut removed) = (vec![], vec![]);
        for &node in parts.scene.markers() {
            let name = parts.reader.unique_name(node)?;
            if !keep(&name) {
                edits.remove(node);
                removed.push(name);
                continue;
            }
            if parts.reader.flag(node, "fixed", false)? {
                continue;
            }
            let frame = parts.scene.frame_of_point(parts.reader, node, &format!("/markerset/{name}"))?;
            if let Some(place) = place(&name) {
                let before = parts.reader.vector(node, "location", Some(Vector3::zeros()))?;
                let location = frame.pose.inverse_transform_point(&Point3::from(place)).coords;
                edits.set_properties(node, &[("location", vector(location))]);
                moved.push((name, (location - before).norm()));
            }
        }
        Ok(PlacedMarkers { text: edits.apply(), moved, removed })
    })
}
