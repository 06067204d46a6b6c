//! Connections: how many, and how long one may take to say what it wants.

use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::body::Incoming;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::AsyncWriteExt as _;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tower::ServiceExt as _;

use crate::service::Shared;

/// A connection's place among those that may be open.
#[derive(Debug, Clone)]
pub(crate) struct Place(#[expect(dead_code, reason = "it is there to be dropped")] Arc<OwnedSemaphorePermit>);

/// After how long in silence it is looked whether the other side is still there.
const KEEPALIVE: Duration = Duration::from_secs(30);

/// How long requests that are being answered may take once the service stops.
const GRACE: Duration = Duration::from_secs(10);

/// Takes connections until told to stop, and then waits for those that are being answered.
pub(crate) async fn listen(
    listener: TcpListener,
    router: Router,
    shared: Arc<Shared>,
    mut stop: watch::Receiver<bool>,
) {
    let room = Arc::new(Semaphore::new(shared.limits.connections));
    loop {
        let stream = tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => stream,
                Err(err) => {
                    // Mostly too many open files: those that are there go on, and some will end.
                    tracing::warn!("a connection could not be taken: {err}");
                    tokio::time::sleep(Duration::from_millis(100)).await;
                    continue;
                }
            },
            () = async { drop(stop.wait_for(|is_stopping| *is_stopping).await) } => break,
        };
        let Ok(place) = Arc::clone(&room).try_acquire_owned() else {
            tokio::spawn(refuse(stream, shared.limits.connections));
            continue;
        };
        // A live channel outlives its request, and takes the place with it.
        let place = Place(Arc::new(place));
        let taken = place.clone();
        let service = router.clone().map_request(move |mut request: hyper::Request<Incoming>| {
            request.extensions_mut().insert(taken.clone());
            request
        });
        // Small messages are not to wait for more.
        stream.set_nodelay(true).ok();
        bound_silence(&stream, shared.limits.send);
        let connection = hyper::server::conn::http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(shared.limits.head)
            .serve_connection(TokioIo::new(stream), TowerToHyperService::new(service))
            .with_upgrades();
        let (shared, mut stop) = (Arc::clone(&shared), stop.clone());
        tokio::spawn(async move {
            shared.metrics.connections.inc();
            let mut connection = pin!(connection);
            let ended = tokio::select! {
                ended = connection.as_mut() => ended,
                () = async { drop(stop.wait_for(|is_stopping| *is_stopping).await) } => {
                    // What is being answered is answered.
                    connection.as_mut().graceful_shutdown();
                    connection.await
                }
            };
            if let Err(err) = ended {
                tracing::debug!("a connection ended: {err}");
            }
            shared.metrics.connections.dec();
            drop(place);
        });
    }
    drop(listener);
    // All places are free once all have been answered.
    let all = u32::try_from(shared.limits.connections).unwrap_or(u32::MAX);
    tokio::time::timeout(GRACE, room.acquire_many(all)).await.ok();
}

/// Ends connections whose other side takes nothing for so long, or is gone without having said so.
fn bound_silence(stream: &TcpStream, send: Duration) {
    let socket = socket2::SockRef::from(stream);
    let keepalive = socket2::TcpKeepalive::new().with_time(KEEPALIVE).with_interval(KEEPALIVE / 4);
    if let Err(err) = socket.set_tcp_keepalive(&keepalive) {
        tracing::debug!("no keepalive: {err}");
    }
    #[cfg(target_os = "linux")]
    if let Err(err) = socket.set_tcp_user_timeout(Some(send)) {
        tracing::debug!("no limit for sending: {err}");
    }
    #[cfg(not(target_os = "linux"))]
    let _ = send;
}

/// Answers whoever there is no room for, without reading what they want.
async fn refuse(mut stream: TcpStream, limit: usize) {
    let body = format!(
        "{{\"error\":{{\"code\":\"too_many_connections\",\"message\":\"there are {limit} connections already: close some, or try again \
         later\",\"limit\":{limit}}}}}"
    );
    let answer = format!(
        "HTTP/1.1 429 Too Many Requests\r\ncontent-type: application/json\r\ncontent-length: {}\r\nretry-after: 5\r\nconnection: \
         close\r\n\r\n{body}",
        body.len()
    );
    tokio::time::timeout(Duration::from_secs(1), stream.write_all(answer.as_bytes())).await.ok();
}
