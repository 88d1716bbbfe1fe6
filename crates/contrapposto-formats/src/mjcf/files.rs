//! The main file and its includes, seen as one tree.

use super::error::{IncludeRule, MjcfError};
use crate::xml::{self, Document, Limits, Node, Place, shorten};
use std::collections::{BTreeMap, BTreeSet};

/// All files of a model.
pub(super) struct Files {
    files: Vec<File>,
}

struct File {
    /// As the include names it; empty for the main file.
    name: String,
    document: Document,
    /// Which file takes the place of an `<include>`, by its element's index.
    includes: BTreeMap<usize, usize>,
}

/// An element and the file it stands in.
#[derive(Clone, Copy)]
pub(super) struct Item<'a> {
    files: &'a Files,
    file: usize,
    node: Node<'a>,
}

impl Files {
    pub(super) fn load(
        bytes: &[u8],
        file_name: &str,
        include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
        limits: &Limits,
    ) -> Result<Self, MjcfError> {
        let mut loaded = Self { files: vec![File::parse(String::new(), bytes, limits)?] };
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
                let refuse =
                    |why| MjcfError::Include { place: item.attribute_place("file"), value: shorten(text), why };
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
                let beside = folder.map(|folder| format!("{folder}/{name}"));
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
                let file = File::parse(name, &bytes, limits)?;
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

    pub(super) fn root(&self) -> Item<'_> {
        Item { files: self, file: 0, node: self.files[0].document.root() }
    }
}

impl File {
    fn parse(name: String, bytes: &[u8], limits: &Limits) -> Result<Self, MjcfError> {
        match xml::parse(bytes, limits) {
            Ok(document) => Ok(Self { name, document, includes: BTreeMap::new() }),
            Err(error) => Err(MjcfError::Xml { file: name, error }),
        }
    }
}

/// A path that stays in its folder, `.` and doubled `/` removed.
fn confined(path: &str) -> Result<String, IncludeRule> {
    let path = path.trim();
    if path.starts_with('/') {
        return Err(IncludeRule::Absolute);
    }
    if path.is_empty() || path.len() > 1024 || path.contains([':', '\\']) || path.contains(char::is_control) {
        return Err(IncludeRule::Plain);
    }
    let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") {
        return Err(IncludeRule::Outside);
    }
    if parts.is_empty() { Err(IncludeRule::Plain) } else { Ok(parts.join("/")) }
}

impl<'a> Item<'a> {
    pub(super) fn name(self) -> &'a str {
        self.node.name()
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    pub(super) fn attributes(self) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
        self.node.attributes()
    }

    pub(super) fn place(self) -> Place {
        Place { file: self.file_name(), ..self.node.place() }
    }

    pub(super) fn attribute_place(self, name: &str) -> Place {
        Place { file: self.file_name(), ..self.node.attribute_place(name) }
    }

    fn file_name(self) -> Box<str> {
        self.files.files[self.file].name.as_str().into()
    }

    /// The names of all elements of these kinds in all files.
    pub(super) fn names_of(self, tags: &[&str]) -> BTreeSet<&'a str> {
        let nodes = self.files.files.iter().flat_map(|f| f.document.nodes());
        nodes.filter(|n| tags.contains(&n.name())).filter_map(|n| n.attribute("name")).collect()
    }

    /// Child elements, includes replaced by what they include.
    pub(super) fn children(self) -> Vec<Item<'a>> {
        let mut children = vec![];
        self.collect(&mut children);
        children
    }

    /// Goes as deep as includes do, which is bounded.
    fn collect(self, children: &mut Vec<Item<'a>>) {
        for node in self.node.children() {
            match self.files.files[self.file].includes.get(&node.index()) {
                None => children.push(Item { node, ..self }),
                Some(&file) => {
                    let node = self.files.files[file].document.root();
                    Item { file, node, ..self }.collect(children);
                }
            }
        }
    }
}
