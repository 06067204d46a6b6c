//! The service: other programs read and brush terrains over HTTP and a WebSocket. `docs/service.md` is its protocol.
//!
//! ```text
//! listen ──▶ guard ──▶ http ──┐                     ┌── Session (thread: Terrain)
//!            (who may)        ├──▶ Room ── tasks ──▶│
//!                     live ───┘     └── Hub ◀ events┘
//!                                        └── outboxes ──▶ clients
//! ```
//!
//! A room is a terrain with those who are there. Its engine session does what is asked for, one thing after another, and
//! tells events; the hub, which is all the room's state and does no I/O, hands them on. What goes out to a client lies in its outbox, whose
//! size is bounded: what a slow client has not fetched yet is replaced by what is newer, never heaped up.

mod connection;
mod error;
mod frame;
mod guard;
mod http;
mod hub;
mod limits;
mod listen;
mod live;
mod message;
mod metrics;
mod outbox;
mod page;
mod reply;
mod room;
mod service;
mod subscription;
mod token;

pub use error::{Error, Result};
pub use frame::{FRAME_HEADER_BYTES, FrameFormat, FrameHeader};
pub use limits::Limits;
pub use service::{Running, ServiceOptions};
pub use token::Token;
