//! The open terrain: its file, its executor, its history.

use std::collections::BTreeSet;
use std::path::Path;

use orogeny_brush::Executor;
use orogeny_field::{FieldId, PageKey, PageLayout, SampleRect, TerrainGrid};
use orogeny_store::{
    Change, CheckReport, Dropped, Entry, EntryId, HistorySummary, Layer, NewLayer, NewTerrain, Recorder,
    Repaired, Salvaged, Store,
};

use crate::access::{Access, band_bytes, open_to_write, up_to_date};
use crate::backend::{self, Settings};
use crate::composite::{Composite, Source};
use crate::progress::report;
use crate::{Error, LayerReference, Observer, Result};

/// The name of the layer that a new terrain has.
pub(crate) const BASE_LAYER: &str = "Base";

/// An open terrain file and what works on it.
pub struct Terrain {
    access: Access,
    grid: TerrainGrid,
    settings: Settings,
    /// Made when the first operation needs it.
    executor: Option<Box<dyn Executor>>,
}

impl std::fmt::Debug for Terrain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Terrain")
            .field("access", &self.access)
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
    /// How many times it was committed.
    pub num_commits: u64,
    /// Levels above full resolution.
    pub num_levels_above: u8,
    /// What it takes in memory.
    pub memory: MemoryUse,
}

/// What a terrain keeps in memory, counted, and what it may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct MemoryUse {
    /// Bytes that pages may take, in memory or in textures.
    pub budget_in_bytes: u64,
    /// Bytes of pages that the back end keeps in memory.
    pub pages_in_bytes: u64,
    /// Bytes of textures that the back end keeps pages in.
    pub textures_in_bytes: u64,
    /// Bytes of pages on their way to the file, and of those that the store remembers.
    pub store_in_bytes: u64,
}

impl MemoryUse {
    /// All that is counted against the budget, textures not counted.
    #[must_use]
    pub const fn total_in_bytes(&self) -> u64 {
        self.pages_in_bytes + self.store_in_bytes
    }
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
    pub num_pages: u64,
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
        // What stops here leaves a terrain behind that no one asked for.
        Self::writing(Store::create(path, &new)?, settings).inspect_err(|_| _ = std::fs::remove_file(path))
    }

    /// Opens a terrain for writing. Takes no longer for a large one.
    ///
    /// # Errors
    /// [`Error::Store`] when the file is not there, is no terrain, is damaged or comes from a newer version, or when someone
    /// else has it open for writing.
    pub fn open(path: &Path, settings: Settings) -> Result<Self> {
        Self::writing(open_to_write(path)?, settings)
    }

    /// Opens a terrain for reading, beside whoever writes it: it shows what was last committed.
    ///
    /// # Errors
    /// [`Error::Store`] when the file is not there, is no terrain, is damaged or comes from a newer version.
    pub fn open_to_read(path: &Path, settings: Settings) -> Result<Self> {
        Self::of(Access::reading(path)?, settings)
    }

    fn writing(store: Store, settings: Settings) -> Result<Self> {
        Self::of(Access::writing(store, settings.page_budget_in_bytes)?, settings)
    }

    pub(crate) fn of(access: Access, settings: Settings) -> Result<Self> {
        let grid = access.on_disk()?.grid();
        Ok(Self { access, grid, settings, executor: None })
    }

    /// Reads and verifies everything of a terrain file.
    ///
    /// # Errors
    /// [`Error::Store`] when the file cannot be read at all. Damage is no error: it is what the report lists.
    pub fn check(path: &Path) -> Result<CheckReport> {
        Ok(up_to_date(path, Store::check_file)?)
    }

    /// Makes a damaged terrain usable again, as far as what is left of it allows: see [`Repaired`].
    ///
    /// # Errors
    /// [`Error::Store`] when the file cannot be opened for writing or written.
    pub fn repair(path: &Path) -> Result<Repaired> {
        Ok(Store::repair(path)?)
    }

    /// Copies what can be read of a damaged terrain into a new one.
    ///
    /// # Errors
    /// [`Error::Store`] when nothing can be read, or there is a file at `to` already.
    pub fn salvage(from: &Path, to: &Path) -> Result<Salvaged> {
        Ok(Store::salvage(from, to)?)
    }

    /// Closes the terrain, which is one file then.
    ///
    /// # Errors
    /// [`Error::Store`] when the database's log could not be brought into the file; nothing is lost then.
    pub fn close(self) -> Result<()> {
        self.access.close()
    }

    /// Size and spacing.
    #[must_use]
    pub const fn grid(&self) -> TerrainGrid {
        self.grid
    }

    /// The layers, from the bottom.
    ///
    /// # Errors
    /// [`Error::Store`] once the terrain was closed in the background.
    pub fn layers(&self) -> Result<&[Layer]> {
        Ok(self.store()?.layers())
    }

    /// The layer of a reference; the lowest for none.
    ///
    /// # Errors
    /// [`Error::UnknownLayer`].
    pub fn layer(&self, reference: Option<&LayerReference>) -> Result<&Layer> {
        find_layer(self.layers()?, reference)
    }

    /// What does the work, for people: the CPU back end or a GPU.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the adapter asked for cannot be used.
    pub fn backend_description(&mut self) -> Result<String> {
        Ok(self.recorder_and_executor()?.1.description())
    }

    /// The terrain in numbers.
    ///
    /// # Errors
    /// [`Error::Store`] when the file cannot be read.
    pub fn describe(&self) -> Result<Description> {
        let (grid, store) = (self.grid(), self.settled()?);
        let layers = store.layers().iter().map(|layer| {
            Ok(LayerDescription {
                id: layer.id,
                name: layer.name.clone(),
                constant_m: layer.constant_m,
                visible: layer.visible,
                opacity: layer.opacity,
                num_pages: store.num_pages(layer.heights)?,
            })
        });
        Ok(Description {
            width: grid.width(),
            depth: grid.depth(),
            spacing_m: grid.spacing_m(),
            width_m: f64::from(grid.width()) * grid.spacing_m(),
            depth_m: f64::from(grid.depth()) * grid.spacing_m(),
            page_size: store.layout().size(),
            layers: layers.collect::<Result<_>>()?,
            history: store.history_summary()?,
            file_size_in_bytes: store.file_size_in_bytes()?,
            num_commits: store.num_commits()?,
            num_levels_above: store.layout().top_level(&grid),
            memory: self.memory(),
        })
    }

    /// What the terrain takes in memory now.
    #[must_use]
    pub fn memory(&self) -> MemoryUse {
        let executor = self.executor.as_ref().map(|executor| executor.memory()).unwrap_or_default();
        MemoryUse {
            budget_in_bytes: self.settings.page_budget_in_bytes,
            pages_in_bytes: executor.host_in_bytes,
            textures_in_bytes: executor.textures_in_bytes,
            store_in_bytes: self.access.memory_in_bytes(),
        }
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
        self.composite(Source::Composite, 0, sample)?.read_rows(&mut height_m)?;
        let [height_m] = height_m;
        Ok(height_m)
    }

    /// Lowest, highest and mean height of the composite. Reads every painted page, and no other.
    ///
    /// # Errors
    /// [`Error::Store`] when a page cannot be read; [`Error::Cancelled`].
    pub fn height_statistics(&self, observer: &mut dyn Observer) -> Result<HeightStatistics> {
        let bounds = self.grid().bounds();
        let _unchanging = self.settled()?.snapshot()?;
        let painted = self.painted_rects(0, bounds)?;
        let (mut min_m, mut max_m, mut sum_m) = (f32::INFINITY, f32::NEG_INFINITY, 0.0_f64);
        let mut num_samples = 0;
        for (index, rect) in painted.iter().enumerate() {
            let mut heights = vec![0.0; usize::try_from(rect.area()).unwrap_or_default()];
            self.composite(Source::Composite, 0, *rect)?.read_rows(&mut heights)?;
            for height_m in &heights {
                min_m = min_m.min(*height_m);
                max_m = max_m.max(*height_m);
                sum_m += f64::from(*height_m);
            }
            num_samples += rect.area();
            report(observer, "measuring", index as u64 + 1, painted.len() as u64)?;
        }
        if num_samples < bounds.area() {
            let unpainted_m = self.unpainted_height_m()?;
            min_m = min_m.min(unpainted_m);
            max_m = max_m.max(unpainted_m);
            sum_m += f64::from(unpainted_m) * (bounds.area() - num_samples) as f64;
        }
        Ok(HeightStatistics { min_m, max_m, mean_m: sum_m / bounds.area() as f64 })
    }

    /// What of a rectangle of a level, in samples of that level, has pages on any visible layer, page by page.
    pub(crate) fn painted_rects(&self, level: u8, rect: SampleRect) -> Result<Vec<SampleRect>> {
        let store = self.settled()?;
        let layout = store.layout();
        let mut places = BTreeSet::new();
        for layer in store.layers().iter().filter(|layer| layer.visible) {
            let keys = store.page_keys_in(layer.heights, level, &rect)?;
            places.extend(keys.into_iter().map(|key| (key.z, key.x)));
        }
        let rects = places
            .into_iter()
            .map(|(z, x)| layout.page_rect(&PageKey { field: FieldId(0), level, z, x }).intersection(&rect));
        Ok(rects.filter(|rect| !rect.is_empty()).collect())
    }

    /// The composite where nothing is painted.
    pub(crate) fn unpainted_height_m(&self) -> Result<f32> {
        let mut visible = self.layers()?.iter().filter(|layer| layer.visible);
        let lowest_m = visible.next().map_or(0.0, |layer| layer.constant_m);
        Ok(visible.fold(lowest_m, |height_m, layer| height_m + layer.opacity * layer.constant_m))
    }

    /// Undoes up to `count` operations, bit for bit; fewer where the history begins.
    ///
    /// # Errors
    /// [`Error::Store`]; the terrain is then as it was.
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.undo(count))
    }

    /// Does up to `count` undone operations again, bit for bit.
    ///
    /// # Errors
    /// [`Error::Store`]; the terrain is then as it was.
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.redo(count))
    }

    /// Goes to any entry of the history, on a branch too: afterwards it is the last one that shows.
    ///
    /// # Errors
    /// [`Error::Store`] when there is none of that number, and as [`Self::undo`].
    pub fn jump(&mut self, entry: EntryId) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.jump(entry))
    }

    fn travel(
        &mut self,
        travel: impl FnOnce(&mut Recorder) -> orogeny_store::Result<Vec<Change>>,
    ) -> Result<Vec<Change>> {
        // A commit that failed meanwhile takes its pages back.
        self.flush()?;
        let travelled = travel(self.recorder()?);
        if travelled.is_err() {
            // Whether it came to pass or not.
            self.forget_all_pages();
        }
        let changes = travelled?;
        changes.iter().for_each(|change| self.forget_pages(&change.pages));
        Ok(changes)
    }

    /// What was done, oldest first, with what was undone and what was left behind.
    ///
    /// # Errors
    /// [`Error::Store`] when the history cannot be read.
    pub fn log(&self) -> Result<Vec<Entry>> {
        Ok(self.settled()?.log()?)
    }

    /// Sets how many bytes of the file the history may take; `None`: whatever it comes to. The oldest entries over it go at
    /// once, and from now on with each operation.
    ///
    /// # Errors
    /// [`Error::Store`]; nothing is changed then.
    pub fn set_history_budget(&mut self, budget_in_bytes: Option<u64>) -> Result<Dropped> {
        self.flush()?;
        Ok(self.recorder()?.with_store(move |store| store.set_history_budget(budget_in_bytes))?)
    }

    /// Drops everything that was undone and left behind.
    ///
    /// # Errors
    /// [`Error::Store`]; nothing is changed then.
    pub fn drop_branches(&mut self) -> Result<Dropped> {
        self.flush()?;
        Ok(self.recorder()?.with_store(Store::drop_branches)?)
    }

    /// Gives free space in the file back, and tells its size in bytes before and after.
    ///
    /// # Errors
    /// [`Error::Store`]; nothing is changed then.
    pub fn compact(&mut self) -> Result<(u64, u64)> {
        self.flush()?;
        Ok(self.recorder()?.with_store(Store::compact)?)
    }

    /// What had to go from the history since this was last asked, for it to keep to its budget.
    ///
    /// # Errors
    /// [`Error::Store`] for a terrain that is open for reading.
    pub fn take_dropped_history(&mut self) -> Result<Dropped> {
        Ok(self.recorder()?.take_dropped())
    }

    /// The executor's pages are no longer those of the file.
    pub(crate) fn forget_pages(&mut self, keys: &[PageKey]) {
        if let Some(executor) = &mut self.executor {
            executor.forget(keys);
        }
    }

    /// None of the executor's pages can be trusted.
    pub(crate) fn forget_all_pages(&mut self) {
        if let Some(executor) = &mut self.executor {
            executor.cancel();
        }
    }

    /// Removes a terrain that was only just made and did not come to anything.
    pub(crate) fn remove(self) {
        let path = self.store().map(|store| store.path().to_owned());
        drop(self);
        let Ok(path) = path else { return };
        if let Err(err) = std::fs::remove_file(&path) {
            tracing::warn!("`{}` was left behind: {err}", path.display());
        }
    }

    pub(crate) const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What is on disk.
    pub(crate) fn store(&self) -> Result<&Store> {
        self.access.on_disk()
    }

    /// What is on disk, once everything finished is there.
    pub(crate) fn settled(&self) -> Result<&Store> {
        self.access.settled()
    }

    pub(crate) fn recorder(&mut self) -> Result<&mut Recorder> {
        self.access.recorder()
    }

    /// Heights of a rectangle of a level, row by row.
    pub(crate) fn composite(&self, source: Source, level: u8, rect: SampleRect) -> Result<Composite<'_>> {
        let max_band_bytes = band_bytes(self.settings.page_budget_in_bytes);
        Ok(Composite::new(self.settled()?, source, level, rect, max_band_bytes))
    }

    pub(crate) fn recorder_and_executor(&mut self) -> Result<(&mut Recorder, &mut dyn Executor)> {
        let recorder = self.access.recorder()?;
        let executor = match &mut self.executor {
            Some(executor) => executor,
            none => none.insert(backend::executor(&self.settings, recorder.on_disk()?.layout())?),
        };
        Ok((recorder, executor.as_mut()))
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
