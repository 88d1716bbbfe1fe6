//! Finds all possible mutants of the sources, and puts them into a random order.

use std::ops::Range;
use std::path::{Path, PathBuf};

use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// One change of a source.
#[derive(Clone, Debug)]
pub(crate) struct Mutant {
    /// Path of the file from the root of the workspace, and the line, from 1.
    pub(crate) file: String,
    pub(crate) line: usize,
    /// Bytes of the file that are replaced; none where a statement is put in.
    pub(crate) range: Range<usize>,
    /// The expression in their place, or the value that the function returns at once.
    pub(crate) text: String,
    pub(crate) what: String,
}

/// All possible mutants, by file and place.
pub(crate) fn candidates(root: &Path, folders: &[&str]) -> Result<Vec<Mutant>, String> {
    let mut files = vec![];
    for folder in folders {
        list(&root.join(folder), &mut files)?;
    }
    files.sort_unstable();
    let mut all = vec![];
    for path in files {
        let source = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let file = path.strip_prefix(root).unwrap_or(&path).display().to_string();
        all.extend(of_source(file, &source)?);
    }
    Ok(all)
}

/// The possible mutants of one file.
pub(crate) fn of_source(file: String, source: &str) -> Result<Vec<Mutant>, String> {
    let parsed = syn::parse_file(source).map_err(|error| format!("{file}: {error}"))?;
    let mut found = vec![];
    Visitor { file, source, found: &mut found }.visit_file(&parsed);
    Ok(found)
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    for entry in std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry.map_err(|error| error.to_string())?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// The mutants in an order that depends on the seed alone (Fisher & Yates, with SplitMix64 by Steele, Lea & Flood 2014).
pub(crate) fn shuffled(mut mutants: Vec<Mutant>, seed: u64) -> Vec<Mutant> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    for i in (1..mutants.len()).rev() {
        let j = ((u128::from(random()) * (i as u128 + 1)) >> 64) as usize;
        mutants.swap(i, j);
    }
    mutants
}

/// Gathers the mutants of a file. Tests, macros and what the compiler computes have none.
struct Visitor<'a> {
    file: String,
    source: &'a str,
    found: &'a mut Vec<Mutant>,
}

impl Visitor<'_> {
    fn add(&mut self, span: Span, range: Range<usize>, text: String, what: String) {
        let line = span.start().line;
        self.found.push(Mutant { file: self.file.clone(), line, range, text, what });
    }

    fn text(&self, spanned: &impl Spanned) -> String {
        self.source[spanned.span().byte_range()].to_owned()
    }

    /// Values that a function returns instead of what it computes.
    fn early_returns(&mut self, signature: &syn::Signature, block: &syn::Block) {
        if block.stmts.is_empty() {
            return;
        }
        let values: &[&str] = match &signature.output {
            syn::ReturnType::Default => &["()"],
            syn::ReturnType::Type(_, of) => match self.text(of).as_str() {
                "bool" => &["true", "false"],
                "f64" => &["0.0", "1.0", "-1.0"],
                "usize" | "u64" | "u32" | "i32" => &["0", "1"],
                "!" => &[],
                of if of.starts_with("Option<") => &["None"],
                of if of.starts_with("Vec<") => &["Vec::new()"],
                of if of.starts_with("Result<(),") || of == "Result<()>" => &["Ok(())"],
                of if of.starts_with("Result<") => &["Ok(Default::default())"],
                of if of.starts_with("impl") => &[],
                _ => &["Default::default()"],
            },
        };
        let at = block.brace_token.span.open().byte_range().end;
        for value in values {
            let what = format!("`{}` returns {value}", signature.ident);
            self.add(signature.ident.span(), at..at, (*value).to_owned(), what);
        }
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return attribute.path().is_ident("test") };
        list.path.is_ident("cfg") && list.tokens.to_string().contains("test")
    })
}

/// Operators that stand in for one.
fn others(operator: &syn::BinOp) -> &'static [&'static str] {
    use syn::BinOp::*;
    match operator {
        Add(_) => &["-", "*"],
        Sub(_) => &["+", "/"],
        Mul(_) => &["+", "/"],
        Div(_) => &["*", "%"],
        Rem(_) => &["/", "+"],
        Lt(_) => &["==", ">", "<="],
        Gt(_) => &["==", "<", ">="],
        Le(_) => &[">", "<"],
        Ge(_) => &["<", ">"],
        Eq(_) => &["!="],
        Ne(_) => &["=="],
        And(_) => &["||"],
        Or(_) => &["&&"],
        AddAssign(_) => &["-=", "*="],
        SubAssign(_) => &["+=", "/="],
        MulAssign(_) => &["+=", "/="],
        DivAssign(_) => &["*="],
        BitOrAssign(_) => &["&="],
        BitAndAssign(_) => &["|="],
        _ => &[],
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if item.sig.constness.is_none() && !is_test(&item.attrs) {
            self.early_returns(&item.sig, &item.block);
            self.visit_block(&item.block);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if item.sig.constness.is_none() && !is_test(&item.attrs) {
            self.early_returns(&item.sig, &item.block);
            self.visit_block(&item.block);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        let has_let = |side: &syn::Expr| matches!(side, syn::Expr::Let(_)) || self.text(side).contains("let ");
        if !(matches!(binary.op, syn::BinOp::And(_)) && (has_let(&binary.left) || has_let(&binary.right))) {
            let (left, right, old) = (self.text(&binary.left), self.text(&binary.right), self.text(&binary.op));
            for new in others(&binary.op) {
                let what = format!("`{old}` is `{new}` in `{}`", self.text(binary));
                self.add(binary.op.span(), binary.span().byte_range(), format!("{left} {new} {right}"), what);
            }
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        if matches!(unary.op, syn::UnOp::Not(_) | syn::UnOp::Neg(_)) {
            let what = format!("`{}` without its sign", self.text(unary));
            self.add(unary.span(), unary.span().byte_range(), self.text(&unary.expr), what);
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    // The compiler computes these.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_item_enum(&mut self, _: &'ast syn::ItemEnum) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
}

#[cfg(test)]
mod tests {
    use super::{of_source, shuffled};

    #[test]
    fn signs_operators_and_values_are_changed_and_tests_and_constants_are_not() {
        let source = "const N: usize = 1 + 1;\n#[cfg(test)]\nmod tests { fn t() -> bool { 1 < 2 } }\n\
                      fn f(a: f64) -> bool { -a < 2.0 }\nconst fn g() -> usize { 1 + 2 }\nfn h() { let [b] = [1 + 1; 1]; }";
        let found = of_source("a.rs".into(), source).unwrap();
        let what: Vec<_> = found.iter().map(|mutant| (mutant.line, mutant.text.as_str())).collect();
        let of_f = [(4, "true"), (4, "false"), (4, "-a == 2.0"), (4, "-a > 2.0"), (4, "-a <= 2.0"), (4, "a")];
        assert_eq!(what[..6], of_f);
        assert_eq!(what[6..], [(6, "()"), (6, "1 - 1"), (6, "1 * 1")]);
    }

    #[test]
    fn the_seed_alone_gives_the_order() {
        let found = || of_source("a.rs".into(), "fn f(a: f64) -> f64 { a + a - a * a / a }").unwrap();
        let order = |seed| shuffled(found(), seed).into_iter().map(|mutant| mutant.what).collect::<Vec<_>>();
        assert_eq!(order(1), order(1));
        assert_ne!(order(1), order(2));
    }
}
