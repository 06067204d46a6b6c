//! Figures of a run: printed, kept, compared.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use serde::{Deserialize, Serialize};

use crate::measure::Times;

/// One measured rate.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Figure {
    name: String,
    /// Samples a second, by the median time.
    samples_per_s: f64,
    /// The same by the slowest and the fastest time.
    slowest_samples_per_s: f64,
    fastest_samples_per_s: f64,
    median_ms: f64,
    /// The share of the limit measured beside it that its bytes, read and written, come to.
    share_of_copy: Option<f64>,
}

impl Figure {
    /// A rate of `num_samples` heights, each read and written once, a measurement.
    pub fn rate(name: String, times: &Times, num_samples: f64, copy_bytes_per_s: Option<f64>) -> Self {
        let (fastest_s, slowest_s) = times.extremes_s();
        let samples_per_s = num_samples / times.median_s();
        Self {
            name,
            samples_per_s,
            slowest_samples_per_s: num_samples / slowest_s,
            fastest_samples_per_s: num_samples / fastest_s,
            median_ms: times.median_s() * 1.0e3,
            share_of_copy: copy_bytes_per_s.map(|limit| samples_per_s * 8.0 / limit),
        }
    }
}

/// The figures of one run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Report {
    machine: String,
    figures: Vec<Figure>,
    notes: Vec<String>,
}

impl Report {
    pub fn new() -> Self {
        let num_cores = std::thread::available_parallelism().map_or(0, usize::from);
        let machine = format!("{} {}, {num_cores} cores", std::env::consts::OS, std::env::consts::ARCH);
        Self { machine, figures: Vec::new(), notes: Vec::new() }
    }

    pub fn add(&mut self, figure: Figure) {
        self.figures.push(figure);
    }

    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    pub fn print(&self) {
        println!("{}", self.machine);
        println!("{:<44} {:>10} {:>21} {:>10} {:>8}", "", "M/s", "slowest .. fastest", "ms", "of copy");
        for figure in &self.figures {
            let share = figure.share_of_copy.map_or(String::new(), |share| format!("{:.0} %", share * 100.0));
            println!(
                "{:<44} {:>10.0} {:>9.0} .. {:>8.0} {:>10.3} {:>8}",
                figure.name,
                figure.samples_per_s / 1.0e6,
                figure.slowest_samples_per_s / 1.0e6,
                figure.fastest_samples_per_s / 1.0e6,
                figure.median_ms,
                share
            );
        }
        for note in &self.notes {
            println!("{note}");
        }
    }

    /// Prints how each figure differs from the last kept run's, where there is one.
    pub fn compare_with_last_kept(&self) -> anyhow::Result<()> {
        let mut kept: Vec<_> = fs::read_dir(runs_folder())
            .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
            .unwrap_or_default();
        kept.retain(|path: &PathBuf| path.extension().is_some_and(|ending| ending == "json"));
        kept.sort();
        let Some(last) = kept.pop() else {
            println!("no kept run to compare with");
            return Ok(());
        };
        let text =
            fs::read_to_string(&last).with_context(|| format!("`{}` cannot be read", last.display()))?;
        let before: Self =
            serde_json::from_str(&text).with_context(|| format!("`{}` is no run", last.display()))?;
        let rates: BTreeMap<_, _> =
            before.figures.iter().map(|figure| (&figure.name, figure.samples_per_s)).collect();
        println!("against {} ({}):", last.display(), before.machine);
        for figure in &self.figures {
            if let Some(rate) = rates.get(&figure.name) {
                println!("{:<44} {:>+9.0} %", figure.name, (figure.samples_per_s / rate - 1.0) * 100.0);
            }
        }
        Ok(())
    }

    /// Writes the run to `runs/NAME.json`.
    pub fn keep(&self, name: &str) -> anyhow::Result<PathBuf> {
        let path = runs_folder().join(format!("{name}.json"));
        fs::create_dir_all(runs_folder())?;
        let text = serde_json::to_string_pretty(self)? + "\n";
        fs::write(&path, text).with_context(|| format!("`{}` cannot be written", path.display()))?;
        Ok(path)
    }
}

fn runs_folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/runs"))
}
