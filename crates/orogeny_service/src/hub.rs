//! All that a room knows of its clients, and what it does when the session tells something or a client says something. No I/O: what goes
//! out is put into outboxes.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Arc;

use axum::body::Bytes;
use orogeny_engine::session::{Event, PageData, PageRequest, Participant, Session, Status, Ticket};
use orogeny_engine::{PagePlace, SampleRect};
use tokio::sync::oneshot;

use crate::frame::{self, FrameFormat, FrameHeader};
use crate::message::{self, RectM};
use crate::metrics::Metrics;
use crate::outbox::{Latest, Outbox};
use crate::reply::{self, Failure, Refusal};
use crate::subscription::Subscription;

/// The most pages that are asked for at once, so that what changes meanwhile comes soon after.
const PAGES_AT_ONCE: usize = 16;

/// The number of a client on the live channel.
pub(crate) type ClientId = u64;

/// A client on the live channel.
#[derive(Debug)]
pub(crate) struct Client {
    pub(crate) author: Arc<str>,
    pub(crate) participant: Participant,
    pub(crate) outbox: Outbox,
    pub(crate) subscription: Option<Subscription>,
    /// What it asked for and is not done, by its own numbers.
    pub(crate) tasks: HashMap<u64, Task>,
    pub(crate) num_frames: u64,
    pub(crate) num_acknowledged: u64,
}

/// Something that a client asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task {
    pub(crate) ticket: Ticket,
    /// Points so far, of a stroke.
    pub(crate) num_points: usize,
    /// Whether it is a stroke whose hand is not lifted.
    pub(crate) is_open: bool,
}

/// What was done, for a request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) revision: u64,
    pub(crate) entries: Vec<u32>,
    pub(crate) rect_m: RectM,
    /// As the engine reports it.
    pub(crate) applied: serde_json::Value,
}

/// Who hears how something ended.
#[derive(Debug)]
pub(crate) enum Asker {
    Client { client: ClientId, id: u64 },
    Request(oneshot::Sender<Result<Outcome, Failure>>),
}

/// Something that was asked for.
#[derive(Debug)]
struct Asked {
    asker: Asker,
    author: Arc<str>,
    what: String,
}

#[derive(Debug)]
pub(crate) struct Hub {
    pub(crate) clients: BTreeMap<ClientId, Client>,
    last_client: ClientId,
    asked: HashMap<Ticket, Asked>,
    /// Grows with every change of what is seen.
    pub(crate) revision: u64,
    pub(crate) status: Option<Arc<Status>>,
    status_text: String,
    /// What changed since something ended; `None`: perhaps everything.
    changed: Option<SampleRect>,
    /// Pages that were asked for together, the longest ago first.
    looks: VecDeque<Vec<PagePlace>>,
    is_closing: bool,
    metrics: Arc<Metrics>,
}

impl Hub {
    pub(crate) fn new(metrics: Arc<Metrics>) -> Self {
        Self {
            clients: BTreeMap::new(),
            last_client: 0,
            asked: HashMap::new(),
            revision: 0,
            status: None,
            status_text: String::new(),
            changed: Some(SampleRect::EMPTY),
            looks: VecDeque::new(),
            is_closing: false,
            metrics,
        }
    }

    /// Lets a client in, and tells it and all others.
    pub(crate) fn enter(
        &mut self,
        terrain: &str,
        author: &str,
        participant: Participant,
        outbox: Outbox,
        status: &Status,
    ) -> ClientId {
        self.last_client += 1;
        let id = self.last_client;
        outbox.text(message::hello(id, author, terrain, self.revision, status));
        outbox.latest(Latest::Status, self.status_text.clone());
        let client = Client {
            author: author.into(),
            participant,
            outbox,
            subscription: None,
            tasks: HashMap::new(),
            num_frames: 0,
            num_acknowledged: 0,
        };
        if self.is_closing {
            say_closing(&client);
        }
        self.clients.insert(id, client);
        self.metrics.clients.inc();
        self.tell_clients();
        id
    }

    /// Tells everyone that it ends.
    pub(crate) fn close(&mut self) {
        self.is_closing = true;
        self.clients.values().for_each(say_closing);
    }

    /// How much was asked for and is not done.
    pub(crate) fn num_asked(&self) -> usize {
        self.asked.len()
    }

    /// Lets a client go. Strokes that it did not end are taken back; what else it asked for is done.
    pub(crate) fn leave(&mut self, id: ClientId) {
        let Some(client) = self.clients.remove(&id) else { return };
        for task in client.tasks.values().filter(|task| task.is_open) {
            client.participant.cancel(task.ticket);
        }
        self.metrics.clients.dec();
        for other in self.clients.values() {
            other.outbox.forget(Latest::Cursor(id));
        }
        self.tell_clients();
    }

    fn tell_clients(&self) {
        let text = message::clients(self.clients.iter().map(|(id, client)| (*id, &*client.author)));
        self.tell_latest(Latest::Clients, &text);
    }

    fn tell_latest(&self, of: Latest, text: &str) {
        self.clients.values().for_each(|client| client.outbox.latest(of, text.to_owned()));
    }

    /// Tells something that has to come.
    pub(crate) fn tell(&self, text: &str) {
        self.clients.values().for_each(|client| client.outbox.text(text.to_owned()));
    }

    /// Remembers who asked for something.
    pub(crate) fn note(&mut self, ticket: Ticket, asker: Asker, author: Arc<str>, what: String) {
        self.asked.insert(ticket, Asked { asker, author, what });
    }

    /// What the session tells.
    pub(crate) fn handle(&mut self, event: Event) {
        match event {
            Event::Progress { ticket, progress } => {
                if let Some(Asked { asker: Asker::Client { client, id }, .. }) = self.asked.get(&ticket)
                    && let Some(client) = self.clients.get(client)
                {
                    client.outbox.latest(Latest::Progress(*id), message::progress(*id, progress));
                }
            }
            Event::Done { ticket, applied, entries, cut_after } => {
                let entries = entries.into_iter().map(|entry| entry.0).collect();
                // What it did to the terrain is always plain JSON.
                let applied = serde_json::to_value(applied).unwrap_or_default();
                self.end(ticket, Ok((entries, applied, cut_after)));
            }
            Event::Failed { ticket, message, is_cancelled, is_fault } => {
                if is_fault {
                    tracing::error!(message, "a task failed");
                }
                self.end(ticket, Err(reply::failure(message, is_cancelled, is_fault)));
            }
            Event::Changed { rects, .. } => self.change(rects),
            Event::Status(status) => {
                let text = message::status(&status);
                self.status = Some(Arc::new(*status));
                if text != self.status_text {
                    self.tell_latest(Latest::Status, &text);
                    self.status_text = text;
                }
            }
            Event::Pages(pages) => self.send(&pages),
            // No one here asks for any.
            Event::Surveyed { .. } => {}
        }
    }

    fn end(&mut self, ticket: Ticket, result: Result<(Vec<u32>, serde_json::Value, Option<usize>), Failure>) {
        let Some(Asked { asker, author, what }) = self.asked.remove(&ticket) else { return };
        let changed = self.changed.replace(SampleRect::EMPTY);
        let rect_m = changed.map(|rect| self.rect_m(rect));
        let is_change = changed.is_none_or(|rect| !rect.is_empty());
        if let Ok((entries, ..)) = &result {
            self.metrics.tasks.inc();
            // An undo of nothing is nothing to tell.
            if is_change || !entries.is_empty() {
                let client = match asker {
                    Asker::Client { client, .. } => Some(client),
                    Asker::Request(_) => None,
                };
                let revision = self.revision;
                let operation =
                    message::Operation { revision, author: &author, client, what: &what, entries, rect_m };
                self.tell(&operation.to_text());
            }
        }
        match asker {
            Asker::Client { client, id } => {
                let Some(client) = self.clients.get_mut(&client) else { return };
                client.tasks.remove(&id);
                client.outbox.forget(Latest::Progress(id));
                match result {
                    Ok((entries, _, cut_after)) => {
                        if let Some(num_points) = cut_after {
                            client.outbox.text(message::cut(id, num_points));
                        }
                        client.outbox.text(message::done(id, self.revision, &entries, rect_m));
                    }
                    Err(Failure(_, refusal)) => client.outbox.text(message::error(Some(id), &refusal)),
                }
            }
            Asker::Request(reply) => {
                let revision = self.revision;
                let outcome =
                    result.map(|(entries, applied, _)| Outcome { revision, entries, rect_m, applied });
                // Whoever asked may have gone.
                reply.send(outcome).ok();
            }
        }
    }

    fn rect_m(&self, rect: SampleRect) -> [f64; 4] {
        let Some(status) = &self.status else { return [0.0; 4] };
        let (spacing_m, rect) = (status.grid.spacing_m(), rect.intersection(&status.grid.bounds()));
        if rect.is_empty() {
            return [0.0; 4];
        }
        let [x, z] = [rect.x0, rect.z0].map(|sample| f64::from(sample) * spacing_m);
        [x, z, f64::from(rect.width()) * spacing_m, f64::from(rect.depth()) * spacing_m]
    }

    fn change(&mut self, rects: Option<Vec<SampleRect>>) {
        let page_size = self.status.as_ref().map(|status| status.layout.size());
        let (Some(rects), Some(page_size)) = (rects, page_size) else {
            self.revision += 1;
            self.changed = None;
            let subscriptions = self.clients.values_mut().filter_map(|client| client.subscription.as_mut());
            return subscriptions.for_each(Subscription::change_all);
        };
        if rects.iter().all(SampleRect::is_empty) {
            return;
        }
        self.revision += 1;
        if let (Some(changed), Some(rect)) = (&mut self.changed, rects.first()) {
            *changed = changed.bounds_with(rect);
        }
        for client in self.clients.values_mut() {
            if let Some(subscription) = &mut client.subscription {
                subscription.change(&rects, page_size);
            }
        }
    }

    /// Sends pages that have come to those who asked for them.
    fn send(&mut self, pages: &[PageData]) {
        let asked_for = self.looks.pop_front().unwrap_or_default();
        let revision = self.revision;
        let mut made: HashMap<(PagePlace, FrameFormat), Bytes> = HashMap::new();
        for place in asked_for {
            let page = pages.iter().find(|page| page.place == place);
            for client in self.clients.values_mut() {
                let Some(subscription) = &mut client.subscription else { continue };
                if !subscription.arrive(place) {
                    continue;
                }
                let Some(page) = page else {
                    client.outbox.text(message::error(None, &unreadable(place)));
                    continue;
                };
                let frame = made.entry((place, subscription.format)).or_insert_with(|| {
                    let header = FrameHeader {
                        level: place.level,
                        format: subscription.format,
                        // A page has 256 samples a side.
                        width: page.rect.width() as u16,
                        depth: page.rect.depth() as u16,
                        x: place.x,
                        z: place.z,
                        revision,
                        payload_in_bytes: 0,
                    };
                    frame::encode(header, &page.heights).into()
                });
                client.num_frames += 1;
                self.metrics.frames.inc();
                self.metrics.frame_bytes.inc_by(frame.len() as u64);
                client.outbox.frame(frame.clone());
            }
        }
    }

    /// Asks for the pages that clients can take.
    pub(crate) fn look(&mut self, session: &Session) {
        let mut places = Vec::new();
        for client in self.clients.values_mut() {
            let num_under_way = client.num_frames.saturating_sub(client.num_acknowledged);
            if let Some(subscription) = &mut client.subscription {
                places.extend(subscription.ask(num_under_way, PAGES_AT_ONCE));
            }
        }
        places.sort_unstable();
        places.dedup();
        for places in places.chunks(PAGES_AT_ONCE) {
            session.look(places.iter().map(|place| PageRequest { place: *place, rect: None }).collect());
            self.looks.push_back(places.to_vec());
        }
    }
}

fn say_closing(client: &Client) {
    client.outbox.text(message::closing());
    client.outbox.close(1001, "the service stops");
}

/// The page cannot be read, which its file's damage or a machine's fault may be the reason for.
fn unreadable(place: PagePlace) -> Refusal {
    let PagePlace { level, z, x } = place;
    let message = format!(
        "page ({x}, {z}) of level {level} could not be read: the service's log tells why; it comes when it changes"
    );
    Refusal::new("page", message)
}
