//! The command line as its users have it: the real program, in processes of its own, on real files.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod backends;
mod bad_input;
mod bad_recipes;
mod beside;
mod brush_data;
mod cancel;
mod cloning;
mod compaction;
mod damage;
mod drainage;
mod edit;
mod exporting;
mod faults;
mod history;
mod importing;
mod job;
mod layers;
mod levels;
mod machine;
mod memory;
mod pictures;
mod presets;
mod program;
mod round_trip;
mod selecting;
mod serve;
mod sparse;
mod travel;
