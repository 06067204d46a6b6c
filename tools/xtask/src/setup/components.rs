//! Parts of the Rust toolchain that a minimal installation leaves out.

use std::process::Command;

use anyhow::ensure;

use crate::cargo::{cargo, status, succeeds};

/// Installs a rustup component (`clippy` or `rustfmt`) unless it works already.
///
/// # Errors
///
/// It is missing and rustup is too, or rustup cannot install it.
pub fn component(name: &str) -> anyhow::Result<()> {
    let subcommand = name.strip_prefix("rust").unwrap_or(name); // rustfmt is `cargo fmt`
    if succeeds(&mut cargo([subcommand, "--version"])) {
        return Ok(());
    }
    println!("installing {name}");
    let installed = status(Command::new("rustup").args(["component", "add", name]))
        .is_ok_and(|status| status.success() && succeeds(&mut cargo([subcommand, "--version"])));
    ensure!(installed, "{name} is missing and could not be installed; run: rustup component add {name}");
    Ok(())
}
