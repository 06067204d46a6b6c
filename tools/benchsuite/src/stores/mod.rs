//! Embedded stores at the product's work: commits that replace pages and keep what was done to them, then single pages at random.
//!
//! All get the same bytes: pages of the bundled terrain before and after real strokes, and the deltas, coded beforehand with the
//! product's codec. A commit is on disk when it returns. The limit is a plain file that is overwritten with the same bytes and
//! synced: no store, but what the disk can do.
//!
//! The operating system's cache is warm when pages are read, as it is after a terrain was worked on.

mod fjall;
mod overwritten;
mod redb;
mod sqlite;
mod work;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use tempfile::TempDir;

use crate::measure::Times;
use crate::report::{Figure, Report, Unit};
use overwritten::Overwritten;
use work::{Live, Work, Write};

/// Pages of each commit.
const COMMIT_SIZES: [usize; 3] = [64, 256, 1000];
/// Commits, each size by turns, before the store is closed: pages are replaced several times.
const NUM_COMMITS: usize = 6;
const NUM_READS: usize = 1000;

/// A file or folder that keeps pages by their place, and what was done to them by entry and place.
trait Store {
    /// Replaces the pages and adds the deltas that are there. All of it is on disk when this returns, or nothing.
    fn commit(&mut self, entry: u32, writes: &[Write]) -> Result<()>;

    /// The coded page as it was last committed.
    fn read(&self, place: u32) -> Result<Vec<u8>>;

    /// Ends as the product would.
    fn close(self: Box<Self>) -> Result<()>;
}

type Open = fn(&Path) -> Result<Box<dyn Store>>;

/// The stores. Each makes what is not there in a folder of its own, or opens it.
const STORES: [(&str, Open); 3] = [("SQLite", sqlite::open), ("redb", redb::open), ("fjall", fjall::open)];

/// What is measured of the limit and of every store.
#[derive(Default)]
struct Speeds {
    /// By commit size.
    commits: BTreeMap<usize, Times>,
    reads: Times,
}

/// What is measured of one store.
struct Case {
    name: &'static str,
    open: Open,
    speeds: Speeds,
    openings: Times,
    /// Bytes on disk by bytes that are still of use.
    growth: Vec<f64>,
}

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let work = Work::new()?;
    report.note(work.description());
    let mut limit = Speeds::default();
    let mut cases = STORES.map(|(name, open)| {
        let (speeds, openings, growth) = Default::default();
        Case { name, open, speeds, openings, growth }
    });
    for _ in 0..repeat {
        measure_limit(&mut limit, &work)?;
        for case in &mut cases {
            case.measure(&work).with_context(|| format!("{} failed", case.name))?;
        }
        // No store always comes after the same one.
        cases.rotate_left(1);
    }
    cases.sort_by_key(|case| STORES.iter().position(|(name, _)| *name == case.name));
    add_figures(report, &work, &limit, &cases);
    Ok(())
}

fn add_figures(report: &mut Report, work: &Work, limit: &Speeds, cases: &[Case]) {
    let named =
        || std::iter::once(("the limit", limit)).chain(cases.iter().map(|case| (case.name, &case.speeds)));
    for size in COMMIT_SIZES {
        let bytes = work.mean_bytes_of_commit(size);
        let times = |speeds: &Speeds| speeds.commits.get(&size).cloned().unwrap_or_default();
        let limit = bytes / times(limit).median_s();
        for (name, speeds) in named() {
            let name = format!("commit of {size} pages, {name}");
            let times = times(speeds);
            report.add(Figure::per_second(name, Unit::BytesPerSecond, &times, bytes, Some(limit)));
        }
    }
    let num_reads = NUM_READS as f64;
    let limit = num_reads / limit.reads.median_s();
    for (name, speeds) in named() {
        let name = format!("{NUM_READS} pages at random, {name}");
        report.add(Figure::per_second(name, Unit::PagesPerSecond, &speeds.reads, num_reads, Some(limit)));
    }
    for case in cases {
        report.add(Figure::time(format!("opening, {}", case.name), &case.openings));
    }
    for case in cases {
        let name = format!("bytes on disk by bytes of use, {}", case.name);
        report.add(Figure::ratio(name, case.growth.clone()));
    }
}

fn measure_limit(limit: &mut Speeds, work: &Work) -> Result<()> {
    let scratch = scratch_folder()?;
    let mut file = Overwritten::create(scratch.path(), work.longest_commit())?;
    for (entry, size) in Work::commits() {
        let writes = work.commit(entry, size);
        limit.commits.entry(size).or_default().measure(|| file.commit(writes))?;
    }
    let pages: Vec<(u64, usize)> =
        work.random_places(NUM_READS).map(|place| work.start_and_length(place)).collect();
    let mut read =
        || pages.iter().map(|(start, length)| file.read(*start, *length)).collect::<Result<Vec<_>>>();
    limit.reads.measure(&mut read)?;
    Ok(())
}

impl Case {
    /// Once through the whole work, in a new folder.
    fn measure(&mut self, work: &Work) -> Result<()> {
        let folder = scratch_folder()?;
        let mut store = (self.open)(folder.path())?;
        store.commit(0, work.ground())?;
        let mut live = Live::default();
        live.commit(work.ground());
        for (entry, size) in Work::commits() {
            let writes = work.commit(entry, size);
            self.speeds.commits.entry(size).or_default().measure(|| store.commit(entry, writes))?;
            live.commit(writes);
        }
        store.close()?;
        self.growth.push(size_on_disk(folder.path())? as f64 / live.num_bytes() as f64);

        let store = self.openings.measure(|| (self.open)(folder.path()))?;
        let places: Vec<u32> = work.random_places(NUM_READS).collect();
        let read = || places.iter().map(|place| store.read(*place)).collect::<Result<Vec<_>>>();
        let pages = self.speeds.reads.measure(read)?;
        for (place, page) in places.iter().zip(pages) {
            ensure!(live.page(*place) == Some(page.as_slice()), "page {place} came back wrong");
        }
        store.close()
    }
}

/// A folder that goes when it is dropped. It lies beside this program, in cargo's folder: on a disk, which the folder for
/// temporary files need not be.
pub fn scratch_folder() -> Result<TempDir> {
    let program = std::env::current_exe()?;
    let parent = program.parent().context("this program lies in no folder")?;
    Ok(tempfile::Builder::new().prefix("bench-stores-").tempdir_in(parent)?)
}

/// What a folder takes on disk.
fn size_on_disk(folder: &Path) -> Result<u64> {
    let mut size_in_bytes = 0;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        size_in_bytes +=
            if metadata.is_dir() { size_on_disk(&entry.path())? } else { allocated_bytes(&metadata) };
    }
    Ok(size_in_bytes)
}

#[cfg(unix)]
fn allocated_bytes(metadata: &std::fs::Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::blocks(metadata) * 512
}

#[cfg(not(unix))]
fn allocated_bytes(metadata: &std::fs::Metadata) -> u64 {
    metadata.len()
}
