//! Answers to requests, and what is refused.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

/// The longest text of a refusal.
const MAX_MESSAGE_BYTES: usize = 1000;

/// Why something is not done: what it is called, what it means and, where there is one, the limit. Nothing was changed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refusal {
    pub(crate) code: &'static str,
    pub(crate) message: String,
    limit: Option<u64>,
}

impl Refusal {
    pub(crate) fn new(code: &'static str, mut message: String) -> Self {
        // What was sent may stand in it.
        if message.len() > MAX_MESSAGE_BYTES {
            message.truncate(message.floor_char_boundary(MAX_MESSAGE_BYTES));
            message.push('…');
        }
        Self { code, message, limit: None }
    }

    pub(crate) const fn with_limit(mut self, limit: u64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// As an object.
    pub(crate) fn to_json(&self) -> Value {
        let mut object = json!({ "code": self.code, "message": self.message });
        if let (Some(limit), Some(fields)) = (self.limit, object.as_object_mut()) {
            fields.insert("limit".to_owned(), limit.into());
        }
        object
    }

    /// As an answer of a status.
    pub(crate) fn with(self, status: StatusCode) -> Failure {
        Failure(status, self)
    }
}

/// A refusal as an answer.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) StatusCode, pub(crate) Refusal);

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        let Self(status, refusal) = self;
        (status, Json(json!({ "error": refusal.to_json() }))).into_response()
    }
}

impl From<orogeny_engine::Error> for Failure {
    fn from(err: orogeny_engine::Error) -> Self {
        failure(err.to_string(), matches!(err, orogeny_engine::Error::Cancelled), err.is_fault())
    }
}

/// What the engine said of something that was not done.
pub(crate) fn failure(message: String, is_cancelled: bool, is_fault: bool) -> Failure {
    let (status, code) = match (is_cancelled, is_fault) {
        (true, _) => (StatusCode::CONFLICT, "cancelled"),
        (_, true) => (StatusCode::INTERNAL_SERVER_ERROR, "fault"),
        _ => (StatusCode::UNPROCESSABLE_ENTITY, "refused"),
    };
    Refusal::new(code, message).with(status)
}

/// The machine failed.
pub(crate) fn fault(err: impl std::fmt::Display) -> Failure {
    failure(err.to_string(), false, true)
}
