//! Who may ask, and for how much: looked at before anything of a request is read.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, CONTENT_LENGTH, HOST, ORIGIN, SEC_WEBSOCKET_PROTOCOL};
use axum::http::{HeaderMap, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};

use crate::reply::{Failure, Refusal};
use crate::service::Shared;

/// What may be had without a token: it tells nothing of any terrain.
const OPEN_PATHS: [&str; 3] = ["/", "/healthz", "/openapi.json"];
const OPEN_PREFIX: &str = "/page/";
/// The subprotocol of the live channel.
pub(crate) const PROTOCOL: &str = "orogeny.v1";
const BEARER_PROTOCOL: &str = "bearer.";

/// How long, and how much of a refused request is read.
const DRAIN: Duration = Duration::from_millis(500);
const MAX_DRAINED_BYTES: usize = 1 << 16;

/// Lets a request through, or answers it.
pub(crate) async fn guard(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    // Of an address only the path is logged: what is behind it may be a secret by mistake.
    let (method, path, start) = (request.method().clone(), request.uri().path().to_owned(), Instant::now());
    let response = match check(&shared, &request) {
        Ok(()) => match read_body(&shared, request).await {
            Ok(request) => next.run(request).await,
            Err(failure) => failure.into_response(),
        },
        Err(failure) => {
            // What has been sent already is taken and thrown away: an answer to someone who is still sending is lost with the
            // connection.
            tokio::time::timeout(DRAIN, to_bytes(request.into_body(), MAX_DRAINED_BYTES)).await.ok();
            failure.into_response()
        }
    };
    let (answer, elapsed_ms) = (response.status().as_u16(), start.elapsed().as_millis());
    tracing::debug!(%method, path, status = answer, elapsed_ms, "request");
    let status = vec![("status", answer.to_string())];
    shared.metrics.requests.get_or_create(&status).inc();
    response
}

fn check(shared: &Shared, request: &Request) -> Result<(), Failure> {
    let (headers, uri) = (request.headers(), request.uri());
    check_origin(shared, headers)?;
    let Some(token) = &shared.token else { return Ok(()) };
    let names_token =
        |query: &str| query.split('&').any(|part| part.split('=').next().is_some_and(is_token_name));
    if uri.query().is_some_and(names_token) {
        let message = "a token in an address ends up in logs: send it as `Authorization: Bearer TOKEN`";
        return Err(Refusal::new("token_in_address", message.to_owned()).with(StatusCode::BAD_REQUEST));
    }
    if is_open(uri.path()) || given_token(headers).is_some_and(|given| token.is(given)) {
        return Ok(());
    }
    let message =
        "a token is needed, as `Authorization: Bearer TOKEN`, and it was not given or is another one";
    Err(Refusal::new("token", message.to_owned()).with(StatusCode::UNAUTHORIZED))
}

fn is_open(path: &str) -> bool {
    OPEN_PATHS.contains(&path) || path.starts_with(OPEN_PREFIX)
}

fn is_token_name(name: &str) -> bool {
    ["token", "access_token", "authorization", "bearer"].iter().any(|known| name.eq_ignore_ascii_case(known))
}

fn given_token(headers: &HeaderMap) -> Option<&str> {
    let header = headers.get(AUTHORIZATION).and_then(|value| value.to_str().ok());
    if let Some(header) = header {
        let (scheme, token) = header.split_once(' ')?;
        return scheme.eq_ignore_ascii_case("bearer").then_some(token.trim());
    }
    let protocols = headers.get(SEC_WEBSOCKET_PROTOCOL)?.to_str().ok()?;
    protocols.split(',').find_map(|protocol| protocol.trim().strip_prefix(BEARER_PROTOCOL))
}

/// Refuses requests that a browser makes for another site's page: those of a page that came from elsewhere, and those that come by another
/// name than this service has, which is how a page makes its own name mean this machine.
fn check_origin(shared: &Shared, headers: &HeaderMap) -> Result<(), Failure> {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let host = text(HOST).unwrap_or_default();
    if let Some(origin) = text(ORIGIN) {
        let is_own = origin.split_once("://").is_some_and(|(_, from)| from == host);
        if !is_own {
            let message = format!("the page of {origin} may not use this service");
            return Err(Refusal::new("origin", message).with(StatusCode::FORBIDDEN));
        }
    }
    // Where a token is asked for, that is what lets in: a proxy may call the service as it likes.
    if shared.token.is_some() || is_this_machine(host) {
        return Ok(());
    }
    let message = format!("this service is called 127.0.0.1 or localhost, not `{host}`");
    Err(Refusal::new("host", message).with(StatusCode::FORBIDDEN))
}

fn is_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    ["localhost", "127.0.0.1", "[::1]"].contains(&name)
}

/// Reads the body, in a bounded time and up to a bounded length.
async fn read_body(shared: &Shared, request: Request) -> Result<Request, Failure> {
    // Whoever only reads, or gives no token, has little to say.
    let is_small = request.method() == Method::GET || is_open(request.uri().path());
    let limit = if is_small { MAX_DRAINED_BYTES } else { shared.limits.body_in_bytes };
    let too_long = || {
        let message = format!("the body is longer than {limit} bytes: send less at a time");
        Refusal::new("body_too_long", message).with_limit(limit as u64).with(StatusCode::PAYLOAD_TOO_LARGE)
    };
    let length =
        request.headers().get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|length| length > limit as u64) {
        return Err(too_long());
    }
    let (parts, body) = request.into_parts();
    let within = shared.limits.body;
    match tokio::time::timeout(within, to_bytes(body, limit)).await {
        Ok(Ok(bytes)) => Ok(Request::from_parts(parts, Body::from(bytes))),
        Ok(Err(_)) => Err(too_long()),
        Err(_) => {
            let message = format!("the body did not come within {} s", within.as_secs());
            let refusal = Refusal::new("body_too_slow", message).with_limit(within.as_secs());
            Err(refusal.with(StatusCode::REQUEST_TIMEOUT))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_has_few_names() {
        for host in ["localhost", "localhost:4750", "127.0.0.1:1", "[::1]:80", "[::1]"] {
            assert!(is_this_machine(host), "{host}");
        }
        for host in
            ["", "evil.example", "localhost.evil.example:4750", "127.0.0.1.evil.example", "localhost:x"]
        {
            assert!(!is_this_machine(host), "{host}");
        }
    }
}
