//! The editor as a person drives it: by mouse, keys and what is written on buttons.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "a test that meets what it does not expect is to fail there"
)]

mod browsing;
mod brushing;
mod commands;
mod comparing;
mod curves;
mod dialogs;
mod files;
mod log;
mod looking;
mod lost;
mod own_brushes;
mod panels;
mod pasting;
mod pictures;
mod presets;
mod random;
mod selecting;
mod splitting;
mod support;
