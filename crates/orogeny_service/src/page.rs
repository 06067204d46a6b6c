//! The page at `/`: files that come with the program.

use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, X_CONTENT_TYPE_OPTIONS};
use axum::http::{HeaderName, StatusCode};
use axum::response::{IntoResponse, Response};

use crate::reply::Refusal;

/// Nothing comes from anywhere else, and no other page holds this one.
const POLICY: &str = "default-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self' ws: wss:; frame-ancestors \
                      'none'; base-uri 'none'; form-action 'none'";

include!(concat!(env!("OUT_DIR"), "/page_files.rs"));

/// A file of the page, by its name; the page itself for none.
pub(crate) fn file(name: &str) -> Response {
    let name = if name.is_empty() { "index.html" } else { name };
    let Some((_, content)) = FILES.iter().find(|(known, _)| *known == name) else {
        let refusal = Refusal::new("not_found", format!("the page has no file `{name}`"));
        return refusal.with(StatusCode::NOT_FOUND).into_response();
    };
    let kind = match name.rsplit_once('.') {
        Some((_, "html")) => "text/html; charset=utf-8",
        Some((_, "css")) => "text/css; charset=utf-8",
        Some((_, "js")) => "text/javascript; charset=utf-8",
        Some((_, "svg")) => "image/svg+xml",
        _ => "text/plain; charset=utf-8",
    };
    let headers: [(HeaderName, &str); 4] = [
        (CONTENT_TYPE, kind),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (CACHE_CONTROL, "no-cache"),
    ];
    (headers, *content).into_response()
}
