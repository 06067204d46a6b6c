//! Noise: [`basis`] is one octave, [`turbulence`] the sum of several, [`row`] what a kernel needs of it.
//!
//! All of it is generic over the number ([`Real`]): rows are `f32`, normalising and the tests use `f64`. Samples are worked in
//! groups of [`LANES`], octave after octave, so that each octave is one loop that vectorises.
//!
//! Twins: `shaders/lib/noise.wgsl` and `shaders/driver/noise.wgsl`.

pub mod basis;
mod percentile;
mod real;
pub mod row;
pub mod turbulence;

pub use percentile::normalization;
pub use real::Real;

/// Samples that are worked together.
pub const LANES: usize = orogeny_field::noise::LATTICE_BLOCK as usize;
