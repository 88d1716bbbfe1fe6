//! Walks the elements of a main file and its includes as one tree.

use crate::xml::{Document, Node, Place};
use std::collections::{BTreeMap, BTreeSet};

/// All files of a model.
pub(super) struct Files {
    pub(super) files: Vec<File>,
}

/// One file.
pub(super) struct File {
    /// As the include names it; empty for the main file.
    pub(super) name: String,
    pub(super) document: Document,
    /// Number of the file that takes the place of an `<include>`, by its element's index.
    pub(super) includes: BTreeMap<usize, usize>,
}

/// An element and the file it stands in.
#[derive(Clone, Copy)]
pub(super) struct Item<'a> {
    pub(super) files: &'a Files,
    pub(super) file: usize,
    pub(super) node: Node<'a>,
}

impl Files {
    pub(super) fn root(&self) -> Item<'_> {
        Item { files: self, file: 0, node: self.files[0].document.root() }
    }
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

    /// Child elements, includes replaced by the elements of their files.
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
