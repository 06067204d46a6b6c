//! Child processes, terrains and skips for the storage tests.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use orogeny_field::{Page, PageKey, PageLayout, TerrainGrid};
use orogeny_store::{NewLayer, NewTerrain, Store};

/// Set in a child: the terrain or folder that it works on.
const CHILD_PATH: &str = "OROGENY_STORAGE_CHILD";

/// Columns and rows of pages of the test terrains.
pub const PAGES: (u32, u32) = (5, 3);

/// What a child was started for; `None` in the parent.
pub fn child_path() -> Option<PathBuf> {
    let path = std::env::var_os(CHILD_PATH)?;
    // The test harness leaves the name of the test on the line.
    println!();
    Some(PathBuf::from(path))
}

/// This test again, by its full name, as a child that works on `path`, its output piped.
pub fn child(test: &str, path: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    as_child(&mut command, path).args(child_arguments(test));
    command
}

/// What makes the test binary run one test.
pub fn child_arguments(test: &str) -> [&str; 3] {
    ["--exact", test, "--nocapture"]
}

/// Makes any command the child of a test.
pub fn as_child<'a>(command: &'a mut Command, path: &Path) -> &'a mut Command {
    command.env(CHILD_PATH, path).stdin(Stdio::piped()).stdout(Stdio::piped())
}

/// Tells the parent that something is done.
pub fn acknowledge(what: &str) {
    println!("ack {what}");
}

/// Everything that a child acknowledged; a line cut off by its end does not count.
pub fn acknowledged(output: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(output);
    let whole_lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
    whole_lines.filter_map(|line| line.strip_prefix("ack ").map(str::to_owned)).collect()
}

/// Says aloud, and where a list is kept, that something could not be tested here.
pub fn skip(reason: &str) {
    println!("SKIPPED (counted): {reason}");
    if let Some(log) = std::env::var_os("OROGENY_SKIP_LOG") {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(log).unwrap();
        writeln!(file, "SKIPPED (counted): {reason}").unwrap();
    }
}

/// Whether the long, exhaustive form of a test was asked for.
pub fn is_long() -> bool {
    std::env::var_os("OROGENY_TEST_LONG").is_some()
}

pub fn layout() -> PageLayout {
    PageLayout::new(64).unwrap()
}

pub fn create(path: &Path) -> Store {
    let (columns, rows) = (u64::from(PAGES.0), u64::from(PAGES.1));
    let new = NewTerrain {
        grid: TerrainGrid::new(columns * 64, rows * 64, 1.0).unwrap(),
        layout: layout(),
        layers: vec![NewLayer { name: "Base".to_owned(), constant_m: 0.0 }],
    };
    Store::create(path, &new).unwrap()
}

/// A page that no two seeds share, and that compresses badly.
pub fn page(seed: u32) -> Page {
    let mut state = seed.wrapping_mul(0x9e37_79b9) | 1;
    let samples = (0..layout().num_samples()).map(|_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 8) as f32 * 0.001 + seed as f32
    });
    Page::from_samples(layout(), samples.collect()).unwrap()
}

/// Every page of every layer, at full resolution: what is above is compared with it by the check.
pub fn contents(store: &Store) -> BTreeMap<PageKey, Page> {
    let keys = store.layers().iter().flat_map(|layer| store.page_keys(layer.heights).unwrap());
    let keys = keys.filter(|key| key.level == 0);
    keys.map(|key| (key, Arc::unwrap_or_clone(store.load_page(&key).unwrap().unwrap()))).collect()
}

pub fn assert_whole(store: &Store) {
    let report = store.check().unwrap();
    assert!(report.problems.is_empty(), "{:#?}", report.problems);
}

/// Random numbers that are the same in every run.
pub struct Seeded(pub u64);

impl Seeded {
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}
