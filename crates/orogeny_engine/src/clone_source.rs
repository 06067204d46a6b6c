//! The ground that a clone brush copies: a field of the terrain, or data from outside, of which what is needed is kept.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use orogeny_brush::CloneGround;
use orogeny_field::{
    Alignment, Brush, BrushType, DataSource, FieldId, LayerContent, Placement, Plane, SampleRect, TerrainGrid,
};
use orogeny_formats::{ExportOptions, ImportOptions};
use orogeny_store::{Layer, Recording};
use tempfile::TempDir;

use crate::access::{Access, band_bytes};
use crate::composite::{Composite, Compositor, Source};
use crate::layers::refused;
use crate::operation::BrushOperation;
use crate::resources;
use crate::terrain::find_layer;
use crate::{Adapter, Error, LayerReference, Result, Settings, Target};

/// The most samples of data from outside: as many as a picture for a brush may have.
const MAX_SAMPLES: u64 = 4096 * 4096;
/// The most bytes of them, with what a file says of itself.
const MAX_BYTES: u64 = MAX_SAMPLES * 4 + (1 << 10);
/// The ending of terrains.
const TERRAIN_ENDING: &str = "orogeny";

/// Loads what an operation's brush clones, and names it in the brush as a recorded operation does: layers by their ids, data
/// by its content.
///
/// # Errors
/// [`Error::UnknownLayer`]; [`Error::Read`], [`Error::Format`], [`Error::CloneSource`] or [`Error::Store`], naming the file.
pub(crate) fn load(
    operation: &BrushOperation,
    brush: &mut Brush,
    painted: FieldId,
    grid: &TerrainGrid,
    recording: &mut Recording<'_>,
) -> Result<Option<CloneGround>> {
    if brush.brush_type != BrushType::Clone {
        return Ok(None);
    }
    let Some(data) = brush.cloning.source.data.clone() else {
        let Some(reference) = brush.cloning.source.layer.clone() else {
            // What is painted on itself.
            return Ok(Some(CloneGround::Field(painted)));
        };
        let from = find_layer(recording.layers(), Some(&reference))?.clone();
        brush.cloning.source.layer = Some(LayerReference::Id(from.id));
        check_cloneable(&from, operation.target())?;
        let field = match operation.target() {
            Target::Seen | Target::Heights => from.heights,
            Target::Mask => recording.with_mask(&from)?.mask.unwrap_or(from.heights),
            Target::Selection => recording.selection()?,
        };
        return Ok(Some(CloneGround::Field(field)));
    };
    let (plane, spacing_m) = match data {
        DataSource::File(file) => {
            let cut = cut_out(operation, brush, grid, Path::new(&file))?;
            let bytes = bytes_of(&cut.plane)?;
            let hash = recording
                .with_transaction(move |transaction| transaction.keep_blob(&mut bytes.as_slice()))?;
            let source = &mut brush.cloning.source;
            // What was left out to the north and west is no longer there.
            let [x, z] = source.at_m;
            let [first_x, first_z] = cut.first.map(|first| f64::from(first) * cut.spacing_m);
            source.at_m = [x - first_x, z - first_z];
            source.region_m =
                source.region_m.map(|[x, z, width, depth]| [x - first_x, z - first_z, width, depth]);
            source.data = Some(DataSource::Blake3(hash.to_string()));
            (source.spacing_m, source.range_m) = (Some(cut.spacing_m), None);
            (cut.plane, cut.spacing_m)
        }
        DataSource::Blake3(_) => {
            let bytes = resources::kept(&data, MAX_BYTES, recording)?;
            let spacing_m = brush.cloning.source.spacing_m.unwrap_or_else(|| grid.spacing_m());
            (plane_of(&bytes)?, spacing_m)
        }
    };
    Ok(Some(CloneGround::Raster { heights: Arc::new(plane), spacing_m }))
}

/// Refuses a layer whose heights, or whose mask, are not stored where they lie.
fn check_cloneable(from: &Layer, target: Target) -> Result<()> {
    let is_made = from.content != LayerContent::Heights && target.is_heights();
    let is_moved = !from.transform.is_identity() && target != Target::Selection;
    if is_made || is_moved {
        let why = "it is not made of heights that lie where they are: collapse it first".to_owned();
        return Err(refused(from, "cloned", why));
    }
    Ok(())
}

/// A part of data from outside.
struct Cut {
    /// From sample (0, 0) on.
    plane: Plane,
    /// Where that was.
    first: [i32; 2],
    spacing_m: f64,
}

/// Reads as much of a file as an operation needs.
fn cut_out(operation: &BrushOperation, brush: &Brush, grid: &TerrainGrid, file: &Path) -> Result<Cut> {
    let is_terrain = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(TERRAIN_ENDING));
    if is_terrain {
        let access = Access::reading(file)?;
        let store = access.settled()?;
        let spacing_m = brush.cloning.source.spacing_m.unwrap_or_else(|| store.grid().spacing_m());
        let bounds = store.grid().bounds();
        let rect = needed(operation, brush, grid, spacing_m, &bounds, file)?;
        let compositor =
            RefCell::new(Compositor::new(&Settings { adapter: Adapter::Cpu, ..Settings::default() }));
        let mut rows = Composite::new(store, &compositor, Source::Composite, 0, rect, band_bytes(0));
        let plane = read(rect, rect, |row| rows.read_rows(row).map(drop))?;
        return Ok(Cut { plane, first: [rect.x0, rect.z0], spacing_m });
    }
    let source = &brush.cloning.source;
    let options = ImportOptions {
        range_m: source.range_m.map(|[low, high]| (low, high)),
        spacing_m: source.spacing_m,
        ..ImportOptions::default()
    };
    let mut raster = orogeny_formats::open(file, &options)?;
    let info = raster.info();
    let spacing_m = info.spacing_m.unwrap_or_else(|| grid.spacing_m());
    let bounds = SampleRect::new(0, 0, info.width.cast_signed(), info.depth.cast_signed());
    let rect = needed(operation, brush, grid, spacing_m, &bounds, file)?;
    let plane = read(bounds, rect, |row| Ok(raster.read_rows(row).map(drop)?))?;
    Ok(Cut { plane, first: [rect.x0, rect.z0], spacing_m })
}

/// Reads rows of a rectangle from the first on and keeps those of another within it, from sample (0, 0) on.
fn read(rows: SampleRect, rect: SampleRect, mut next: impl FnMut(&mut [f32]) -> Result<()>) -> Result<Plane> {
    let (width, first) = (rect.width() as usize, rect.x0.abs_diff(rows.x0) as usize);
    let mut samples = Vec::with_capacity(rect.area() as usize);
    let mut row = vec![0.0; rows.width() as usize];
    for z in rows.z0..rect.z1 {
        next(&mut row)?;
        if z >= rect.z0 {
            samples.extend_from_slice(row.get(first..first + width).unwrap_or_default());
        }
    }
    let from_zero = SampleRect::new(0, 0, rect.width().cast_signed(), rect.depth().cast_signed());
    Ok(Plane::from_samples(from_zero, 1, samples)?)
}

/// The samples of a source of `bounds` that an operation may look at: all where these are few, else those that come to lie
/// where it acts, and as many around them.
fn needed(
    operation: &BrushOperation,
    brush: &Brush,
    grid: &TerrainGrid,
    spacing_m: f64,
    bounds: &SampleRect,
    file: &Path,
) -> Result<SampleRect> {
    if bounds.area() <= MAX_SAMPLES {
        return Ok(*bounds);
    }
    let source = &brush.cloning.source;
    let (reached, first_m) = reached(operation, brush, grid)?;
    let is_fill = matches!(operation, BrushOperation::Fill { .. });
    let is_aligned = is_fill || source.alignment == Alignment::Aligned;
    let to_m = source.to_m.filter(|_| is_aligned).unwrap_or(first_m);
    let placement = Placement::new(&source.placing(to_m, spacing_m, grid.spacing_m()));
    let rect = placement.source_rect(&reached);
    let margin = rect.width().max(rect.depth()).cast_signed() / 2 + 16;
    let rect = rect.grown(margin).intersection(bounds);
    let refused = |detail: String| Err(Error::CloneSource { path: file.to_owned(), detail });
    if rect.is_empty() {
        return refused("none of it comes to lie where the brush acts".to_owned());
    }
    if rect.area() > MAX_SAMPLES {
        let (width, depth) = (rect.width(), rect.depth());
        return refused(format!(
            "it takes {width} x {depth} of its samples, and at most {MAX_SAMPLES} are kept; use a smaller radius or region, or a larger `scale`"
        ));
    }
    Ok(rect)
}

/// The samples where an operation may act, and its first place in metres.
fn reached(operation: &BrushOperation, brush: &Brush, grid: &TerrainGrid) -> Result<(SampleRect, [f64; 2])> {
    let BrushOperation::Stroke { stroke, .. } = operation else {
        let BrushOperation::Fill { region_m: Some(region_m), .. } = operation else {
            return Ok((grid.bounds(), [0.0; 2]));
        };
        return Ok((grid.samples_in_region(*region_m)?, [0.0; 2]));
    };
    let first_m = stroke.points.first().map_or([0.0; 2], |point| point.position_m);
    if brush.symmetry.is_some() || brush.cloning.source.alignment == Alignment::Fixed {
        return Ok((grid.bounds(), first_m));
    }
    // The curve through the points swings out by no more than they are apart.
    let radius = brush.radius_m * (1.0 + brush.jitter.position) / grid.spacing_m();
    let mut rect = SampleRect::EMPTY;
    for point in &stroke.points {
        let [x, z] = grid.sample_from_world(point.position_m);
        let along = |place: f64| ((place - radius).floor() as i32, (place + radius).ceil() as i32 + 1);
        let ((x0, x1), (z0, z1)) = (along(x), along(z));
        rect = rect.bounds_with(&SampleRect::new(x0, z0, x1, z1));
    }
    Ok((rect.intersection(&grid.bounds()), first_m))
}

/// A plane as a file's bytes.
fn bytes_of(plane: &Plane) -> Result<Vec<u8>> {
    let (_folder, path) = temporary_file()?;
    let rect = plane.rect();
    let mut export = orogeny_formats::create(&path, &ExportOptions::default(), rect.width(), rect.depth())?;
    export.write_rows(plane.samples())?;
    export.finish()?;
    resources::read(&path, MAX_BYTES)
}

/// The plane of a file's bytes.
fn plane_of(bytes: &[u8]) -> Result<Plane> {
    let (_folder, path) = temporary_file()?;
    std::fs::write(&path, bytes).map_err(|source| Error::Write { path: path.clone(), source })?;
    let mut raster = orogeny_formats::open(&path, &ImportOptions::default())?;
    let bounds = SampleRect::new(0, 0, raster.info().width.cast_signed(), raster.info().depth.cast_signed());
    read(bounds, bounds, |row| Ok(raster.read_rows(row).map(drop)?))
}

/// A name for a file of heights, in a folder that goes with its handle.
fn temporary_file() -> Result<(TempDir, PathBuf)> {
    let folder = tempfile::tempdir().map_err(|source| Error::Write { path: std::env::temp_dir(), source })?;
    let path = folder.path().join("clone").with_extension(resources::HEIGHTS_ENDING);
    Ok((folder, path))
}
