//! What all commands share: the settings of the engine and the way to report.

use std::path::{Path, PathBuf};

use orogeny_engine::presets::{ExportPresets, user_presets_folder};
use orogeny_engine::{Adapter, Presets, Settings, Terrain};
use tracing_subscriber::filter::LevelFilter;

use crate::arguments::Global;
use crate::output::Output;

/// The global options, put to use.
#[derive(Debug)]
pub struct Session {
    settings: Settings,
    output: Output,
    presets_folder: Option<PathBuf>,
}

impl Session {
    /// From the global options. Notes of `-v` go to standard error from here on.
    pub fn new(global: &Global) -> Self {
        let level = match global.verbose {
            0 if global.json => LevelFilter::OFF, // standard error then holds the error alone
            0 => LevelFilter::WARN,
            1 => LevelFilter::INFO,
            _ => LevelFilter::DEBUG,
        };
        tracing_subscriber::fmt()
            .with_max_level(level)
            .with_writer(std::io::stderr)
            .without_time()
            .with_target(false)
            .init();
        let user = std::env::var("USER").or_else(|_| std::env::var("USERNAME"));
        let settings = Settings {
            adapter: Adapter::from_name(&global.adapter),
            page_budget_in_bytes: global.page_budget << 20,
            num_threads: global.threads.map(Into::into),
            author: user.unwrap_or_default(),
        };
        Self { settings, output: Output::new(global.json), presets_folder: global.presets.clone() }
    }

    /// How the engine is to work.
    pub fn settings(&self) -> Settings {
        self.settings.clone()
    }

    /// Where reports go.
    pub const fn output(&self) -> Output {
        self.output
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

    /// Opens a terrain for writing.
    ///
    /// # Errors
    /// As [`Terrain::open`].
    pub fn open(&self, path: &Path) -> anyhow::Result<Terrain> {
        Ok(Terrain::open(path, self.settings())?)
    }
}
