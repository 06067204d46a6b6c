//! Saving what can be read of a damaged terrain into a new one.

use std::path::Path;
use std::sync::Arc;

use orogeny_field::{FieldId, LayerReference, Page, PageKey};

use crate::database::{Database, companion, has_log};
use crate::rows::Document;
use crate::stack::Stack;
use crate::{
    BlobHash, Error, Field, FieldKind, Layer, NewLayer, NewTerrain, Result, Store, Transaction, content,
};

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
    /// Copies what can be read of a terrain into a new one at `to`: layers, masks, the selection and pages, with what is damaged replaced by
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
            let mut copies = Copies::default();
            for layer in &source.stack.layers {
                copies.copy_layer(&source, layer, &mut transaction, &mut salvaged)?;
            }
            copies.join(&source, &mut transaction, &mut salvaged)?;
            for (field, _) in
                source.stack.fields.iter().filter(|(_, field)| field.kind == FieldKind::Selection)
            {
                let selection = transaction.selection()?;
                copy_pages(&source, *field, selection, &mut transaction, &mut salvaged)?;
            }
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

/// Layers that were copied, which do not yet name each other.
#[derive(Default)]
struct Copies {
    /// Each with the id that it had.
    layers: Vec<(u32, Layer)>,
}

impl Copies {
    fn copy_layer(
        &mut self,
        source: &Store,
        layer: &Layer,
        transaction: &mut Transaction<'_>,
        salvaged: &mut Salvaged,
    ) -> Result<()> {
        let mut name = layer.name.clone();
        if crate::layer::check_name(&name).is_err() {
            salvaged.problems.push(format!("layer {} has no name that can be", layer.id));
            name = format!("Layer {}", layer.id);
        }
        let constant_m = layer.constant_m;
        let made = transaction.add_layer(&NewLayer { name: name.clone(), constant_m })?;
        copy_pages(source, layer.heights, made.heights, transaction, salvaged)?;
        // What an effect was made of goes by entries of the history, which is not copied.
        let (id, heights) = (made.id, made.heights);
        let mut copy = Layer { id, name, heights, mask: None, made_of: None, ..layer.clone() };
        if let Some(mask) = layer.mask {
            let constant = source.stack.fields.get(&mask).map_or(1.0, |field| field.constant);
            let field = transaction.add_field(Field { kind: FieldKind::Mask, constant })?;
            copy_pages(source, mask, field, transaction, salvaged)?;
            copy.mask = Some(field);
        }
        if let Some(made_mask) = &mut copy.made_mask {
            made_mask.made_of.entry = 0;
        }
        self.layers.push((layer.id, copy));
        Ok(())
    }

    /// Lets groups and masks name the copies, and copies the data from outside that they are made of.
    fn join(&self, source: &Store, transaction: &mut Transaction<'_>, salvaged: &mut Salvaged) -> Result<()> {
        let copy_of = |id: u32| self.layers.iter().find(|(before, _)| *before == id).map(|(_, copy)| copy.id);
        for (_, copy) in &self.layers {
            let mut copy = copy.clone();
            copy.group = copy.group.and_then(copy_of);
            let num_terms = copy.mask_terms.len();
            copy.mask_terms.retain_mut(|term| match term.source.layer_mut() {
                Some(LayerReference::Id(id)) => copy_of(*id).map(|copy| *id = copy).is_some(),
                Some(LayerReference::Name(_)) => false,
                None => true,
            });
            let name = &copy.name;
            if copy.mask_terms.len() < num_terms {
                salvaged
                    .problems
                    .push(format!("a layer is lost that the mask of the layer `{name}` looks at"));
            }
            let state: serde_json::Value = serde_json::from_str(&copy.to_state()?)
                .map_err(|err| Error::Operation { detail: err.to_string() })?;
            for hash in hashes_in(&state) {
                let mut data = Vec::new();
                if let Err(err) = source.read_blob(&hash, &mut data) {
                    // Without it nothing that it is in could be looked at.
                    salvaged.problems.push(format!("the layer `{name}` is hidden: {err}"));
                    copy.visible = false;
                    continue;
                }
                transaction.keep_blob(&mut data.as_slice())?;
            }
            transaction.set_layer(&copy)?;
        }
        Ok(())
    }
}

/// The names of all data from outside in a layer's state.
fn hashes_in(state: &serde_json::Value) -> Vec<BlobHash> {
    match state {
        serde_json::Value::Object(object) => {
            let own = object.get("blake3").and_then(serde_json::Value::as_str).and_then(BlobHash::from_hex);
            own.into_iter().chain(object.values().flat_map(hashes_in)).collect()
        }
        serde_json::Value::Array(list) => list.iter().flat_map(hashes_in).collect(),
        _ => Vec::new(),
    }
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
