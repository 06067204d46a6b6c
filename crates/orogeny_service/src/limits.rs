//! How much clients may ask for.

use std::time::Duration;

/// How much clients may ask for. What is over a limit is refused, and the answer names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Connections at a time.
    pub connections: usize,
    /// Bytes of a request's body.
    pub body_in_bytes: usize,
    /// Bytes of a message to the live channel.
    pub message_in_bytes: usize,
    /// Time in which the head of a request has to come.
    pub head: Duration,
    /// Time in which the body of a request has to come.
    pub body: Duration,
    /// Time in which a client takes what is sent to it.
    pub send: Duration,
    /// Things that a client asked for and that are not done.
    pub tasks_per_client: usize,
    /// Things that all clients of a terrain asked for and that are not done.
    pub tasks_per_terrain: usize,
    /// Points of strokes of a client that are not done.
    pub points_per_client: usize,
    /// Pages that a client looks at.
    pub pages_per_subscription: u64,
    /// Page frames under way to a client without being acknowledged.
    pub window: u32,
    /// Messages that wait for a client, page frames not counted.
    pub messages_waiting: usize,
    /// Samples of one answer with heights.
    pub samples_per_answer: u64,
    /// Answers with heights that are made at a time.
    pub readers: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 128,
            body_in_bytes: 64 << 20,
            message_in_bytes: 1 << 20,
            head: Duration::from_secs(10),
            body: Duration::from_secs(60),
            send: Duration::from_secs(30),
            tasks_per_client: 64,
            tasks_per_terrain: 1024,
            points_per_client: 1 << 20,
            pages_per_subscription: 4096,
            window: 64,
            messages_waiting: 1024,
            samples_per_answer: 4096 * 4096,
            readers: 4,
        }
    }
}
