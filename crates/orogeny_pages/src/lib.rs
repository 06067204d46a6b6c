//! Pages in memory: where they come from, which of them are resident, and the texture atlas that holds them on a GPU.
//!
//! - [`PageStore`]: what an executor asks for pages and gives changed ones back to. A terrain file stands behind it in the
//!   product, a map in tests.
//! - [`HeightProbe`]: single heights from before an operation, for planning.
//! - [`Residency`]: which page is in which slot, what is dirty, and which one goes when room is needed. Pure.
//! - [`Atlas`]: the slots as layers of `R32Float` texture arrays, within WebGPU's default limits.

mod atlas;
mod error;
mod probe;
mod residency;
mod source;

pub use atlas::{Atlas, AtlasLimits, Slot};
pub use error::{BoxError, Error, Result};
pub use probe::HeightProbe;
pub use residency::{Admitted, Evicted, Residency};
pub use source::{MemoryPages, PageStore};
