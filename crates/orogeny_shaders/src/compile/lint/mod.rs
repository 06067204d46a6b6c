//! House lints: what naga accepts and this engine does not.
//!
//! Lints on names and declarations read the tokens of each file, so that they also see code that no kernel
//! calls. Lints on what code means read naga's module. Every module here holds one lint, its check and its tests.

mod entry_point;
mod group_zero;
mod lib_purity;
mod mix;
mod nan_test;
mod orphan;
mod transcendental;

use std::collections::BTreeSet;

use naga::{Block, Module, Span, Statement};

use super::diagnostic::Diagnostic;
use super::resolve::Flattened;
use super::text::{self, Token};
use super::tree::{Folder, SourceTree};
use super::validate;

/// Every house lint, sorted by name.
pub const LINTS: &[&Lint] = &[
    &entry_point::LINT,
    &group_zero::LINT,
    &lib_purity::LINT,
    &mix::LINT,
    &nan_test::LINT,
    &orphan::LINT,
    &transcendental::LINT,
];

/// A house rule for shaders; breaking it fails the build.
#[derive(Debug)]
#[non_exhaustive]
pub struct Lint {
    /// The name that errors show: `error[mix]`.
    pub name: &'static str,
    /// The rule.
    pub summary: &'static str,
    /// What goes wrong without it.
    pub why: &'static str,
    /// What to write instead.
    pub fix: &'static str,
}

impl Lint {
    /// The diagnostic of this lint at a place.
    pub(crate) fn broken(&'static self, place: Diagnostic) -> Diagnostic {
        let notes = vec![format!("why: {}", self.why), format!("fix: {}", self.fix)];
        Diagnostic { lint: Some(self.name), notes, ..place }
    }
}

/// A file as the lints on tokens see it.
struct SourceFile<'a> {
    path: &'a str,
    folder: Option<Folder>,
    tokens: &'a [Token<'a>],
}

impl<'a> SourceFile<'a> {
    /// The calls (or declarations) of functions with one of these names.
    fn calls(&self, names: &'a [&str]) -> impl Iterator<Item = Token<'a>> {
        let is_call = |pair: &&[Token<'a>]| matches!(pair, [name, open] if open.text == "(" && names.contains(&name.text));
        self.tokens.windows(2).filter(is_call).filter_map(|pair| pair.first().copied())
    }

    /// The attributes `@name` with one of these names, each with the tokens that follow it.
    fn attributes(&self, names: &'a [&str]) -> impl Iterator<Item = (Token<'a>, &'a [Token<'a>])> {
        let tokens = self.tokens;
        (0..tokens.len()).filter_map(move |index| match tokens.get(index..)? {
            [at, name, rest @ ..] if at.text == "@" && names.contains(&name.text) => Some((*name, rest)),
            _ => None,
        })
    }
}

/// A mistake that a lint on tokens found: a byte offset and what is wrong.
struct Finding {
    offset: usize,
    message: String,
}

type SourceCheck = fn(&SourceFile<'_>) -> Vec<Finding>;

/// Applies the lints on tokens to every file.
pub(crate) fn check_sources(tree: &SourceTree, diagnostics: &mut Vec<Diagnostic>) {
    let checks: &[(&Lint, SourceCheck)] = &[
        (&entry_point::LINT, entry_point::check),
        (&lib_purity::LINT, lib_purity::check),
        (&mix::LINT, mix::check),
        (&transcendental::LINT, transcendental::check),
    ];
    for (path, source) in tree.files() {
        // An endless comment is reported where the file is flattened; here it hides nothing.
        let masked = text::without_comments(source).unwrap_or_else(|_| source.to_owned());
        let tokens = text::tokens(&masked);
        let file = SourceFile { path, folder: Folder::of(path), tokens: &tokens };
        for &(lint, check) in checks {
            let findings = check(&file).into_iter();
            diagnostics.extend(
                findings.map(|found| lint.broken(tree.diagnostic_at(path, found.offset, found.message))),
            );
        }
    }
}

/// Applies the lints on naga's module to a flattened file.
pub(crate) fn check_module(
    tree: &SourceTree,
    flattened: &Flattened,
    module: &Module,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut report = |lint: &'static Lint, span: Span, message: String| {
        diagnostics.push(lint.broken(validate::diagnostic_at(tree, flattened, span, &message)));
    };
    group_zero::check(flattened, module, |span, message| report(&group_zero::LINT, span, message));
    nan_test::check(module, |span, message| report(&nan_test::LINT, span, message));
}

/// Applies the lint on files that no entry point includes.
pub(crate) fn check_orphans(
    tree: &SourceTree,
    included: &BTreeSet<String>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let orphans = orphan::check(tree, included);
    diagnostics
        .extend(orphans.map(|(path, message)| orphan::LINT.broken(tree.diagnostic(path, 1, 1, message))));
}

/// The blocks that a statement is made of.
pub(crate) fn inner_blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        _ => Vec::new(),
    }
}
