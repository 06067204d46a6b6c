//! The open terrain file.

use std::collections::BTreeMap;
use std::path::Path;

use orogeny_field::{FieldId, Page, PageKey, PageLayout, TerrainGrid};

use crate::database::Database;
use crate::rows::{Document, EntryRow, LayerChange};
use crate::transaction::now_unix_ms;
use crate::{EntryId, Error, Layer, NewLayer, Result, Transaction, content};

/// A terrain to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct NewTerrain {
    /// Its size and sample spacing.
    pub grid: TerrainGrid,
    /// How it is cut into pages.
    pub layout: PageLayout,
    /// Its first layers, from the bottom. They belong to the terrain and cannot be undone.
    pub layers: Vec<NewLayer>,
}

/// A terrain file, open for reading and writing.
///
/// One process writes at a time, transaction by transaction; every read sees what was last committed. What this value
/// remembers of the terrain (its [`layers`](Self::layers)) is as of the last transaction, undo, redo or opening.
pub struct Store {
    pub(crate) db: Database,
    pub(crate) document: Document,
    pub(crate) stack: Stack,
    pub(crate) was_moved_by_others: bool,
}

/// The layers and what their fields hold where they have no page.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stack {
    pub(crate) layers: Vec<Layer>,
    pub(crate) constants: BTreeMap<FieldId, f32>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Store").field("path", &self.path()).finish_non_exhaustive()
    }
}

impl Store {
    /// Makes a terrain file, durably, and opens it.
    ///
    /// # Errors
    /// [`Error::Exists`] where there is a file already; [`Error::LayerName`] or [`Error::Value`] for a layer that
    /// cannot be; else what the system refused. Nothing is left behind.
    pub fn create(path: &Path, new: &NewTerrain) -> Result<Self> {
        let layers = new.layers.iter().map(NewLayer::checked).collect::<Result<Vec<_>>>()?;
        let mut document = Document {
            grid: new.grid,
            layout: new.layout,
            head: EntryId::CREATION,
            last_entry: 0,
            last_layer: 0,
            last_field: 0,
        };
        let mut stack = Stack::default();
        let db = Database::create(path, |db| {
            db.insert_entry(&EntryRow {
                id: EntryId::CREATION,
                parent: None,
                operation: "null".to_owned(),
                author: String::new(),
                time_unix_ms: now_unix_ms(),
                num_pages: 0,
                delta_bytes: 0,
            })?;
            for layer in layers {
                stack.add(db, &mut document, EntryId::CREATION, layer)?;
            }
            db.insert_document(&document)
        })?;
        Ok(Self { db, document, stack, was_moved_by_others: false })
    }

    /// Opens a terrain file, in time independent of its size. A log that a killed process left is taken up: everything
    /// acknowledged is there.
    ///
    /// # Errors
    /// Says which: [`Error::EmptyPath`], [`Error::Missing`], [`Error::Directory`], [`Error::NotATerrain`],
    /// [`Error::NewerVersion`], [`Error::Damaged`], [`Error::ReadOnly`], [`Error::Busy`]. The file is not changed.
    pub fn open(path: &Path) -> Result<Self> {
        let db = Database::open(path)?;
        let (document, stack) = db.in_snapshot(|| Ok((db.document()?, Stack::load(&db)?)))?;
        Ok(Self { db, document, stack, was_moved_by_others: false })
    }

    /// Moves everything into the one file and closes it: no log remains, unless someone else has the terrain open.
    /// Dropping a store does the same, without a word when it cannot.
    ///
    /// # Errors
    /// When the log could not be moved, for want of space for instance. Nothing is lost: the log stays beside the file.
    pub fn close(self) -> Result<()> {
        self.db.close()
    }

    /// Where the file is, absolute.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.db.path()
    }

    /// Size and sample spacing.
    #[must_use]
    pub const fn grid(&self) -> TerrainGrid {
        self.document.grid
    }

    /// How its fields are cut into pages.
    #[must_use]
    pub const fn layout(&self) -> PageLayout {
        self.document.layout
    }

    /// Whether another writer has moved the terrain to another place in its history since this was last asked, as seen by
    /// the last transaction, undo or redo. Pages remembered from before are then out of date.
    pub const fn take_was_moved_by_others(&mut self) -> bool {
        std::mem::replace(&mut self.was_moved_by_others, false)
    }

    /// The layers, from the bottom.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.stack.layers
    }

    /// Reads a page; `None` where the field holds its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode; the others are not concerned.
    pub fn load_page(&self, key: &PageKey) -> Result<Option<Page>> {
        load_page(&self.db, self.document.layout, key)
    }

    /// The pages that a field has, at all levels, in the order of level, row, column.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_keys(&self, field: FieldId) -> Result<Vec<PageKey>> {
        self.db.page_keys(field)
    }

    /// Starts an operation, waiting up to five seconds for another process that writes.
    ///
    /// # Errors
    /// [`Error::Busy`] when that was not enough.
    pub fn begin(&mut self) -> Result<Transaction<'_>> {
        Transaction::start(self)
    }

    /// Bytes of the file, its log included.
    ///
    /// # Errors
    /// When the system does not say.
    pub fn file_size_in_bytes(&self) -> Result<u64> {
        self.db.file_size_in_bytes()
    }

    /// Looks again at what another process may have changed. To be called where that cannot change any more: in a
    /// transaction or a snapshot.
    pub(crate) fn refresh(&mut self) -> Result<()> {
        let document = self.db.document()?;
        if document.head != self.document.head {
            self.stack = Stack::load(&self.db)?;
            self.was_moved_by_others = true;
        }
        self.document = document;
        Ok(())
    }
}

pub(crate) fn load_page(db: &Database, layout: PageLayout, key: &PageKey) -> Result<Option<Page>> {
    let Some(row) = db.page(layout, key)? else { return Ok(None) };
    let ordered = content::decode_page(layout, &row)?;
    content::page_from_ordered(layout, &ordered).map(Some)
}

impl Stack {
    pub(crate) fn load(db: &Database) -> Result<Self> {
        let constants = db.field_constants()?;
        let mut layers = Vec::new();
        for saved in db.saved_layers()? {
            let wrong = |detail: String| Error::damaged(db.path(), format!("layer {}: {detail}", saved.id));
            let mut layer: Layer =
                serde_json::from_str(&saved.state).map_err(|err| wrong(err.to_string()))?;
            layer.constant_m = *constants
                .get(&layer.heights)
                .ok_or_else(|| wrong(format!("its field {} does not exist", layer.heights.0)))?;
            layers.push(layer);
        }
        layers.sort_by_key(|layer| (layer.position, layer.id));
        Ok(Self { layers, constants })
    }

    /// Puts a new layer on top, here and in the file, as a change that `entry` makes.
    pub(crate) fn add(
        &mut self,
        db: &Database,
        document: &mut Document,
        entry: EntryId,
        new: NewLayer,
    ) -> Result<Layer> {
        let layer = Layer {
            id: document.next_layer()?,
            position: self.layers.last().map_or(0, |top| top.position.saturating_add(1)),
            name: new.name,
            heights: document.next_field()?,
            constant_m: new.constant_m,
            visible: true,
            opacity: 1.0,
            blend: crate::Blend::default(),
        };
        let state =
            serde_json::to_string(&layer).map_err(|err| Error::Operation { detail: err.to_string() })?;
        db.insert_field(layer.heights, layer.constant_m)?;
        db.set_layer(layer.id, Some(&state))?;
        db.insert_layer_change(entry, &LayerChange { layer: layer.id, before: None, after: Some(state) })?;
        self.constants.insert(layer.heights, layer.constant_m);
        self.layers.push(layer.clone());
        Ok(layer)
    }
}
