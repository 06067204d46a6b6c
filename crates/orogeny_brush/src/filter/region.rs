//! What is made of a whole region at once: filled pits, masks of flow, droplets.
//!
//! Water runs from one end of a region to the other, so what a sample becomes has no halo that would hold all that it depends
//! on. A region is therefore fixed when an operation is planned, and what is made of it depends on its heights alone, however
//! pages, blocks and batches cut it; it is closed at its border, as though there were nothing beyond.
//!
//! Both back ends work it out on the CPU, once an operation, and keep it until that ends. One implementation gives both the same
//! bits; and there is little to be won on a GPU: a flood goes on from the lowest outlet, areas are summed from the springs down, and
//! droplets write wherever they come.

use std::sync::Arc;

use orogeny_field::{
    Brush, BrushType, DropletKernel, Droplets, FieldId, FillPits, FlowMask, FlowRouting, PageKey, Plane,
    SampleRect, sanitized_height,
};
use orogeny_pages::PageStore;
use orogeny_reference::field::droplets;
use orogeny_reference::field::fill_pits::fill_pits;
use orogeny_reference::field::flow::{flow, flow_mask};

use super::{Filter, Graph, Step, rounds};
use crate::canvas::Canvas;
use crate::execute::Watch;
use crate::{Error, Result};

/// The most samples of a region: 256 MiB of heights, and about six times as much while they are worked on.
pub const MAX_REGION_SAMPLES: u64 = 1 << 26;

/// What is made of the heights of a region before the operation.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionKernel {
    /// The region, within the terrain.
    pub rect: SampleRect,
    /// Whose heights are looked at.
    pub heights: FieldId,
    /// What is made of them.
    pub rule: RegionRule,
}

/// What is made of a region.
#[derive(Debug, Clone, PartialEq)]
pub enum RegionRule {
    /// Heights whose pits are filled.
    FillPits(FillPits),
    /// A mask of where water gathers.
    FlowMask {
        /// How water is shared among lower neighbours.
        routing: FlowRouting,
        /// Which areas are told apart.
        mask: FlowMask,
        /// Metres between samples.
        spacing_m: f64,
    },
    /// Heights eroded by droplets.
    Droplets {
        /// Rock and water.
        kernel: DropletKernel,
        /// How many.
        num_droplets: u32,
    },
}

/// Whether a brush works on a whole region at once.
pub(crate) const fn is_region_wide(brush_type: BrushType) -> bool {
    matches!(brush_type, BrushType::ErodeDroplets | BrushType::FillPits | BrushType::FlowMask)
}

/// The region of a stroke that reaches `rect`: of droplets it has those that may run into it, and where they end.
pub(crate) fn of_stroke(brush: &Brush, canvas: &Canvas, rect: SampleRect) -> Result<SampleRect> {
    let margin = match brush.brush_type {
        BrushType::ErodeDroplets => droplet_kernel(brush, canvas, 0)?.reach().cast_signed(),
        _ => 0,
    };
    Ok(if rect.is_empty() { rect } else { rect.grown(margin).intersection(&canvas.grid.bounds()) })
}

/// The filter of a brush that works on a whole region at once; `None` for any other.
///
/// # Errors
/// [`Error::RegionSize`] for a region of more samples than are worked on at once.
pub(crate) fn filter(brush: &Brush, seed: u32, canvas: &Canvas, rect: SampleRect) -> Result<Option<Filter>> {
    let num_samples = rect.area();
    let rule = match brush.brush_type {
        BrushType::FillPits => RegionRule::FillPits(brush.fill_pits),
        BrushType::FlowMask => RegionRule::FlowMask {
            routing: brush.flow_routing,
            mask: brush.flow_mask,
            spacing_m: canvas.grid.spacing_m(),
        },
        BrushType::ErodeDroplets => RegionRule::Droplets {
            kernel: droplet_kernel(brush, canvas, seed)?,
            num_droplets: (brush.droplets.per_sample * num_samples as f64).round() as u32,
        },
        _ => return Ok(None),
    };
    if num_samples > MAX_REGION_SAMPLES {
        return Err(Error::RegionSize {
            brush: brush.brush_type.name(),
            width: rect.width(),
            depth: rect.depth(),
            num_samples,
            limit: MAX_REGION_SAMPLES,
        });
    }
    // A mask is made of the layer's heights, all else of what it changes.
    let heights = if brush.brush_type.is_for_masks() { canvas.heights } else { canvas.field };
    let mut graph = Graph::new([canvas.grid.width(), canvas.grid.depth()]);
    graph.add(Step::Region(Arc::new(RegionKernel { rect, heights, rule })), &[]);
    Ok(Some(Filter { graph: Arc::new(graph), is_sequential: false }))
}

fn droplet_kernel(brush: &Brush, canvas: &Canvas, seed: u32) -> Result<DropletKernel> {
    let droplets = Droplets { seed, ..brush.droplets.clone() };
    Ok(DropletKernel::new(brush.brush_type.name(), &droplets, canvas.grid.spacing_m())?)
}

impl RegionKernel {
    /// Makes it of the region's heights.
    ///
    /// # Errors
    /// [`Error::Interrupted`] where the watch says not to go on.
    fn work_out(
        &self,
        mut heights: Plane,
        threads: Option<&rayon::ThreadPool>,
        watch: Watch<'_>,
    ) -> Result<Plane> {
        // A damaged page may hold what is no height.
        for height in heights.samples_mut().iter_mut().filter(|height| !height.is_finite()) {
            *height = sanitized_height(*height);
        }
        let mut goes_on = watch(0.0);
        if goes_on {
            match &self.rule {
                RegionRule::FillPits(options) => fill_pits(&mut heights, options),
                RegionRule::FlowMask { routing, mask, spacing_m } => {
                    heights = flow_mask(&flow(&heights, *routing), *spacing_m, mask);
                }
                RegionRule::Droplets { kernel, num_droplets } => {
                    goes_on = match threads {
                        Some(threads) => {
                            rounds::run_while(&mut heights, kernel, *num_droplets, threads, &mut *watch)
                        }
                        None => droplets::run_while(&mut heights, kernel, *num_droplets, 0, &mut *watch),
                    };
                }
            }
        }
        if goes_on && watch(1.0) { Ok(heights) } else { Err(Error::Interrupted) }
    }
}

/// What was made of the regions of the running operation.
#[derive(Debug, Default)]
pub(crate) struct Regions {
    known: Vec<(Arc<RegionKernel>, Plane)>,
}

impl Regions {
    /// Works out what a graph has of regions, unless that is known, on these threads or on the one that asks; `load` gives the heights of a rectangle before the operation.
    ///
    /// # Errors
    /// What `load` says; [`Error::Interrupted`] where the watch says not to go on.
    pub(crate) fn work_out(
        &mut self,
        graph: &Graph,
        threads: Option<&rayon::ThreadPool>,
        mut load: impl FnMut(FieldId, SampleRect) -> Result<Plane>,
        watch: Watch<'_>,
    ) -> Result<()> {
        for node in graph.nodes() {
            if let Step::Region(kernel) = &node.step
                && !kernel.rect.is_empty()
                && self.plane(kernel).is_none()
            {
                let heights = load(kernel.heights, kernel.rect)?;
                self.known.push((Arc::clone(kernel), kernel.work_out(heights, threads, watch)?));
            }
        }
        Ok(())
    }

    /// What was made of a region.
    pub(crate) fn plane(&self, kernel: &Arc<RegionKernel>) -> Option<&Plane> {
        self.known.iter().find(|(known, _)| Arc::ptr_eq(known, kernel)).map(|(_, plane)| plane)
    }

    /// The memory that they take.
    pub(crate) fn size_in_bytes(&self) -> u64 {
        self.known.iter().map(|(_, plane)| plane.size_in_bytes()).sum()
    }

    /// The operation is over.
    pub(crate) fn clear(&mut self) {
        self.known.clear();
    }
}

/// The heights of a rectangle before the operation, from the store alone.
pub(crate) fn load_before(field: FieldId, rect: SampleRect, store: &mut dyn PageStore) -> Result<Plane> {
    let layout = store.layout();
    let mut plane = Plane::constant(rect, store.constant(field));
    for (x, z) in layout.pages_in(rect) {
        let key = PageKey::full_resolution(field, x, z);
        let loaded = store.load_before(&key).map_err(orogeny_pages::Error::Source)?;
        if let Some(page) = loaded {
            plane.paste(&page, &layout.page_rect(&key), &rect);
        }
    }
    Ok(plane)
}
