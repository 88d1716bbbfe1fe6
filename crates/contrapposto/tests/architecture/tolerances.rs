//! Writes the table of all tolerances and limits of the solvers from their documentation in the sources.

use syn::spanned::Spanned;

use super::sources::{Source, crates, sources};

/// Rooms of the science crate whose constants are tolerances or limits of a solver or a search.
const ROOMS: [&str; 9] =
    ["math", "muscle", "contact", "effort", "posture_solver", "equilibria", "simulation", "capacity", "tracking"];

/// The page `docs/tolerances.md`.
pub(super) fn page() -> String {
    let mut page = String::from(
        "# Tolerances and limits of the solvers\n\nA test writes this page from the sources and compares it with the file; to write it anew:\n\
         `CONTRAPPOSTO_WRITE_DOCS=1 cargo test -p contrapposto tolerances`.\n",
    );
    for name in ["hierarchical-least-squares", "contrapposto"] {
        let files = sources(&crates()[name]).into_iter().map(|(source, _)| source);
        let solver = |source: &Source| {
            name != "contrapposto" || source.module.first().is_some_and(|room| ROOMS.contains(&room.as_str()))
        };
        for source in files.filter(solver) {
            let rows: Vec<String> = source.items.iter().filter_map(|item| row(item, &source.text)).collect();
            if !rows.is_empty() {
                page += &format!("\n## `{}`\n\n| Constant | Value | Meaning and unit |\n|---|---|---|\n", source.name);
                page += &rows.concat();
            }
        }
    }
    page
}

fn row(item: &syn::Item, text: &str) -> Option<String> {
    let syn::Item::Const(constant) = item else { return None };
    let numeric = ["f64", "usize", "u32", "u64"]
        .iter()
        .any(|kind| matches!(&*constant.ty, syn::Type::Path(path) if path.path.is_ident(kind)));
    if !numeric {
        return None;
    }
    let value = constant.expr.span();
    let line = text.lines().nth(value.start().line - 1)?;
    let value = line.split_once(" = ")?.1.trim_end_matches(';');
    let said = constant.attrs.iter().filter_map(|attribute| match &attribute.meta {
        syn::Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value().trim().to_owned()),
            _ => None,
        },
        _ => None,
    });
    let said = said.collect::<Vec<_>>().join(" ").replace('|', "\\|");
    Some(format!("| `{}` | `{value}` | {said} |\n", constant.ident))
}
