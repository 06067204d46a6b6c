//! Where a brush may act: a page of weights for each page of heights, from the ground before the stroke.
//!
//! Gates are worked out on the CPU for both back ends, once for each page of a stroke. They look across page borders.

use std::borrow::Cow;
use std::sync::Arc;

use orogeny_field::noise::{NoiseFrame, NoiseKernel};
use orogeny_field::{
    Band, Bitmap, FieldId, Gate, Page, PageKey, PageLayout, Plane, SampleRect, TerrainGrid, mirrored,
};
use orogeny_pages::PageStore;
use orogeny_reference::gate::{self, Ground};
use rayon::prelude::*;

use crate::pattern::Pattern;
use crate::{Error, Result};

/// Rows that a thread takes at once.
const MIN_ROWS: usize = 16;

/// A gate with all that it needs of the terrain.
#[derive(Debug, Clone, PartialEq)]
pub struct GatePlan {
    gate: Gate,
    noise: Option<(NoiseKernel, NoiseFrame, Band)>,
    image: Option<(Arc<Bitmap>, [f64; 4])>,
    grid: TerrainGrid,
    /// Whose ground is looked at.
    heights: FieldId,
    /// The terrain's selection.
    selection: FieldId,
}

/// What the weights of one page are made of.
#[derive(Debug)]
pub(crate) struct GateInput {
    /// Heights of the page and one sample about it, where the gate looks at them.
    ground: Option<Vec<f32>>,
    selection: Option<Page>,
}

impl GatePlan {
    /// A gate on a terrain.
    ///
    /// # Errors
    /// [`orogeny_field::Error::FeatureSize`] for a noise that the terrain's samples cannot show.
    pub fn new(
        gate: &Gate,
        grid: TerrainGrid,
        heights: FieldId,
        selection: FieldId,
        image: Option<Arc<Bitmap>>,
    ) -> Result<Self> {
        let image = image.zip(gate.image.as_ref().map(|image| image.region_m));
        let noise = match &gate.noise {
            None => None,
            Some(noise_gate) => {
                let kernel = NoiseKernel::new(&noise_gate.noise, grid.spacing_m(), [0.0; 2])?;
                let frame = NoiseFrame::new(&kernel, noise_gate.noise.seed, 0, None);
                Some((kernel, frame, noise_gate.band))
            }
        };
        Ok(Self { gate: gate.clone(), noise, image, grid, heights, selection })
    }

    /// The weights of all pages of a rectangle; of its samples only, the others are 1.
    ///
    /// # Errors
    /// [`Error::Pages`] when what it looks at cannot be read.
    pub fn pages(&self, rect: &SampleRect, store: &mut dyn PageStore) -> Result<Vec<(SampleRect, Page)>> {
        let layout = store.layout();
        let mut inputs = Vec::new();
        for (x, z) in layout.pages_in(*rect) {
            // It looks at heights at the same place, whichever field it is for.
            let key = PageKey::full_resolution(self.heights, x, z);
            inputs.push((key, self.load(&key, store)?));
        }
        let page = |(key, input): &(PageKey, GateInput)| {
            let page_rect = layout.page_rect(key);
            (page_rect, self.part(key, layout, input, &page_rect.intersection(rect)))
        };
        Ok(inputs.par_iter().map(page).collect())
    }

    /// The weights of the rectangle of a plane, whatever it holds, over planes in memory: heights with one sample more about it, as far as the terrain goes, and the
    /// selection, each where the gate looks at it.
    #[must_use]
    pub fn plane(
        &self,
        layout: PageLayout,
        mut plane: Plane,
        heights: Option<&Plane>,
        selection: Option<&Plane>,
    ) -> Plane {
        let rect = plane.rect();
        let patterns: Vec<(SampleRect, Pattern)> = match &self.noise {
            Some((kernel, frame, _)) => {
                let pages: Vec<_> = layout.pages_in(rect).collect();
                let work_out = |(x, z): &(u32, u32)| {
                    let page_rect = layout.page_rect(&PageKey::full_resolution(self.heights, *x, *z));
                    let mut pattern = Pattern::new(layout);
                    pattern.work_out(kernel, frame, None, &page_rect.intersection(&rect), &page_rect);
                    (page_rect, pattern)
                };
                pages.par_iter().map(work_out).collect()
            }
            None => Vec::new(),
        };
        let heights = heights.filter(|_| self.gate.needs_heights());
        let rows = plane.samples_mut().par_chunks_mut(rect.width().max(1) as usize);
        let rows = rows.zip((rect.z0..rect.z1).into_par_iter()).with_min_len(MIN_ROWS);
        rows.for_each(|(weights, z)| {
            weights.fill(1.0);
            if let Some(heights) = heights {
                let [north, here, south] = [z - 1, z, z + 1].map(|z| self.row_around(heights, z, &rect));
                let (north, here, south) = (&north, &here, &south);
                let ground = Ground { north, here, south, spacing_m: self.grid.spacing_m() };
                gate::multiply_by_ground(weights, &self.gate, &ground);
            }
            for (page_rect, pattern) in patterns.iter().filter(|(page, _)| (page.z0..page.z1).contains(&z)) {
                let both = page_rect.intersection(&rect);
                let [first, end] = [both.x0, both.x1].map(|x| x.abs_diff(page_rect.x0));
                let to = both.x0.abs_diff(rect.x0) as usize;
                let values = pattern.values().row(z.abs_diff(page_rect.z0), first, end);
                let weights = weights.get_mut(to..to + both.width() as usize);
                if let (Some(weights), Some(values), Some((_, _, band))) = (weights, values, &self.noise) {
                    gate::multiply_by_band(weights, values, band);
                }
            }
            if let Some(selected) = selection.filter(|_| self.gate.selection).and_then(|plane| plane.row(z)) {
                let first = plane_column(rect.x0, selection);
                gate::multiply_by_selection(weights, selected.get(first..).unwrap_or_default());
            }
            self.multiply_by_image(weights, rect.x0, z);
            if self.gate.is_inverted {
                gate::invert(weights);
            }
        });
        plane
    }

    /// A row of heights with one sample more at either end, mirrored beyond the terrain.
    fn row_around<'a>(&self, heights: &'a Plane, z: i32, rect: &SampleRect) -> Cow<'a, [f32]> {
        let row = heights.row(mirrored(z, self.grid.depth())).unwrap_or_default();
        let first = heights.rect().x0;
        let whole = |x0: i32, x1: i32| {
            let from = usize::try_from(x0 - first).ok()?;
            row.get(from..from + x1.abs_diff(x0) as usize)
        };
        if let Some(whole) = whole(rect.x0 - 1, rect.x1 + 1) {
            return Cow::Borrowed(whole);
        }
        let sample = |x: i32| {
            let x = mirrored(x, self.grid.width());
            whole(x, x + 1).and_then(|sample| sample.first()).copied().unwrap_or_default()
        };
        (rect.x0 - 1..rect.x1 + 1).map(sample).collect()
    }

    fn multiply_by_image(&self, weights: &mut [f32], x: i32, z: i32) {
        if let Some((bitmap, [x_m, z_m, width_m, depth_m])) = &self.image {
            let spacing_m = self.grid.spacing_m();
            // Each by itself: steps from the row's first sample would round otherwise in each part of a row.
            let x_at = |index: usize| ((f64::from(x) + index as f64) * spacing_m - x_m) / width_m;
            gate::multiply_by_image(weights, bitmap, x_at, (f64::from(z) * spacing_m - z_m) / depth_m);
        }
    }

    /// Loads what the weights of a page are made of.
    pub(crate) fn load(&self, key: &PageKey, store: &mut dyn PageStore) -> Result<GateInput> {
        let ground = if self.gate.needs_heights() { Some(self.ground(key, store)?) } else { None };
        let selection = if self.gate.selection {
            Some(load(&PageKey { field: self.selection, ..*key }, store)?)
        } else {
            None
        };
        Ok(GateInput { ground, selection })
    }

    /// The weights of a page.
    pub(crate) fn page(&self, key: &PageKey, layout: PageLayout, input: &GateInput) -> Page {
        self.part(key, layout, input, &layout.page_rect(key))
    }

    /// The weights of a part of a page.
    fn part(&self, key: &PageKey, layout: PageLayout, input: &GateInput, part: &SampleRect) -> Page {
        let mut page = Page::constant(layout, 1.0);
        let size = layout.size();
        let origin = layout.page_rect(key);
        let stride = size as usize + 2;
        let noise = self.noise.as_ref().map(|(kernel, frame, band)| {
            let mut pattern = Pattern::new(layout);
            pattern.work_out(kernel, frame, None, part, &origin);
            (pattern, band)
        });
        let [first, end] = [part.x0, part.x1].map(|x| x.abs_diff(origin.x0));
        let columns = first as usize..end as usize + 2;
        for z in part.z0.abs_diff(origin.z0)..part.z1.abs_diff(origin.z0) {
            let Some(weights) = page.row_mut(z, first, end) else { continue };
            if let Some(ground) = &input.ground {
                let rows = ground.chunks(stride).skip(z as usize);
                let mut rows = rows.filter_map(|row| row.get(columns.clone()));
                if let (Some(north), Some(here), Some(south)) = (rows.next(), rows.next(), rows.next()) {
                    let ground = Ground { north, here, south, spacing_m: self.grid.spacing_m() };
                    gate::multiply_by_ground(weights, &self.gate, &ground);
                }
            }
            if let Some((pattern, band)) = &noise
                && let Some(values) = pattern.values().row(z, first, end)
            {
                gate::multiply_by_band(weights, values, band);
            }
            if let Some(selected) = input.selection.as_ref().and_then(|page| page.row(z, first, end)) {
                gate::multiply_by_selection(weights, selected);
            }
            self.multiply_by_image(weights, part.x0, origin.z0.saturating_add_unsigned(z));
            if self.gate.is_inverted {
                gate::invert(weights);
            }
        }
        page
    }

    /// The heights of a page before the stroke and of one sample about it; beyond the terrain's edge it is mirrored.
    fn ground(&self, key: &PageKey, store: &mut dyn PageStore) -> Result<Vec<f32>> {
        let layout = store.layout();
        let size = layout.size();
        let origin = layout.page_rect(key);
        // At most nine: the page and those about it.
        let mut pages: Vec<((u32, u32), Page)> = Vec::new();
        let mut ground = Vec::with_capacity((size as usize + 2).pow(2));
        let mut last = 0;
        for z in origin.z0 - 1..=origin.z1 {
            let z = mirrored(z, self.grid.depth()).cast_unsigned();
            for x in origin.x0 - 1..=origin.x1 {
                let x = mirrored(x, self.grid.width()).cast_unsigned();
                let place = (x / size, z / size);
                if pages.get(last).is_none_or(|(known, _)| *known != place) {
                    last = match pages.iter().position(|(known, _)| *known == place) {
                        Some(index) => index,
                        None => {
                            let (x, z) = place;
                            let key = PageKey::full_resolution(self.heights, x, z);
                            pages.push((place, load(&key, store)?));
                            pages.len() - 1
                        }
                    };
                }
                let sample =
                    pages.get(last).and_then(|(_, page)| page.row(z % size, x % size, x % size + 1)?.first());
                ground.push(sample.copied().unwrap_or_default());
            }
        }
        Ok(ground)
    }
}

/// Where a column lies in a plane.
fn plane_column(x: i32, plane: Option<&Plane>) -> usize {
    plane.and_then(|plane| usize::try_from(x - plane.rect().x0).ok()).unwrap_or_default()
}

fn load(key: &PageKey, store: &mut dyn PageStore) -> Result<Page> {
    let layout = store.layout();
    let page = store.load_before(key).map_err(orogeny_pages::Error::Source)?;
    let page = page.unwrap_or_else(|| Page::constant(layout, store.constant(key.field)));
    if page.size() == layout.size() {
        Ok(page)
    } else {
        Err(Error::PageSize { expected: layout.size(), actual: page.size() })
    }
}

#[cfg(test)]
mod tests {
    use orogeny_field::{DataSource, GateImage, hash};

    use super::*;

    #[test]
    fn a_part_of_a_picture_has_the_bits_of_the_whole() {
        let values = (0..37 * 11).map(|place| hash::uniform(place, 0, 3).abs()).collect();
        let bitmap = Arc::new(Bitmap::new(37, 11, values).unwrap());
        let source = DataSource::File("a.png".to_owned());
        // Every third sample lies in the middle of a pixel, but for rounding.
        let image = Some(GateImage { source, region_m: [-1.05, 0.3, 77.7, 50.1] });
        let grid = TerrainGrid::new(300, 90, 0.7).unwrap();
        let gate = Gate { image, ..Gate::default() };
        let plan = GatePlan::new(&gate, grid, FieldId(0), FieldId(0), Some(bitmap)).unwrap();
        let layout = PageLayout::new(64).unwrap();
        let weights = |rect| plan.plane(layout, Plane::constant(rect, f32::NAN), None, None);
        let whole = weights(grid.bounds());
        for (x0, z0) in (0..120).map(|x0| (x0, 60 + x0 % 30)) {
            let part = weights(SampleRect::new(x0, z0, 300, 90));
            for z in z0..90 {
                for x in x0..300 {
                    let [a, b] = [&part, &whole].map(|plane| plane.at(x, z).unwrap().to_bits());
                    assert_eq!(a, b, "{x}, {z} from {x0}, {z0} on");
                }
            }
        }
    }
}
