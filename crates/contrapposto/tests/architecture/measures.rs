//! Measures functions: number of lines, and depth of nested blocks.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// One function.
pub(super) struct Function {
    pub(super) name: String,
    /// Lines from the signature to the closing brace.
    pub(super) lines: usize,
    /// Depth of nested `if`, `match`, `for`, `while`, `loop` and closures with blocks; `else if` is no deeper than its `if`.
    pub(super) depth: usize,
}

pub(super) fn functions(items: &[syn::Item]) -> Vec<Function> {
    let mut finder = Finder { found: vec![] };
    items.iter().for_each(|item| finder.visit_item(item));
    finder.found
}

struct Finder {
    found: Vec<Function>,
}

impl Finder {
    fn add(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let (first, last) = (signature.span().start().line, block.span().end().line);
        let mut depth = Depth { now: 0, most: 0 };
        depth.visit_block(block);
        let name = signature.ident.to_string();
        self.found.push(Function { name, lines: last - first + 1, depth: depth.most });
    }
}

impl Visit<'_> for Finder {
    fn visit_item_fn(&mut self, function: &syn::ItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &syn::ImplItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &syn::TraitItemFn) {
        if let Some(block) = &function.default {
            self.add(&function.sig, block);
        }
        visit::visit_trait_item_fn(self, function);
    }
}

struct Depth {
    now: usize,
    most: usize,
}

impl Depth {
    fn deeper(&mut self, inside: impl FnOnce(&mut Self)) {
        self.now += 1;
        self.most = self.most.max(self.now);
        inside(self);
        self.now -= 1;
    }
}

impl Visit<'_> for Depth {
    fn visit_item(&mut self, _: &syn::Item) {} // functions inside a function are measured by themselves

    fn visit_expr_if(&mut self, expression: &syn::ExprIf) {
        self.visit_expr(&expression.cond);
        self.deeper(|depth| depth.visit_block(&expression.then_branch));
        match expression.else_branch.as_ref().map(|(_, branch)| &**branch) {
            Some(syn::Expr::If(next)) => self.visit_expr_if(next),
            Some(branch) => self.deeper(|depth| visit::visit_expr(depth, branch)),
            None => {}
        }
    }

    fn visit_expr_match(&mut self, expression: &syn::ExprMatch) {
        self.visit_expr(&expression.expr);
        self.deeper(|depth| expression.arms.iter().for_each(|arm| depth.visit_arm(arm)));
    }

    fn visit_expr_for_loop(&mut self, expression: &syn::ExprForLoop) {
        self.visit_expr(&expression.expr);
        self.deeper(|depth| depth.visit_block(&expression.body));
    }

    fn visit_expr_while(&mut self, expression: &syn::ExprWhile) {
        self.visit_expr(&expression.cond);
        self.deeper(|depth| depth.visit_block(&expression.body));
    }

    fn visit_expr_loop(&mut self, expression: &syn::ExprLoop) {
        self.deeper(|depth| depth.visit_block(&expression.body));
    }

    fn visit_expr_closure(&mut self, expression: &syn::ExprClosure) {
        match &*expression.body {
            syn::Expr::Block(block) => self.deeper(|depth| depth.visit_block(&block.block)),
            body => self.visit_expr(body),
        }
    }
}
