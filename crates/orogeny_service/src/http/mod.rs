//! The HTTP calls, one group a file.

mod about;
mod heights;
mod history;
pub(crate) mod operations;
mod terrains;

use std::sync::Arc;

use axum::Router;
use axum::extract::{DefaultBodyLimit, FromRequestParts, Path, Query, State};
use axum::http::StatusCode;
use axum::http::request::Parts;
use axum::middleware;
use axum::routing::{get, post};
use serde::de::DeserializeOwned;

use crate::guard::guard;
use crate::reply::{Failure, Refusal};
use crate::room::Room;
use crate::service::Shared;
use crate::{live, page};

/// Who is recorded where a request names no author.
const USUAL_AUTHOR: &str = "http";
/// The longest name of an author.
pub(crate) const MAX_AUTHOR_BYTES: usize = 64;

/// All calls, behind the guard.
pub(crate) fn router(shared: Arc<Shared>) -> Router {
    let terrain = Router::new()
        .route("/", get(terrains::one))
        .route("/operations", post(operations::run))
        .route("/heights", get(heights::read).put(heights::write))
        .route("/undo", post(history::undo))
        .route("/redo", post(history::redo))
        .route("/history", get(history::list))
        .route("/live", get(live::open));
    Router::new()
        .route("/", get(async || page::file("")))
        .route("/page/{file}", get(async |Path(file): Path<String>| page::file(&file)))
        .route("/openapi.json", get(about::openapi))
        .route("/healthz", get(about::health))
        .route("/metrics", get(about::metrics))
        .route("/v1/brushes", get(about::brushes))
        .route("/v1/terrains", get(terrains::list))
        .nest("/v1/terrains/{name}", terrain)
        .fallback(async || {
            Refusal::new("not_found", "there is no such call".to_owned()).with(StatusCode::NOT_FOUND)
        })
        .method_not_allowed_fallback(async || {
            let message = "this address takes other methods: /openapi.json lists them".to_owned();
            Refusal::new("method", message).with(StatusCode::METHOD_NOT_ALLOWED)
        })
        // The guard has read the body, up to a limit of its own.
        .layer(DefaultBodyLimit::disable())
        .layer(middleware::from_fn_with_state(Arc::clone(&shared), guard))
        .with_state(shared)
}

/// The terrain that an address names.
pub(crate) struct Named(pub(crate) Arc<Room>);

impl FromRequestParts<Arc<Shared>> for Named {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, shared: &Arc<Shared>) -> Result<Self, Failure> {
        let name = Path::<std::collections::HashMap<String, String>>::from_request_parts(parts, shared)
            .await
            .ok()
            .and_then(|Path(mut names)| names.remove("name"))
            .unwrap_or_default();
        match shared.rooms.get(&name) {
            Some(room) => Ok(Self(Arc::clone(room))),
            None => {
                let known: Vec<_> = shared.rooms.keys().map(|name| format!("`{name}`")).collect();
                let message = format!("there is no terrain `{name}`; there are {}", known.join(", "));
                Err(Refusal::new("unknown_terrain", message).with(StatusCode::NOT_FOUND))
            }
        }
    }
}

/// What an address says behind its question mark.
pub(crate) struct Asked<T>(pub(crate) T);

impl<T: DeserializeOwned> FromRequestParts<Arc<Shared>> for Asked<T> {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, shared: &Arc<Shared>) -> Result<Self, Failure> {
        let asked = Query::<T>::from_request_parts(parts, shared).await;
        asked.map(|Query(asked)| Self(asked)).map_err(|err| bad_request("query", err.body_text()))
    }
}

/// Reads a body of JSON, whatever type it says it is of.
fn json<T: DeserializeOwned>(body: &[u8]) -> Result<T, Failure> {
    serde_json::from_slice(body)
        .map_err(|err| bad_request("not_understood", format!("the body cannot be understood: {err}")))
}

fn bad_request(code: &'static str, message: String) -> Failure {
    Refusal::new(code, message).with(StatusCode::BAD_REQUEST)
}

/// The name that is recorded.
///
/// # Errors
/// One that is too long, or that could not be printed.
pub(crate) fn author(given: Option<String>) -> Result<String, Failure> {
    let author = given.unwrap_or_else(|| USUAL_AUTHOR.to_owned());
    if author.len() > MAX_AUTHOR_BYTES || author.chars().any(char::is_control) {
        let message =
            format!("`author` takes up to {MAX_AUTHOR_BYTES} bytes of text without control characters");
        let refusal = Refusal::new("author", message).with_limit(MAX_AUTHOR_BYTES as u64);
        return Err(refusal.with(StatusCode::BAD_REQUEST));
    }
    Ok(author)
}

/// What reads the shared state.
type Service = State<Arc<Shared>>;
