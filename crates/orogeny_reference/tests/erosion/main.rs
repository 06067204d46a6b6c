//! Erosion against what NumPy makes of the formulas in `f64` (`tests/fixtures/field/make_erosion.py`), and what holds for every
//! field: nothing is lost, no summit grows, slopes come to rest, and no way of cutting the work changes a bit.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "this is a test: a panic is how it fails"
)]

mod droplets;
mod limits;
mod pipes;
mod support;
mod thermal;
