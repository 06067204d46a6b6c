//! Work as plain data: what a kernel is to do, with which instances, on which pages.

use std::collections::BTreeMap;
use std::sync::Arc;

use orogeny_field::noise::NoiseFrame;
use orogeny_field::{Bitmap, FieldId, Footprint, Instance, PageKey, PageLayout, SampleRect, WeightMode};

use crate::filter;
use crate::gate::GatePlan;
use crate::kernels::Rule;

/// What is the same for all instances of a stroke or fill.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// What the kernel does.
    pub rule: Rule,
    /// How instances cover samples.
    pub footprint: Footprint,
    /// The field whose pages are changed.
    pub field: FieldId,
    /// Whether that is a mask or a selection, whose values stay within 0..1.
    pub is_mask: bool,
    /// Where it may act.
    pub gate: Option<Arc<GatePlan>>,
    /// How rough a noise is where.
    pub roughness: Option<Arc<GatePlan>>,
}

impl Pass {
    /// A pass over heights, without a gate.
    #[must_use]
    pub const fn new(rule: Rule, footprint: Footprint, field: FieldId) -> Self {
        Self { rule, footprint, field, is_mask: false, gate: None, roughness: None }
    }

    /// The picture that the kernel reads: that of its footprint, or a stamp's.
    #[must_use]
    pub const fn bitmap(&self) -> Option<&Arc<Bitmap>> {
        match &self.rule {
            Rule::Stamp { bitmap, .. } => Some(bitmap),
            _ => self.footprint.alpha.as_ref(),
        }
    }

    /// How weights become amounts.
    #[must_use]
    pub const fn weight_mode(&self) -> WeightMode {
        self.footprint.weight_mode
    }
}

/// Successive instances of a stroke and the pages that they touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// What to do.
    pub pass: Pass,
    /// In stroke order.
    pub instances: Vec<Instance>,
    /// The samples that each instance may change, within the terrain; same order.
    pub bounds: Vec<SampleRect>,
    /// Of a noise: its frames, to which instances refer.
    pub frames: Arc<Vec<NoiseFrame>>,
    /// In the order of their keys, each once.
    pub pages: Vec<PageWork>,
}

/// What a batch does to one page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageWork {
    /// Which page.
    pub key: PageKey,
    /// The samples that may change, on the terrain; nothing outside is touched.
    pub rect: SampleRect,
    /// Indices into [`Batch::instances`], in stroke order: those that reach the rectangle.
    pub instances: Vec<u32>,
}

impl Batch {
    /// Plans instances over pages. An instance is left out of a page that its circle does not reach.
    #[must_use]
    pub fn new(pass: Pass, layout: PageLayout, instances: Vec<Instance>, bounds: Vec<SampleRect>) -> Self {
        let mut pages = BTreeMap::<PageKey, PageWork>::new();
        for (index, (instance, bound)) in instances.iter().zip(&bounds).enumerate() {
            for (x, z) in layout.pages_in(*bound) {
                let key = PageKey::full_resolution(pass.field, x, z);
                let rect = layout.page_rect(&key).intersection(bound);
                if !reaches(instance, &rect) {
                    continue;
                }
                let work = pages.entry(key).or_insert_with(|| PageWork {
                    key,
                    rect: SampleRect::EMPTY,
                    instances: Vec::new(),
                });
                work.rect = work.rect.bounds_with(&rect);
                work.instances.push(index as u32);
            }
        }
        Self { pass, instances, bounds, frames: Arc::default(), pages: pages.into_values().collect() }
    }
}

impl Batch {
    /// The same work with the frames of a noise.
    #[must_use]
    pub fn with_frames(self, frames: Arc<Vec<NoiseFrame>>) -> Self {
        Self { frames, ..self }
    }

    /// The same work in pieces of at most `max_pages` pages each, which may be run one after another. A piece has all of the
    /// batch's instances and bounds; its pages say what of them is to be done. What works on the ground as it is all around
    /// is one piece; a filter's pieces are its blocks.
    pub fn split(mut self, layout: PageLayout, max_pages: usize) -> impl Iterator<Item = Self> {
        let pages = std::mem::take(&mut self.pages);
        let pieces: Vec<Vec<PageWork>> = match &self.pass.rule {
            _ if pages.is_empty() => Vec::new(),
            Rule::Filter(filter) if filter.is_sequential => vec![pages],
            Rule::Filter(filter) => {
                let blocks = filter::blocks(layout, &pages, &filter.graph);
                blocks.into_iter().map(|block| block.pages).collect()
            }
            _ => {
                let mut rest = pages.into_iter().peekable();
                std::iter::from_fn(|| {
                    rest.peek()?;
                    Some(rest.by_ref().take(max_pages.max(1)).collect())
                })
                .collect()
            }
        };
        pieces.into_iter().map(move |pages| Self { pages, ..self.clone() })
    }
}

/// Whether any sample of a rectangle may lie within an instance's radius. Errs on the side of yes.
#[must_use]
pub(crate) fn reaches(instance: &Instance, rect: &SampleRect) -> bool {
    if rect.is_empty() {
        return false;
    }
    if instance.inverse_radius <= 0.0 {
        return true;
    }
    let [cell_x, cell_z] = instance.cell.map(f64::from);
    let [fraction_x, fraction_z] = instance.fraction.map(f64::from);
    if instance.inverse_segment_squared > 0.0 {
        // A ramp: its bounds are near enough.
        return true;
    }
    let outside =
        |place: f64, first: i32, end: i32| place - place.clamp(f64::from(first), f64::from(end - 1));
    let dx = outside(cell_x + fraction_x, rect.x0, rect.x1);
    let dz = outside(cell_z + fraction_z, rect.z0, rect.z1);
    // A millionth more than the radius, for the rounding of the kernels' `f32`.
    let radius = 1.000_001 / f64::from(instance.inverse_radius);
    dx * dx + dz * dz < radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_batch_have_all_of_its_pages_once_and_in_order() {
        let pass = Pass::new(Rule::Raise, Footprint::EVERYWHERE, FieldId(1));
        let everywhere = Instance::EVERYWHERE;
        let layout = PageLayout::new(64).unwrap();
        let bounds = vec![SampleRect::new(10, 10, 300, 200)];
        let batch = Batch::new(pass, layout, vec![everywhere], bounds);
        assert_eq!(batch.pages.len(), 20);
        for max_pages in [1, 7, 20, 100] {
            let pieces: Vec<_> = batch.clone().split(layout, max_pages).collect();
            assert_eq!(pieces.len(), 20_usize.div_ceil(max_pages));
            assert!(
                pieces.iter().all(|piece| piece.instances == batch.instances && piece.bounds == batch.bounds)
            );
            let pages: Vec<_> = pieces.into_iter().flat_map(|piece| piece.pages).collect();
            assert_eq!(pages, batch.pages);
        }
    }
}
