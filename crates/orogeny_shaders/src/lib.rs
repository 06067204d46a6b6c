//! The WGSL shaders of `shaders/`, checked at build time and embedded with their reflection.
//!
//! The build script resolves the includes of every entry-point file, parses and validates the result with naga
//! against the capabilities that the engine requests, applies the house lints, and generates [`SHADERS`]. A
//! broken shader fails the build with its real file and line; all errors of all files are listed at once.
//!
//! The same compiler is here at run time ([`compile_dir`], [`compile_tree`]), for shaders that change while the
//! program runs. It makes the same [`Shader`] values, and an [`Error::Broken`] leaves the caller with what it had.
//!
//! Brushes that users write are compiled by [`custom`], under rules of their own.
//!
//! This crate knows no GPU: pipelines are made by `orogeny_gpu` from what is reflected here. The rules of the
//! folder itself (includes, groups, precision, names) are in `shaders/README.md`.
//!
//! ```
//! let raise = orogeny_shaders::shader("brush/raise").ok_or("no such shader")?;
//! assert_eq!(raise.entry_point, "main");
//! assert!(raise.bindings.iter().all(|binding| binding.group >= 1));
//! # Ok::<(), &str>(())
//! ```

mod compile;
pub mod custom;
mod error;
mod shader;

use std::borrow::Cow;

pub use compile::lint::{LINTS, Lint};
pub use compile::{Diagnostic, SourceTree, compile_dir, compile_tree};
pub use error::{Error, Result};
pub use shader::{
    Binding, BindingKind, LineRun, Member, Override, SampleType, ScalarType, Shader, SourceLine, Struct,
    TextureAccess, TextureDimension,
};

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The embedded shader with the given stem, such as `brush/raise`; `None` if there is none.
pub fn shader(stem: &str) -> Option<&'static Shader> {
    let index = SHADERS.binary_search_by(|shader| shader.stem.as_ref().cmp(stem)).ok()?;
    SHADERS.get(index)
}
