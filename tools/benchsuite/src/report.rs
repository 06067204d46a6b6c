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
    /// How much memory or disk something takes.
    #[serde(rename = "B")]
    Bytes,
    /// One size divided by another.
    #[serde(rename = "x")]
    Ratio,
}

/// One measured quantity: the median of its repetitions, the lowest and the highest.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Figure {
    /// Which benchmark it is of.
    #[serde(default)]
    what: String,
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

    /// The time under which a share of all lies.
    pub fn percentile(name: String, times: &Times, share: f64) -> Self {
        Self::of_spread(name, Unit::Seconds, Spread::of(vec![times.percentile_s(share)]))
    }

    /// A size, which is the same each time.
    pub fn size(name: String, bytes: f64) -> Self {
        Self::sizes(name, vec![bytes])
    }

    /// A size, measured several times.
    pub fn sizes(name: String, bytes: Vec<f64>) -> Self {
        Self::of_spread(name, Unit::Bytes, Spread::of(bytes))
    }

    /// A proportion, measured several times or once.
    pub fn ratio(name: String, values: Vec<f64>) -> Self {
        Self::of_spread(name, Unit::Ratio, Spread::of(values))
    }

    fn of_spread(name: String, unit: Unit, spread: Spread) -> Self {
        let Spread { median: value, lowest, highest } = spread;
        Self {
            what: String::new(),
            name,
            unit,
            value,
            lowest,
            highest,
            median_ms: None,
            share_of_limit: None,
        }
    }
}

/// How one cost grows with something: a line of a plot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Series {
    /// Series of one title are drawn together.
    title: String,
    name: String,
    /// What grows, with its unit.
    x_name: String,
    unit: Unit,
    /// What has grown to how much, and median, lowest and highest cost there.
    points: Vec<(f64, [f64; 3])>,
}

impl Series {
    pub fn new(title: &str, name: &str, x_name: &str, unit: Unit, points: Vec<(f64, Spread)>) -> Self {
        let points =
            points.into_iter().map(|(x, Spread { median, lowest, highest })| (x, [median, lowest, highest]));
        Self {
            title: title.to_owned(),
            name: name.to_owned(),
            x_name: x_name.to_owned(),
            unit,
            points: points.collect(),
        }
    }

    pub fn title(&self) -> &str {
        &self.title
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn x_name(&self) -> &str {
        &self.x_name
    }

    pub fn points(&self) -> impl Iterator<Item = (f64, Spread)> {
        self.points.iter().map(|(x, [median, lowest, highest])| {
            (*x, Spread { median: *median, lowest: *lowest, highest: *highest })
        })
    }
}

/// The figures of one run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Report {
    machine: String,
    figures: Vec<Figure>,
    #[serde(default)]
    series: Vec<Series>,
    notes: Vec<String>,
    /// The benchmark that is running.
    #[serde(skip)]
    what: String,
}

impl Report {
    pub fn new() -> Self {
        let num_cores = std::thread::available_parallelism().map_or(0, usize::from);
        let machine = format!("{} {}, {num_cores} cores", std::env::consts::OS, std::env::consts::ARCH);
        let (figures, series, notes) = (Vec::new(), Vec::new(), Vec::new());
        Self { machine, figures, series, notes, what: String::new() }
    }

    /// What is added from here on is of this benchmark.
    pub fn begin(&mut self, what: &str) {
        what.clone_into(&mut self.what);
    }

    pub fn add(&mut self, figure: Figure) {
        self.figures.push(Figure { what: self.what.clone(), ..figure });
    }

    pub fn plot(&mut self, series: Series) {
        self.series.push(series);
    }

    pub fn machine(&self) -> &str {
        &self.machine
    }

    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    pub fn series(&self) -> &[Series] {
        &self.series
    }

    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    pub fn print(&self) {
        println!("{}", self.machine);
        println!("{:<57} {:>16} {:>21} {:>10} {:>8}", "", "median", "lowest .. highest", "ms", "of limit");
        for figure in &self.figures {
            let Printed { unit, median, lowest, highest, share_of_limit } = figure.printed();
            println!(
                "{:<57} {median:>8} {unit:<7} {lowest:>9} .. {highest:>8} {:>10} {share_of_limit:>8}",
                figure.name,
                figure.median_ms.map_or(String::new(), |median_ms| format!("{median_ms:.3}")),
            );
        }
        for series in &self.series {
            let (divisor, decimals, unit) =
                series.unit.as_printed(series.points.first().map_or(1.0, |(_, [y, ..])| *y));
            let points: Vec<_> =
                series.points.iter().map(|(x, [y, ..])| format!("{x}: {:.decimals$}", y / divisor)).collect();
            println!(
                "{} ({}), {unit} by {}: {}",
                series.title,
                series.name,
                series.x_name,
                points.join(", ")
            );
        }
        for note in &self.notes {
            println!("{note}");
        }
    }

    /// Prints how each figure differs from the last kept one of its name, where there is one.
    pub fn compare_with_last_kept(&self) -> anyhow::Result<()> {
        let mut kept = BTreeMap::new();
        for (path, run) in Self::kept()? {
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

    /// The kept runs and their files, the newest last.
    pub fn kept() -> anyhow::Result<Vec<(PathBuf, Self)>> {
        let read = |path: PathBuf| {
            let text =
                fs::read_to_string(&path).with_context(|| format!("`{}` cannot be read", path.display()))?;
            let run =
                serde_json::from_str(&text).with_context(|| format!("`{}` is no run", path.display()))?;
            Ok((path, run))
        };
        kept_runs().into_iter().map(read).collect()
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

/// A figure for people.
pub struct Printed {
    pub unit: &'static str,
    pub median: String,
    pub lowest: String,
    pub highest: String,
    pub share_of_limit: String,
}

impl Figure {
    pub fn what(&self) -> &str {
        &self.what
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn printed(&self) -> Printed {
        let (divisor, decimals, unit) = self.unit.as_printed(self.value);
        let printed = |value: f64| format!("{:.decimals$}", value / divisor);
        Printed {
            unit,
            median: printed(self.value),
            lowest: printed(self.lowest),
            highest: printed(self.highest),
            share_of_limit: self
                .share_of_limit
                .map_or(String::new(), |share| format!("{:.0} %", share * 100.0)),
        }
    }
}

impl Unit {
    /// What a value is divided by for people, its decimals and what it then counts.
    fn as_printed(self, value: f64) -> (f64, usize, &'static str) {
        match self {
            // Droplets: less than one of a million.
            Self::SamplesPerSecond if value < 10.0e6 => (1.0e6, 2, "M/s"),
            Self::SamplesPerSecond => (1.0e6, 0, "M/s"),
            Self::BytesPerSecond => (1.0e6, 0, "MB/s"),
            Self::PagesPerSecond => (1.0, 0, "pages/s"),
            Self::Seconds if value < 1.0e-6 => (1.0e-9, 2, "ns"),
            Self::Seconds if value < 1.0e-4 => (1.0e-6, 1, "µs"),
            Self::Seconds => (1.0e-3, 2, "ms"),
            Self::Bytes if value < 10.0 * 1048576.0 => (1024.0, 1, "KiB"),
            Self::Bytes => (1048576.0, 0, "MiB"),
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
