//! The tables and plots of `docs/performance.md`, made of the kept runs: of each figure the newest.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use crate::plot;
use crate::report::{Figure, Printed, Report, Series};

/// Writes all tables of the page, each between `<!-- figures: WHAT -->` and `<!-- end -->`, and the plots that it shows.
pub fn write() -> Result<()> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let path = root.join("docs/performance.md");
    let page = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let runs = Report::kept()?;
    fs::write(&path, with_tables(&page, &runs)?)
        .with_context(|| format!("cannot write {}", path.display()))?;
    let mut plots = BTreeMap::new();
    for series in runs.iter().flat_map(|(_, run)| run.series()) {
        let of_title: &mut BTreeMap<String, &Series> = plots.entry(series.title().to_owned()).or_default();
        of_title.insert(series.name().to_owned(), series);
    }
    for (title, series) in plots {
        let file = root.join("docs/images").join(format!("performance-{}.svg", title.replace(' ', "-")));
        let series: Vec<_> = series.into_values().collect();
        fs::write(&file, plot::svg(&title, &series))
            .with_context(|| format!("cannot write {}", file.display()))?;
        println!("{}", file.display());
    }
    println!("{}", path.display());
    Ok(())
}

/// The page with its tables made anew.
fn with_tables(page: &str, runs: &[(PathBuf, Report)]) -> Result<String> {
    const BEGIN: &str = "<!-- figures: ";
    const END: &str = "<!-- end -->";
    let mut made = String::new();
    let mut rest = page;
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let Some((what, after)) = after.split_once(" -->") else {
            bail!("a table's beginning is not closed")
        };
        let Some((_, after)) = after.split_once(END) else { bail!("the table of `{what}` has no end") };
        let table = table(what, runs);
        if table.is_empty() {
            bail!("no kept run has figures of `{what}`: `cargo xtask bench {what} --keep NAME`");
        }
        _ = write!(made, "{before}{BEGIN}{what} -->\n\n{table}\n{END}");
        rest = after;
    }
    Ok(made + rest)
}

/// The newest run with figures of a benchmark, as rows.
fn table(what: &str, runs: &[(PathBuf, Report)]) -> String {
    let figures_of = |run: &Report| {
        run.figures().iter().filter(|figure| figure.what() == what).cloned().collect::<Vec<Figure>>()
    };
    let newest = runs.iter().rev().find(|(_, run)| !figures_of(run).is_empty());
    let Some((path, run)) = newest else { return String::new() };
    let mut table = "| | median | lowest to highest | of the limit |\n| --- | --- | --- | --- |\n".to_owned();
    for figure in figures_of(run) {
        let Printed { unit, median, lowest, highest, share_of_limit } = figure.printed();
        let spread = if lowest == highest { String::new() } else { format!("{lowest} to {highest}") };
        _ = writeln!(table, "| {} | {median} {unit} | {spread} | {share_of_limit} |", figure.name());
    }
    let name = path.file_stem().unwrap_or_default().display();
    _ = writeln!(table, "\nRun `{name}`, {}.", run.machine());
    for note in run.notes().iter().filter(|note| note.starts_with(what)) {
        _ = writeln!(table, "{note}.");
    }
    table
}

#[cfg(test)]
mod tests {
    use crate::measure::Times;

    use super::*;

    fn run(seconds: f64) -> Report {
        let mut report = Report::new();
        report.begin("raise");
        let mut times = Times::default();
        times.add(seconds);
        report.add(Figure::time("raise once".to_owned(), &times));
        report
    }

    #[test]
    fn a_table_is_made_of_the_newest_run_and_all_else_stays() {
        let runs = [("old.json", 0.5), ("new.json", 0.25)]
            .map(|(name, seconds)| (PathBuf::from(name), run(seconds)));
        let page = "before\n<!-- figures: raise -->\nstale\n<!-- end -->\nafter\n";
        let made = with_tables(page, &runs).unwrap();
        assert!(
            made.starts_with("before\n<!-- figures: raise -->\n") && made.ends_with("<!-- end -->\nafter\n")
        );
        assert!(made.contains("| raise once | 250.00 ms |") && made.contains("Run `new`"), "{made}");
        assert!(!made.contains("stale"));
        assert_eq!(with_tables(&made, &runs).unwrap(), made, "made again it is the same");
    }

    #[test]
    fn a_table_without_figures_or_without_an_end_is_an_error() {
        let runs = [(PathBuf::from("a.json"), run(1.0))];
        assert!(with_tables("<!-- figures: smooth -->\n<!-- end -->", &runs).is_err());
        assert!(with_tables("<!-- figures: raise -->\n", &runs).is_err());
    }
}
