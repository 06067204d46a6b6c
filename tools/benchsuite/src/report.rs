//! Figures of a run: printed, kept, compared.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use serde::{Deserialize, Serialize};

use crate::measure::{Spread, Times};

/// What a figure counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Heights a second.
    #[serde(rename = "samples/s")]
    SamplesPerSecond,
    /// Bytes a second.
    #[serde(rename = "B/s")]
    BytesPerSecond,
    /// Pages a second.
    #[serde(rename = "pages/s")]
    PagesPerSecond,
    /// How long something takes.
    #[serde(rename = "s")]
    Seconds,
    /// One size divided by another.
    #[serde(rename = "x")]
    Ratio,
}

/// One measured quantity: the median of its repetitions, the lowest and the highest.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Figure {
    name: String,
    unit: Unit,
    value: f64,
    lowest: f64,
    highest: f64,
    /// The median time of what was measured; none for a size.
    median_ms: Option<f64>,
    /// The share of the limit measured beside it.
    share_of_limit: Option<f64>,
}

impl Figure {
    /// A rate of `num_samples` heights, each read and written once, a measurement; the limit is how fast memory is copied.
    pub fn rate(name: String, times: &Times, num_samples: f64, copy_bytes_per_s: Option<f64>) -> Self {
        let limit = copy_bytes_per_s.map(|bytes_per_s| bytes_per_s / 8.0);
        Self::per_second(name, Unit::SamplesPerSecond, times, num_samples, limit)
    }

    /// A rate of `amount` a measurement; the limit is such a rate too.
    pub fn per_second(name: String, unit: Unit, times: &Times, amount: f64, limit: Option<f64>) -> Self {
        let spread = times.per_second(amount);
        Self {
            median_ms: Some(times.median_s() * 1.0e3),
            share_of_limit: limit.map(|limit| spread.median / limit),
            ..Self::of_spread(name, unit, spread)
        }
    }

    /// How long something takes.
    pub fn time(name: String, times: &Times) -> Self {
        Self::of_spread(name, Unit::Seconds, times.spread_s())
    }

    /// A proportion, measured several times or once.
    pub fn ratio(name: String, values: Vec<f64>) -> Self {
        Self::of_spread(name, Unit::Ratio, Spread::of(values))
    }

    fn of_spread(name: String, unit: Unit, spread: Spread) -> Self {
        let Spread { median: value, lowest, highest } = spread;
        Self { name, unit, value, lowest, highest, median_ms: None, share_of_limit: None }
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
        println!("{:<57} {:>16} {:>21} {:>10} {:>8}", "", "median", "lowest .. highest", "ms", "of limit");
        for figure in &self.figures {
            let (divisor, decimals, unit) = figure.unit.as_printed();
            let printed = |value: f64| format!("{:.decimals$}", value / divisor);
            let share =
                figure.share_of_limit.map_or(String::new(), |share| format!("{:.0} %", share * 100.0));
            println!(
                "{:<57} {:>8} {unit:<7} {:>9} .. {:>8} {:>10} {share:>8}",
                figure.name,
                printed(figure.value),
                printed(figure.lowest),
                printed(figure.highest),
                figure.median_ms.map_or(String::new(), |median_ms| format!("{median_ms:.3}")),
            );
        }
        for note in &self.notes {
            println!("{note}");
        }
    }

    /// Prints how each figure differs from the last kept one of its name, where there is one.
    pub fn compare_with_last_kept(&self) -> anyhow::Result<()> {
        let mut kept = BTreeMap::new();
        for path in kept_runs() {
            let text =
                fs::read_to_string(&path).with_context(|| format!("`{}` cannot be read", path.display()))?;
            let run: Self =
                serde_json::from_str(&text).with_context(|| format!("`{}` is no run", path.display()))?;
            kept.extend(run.figures.into_iter().map(|figure| (figure.name.clone(), (figure, path.clone()))));
        }
        println!("against the last kept run of each:");
        for figure in &self.figures {
            if let Some((before, path)) = kept.get(&figure.name)
                && before.unit == figure.unit
            {
                let change = (figure.value / before.value - 1.0) * 100.0;
                let run = path.file_stem().unwrap_or_default().display();
                println!("{:<57} {change:>+9.0} % {run}", figure.name);
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

impl Unit {
    /// What a value is divided by for people, its decimals and what it then counts.
    const fn as_printed(self) -> (f64, usize, &'static str) {
        match self {
            Self::SamplesPerSecond => (1.0e6, 0, "M/s"),
            Self::BytesPerSecond => (1.0e6, 0, "MB/s"),
            Self::PagesPerSecond => (1.0, 0, "pages/s"),
            Self::Seconds => (1.0e-3, 2, "ms"),
            Self::Ratio => (1.0, 2, "x"),
        }
    }
}

/// The kept runs, by name: the last is the newest where names begin with a date.
fn kept_runs() -> Vec<PathBuf> {
    let mut kept: Vec<_> = fs::read_dir(runs_folder())
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    kept.retain(|path: &PathBuf| path.extension().is_some_and(|ending| ending == "json"));
    kept.sort();
    kept
}

fn runs_folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/runs"))
}
