//! Benchmarks: each figure in one run beside the limit that it can be compared with.
//!
//! `cargo xtask bench [WHAT…] [--repeat N] [--keep NAME]`. Measurements of one figure and of its limit are interleaved, and
//! medians are given with the spread, since a busy machine slows both. `--keep` writes the run to `runs/NAME.json`; every run is
//! compared with the last kept one, by name. `--document` measures nothing, and makes the tables and plots of `docs/performance.md` of the
//! kept runs.

#![expect(clippy::print_stdout, reason = "printing figures is what this program is for")]

mod adapter;
mod bundled;
mod clone;
mod codecs;
mod curves;
mod dab;
mod document;
mod erode;
mod files;
mod fill;
mod ground;
mod layers;
mod limit;
mod measure;
mod memory;
mod noise;
mod plot;
mod python;
mod raise;
mod render;
mod report;
mod serve;
mod session;
mod smooth;
mod stores;
mod terrain;
mod window;

use anyhow::{Context as _, bail};

use crate::report::Report;

/// What can be measured.
const WHAT: [&str; 15] = [
    "raise", "noise", "smooth", "clone", "erode", "codecs", "stores", "terrain", "layers", "files", "memory",
    "render", "session", "serve", "curves",
];

struct Arguments {
    what: Vec<String>,
    repeat: usize,
    keep: Option<String>,
    is_document: bool,
}

fn main() -> anyhow::Result<()> {
    if let Some(peak_in_bytes) = files::as_child()? {
        println!("{peak_in_bytes}");
        return Ok(());
    }
    let arguments = arguments()?;
    if arguments.is_document {
        return document::write();
    }
    let mut report = Report::new();
    for what in &arguments.what {
        report.begin(what);
        match what.as_str() {
            "raise" => raise::run(&mut report, arguments.repeat)?,
            "noise" => noise::run(&mut report, arguments.repeat)?,
            "smooth" => smooth::run(&mut report, arguments.repeat)?,
            "clone" => clone::run(&mut report, arguments.repeat)?,
            "erode" => erode::run(&mut report, arguments.repeat)?,
            "codecs" => codecs::run(&mut report, arguments.repeat)?,
            "stores" => stores::run(&mut report, arguments.repeat)?,
            "terrain" => terrain::run(&mut report, arguments.repeat)?,
            "layers" => layers::run(&mut report, arguments.repeat)?,
            "files" => files::run(&mut report, arguments.repeat)?,
            "memory" => memory::run(&mut report)?,
            "render" => render::run(&mut report, arguments.repeat)?,
            "session" => session::run(&mut report, arguments.repeat)?,
            "serve" => serve::run(&mut report, arguments.repeat)?,
            "curves" => curves::run(&mut report, arguments.repeat)?,
            other => bail!("there is no benchmark `{other}`; there are {}", WHAT.join(", ")),
        }
    }
    report.print();
    report.compare_with_last_kept()?;
    if let Some(name) = arguments.keep {
        let path = report.keep(&name)?;
        println!("kept as {}", path.display());
    }
    Ok(())
}

fn arguments() -> anyhow::Result<Arguments> {
    use lexopt::prelude::*;
    let mut arguments = Arguments { what: Vec::new(), repeat: 11, keep: None, is_document: false };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Value(what) => arguments.what.push(what.string()?),
            Long("repeat") => {
                arguments.repeat = parser.value()?.parse().context("--repeat takes a number")?
            }
            Long("document") => arguments.is_document = true,
            Long("keep") => arguments.keep = Some(parser.value()?.string()?),
            other => return Err(other.unexpected().into()),
        }
    }
    if arguments.what.is_empty() {
        arguments.what.extend(WHAT.map(str::to_owned));
    }
    Ok(arguments)
}
