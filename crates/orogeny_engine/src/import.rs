//! From a file of another program to a terrain, or to a layer of one.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use orogeny_field::{LayerContent, Page, PageKey, PageLayout, SampleRect, TerrainGrid};
use orogeny_formats::{Import, ImportOptions};
use orogeny_store::{BlobHash, EntryId, Layer, NewLayer, Recording};

use crate::access::{PAGES_AT_ONCE, band_bytes, band_rows};
use crate::composite::Change;
use crate::layers::{refuse_locked, refused};
use crate::progress::report;
use crate::terrain::find_layer;
use crate::{Error, LayerReference, Observer, Result, Settings, Terrain};

/// Spacings that differ by less than this share are the same.
const SAME_SPACING: f64 = 1.0e-6;

/// A raster to be imported.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportRequest {
    /// The file.
    pub file: PathBuf,
    /// How to read it.
    pub options: ImportOptions,
    /// The layer to write into, which is made where there is none of that name; `None`: the lowest.
    pub layer: Option<String>,
    /// Where its north-west sample goes, in metres.
    pub at_m: [f64; 2],
}

/// What an import did.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ImportSummary {
    /// Its place in the history.
    pub entry: EntryId,
    /// Samples along x, as they arrived.
    pub width: u32,
    /// Samples along z.
    pub depth: u32,
    /// Metres between samples.
    pub spacing_m: f64,
    /// Where its north-west sample went, in metres.
    pub at_m: [f64; 2],
    /// The layer's name.
    pub layer: String,
    /// Whether the layer was made for it.
    pub made_layer: bool,
    /// What was resampled, filled, assumed or left out, for people.
    pub notices: Vec<String>,
}

impl Terrain {
    /// Makes a terrain from a raster, of its size and spacing; 1 m where neither the file nor the options tell one.
    ///
    /// # Errors
    /// [`Error::Format`] when the file cannot be read, [`Error::Store`] when the terrain cannot be made. No terrain is left
    /// behind then.
    pub fn from_raster(
        path: &Path,
        request: &ImportRequest,
        settings: Settings,
        observer: &mut dyn Observer,
    ) -> Result<(Self, ImportSummary)> {
        let mut raster = orogeny_formats::open(&request.file, &request.options)?;
        let info = raster.info().clone();
        let mut notices = info.notices;
        let spacing_m = info.spacing_m.unwrap_or_else(|| {
            notices.push("the file tells no spacing; its samples were taken as 1 m apart".to_owned());
            1.0
        });
        let grid = TerrainGrid::new(info.width.into(), info.depth.into(), spacing_m)?;
        let mut terrain = Self::create(path, grid, 0.0, settings)?;
        match terrain.write_raster(&mut raster, request, notices, observer) {
            Ok(summary) => Ok((terrain, summary)),
            Err(err) => {
                terrain.remove();
                Err(err)
            }
        }
    }

    /// Writes a raster into a layer, sample for sample, as one entry of the history. A layer that is made for it is added
    /// to those below.
    ///
    /// # Errors
    /// [`Error::SpacingDiffers`] for a raster of another spacing; [`Error::OutsideTerrain`] for one that does not touch
    /// the terrain; [`Error::Format`], [`Error::Store`].
    pub fn import(&mut self, request: &ImportRequest, observer: &mut dyn Observer) -> Result<ImportSummary> {
        let mut raster = orogeny_formats::open(&request.file, &request.options)?;
        let terrain_m = self.grid().spacing_m();
        let mut notices = raster.info().notices.clone();
        match raster.info().spacing_m {
            Some(raster_m) if (raster_m / terrain_m - 1.0).abs() > SAME_SPACING => {
                return Err(Error::SpacingDiffers { path: request.file.clone(), raster_m, terrain_m });
            }
            Some(_) => {}
            None => {
                notices.push(format!(
                    "the file tells no spacing; its samples were taken as {terrain_m} m apart"
                ));
            }
        }
        self.write_raster(&mut raster, request, notices, observer)
    }

    fn write_raster(
        &mut self,
        raster: &mut Import,
        request: &ImportRequest,
        mut notices: Vec<String>,
        observer: &mut dyn Observer,
    ) -> Result<ImportSummary> {
        let grid = self.grid();
        let (width, depth) = (raster.info().width, raster.info().depth);
        let author = self.settings().author.clone();
        let band_bytes = band_bytes(self.settings().page_budget_in_bytes);
        // Strokes that turn out to have failed go from the executor's memory too.
        self.flush()?;
        let mut recording = self.recorder()?.begin()?;
        let done = run_import(&mut recording, raster, request, grid, &author, band_bytes, observer)?;
        recording.finish()?;
        self.flush()?;
        self.forget_pages(&done.pages);
        if done.num_left_out > 0 {
            notices.push(format!("{} samples beyond the terrain's edge were left out", done.num_left_out));
        }
        Ok(ImportSummary {
            entry: done.entry,
            width,
            depth,
            spacing_m: grid.spacing_m(),
            at_m: request.at_m,
            layer: done.layer.name,
            made_layer: done.made_layer,
            notices,
        })
    }
}

impl Terrain {
    /// What an import changed of one field; `None` where it changed more.
    pub(crate) fn changed_by(&self, summary: &ImportSummary) -> Option<Change> {
        if summary.made_layer {
            return None;
        }
        let layer = self.layer(Some(&LayerReference::Name(summary.layer.clone()))).ok()?;
        let rect = raster_rect(&self.grid(), summary.at_m, summary.width, summary.depth).ok()?;
        Some(Change { field: layer.heights, rect: rect.intersection(&self.grid().bounds()) })
    }
}

/// What an import wrote.
pub(crate) struct Imported {
    pub(crate) entry: EntryId,
    pub(crate) layer: Layer,
    pub(crate) made_layer: bool,
    pub(crate) pages: Vec<PageKey>,
    /// Samples beyond the terrain's edge.
    pub(crate) num_left_out: u64,
}

/// Writes a raster into a layer, as one entry of the history.
///
/// # Errors
/// As [`Terrain::import`]; the recording is then to be dropped.
pub(crate) fn run_import(
    recording: &mut Recording<'_>,
    raster: &mut Import,
    request: &ImportRequest,
    grid: TerrainGrid,
    author: &str,
    max_band_bytes: u64,
    observer: &mut dyn Observer,
) -> Result<Imported> {
    let (width, depth) = (raster.info().width, raster.info().depth);
    let target = raster_rect(&grid, request.at_m, width, depth)?;
    let inside = target.intersection(&grid.bounds());
    let read_at = stamp(&request.file)?;
    let (layer, made_layer) = target_layer(recording, request.layer.as_deref())?;
    let pages = write_rows(recording, raster, &layer, target, &inside, max_band_bytes, observer)?;
    let operation = RecordedImport {
        op: RecordedImport::OP.to_owned(),
        layer: layer.id,
        new_layer: made_layer.then(|| layer.name.clone()),
        file: request.file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        blake3: keep_file(recording, &request.file)?.to_string(),
        options: request.options.clone(),
        at: request.at_m,
        width,
        depth,
    };
    if stamp(&request.file)? != read_at {
        let source = std::io::Error::other("it was changed while it was imported: import it again");
        return Err(Error::Read { path: request.file.clone(), source });
    }
    let entry = recording.record(operation.to_json()?, author)?;
    let num_left_out = target.area() - inside.area();
    Ok(Imported { entry, layer, made_layer, pages, num_left_out })
}

/// What the history records of an import: with the data that it names, enough to do it again.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RecordedImport {
    pub(crate) op: String,
    /// The layer's id.
    pub(crate) layer: u32,
    /// Its name, where it was made for the import.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) new_layer: Option<String>,
    /// The file's name, whose ending may tell the format.
    pub(crate) file: String,
    /// The name of its content.
    pub(crate) blake3: String,
    pub(crate) options: ImportOptions,
    pub(crate) at: [f64; 2],
    pub(crate) width: u32,
    pub(crate) depth: u32,
}

impl RecordedImport {
    pub(crate) const OP: &str = "import";

    fn to_json(&self) -> Result<String> {
        serde_json::to_string(self)
            .map_err(|err| Error::Operation { place: "the import".to_owned(), detail: err.to_string() })
    }
}

/// What changes with a file: its length and time.
fn stamp(file: &Path) -> Result<(u64, Option<SystemTime>)> {
    let metadata = std::fs::metadata(file).map_err(|source| Error::Read { path: file.to_owned(), source })?;
    Ok((metadata.len(), metadata.modified().ok()))
}

/// Keeps the file's content with the terrain, and gives its name.
fn keep_file(recording: &mut Recording<'_>, file: &Path) -> Result<BlobHash> {
    let failed = |source| Error::Read { path: file.to_owned(), source };
    let mut content = File::open(file).map_err(failed)?;
    Ok(recording.with_transaction(move |transaction| transaction.keep_blob(&mut content))?)
}

fn raster_rect(grid: &TerrainGrid, at_m: [f64; 2], width: u32, depth: u32) -> Result<SampleRect> {
    let outside = || Error::OutsideTerrain {
        what: format!("the raster of {width} x {depth} samples at [{}, {}] m", at_m[0], at_m[1]),
        width_m: f64::from(grid.width()) * grid.spacing_m(),
        depth_m: f64::from(grid.depth()) * grid.spacing_m(),
    };
    let [x, z] = grid.sample_from_world(at_m).map(f64::round);
    let limit = f64::from(orogeny_field::MAX_SIDE_SAMPLES);
    if !(x.abs() <= limit && z.abs() <= limit) {
        return Err(outside());
    }
    let (x, z) = (x as i32, z as i32);
    let rect = SampleRect::new(x, z, x.saturating_add_unsigned(width), z.saturating_add_unsigned(depth));
    if rect.intersection(&grid.bounds()).is_empty() { Err(outside()) } else { Ok(rect) }
}

fn target_layer(recording: &mut Recording<'_>, name: Option<&str>) -> Result<(Layer, bool)> {
    let reference = name.map(|name| LayerReference::Name(name.to_owned()));
    match (find_layer(recording.layers(), reference.as_ref()), name) {
        (Ok(layer), _) => {
            refuse_locked(recording.layers(), layer)?;
            if layer.content != LayerContent::Heights || !layer.transform.is_identity() {
                let why = "it is not made of heights that lie where they are: give the name of a new layer"
                    .to_owned();
                return Err(refused(layer, "imported into", why));
            }
            Ok((layer.clone(), false))
        }
        (Err(_), Some(name)) => {
            let layer = recording.add_layer(NewLayer { name: name.to_owned(), constant_m: 0.0 })?;
            Ok((layer, true))
        }
        (Err(err), None) => Err(err),
    }
}

/// Writes the raster's rows into pages, a row of pages at a time, and gives the pages written. A row of pages of which
/// `max_band_bytes` hold only a part is written in several goes.
fn write_rows(
    recording: &mut Recording<'_>,
    raster: &mut Import,
    layer: &Layer,
    target: SampleRect,
    inside: &SampleRect,
    max_band_bytes: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<PageKey>> {
    let layout = recording.layout()?;
    let mut written = Vec::new();
    let mut band = Band::new(layout, layer, inside, max_band_bytes);
    let mut row = vec![0.0; target.width() as usize];
    let skipped = inside.x0.abs_diff(target.x0) as usize;
    let mut z = target.z0;
    while raster.read_rows(&mut row)? > 0 {
        let Some(heights) = row.get(skipped..skipped + inside.width() as usize) else { break };
        if (inside.z0..inside.z1).contains(&z) {
            band.push(heights);
            if band.is_complete(z + 1) {
                written.extend(band.write(recording)?);
            }
        }
        z += 1;
        report(observer, "importing", u64::from(z.abs_diff(target.z0)), u64::from(target.depth()))?;
    }
    Ok(written)
}

/// Rows of a raster that lie in one row of pages, on their way into it.
struct Band<'a> {
    layout: PageLayout,
    layer: &'a Layer,
    inside: &'a SampleRect,
    /// The first of its rows.
    z0: i32,
    rows: Vec<f32>,
    max_rows: i32,
}

impl<'a> Band<'a> {
    fn new(layout: PageLayout, layer: &'a Layer, inside: &'a SampleRect, max_bytes: u64) -> Self {
        let max_rows = band_rows(inside.width(), max_bytes);
        Self { layout, layer, inside, z0: inside.z0, rows: Vec::new(), max_rows }
    }

    fn push(&mut self, heights: &[f32]) {
        self.rows.extend_from_slice(heights);
    }

    /// Whether the rows up to `z1` are to be written: the row of pages is full, or as much of it as fits.
    fn is_complete(&self, z1: i32) -> bool {
        let is_page_end = z1.cast_unsigned().is_multiple_of(self.layout.size());
        is_page_end || z1 == self.inside.z1 || z1 - self.z0 >= self.max_rows
    }

    /// Writes the rows into the pages that they cross, and begins anew after them.
    fn write(&mut self, recording: &mut Recording<'_>) -> Result<Vec<PageKey>> {
        let width = self.inside.width() as usize;
        let num_rows = (self.rows.len() / width.max(1)) as i32;
        let rect = SampleRect::new(self.inside.x0, self.z0, self.inside.x1, self.z0 + num_rows);
        let keys: Vec<_> = self
            .layout
            .pages_in(rect)
            .map(|(x, z)| PageKey::full_resolution(self.layer.heights, x, z))
            .collect();
        for keys in keys.chunks(PAGES_AT_ONCE) {
            let mut pages = Vec::with_capacity(keys.len());
            for key in keys {
                let page = recording.load_page(key)?.map(Arc::unwrap_or_clone);
                let mut page = page.unwrap_or_else(|| Page::constant(self.layout, self.layer.constant_m));
                let page_rect = self.layout.page_rect(key);
                let part = page_rect.intersection(&rect);
                let columns = (part.x0.abs_diff(page_rect.x0), part.x1.abs_diff(page_rect.x0));
                for z in part.z0..part.z1 {
                    let start = z.abs_diff(rect.z0) as usize * width + part.x0.abs_diff(rect.x0) as usize;
                    let from = self.rows.get(start..start + part.width() as usize);
                    let to = page.row_mut(z.abs_diff(page_rect.z0), columns.0, columns.1);
                    if let (Some(to), Some(from)) = (to, from) {
                        to.copy_from_slice(from);
                    }
                }
                pages.push((*key, page));
            }
            recording.write_pages(pages)?;
        }
        self.z0 += num_rows;
        self.rows.clear();
        Ok(keys)
    }
}

impl ImportRequest {
    /// A file at the north-west corner, read as it says of itself, into the lowest layer.
    #[must_use]
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), options: ImportOptions::default(), layer: None, at_m: [0.0, 0.0] }
    }
}
