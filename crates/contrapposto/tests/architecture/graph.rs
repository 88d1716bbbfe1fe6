//! Finds which file of a crate uses which, through `use` declarations and through paths in the code.
//!
//! A name that a parent module only hands on (`pub use child::Name`) counts as a use of the file that defines it. `mod` lines and
//! names handed on are no use of a file.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::{Visit, visit_path};

use super::sources::Source;

/// Module path -> files that it uses, as module paths.
pub(super) type Graph = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

/// Names that each module hands on, with the paths that they stand for.
type HandedOn = BTreeMap<Vec<String>, BTreeMap<String, Vec<String>>>;

pub(super) fn uses(sources: &[Source]) -> Graph {
    let modules: BTreeSet<Vec<String>> = sources.iter().map(|source| source.module.clone()).collect();
    let mut handed_on = HandedOn::new();
    let mut raw: BTreeMap<Vec<String>, Vec<Vec<String>>> = BTreeMap::new();
    for source in sources {
        let mut collector =
            Collector { module: &source.module, modules: &modules, names: BTreeMap::new(), paths: vec![] };
        source.items.iter().for_each(|item| collector.visit_item(item));
        handed_on.insert(source.module.clone(), collector.names);
        raw.insert(source.module.clone(), collector.paths);
    }
    let resolve = |path: &[String]| resolve(path, &modules, &handed_on);
    raw.iter()
        .map(|(module, paths)| {
            let used = paths.iter().filter_map(|path| resolve(path)).filter(|used| used != module).collect();
            (module.clone(), used)
        })
        .collect()
}

/// The file that defines the last name of an absolute path (below the crate root).
fn resolve(path: &[String], modules: &BTreeSet<Vec<String>>, handed_on: &HandedOn) -> Option<Vec<String>> {
    let mut path = path.to_vec();
    for _ in 0..8 {
        let depth = (0..=path.len()).rev().find(|&depth| modules.contains(&path[..depth]))?;
        let (module, rest) = path.split_at(depth);
        let Some(name) = rest.first() else { return Some(module.to_vec()) };
        let Some(target) = handed_on.get(module).and_then(|names| names.get(name)) else {
            return Some(module.to_vec());
        };
        path = target.iter().chain(&rest[1..]).cloned().collect();
    }
    None
}

/// One circle of files, if there is one: each file uses the next, the last one the first.
pub(super) fn circle(graph: &Graph) -> Option<Vec<Vec<String>>> {
    let mut done = BTreeSet::new();
    graph.keys().find_map(|start| walk(graph, start, &mut vec![], &mut done))
}

fn walk(
    graph: &Graph,
    at: &Vec<String>,
    way: &mut Vec<Vec<String>>,
    done: &mut BTreeSet<Vec<String>>,
) -> Option<Vec<Vec<String>>> {
    if let Some(first) = way.iter().position(|module| module == at) {
        return Some(way[first..].to_vec());
    }
    if done.contains(at) {
        return None;
    }
    way.push(at.clone());
    let found = graph.get(at).into_iter().flatten().find_map(|next| walk(graph, next, way, done));
    way.pop();
    done.insert(at.clone());
    found
}

/// Absolute paths that a file names.
struct Collector<'a> {
    module: &'a [String],
    modules: &'a BTreeSet<Vec<String>>,
    /// Public or private names that `use` brings into the module.
    names: BTreeMap<String, Vec<String>>,
    paths: Vec<Vec<String>>,
}

impl Collector<'_> {
    /// The absolute path of one that begins with `crate`, `self`, `super` or a child module.
    fn absolute(&self, segments: &[String]) -> Option<Vec<String>> {
        let (mut base, mut rest) = match segments.first()?.as_str() {
            "crate" => (vec![], &segments[1..]),
            "self" => (self.module.to_vec(), &segments[1..]),
            "super" => (self.module[..self.module.len().checked_sub(1)?].to_vec(), &segments[1..]),
            child => {
                let path: Vec<String> = self.module.iter().cloned().chain([child.to_owned()]).collect();
                if !self.modules.contains(&path) {
                    return None;
                }
                (self.module.to_vec(), segments)
            }
        };
        while rest.first().is_some_and(|segment| segment == "super") {
            base.pop()?;
            rest = &rest[1..];
        }
        Some(base.into_iter().chain(rest.iter().cloned()).collect())
    }

    fn use_tree(&mut self, tree: &syn::UseTree, before: &mut Vec<String>, handed_on: bool) {
        match tree {
            syn::UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.use_tree(&path.tree, before, handed_on);
                before.pop();
            }
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.use_tree(tree, before, handed_on)),
            syn::UseTree::Name(name) => self.used(before, &name.ident.to_string(), &name.ident.to_string(), handed_on),
            syn::UseTree::Rename(name) => {
                self.used(before, &name.ident.to_string(), &name.rename.to_string(), handed_on)
            }
            syn::UseTree::Glob(_) => self.paths.extend(self.absolute(before)),
        }
    }

    fn used(&mut self, before: &[String], name: &str, known_as: &str, handed_on: bool) {
        let mut path = before.to_vec();
        let known_as = if name == "self" { before.last().map_or(name, String::as_str) } else { known_as };
        if name != "self" {
            path.push(name.to_owned());
        }
        let Some(path) = self.absolute(&path) else { return };
        if handed_on {
            self.names.insert(known_as.to_owned(), path);
        } else {
            // A module that is only named is used where its items are.
            let is_module = self.modules.contains(&path);
            self.names.insert(known_as.to_owned(), path.clone());
            if !is_module {
                self.paths.push(path);
            }
        }
    }
}

impl Visit<'_> for Collector<'_> {
    fn visit_item_use(&mut self, item: &syn::ItemUse) {
        let handed_on = !matches!(item.vis, syn::Visibility::Inherited);
        self.use_tree(&item.tree, &mut vec![], handed_on);
    }

    fn visit_item_mod(&mut self, module: &syn::ItemMod) {
        if let Some((_, items)) = &module.content {
            items.iter().for_each(|item| self.visit_item(item));
        }
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if segments.len() > 1 {
            let known = self.names.get(&segments[0]).filter(|target| self.modules.contains(*target));
            match known {
                Some(target) => self.paths.push(target.iter().chain(&segments[1..]).cloned().collect()),
                None => self.paths.extend(self.absolute(&segments)),
            }
        }
        visit_path(self, path);
    }
}
