//! Messages of the live channel: what clients say, and what they are told.

use orogeny_engine::session::Status;
use orogeny_engine::{PointerSample, Progress};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::frame::FrameFormat;
use crate::reply::Refusal;

/// What a client says. `id` is the client's own number for what it asks for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Message {
    BeginStroke {
        id: u64,
        operation: Value,
    },
    Points {
        id: u64,
        points: Vec<PointerSample>,
    },
    EndStroke {
        id: u64,
    },
    CancelStroke {
        id: u64,
    },
    Apply {
        id: u64,
        operations: Vec<Value>,
    },
    Undo {
        id: u64,
        #[serde(default)]
        anyone: bool,
    },
    Redo {
        id: u64,
        #[serde(default)]
        anyone: bool,
    },
    Subscribe {
        #[serde(default)]
        id: Option<u64>,
        #[serde(default)]
        region: Option<[f64; 4]>,
        #[serde(default)]
        level: u8,
        #[serde(default)]
        format: FrameFormat,
        #[serde(default = "usual_window")]
        window: u32,
    },
    Unsubscribe {},
    Ack {
        frames: u64,
    },
    Cursor {
        x: f64,
        z: f64,
        radius: f64,
    },
}

const fn usual_window() -> u32 {
    16
}

impl Message {
    /// Reads a message.
    ///
    /// # Errors
    /// What cannot be understood.
    pub(crate) fn read(text: &str) -> Result<Self, Refusal> {
        serde_json::from_str(text)
            .map_err(|err| Refusal::new("not_understood", format!("the message cannot be understood: {err}")))
    }
}

/// A rectangle in metres, `[x, z, width, depth]`; `None`: perhaps everywhere.
pub(crate) type RectM = Option<[f64; 4]>;

/// The first thing that a client hears.
pub(crate) fn hello(client: u64, author: &str, terrain: &str, revision: u64, status: &Status) -> String {
    let (root, summary) = status.root;
    json!({
        "event": "hello",
        "client": client,
        "author": author,
        "terrain": terrain,
        "revision": revision,
        "width": status.grid.width(),
        "depth": status.grid.depth(),
        "spacing": status.grid.spacing_m(),
        "page_size": status.layout.size(),
        "levels": root.level,
        "lowest": summary.bounds.min_m,
        "highest": summary.bounds.max_m,
    })
    .to_string()
}

pub(crate) fn clients<'a>(clients: impl Iterator<Item = (u64, &'a str)>) -> String {
    let clients: Vec<_> =
        clients.map(|(client, author)| json!({ "client": client, "author": author })).collect();
    json!({ "event": "clients", "clients": clients }).to_string()
}

pub(crate) fn status(status: &Status) -> String {
    let [can_undo, can_redo] = status.can_undo_redo();
    let bounds = status.root.1.bounds;
    json!({
        "event": "status",
        "layers": status.descriptions,
        "can_undo": can_undo,
        "can_redo": can_redo,
        "lowest": bounds.min_m,
        "highest": bounds.max_m,
    })
    .to_string()
}

/// What was done, for whoever asked for it.
pub(crate) fn done(id: u64, revision: u64, entries: &[u32], rect_m: RectM) -> String {
    json!({ "event": "done", "id": id, "revision": revision, "entries": entries, "rect": rect_m }).to_string()
}

/// What was done, for everyone.
pub(crate) struct Operation<'a> {
    pub(crate) revision: u64,
    pub(crate) author: &'a str,
    /// `None` for one that has no live channel.
    pub(crate) client: Option<u64>,
    pub(crate) what: &'a str,
    pub(crate) entries: &'a [u32],
    pub(crate) rect_m: RectM,
}

impl Operation<'_> {
    pub(crate) fn to_text(&self) -> String {
        json!({
            "event": "operation",
            "revision": self.revision,
            "author": self.author,
            "client": self.client,
            "what": self.what,
            "entries": self.entries,
            "rect": self.rect_m,
        })
        .to_string()
    }
}

pub(crate) fn progress(id: u64, progress: Progress) -> String {
    let Progress { what, done, total } = progress;
    json!({ "event": "progress", "id": id, "stage": what, "done": done, "total": total }).to_string()
}

pub(crate) fn error(id: Option<u64>, refusal: &Refusal) -> String {
    let mut object = refusal.to_json();
    if let Some(fields) = object.as_object_mut() {
        fields.insert("event".to_owned(), "error".into());
        if let Some(id) = id {
            fields.insert("id".to_owned(), id.into());
        }
    }
    object.to_string()
}

pub(crate) fn cut(id: u64, num_points: usize) -> String {
    json!({ "event": "cut", "id": id, "points": num_points }).to_string()
}

pub(crate) fn cursor(client: u64, [x, z]: [f64; 2], radius: f64) -> String {
    json!({ "event": "cursor", "client": client, "x": x, "z": z, "radius": radius }).to_string()
}

pub(crate) fn closing() -> String {
    json!({ "event": "closing" }).to_string()
}
