//! Finds the coordinates of a model by name and by path.

use std::collections::HashMap;

use super::attributes::Reader;
use super::error::OsimProblem;
use super::functions;
use crate::model_ir::{CoordinateIr, CoordinateKind, Function, near};
use crate::xml::{Node, Place, shorten};

/// OpenSim's range of a coordinate that gives none, rad or m.
const DEFAULT_RANGE: (f64, f64) = (-10.0, 10.0);

/// Properties of a coordinate that its forces need.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CoordinateTraits {
    /// OpenSim calls it rotational: limit forces are in degrees.
    pub(super) degrees: bool,
    /// A rotation of a ball or free joint.
    pub(super) of_ball: bool,
}

/// All coordinates so far.
#[derive(Default)]
pub(super) struct Coordinates {
    list: Vec<CoordinateIr>,
    traits: Vec<CoordinateTraits>,
    by_name: HashMap<String, usize>,
    by_path: HashMap<String, usize>,
}

impl Coordinates {
    pub(super) fn into_list(self) -> Vec<CoordinateIr> {
        self.list
    }

    pub(super) fn list(&self) -> &[CoordinateIr] {
        &self.list
    }

    pub(super) fn traits(&self, index: usize) -> CoordinateTraits {
        self.traits[index]
    }

    /// Takes in a coordinate. A name that is taken becomes `joint/name`.
    pub(super) fn add(
        &mut self,
        reader: &Reader<'_>,
        place: Place,
        joint: &str,
        mut coordinate: CoordinateIr,
        traits: CoordinateTraits,
    ) -> Result<usize, OsimProblem> {
        let index = self.list.len();
        if index == reader.limits.coordinates {
            return Err(OsimProblem::TooMany { place, what: "coordinates", cap: reader.limits.coordinates });
        }
        self.by_path.entry(format!("/jointset/{joint}/{}", coordinate.name)).or_insert(index);
        if self.by_name.contains_key(&coordinate.name) {
            coordinate.name = format!("{joint}/{}", coordinate.name);
        }
        if self.by_name.insert(coordinate.name.clone(), index).is_some() {
            return Err(OsimProblem::Twice { place, what: "coordinate", name: coordinate.name });
        }
        self.list.push(coordinate);
        self.traits.push(traits);
        Ok(index)
    }

    /// The coordinate a text names: alone, or as the end of a path.
    pub(super) fn find(&self, text: &str, node: Node<'_>) -> Result<usize, OsimProblem> {
        let bare = text.rsplit('/').next().unwrap_or_default();
        let found = if text.starts_with('/') { self.by_path.get(text) } else { None };
        found.or_else(|| self.by_name.get(bare)).copied().ok_or_else(|| OsimProblem::Unknown {
            place: node.place(),
            what: "coordinate",
            name: shorten(text),
            near: near(bare, self.list.iter().map(|c| c.name.as_str())),
        })
    }
}

/// A coordinate's properties.
pub(super) fn read<'a>(reader: &Reader<'a>, node: Node<'a>, kind: CoordinateKind) -> Result<CoordinateIr, OsimProblem> {
    let mut coordinate = CoordinateIr {
        name: reader.unique_name(node)?,
        kind,
        range: range(reader, node)?,
        default: reader.number(node, "default_value", Some(0.0))?,
        locked: reader.flag(node, "locked", false)?,
        clamped: reader.flag(node, "clamped", false)?,
    };
    if reader.flag(node, "prescribed", false)? {
        let function = reader.object(node, "prescribed_function", functions::is_function);
        match function.filter(|f| f.name() == "Constant").map(|f| functions::read(reader, f)).transpose()? {
            // Held at a value: what OpenSim does with it is what a lock does.
            Some(Function::Constant(value)) => (coordinate.locked, coordinate.default) = (true, value),
            _ => {
                let accepted = "<prescribed>false</prescribed>, or a Constant as <prescribed_function>";
                return Err(OsimProblem::unsupported(node.place(), "a coordinate prescribed in time", accepted));
            }
        }
    }
    Ok(coordinate)
}

/// A coordinate the file leaves out: OpenSim's defaults.
pub(super) fn unwritten(name: String, kind: CoordinateKind) -> CoordinateIr {
    CoordinateIr { name, kind, range: DEFAULT_RANGE, default: 0.0, locked: false, clamped: false }
}

/// Two numbers in order; infinite ones are accepted.
fn range<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<(f64, f64), OsimProblem> {
    let Some(property) = reader.property(node, "range") else { return Ok(DEFAULT_RANGE) };
    let text = property.text();
    let mut words = text.split_ascii_whitespace().map(str::parse::<f64>);
    match (words.next(), words.next(), words.next()) {
        (Some(Ok(low)), Some(Ok(high)), None) if low <= high => Ok((low, high)),
        _ => Err(OsimProblem::invalid(property.place(), &text, "two numbers are needed, the lower one first")),
    }
}
