//! Starting and stopping.

use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use orogeny_engine::{Presets, Settings};
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinHandle;

use crate::limits::Limits;
use crate::metrics::Metrics;
use crate::room::Room;
use crate::token::Token;
use crate::{Error, Result, http, listen};

/// How long the last messages to clients may take.
const FAREWELL: Duration = Duration::from_millis(300);

/// What to serve, and how.
#[derive(Debug)]
pub struct ServiceOptions {
    /// The terrains' files. Clients call them by the name without the ending.
    pub terrains: Vec<PathBuf>,
    /// Where to listen; port 0 for any that is free.
    pub address: SocketAddr,
    /// The token that clients must give; none is needed where only this machine can reach the service.
    pub token: Option<Token>,
    /// The folder of files that operations may name: pictures for brushes, heights to clone. `None`: none.
    pub files: Option<PathBuf>,
    /// How much clients may ask for.
    pub limits: Limits,
    /// How the engine works; the budget for pages is each terrain's.
    pub settings: Settings,
    /// Presets that brushes may be called by.
    pub presets: Presets,
}

/// What all requests share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) rooms: BTreeMap<String, Arc<Room>>,
    pub(crate) token: Option<Token>,
    pub(crate) files: Option<PathBuf>,
    pub(crate) limits: Limits,
    pub(crate) presets: Presets,
    pub(crate) metrics: Arc<Metrics>,
    /// Room for those who read heights.
    pub(crate) readers: Arc<Semaphore>,
}

/// A service that runs, on threads of its own. Dropping it stops it.
#[derive(Debug)]
pub struct Running {
    address: SocketAddr,
    names: Vec<String>,
    /// `None` once it is stopped.
    running: Option<(Runtime, JoinHandle<()>, Arc<Shared>)>,
    stop: watch::Sender<bool>,
}

impl Running {
    /// Starts serving.
    ///
    /// # Errors
    /// Any [`Error`]; nothing is served then.
    pub fn start(options: ServiceOptions) -> Result<Self> {
        let ServiceOptions { terrains, address, token, files, limits, settings, presets } = options;
        if token.is_none() && !address.ip().is_loopback() {
            return Err(Error::NoToken { address });
        }
        let metrics = Arc::new(Metrics::new());
        let mut rooms = BTreeMap::new();
        for path in terrains {
            let room = Room::open(&path, settings.clone(), limits.tasks_per_terrain, Arc::clone(&metrics))?;
            let name = room.name.clone();
            if rooms.insert(name.clone(), Arc::new(room)).is_some() {
                return Err(Error::SameName { name });
            }
        }
        if rooms.is_empty() {
            return Err(Error::NoTerrain);
        }
        let cannot_listen = |source| Error::Listen { address, source };
        let listener = TcpListener::bind(address).map_err(cannot_listen)?;
        listener.set_nonblocking(true).map_err(cannot_listen)?;
        let address = listener.local_addr().map_err(cannot_listen)?;
        let names = rooms.keys().cloned().collect();
        let readers = Arc::new(Semaphore::new(limits.readers));
        let shared = Arc::new(Shared { rooms, token, files, limits, presets, metrics, readers });
        let runtime = Runtime::new().map_err(|source| Error::Runtime { source })?;
        let (stop, stopping) = watch::channel(false);
        let listener = {
            let _inside = runtime.enter();
            tokio::net::TcpListener::from_std(listener).map_err(cannot_listen)?
        };
        for room in shared.rooms.values() {
            let room = Arc::clone(room);
            // It goes on until the last answer has been given, when the runtime ends.
            runtime.spawn(async move { room.pump().await });
        }
        let router = http::router(Arc::clone(&shared));
        let serving = runtime.spawn(listen::listen(listener, router, Arc::clone(&shared), stopping));
        tracing::info!(%address, "listening");
        Ok(Self { address, names, running: Some((runtime, serving, shared)), stop })
    }

    /// Where it listens.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// What clients call the terrains.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Tells clients, does what they asked for, and closes the terrains.
    ///
    /// # Errors
    /// [`Error::Terrain`] for one that could not be closed well; what was acknowledged is on disk all the same.
    pub fn stop(mut self) -> Result<()> {
        self.end()
    }

    fn end(&mut self) -> Result<()> {
        let Some((runtime, serving, shared)) = self.running.take() else { return Ok(()) };
        shared.rooms.values().for_each(|room| room.say_closing());
        runtime.block_on(async {
            tokio::time::sleep(FAREWELL).await;
            self.stop.send(true).ok();
            serving.await.ok();
        });
        // Whoever is still reading ends by itself, and holds up nothing.
        runtime.shutdown_timeout(Duration::from_secs(5));
        // All of them, whether one fails or not.
        let closed: Vec<_> = shared.rooms.values().map(|room| room.close()).collect();
        closed.into_iter().collect()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Whoever wants to hear whether it ended well, stops it.
        self.end().ok();
    }
}
