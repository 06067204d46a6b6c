//! What is made of whole fields: a row at a time, or, where water runs across all of it, at once.

mod around;
pub mod coarsen;
pub mod convolve;
pub mod droplets;
pub mod fill_pits;
pub mod flow;
pub mod interpolate;
mod padded;
pub mod pipes;
pub mod sharpen;
pub mod shift;
pub mod thermal;

pub use padded::Channel;
