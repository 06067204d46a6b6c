//! By how much ground and what is cloned onto it differ in the mean.
//!
//! The mean is taken over every so many samples both ways, as many as it takes to be near: so it costs much the same for any
//! radius, and no back end's rounding comes into it.

use orogeny_field::{Mirrors, Page, PageKey, SampleRect};
use orogeny_pages::{HeightProbe, PageStore};
use orogeny_reference::amounts;
use orogeny_reference::field::between::Ground;
use orogeny_reference::field::weights::gather_row;

use crate::Result;
use crate::canvas::Canvas;
use crate::filter::cloning::Laid;
use crate::filter::{CloneGround, Weights};

/// Samples that are looked at, about: all of a smaller area.
const NUM_SAMPLES: u64 = 1 << 18;

/// The mean height of the ground less that of what is laid on it, in metres, by the weights; 0 where these are.
pub(super) fn mean_difference(
    laid: &Laid<'_>,
    weights: &Weights,
    canvas: &Canvas,
    store: &mut dyn PageStore,
) -> Result<f64> {
    let layout = canvas.layout;
    let whole = weights.rect();
    let step = whole.area().div_ceil(NUM_SAMPLES).isqrt().max(1) as usize;
    let mut ground = HeightProbe::new(canvas.grid, canvas.field);
    let mut source = Source::new(laid, canvas);
    let (mut sum, mut sum_of_weights) = (0.0, 0.0);
    for (page_x, page_z) in layout.pages_in(whole) {
        let key = PageKey::full_resolution(canvas.field, page_x, page_z);
        let page_rect = layout.page_rect(&key);
        let rect = page_rect.intersection(&whole);
        let mut row = vec![0.0; rect.width() as usize];
        let mut gate = None;
        // The same rows and columns, however the terrain is cut into pages.
        let first =
            |edge: i32, origin: i32| (-edge.abs_diff(origin).cast_signed()).rem_euclid(step as i32) as usize;
        for z in (rect.z0..rect.z1).skip(first(rect.z0, whole.z0)).step_by(step) {
            if !gather(&mut row, &rect, z, weights) {
                continue;
            }
            if let Some(plan) = &weights.gate {
                let page: &Page = match &mut gate {
                    Some(page) => page,
                    none => {
                        let input = plan.load(&key, store)?;
                        none.insert(plan.page(&key, layout, &input))
                    }
                };
                let (x0, x1) = (rect.x0.abs_diff(page_rect.x0), rect.x1.abs_diff(page_rect.x0));
                amounts::let_through(
                    &mut row,
                    page.row(z.abs_diff(page_rect.z0), x0, x1).unwrap_or_default(),
                );
            }
            for (x, weight) in (rect.x0..).zip(&row).skip(first(rect.x0, whole.x0)).step_by(step) {
                let here = [f64::from(x), f64::from(z)];
                if *weight > 0.0
                    && let Some((height_m, covered)) = source.height_m(laid.placement.place(here), store)?
                {
                    let weight = f64::from(*weight) * covered;
                    sum += weight * (f64::from(ground.height_m(store, here)?) - height_m);
                    sum_of_weights += weight;
                }
            }
        }
    }
    Ok(if sum_of_weights > 0.0 { sum / sum_of_weights } else { 0.0 })
}

/// Gathers the instances that reach a row into its weights; whether there are any.
fn gather(row: &mut [f32], rect: &SampleRect, z: i32, weights: &Weights) -> bool {
    row.fill(0.0);
    let row_rect = SampleRect { z0: z, z1: z + 1, ..*rect };
    let mut is_reached = false;
    for (instance, bound) in weights.instances.iter().zip(&weights.bounds) {
        let both = bound.intersection(&row_rect);
        if both.is_empty() {
            continue;
        }
        let part = row.get_mut(both.x0.abs_diff(rect.x0) as usize..both.x1.abs_diff(rect.x0) as usize);
        gather_row(part.unwrap_or_default(), both.x0, z, instance, &weights.footprint);
        is_reached = true;
    }
    is_reached
}

/// What is laid, at any place of it.
struct Source<'a> {
    laid: &'a Laid<'a>,
    extent: [u32; 2],
    heights: Option<HeightProbe>,
    selection: Option<HeightProbe>,
}

impl<'a> Source<'a> {
    fn new(laid: &'a Laid<'a>, canvas: &Canvas) -> Self {
        let (extent, heights) = match laid.ground {
            CloneGround::Field(field) => {
                ([canvas.grid.width(), canvas.grid.depth()], Some(HeightProbe::new(canvas.grid, *field)))
            }
            CloneGround::Raster { heights, .. } => ([heights.rect().width(), heights.rect().depth()], None),
        };
        let selection = laid.selection.map(|field| HeightProbe::new(canvas.grid, field));
        Self { laid, extent, heights, selection }
    }

    /// The height at a place, in samples of it, and how much of it counts; `None` beyond its border.
    fn height_m(&mut self, [x, z]: [f64; 2], store: &mut dyn PageStore) -> Result<Option<(f64, f64)>> {
        let is_within =
            |place: f64, first: i32, end: i32| (f64::from(first)..=f64::from(end) - 1.0).contains(&place);
        let copied = self.laid.copied(self.extent);
        if !is_within(x, copied.x0, copied.x1) || !is_within(z, copied.z0, copied.z1) {
            return Ok(None);
        }
        let raw = match (&mut self.heights, self.laid.ground) {
            (Some(probe), _) => probe.height_m(store, [x, z])?,
            (None, CloneGround::Raster { heights, .. }) => {
                let ground = Ground { plane: heights, mirrors: Mirrors::of_extent(self.extent) };
                ground.between([x as i32, z as i32], [x.fract() as f32, z.fract() as f32])
            }
            (None, CloneGround::Field(_)) => 0.0,
        };
        let covered = match &mut self.selection {
            Some(selection) => f64::from(selection.height_m(store, [x, z])?),
            None => 1.0,
        };
        let [scale, offset_m] = self.laid.heights.map(f64::from);
        Ok(Some((f64::from(raw) * scale + offset_m, covered)))
    }
}
