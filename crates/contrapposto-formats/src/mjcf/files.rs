//! Joins the main file and its includes to one tree.

use super::error::{IncludeRule, MjcfError};
use super::item::{File, Files, Item};
use crate::xml::{self, Limits, shorten};
use std::collections::{BTreeMap, BTreeSet};

/// Reads the main file and all files that it includes.
pub(super) fn load(
    bytes: &[u8],
    file_name: &str,
    include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    limits: &Limits,
) -> Result<Files, MjcfError> {
    let mut loaded = Files { files: vec![parse(String::new(), bytes, limits)?] };
    let main = file_name.rsplit(['/', '\\']).next().unwrap_or(file_name);
    let mut names = BTreeSet::from([main.to_owned()]);
    let mut depths = vec![0];
    let mut next = 0;
    while next < loaded.files.len() {
        let mut found = vec![];
        for node in loaded.files[next].document.nodes().filter(|n| n.name() == "include") {
            let item = Item { files: &loaded, file: next, node };
            let text =
                item.attribute("file").ok_or_else(|| MjcfError::Missing { place: item.attribute_place("file") })?;
            let refuse = |why| MjcfError::Include { place: item.attribute_place("file"), value: shorten(text), why };
            if node.children().next().is_some() {
                return Err(refuse(IncludeRule::Childless));
            }
            if depths[next] >= limits.include_depth {
                return Err(refuse(IncludeRule::TooDeep { cap: limits.include_depth }));
            }
            if loaded.files.len() + found.len() > limits.includes {
                return Err(refuse(IncludeRule::TooMany { cap: limits.includes }));
            }
            let name = confined(text).map_err(refuse)?;
            // As MuJoCo: from the main file's folder, otherwise from the folder of the file that includes.
            let folder = loaded.files[next].name.rsplit_once('/').map(|(folder, _)| folder);
            let beside = folder.and_then(|folder| confined(&format!("{folder}/{name}")).ok());
            let (name, bytes) = match (include(&name), beside) {
                (Ok(bytes), _) => (name, bytes),
                (Err(reason), None) => return Err(refuse(IncludeRule::NotRead { reason: shorten(&reason) })),
                (Err(reason), Some(beside)) => match include(&beside) {
                    Ok(bytes) => (beside, bytes),
                    Err(_) => return Err(refuse(IncludeRule::NotRead { reason: shorten(&reason) })),
                },
            };
            if !names.insert(name.clone()) {
                return Err(refuse(IncludeRule::Repeated));
            }
            let file = parse(name, &bytes, limits)?;
            if file.document.root().children().next().is_none() {
                return Err(refuse(IncludeRule::Empty));
            }
            found.push((node.index(), file));
        }
        for (index, file) in found {
            let number = loaded.files.len();
            loaded.files[next].includes.insert(index, number);
            loaded.files.push(file);
            depths.push(depths[next] + 1);
        }
        next += 1;
    }
    Ok(loaded)
}

fn parse(name: String, bytes: &[u8], limits: &Limits) -> Result<File, MjcfError> {
    match xml::parse(bytes, limits) {
        Ok(document) => Ok(File { name, document, includes: BTreeMap::new() }),
        Err(error) => Err(MjcfError::Xml { file: name, error }),
    }
}

/// Folders above that of the model from which files may be included: MyoSuite's models include the files of bodies that stand beside theirs.
const FOLDERS_UP: usize = 2;

/// A path that leads at most [`FOLDERS_UP`] above the model's folder, and there to an `.xml` only; `.`, doubled `/` and `a/..` are removed.
fn confined(path: &str) -> Result<String, IncludeRule> {
    let path = path.trim();
    if path.starts_with('/') {
        return Err(IncludeRule::Absolute);
    }
    if path.is_empty() || path.len() > 1024 || path.contains([':', '\\']) || path.contains(char::is_control) {
        return Err(IncludeRule::Plain);
    }
    let mut parts: Vec<&str> = vec![];
    for part in path.split('/').filter(|part| !part.is_empty() && *part != ".") {
        match parts.last() {
            Some(&last) if part == ".." && last != ".." => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    let up = parts.iter().filter(|part| **part == "..").count();
    if up > FOLDERS_UP || up > 0 && !path.ends_with(".xml") {
        return Err(IncludeRule::Outside);
    }
    if parts.is_empty() { Err(IncludeRule::Plain) } else { Ok(parts.join("/")) }
}
