//! A terrain in numbers: what it is, what it takes, how high it is.

use orogeny_field::{Blend, LayerTransform, MaskTerm};
use orogeny_store::HistorySummary;

use crate::composite::Source;
use crate::layers::is_stale;
use crate::progress::report;
use crate::{Observer, Result, Terrain};

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
    /// `heights`, `procedural`, `effect` or `group`.
    pub content: &'static str,
    /// The brush that makes it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brush: Option<&'static str>,
    /// Whether it counts.
    pub visible: bool,
    /// Whether it is protected from being painted on.
    pub locked: bool,
    /// How much it counts, 0..1.
    pub opacity: f32,
    /// How it joins what is below.
    pub blend: Blend,
    /// Whether its mask was painted.
    pub has_painted_mask: bool,
    /// What else its mask is worked out from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mask_terms: Vec<MaskTerm>,
    /// Where its heights were moved to.
    #[serde(skip_serializing_if = "LayerTransform::is_identity")]
    pub transform: LayerTransform,
    /// The group that it is in, by its id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub group: Option<u32>,
    /// Whether it is an effect that is kept, and what is below was changed since it was worked out.
    pub is_stale: bool,
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
    /// The terrain in numbers.
    ///
    /// # Errors
    /// [`crate::Error::Store`] when the file cannot be read.
    pub fn describe(&self) -> Result<Description> {
        let (grid, store) = (self.grid(), self.settled()?);
        let layers = store.layers().iter().map(|layer| {
            Ok(LayerDescription {
                id: layer.id,
                name: layer.name.clone(),
                constant_m: layer.constant_m,
                content: layer.content.name(),
                brush: layer.content.procedure().map(|procedure| procedure.brush.brush_type.name()),
                visible: layer.visible,
                locked: layer.locked,
                opacity: layer.opacity,
                blend: layer.blend,
                has_painted_mask: layer.mask.is_some(),
                mask_terms: layer.mask_terms.clone(),
                transform: layer.transform,
                group: layer.group,
                is_stale: is_stale(store, layer)?,
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
        let executor = self.executor_memory();
        MemoryUse {
            budget_in_bytes: self.settings().page_budget_in_bytes,
            pages_in_bytes: executor.host_in_bytes + self.compositor().borrow().memory_in_bytes(),
            textures_in_bytes: executor.textures_in_bytes,
            store_in_bytes: self.store_memory_in_bytes(),
        }
    }

    /// Lowest, highest and mean height of the composite. Reads every painted page, and no other.
    ///
    /// # Errors
    /// [`crate::Error::Store`] when a page cannot be read; [`crate::Error::Cancelled`].
    pub fn height_statistics(&self, observer: &mut dyn Observer) -> Result<HeightStatistics> {
        let bounds = self.grid().bounds();
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
}
