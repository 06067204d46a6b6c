//! Saving what can be read of a damaged terrain into a new one.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use orogeny_field::{FieldId, LayerReference, Page, PageKey};

use crate::database::{Database, companion, has_log};
use crate::rows::Document;
use crate::stack::Stack;
use crate::{Error, Field, FieldKind, Layer, NewLayer, NewTerrain, Result, Store, Transaction, content};

/// What [`Store::salvage`] saved, and how.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Salvaged {
    /// Pages that were whole.
    pub num_whole_pages: u64,
    /// Pages that were made again from the history, bit for bit.
    pub pages_from_history: Vec<PageKey>,
    /// Pages of which only a coarser level was left, by the level.
    pub pages_from_coarser_levels: Vec<(PageKey, u8)>,
    /// Pages of which nothing was left.
    pub lost_pages: Vec<PageKey>,
    /// What else was damaged, for people.
    pub problems: Vec<String>,
}

impl Store {
    /// Copies what can be read of a terrain into a new one at `to`: layers, masks and pages, with what is damaged replaced by
    /// the best that is left. The history is not copied. The damaged terrain is not changed.
    ///
    /// # Errors
    /// When the file is so damaged that not even the size of the terrain is left; [`Error::Exists`] where there is a file at
    /// `to` already, and what else [`Self::create`] may say.
    pub fn salvage(from: &Path, to: &Path) -> Result<Salvaged> {
        let mut salvaged = Salvaged::default();
        // An older version is brought up to date in a copy: the original is not changed.
        let copy;
        let db = match Database::open_to_read(from) {
            Err(Error::OlderVersion { .. }) => {
                copy = up_to_date_copy(from, to)?;
                Database::open_to_read(&copy)?
            }
            opened => opened?,
        };
        let (document, is_whole) = db.document_unchecked()?;
        if !is_whole {
            salvaged.problems.push("the row that says what terrain it is fails its checksum".to_owned());
        }
        let stack = Stack::as_found(&db, &mut salvaged.problems)?;
        let source = Self::reader(db, document, stack);
        let Document { grid, layout, .. } = source.document;
        let mut target = Self::create(to, &NewTerrain { grid, layout, layers: Vec::new() })?;
        let copied = target.begin().and_then(|mut transaction| {
            copy_layers(&source, &mut transaction, &mut salvaged)?;
            let name = from.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let operation = serde_json::json!({ "op": "salvage", "from": name });
            transaction.commit(&operation.to_string(), "")
        });
        // A part of what is left must not look like all of it.
        copied.and_then(|_| target.close()).inspect_err(|_| _ = std::fs::remove_file(to))?;
        Ok(salvaged)
    }
}

/// A copy beside `to`, with its log, that goes when it is dropped.
fn up_to_date_copy(from: &Path, to: &Path) -> Result<tempfile::TempPath> {
    let folder = to.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed = |err: std::io::Error| Error::from_io(to, &err);
    let copy = tempfile::NamedTempFile::new_in(folder).map_err(failed)?.into_temp_path();
    std::fs::copy(from, &copy).map_err(failed)?;
    let log = companion(&copy, "-wal");
    if has_log(from) {
        std::fs::copy(companion(from, "-wal"), &log).map_err(failed)?;
    }
    Store::open(&copy)?.close()?;
    Ok(copy)
}

fn copy_layers(source: &Store, transaction: &mut Transaction<'_>, salvaged: &mut Salvaged) -> Result<()> {
    let mut copies = Vec::new();
    for layer in &source.stack.layers {
        copies.push((layer.id, copy_layer(source, layer, transaction, salvaged)?));
    }
    let ids: BTreeMap<u32, u32> = copies.iter().map(|(id, copy)| (*id, copy.id)).collect();
    for (_, mut copy) in copies {
        refer_to_copies(&mut copy, &ids, salvaged);
        copy_blobs(source, &copy, transaction, salvaged)?;
        transaction.set_layer(&copy)?;
    }
    Ok(())
}

/// Copies a layer with its pages; it still refers to others by the ids that they had.
fn copy_layer(
    source: &Store,
    layer: &Layer,
    transaction: &mut Transaction<'_>,
    salvaged: &mut Salvaged,
) -> Result<Layer> {
    let mut name = layer.name.clone();
    if crate::layer::check_name(&name).is_err() {
        salvaged.problems.push(format!("layer {} has no name that can be", layer.id));
        name = format!("Layer {}", layer.id);
    }
    let made = transaction.add_layer(&NewLayer { name: name.clone(), constant_m: layer.constant_m })?;
    copy_pages(source, layer.heights, made.heights, transaction, salvaged)?;
    let mut mask = None;
    if let Some(from) = layer.mask {
        let constant = source.stack.fields.get(&from).map_or(1.0, |field| field.constant);
        let field = transaction.add_field(Field { kind: FieldKind::Mask, constant })?;
        copy_pages(source, from, field, transaction, salvaged)?;
        mask = Some(field);
    }
    let mut copy = Layer { id: made.id, name, heights: made.heights, mask, made_of: None, ..layer.clone() };
    // What something was made of is told by entries of a history that is not copied.
    if let Some(made_mask) = &mut copy.made_mask {
        made_mask.made_of.entry = 0;
    }
    Ok(copy)
}

/// Names other layers by the ids of their copies.
fn refer_to_copies(copy: &mut Layer, ids: &BTreeMap<u32, u32>, salvaged: &mut Salvaged) {
    copy.group = copy.group.and_then(|group| ids.get(&group).copied());
    let num_terms = copy.mask_terms.len();
    copy.mask_terms.retain_mut(|term| match term.source.layer_mut() {
        Some(LayerReference::Id(id)) => ids.get(id).map(|copied| *id = *copied).is_some(),
        Some(LayerReference::Name(_)) | None => true,
    });
    if copy.mask_terms.len() < num_terms {
        salvaged
            .problems
            .push(format!("the mask of the layer `{}` looks at one that cannot be read", copy.name));
    }
}

/// Copies the data from outside that a layer is made of: its state names it.
fn copy_blobs(
    source: &Store,
    layer: &Layer,
    transaction: &mut Transaction<'_>,
    salvaged: &mut Salvaged,
) -> Result<()> {
    let state = layer.to_state()?;
    for blob in source.db.blobs().unwrap_or_default().into_iter().flatten() {
        if !state.contains(&blob.hash.to_string()) {
            continue;
        }
        let mut bytes = Vec::new();
        match source.copy_blob(&blob, &mut bytes) {
            Ok(()) => _ = transaction.keep_blob(&mut bytes.as_slice())?,
            Err(err) => salvaged.problems.push(format!("what the layer `{}` is made of: {err}", layer.name)),
        }
    }
    Ok(())
}

fn copy_pages(
    source: &Store,
    from: FieldId,
    to: FieldId,
    transaction: &mut Transaction<'_>,
    salvaged: &mut Salvaged,
) -> Result<()> {
    let keys = source.db.page_keys_as_far_as_possible(from, &mut salvaged.problems);
    let (grid, layout) = (source.grid(), source.layout());
    let (keys, beyond): (Vec<_>, Vec<_>) = keys.into_iter().partition(|key| layout.has_page(&grid, key));
    if !beyond.is_empty() {
        salvaged.problems.push(format!("{} pages lie beyond the terrain", beyond.len()));
    }
    for batch in keys.chunks(content::pages_per_batch(source.layout())) {
        let mut pages: Vec<(PageKey, Arc<Page>)> = Vec::with_capacity(batch.len());
        for key in batch {
            let page = saved_page(source, key, salvaged)?;
            pages.extend(page.map(|page| (PageKey { field: to, ..*key }, page)));
        }
        transaction.write_pages(&pages)?;
    }
    Ok(())
}

/// The best that is left of a page.
fn saved_page(source: &Store, key: &PageKey, salvaged: &mut Salvaged) -> Result<Option<Arc<Page>>> {
    if let Ok(page) = source.load_page(key) {
        salvaged.num_whole_pages += 1;
        return Ok(page);
    }
    if let Ok(Some(content)) = source.page_from_history(key) {
        salvaged.pages_from_history.push(*key);
        return Ok(Some(content.page));
    }
    match source.load_page_or_coarser(key) {
        Ok((page, level)) => {
            salvaged.pages_from_coarser_levels.push((*key, level));
            Ok(page)
        }
        Err(Error::Io { path, detail }) => Err(Error::Io { path, detail }),
        Err(_) => {
            salvaged.lost_pages.push(*key);
            Ok(None)
        }
    }
}

impl Stack {
    /// As the file says, whatever fails its checksum: what makes sense is taken.
    fn as_found(db: &Database, problems: &mut Vec<String>) -> Result<Self> {
        let fields = db.fields_as_found(problems)?;
        let mut layers = Vec::new();
        for (id, state) in db.layer_states_as_found(problems)? {
            match serde_json::from_str::<Layer>(&state) {
                Ok(layer) => {
                    let constant_m = fields.get(&layer.heights).map_or(0.0, |field| field.constant);
                    layers.push(Layer { constant_m, ..layer });
                }
                Err(err) => problems.push(format!("layer {id} cannot be read: {err}")),
            }
        }
        layers.sort_by_key(|layer| (layer.position, layer.id));
        Ok(Self { layers, fields })
    }
}
