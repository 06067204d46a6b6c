//! Terrains and pages for the tests.

use std::path::{Path, PathBuf};

use orogeny_field::{FieldId, Page, PageKey, PageLayout, TerrainGrid};
use orogeny_store::{EntryId, NewLayer, NewTerrain, Store};
use tempfile::TempDir;

/// The smallest pages, to keep the tests quick.
pub fn layout() -> PageLayout {
    PageLayout::new(64).unwrap()
}

pub fn layer(name: &str, constant_m: f32) -> NewLayer {
    NewLayer { name: name.to_owned(), constant_m }
}

/// A folder that goes away with the test, and a path in it.
pub struct Scratch {
    folder: TempDir,
}

impl Scratch {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("terrain.orogeny")
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Names of all files in the folder, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// A terrain of 5 x 3 pages with one layer at 100 m.
    pub fn create(&self) -> Store {
        let grid = TerrainGrid::new(300, 150, 1.0).unwrap();
        let new = NewTerrain { grid, layout: layout(), layers: vec![layer("Base", 100.0)] };
        Store::create(&self.path(), &new).unwrap()
    }
}

/// The key of a page of the first layer.
pub fn key(store: &Store, x: u32, z: u32) -> PageKey {
    PageKey::full_resolution(store.layers()[0].heights, x, z)
}

/// A page that no two seeds share, with awkward but allowed values in it.
pub fn page(seed: u32) -> Page {
    let mut samples: Vec<f32> = (0..layout().num_samples() as u32)
        .map(|i| {
            let noise = (i ^ seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b) >> 20;
            (i % 64) as f32 * 0.5 + noise as f32 * 0.001 + seed as f32
        })
        .collect();
    let awkward = [-0.0, 0.0, 1.0e7, -1.0e7, f32::MIN_POSITIVE, 1.0e-45, -1.0e-45];
    for (i, value) in awkward.into_iter().enumerate() {
        samples[(i * 577 + seed as usize) % 4096] = value;
    }
    Page::from_samples(layout(), samples).unwrap()
}

pub fn bits(page: &Page) -> Vec<u32> {
    page.samples().iter().map(|height| height.to_bits()).collect()
}

/// Commits pages as one operation.
pub fn commit(store: &mut Store, pages: &[(PageKey, Page)]) -> EntryId {
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(pages).unwrap();
    transaction.commit("{}", "test").unwrap()
}

/// Every page of a field at full resolution, with its bits.
pub fn painted(store: &Store, field: FieldId) -> Vec<(PageKey, Vec<u32>)> {
    let mut pages = contents(store, field);
    pages.retain(|(key, _)| key.level == 0);
    pages
}

/// Every page of a field at all levels, with its bits.
pub fn contents(store: &Store, field: FieldId) -> Vec<(PageKey, Vec<u32>)> {
    let keys = store.page_keys(field).unwrap();
    keys.into_iter().map(|key| (key, bits(&store.load_page(&key).unwrap().unwrap()))).collect()
}

/// Fails, listing the problems, unless `check` finds none.
pub fn assert_whole(store: &Store) {
    let report = store.check().unwrap();
    assert!(report.problems.is_empty(), "{:#?}", report.problems);
}

/// How far a page's surface is said to be from full resolution; `None` where there is no page.
pub fn error_of(store: &Store, key: &PageKey) -> Option<f32> {
    store.page_surface(key).unwrap().map(|(_, error_m)| error_m)
}
