//! Materials.
mod surface;
pub use surface::*;
