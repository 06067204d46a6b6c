//! The CPU truth of every kernel, and the arithmetic of the CPU back end: plain loops over one row of samples.
//!
//! Nothing here knows of pages, threads or a GPU. A file has the stem of the shader that it is the twin of
//! (`shaders/brush/raise.wgsl` and [`brush::raise`]), and does the same `f32` operations in the same order, so that the two
//! differ only where a GPU rounds differently. The tests hold the rows against formulas evaluated by NumPy in `f64`.
//!
//! A row of an instance is worked in two steps that both vectorise: [`amounts::row`] turns distance into the amount `A`
//! for each sample, and the brush's own `row` applies it.
//!
//! ```
//! use orogeny_field::{Falloff, Footprint, Instance, Profile, ProfileShape};
//! use orogeny_reference::{amounts, brush};
//!
//! let dab = Instance {
//!     cell: [4, 0], inverse_radius: 1.0 / 4.0, amplitude: 8.0, inverse_radius_m: 0.25, ..Instance::EVERYWHERE
//! };
//! let falloff = Falloff::from(Profile { shape: ProfileShape::Linear, falloff_ratio: 1.0 });
//! let footprint = Footprint { falloff, ..Footprint::EVERYWHERE };
//! let (mut heights, mut amounts_row) = ([100.0; 9], [0.0; 9]);
//! amounts::row(&mut amounts_row, 0, 0, &dab, &footprint);
//! brush::raise::row(&mut heights, &amounts_row);
//! assert_eq!(heights, [100.0, 102.0, 104.0, 106.0, 108.0, 106.0, 104.0, 102.0, 100.0]);
//! ```

pub mod amounts;
pub mod brush;
pub mod curve;
pub mod falloff;
pub mod field;
pub mod gate;
pub mod hash;
pub mod noise;
pub mod select;
pub mod store;
pub mod transcendental;
