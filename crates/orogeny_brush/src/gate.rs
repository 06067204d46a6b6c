//! Where a brush may act: a page of weights for each page of heights, from the ground before the stroke.
//!
//! Gates are worked out on the CPU for both back ends, once for each page of a stroke. They look across page borders.

use std::sync::Arc;

use orogeny_field::noise::{NoiseFrame, NoiseKernel};
use orogeny_field::{
    Band, Bitmap, FieldId, Gate, Page, PageKey, PageLayout, SampleRect, TerrainGrid, mirrored,
};
use orogeny_pages::PageStore;
use orogeny_reference::gate::{self, Ground};

use crate::pattern::Pattern;
use crate::{Error, Result};

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

    /// The weights of all pages of a rectangle.
    ///
    /// # Errors
    /// [`Error::Pages`] when what it looks at cannot be read.
    pub fn pages(&self, rect: &SampleRect, store: &mut dyn PageStore) -> Result<Vec<(SampleRect, Page)>> {
        let layout = store.layout();
        let mut pages = Vec::new();
        for (x, z) in layout.pages_in(*rect) {
            // It looks at heights at the same place, whichever field it is for.
            let key = PageKey::full_resolution(self.heights, x, z);
            let input = self.load(&key, store)?;
            pages.push((layout.page_rect(&key), self.page(&key, layout, &input)));
        }
        Ok(pages)
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
        let mut page = Page::constant(layout, 1.0);
        let size = layout.size();
        let origin = layout.page_rect(key);
        let stride = size as usize + 2;
        let noise = self.noise.as_ref().map(|(kernel, frame, band)| {
            let mut pattern = Pattern::new(layout);
            pattern.work_out(kernel, frame, None, &origin, &origin);
            (pattern, band)
        });
        for z in 0..size {
            let Some(weights) = page.row_mut(z, 0, size) else { continue };
            if let Some(ground) = &input.ground {
                let mut rows = ground.chunks(stride).skip(z as usize);
                if let (Some(north), Some(here), Some(south)) = (rows.next(), rows.next(), rows.next()) {
                    let ground = Ground { north, here, south, spacing_m: self.grid.spacing_m() };
                    gate::multiply_by_ground(weights, &self.gate, &ground);
                }
            }
            if let Some((pattern, band)) = &noise
                && let Some(values) = pattern.values().row(z, 0, size)
            {
                gate::multiply_by_band(weights, values, band);
            }
            if let Some(selected) = input.selection.as_ref().and_then(|page| page.row(z, 0, size)) {
                gate::multiply_by_selection(weights, selected);
            }
            if let Some((bitmap, [x_m, z_m, width_m, depth_m])) = &self.image {
                let spacing_m = self.grid.spacing_m();
                let first_x = (f64::from(origin.x0) * spacing_m - x_m) / width_m;
                let row_z = ((f64::from(origin.z0) + f64::from(z)) * spacing_m - z_m) / depth_m;
                gate::multiply_by_image(weights, bitmap, [first_x, row_z], spacing_m / width_m);
            }
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
