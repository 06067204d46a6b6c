//! What a custom brush may be, rule by rule: first on its text and tokens, then on naga's module.
//!
//! Every module here but [`loops`] holds one rule, its check and its tests; [`super::parameter`] holds one too, beside
//! its parser.
//! The rules on the module list what is allowed, so that what a later naga brings is refused until someone looks at it.

pub(super) mod attribute;
mod cost;
pub(super) mod declaration;
mod forbidden;
mod loop_bound;
mod loops;
mod signature;
pub(super) mod text;
mod value_type;

use naga::valid::ModuleInfo;
use naga::{Function, Handle, Module, Span};

use super::{BRUSH, Checked, parameter};
use crate::compile::diagnostic::Diagnostic;
use crate::compile::lint::Lint;
use crate::compile::resolve::Flattened;
use crate::compile::tree::SourceTree;
use crate::compile::validate;

/// Every rule, sorted by name.
pub(super) const RULES: &[&Lint] = &[
    &attribute::LINT,
    &cost::LINT,
    &declaration::LINT,
    &forbidden::LINT,
    &loop_bound::LINT,
    &parameter::LINT,
    &signature::LINT,
    &text::LINT,
    &value_type::LINT,
];

/// More errors than anyone reads; a hostile file would break a rule with every byte.
pub(super) const MAX_DIAGNOSTICS: usize = 50;

/// Where the rules report to. What is beyond [`MAX_DIAGNOSTICS`] is left out.
pub(super) struct Reporter<'a> {
    tree: &'a SourceTree,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> Reporter<'a> {
    /// What `check` finds, or else what it returns.
    pub(super) fn check<T>(tree: &'a SourceTree, check: impl FnOnce(&mut Self) -> T) -> Checked<T> {
        let mut reporter = Self { tree, diagnostics: Vec::new() };
        let value = check(&mut reporter);
        if reporter.diagnostics.is_empty() { Ok(value) } else { Err(reporter.diagnostics) }
    }

    /// A broken rule at a byte offset of the user's file.
    pub(super) fn at_offset(&mut self, lint: &'static Lint, offset: usize, message: impl Into<String>) {
        self.report(lint, |tree| tree.diagnostic_at(BRUSH, offset, message));
    }

    /// A broken rule at a line and a column of the user's file, whose text is too long or too odd to be shown.
    fn unseen(&mut self, lint: &'static Lint, [line, column]: [u32; 2], message: impl Into<String>) {
        self.report(lint, |tree| {
            let place = tree.diagnostic(BRUSH, line, column, message);
            Diagnostic { source_line: String::new(), ..place }
        });
    }

    /// A broken rule at a span of the flattened text.
    fn at_span(&mut self, lint: &'static Lint, parsed: &Parsed<'_>, span: Span, message: &str) {
        self.report(lint, |tree| validate::diagnostic_at(tree, parsed.flattened, span, message));
    }

    fn report(&mut self, lint: &'static Lint, place: impl FnOnce(&SourceTree) -> Diagnostic) {
        if self.diagnostics.len() < MAX_DIAGNOSTICS {
            self.diagnostics.push(lint.broken(place(self.tree)));
        }
    }
}

/// A user's file with its library, as naga reads it.
pub(super) struct Parsed<'a> {
    pub flattened: &'a Flattened,
    pub module: &'a Module,
    pub info: &'a ModuleInfo,
}

impl<'a> Parsed<'a> {
    /// The functions of the user's file, callees before their callers.
    fn functions(&self) -> impl Iterator<Item = (Handle<Function>, &'a Function)> {
        let functions = &self.module.functions;
        functions.iter().filter(|&(handle, _)| self.is_in_file(functions.get_span(handle)))
    }

    /// Whether the user's file holds a span of the flattened text.
    fn is_in_file(&self, span: Span) -> bool {
        span.is_defined() && validate::place(self.flattened, span).0 == BRUSH
    }
}

/// Applies the rules on the module: the number of operations of the brush.
pub(super) fn check_module(parsed: &Parsed<'_>, reporter: &mut Reporter<'_>) -> u64 {
    value_type::check(parsed, reporter);
    forbidden::check(parsed, reporter);
    let brush = signature::check(parsed, reporter);
    if loop_bound::check(parsed, reporter) {
        return cost::check(parsed, brush, reporter);
    }
    0
}
