//! Reads the source files of a crate as syntax trees, with the module path of each file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use syn::spanned::Spanned;

/// One source file of a crate.
pub(super) struct Source {
    /// Path below the crate's folder, for messages.
    pub(super) name: String,
    /// Module path below the crate root: `["statics", "load"]`; empty for the root.
    pub(super) module: Vec<String>,
    /// Items outside `#[cfg(test)]`.
    pub(super) items: Vec<syn::Item>,
    pub(super) text: String,
}

impl Source {
    /// Number of lines before the unit tests of the file.
    pub(super) fn lines_without_tests(&self, file: &syn::File) -> usize {
        let tests = file.items.iter().filter(|item| is_test(item)).map(|item| {
            let span = item.span();
            span.end().line - span.start().line + 1
        });
        self.text.lines().count() - tests.sum::<usize>()
    }
}

/// The repository's folder.
pub(super) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

pub(super) fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.as_ref().display()))
}

/// Folders of all crates, by name.
pub(super) fn crates() -> BTreeMap<String, PathBuf> {
    let folders = std::fs::read_dir(root().join("crates")).unwrap();
    folders.map(|entry| entry.unwrap()).map(|entry| (entry.file_name().into_string().unwrap(), entry.path())).collect()
}

/// All Rust files below a folder, sorted.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The parsed files of a crate's `src`, each beside its whole syntax tree.
pub(super) fn sources(krate: &Path) -> Vec<(Source, syn::File)> {
    let src = krate.join("src");
    let mut all = vec![];
    for path in files(&src) {
        let text = read(&path);
        let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let relative = path.strip_prefix(&src).unwrap().with_extension("");
        let mut module: Vec<String> = relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        if ["lib", "main", "mod"].contains(&module.last().unwrap().as_str()) {
            module.pop();
        }
        let name = format!(
            "{}/src/{}",
            krate.file_name().unwrap().to_str().unwrap(),
            path.strip_prefix(&src).unwrap().display()
        );
        let items = file.items.iter().filter(|item| !is_test(item)).cloned().collect();
        all.push((Source { name, module, items, text }, file));
    }
    let declared_as_test: Vec<Vec<String>> = all.iter().flat_map(|(source, file)| test_modules(source, file)).collect();
    all.retain(|(source, _)| !declared_as_test.iter().any(|module| source.module.starts_with(module)));
    all
}

/// Modules that stand in files of their own and are compiled for tests only.
fn test_modules(source: &Source, file: &syn::File) -> Vec<Vec<String>> {
    let declared = file.items.iter().filter(|item| is_test(item)).filter_map(|item| match item {
        syn::Item::Mod(module) if module.content.is_none() => Some(module.ident.to_string()),
        _ => None,
    });
    declared.map(|name| source.module.iter().cloned().chain([name]).collect()).collect()
}

pub(super) fn is_test(item: &syn::Item) -> bool {
    attributes(item).iter().any(|attribute| {
        let is_cfg = attribute.path().is_ident("cfg");
        is_cfg && attribute.parse_args::<syn::Ident>().is_ok_and(|condition| condition == "test")
    })
}

fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Const(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Static(item) => &item.attrs,
        syn::Item::Struct(item) => &item.attrs,
        syn::Item::ExternCrate(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        _ => &[],
    }
}
