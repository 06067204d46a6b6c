//! The compiler: a folder of WGSL files in, [`Shader`]s or every error out.
//!
//! Read in this order: [`tree`] (the files), [`resolve`] (includes), [`validate`] (naga), [`lint`] (house rules),
//! [`reflect`] (layouts). [`text`] and [`diagnostic`] serve them all. The build script and the library share
//! these modules, so they use nothing but naga. A brush that a user wrote passes through them too, file by file
//! ([`crate::custom`]).
//!
//! Modules of `lib/` are compiled twice: inside every kernel that includes them, and alone. So errors in two of
//! them are both reported even where one kernel includes both, and a module includes what it uses.

pub(crate) mod diagnostic;
pub(crate) mod lint;
pub(crate) mod reflect;
pub(crate) mod resolve;
pub(crate) mod text;
pub(crate) mod tree;
pub(crate) mod validate;

#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::path::Path;

pub use diagnostic::Diagnostic;
pub use tree::SourceTree;

use crate::error::{Error, Result};
use crate::shader::Shader;
use tree::{ENTRY_FOLDERS, Folder};

/// Compiles every entry-point file below the folder `root`, in the order of their stems.
///
/// # Errors
///
/// [`Error::Read`] and [`Error::TooLarge`] for the folder itself, and those of [`compile_tree`].
pub fn compile_dir(root: &Path) -> Result<Vec<Shader>> {
    compile_tree(&SourceTree::load(root)?)
}

/// Compiles every entry-point file of `tree`, in the order of their stems.
///
/// Text from outside may nest deeply, and naga's parser is recursive up to its own limit: call this on a thread
/// with the usual 2 MiB of stack or more.
///
/// # Errors
///
/// [`Error::Broken`] with all errors of all files; [`Error::NoShaders`] if there is nothing to compile.
pub fn compile_tree(tree: &SourceTree) -> Result<Vec<Shader>> {
    if tree.paths_in(Folder::Entry).next().is_none() {
        return Err(Error::NoShaders { root: tree.name().to_owned(), folders: ENTRY_FOLDERS.join(", ") });
    }

    let mut diagnostics = tree.diagnostics().to_vec();
    lint::check_sources(tree, &mut diagnostics);
    for path in tree.paths_in(Folder::Lib) {
        // A module that compiles alone has nothing to reflect.
        let _ = compile_module(tree, path, &mut diagnostics);
    }

    let mut shaders = Vec::new();
    let mut included = BTreeSet::new();
    for path in tree.paths_in(Folder::Entry) {
        let (flattened, module) = compile_module(tree, path, &mut diagnostics);
        if let Some(module) = module {
            shaders.extend(reflect::shader(tree, path, &flattened, &module, &mut diagnostics));
        }
        included.extend(flattened.sources);
    }
    lint::check_orphans(tree, &included, &mut diagnostics);

    if diagnostics.is_empty() {
        return Ok(shaders);
    }
    Err(Error::Broken { diagnostics: diagnostic::sorted(diagnostics) })
}

/// Flattens, parses, validates and lints one file; no module if any of that failed.
pub(crate) fn compile_module(
    tree: &SourceTree,
    path: &str,
    diagnostics: &mut Vec<Diagnostic>,
) -> (resolve::Flattened, Option<naga::Module>) {
    let num_before = diagnostics.len();
    let flattened = resolve::flatten(tree, path, diagnostics);
    if diagnostics.len() > num_before {
        return (flattened, None);
    }
    match validate::parse_and_validate(tree, &flattened) {
        Ok((module, _)) => {
            lint::check_module(tree, &flattened, &module, diagnostics);
            (flattened, Some(module))
        }
        Err(diagnostic) => {
            diagnostics.push(diagnostic);
            (flattened, None)
        }
    }
}
