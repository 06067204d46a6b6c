//! Running operations.

use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use orogeny_engine::Operation;
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Named, Service, author, json};
use crate::reply::{Failure, Refusal};
use crate::service::Shared;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    operations: Vec<Value>,
    #[serde(default)]
    author: Option<String>,
}

pub(super) async fn run(
    State(shared): Service,
    Named(room): Named,
    body: Bytes,
) -> Result<Json<Value>, Failure> {
    let body: Body = json(&body)?;
    let author = author(body.author)?;
    let operations = read_operations(&shared, body.operations);
    let operations = operations.map_err(|refusal| refusal.with(StatusCode::BAD_REQUEST))?;
    let what = label(&operations);
    let done = room.ask(&author, what, |participant| participant.apply(operations)).await?;
    Ok(Json(json!({
        "revision": done.revision,
        "rect": done.rect_m,
        "entries": done.entries,
        "applied": done.applied,
    })))
}

/// Reads operations that a client gave.
///
/// # Errors
/// What cannot be understood, or not be allowed.
pub(crate) fn read_operations(shared: &Shared, values: Vec<Value>) -> Result<Vec<Operation>, Refusal> {
    let read = |value| {
        let mut operation = Operation::from_json_with(value, &shared.presets)?;
        operation.keep_files_below(shared.files.as_deref())?;
        Ok(operation)
    };
    let refused = |err: orogeny_engine::Error| Refusal::new("operation", err.to_string());
    values.into_iter().map(read).collect::<orogeny_engine::Result<_>>().map_err(refused)
}

/// What operations do, as short as can be.
pub(crate) fn label(operations: &[Operation]) -> String {
    match operations {
        [] => "nothing".to_owned(),
        [one] => one.label(),
        several => format!("{} operations", several.len()),
    }
}
