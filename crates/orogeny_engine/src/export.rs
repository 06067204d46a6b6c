//! From a terrain to a file of another program.

use std::path::PathBuf;

use orogeny_field::{LayerContent, SampleRect};
use orogeny_formats::ExportOptions;

use crate::access::Access;
use crate::composite::{Look, RecorderPages, Source, read};
use crate::layers::refused;
use crate::progress::report;
use crate::{Error, LayerReference, Observer, Result, Terrain};

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
    /// The place of the first sample, `[x, z]` in metres.
    pub at_m: [f64; 2],
    /// Metres between samples.
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
        }
    }
}

impl Terrain {
    /// Writes heights to a file, which appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Format`] when the heights do not fit the format or the file cannot be written; [`Error::OutsideTerrain`];
    /// [`Error::UnknownLayer`]; [`Error::Store`].
    pub fn export(&self, request: &ExportRequest, observer: &mut dyn Observer) -> Result<ExportSummary> {
        let level = request.level;
        let rect = self.region_at(request.region_m, level)?;
        let source = self.source(&request.source)?;
        let mut options = request.options.clone();
        options.spacing_m.get_or_insert(self.grid().spacing_m() * f64::from(1_u32 << level));
        let (width, depth) = (rect.width(), rect.depth());
        let mut file = orogeny_formats::create(&request.file, &options, width, depth)?;
        let mut composite = self.composite(source, level, rect)?;
        let mut row = vec![0.0; width as usize];
        let mut num_rows = 0;
        while composite.read_rows(&mut row)? > 0 {
            file.write_rows(&row)?;
            num_rows += 1;
            report(observer, "exporting", num_rows, u64::from(depth))?;
        }
        let notices = file.finish()?.notices;
        let spacing_m = self.grid().spacing_m() * f64::from(1_u32 << level);
        let at_m = [rect.x0, rect.z0].map(|sample| f64::from(sample) * spacing_m);
        Ok(ExportSummary { file: request.file.clone(), width, depth, at_m, spacing_m, notices })
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
