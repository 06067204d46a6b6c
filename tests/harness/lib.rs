//! What the tests over several crates share: terrains, strokes, back ends, and comparisons that can fail.
//!
//! - [`gpu`]: the device that GPU tests run on. No adapter is a failure, never a skip.
//! - [`Plane`]: the heights of a whole terrain, and [`terrain`] with the kinds of it that tests paint on.
//! - [`paint`], [`apply`], [`plan`]: operations fed to an executor in a given way ([`Feed`]).
//! - [`compare`]: by bits, or within a [`Tolerance`] at each sample; each comparison is tested to fail.
//! - [`Reach`]: how many instances act on each sample, and the tolerance between back ends that follows.
//! - [`WatchedPages`]: a page store that counts, and that fails when it is told to.
//! - [`Screen`]: one that no one sees, for windows.
//! - [`skip`]: for what a machine cannot run. Said, written down and counted.

#![allow(
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test fails by panicking"
)]

mod adapter;
pub mod child;
pub mod compare;
mod operation;
mod plane;
mod random;
mod reach;
mod screen;
mod skip;
pub mod terrain;
mod watched;

pub use adapter::gpu;
pub use compare::{Agreement, Mismatch, Tolerance};
pub use operation::{Feed, Operation, Painted, Split, apply, paint, plan, resources};
pub use plane::{PADDING_M, Plane};
pub use random::Random;
pub use reach::Reach;
pub use screen::{Killed, Screen};
pub use skip::skip;
pub use watched::WatchedPages;

use std::path::{Path, PathBuf};

/// The root of the repository.
#[must_use]
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the repository").to_owned()
}
