//! `custom`: look over a custom brush, once or whenever its file changes.

use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use orogeny_engine::CustomBrushFile;
use serde::Serialize;

use crate::cancel;
use crate::output::text_of;
use crate::session::Session;

/// How often a watched file is looked at.
const INTERVAL: Duration = Duration::from_millis(200);

/// What `custom` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The WGSL file
    file: PathBuf,
    /// Go on, and look again whenever the file changes, until Ctrl-C
    #[arg(long)]
    watch: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    file: String,
    summary: String,
    /// For one sample and instance at most.
    num_operations: u64,
    parameters: Vec<Parameter>,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: String,
    default: f32,
    min: f32,
    max: f32,
    meaning: String,
}

/// Compiles the file and tells what it declares.
///
/// # Errors
/// When the file cannot be read or does not compile; while it is watched, only when it did not at first.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let mut file = CustomBrushFile::open(&arguments.file)?;
    session.output().report(&Report::of(&file))?;
    if arguments.watch {
        cancel::watch();
    }
    while arguments.watch && !cancel::is_requested() {
        std::thread::sleep(INTERVAL);
        match file.refresh() {
            Ok(true) => session.output().report(&Report::of(&file))?,
            Ok(false) => {}
            // The last good one stays; the next change may mend it.
            Err(err) => session.output().error(&err.to_string()),
        }
    }
    Ok(())
}

impl Report {
    fn of(file: &CustomBrushFile) -> Self {
        let parameters = file.parameters().iter().map(|parameter| Parameter {
            name: parameter.name.clone(),
            default: parameter.default,
            min: parameter.min,
            max: parameter.max,
            meaning: parameter.meaning.clone(),
        });
        Self {
            file: text_of(file.path()),
            summary: file.summary().to_owned(),
            num_operations: file.num_operations(),
            parameters: parameters.collect(),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.file, self.summary)?;
        for Parameter { name, default, min, max, meaning } in &self.parameters {
            writeln!(f, "    {name:<14} {default:<9} {meaning} ({min} to {max})")?;
        }
        writeln!(f, "up to {} operations for a sample and instance", self.num_operations)
    }
}
