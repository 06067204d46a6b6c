//! naga's verdict on a flattened shader, at the place in the original file.

use std::error::Error;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, Span};

use super::diagnostic::Diagnostic;
use super::resolve::Flattened;
use super::text;
use super::tree::SourceTree;
use crate::shader;

/// What the engine requests of a device beyond the WebGPU baseline: nothing.
///
/// Read-write `r32float` storage textures and 32-bit atomics need no capability of naga's; the device is asked
/// for the texture access by `orogeny_gpu`.
const CAPABILITIES: Capabilities = Capabilities::empty();

/// Parses and validates; the first error of the module if it has any.
pub(crate) fn parse_and_validate(
    tree: &SourceTree,
    flattened: &Flattened,
) -> Result<(Module, ModuleInfo), Diagnostic> {
    let module = naga::front::wgsl::parse_str(&flattened.wgsl).map_err(|err| {
        let mut labels = err.labels();
        let (span, label) = labels.next().unwrap_or_default();
        let mut diagnostic = diagnostic_at(tree, flattened, span, err.message());
        diagnostic.notes.extend((!label.is_empty()).then(|| label.to_owned()));
        diagnostic.notes.extend(labels.map(|(span, label)| note_at(tree, flattened, span, label)));
        diagnostic.notes.extend(err.notes().map(str::to_owned));
        diagnostic
    })?;

    let info = Validator::new(ValidationFlags::all(), CAPABILITIES).validate(&module).map_err(|err| {
        // The spans go from the whole function to the expression: the narrowest says most.
        let narrowest =
            err.spans().filter_map(|(span, _)| span.to_range()).min_by_key(ExactSizeIterator::len);
        let span = narrowest.map(Span::from).unwrap_or_default();
        let mut message = err.as_inner().to_string();
        let mut cause = err.as_inner().source();
        while let Some(err) = cause {
            message = format!("{message}: {err}");
            cause = err.source();
        }
        diagnostic_at(tree, flattened, span, &message)
    })?;
    Ok((module, info))
}

/// An error at a span of the flattened text.
pub(crate) fn diagnostic_at(
    tree: &SourceTree,
    flattened: &Flattened,
    span: Span,
    message: &str,
) -> Diagnostic {
    let (path, line, column) = place(flattened, span);
    tree.diagnostic(path, line, column, message)
}

fn note_at(tree: &SourceTree, flattened: &Flattened, span: Span, label: &str) -> String {
    let (path, line, column) = place(flattened, span);
    format!("{}:{line}:{column}: {label}", tree.shown(path))
}

/// The file, line and column of a span's start. An unknown span is the start of the entry-point file.
pub(crate) fn place(flattened: &Flattened, span: Span) -> (&str, u32, u32) {
    let entry_file = flattened.sources.first().map_or("", String::as_str);
    let Some(range) = span.to_range() else {
        return (entry_file, 1, 1);
    };
    let (flattened_line, column) = text::position(&flattened.wgsl, range.start);
    // A span at the very end of the text (an unexpected end of file) belongs to its last line.
    let last_line = flattened.line_runs.last().map_or(0, |run| run.flattened_line + run.num_lines - 1);
    let located = shader::locate(&flattened.line_runs, flattened_line.min(last_line));
    let path = located.and_then(|(source, _)| flattened.sources.get(source as usize));
    match (path, located) {
        (Some(path), Some((_, line))) => (path, line, column),
        _ => (entry_file, 1, 1),
    }
}
