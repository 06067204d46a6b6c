//! The service as clients meet it: over sockets, from outside.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot go on has failed"
)]

mod fuzz;
mod guard;
mod http;
mod limits;
mod live;
mod openapi;
mod several;
mod support;
