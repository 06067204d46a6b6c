//! The open terrain: its file, its executor, its history.

use std::collections::BTreeSet;
use std::path::Path;

use orogeny_brush::Executor;
use orogeny_field::{FieldId, PageKey, PageLayout, SampleRect, TerrainGrid};
use orogeny_store::{Change, Entry, HistorySummary, Layer, NewLayer, NewTerrain, Store};

use crate::backend::{self, Settings};
use crate::composite::{Composite, Source};
use crate::progress::report;
use crate::{Error, LayerReference, Observer, Result};

/// The name of the layer that a new terrain has.
pub(crate) const BASE_LAYER: &str = "Base";

/// An open terrain file and what works on it.
pub struct Terrain {
    store: Store,
    settings: Settings,
    /// Made when the first operation needs it.
    executor: Option<Box<dyn Executor>>,
}

impl std::fmt::Debug for Terrain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Terrain")
            .field("store", &self.store)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// A terrain in numbers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Description {
    /// Samples along x.
    pub width: u32,
    /// Samples along z.
    pub depth: u32,
    /// Metres between samples.
    pub spacing_m: f64,
    /// Metres along x.
    pub width_m: f64,
    /// Metres along z.
    pub depth_m: f64,
    /// Samples a side of a page.
    pub page_size: u32,
    /// From the bottom.
    pub layers: Vec<LayerDescription>,
    /// What was done, in numbers.
    pub history: HistorySummary,
    /// Bytes on disk, with the database's log.
    pub file_size_in_bytes: u64,
}

/// A layer in numbers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LayerDescription {
    /// Never used twice.
    pub id: u32,
    /// What the user calls it.
    pub name: String,
    /// Height where it has no page, in metres.
    pub constant_m: f32,
    /// Whether it counts.
    pub visible: bool,
    /// How much it counts, 0..1.
    pub opacity: f32,
    /// Pages that were painted.
    pub num_pages: usize,
}

/// Lowest, highest and mean height of a terrain, in metres.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct HeightStatistics {
    /// Lowest.
    pub min_m: f32,
    /// Highest.
    pub max_m: f32,
    /// Mean.
    pub mean_m: f64,
}

impl Terrain {
    /// Makes a flat terrain of one layer at `height_m`.
    ///
    /// # Errors
    /// [`Error::Store`] when a file is there already or cannot be made; nothing is left behind then.
    pub fn create(path: &Path, grid: TerrainGrid, height_m: f32, settings: Settings) -> Result<Self> {
        let base = NewLayer { name: BASE_LAYER.to_owned(), constant_m: height_m };
        let new = NewTerrain { grid, layout: PageLayout::default(), layers: vec![base] };
        Ok(Self { store: Store::create(path, &new)?, settings, executor: None })
    }

    /// Opens a terrain. Takes no longer for a large one.
    ///
    /// # Errors
    /// [`Error::Store`] when the file is not there, is no terrain, is damaged or comes from a newer version.
    pub fn open(path: &Path, settings: Settings) -> Result<Self> {
        Ok(Self { store: Store::open(path)?, settings, executor: None })
    }

    /// Closes the terrain, which is one file then.
    ///
    /// # Errors
    /// [`Error::Store`] when the database's log could not be brought into the file; nothing is lost then.
    pub fn close(self) -> Result<()> {
        Ok(self.store.close()?)
    }

    /// Size and spacing.
    #[must_use]
    pub fn grid(&self) -> TerrainGrid {
        self.store.grid()
    }

    /// The layers, from the bottom.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        self.store.layers()
    }

    /// The layer of a reference; the lowest for none.
    ///
    /// # Errors
    /// [`Error::UnknownLayer`].
    pub fn layer(&self, reference: Option<&LayerReference>) -> Result<&Layer> {
        find_layer(self.store.layers(), reference)
    }

    /// What does the work, for people: the CPU back end or a GPU.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the adapter asked for cannot be used.
    pub fn backend_description(&mut self) -> Result<String> {
        Ok(self.store_and_executor()?.1.description())
    }

    /// The terrain in numbers.
    ///
    /// # Errors
    /// [`Error::Store`] when the file cannot be read.
    pub fn describe(&self) -> Result<Description> {
        let grid = self.grid();
        let layers = self.store.layers().iter().map(|layer| {
            Ok(LayerDescription {
                id: layer.id,
                name: layer.name.clone(),
                constant_m: layer.constant_m,
                visible: layer.visible,
                opacity: layer.opacity,
                num_pages: self.store.page_keys(layer.heights)?.len(),
            })
        });
        Ok(Description {
            width: grid.width(),
            depth: grid.depth(),
            spacing_m: grid.spacing_m(),
            width_m: f64::from(grid.width()) * grid.spacing_m(),
            depth_m: f64::from(grid.depth()) * grid.spacing_m(),
            page_size: self.store.layout().size(),
            layers: layers.collect::<Result<_>>()?,
            history: self.store.history_summary()?,
            file_size_in_bytes: self.store.file_size_in_bytes()?,
        })
    }

    /// The height of the composite at the sample nearest to a place in metres, clamped to the terrain.
    ///
    /// # Errors
    /// [`Error::Store`] when the page cannot be read.
    pub fn height_m(&self, place_m: [f64; 2]) -> Result<f32> {
        let bounds = self.grid().bounds();
        let [x, z] = self.grid().sample_from_world(place_m).map(f64::round);
        let (x, z) = ((x as i32).clamp(0, bounds.x1 - 1), (z as i32).clamp(0, bounds.z1 - 1));
        let mut height_m = [0.0];
        let sample = SampleRect::new(x, z, x + 1, z + 1);
        self.composite(Source::Composite, sample).read_rows(&mut height_m)?;
        let [height_m] = height_m;
        Ok(height_m)
    }

    /// Lowest, highest and mean height of the composite. Reads every painted page, and no other.
    ///
    /// # Errors
    /// [`Error::Store`] when a page cannot be read; [`Error::Cancelled`].
    pub fn height_statistics(&self, observer: &mut dyn Observer) -> Result<HeightStatistics> {
        let bounds = self.grid().bounds();
        let painted = self.painted_rects(bounds)?;
        let (mut min_m, mut max_m, mut sum_m) = (f32::INFINITY, f32::NEG_INFINITY, 0.0_f64);
        let mut num_samples = 0;
        for (index, rect) in painted.iter().enumerate() {
            let mut heights = vec![0.0; usize::try_from(rect.area()).unwrap_or_default()];
            self.composite(Source::Composite, *rect).read_rows(&mut heights)?;
            for height_m in &heights {
                min_m = min_m.min(*height_m);
                max_m = max_m.max(*height_m);
                sum_m += f64::from(*height_m);
            }
            num_samples += rect.area();
            report(observer, "measuring", index as u64 + 1, painted.len() as u64)?;
        }
        if num_samples < bounds.area() {
            let unpainted_m = self.unpainted_height_m();
            min_m = min_m.min(unpainted_m);
            max_m = max_m.max(unpainted_m);
            sum_m += f64::from(unpainted_m) * (bounds.area() - num_samples) as f64;
        }
        Ok(HeightStatistics { min_m, max_m, mean_m: sum_m / bounds.area() as f64 })
    }

    /// What of a rectangle is painted on any visible layer, page by page.
    pub(crate) fn painted_rects(&self, rect: SampleRect) -> Result<Vec<SampleRect>> {
        let layout = self.store.layout();
        let mut places = BTreeSet::new();
        for layer in self.store.layers().iter().filter(|layer| layer.visible) {
            let keys = self.store.page_keys(layer.heights)?;
            places.extend(keys.into_iter().filter(|key| key.level == 0).map(|key| (key.z, key.x)));
        }
        let any_field = FieldId(0);
        let rects = places
            .into_iter()
            .map(|(z, x)| layout.page_rect(&PageKey::full_resolution(any_field, x, z)).intersection(&rect));
        Ok(rects.filter(|rect| !rect.is_empty()).collect())
    }

    /// The composite where nothing is painted.
    pub(crate) fn unpainted_height_m(&self) -> f32 {
        let mut visible = self.store.layers().iter().filter(|layer| layer.visible);
        let lowest_m = visible.next().map_or(0.0, |layer| layer.constant_m);
        visible.fold(lowest_m, |height_m, layer| height_m + layer.opacity * layer.constant_m)
    }

    /// Undoes up to `count` operations, bit for bit; fewer where the history begins.
    ///
    /// # Errors
    /// [`Error::Store`]; the terrain is then as it was.
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        let changes = self.store.undo(count)?;
        self.forget(&changes);
        Ok(changes)
    }

    /// Does up to `count` undone operations again, bit for bit.
    ///
    /// # Errors
    /// [`Error::Store`]; the terrain is then as it was.
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        let changes = self.store.redo(count)?;
        self.forget(&changes);
        Ok(changes)
    }

    /// What was done, oldest first, with what was undone and what was left behind.
    ///
    /// # Errors
    /// [`Error::Store`] when the history cannot be read.
    pub fn log(&self) -> Result<Vec<Entry>> {
        Ok(self.store.log()?)
    }

    fn forget(&mut self, changes: &[Change]) {
        if self.store.take_was_moved_by_others()
            && let Some(executor) = &mut self.executor
        {
            executor.cancel();
        }
        changes.iter().for_each(|change| self.forget_pages(&change.pages));
    }

    /// The executor's pages are no longer those of the file.
    pub(crate) fn forget_pages(&mut self, keys: &[PageKey]) {
        if let Some(executor) = &mut self.executor {
            executor.forget(keys);
        }
    }

    /// Removes a terrain that was only just made and did not come to anything.
    pub(crate) fn remove(self) {
        let path = self.store.path().to_owned();
        drop(self);
        if let Err(err) = std::fs::remove_file(&path) {
            tracing::warn!("`{}` was left behind: {err}", path.display());
        }
    }

    pub(crate) const fn settings(&self) -> &Settings {
        &self.settings
    }

    pub(crate) const fn store_mut(&mut self) -> &mut Store {
        &mut self.store
    }

    /// Heights of a rectangle, row by row.
    pub(crate) fn composite(&self, source: Source, rect: SampleRect) -> Composite<'_> {
        Composite::new(&self.store, source, rect)
    }

    pub(crate) fn store_and_executor(&mut self) -> Result<(&mut Store, &mut dyn Executor)> {
        let executor = match &mut self.executor {
            Some(executor) => executor,
            none => none.insert(backend::executor(&self.settings, self.store.layout())?),
        };
        Ok((&mut self.store, executor.as_mut()))
    }

    #[cfg(test)]
    pub(crate) fn set_executor(&mut self, executor: Box<dyn Executor>) {
        self.executor = Some(executor);
    }

    pub(crate) fn drop_executor(&mut self) {
        self.executor = None;
    }
}

/// The layer of a reference; the lowest for none.
pub(crate) fn find_layer<'a>(layers: &'a [Layer], reference: Option<&LayerReference>) -> Result<&'a Layer> {
    let found = match reference {
        None => layers.first(),
        Some(LayerReference::Id(id)) => layers.iter().find(|layer| layer.id == *id),
        Some(LayerReference::Name(name)) => layers.iter().find(|layer| layer.name == *name),
    };
    found.ok_or_else(|| {
        let known: Vec<_> = layers.iter().map(|layer| format!("`{}` ({})", layer.name, layer.id)).collect();
        let layer = match reference {
            Some(LayerReference::Id(id)) => format!("with the id {id}"),
            Some(LayerReference::Name(name)) => format!("`{name}`"),
            None => "at all".to_owned(),
        };
        Error::UnknownLayer { layer, known: known.join(", ") }
    })
}
