//! What is made of whole fields: a row at a time, or, where water runs across all of it, at once.

mod around;
pub mod band;
pub mod between;
pub mod channel;
pub mod coarsen;
pub mod combine;
pub mod compose;
pub mod convolve;
pub mod cover;
pub mod droplets;
pub mod fill_pits;
pub mod flow;
pub mod grab;
pub mod interpolate;
pub mod lerp;
mod padded;
pub mod pipes;
pub mod resample;
pub mod sharpen;
pub mod shift;
pub mod thermal;
pub mod weights;

pub use padded::Channel;
