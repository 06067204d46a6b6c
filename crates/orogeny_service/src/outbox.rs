//! What is to go out to a client, within bounds.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use axum::body::Bytes;
use tokio::sync::Notify;

/// What goes out next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Outgoing {
    Text(String),
    Frame(Bytes),
    /// The end, with a WebSocket's code and the reason.
    Close(u16, &'static str),
}

/// Things of which only the latest counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Latest {
    Clients,
    Status,
    /// How far a task of the client has come, by its id.
    Progress(u64),
    /// Where another client's pointer is.
    Cursor(u64),
}

/// Messages for a client, that its connection takes when it can send.
#[derive(Debug, Clone)]
pub(crate) struct Outbox {
    content: Arc<Mutex<Content>>,
    has_more: Arc<Notify>,
    max_texts: usize,
}

#[derive(Debug, Default)]
struct Content {
    texts: VecDeque<String>,
    latest: BTreeMap<Latest, String>,
    frames: VecDeque<Bytes>,
    close: Option<(u16, &'static str)>,
}

impl Outbox {
    pub(crate) fn new(max_texts: usize) -> Self {
        Self { content: Arc::default(), has_more: Arc::default(), max_texts }
    }

    /// A message that has to come; a client for which too many wait is let go.
    pub(crate) fn text(&self, text: String) {
        let max_texts = self.max_texts;
        self.change(|content| {
            if content.close.is_some() {
                // Nothing comes after the end.
            } else if content.texts.len() < max_texts {
                content.texts.push_back(text);
            } else {
                content.close.get_or_insert((1013, "too many messages wait: read them faster"));
            }
        });
    }

    /// A message that takes the place of the one before it.
    pub(crate) fn latest(&self, of: Latest, text: String) {
        self.change(|content| {
            if content.close.is_none() {
                content.latest.insert(of, text);
            }
        });
    }

    /// No more is told of that.
    pub(crate) fn forget(&self, of: Latest) {
        self.change(|content| _ = content.latest.remove(&of));
    }

    pub(crate) fn frame(&self, frame: Bytes) {
        self.change(|content| content.frames.push_back(frame));
    }

    pub(crate) fn close(&self, code: u16, reason: &'static str) {
        self.change(|content| _ = content.close.get_or_insert((code, reason)));
    }

    /// The next thing to send, when there is one.
    pub(crate) async fn next(&self) -> Outgoing {
        loop {
            let has_more = self.has_more.notified();
            if let Some(next) = self.take() {
                return next;
            }
            has_more.await;
        }
    }

    fn take(&self) -> Option<Outgoing> {
        let mut content = self.content.lock().unwrap_or_else(PoisonError::into_inner);
        let text = content.texts.pop_front().or_else(|| content.latest.pop_first().map(|(_, text)| text));
        if let Some(text) = text {
            return Some(Outgoing::Text(text));
        }
        if let Some((code, reason)) = content.close {
            return Some(Outgoing::Close(code, reason));
        }
        content.frames.pop_front().map(Outgoing::Frame)
    }

    fn change(&self, change: impl FnOnce(&mut Content)) {
        // Whoever panicked left whole messages behind.
        change(&mut self.content.lock().unwrap_or_else(PoisonError::into_inner));
        self.has_more.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(outbox: &Outbox) -> Vec<Outgoing> {
        std::iter::from_fn(|| outbox.take()).take(20).collect()
    }

    #[test]
    fn what_must_come_comes_in_order_and_of_the_rest_the_latest() {
        let outbox = Outbox::new(10);
        outbox.latest(Latest::Status, "old".to_owned());
        outbox.frame(Bytes::from_static(b"page"));
        outbox.latest(Latest::Progress(3), "10 %".to_owned());
        outbox.text("first".to_owned());
        outbox.latest(Latest::Status, "new".to_owned());
        outbox.text("second".to_owned());
        outbox.latest(Latest::Cursor(2), "there".to_owned());
        outbox.forget(Latest::Progress(3));
        let texts = ["first", "second", "new", "there"].map(|text| Outgoing::Text(text.to_owned()));
        assert_eq!(all(&outbox)[..4], texts);
        outbox.frame(Bytes::from_static(b"more"));
        assert_eq!(all(&outbox), [Outgoing::Frame(Bytes::from_static(b"more"))]);
    }

    #[test]
    fn too_many_messages_end_it_after_those_that_are_there() {
        let outbox = Outbox::new(2);
        for text in ["a", "b", "c"] {
            outbox.text(text.to_owned());
        }
        let sent = all(&outbox);
        assert_eq!(sent[..2], ["a", "b"].map(|text| Outgoing::Text(text.to_owned())));
        assert!(matches!(sent[2], Outgoing::Close(1013, _)));
    }
}
