//! From a terrain to a file of another program.

use std::path::PathBuf;

use orogeny_field::{LayerContent, SampleRect};
use orogeny_formats::{ByteOrder, Direction, ExportOptions, Format, MAX_SAMPLES_PER_SIDE, SampleType};

use crate::access::Access;
use crate::composite::{Look, RecorderPages, Source, read};
use crate::fit::{Axis, ExportSize, Fit};
use crate::layers::refused;
use crate::presets::{ExportPreset, PlannedExport};
use crate::progress::report;
use crate::{Error, LayerReference, Observer, Quiet, Result, Terrain};

/// What to export, and where to.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportRequest {
    /// The file; its ending tells the format.
    pub file: PathBuf,
    /// How to write it. The spacing is the terrain's where none is given.
    pub options: ExportOptions,
    /// What of the terrain.
    pub source: ExportSource,
    /// `[x, z, width, depth]` in metres, far edges outside; `None`: the whole terrain.
    pub region_m: Option<[f64; 4]>,
    /// 0 for full resolution; each next level has a sample for two each way.
    pub level: u8,
    /// The number of samples that the file is to have; `None`: as many as there are.
    pub size: Option<ExportSize>,
    /// Whether the southern row comes first, for programs whose depth grows to the north.
    pub is_south_first: bool,
}

/// What of a terrain is exported.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ExportSource {
    /// What all layers come to.
    #[default]
    Composite,
    /// One layer alone: what it is made of, whether it counts or not.
    Layer(LayerReference),
    /// How much a layer counts where, 0..1, by its mask and those of its groups.
    Mask(LayerReference),
    /// How much is selected, 0..1.
    Selection,
}

/// What an export wrote.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ExportSummary {
    /// The file.
    pub file: PathBuf,
    /// Samples along x.
    pub width: u32,
    /// Samples along z.
    pub depth: u32,
    /// The place of the north-west sample, `[x, z]` in metres.
    pub at_m: [f64; 2],
    /// Metres between samples, along x.
    pub spacing_m: f64,
    /// What was rounded or left out, for people.
    pub notices: Vec<String>,
}

impl ExportRequest {
    /// The whole composite to a file.
    #[must_use]
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self {
            file: file.into(),
            options: ExportOptions::default(),
            source: ExportSource::Composite,
            region_m: None,
            level: 0,
            size: None,
            is_south_first: false,
        }
    }

    /// The samples that it is going to write of so many, and how they come about.
    fn size_of(&self, samples: [u32; 2]) -> ([u32; 2], Fit) {
        self.size.map_or((samples, Fit::Middle), |size| ([size.width, size.depth], size.fit))
    }

    /// Whether a file can have as many samples as it is to have.
    fn is_size(&self, samples: [u32; 2]) -> bool {
        self.size_of(samples).0.iter().all(|side| (1..=MAX_SAMPLES_PER_SIDE).contains(side))
    }

    /// What it is going to write of so many samples, so far apart.
    #[must_use]
    pub fn planned(&self, samples: [u32; 2], spacing_m: f64) -> PlannedExport {
        let (size, fit) = self.size_of(samples);
        let sample = self.options.sample.unwrap_or_else(|| match self.options.format {
            Some(format) => sample_of(format),
            None => Format::from_path(&self.file, Direction::Export).map_or(SampleType::U16, sample_of),
        });
        let [width, depth] = size.map(u64::from);
        PlannedExport {
            size,
            spacing_m: spacings_m(fit, samples, size, spacing_m),
            range_m: self.options.range_m.map(Into::into),
            // Sizes that are going to be refused have a plan too.
            num_bytes: width.saturating_mul(depth).saturating_mul(u64::from(sample.bytes())),
            byte_order: self.options.byte_order.unwrap_or(ByteOrder::Little),
            is_south_first: self.is_south_first,
        }
    }
}

/// Metres between samples along x and z once they are others, which are so far apart.
fn spacings_m(fit: Fit, samples: [u32; 2], size: [u32; 2], spacing_m: f64) -> [f64; 2] {
    let ([from_x, from_z], [to_x, to_z]) = (samples, size);
    // One sample alone has no distance to another.
    [fit.step(from_x, to_x), fit.step(from_z, to_z)]
        .map(|step| if step > 0.0 { step * spacing_m } else { spacing_m })
}

/// How a format stores a sample where nothing is said of it.
const fn sample_of(format: Format) -> SampleType {
    match format {
        Format::Png | Format::R16 | Format::Raw => SampleType::U16,
        Format::Hgt => SampleType::I16,
        _ => SampleType::F32,
    }
}

/// Where the rows of a file are read.
struct Reading {
    source: Source,
    /// The region at the level that was asked for.
    rect: SampleRect,
    /// The level that is read, and its samples in the region.
    read: (u8, SampleRect),
    /// Where along x and z samples are read; `None`: all of them as they are, the northern row first.
    axes: Option<[Axis; 2]>,
}

impl Terrain {
    /// Lets a preset say what a request does not say: size, samples, order and range; and how a number of samples comes about, unless
    /// that is said. Tells what is going to be written.
    ///
    /// # Errors
    /// [`Error::Preset`] for one that is for files of another format; as [`Self::export`], for what cannot be read.
    pub fn take_preset(
        &self,
        request: &mut ExportRequest,
        preset: &ExportPreset,
        fit: Option<Fit>,
    ) -> Result<PlannedExport> {
        preset.check_file(&request.file)?;
        let rect = self.region_at(request.region_m, request.level)?;
        let samples = [rect.width(), rect.depth()];
        let fit = fit.unwrap_or(preset.fit);
        let of_preset =
            || preset.sizes.nearest_size(samples).map(|[width, depth]| ExportSize { width, depth, fit });
        request.size = request.size.or_else(of_preset);
        request.is_south_first |= preset.is_south_first;
        let options = &mut request.options;
        options.sample = options.sample.or(preset.sample);
        options.byte_order = options.byte_order.or(preset.byte_order);
        // A size that is going to be refused has no heights.
        if options.range_m.is_none() && preset.is_scaled() && request.is_size(samples) {
            let mut range_m = [f64::INFINITY, f64::NEG_INFINITY];
            let reading = self.reading(request)?;
            self.rows(&reading, request.is_south_first, &mut Quiet, |row| {
                for height_m in row.iter().copied().map(f64::from) {
                    range_m = [range_m[0].min(height_m), range_m[1].max(height_m)];
                }
                Ok(())
            })?;
            request.options.range_m = preset.range_m(range_m).map(Into::into);
        }
        Ok(request.planned(samples, self.grid().spacing_m() * f64::from(1_u32 << request.level)))
    }

    /// Writes heights to a file, which appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Format`] when the heights do not fit the format or the file cannot be written; [`Error::OutsideTerrain`];
    /// [`Error::UnknownLayer`]; [`Error::Store`].
    pub fn export(&self, request: &ExportRequest, observer: &mut dyn Observer) -> Result<ExportSummary> {
        let reading = self.reading(request)?;
        let rect = reading.rect;
        let spacing_m = self.grid().spacing_m() * f64::from(1_u32 << request.level);
        let samples = [rect.width(), rect.depth()];
        let ([width, depth], fit) = request.size_of(samples);
        let [spacing_x_m, spacing_z_m] = spacings_m(fit, samples, [width, depth], spacing_m);
        let mut options = request.options.clone();
        options.spacing_m.get_or_insert(spacing_x_m);
        let mut file = orogeny_formats::create(&request.file, &options, width, depth)?;
        self.rows(&reading, request.is_south_first, observer, |row| Ok(file.write_rows(row)?))?;
        let mut notices = file.finish()?.notices;
        if (spacing_x_m - spacing_z_m).abs() > 1.0e-9 * spacing_x_m {
            notices.push(format!(
                "samples are {spacing_x_m:.4} m apart along x, and {spacing_z_m:.4} m along z"
            ));
        }
        if request.is_south_first {
            notices.push(
                "the southern row comes first: what expects the northern one sees it mirrored".to_owned(),
            );
        }
        let [first_x, first_z] = reading.axes.map_or([0.0; 2], |axes| axes.map(|axis| axis.first));
        let at_m = [(f64::from(rect.x0) + first_x) * spacing_m, (f64::from(rect.z0) + first_z) * spacing_m];
        Ok(ExportSummary { file: request.file.clone(), width, depth, at_m, spacing_m: spacing_x_m, notices })
    }

    /// Where what is asked for is read.
    fn reading(&self, request: &ExportRequest) -> Result<Reading> {
        let level = request.level;
        let rect = self.region_at(request.region_m, level)?;
        let source = self.source(&request.source)?;
        let samples = [rect.width(), rect.depth()];
        let is_plain = request.size.is_none() && !request.is_south_first;
        if is_plain || !request.is_size(samples) {
            return Ok(Reading { source, rect, read: (level, rect), axes: None });
        }
        let ([width, depth], fit) = request.size_of(samples);
        let (read_level, read_rect) = match fit {
            Fit::Resample => self.level_for(request, rect, [width, depth])?,
            Fit::Middle => (level, rect),
        };
        let scale = 1 << (read_level - level);
        let along_x = Axis::new(rect.width(), width, fit);
        let along_z = Axis::new(rect.depth(), depth, fit);
        let axes = [
            along_x.coarser(rect.x0, (read_rect.x0, read_rect.width()), scale),
            along_z.coarser(rect.z0, (read_rect.z0, read_rect.depth()), scale),
        ];
        Ok(Reading { source, rect, read: (read_level, read_rect), axes: Some(axes) })
    }

    /// Gives the rows of a file to `take`, in its order.
    fn rows(
        &self,
        reading: &Reading,
        is_south_first: bool,
        observer: &mut dyn Observer,
        mut take: impl FnMut(&[f32]) -> Result<()>,
    ) -> Result<()> {
        let (level, rect) = reading.read;
        if let Some([along_x, along_z]) = &reading.axes {
            let what = (reading.source, level, rect);
            return self.fitted_rows(what, [along_x, along_z], is_south_first, observer, take);
        }
        let mut composite = self.composite(reading.source, level, rect)?;
        let mut row = vec![0.0; rect.width() as usize];
        let mut num_rows = 0;
        while composite.read_rows(&mut row)? > 0 {
            take(&row)?;
            num_rows += 1;
            report(observer, "exporting", num_rows, u64::from(rect.depth()))?;
        }
        Ok(())
    }

    /// The coarsest level that still has as many samples each way as are wanted, and its samples in the region.
    fn level_for(
        &self,
        request: &ExportRequest,
        rect: SampleRect,
        [width, depth]: [u32; 2],
    ) -> Result<(u8, SampleRect)> {
        let top = self.store()?.layout().top_level(&self.grid());
        let region = self.region(request.region_m)?;
        let (mut level, mut samples) = (request.level, rect);
        for coarser in request.level + 1..=top {
            let next = self.samples_at(&region, coarser);
            if next.width() < width || next.depth() < depth {
                break;
            }
            (level, samples) = (coarser, next);
        }
        Ok((level, samples))
    }

    /// The heights of a region at a level, row by row, or a layer's, or how much counts where, as [`Self::export`] writes them; with
    /// the samples along x and z. At full resolution it does not wait for what is on its way to the disk.
    ///
    /// # Errors
    /// [`Error::OutsideTerrain`], [`Error::UnknownLevel`], [`Error::UnknownLayer`], [`Error::Store`].
    pub fn heights(
        &self,
        source: &ExportSource,
        region_m: Option<[f64; 4]>,
        level: u8,
    ) -> Result<(u32, u32, Vec<f32>)> {
        let rect = self.region_at(region_m, level)?;
        let source = self.source(source)?;
        if let (0, Access::Write(recorder)) = (level, self.access()) {
            let _first = recorder.give_way();
            let mut pages = RecorderPages(recorder);
            let mut look = Look::new(self.grid(), level, &mut pages)?;
            let layers = recorder.on_disk()?.layers();
            let plane = read(&mut self.compositor().borrow_mut(), layers, &mut look, source, rect)?;
            return Ok((rect.width(), rect.depth(), plane.into_samples()));
        }
        let mut heights = vec![0.0; usize::try_from(rect.area()).unwrap_or_default()];
        self.composite(source, level, rect)?.read_rows(&mut heights)?;
        Ok((rect.width(), rect.depth(), heights))
    }

    fn source(&self, source: &ExportSource) -> Result<Source> {
        Ok(match source {
            ExportSource::Composite => Source::Composite,
            ExportSource::Layer(layer) => {
                let layer = self.layer(Some(layer))?;
                if layer.content == LayerContent::Group {
                    let why = "it is a group, which has no heights: read one of its layers".to_owned();
                    return Err(refused(layer, "read", why));
                }
                Source::Layer(layer.id)
            }
            ExportSource::Mask(layer) => Source::Mask(self.layer(Some(layer))?.id),
            ExportSource::Selection => Source::Selection,
        })
    }

    /// The samples of a level in a region.
    fn region_at(&self, region_m: Option<[f64; 4]>, level: u8) -> Result<SampleRect> {
        let top = self.store()?.layout().top_level(&self.grid());
        if level > top {
            return Err(Error::UnknownLevel { level, top });
        }
        Ok(self.samples_at(&self.region(region_m)?, level))
    }

    /// The samples of a level that lie on a sample of a rectangle, and at least one each way.
    pub(crate) fn samples_at(&self, rect: &SampleRect, level: u8) -> SampleRect {
        let side = 1_i32 << level;
        let along = |start: i32, end: i32, last: i32| {
            let first = ((start + side - 1) / side).min(last - 1);
            (first, ((end + side - 1) / side).clamp(first + 1, last))
        };
        let bounds = self.grid().bounds_at(level);
        let ((x0, x1), (z0, z1)) = (along(rect.x0, rect.x1, bounds.x1), along(rect.z0, rect.z1, bounds.z1));
        SampleRect::new(x0, z0, x1, z1)
    }

    /// The samples of a region, which touches the terrain; all of them for none.
    pub(crate) fn region(&self, region_m: Option<[f64; 4]>) -> Result<SampleRect> {
        let grid = self.grid();
        let Some(region_m) = region_m else { return Ok(grid.bounds()) };
        let rect = grid.samples_in_region(region_m)?;
        if !rect.is_empty() {
            return Ok(rect);
        }
        Err(Error::OutsideTerrain {
            what: format!("the region {region_m:?}"),
            width_m: f64::from(grid.width()) * grid.spacing_m(),
            depth_m: f64::from(grid.depth()) * grid.spacing_m(),
        })
    }
}

#[cfg(test)]
mod tests {
    use orogeny_field::TerrainGrid;
    use orogeny_formats::{ImportOptions, open};

    use super::*;
    use crate::{Adapter, Operation, Quiet, Settings};

    /// What a file holds, row by row.
    fn written(terrain: &Terrain, request: &ExportRequest) -> (ExportSummary, Vec<f32>) {
        let summary = terrain.export(request, &mut Quiet).unwrap();
        let mut file = open(&request.file, &ImportOptions::default()).unwrap();
        let mut rows = vec![0.0; (summary.width * summary.depth) as usize];
        let mut rest = rows.as_mut_slice();
        while !rest.is_empty() {
            let num_rows = file.read_rows(rest).unwrap();
            rest = &mut rest[num_rows * summary.width as usize..];
        }
        (summary, rows)
    }

    #[test]
    fn a_file_has_the_size_and_the_order_that_were_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
        let path = folder.path().join("t.orogeny");
        let grid = TerrainGrid::new(300, 260, 2.0).unwrap();
        let mut terrain = Terrain::create(&path, grid, 10.0, settings).unwrap();
        let fill = r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 90, "strength": 25}}"#;
        terrain.apply(&[Operation::from_json_text(fill).unwrap()], &mut Quiet).unwrap();
        let (_, _, heights) = terrain.heights(&ExportSource::Composite, None, 0).unwrap();
        let at = |x: usize, z: usize| heights[z * 300 + x];
        let request = ExportRequest::new(folder.path().join("t.npy"));

        let (_, plain) = written(&terrain, &request);
        assert_eq!(plain, heights);
        let (_, from_south) = written(&terrain, &ExportRequest { is_south_first: true, ..request.clone() });
        let turned: Vec<f32> = heights.chunks(300).rev().flatten().copied().collect();
        assert_eq!(from_south, turned);

        let of = |width, depth, fit| Some(ExportSize { width, depth, fit });
        let size = of(200, 300, Fit::Middle);
        let (summary, middle) = written(&terrain, &ExportRequest { size, ..request.clone() });
        assert_eq!((summary.at_m, summary.spacing_m), ([100.0, -40.0], 2.0));
        assert_eq!(
            [middle[0], middle[20 * 200], middle[299 * 200 + 199]],
            [at(50, 0), at(50, 0), at(249, 259)]
        );

        let size = of(599, 519, Fit::Resample);
        let (summary, finer) = written(&terrain, &ExportRequest { size, ..request.clone() });
        assert_eq!((summary.at_m, summary.spacing_m), ([0.0, 0.0], 1.0));
        assert_eq!([finer[0], finer[2], finer[599 * 519 - 1]], [at(0, 0), at(1, 0), at(299, 259)]);
        assert!((finer[599 + 1] - (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0).abs() < 1.0e-4);

        // What is made much smaller is made of means: their mean is that of the heights.
        let mean =
            |all: &[f32]| all.iter().map(|height_m| f64::from(*height_m)).sum::<f64>() / all.len() as f64;
        let size = of(25, 22, Fit::Resample);
        let (_, small) = written(&terrain, &ExportRequest { size, ..request.clone() });
        let spread = |all: &[f32]| {
            all.iter().map(|m| (f64::from(*m) - mean(all)).powi(2)).sum::<f64>() / all.len() as f64
        };
        assert!((mean(&small) - mean(&heights)).abs() < 0.1 * spread(&heights).sqrt(), "{}", mean(&small));
        let size = of(100, 100, Fit::Resample);
        let (summary, _) = written(&terrain, &ExportRequest { size, ..request.clone() });
        assert!(summary.notices.iter().any(|notice| notice.contains("along z")), "{:?}", summary.notices);
        for (width, depth) in [(0, 5), (5, u32::MAX)] {
            let size = of(width, depth, Fit::Resample);
            terrain.export(&ExportRequest { size, ..request.clone() }, &mut Quiet).unwrap_err();
        }
    }
}
