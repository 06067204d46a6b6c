//! From a file of another program to a terrain, or to a layer of one.

use std::fs::File;
use std::path::{Path, PathBuf};

use orogeny_field::{Page, PageKey, SampleRect, TerrainGrid};
use orogeny_formats::{Import, ImportOptions, NodataPolicy};
use orogeny_store::{EntryId, Layer, NewLayer, Transaction};

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
        let target = raster_rect(&grid, request.at_m, width, depth)?;
        let inside = target.intersection(&grid.bounds());
        if inside != target {
            notices.push(format!(
                "{} samples beyond the terrain's edge were left out",
                target.area() - inside.area()
            ));
        }
        let author = self.settings().author.clone();
        let mut transaction = self.store_mut().begin()?;
        let (layer, made_layer) = target_layer(&mut transaction, request.layer.as_deref())?;
        let written = write_rows(&mut transaction, raster, &layer, target, &inside, observer)?;
        let operation = serde_json::json!({
            "op": "import",
            "layer": layer.id,
            "file": request.file.file_name().unwrap_or_default().to_string_lossy(),
            "blake3": hash_of(&request.file)?,
            "options": recorded_options(&request.options),
            "at": request.at_m,
            "width": width,
            "depth": depth,
        });
        let entry = transaction.commit(&operation.to_string(), &author)?;
        self.forget_pages(&written);
        Ok(ImportSummary {
            entry,
            width,
            depth,
            spacing_m: grid.spacing_m(),
            layer: layer.name,
            made_layer,
            notices,
        })
    }
}

/// Names the file's content, whatever becomes of the file.
fn hash_of(file: &Path) -> Result<String> {
    let failed = |source| Error::Read { path: file.to_owned(), source };
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(file).map_err(failed)?).map_err(failed)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// What was said about the file: with the file, enough to read it in the same way.
fn recorded_options(options: &ImportOptions) -> serde_json::Value {
    let name = |value: Option<String>| value.map(|value| value.to_lowercase());
    serde_json::json!({
        "format": name(options.format.map(|format| format!("{format:?}"))),
        "size": options.size,
        "sample": name(options.sample.map(|sample| format!("{sample:?}"))),
        "byte_order": name(options.byte_order.map(|byte_order| format!("{byte_order:?}"))),
        "range": options.range_m,
        "nodata": match options.nodata {
            NodataPolicy::Fill => "fill".into(),
            NodataPolicy::Value(height_m) => serde_json::Value::from(height_m),
            _ => "refuse".into(),
        },
        "spacing": options.spacing_m,
    })
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

fn target_layer(transaction: &mut Transaction<'_>, name: Option<&str>) -> Result<(Layer, bool)> {
    let reference = name.map(|name| LayerReference::Name(name.to_owned()));
    match (find_layer(transaction.layers(), reference.as_ref()), name) {
        (Ok(layer), _) => Ok((layer.clone(), false)),
        (Err(_), Some(name)) => {
            let layer = transaction.add_layer(&NewLayer { name: name.to_owned(), constant_m: 0.0 })?;
            Ok((layer, true))
        }
        (Err(err), None) => Err(err),
    }
}

/// Writes the raster's rows into pages, a row of pages at a time, and gives the pages written.
fn write_rows(
    transaction: &mut Transaction<'_>,
    raster: &mut Import,
    layer: &Layer,
    target: SampleRect,
    inside: &SampleRect,
    observer: &mut dyn Observer,
) -> Result<Vec<PageKey>> {
    let layout = transaction.layout();
    let mut written = Vec::new();
    let mut band: Vec<(PageKey, Page)> = Vec::new();
    let mut row = vec![0.0; target.width() as usize];
    let skipped = inside.x0.abs_diff(target.x0) as usize;
    let mut z = target.z0;
    while raster.read_rows(&mut row)? > 0 {
        let Some(heights) = row.get(skipped..skipped + inside.width() as usize) else { break };
        if (inside.z0..inside.z1).contains(&z) {
            let first_of_band = band.is_empty();
            if first_of_band {
                band = load_band(transaction, layer, &SampleRect::new(inside.x0, z, inside.x1, z + 1))?;
            }
            for (key, page) in &mut band {
                let rect = layout.page_rect(key);
                let part = rect.intersection(inside);
                let source = part.x0.abs_diff(inside.x0) as usize;
                let columns = (part.x0.abs_diff(rect.x0), part.x1.abs_diff(rect.x0));
                let to = page.row_mut(z.abs_diff(rect.z0), columns.0, columns.1);
                let from = heights.get(source..source + part.width() as usize);
                if let (Some(to), Some(from)) = (to, from) {
                    to.copy_from_slice(from);
                }
            }
            let is_last_of_band = (z + 1).cast_unsigned().is_multiple_of(layout.size()) || z + 1 == inside.z1;
            if is_last_of_band {
                transaction.write_pages(&band)?;
                written.extend(band.drain(..).map(|(key, _)| key));
            }
        }
        z += 1;
        report(observer, "importing", u64::from(z.abs_diff(target.z0)), u64::from(target.depth()))?;
    }
    Ok(written)
}

/// The pages that a row crosses, as they are.
fn load_band(transaction: &Transaction<'_>, layer: &Layer, row: &SampleRect) -> Result<Vec<(PageKey, Page)>> {
    let layout = transaction.layout();
    let load = |(x, z)| {
        let key = PageKey::full_resolution(layer.heights, x, z);
        let page = transaction.load_page(&key)?.unwrap_or_else(|| Page::constant(layout, layer.constant_m));
        Ok((key, page))
    };
    layout.pages_in(*row).map(load).collect()
}

impl ImportRequest {
    /// A file at the north-west corner, read as it says of itself, into the lowest layer.
    #[must_use]
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), options: ImportOptions::default(), layer: None, at_m: [0.0, 0.0] }
    }
}
