//! Back and forth, and what was done.

use axum::Json;
use axum::body::Bytes;
use orogeny_engine::session::Travel;
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Asked, Named, author, bad_request, json};
use crate::reply::Failure;

/// The most entries of one answer.
const MAX_ENTRIES: usize = 1000;
/// The most undone or redone at once.
const MAX_COUNT: u32 = 1000;

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    #[serde(default)]
    author: Option<String>,
    #[serde(default)]
    anyone: bool,
    #[serde(default)]
    count: Option<u32>,
}

pub(super) async fn undo(named: Named, body: Bytes) -> Result<Json<Value>, Failure> {
    travel(named, &body, "undo", Travel::UndoOwn, Travel::Undo).await
}

pub(super) async fn redo(named: Named, body: Bytes) -> Result<Json<Value>, Failure> {
    travel(named, &body, "redo", Travel::RedoOwn, Travel::Redo).await
}

async fn travel(
    Named(room): Named,
    body: &[u8],
    what: &str,
    own: Travel,
    anyones: impl Fn(u32) -> Travel,
) -> Result<Json<Value>, Failure> {
    let body: Body = if body.is_empty() { Body::default() } else { json(body)? };
    let count = body.count.unwrap_or(1);
    if !(1..=MAX_COUNT).contains(&count) {
        return Err(bad_request("count", format!("`count` is {count}, it may be 1 to {MAX_COUNT}")));
    }
    let author = author(body.author)?;
    let mut entries = Vec::new();
    let mut last = None;
    // Someone else's undo is one step of the history; one's own may do others' operations again, each for itself.
    for _ in 0..if body.anyone { 1 } else { count } {
        let travel = if body.anyone { anyones(count) } else { own };
        let done = room.ask(&author, what.to_owned(), |participant| participant.travel(travel)).await?;
        entries.extend(done.entries.iter().copied());
        last = Some(done);
    }
    let (revision, rect) = last.map_or((0, None), |done| (done.revision, done.rect_m));
    Ok(Json(
        json!({ "revision": revision, "rect": if count == 1 { json!(rect) } else { Value::Null }, "entries": entries }),
    ))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Which {
    #[serde(default)]
    before: Option<u32>,
    #[serde(default)]
    limit: Option<usize>,
}

pub(super) async fn list(Named(room): Named, Asked(which): Asked<Which>) -> Result<Json<Value>, Failure> {
    let limit = which.limit.unwrap_or(100);
    if !(1..=MAX_ENTRIES).contains(&limit) {
        return Err(bad_request("limit", format!("`limit` is {limit}, it may be 1 to {MAX_ENTRIES}")));
    }
    let status = room.status().await?;
    let asked_for =
        status.history.iter().rev().filter(|item| which.before.is_none_or(|before| item.id.0 < before));
    let entries: Vec<_> = asked_for
        .take(limit)
        .map(|item| {
            json!({
                "entry": item.id,
                "parent": item.parent,
                "what": item.label,
                "author": item.author,
                "time_unix_ms": item.time_unix_ms,
                "state": item.state,
                "num_pages": item.num_pages,
            })
        })
        .collect();
    Ok(Json(json!({ "head": status.current_entry(), "entries": entries })))
}
