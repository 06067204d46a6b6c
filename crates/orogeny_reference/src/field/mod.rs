//! What is made of whole fields, a row at a time.

pub mod coarsen;
pub mod convolve;
pub mod interpolate;
pub mod sharpen;
pub mod shift;
