//! Terrains, operations and comparisons of the tests.

use std::path::{Path, PathBuf};

use orogeny_engine::{
    Adapter, ExportSource, Layer, LayerReference, Operation, Quiet, Result, Settings, Terrain, TerrainGrid,
};
use orogeny_field::PageLayout;
use orogeny_store::{NewLayer, NewTerrain, Store};
use orogeny_tests::{Plane, Tolerance, compare};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Samples a side of most terrains, odd so that pages hang over their edges at every level.
pub const SIDES: [u64; 2] = [300, 517];

/// Metres between samples of most terrains: far enough that a height's last bits are no slope.
pub const SPACING_M: f64 = 25.0;

pub fn settings() -> Settings {
    Settings {
        adapter: Adapter::Cpu,
        page_budget_in_bytes: 64 << 20,
        author: "test".to_owned(),
        ..Settings::default()
    }
}

/// A terrain in a folder of its own.
pub struct Site {
    pub terrain: Terrain,
    pub path: PathBuf,
    folder: TempDir,
}

impl Site {
    /// A terrain of one layer, `Base`, at 100 m.
    pub fn new([width, depth]: [u64; 2], spacing_m: f64, page_size: u32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.orogeny");
        let layers = vec![NewLayer { name: "Base".to_owned(), constant_m: 100.0 }];
        let grid = TerrainGrid::new(width, depth, spacing_m).unwrap();
        let new = NewTerrain { grid, layout: PageLayout::new(page_size).unwrap(), layers };
        Store::create(&path, &new).unwrap().close().unwrap();
        Self { terrain: Terrain::open(&path, settings()).unwrap(), path, folder }
    }

    /// One of the usual size, on small pages.
    pub fn usual() -> Self {
        Self::new(SIDES, SPACING_M, 64)
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Does operations, each of which must succeed.
    pub fn apply(&mut self, operations: &[Value]) {
        operations.iter().for_each(|operation| self.apply_one(operation));
    }

    pub fn apply_one(&mut self, operation: &Value) {
        self.try_to(operation).unwrap_or_else(|err| panic!("{operation}: {err}"));
    }

    pub fn try_to(&mut self, json: &Value) -> Result<()> {
        self.terrain.apply(&[operation(json)], &mut Quiet).map(drop)
    }

    /// Closes the terrain and opens it again.
    pub fn reopen(&mut self) {
        let other = self.file("other.orogeny");
        let grid = TerrainGrid::new(8, 8, 1.0).unwrap();
        let stand_in = Terrain::create(&other, grid, 0.0, settings()).unwrap();
        std::mem::replace(&mut self.terrain, stand_in).close().unwrap();
        self.terrain = Terrain::open(&self.path, settings()).unwrap();
        std::fs::remove_file(&other).unwrap();
    }

    pub fn top_level(&self) -> u8 {
        self.terrain.describe().unwrap().num_levels_above
    }

    /// The composite of every level.
    pub fn composites(&self) -> Vec<Plane> {
        (0..=self.top_level()).map(|level| composite(&self.terrain, level)).collect()
    }

    pub fn layers(&self) -> Vec<Layer> {
        self.terrain.layers().unwrap().to_vec()
    }

    pub fn is_stale(&self, name: &str) -> bool {
        let described = self.terrain.describe().unwrap();
        described.layers.iter().find(|layer| layer.name == name).unwrap().is_stale
    }
}

pub fn operation(json: &Value) -> Operation {
    Operation::from_json(json.clone()).unwrap_or_else(|err| panic!("{json}: {err}"))
}

pub fn name(name: &str) -> LayerReference {
    LayerReference::Name(name.to_owned())
}

/// The terrain as it is on disk, with nothing in memory.
pub fn afresh(path: &Path) -> Terrain {
    Terrain::open_to_read(path, settings()).unwrap()
}

pub fn read(terrain: &Terrain, source: &ExportSource, region_m: Option<[f64; 4]>, level: u8) -> Plane {
    let read = terrain.heights(source, region_m, level);
    let (width, depth, heights) =
        read.unwrap_or_else(|err| panic!("{source:?} of {region_m:?} at level {level}: {err}"));
    Plane::new(width, depth, heights)
}

pub fn composite(terrain: &Terrain, level: u8) -> Plane {
    read(terrain, &ExportSource::Composite, None, level)
}

/// A stack in few words, for whoever looks for what is wrong with it.
pub fn told(layers: &[Layer]) -> String {
    let tell = |layer: &Layer| {
        let mut value = serde_json::to_value(layer).unwrap();
        if let Some(procedure) = layer.content.procedure() {
            value["content"] =
                format!("{}: {}", layer.content.name(), procedure.brush.brush_type.name()).into();
        }
        value.to_string()
    };
    layers.iter().map(tell).collect::<Vec<_>>().join("\n")
}

/// A fill of a layer's heights with a noise of some metres.
pub fn fill(layer: &str, strength_m: f64, seed: u32) -> Value {
    json!({"op": "fill", "layer": layer, "brush": noise(strength_m, seed)})
}

pub fn noise(strength_m: f64, seed: u32) -> Value {
    json!({"type": "noise", "strength": strength_m, "feature_size": 1500, "octaves": 4, "seed": seed})
}

/// A dab of a brush.
pub fn dab(layer: &str, target: &str, brush_type: &str, radius_m: f64, at_m: [f64; 2]) -> Value {
    let mut brush = json!({"type": brush_type, "radius": radius_m});
    if brush_type == "raise" {
        brush["strength"] = json!(60.0);
    }
    json!({"op": "stroke", "layer": layer, "target": target, "brush": brush, "points": [at_m]})
}

/// Fails unless all samples have the same bits.
pub fn assert_same(expected: &Plane, found: &Plane, what: &str) {
    compare::bit_equal(expected, found).unwrap_or_else(|mismatch| panic!("{what}: {mismatch}"));
}

pub fn assert_all_same(expected: &[Plane], found: &[Plane], what: &str) {
    assert_eq!(expected.len(), found.len(), "{what}");
    for (level, (expected, found)) in expected.iter().zip(found).enumerate() {
        assert_same(expected, found, &format!("{what}, level {level}"));
    }
}

/// Fails unless the two differ somewhere: what was done did something.
pub fn assert_differs(before: &Plane, after: &Plane, what: &str) {
    assert!(compare::bit_equal(before, after).is_err(), "{what}: nothing came of it");
}

/// Fails where samples are further apart than `tolerance_m`; gives how far the worst are.
pub fn assert_near(expected: &Plane, found: &Plane, tolerance_m: f64, what: &str) -> f64 {
    let tolerance = Tolerance { absolute_m: tolerance_m, ..Tolerance::EXACT };
    let agreement = compare::within(expected, found, |_, _| tolerance);
    agreement.unwrap_or_else(|mismatch| panic!("{what}: {mismatch}")).worst.distance_m()
}

/// From the lowest to the highest height of a plane.
pub fn range_m(plane: &Plane) -> f64 {
    let lowest = plane.samples().iter().copied().fold(f32::INFINITY, f32::min);
    let highest = plane.samples().iter().copied().fold(f32::NEG_INFINITY, f32::max);
    f64::from(highest) - f64::from(lowest)
}

#[test]
#[should_panic(expected = "a bit: ")]
fn a_bit_that_differs_is_seen() {
    let plane = Plane::from_fn(5, 4, |x, z| (x * z) as f32);
    let mut other = plane.clone();
    other.samples_mut()[7] = -other.samples()[7];
    other.samples_mut()[0] = -0.0;
    assert_same(&plane, &other, "a bit");
}

#[test]
#[should_panic(expected = "apart: ")]
fn what_is_too_far_apart_is_seen() {
    let plane = Plane::from_fn(5, 4, |x, z| (x * z) as f32);
    let other = Plane::from_fn(5, 4, |x, z| (x * z) as f32 + if x == 4 { 0.011 } else { 0.009 });
    assert_near(&plane, &plane, 0.0, "the same");
    assert_near(&plane, &other, 0.01, "apart");
}

#[test]
#[should_panic(expected = "nothing came of it")]
fn what_did_nothing_is_seen() {
    let plane = Plane::from_fn(5, 4, |x, z| (x * z) as f32);
    assert_differs(&plane, &plane.clone(), "the same");
}

#[test]
#[should_panic(expected = "levels")]
fn a_level_too_few_is_seen() {
    let plane = Plane::from_fn(5, 4, |x, z| (x * z) as f32);
    assert_all_same(&[plane.clone(), plane.clone()], &[plane], "levels");
}
