//! Compiles `shaders/` and embeds the result; a broken shader fails the build.
//!
//! The work is done by the library's own modules, so that a shader reloaded at run time passes exactly the
//! checks that it passed here. Nothing is written on failure: cargo stops, and no stale shader is embedded.

use std::env;
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

#[path = "src/compile/mod.rs"]
#[allow(dead_code, reason = "the library uses the rest")]
mod compile;
#[path = "build/embed.rs"]
mod embed;
#[path = "src/error.rs"]
#[allow(dead_code, reason = "the library uses the rest")]
mod error;
#[path = "src/shader.rs"]
#[allow(dead_code, reason = "the library uses the rest")]
mod shader;

fn main() -> ExitCode {
    match build() {
        Ok(()) => ExitCode::SUCCESS,
        Err(err) => {
            // Not `Result` from `main`, which would print the error's debug form on one line. A failed write
            // changes nothing: the exit code already stops the build.
            let _ = writeln!(io::stderr(), "{err}");
            ExitCode::FAILURE
        }
    }
}

fn build() -> Result<(), Box<dyn std::error::Error>> {
    let manifest_dir = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let root = manifest_dir.join("../../shaders");
    writeln!(io::stdout(), "cargo::rerun-if-changed={}", root.display())?;

    let tree = compile::SourceTree::load(&root)?;
    let shaders = compile::compile_tree(&tree)?;
    let generated = PathBuf::from(env::var("OUT_DIR")?).join("shaders.rs");
    fs::write(generated, embed::rust_source(&tree, &shaders)?)?;
    Ok(())
}
