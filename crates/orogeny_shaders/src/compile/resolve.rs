//! Includes: one entry-point file and all it needs as one text, with a table back to the files.
//!
//! A line `#include "lib/falloff.wgsl"` stands for the file's text. The path is relative to the shader folder.
//! A file is included once however often it is named, before the first file that names it goes on.

use super::diagnostic::Diagnostic;
use super::text;
use super::tree::{ENTRY_FOLDERS, Folder, SourceTree};
use crate::shader::LineRun;

/// Includes in includes: deeper than any real shader goes, far less than the stack holds.
const MAX_DEPTH: usize = 32;

/// An entry-point file with its includes in place.
#[derive(Debug, Default)]
pub(crate) struct Flattened {
    /// The text.
    pub wgsl: String,
    /// The files that went in, in the order of their first line.
    pub sources: Vec<String>,
    /// Where the lines came from.
    pub line_runs: Vec<LineRun>,
}

/// Resolves the includes of the file at `path`. What could not be resolved is left out and reported.
pub(crate) fn flatten(tree: &SourceTree, path: &str, diagnostics: &mut Vec<Diagnostic>) -> Flattened {
    let mut flattener = Flattener { tree, diagnostics, open: Vec::new(), flattened: Flattened::default() };
    flattener.file(path);
    flattener.flattened
}

struct Flattener<'a> {
    tree: &'a SourceTree,
    diagnostics: &'a mut Vec<Diagnostic>,
    /// The files being included, outermost first.
    open: Vec<&'a str>,
    flattened: Flattened,
}

impl<'a> Flattener<'a> {
    fn file(&mut self, path: &'a str) {
        let text = self.tree.get(path).unwrap_or_default();
        let masked = match text::without_comments(text) {
            Ok(masked) => masked,
            Err(offset) => {
                self.diagnostics.push(self.tree.diagnostic_at(path, offset, "this comment never ends"));
                return;
            }
        };

        let source = count(self.flattened.sources.len());
        self.flattened.sources.push(path.to_owned());
        self.open.push(path);
        for (index, (line_text, masked_line)) in text.lines().zip(masked.lines()).enumerate() {
            let line = count(index + 1);
            match directive(masked_line) {
                None => self.push_line(source, line, line_text),
                Some(included) => {
                    if let Err(message) = included.and_then(|included| self.include(path, included)) {
                        let indent = masked_line.chars().take_while(|c| c.is_whitespace()).count();
                        self.diagnostics.push(self.tree.diagnostic(path, line, count(indent + 1), message));
                    }
                }
            }
        }
        self.open.pop();
    }

    fn include(&mut self, from: &str, path: &str) -> Result<(), String> {
        check_path(path)?;
        let tree = self.tree;
        let Some((path, _)) = tree.files().find(|&(known, _)| known == path) else {
            return Err(format!("there is no `{path}` in {}/", tree.name()));
        };
        match (Folder::of(from), Folder::of(path)) {
            (Some(Folder::Lib), Some(Folder::Driver)) => {
                return Err(format!(
                    "`{path}` has bindings, and lib/ has none; take what it needs as arguments"
                ));
            }
            (_, Some(Folder::Lib | Folder::Driver)) => {}
            _ => {
                let folders = ENTRY_FOLDERS.join(", ");
                return Err(format!(
                    "`{path}` is an entry point; move what is shared from {folders} to lib/ or driver/"
                ));
            }
        }

        if let Some(start) = self.open.iter().position(|&open| open == path) {
            let cycle: Vec<&str> = self.open.iter().copied().skip(start).chain([path]).collect();
            return Err(format!("include cycle: {}", cycle.join(" -> ")));
        }
        if self.open.len() >= MAX_DEPTH {
            return Err(format!("includes nested deeper than {MAX_DEPTH}; include the files side by side"));
        }
        if !self.flattened.sources.iter().any(|source| source == path) {
            self.file(path);
        }
        Ok(())
    }

    fn push_line(&mut self, source: u32, source_line: u32, line_text: &str) {
        self.flattened.wgsl.push_str(line_text);
        self.flattened.wgsl.push('\n');
        match self.flattened.line_runs.last_mut() {
            Some(run) if run.source == source && run.source_line + run.num_lines == source_line => {
                run.num_lines += 1;
            }
            last => {
                let flattened_line = last.map_or(1, |run| run.flattened_line + run.num_lines);
                let run = LineRun { flattened_line, num_lines: 1, source, source_line };
                self.flattened.line_runs.push(run);
            }
        }
    }
}

/// The path that a line includes, what is wrong with the line, or `None` for a line of WGSL.
fn directive(masked_line: &str) -> Option<Result<&str, String>> {
    let directive = masked_line.trim().strip_prefix('#')?;
    let path = (directive.strip_prefix("include"))
        .and_then(|rest| rest.trim_start().strip_prefix('"'))
        .and_then(|rest| rest.strip_suffix('"'))
        .filter(|path| !path.contains('"'));
    Some(path.ok_or_else(|| "expected `#include \"lib/name.wgsl\"`, alone on its line".to_owned()))
}

fn check_path(path: &str) -> Result<(), String> {
    let is_plain = |part: &str| !matches!(part, "" | "." | "..");
    if path.contains(['\\', ':']) || !path.split('/').all(is_plain) {
        return Err(format!(
            "`{path}` leads out of the shader folder or is not in its plain form; write it relative to the folder, \
             as in `lib/name.wgsl`"
        ));
    }
    Ok(())
}

/// Lines and files are bounded by the tree's limits, far below `u32`.
fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
