//! One error at one place of one file, written the way rustc writes it.

use std::fmt;

/// An error in a shader file.
///
/// Displays as `shaders/brush/raise.wgsl:12:5: error: ...`, the line with a mark under it, and notes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Diagnostic {
    /// The file, with the folder's name: `shaders/brush/raise.wgsl`.
    pub file: String,
    /// The line, from 1.
    pub line: u32,
    /// The column in characters, from 1.
    pub column: u32,
    /// The name of the house lint that was broken; `None` for what naga or the include resolver refuses.
    pub lint: Option<&'static str>,
    /// What is wrong.
    pub message: String,
    /// Why, what to do, and other places that matter.
    pub notes: Vec<String>,
    /// The text of the line; empty if there is none.
    pub source_line: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: error", self.file, self.line, self.column)?;
        if let Some(lint) = self.lint {
            write!(f, "[{lint}]")?;
        }
        writeln!(f, ": {}", self.message)?;
        if !self.source_line.is_empty() {
            // Tabs are kept under tabs, so that the mark stands right at any tab width.
            let margin: String = (self.source_line.chars().take(self.column.saturating_sub(1) as usize))
                .map(|c| if c == '\t' { '\t' } else { ' ' })
                .collect();
            writeln!(f, "{:>5} | {}", self.line, self.source_line)?;
            writeln!(f, "      | {margin}^")?;
        }
        for note in &self.notes {
            writeln!(f, "      = {note}")?;
        }
        Ok(())
    }
}

/// Sorted by place, each mistake once: an error in a shared module is found again by every kernel that includes it.
///
/// naga numbers the functions and expressions in its messages by module, so the place tells them apart, not the text.
pub(crate) fn sorted(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by(|a, b| {
        let key = |d: &Diagnostic| (d.line, d.column, d.lint);
        a.file.cmp(&b.file).then_with(|| key(a).cmp(&key(b)))
    });
    diagnostics
        .dedup_by(|a, b| a.file == b.file && a.line == b.line && a.column == b.column && a.lint == b.lint);
    diagnostics
}
