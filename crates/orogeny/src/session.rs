//! What all commands share: the settings of the engine and the way to report.

use std::path::{Path, PathBuf};

use orogeny_editor::Log;
use orogeny_engine::presets::{ExportPresets, user_presets_folder};
use orogeny_engine::{Adapter, EntryId, Presets, Settings, Terrain};
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::filter::{LevelFilter, filter_fn};
use tracing_subscriber::layer::{Context, SubscriberExt as _};
use tracing_subscriber::util::SubscriberInitExt as _;

use crate::arguments::Global;
use crate::output::Output;

/// The global options, put to use.
#[derive(Debug)]
pub struct Session {
    settings: Settings,
    output: Output,
    presets_folder: Option<PathBuf>,
    /// Where notes go as well, for a window to show them.
    log: Option<Log>,
}

/// Has the notes of this program's own parts kept for a window.
struct Kept(Log);

/// The text of a note: its message, then whatever else it has.
#[derive(Default)]
struct NoteText(String);

impl Visit for NoteText {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        use std::fmt::Write as _;
        let gap = if self.0.is_empty() { "" } else { " " };
        // Writing into a string does not fail.
        match field.name() {
            "message" => self.0.insert_str(0, &format!("{value:?}{gap}")),
            name => _ = write!(self.0, "{gap}{name}={value:?}"),
        }
    }
}

impl<S: Subscriber> Layer<S> for Kept {
    fn on_event(&self, event: &Event<'_>, _context: Context<'_, S>) {
        let metadata = event.metadata();
        let mut text = NoteText::default();
        event.record(&mut text);
        self.0.push(*metadata.level(), metadata.target(), text.0);
    }
}

impl Session {
    /// From the global options. Notes of `-v` go to standard error from here on, and all of them to a log where there is to be a window.
    pub fn new(global: &Global, is_window: bool) -> Self {
        let level = match global.verbose {
            0 if global.json => LevelFilter::OFF, // standard error then holds the error alone
            0 => LevelFilter::WARN,
            1 => LevelFilter::INFO,
            _ => LevelFilter::DEBUG,
        };
        let printed = tracing_subscriber::fmt::layer()
            .with_writer(std::io::stderr)
            .without_time()
            .with_target(false)
            .with_filter(level);
        let log = is_window.then(Log::default);
        let of_this_program = filter_fn(|metadata| metadata.target().starts_with("orogeny"));
        let kept = log.clone().map(|log| Kept(log).with_filter(of_this_program));
        tracing_subscriber::registry().with(printed).with(kept).init();
        let user = std::env::var("USER").or_else(|_| std::env::var("USERNAME"));
        let settings = Settings {
            adapter: Adapter::from_name(&global.adapter),
            page_budget_in_bytes: global.page_budget << 20,
            num_threads: global.threads.map(Into::into),
            author: user.unwrap_or_default(),
        };
        Self { settings, output: Output::new(global.json), presets_folder: global.presets.clone(), log }
    }

    /// How the engine is to work.
    pub fn settings(&self) -> Settings {
        self.settings.clone()
    }

    /// Where reports go.
    pub const fn output(&self) -> Output {
        self.output
    }

    /// What is noted, where a window is going to show it.
    pub const fn log(&self) -> Option<&Log> {
        self.log.as_ref()
    }

    /// The presets that come with the program and the user's.
    pub fn presets(&self) -> Presets {
        Presets::open(self.presets_folder.clone().or_else(user_presets_folder))
    }

    /// Those of exports, which have a folder in that one.
    pub fn export_presets(&self) -> ExportPresets {
        ExportPresets::of(&self.presets())
    }

    /// Opens a terrain for reading, beside whoever writes it.
    ///
    /// # Errors
    /// As [`Terrain::open_to_read`].
    pub fn open_to_read(&self, path: &Path) -> anyhow::Result<Terrain> {
        Ok(Terrain::open_to_read(path, self.settings())?)
    }

    /// Opens a terrain for reading as it was after an entry of its history.
    ///
    /// # Errors
    /// As [`Terrain::open_to_read_at`].
    pub fn open_to_read_at(&self, path: &Path, entry: EntryId) -> anyhow::Result<Terrain> {
        Ok(Terrain::open_to_read_at(path, entry, self.settings())?)
    }

    /// Opens a terrain for writing.
    ///
    /// # Errors
    /// As [`Terrain::open`].
    pub fn open(&self, path: &Path) -> anyhow::Result<Terrain> {
        Ok(Terrain::open(path, self.settings())?)
    }
}
