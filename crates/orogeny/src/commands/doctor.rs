//! `doctor`: what this machine can do, and what to install where it cannot.

use std::fmt;
use std::path::Path;

use clap::Args;
use orogeny_engine::{
    Adapter, AdapterDescription, Direction, Format, Settings, backend_description, list_adapters,
};
use serde::Serialize;

use crate::session::Session;

/// Every ending that some format has.
const ENDINGS: [&str; 9] = ["png", "r16", "raw", "r32", "tif", "tiff", "hgt", "zip", "npy"];

/// What `doctor` takes: nothing.
#[derive(Debug, Args)]
pub struct Arguments {}

#[derive(Debug, Serialize)]
struct Report {
    version: &'static str,
    num_threads: usize,
    adapters: Vec<ReportedAdapter>,
    /// What `--adapter auto` takes.
    auto: Outcome,
    /// What `--adapter software` takes.
    software: Outcome,
    import_endings: Vec<&'static str>,
    export_endings: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct ReportedAdapter {
    name: String,
    kind: &'static str,
    backend: String,
    driver: String,
    is_software: bool,
}

/// A back end that works, or why it does not.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Works(String),
    Fails(String),
}

/// Looks at the machine.
///
/// # Errors
/// When standard output cannot be written.
pub fn run(_arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let settings = session.settings();
    let try_out = |adapter| match backend_description(&Settings { adapter, ..settings.clone() }) {
        Ok(description) => Outcome::Works(description),
        Err(err) => Outcome::Fails(err.to_string()),
    };
    session.output().report(&Report {
        version: env!("CARGO_PKG_VERSION"),
        num_threads: std::thread::available_parallelism().map_or(1, Into::into),
        adapters: list_adapters().into_iter().map(ReportedAdapter::from).collect(),
        auto: try_out(Adapter::Auto),
        software: try_out(Adapter::Software),
        import_endings: endings(Direction::Import),
        export_endings: endings(Direction::Export),
    })
}

fn endings(direction: Direction) -> Vec<&'static str> {
    let is_known =
        |ending: &&str| Format::from_path(&Path::new("file").with_extension(ending), direction).is_ok();
    ENDINGS.into_iter().filter(is_known).collect()
}

impl From<AdapterDescription> for ReportedAdapter {
    fn from(adapter: AdapterDescription) -> Self {
        let AdapterDescription { name, backend, kind, driver, is_software } = adapter;
        Self { name, kind, backend, driver, is_software }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "orogeny      {}", self.version)?;
        writeln!(f, "CPU          {} threads", self.num_threads)?;
        if self.adapters.is_empty() {
            writeln!(f, "adapters     none; everything works without one, on the CPU back end")?;
        }
        for (index, ReportedAdapter { name, kind, backend, driver, .. }) in self.adapters.iter().enumerate() {
            let title = if index == 0 { "adapters" } else { "" };
            writeln!(f, "{title:<12} {name} ({kind}, {backend}, {driver})")?;
        }
        writeln!(f, "auto         {}", self.auto)?;
        writeln!(f, "software     {}", self.software)?;
        writeln!(f, "imports      .{}", self.import_endings.join(" ."))?;
        writeln!(f, "exports      .{}", self.export_endings.join(" ."))
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Works(description) => write!(f, "works: {description}"),
            Self::Fails(reason) => write!(f, "does not work: {reason}"),
        }
    }
}
