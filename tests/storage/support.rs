//! Terrains and skips for the storage tests.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

use orogeny_field::{Page, PageKey, PageLayout, TerrainGrid};
use orogeny_store::{NewLayer, NewTerrain, Store};
pub use orogeny_tests::child::{
    acknowledge, acknowledged, as_child, child, child_arguments, child_path, is_long,
};

/// Columns and rows of pages of the test terrains.
pub const PAGES: (u32, u32) = (5, 3);

/// Says aloud, and where a list is kept, that something could not be tested here.
pub fn skip(reason: &str) {
    println!("SKIPPED (counted): {reason}");
    if let Some(log) = std::env::var_os("OROGENY_SKIP_LOG") {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(log).unwrap();
        writeln!(file, "SKIPPED (counted): {reason}").unwrap();
    }
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
