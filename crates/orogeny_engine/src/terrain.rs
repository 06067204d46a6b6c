//! The open terrain: its file, its executor, its history.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

use orogeny_brush::{Executor, Levels, PageMemory};
use orogeny_field::{FieldId, PageKey, PageLayout, SampleRect, TerrainGrid};
use orogeny_store::{CheckReport, EntryId, Layer, NewLayer, NewTerrain, Recorder, Repaired, Salvaged, Store};

use crate::access::{Access, band_bytes, open_to_write, up_to_date};
use crate::backend::{self, Settings};
use crate::composite::{Change, Composite, Compositor, Node, Source, StorePages};
use crate::pages::SettledPages;
use crate::{Error, LayerReference, Result};

/// The name of the layer that a new terrain has.
pub(crate) const BASE_LAYER: &str = "Base";

/// An open terrain file and what works on it.
pub struct Terrain {
    access: Access,
    grid: TerrainGrid,
    settings: Settings,
    /// Made when the first operation needs it.
    executor: Option<Box<dyn Executor>>,
    /// Works out the layer stack, and keeps what took long.
    compositor: RefCell<Compositor>,
}

/// What operations are run with.
pub(crate) struct Parts<'a> {
    pub(crate) recorder: &'a mut Recorder,
    pub(crate) executor: &'a mut dyn Executor,
    pub(crate) compositor: &'a mut Compositor,
}

impl std::fmt::Debug for Terrain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Terrain")
            .field("access", &self.access)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
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

    /// Opens a terrain for reading, beside whoever writes it: it shows what was last committed then, or when it was
    /// [refreshed](Self::refresh), and keeps a writer beside it from moving its log into the file.
    ///
    /// # Errors
    /// [`Error::Store`] when the file is not there, is no terrain, is damaged or comes from a newer version.
    pub fn open_to_read(path: &Path, settings: Settings) -> Result<Self> {
        Self::of(Access::reading(path)?, settings)
    }

    /// Opens a terrain for reading as it was after an entry of its history, beside whoever writes it: layers, heights and masks are as though one
    /// had [gone](Self::jump) there, and the file stays as it is. Takes about as long as going there, and keeps a writer beside it from
    /// moving its log into the file.
    ///
    /// # Errors
    /// [`Error::Store`] when the history has no such entry, or what leads there is damaged; else as [`Self::open_to_read`].
    pub fn open_to_read_at(path: &Path, entry: EntryId, settings: Settings) -> Result<Self> {
        Self::of(Access::reading_at(path, entry)?, settings)
    }

    /// Lets a terrain that is open for reading show what was committed last: its layers, its pages and its history, of one state. One that
    /// is open for writing does so anyway.
    ///
    /// # Errors
    /// [`Error::Store`] when the file cannot be read. The terrain can then only be closed, or refreshed again.
    pub fn refresh(&mut self) -> Result<()> {
        if let Access::Read(_) = self.access {
            self.compositor.get_mut().forget_results();
        }
        self.access.refresh()
    }

    fn writing(store: Store, settings: Settings) -> Result<Self> {
        Self::of(Access::writing(store, settings.page_budget_in_bytes)?, settings)
    }

    pub(crate) fn of(access: Access, settings: Settings) -> Result<Self> {
        let grid = access.on_disk()?.grid();
        let compositor = RefCell::new(Compositor::new(&settings));
        Ok(Self { access, grid, settings, executor: None, compositor })
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
        Ok(self.parts()?.executor.description())
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

    /// What of a rectangle of a level, in samples of that level, is not as [`Self::unpainted_height_m`] says, page by page.
    pub(crate) fn painted_rects(&self, level: u8, rect: SampleRect) -> Result<Vec<SampleRect>> {
        let store = self.settled()?;
        let layout = store.layout();
        let mut places = BTreeSet::new();
        let nodes = self.compositor.borrow_mut().nodes(store.layers(), &mut StorePages::new(store))?;
        if nodes.iter().all(Node::is_constant_without_pages) {
            for stored in nodes.iter().flat_map(Node::fields) {
                let keys = store.page_keys_in(stored.field, level, &rect)?;
                places.extend(keys.into_iter().map(|key| (key.z, key.x)));
            }
        } else {
            places.extend(layout.pages_in(rect).map(|(x, z)| (z, x)));
        }
        let rects = places
            .into_iter()
            .map(|(z, x)| layout.page_rect(&PageKey { field: FieldId(0), level, z, x }).intersection(&rect));
        Ok(rects.filter(|rect| !rect.is_empty()).collect())
    }

    /// The composite where nothing is painted.
    pub(crate) fn unpainted_height_m(&self) -> Result<f32> {
        let store = self.settled()?;
        let nodes = self.compositor.borrow_mut().nodes(store.layers(), &mut StorePages::new(store))?;
        let mut height_m = [0.0];
        for node in nodes.iter() {
            node.join_constant(&mut height_m);
        }
        let [height_m] = height_m;
        Ok(height_m)
    }

    /// The executor's pages are no longer those of the file.
    pub(crate) fn forget_pages(&mut self, keys: &[PageKey]) {
        if let Some(executor) = &mut self.executor {
            executor.forget(keys);
        }
        self.forget_composite(keys);
    }

    /// What was worked out of these pages is no longer true.
    pub(crate) fn forget_composite(&mut self, keys: &[PageKey]) {
        let layout = self.access.on_disk().map(Store::layout);
        match layout {
            Ok(layout) => {
                let changes = Change::of_pages(layout, keys);
                self.compositor.get_mut().forget(&self.grid, layout, &changes);
            }
            Err(_) => self.compositor.get_mut().forget_all(),
        }
    }

    /// None of the executor's pages can be trusted.
    pub(crate) fn forget_all_pages(&mut self) {
        if let Some(executor) = &mut self.executor {
            executor.cancel();
        }
        self.compositor.get_mut().forget_all();
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

    /// Says who does what is done from now on.
    pub(crate) fn set_author(&mut self, author: String) {
        self.settings.author = author;
    }

    pub(crate) const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the executor keeps pages in.
    pub(crate) fn executor_memory(&self) -> PageMemory {
        self.executor.as_ref().map(|executor| executor.memory()).unwrap_or_default()
    }

    /// Bytes of pages that the open file keeps in memory.
    pub(crate) fn store_memory_in_bytes(&self) -> u64 {
        self.access.memory_in_bytes()
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
        let store = self.settled()?;
        Ok(Composite::new(store, &self.compositor, source, level, rect, max_band_bytes))
    }

    pub(crate) const fn access(&self) -> &Access {
        &self.access
    }

    pub(crate) const fn compositor(&self) -> &RefCell<Compositor> {
        &self.compositor
    }

    /// What operations are run with.
    pub(crate) fn parts(&mut self) -> Result<Parts<'_>> {
        let recorder = self.access.recorder()?;
        let executor = match &mut self.executor {
            Some(executor) => executor,
            none => none.insert(backend::executor(&self.settings, recorder.on_disk()?.layout())?),
        };
        Ok(Parts { recorder, executor: executor.as_mut(), compositor: self.compositor.get_mut() })
    }

    /// What brushes work with, if they have worked.
    pub(crate) fn executor(&self) -> Option<&dyn Executor> {
        self.executor.as_deref()
    }

    /// As [`Executor::levels`], of what is on disk.
    pub(crate) fn levels(&mut self, field: FieldId, wanted: &[SampleRect]) -> Result<Option<Levels>> {
        let Some(executor) = &mut self.executor else { return Ok(None) };
        let store = self.access.settled()?;
        Ok(executor.levels(field, &store.grid(), wanted, &mut SettledPages(store))?)
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
