//! The live channel: a WebSocket whose messages go to the room, and to which the room's answers come.

use std::sync::Arc;
use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::extract::ws::{CloseFrame, Message as Socket, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse as _, Response};
use futures_util::{SinkExt as _, StreamExt as _};
use serde::Deserialize;

use crate::connection::Connection;
use crate::guard::PROTOCOL;
use crate::http::{Asked, Named, author};
use crate::listen::Place;
use crate::outbox::{Outbox, Outgoing};
use crate::reply::{Failure, Refusal};
use crate::service::Shared;

/// How long the last words may take.
const FAREWELL: Duration = Duration::from_secs(1);

/// Bytes that may lie between a message and the system, beyond one message.
const MAX_WRITE_BUFFER_BYTES: usize = 4 << 20;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Who {
    #[serde(default)]
    author: Option<String>,
}

/// Opens a live channel.
pub(crate) async fn open(
    State(shared): State<Arc<Shared>>,
    Named(room): Named,
    Asked(who): Asked<Who>,
    place: Option<Extension<Place>>,
    upgrade: Result<WebSocketUpgrade, axum::extract::ws::rejection::WebSocketUpgradeRejection>,
) -> Result<Response, Failure> {
    let author = match who.author {
        Some(given) => author(Some(given))?,
        None => "someone".to_owned(),
    };
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(err) => {
            let message = format!("this address takes WebSocket connections: {}", err.body_text());
            return Err(Refusal::new("not_a_websocket", message).with(StatusCode::UPGRADE_REQUIRED));
        }
    };
    let (limit, status) = (shared.limits.message_in_bytes, room.status().await?);
    let upgrade = upgrade
        .protocols([PROTOCOL])
        .max_message_size(limit)
        .max_frame_size(limit)
        .write_buffer_size(0)
        .max_write_buffer_size(MAX_WRITE_BUFFER_BYTES)
        .on_failed_upgrade(|err| tracing::debug!("a live channel was not opened: {err}"));
    Ok(upgrade
        .on_upgrade(async move |socket| {
            let outbox = Outbox::new(shared.limits.messages_waiting);
            let participant = room.participant(&author);
            let id = room.hub().enter(&room.name, &author, participant, outbox.clone(), &status);
            tracing::info!(terrain = room.name, client = id, author, "came");
            // Leaves also when the task is dropped.
            let connection = Connection { shared: Arc::clone(&shared), room: Arc::clone(&room), id };
            converse(socket, &connection, &outbox, &shared).await;
            drop((connection, place));
            tracing::info!(terrain = room.name, client = id, "left");
        })
        .into_response())
}

/// Hears and speaks, until one of both ends it.
async fn converse(socket: WebSocket, connection: &Connection, outbox: &Outbox, shared: &Shared) {
    let (mut to, mut from) = socket.split();
    let hear = async {
        loop {
            let message = match from.next().await {
                Some(Ok(message)) => message,
                Some(Err(err)) => {
                    tracing::debug!("a message could not be read: {err}");
                    return Some((1002, "a message could not be read, or is too long"));
                }
                None => return None,
            };
            match message {
                Socket::Text(text) => connection.hear(&text),
                Socket::Binary(_) => {
                    let message = "a client sends text, with JSON".to_owned();
                    connection.refuse(None, &Refusal::new("not_understood", message));
                }
                Socket::Close(_) => return None,
                // Answered by the library.
                Socket::Ping(_) | Socket::Pong(_) => {}
            }
        }
    };
    let speak = async {
        loop {
            let (message, is_last) = match outbox.next().await {
                Outgoing::Text(text) => (Socket::Text(text.into()), false),
                Outgoing::Frame(bytes) => (Socket::Binary(bytes), false),
                Outgoing::Close(code, reason) => {
                    (Socket::Close(Some(CloseFrame { code, reason: reason.into() })), true)
                }
            };
            // Whoever takes nothing for so long is gone, or as good as.
            let sent = tokio::time::timeout(shared.limits.send, to.send(message)).await;
            if is_last || !matches!(sent, Ok(Ok(()))) {
                break;
            }
        }
    };
    let reason = tokio::select! {
        reason = hear => reason,
        () = speak => None,
    };
    let farewell = async {
        if let Some((code, reason)) = reason {
            to.send(Socket::Close(Some(CloseFrame { code, reason: reason.into() }))).await?;
        }
        // The answer to a farewell is on its way.
        to.flush().await
    };
    tokio::time::timeout(FAREWELL, farewell).await.ok();
}
