//! A terrain that is served, and those who are there.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::http::StatusCode;
use orogeny_engine::session::{Participant, Session, Status, Ticket};
use orogeny_engine::{Settings, Terrain};
use tokio::sync::{Notify, oneshot};

use crate::hub::{Asker, Hub, Outcome};
use crate::metrics::Metrics;
use crate::reply::{self, Failure, Refusal};
use crate::{Error, Result};

/// How long a terrain may take to tell what it is.
const MAX_START: Duration = Duration::from_secs(10);

/// A terrain that is served.
#[derive(Debug)]
pub(crate) struct Room {
    pub(crate) name: String,
    path: PathBuf,
    settings: Settings,
    session: Session,
    /// How many things may be asked for and not be done.
    max_tasks: usize,
    hub: Mutex<Hub>,
    has_events: Arc<Notify>,
}

impl Room {
    /// Opens a terrain.
    ///
    /// # Errors
    /// [`Error::Name`], [`Error::Terrain`].
    pub(crate) fn open(
        path: &Path,
        settings: Settings,
        max_tasks: usize,
        metrics: Arc<Metrics>,
    ) -> Result<Self> {
        let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        let is_usable = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ');
        if name.is_empty() || !name.chars().all(is_usable) {
            return Err(Error::Name { path: path.to_owned() });
        }
        let has_events = Arc::<Notify>::default();
        let wake = Arc::clone(&has_events);
        let session = Session::open(path, settings.clone(), move || wake.notify_one())
            .map_err(|source| Error::Terrain { path: path.to_owned(), source: Box::new(source) })?;
        let hub = Mutex::new(Hub::new(metrics));
        Ok(Self { name, path: path.to_owned(), settings, session, max_tasks, hub, has_events })
    }

    pub(crate) fn hub(&self) -> MutexGuard<'_, Hub> {
        // A panic in one of its functions may leave a client behind that hears nothing more; the terrain is not in it.
        self.hub.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Someone who works on the terrain under this name.
    pub(crate) fn participant(&self, author: &str) -> Participant {
        self.session.participant(author)
    }

    /// Hands on what the session tells, for as long as this is polled.
    pub(crate) async fn pump(&self) {
        loop {
            self.has_events.notified().await;
            self.hand_on();
        }
    }

    fn hand_on(&self) {
        let mut hub = self.hub();
        self.session.events().into_iter().for_each(|event| hub.handle(event));
        hub.look(&self.session);
    }

    /// Asks for pages that clients can take now.
    pub(crate) fn look(&self) {
        self.hub().look(&self.session);
    }

    /// Layers and more. The session tells them first of all, so they are waited for only by those who come with the start.
    ///
    /// # Errors
    /// When the terrain cannot tell what it is.
    pub(crate) async fn status(&self) -> Result<Arc<Status>, Failure> {
        let start = Instant::now();
        while start.elapsed() < MAX_START {
            if let Some(status) = &self.hub().status {
                return Ok(Arc::clone(status));
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let message = format!("`{}` cannot be read: `orogeny check` tells what is wrong with it", self.name);
        Err(reply::fault(message))
    }

    /// Refuses more than may wait.
    ///
    /// # Errors
    /// `too_many_tasks`.
    pub(crate) fn check_room(&self, hub: &Hub) -> Result<(), Refusal> {
        let limit = self.max_tasks;
        if hub.num_asked() < limit {
            return Ok(());
        }
        let message = format!("{limit} things that clients asked for are not done yet: try again later");
        Err(Refusal::new("too_many_tasks", message).with_limit(limit as u64))
    }

    /// Asks for something and waits until it is done.
    ///
    /// # Errors
    /// What the engine says.
    pub(crate) async fn ask(
        &self,
        author: &str,
        what: String,
        ask: impl FnOnce(&Participant) -> Ticket,
    ) -> Result<Outcome, Failure> {
        let (reply, replied) = oneshot::channel();
        {
            // Together, so that the end does not come before it is known who waits for it.
            let mut hub = self.hub();
            self.check_room(&hub).map_err(|refusal| refusal.with(StatusCode::TOO_MANY_REQUESTS))?;
            let ticket = ask(&self.participant(author));
            hub.note(ticket, Asker::Request(reply), author.into(), what);
        }
        replied.await.unwrap_or_else(|_| Err(reply::fault("the service is closing")))
    }

    /// Opens the terrain for reading, as it was last committed.
    ///
    /// # Errors
    /// As [`Terrain::open_to_read`].
    pub(crate) fn open_to_read(&self) -> orogeny_engine::Result<Terrain> {
        Terrain::open_to_read(&self.path, self.settings.clone())
    }

    /// Tells everyone that it ends.
    pub(crate) fn say_closing(&self) {
        self.hub().close();
    }

    /// Does what was asked for, and closes the terrain.
    ///
    /// # Errors
    /// [`Error::Terrain`].
    pub(crate) fn close(&self) -> Result<()> {
        let closed = self.session.close();
        closed.map_err(|source| Error::Terrain { path: self.path.clone(), source: Box::new(source) })
    }
}
