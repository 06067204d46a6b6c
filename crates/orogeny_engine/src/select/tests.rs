use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::Arc;

use orogeny_field::{Blend, FieldId, LayerContent, LayerTransform, PageLayout, hash};

use super::*;
use crate::composite::FieldPages;
use crate::{Error, Operation, Progress, Quiet, Settings, Terrain};

const HEIGHTS: FieldId = FieldId(1);
const MASK: FieldId = FieldId(2);
const SELECTION: FieldId = FieldId(3);

/// Stored pages in memory.
struct Memory {
    layout: PageLayout,
    pages: BTreeMap<PageKey, Arc<Page>>,
}

impl FieldPages for Memory {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn selection(&mut self) -> Result<Option<FieldId>> {
        Ok(Some(SELECTION))
    }

    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>> {
        Ok(keys.iter().map(|key| self.pages.get(key).cloned()).collect())
    }

    fn blob(&mut self, _hash: orogeny_store::BlobHash) -> Result<Vec<u8>> {
        panic!("no test has a picture")
    }
}

/// A terrain whose selection, heights and mask are functions of the place; there are no pages where they are 0.
struct Scene {
    grid: TerrainGrid,
    memory: Memory,
    layer: Layer,
    compositor: Compositor,
}

fn layer() -> Layer {
    Layer {
        id: 5,
        position: 0,
        name: "Base".to_owned(),
        heights: HEIGHTS,
        constant_m: 0.0,
        mask: Some(MASK),
        mask_constant: 0.0,
        mask_terms: Vec::new(),
        visible: true,
        locked: false,
        opacity: 1.0,
        blend: Blend::Add,
        content: LayerContent::Heights,
        transform: LayerTransform::default(),
        group: None,
        made_of: None,
        made_mask: None,
    }
}

impl Scene {
    fn new(width: u64, depth: u64, page_size: u32) -> Self {
        let layout = PageLayout::new(page_size).unwrap();
        let memory = Memory { layout, pages: BTreeMap::new() };
        let compositor = Compositor::new(&Settings { adapter: crate::Adapter::Cpu, ..Settings::default() });
        let grid = TerrainGrid::new(width, depth, 2.0).unwrap();
        Self { grid, memory, layer: layer(), compositor }
    }

    /// Paints a field within a rectangle.
    fn paint(&mut self, field: FieldId, rect: SampleRect, value: impl Fn(i32, i32) -> f32) {
        let layout = self.memory.layout;
        for (x, z) in layout.pages_in(rect) {
            let key = PageKey::full_resolution(field, x, z);
            let page_rect = layout.page_rect(&key);
            let mut page = Page::constant(layout, 0.0);
            let both = page_rect.intersection(&rect).intersection(&self.grid.bounds());
            for z in both.z0..both.z1 {
                let columns = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
                let row = page.row_mut(z.abs_diff(page_rect.z0), columns.0, columns.1).unwrap();
                for (x, sample) in (both.x0..).zip(row) {
                    *sample = value(x, z);
                }
            }
            self.memory.pages.insert(key, Arc::new(page));
        }
    }

    /// The same things on pages of any size: spots of a selection, hills, and a mask.
    fn painted(width: u64, depth: u64, page_size: u32) -> Self {
        let mut scene = Self::new(width, depth, page_size);
        // On many page sizes whole pages of it.
        scene.paint(SELECTION, SampleRect::new(0, 0, 256, 128), spot);
        scene.paint(HEIGHTS, scene.grid.bounds(), height);
        scene.paint(MASK, SampleRect::new(0, 0, 128, 256), |x, _| mask(x));
        scene
    }

    fn plan(&mut self, selecting: &Selecting) -> Result<Plan> {
        let keys =
            |field: FieldId| self.memory.pages.keys().filter(|key| key.field == field).copied().collect();
        let painted = Painted { selection: keys(SELECTION), mask: keys(MASK) };
        let look = &mut Look::new(self.grid, 0, &mut self.memory)?;
        let layers = std::slice::from_ref(&self.layer);
        Plan::new(selecting, look, layers, composite::selection(SELECTION), &painted)
    }

    /// Does a change, and gives the keys of what was written.
    fn run(&mut self, plan: &Plan) -> Result<Vec<PageKey>> {
        let layers = std::slice::from_ref(&self.layer);
        let nodes = self.compositor.nodes(layers, &mut self.memory)?;
        let mut written = Vec::new();
        for block in &plan.blocks {
            let look = Look::new(self.grid, 0, &mut self.memory)?;
            let mut ground = Ground { look, compositor: &mut self.compositor, nodes: &nodes };
            written.extend(plan.work_out(&mut ground, block)?);
        }
        let keys = written.iter().map(|(key, _)| *key).collect();
        self.memory.pages.extend(written.into_iter().map(|(key, page)| (key, Arc::new(page))));
        Ok(keys)
    }

    fn select(&mut self, text: &str) -> Result<Vec<PageKey>> {
        let plan = self.plan(&serde_json::from_str(text).unwrap())?;
        self.run(&plan)
    }

    fn selected(&self, x: i32, z: i32) -> f32 {
        let size = self.memory.layout.size().cast_signed();
        let [page_x, page_z] = [x, z].map(|place| (place / size).unsigned_abs());
        let page = self.memory.pages.get(&PageKey::full_resolution(SELECTION, page_x, page_z));
        let [x, z] = [x, z].map(|place| (place % size).unsigned_abs());
        page.map_or(0.0, |page| page.row(z, x, x + 1).unwrap()[0])
    }

    fn selection(&self) -> Vec<f32> {
        let bounds = self.grid.bounds();
        (0..bounds.z1).flat_map(|z| (0..bounds.x1).map(move |x| self.selected(x, z))).collect()
    }
}

fn spot(x: i32, z: i32) -> f32 {
    let random = |salt| hash::uniform(x.unsigned_abs(), z.unsigned_abs(), salt).abs();
    match random(1) {
        spot if spot < 0.01 => random(2),
        spot if spot < 0.03 || (x / 40 + z / 30) % 5 == 2 => 1.0,
        _ => 0.0,
    }
}

fn height(x: i32, z: i32) -> f32 {
    let (x, z) = (x as f32, z as f32);
    40.0 * (x / 9.0).sin() + 30.0 * (z / 13.0).cos() + 0.2 * x
}

fn mask(x: i32) -> f32 {
    if x < 128 { (x % 7) as f32 / 6.0 } else { 0.0 }
}

const SHAPES: [&str; 9] = [
    r#"{"all": true}"#,
    r#"{"nothing": true}"#,
    r#"{"keep": true}"#,
    r#"{"rectangle": [-10, 41, 100, 83]}"#,
    r#"{"lasso": [[30, -50], [290, 77.5], [11, 200], [200, 20], [250, 260]]}"#,
    r#"{"gate": {"slope": {"min": 50, "max": 90, "feather": 20}, "noise": {"min": -0.3, "max": 0.8, "pattern": {"feature_size": 40}}}}"#,
    r#"{"gate": {"height": {"min": 10, "max": 80}, "selection": true, "inverted": true}, "region": [60, 10, 170, 133]}"#,
    r#"{"mask": "Base"}"#,
    r#"{"mask": 5, "region": [8, 20, 300, 100]}"#,
];

/// All shapes, joined in all ways, with some of what may follow.
fn all_selections() -> Vec<Selecting> {
    let mut selections = Vec::new();
    for shape in SHAPES {
        for combine in ["replace", "add", "subtract", "intersect"] {
            for after in [
                "",
                r#", "grow": 9"#,
                r#", "shrink": 4.1"#,
                r#", "feather": 5"#,
                r#", "grow": 5, "shrink": 7, "feather": 3, "invert": true"#,
                r#", "invert": true"#,
            ] {
                let text = format!(r#"{{"shape": {shape}, "combine": "{combine}"{after}}}"#);
                selections.push(serde_json::from_str(&text).unwrap());
            }
        }
    }
    selections
}

fn assert_same_bits(a: &[f32], b: &[f32], what: &impl std::fmt::Debug) {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()), "{what:?}");
}

#[test]
fn neither_pages_nor_blocks_change_a_bit() {
    for selecting in all_selections() {
        let mut whole = Scene::painted(157, 118, 256);
        let plan = whole.plan(&selecting).unwrap();
        whole.run(&plan).unwrap();
        for page_size in [64, 128] {
            let mut scene = Scene::painted(157, 118, page_size);
            let mut plan = scene.plan(&selecting).unwrap();
            if page_size == 64 {
                // Each page by itself.
                plan.blocks = plan.blocks.iter().flatten().map(|key| vec![*key]).collect();
            }
            scene.run(&plan).unwrap();
            assert_same_bits(&scene.selection(), &whole.selection(), &selecting);
        }
    }
}

#[test]
fn only_pages_that_are_planned_would_change() {
    for selecting in all_selections() {
        let mut scene = Scene::painted(500, 270, 64);
        let plan = scene.plan(&selecting).unwrap();
        let planned: BTreeSet<PageKey> = plan.blocks.iter().flatten().copied().collect();
        assert_eq!(planned.len(), plan.blocks.iter().map(Vec::len).sum::<usize>(), "none twice");
        let everywhere = scene.memory.layout.pages_in(scene.grid.bounds());
        let everywhere = everywhere.map(|(x, z)| vec![PageKey::full_resolution(SELECTION, x, z)]);
        let all = Plan { blocks: everywhere.collect(), ..scene.plan(&selecting).unwrap() };
        let written = scene.run(&all).unwrap();
        assert!(written.iter().all(|key| planned.contains(key)), "{selecting:?}");
    }
}

/// A selection by its definition, sample by sample, at the terrain mirrored.
struct Defined {
    width: i32,
    depth: i32,
    values: Vec<f64>,
}

impl Defined {
    fn at(&self, x: i32, z: i32) -> f64 {
        let (x, z) = (mirrored(x, self.width.unsigned_abs()), mirrored(z, self.depth.unsigned_abs()));
        self.values[(z * self.width + x) as usize]
    }

    fn map(&mut self, value: impl Fn(&Self, i32, i32) -> f64) {
        let places = (0..self.depth).flat_map(|z| (0..self.width).map(move |x| (x, z)));
        self.values = places.map(|(x, z)| value(self, x, z)).collect();
    }

    fn spread(&mut self, radius: f64, better: fn(f64, f64) -> f64) {
        let reach = radius as i32;
        self.map(|this, x, z| {
            let around = (-reach..=reach).flat_map(|dz| (-reach..=reach).map(move |dx| (dx, dz)));
            let within = around.filter(|(dx, dz)| f64::from(dx * dx + dz * dz) <= radius * radius);
            within.map(|(dx, dz)| this.at(x + dx, z + dz)).reduce(better).unwrap()
        });
    }

    fn feather(&mut self, sigma: f64) {
        let reach = (4.0 * sigma + 0.5) as i32;
        let weight = |away: i32| (-0.5 * (f64::from(away) / sigma).powi(2)).exp();
        let sum: f64 = (-reach..=reach).map(weight).sum();
        let mean =
            |value: &dyn Fn(i32) -> f64| (-reach..=reach).map(|away| weight(away) / sum * value(away)).sum();
        self.map(|this, x, z| mean(&|away| this.at(x + away, z)));
        self.map(|this, x, z| mean(&|away| this.at(x, z + away)));
    }
}

#[test]
fn a_selection_is_what_its_definition_says() {
    // Spacing 2 m: a rectangle from 20 to 160 m and from 10 to 70 m.
    let is_inside = |x: i32, z: i32| (10..80).contains(&x) && (5..35).contains(&z);
    for (combine, number) in ["replace", "add", "subtract", "intersect"].into_iter().zip(0..) {
        for [grow, shrink, feather] in [[0, 0, 0], [13, 0, 0], [0, 7, 0], [0, 0, 9], [6, 14, 5]] {
            for invert in [false, true] {
                let mut scene = Scene::painted(157, 118, 64);
                let mut defined = Defined { width: 157, depth: 118, values: Vec::new() };
                defined.map(|_, x, z| {
                    let before = if x < 256 && z < 128 { f64::from(spot(x, z)) } else { 0.0 };
                    let shape = f64::from(u8::from(is_inside(x, z)));
                    [shape, shape.max(before), before * (1.0 - shape), before * shape][number]
                });
                defined.spread(f64::from(grow) / 2.0, f64::max);
                defined.spread(f64::from(shrink) / 2.0, f64::min);
                if feather > 0 {
                    defined.feather(f64::from(feather) / 2.0);
                }
                if invert {
                    defined.map(|this, x, z| 1.0 - this.at(x, z));
                }
                let text = format!(
                    r#"{{"shape": {{"rectangle": [20, 10, 140, 60]}}, "combine": "{combine}",
                        "grow": {grow}, "shrink": {shrink}, "feather": {feather}, "invert": {invert}}}"#
                );
                scene.select(&text).unwrap();
                for (found, defined) in scene.selection().into_iter().zip(&defined.values) {
                    assert!((f64::from(found) - defined).abs() < 1.0e-6, "{text}: {found} and not {defined}");
                }
            }
        }
    }
}

#[test]
fn shapes_select_what_they_name() {
    let mut scene = Scene::painted(157, 118, 64);
    let before = scene.selection();
    scene.select(r#"{"shape": {"keep": true}}"#).unwrap();
    assert_same_bits(&scene.selection(), &before, &"keep");
    assert!(
        scene.select(r#"{"shape": {"keep": true}, "combine": "add"}"#).unwrap().is_empty(),
        "nothing changes"
    );
    scene.select(r#"{"shape": {"keep": true}, "invert": true}"#).unwrap();
    scene.select(r#"{"shape": {"keep": true}, "invert": true}"#).unwrap();
    assert!(scene.selection().iter().zip(&before).all(|(a, b)| (a - b).abs() < 1.0e-6));
    scene.select(r#"{"shape": {"mask": 5}}"#).unwrap();
    let all = || (0..118).flat_map(|z| (0..157).map(move |x| (x, z)));
    assert!(all().all(|(x, z)| scene.selected(x, z) == mask(x)));
    scene.select(r#"{"shape": {"gate": {"height": {"min": 20, "max": 1000}}}}"#).unwrap();
    // What is seen of the layer is what its mask leaves.
    assert!(all().all(|(x, z)| (scene.selected(x, z) == 1.0) == (mask(x) * height(x, z) >= 20.0)));
    scene.select(r#"{"shape": {"all": true}}"#).unwrap();
    assert!(scene.selection().iter().all(|value| *value == 1.0));
    assert_eq!(scene.selected(200, 40), 0.0, "beyond the terrain a page keeps its constant");
    scene.select(r#"{"shape": {"nothing": true}}"#).unwrap();
    assert!(scene.selection().iter().all(|value| *value == 0.0));
    assert!(scene.select(r#"{"shape": {"rectangle": [9000, 0, 10, 10]}}"#).unwrap().is_empty());
    // Of a layer without a mask all of it counts.
    scene.layer.mask = None;
    scene.select(r#"{"shape": {"mask": 5}}"#).unwrap();
    assert!(scene.selection().iter().all(|value| *value == 1.0));
}

#[test]
fn on_a_vast_terrain_a_selection_costs_what_it_changes() {
    let mut scene = Scene::new(1 << 20, 1 << 20, 256);
    let at = |x: u32, z: u32| PageKey::full_resolution(SELECTION, x, z);
    // 300 samples within two pages each way, near the far corner.
    let written = scene.select(r#"{"shape": {"rectangle": [2000000, 2000000, 600, 600]}}"#).unwrap();
    assert_eq!(written.len(), 4);
    let lasso = r#"{"shape": {"lasso": [[0, 0], [400, 0], [0, 400]]}, "combine": "add"}"#;
    assert_eq!(scene.select(lasso).unwrap(), [at(0, 0)]);
    let feathered = r#"{"shape": {"keep": true}, "grow": 900, "feather": 40}"#;
    let written = scene.select(feathered).unwrap();
    assert!((20..100).contains(&written.len()), "{}", written.len());
    scene.paint(MASK, SampleRect::new(512, 512, 520, 520), |_, _| 1.0);
    let masked = r#"{"shape": {"mask": 5}, "combine": "intersect", "feather": 2}"#;
    scene.select(masked).unwrap();
    scene.select(r#"{"shape": {"mask": 5}}"#).unwrap();
    assert_eq!(scene.selected(515, 519), 1.0);
    let region = r#"{"shape": {"gate": {"height": {"min": -1, "max": 1}}, "region": [100, 100, 50, 50]}}"#;
    scene.select(region).unwrap();
    assert_eq!((scene.selected(60, 60), scene.selected(515, 519)), (1.0, 0.0));
    for text in [
        r#"{"shape": {"all": true}}"#,
        r#"{"shape": {"keep": true}, "invert": true}"#,
        r#"{"shape": {"gate": {"slope": {"min": 3, "max": 5}}}, "combine": "add"}"#,
        r#"{"shape": {"rectangle": [0, 0, 1000000, 1000000]}}"#,
    ] {
        let err = scene.select(text).unwrap_err();
        assert!(matches!(err, Error::Brush(orogeny_brush::Error::TooManyPages { .. })), "{text}: {err}");
    }
    // What only takes away reaches no page that is not there.
    scene.select(r#"{"shape": {"all": true}, "combine": "intersect"}"#).unwrap();
    scene.select(r#"{"shape": {"all": true}, "combine": "subtract"}"#).unwrap();
    assert_eq!(scene.selected(60, 60), 0.0);
    assert!(scene.select(r#"{"shape": {"nothing": true}}"#).unwrap().is_empty(), "it is nothing already");
}

#[test]
fn what_a_damaged_selection_holds_counts_as_a_selection() {
    let mut scene = Scene::new(64, 64, 64);
    let odd = [f32::NAN, -2.0, 7.0, f32::INFINITY, 0.5];
    scene.paint(SELECTION, scene.grid.bounds(), |x, _| odd[(x % 5).unsigned_abs() as usize]);
    scene.select(r#"{"shape": {"nothing": true}, "combine": "add"}"#).unwrap();
    let expected = [0.0, 0.0, 1.0, 1.0, 0.5];
    // What only adds where there is nothing to add reaches no page.
    assert!(scene.selected(0, 0).is_nan());
    scene.select(r#"{"shape": {"all": true}, "combine": "intersect", "grow": 0.1}"#).unwrap();
    assert!((0..64).all(|x| scene.selected(x, 9) == expected[(x % 5).unsigned_abs() as usize]));
}

/// A terrain in a file, level at 0 m.
fn terrain(folder: &tempfile::TempDir, side: u64) -> Terrain {
    let settings = Settings { adapter: crate::Adapter::Cpu, ..Settings::default() };
    let grid = TerrainGrid::new(side, side, 1.0).unwrap();
    Terrain::create(&folder.path().join("t.orogeny"), grid, 0.0, settings).unwrap()
}

fn operations(texts: &[&str]) -> Vec<Operation> {
    texts.iter().map(|text| Operation::from_json_text(text).unwrap()).collect()
}

/// Notes what it is told, and stops when so many pages are done.
struct Stopping(u64, Vec<Progress>);

impl Observer for Stopping {
    fn progress(&mut self, progress: Progress) -> ControlFlow<()> {
        self.1.push(progress);
        if progress.done >= self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn it_is_told_how_far_it_is_and_may_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain(&folder, 3000);
    let all = operations(&[r#"{"op": "select", "shape": {"all": true}}"#]);
    let mut stopping = Stopping(30, Vec::new());
    let err = terrain.apply(&all, &mut stopping).unwrap_err();
    assert!(matches!(err, Error::Cancelled), "{err}");
    assert!(terrain.log().unwrap().is_empty());
    let told: Vec<_> = stopping.1.iter().map(|progress| (progress.done, progress.total)).collect();
    assert_eq!(told, [(0, 144), (16, 144), (32, 144)]);
    let mut watching = Stopping(u64::MAX, Vec::new());
    assert_eq!(terrain.apply(&all, &mut watching).unwrap()[0].num_pages, 144);
    assert_eq!(watching.1.last().map(|progress| progress.done), Some(144));
    // It is as it was asked to be: no page changes.
    assert_eq!(terrain.apply(&all, &mut Quiet).unwrap()[0].num_pages, 0);
}

#[test]
fn what_is_seen_follows_the_selection_that_a_layer_looks_at() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain(&folder, 300);
    let made = operations(&[
        r#"{"op": "add_layer", "name": "Mesa", "height": 50, "mask": [{"gate": {"selection": true}}]}"#,
        r#"{"op": "select", "shape": {"rectangle": [20, 20, 100, 100]}}"#,
    ]);
    terrain.apply(&made, &mut Quiet).unwrap();
    let heights = |terrain: &Terrain| {
        [[30.0, 30.0], [119.0, 119.0], [120.0, 119.0], [129.0, 70.0], [131.0, 70.0]]
            .map(|place| terrain.height_m(place).unwrap())
    };
    assert_eq!(heights(&terrain), [50.0, 50.0, 0.0, 0.0, 0.0]);
    // Through a gate by the heights that the selection itself makes, as they were before.
    let higher = r#"{"op": "select", "shape": {"gate": {"height": {"min": 25, "max": 100}}}, "grow": 10}"#;
    terrain.apply(&operations(&[higher]), &mut Quiet).unwrap();
    assert_eq!(heights(&terrain), [50.0, 50.0, 50.0, 50.0, 0.0]);
    terrain.apply(&operations(&[higher, higher]), &mut Quiet).unwrap();
    assert_eq!(heights(&terrain), [50.0; 5]);
    terrain.undo(3).unwrap();
    assert_eq!(heights(&terrain), [50.0, 50.0, 0.0, 0.0, 0.0]);
}
