//! Brushes that users write: one WGSL file in, a kernel and its declared parameters out.
//!
//! A file holds comments that declare parameters and a function from a sample's old height to its new one; the
//! users' guide is `docs/custom-brushes.md`. It comes from anywhere, so nothing in it may reach a GPU that has not
//! been seen to end, to touch nothing but its input, and to be no more work than [`MAX_OPERATIONS`]:
//!
//! 1. the rules on text and tokens (`rule`), which also bound how deep naga's recursion goes;
//! 2. the file with its library alone, so that none of the engine's own names is in reach: naga, then the rules on
//!    naga's module;
//! 3. the whole kernel, `shaders/custom/brush.wgsl`, with the file in its place. `names` keeps the names of both
//!    apart.

mod names;
mod parameter;
mod rule;

#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::thread;

use crate::compile::Diagnostic;
use crate::compile::diagnostic;
use crate::compile::lint::{self, Lint};
use crate::compile::text;
use crate::compile::tree::SourceTree;
use crate::compile::{compile_module, reflect, resolve, validate};
use crate::error::{Error, Result};
use crate::shader::Shader;
use names::{Names, Renaming};
use parameter::Declarations;
use rule::{Parsed, Reporter};

/// The most operations that a brush may take for one sample and instance, by the compiler's own count.
pub const MAX_OPERATIONS: u64 = 65_536;

/// The most parameters that a brush may declare.
pub const MAX_PARAMETERS: usize = 32;

/// Every rule for custom brushes, sorted by name. The lint `nan_test` holds too, the other house lints do not.
pub const RULES: &[&Lint] = rule::RULES;

/// The kernel around a user's function.
const KERNEL: &str = "custom/brush.wgsl";
/// Where the user's text stands in the kernel.
const BRUSH: &str = "driver/custom_brush.wgsl";
/// Where its parameters stand.
const PARAMETERS: &str = "driver/custom_parameters.wgsl";
/// The user's text with what it may see, and nothing else.
const ALONE: &str = "custom/alone.wgsl";
const ALONE_TEXT: &str = "#include \"lib/custom.wgsl\"\n\
    #include \"driver/custom_parameters.wgsl\"\n\
    #include \"driver/custom_brush.wgsl\"\n";

/// naga's parser and its lowering are recursive. Ten times what the deepest text takes that passes the rules.
const STACK_IN_BYTES: usize = 32 << 20;

/// A step of the compilation, or what is wrong with the user's file.
type Checked<T> = std::result::Result<T, Vec<Diagnostic>>;

/// A number that a brush declares, which its user may change without changing the file.
#[derive(Clone, Debug, PartialEq)]
pub struct CustomParameter {
    /// Its name: an identifier.
    pub name: String,
    /// Its value where none is given, from `min` to `max`.
    pub default: f32,
    /// The least value.
    pub min: f32,
    /// The largest value.
    pub max: f32,
    /// What it is, for a user to read.
    pub meaning: String,
}

/// A brush that a user wrote, checked and ready for a pipeline.
///
/// The shader binds what `brush/raise` binds, and two uniforms more in group 1: binding 11, the parameters in the order
/// of their declaration, an `f32` each (one unused `f32` if there are none), and binding 12, the struct `Custom` of
/// `shaders/custom/brush.wgsl`. Its stem is the same for all custom brushes.
#[derive(Clone, Debug, PartialEq)]
pub struct CustomBrush {
    /// The kernel. Its sources name the user's file, so a driver's message leads to the line there.
    pub shader: Shader,
    /// What may be set, in the order of the file.
    pub parameters: Vec<CustomParameter>,
    /// The file's first line of comment, without its slashes; empty if there is none.
    pub summary: String,
    /// How many operations it takes for one sample and instance at most, up to [`MAX_OPERATIONS`].
    pub num_operations: u64,
}

/// Compiles a user's brush; `file_name` stands in errors. Any text may be given, and is refused or compiled within a
/// bounded time.
///
/// ```
/// let text = "// Lifts the ground.
/// // @param share: f32 = 0.5 (0 .. 1) \"how much of the weight counts\"
/// fn brush(at: BrushInput) -> f32 {
///     return at.height_m + parameters.share * at.weight;
/// }
/// ";
/// let brush = orogeny_shaders::custom::compile_custom(text, "lift.wgsl")?;
/// assert_eq!(brush.summary, "Lifts the ground.");
/// assert_eq!(brush.parameters[0].name, "share");
///
/// let error = orogeny_shaders::custom::compile_custom(&text.replace("share *", "part *"), "lift.wgsl").unwrap_err();
/// assert!(error.to_string().contains("lift.wgsl:4:"));
/// # Ok::<(), orogeny_shaders::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::BrokenBrush`] with what is wrong and where. [`Error::Thread`] if the system gives no thread to compile on,
/// [`Error::CompilerFailed`] if naga panics, which would be a mistake in it.
pub fn compile_custom(text: &str, file_name: &str) -> Result<CustomBrush> {
    // A thread of its own, for the stack and because a panic stays in it.
    thread::scope(|scope| {
        let thread = thread::Builder::new()
            .name("orogeny.shaders.custom".to_owned())
            .stack_size(STACK_IN_BYTES)
            .spawn_scoped(scope, || compile(text, file_name))
            .map_err(|source| Error::Thread { source })?;
        thread.join().unwrap_or_else(|_| Err(Error::CompilerFailed { file: file_name.to_owned() }))
    })
}

fn compile(text: &str, file_name: &str) -> Result<CustomBrush> {
    let broken = |diagnostics| Error::BrokenBrush {
        file: file_name.to_owned(),
        diagnostics: diagnostic::sorted(diagnostics),
    };
    let mut tree = SourceTree::new("shaders");
    for (path, engine_text) in crate::CUSTOM_FILES {
        tree.insert(path, engine_text)?;
    }
    tree.insert(ALONE, ALONE_TEXT)?;
    let mut names = Names::of_engine(&tree);

    // The stand-in shall not be shown for the line of a text that is too long to be taken.
    tree.insert_shown(BRUSH, file_name, "")?;
    Reporter::check(&tree, |reporter| rule::text::check_size(text, reporter)).map_err(broken)?;
    tree.insert_shown(BRUSH, file_name, text)?;
    let declarations = check_text(&tree, &mut names).map_err(broken)?;

    let renaming = Renaming::new(&names);
    tree.insert(PARAMETERS, &declarations.wgsl(|name| name))?;
    let num_operations = check_alone(&tree).map_err(|diagnostics| broken(in_file(&tree, diagnostics)))?;

    let renamed = renaming.apply(tree.get(BRUSH).unwrap_or_default());
    tree.insert_shown(BRUSH, file_name, &renamed)?;
    tree.insert(PARAMETERS, &declarations.wgsl(|name| renaming.new_name(name)))?;
    let shader = kernel(&tree, file_name).map_err(broken)?;
    Ok(CustomBrush {
        shader,
        parameters: declarations.parameters,
        summary: declarations.summary,
        num_operations,
    })
}

/// What can be told from the text: the declared parameters, or what is wrong.
fn check_text(tree: &SourceTree, names: &mut Names) -> Checked<Declarations> {
    let source = tree.get(BRUSH).unwrap_or_default();
    Reporter::check(tree, |reporter| rule::text::check_characters(source, reporter))?;
    let (masked, line_comments) = text::split_comments(source)
        .map_err(|offset| vec![tree.diagnostic_at(BRUSH, offset, "this comment never ends")])?;
    let tokens = text::tokens(&masked);
    Reporter::check(tree, |reporter| rule::text::check_tokens(&masked, &tokens, reporter))?;

    names.add_file(&tokens);
    Reporter::check(tree, |reporter| {
        rule::attribute::check(&masked, &tokens, reporter);
        rule::declaration::check(&tokens, names, reporter);
        parameter::parse(source, &line_comments, reporter)
    })
}

/// The file and its library, parsed and measured: its number of operations, or what is wrong.
fn check_alone(tree: &SourceTree) -> Checked<u64> {
    let mut diagnostics = Vec::new();
    let flattened = resolve::flatten(tree, ALONE, &mut diagnostics);
    if !diagnostics.is_empty() {
        return Err(diagnostics);
    }
    let (module, info) = validate::parse_and_validate(tree, &flattened).map_err(|err| vec![err])?;
    lint::check_module(tree, &flattened, &module, &mut diagnostics);
    diagnostics.truncate(rule::MAX_DIAGNOSTICS);
    let parsed = Parsed { flattened: &flattened, module: &module, info: &info };
    let num_operations = Reporter::check(tree, |reporter| rule::check_module(&parsed, reporter));
    match num_operations {
        Ok(num_operations) if diagnostics.is_empty() => Ok(num_operations),
        Ok(_) => Err(diagnostics),
        Err(found) => Err(diagnostics.into_iter().chain(found).collect()),
    }
}

/// Errors that naga places nowhere, or in the library, are shown at the start of the user's file.
fn in_file(tree: &SourceTree, diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let file = tree.shown(BRUSH);
    let moved = |mut found: Diagnostic| {
        if found.file != file {
            let notes = std::mem::take(&mut found.notes);
            found = Diagnostic { lint: found.lint, notes, ..tree.diagnostic(BRUSH, 1, 1, found.message) };
        }
        found
    };
    diagnostics.into_iter().map(moved).collect()
}

/// The kernel with the user's text in its place.
fn kernel(tree: &SourceTree, file_name: &str) -> Checked<Shader> {
    let mut diagnostics = Vec::new();
    let (flattened, module) = compile_module(tree, KERNEL, &mut diagnostics);
    let shader =
        module.and_then(|module| reflect::shader(tree, KERNEL, &flattened, &module, &mut diagnostics));
    let Some(mut shader) = shader.filter(|_| diagnostics.is_empty()) else {
        return Err(in_file(tree, diagnostics));
    };
    for source in shader.sources.to_mut().iter_mut().filter(|source| *source == BRUSH) {
        *source = Cow::Owned(file_name.to_owned());
    }
    Ok(shader)
}
