//! What the service is: liveness, figures, brushes, its own description.

use axum::Json;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use orogeny_engine::{brush_descriptions, brush_schema};
use serde_json::{Value, json};

use super::Service;

const OPENAPI: &str = include_str!("../../openapi.json");

pub(super) async fn openapi() -> impl IntoResponse {
    ([(CONTENT_TYPE, "application/json")], OPENAPI)
}

pub(super) async fn health() -> Json<Value> {
    Json(json!({ "status": "ok", "version": env!("CARGO_PKG_VERSION") }))
}

pub(super) async fn metrics(State(shared): Service) -> impl IntoResponse {
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    ([(CONTENT_TYPE, kind)], shared.metrics.to_text())
}

pub(super) async fn brushes() -> Json<Value> {
    let brushes: Vec<_> = brush_descriptions()
        .into_iter()
        .map(|brush| json!({ "type": brush.brush_type.name(), "schema": brush_schema(brush.brush_type) }))
        .collect();
    Json(json!({ "brushes": brushes }))
}
