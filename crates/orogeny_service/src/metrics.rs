//! Figures for Prometheus.

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Registry, Unit};

/// What is counted.
#[derive(Debug)]
pub(crate) struct Metrics {
    registry: Registry,
    /// Requests by the status of their answer.
    pub(crate) requests: Family<Vec<(&'static str, String)>, Counter>,
    /// Connections that are open.
    pub(crate) connections: Gauge,
    /// Clients on live channels.
    pub(crate) clients: Gauge,
    /// What was refused, by its code.
    pub(crate) refusals: Family<Vec<(&'static str, &'static str)>, Counter>,
    /// Operations, strokes, undos and the like that were done.
    pub(crate) tasks: Counter,
    pub(crate) frames: Counter,
    pub(crate) frame_bytes: Counter,
}

impl Metrics {
    pub(crate) fn new() -> Self {
        let mut registry = Registry::with_prefix("orogeny");
        let metrics = Self {
            requests: Family::default(),
            connections: Gauge::default(),
            clients: Gauge::default(),
            refusals: Family::default(),
            tasks: Counter::default(),
            frames: Counter::default(),
            frame_bytes: Counter::default(),
            registry: Registry::default(),
        };
        registry.register("http_requests", "HTTP requests by status", metrics.requests.clone());
        registry.register("connections", "Open connections", metrics.connections.clone());
        registry.register("live_clients", "Clients on live channels", metrics.clients.clone());
        registry.register("refusals", "What live channels refused, by code", metrics.refusals.clone());
        registry.register("tasks", "Strokes, operations, undos and redos done", metrics.tasks.clone());
        registry.register("page_frames", "Page frames made for clients", metrics.frames.clone());
        registry.register_with_unit(
            "page_frames",
            "Page frames made for clients",
            Unit::Bytes,
            metrics.frame_bytes.clone(),
        );
        Self { registry, ..metrics }
    }

    /// In the text format.
    pub(crate) fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a string does not fail.
        encode(&mut text, &self.registry).ok();
        text
    }
}
