//! A terrain in memory that knows all its levels, worked out plainly.

use std::collections::HashMap;

use orogeny_field::{FieldId, HeightBounds, MIN_ERROR_GROWTH, Page, PageKey, PageLayout, TerrainGrid};
use orogeny_geomip::{PagePlace, PageSummaries, PageSummary};

pub struct Ground {
    pub grid: TerrainGrid,
    pub layout: PageLayout,
    levels: Vec<Vec<f32>>,
    summaries: HashMap<PagePlace, PageSummary>,
}

impl Ground {
    pub fn new(width: u64, depth: u64, page_size: u32, height_m: impl Fn(u32, u32) -> f32) -> Self {
        let grid = TerrainGrid::new(width, depth, 2.0).unwrap();
        let layout = PageLayout::new(page_size).unwrap();
        let first = (0..grid.depth()).flat_map(|z| (0..grid.width()).map(move |x| (x, z)));
        let mut levels = vec![first.map(|(x, z)| height_m(x, z)).collect::<Vec<f32>>()];
        for level in 1..=layout.top_level(&grid) {
            let (below, rect) = (grid.bounds_at(level - 1), grid.bounds_at(level));
            let at = |x: i32, z: i32| {
                let (x, z) = (x.clamp(0, below.x1 - 1), z.clamp(0, below.z1 - 1));
                levels[usize::from(level) - 1][(z * below.x1 + x) as usize]
            };
            let mean = |x: i32, z: i32| {
                let row = |z: i32| at(2 * x - 1, z) + 2.0 * at(2 * x, z) + at(2 * x + 1, z);
                (row(2 * z - 1) + 2.0 * row(2 * z) + row(2 * z + 1)) / 16.0
            };
            let next = (0..rect.z1).flat_map(|z| (0..rect.x1).map(move |x| (x, z)));
            let next = next.map(|(x, z)| mean(x, z)).collect();
            levels.push(next);
        }
        let mut ground = Self { grid, layout, levels, summaries: HashMap::new() };
        for level in 0..=layout.top_level(&grid) {
            let (columns, rows) = layout.num_pages_at(&grid, level);
            for (z, x) in (0..rows).flat_map(|z| (0..columns).map(move |x| (z, x))) {
                let place = PagePlace { level, z, x };
                let summary = ground.summary_of(place);
                ground.summaries.insert(place, summary);
            }
        }
        ground
    }

    pub fn height_m(&self, level: u8, [x, z]: [u32; 2]) -> f32 {
        let rect = self.grid.bounds_at(level);
        self.levels[usize::from(level)][(z * rect.width() + x) as usize]
    }

    pub fn page(&self, place: PagePlace) -> Page {
        let key = PageKey { field: FieldId(0), level: place.level, z: place.z, x: place.x };
        let rect = self.layout.page_rect(&key);
        let inside = rect.intersection(&self.grid.bounds_at(place.level));
        let mut page = Page::constant(self.layout, f32::NAN);
        for z in inside.z0..inside.z1 {
            let row = page.row_mut(z.abs_diff(rect.z0), 0, inside.width()).unwrap();
            for (x, sample) in (inside.x0..inside.x1).zip(row) {
                *sample = self.height_m(place.level, [x.unsigned_abs(), z.unsigned_abs()]);
            }
        }
        page
    }

    fn summary_of(&self, place: PagePlace) -> PageSummary {
        let [first, last] = place.samples(&self.grid, self.layout);
        let (mut bounds, mut error_m) = (None::<HeightBounds>, 0.0_f32);
        for z in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let height_m = self.height_m(0, [x, z]);
                let here = HeightBounds::of(height_m);
                bounds = Some(bounds.map_or(here, |bounds| bounds.with(here)));
                error_m = error_m.max((self.surface_m(place.level, x, z) - height_m).abs());
            }
        }
        let below = place.children(&self.grid, self.layout).map(|child| self.summaries[&child].error_m);
        let below = below.fold(0.0, f32::max);
        PageSummary {
            bounds: bounds.unwrap(),
            error_m: error_m.max(below * MIN_ERROR_GROWTH),
            is_constant: false,
        }
    }

    /// The triangles of a level at a sample of full resolution.
    fn surface_m(&self, level: u8, x: u32, z: u32) -> f32 {
        let rect = self.grid.bounds_at(level);
        let at = |i: u32, j: u32| self.height_m(level, [i.min(rect.width() - 1), j.min(rect.depth() - 1)]);
        let side = 1_u32 << level;
        let (i, j) = (x / side, z / side);
        let (fx, fz) = ((x % side) as f32 / side as f32, (z % side) as f32 / side as f32);
        let (first, last) = (at(i, j), at(i + 1, j + 1));
        if fx >= fz {
            let east = at(i + 1, j);
            first + fx * (east - first) + fz * (last - east)
        } else {
            let south = at(i, j + 1);
            first + fz * (south - first) + fx * (last - south)
        }
    }
}

impl PageSummaries for Ground {
    fn summary(&self, place: PagePlace) -> PageSummary {
        self.summaries[&place]
    }
}
