//! What the renderer asks of a terrain's heights, answered from what the directory says of its pages: no page is read for it.

use orogeny_field::{HeightBounds, PageLayout, TerrainGrid};

use crate::{PagePlace, Relief, Tile};

/// What is known of a page without reading it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageSummary {
    /// Lowest and highest height, at full resolution, of what it covers.
    pub bounds: HeightBounds,
    /// How far its level's surface is from that of full resolution, at most; at least [`orogeny_field::MIN_ERROR_GROWTH`] times that of
    /// those below it.
    pub error_m: f32,
    /// Whether it is all one height, as what was never painted is: there is no page to load then, nor any below it.
    pub is_constant: bool,
}

/// Knows the summaries of all pages of a terrain.
pub trait PageSummaries {
    /// That of a page, which the terrain has.
    fn summary(&self, place: PagePlace) -> PageSummary;
}

/// A terrain's relief by its pages.
#[derive(Debug)]
pub struct PageRelief<'a, S> {
    grid: TerrainGrid,
    layout: PageLayout,
    summaries: &'a S,
}

impl<'a, S: PageSummaries> PageRelief<'a, S> {
    /// Of a terrain.
    pub const fn new(grid: TerrainGrid, layout: PageLayout, summaries: &'a S) -> Self {
        Self { grid, layout, summaries }
    }

    /// Of a page.
    pub fn summary(&self, place: PagePlace) -> PageSummary {
        self.summaries.summary(place)
    }

    /// [`Relief::ring_bounds`] as narrow as pages tell: by more and smaller ones.
    pub fn narrow_ring_bounds(&self, tile: Tile) -> HeightBounds {
        self.bounds_over(Self::ring(tile), tile.level.saturating_sub(2))
    }

    /// Lowest and highest height of a tile, maybe more than that: of its last samples too, which are the first of the next tile's.
    pub fn tile_bounds(&self, tile: Tile) -> HeightBounds {
        match tile.samples(&self.grid) {
            Some(samples) => self.bounds_over(samples, tile.level.saturating_sub(2)),
            None => HeightBounds::of(0.0),
        }
    }

    /// Lowest and highest height of a page, the first samples of the next ones included, as the ground of its last cells lies between
    /// these; maybe more than that.
    pub fn page_bounds(&self, place: PagePlace) -> HeightBounds {
        self.bounds_over(place.samples(&self.grid, self.layout), place.level)
    }

    fn bounds_over(&self, samples: [[u32; 2]; 2], level: u8) -> HeightBounds {
        let pages = self.pages_over(samples, level).map(|place| self.summaries.summary(place).bounds);
        pages.reduce(HeightBounds::with).unwrap_or(HeightBounds::of(0.0))
    }

    /// The pages of a level that hold any sample from a first to a last one.
    fn pages_over(&self, samples: [[u32; 2]; 2], level: u8) -> impl Iterator<Item = PagePlace> + use<S> {
        let level = level.min(self.layout.top_level(&self.grid));
        let last = [self.grid.width() - 1, self.grid.depth() - 1];
        let page = |sample: u32, last: u32| (sample.min(last) >> level) / self.layout.size();
        let [[x0, z0], [x1, z1]] = samples.map(|[x, z]| [page(x, last[0]), page(z, last[1])]);
        (z0..=z1).flat_map(move |z| (x0..=x1).map(move |x| PagePlace { level, z, x }))
    }

    /// First and last sample of a tile's ring.
    fn ring(tile: Tile) -> [[u32; 2]; 2] {
        let (first, side) = (tile.origin(), tile.side());
        [first.map(|first| first.saturating_sub(side)), first.map(|first| first + 2 * side)]
    }
}

impl<S: PageSummaries> Relief for PageRelief<'_, S> {
    fn top_level(&self) -> u8 {
        self.layout.top_level(&self.grid)
    }

    fn ring_bounds(&self, tile: Tile) -> HeightBounds {
        self.bounds_over(Self::ring(tile), tile.level)
    }

    fn ring_error_m(&self, tile: Tile, level: u8) -> f32 {
        let errors =
            self.pages_over(Self::ring(tile), level).map(|place| self.summaries.summary(place).error_m);
        errors.fold(0.0, f32::max)
    }
}
