//! Pages: which a picture wants, and which slots hold them; beside plain evaluations.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "helpers of tests, which clippy does not take for tests"
)]

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::sync::LazyLock;

use glam::DVec3;
use orogeny_field::{HeightBounds, MIN_ERROR_GROWTH, PageLayout, TerrainGrid, hash};
use orogeny_geomip::{
    Bounds, Camera, DetailRule, Frustum, Ground, Metric, PagePlace, PageRelief, PageSummaries, PageSummary,
    Ray, Relief, Slots, TILE_CELLS, Tile, pick, select, wanted_pages,
};
use proptest::prelude::*;

/// What was never painted.
const UNPAINTED_M: f32 = 3.0;

/// A terrain with all of its heights and the summaries of all of its pages.
struct Pages {
    grid: TerrainGrid,
    layout: PageLayout,
    heights: Vec<f32>,
    summaries: HashMap<PagePlace, PageSummary>,
}

impl Pages {
    fn new([width, depth]: [u64; 2], spacing_m: f64, page_size: u32, height: fn(u32, u32) -> f32) -> Self {
        let grid = TerrainGrid::new(width, depth, spacing_m).unwrap();
        let layout = PageLayout::new(page_size).unwrap();
        let samples = (0..grid.depth()).flat_map(|z| (0..grid.width()).map(move |x| (x, z)));
        let heights = samples.map(|(x, z)| height(x, z)).collect();
        let mut pages = Self { grid, layout, heights, summaries: HashMap::new() };
        for level in 0..=layout.top_level(&grid) {
            for place in all_of_level(&grid, layout, level) {
                let summary = if level == 0 { pages.of_samples(place) } else { pages.of_children(place) };
                pages.summaries.insert(place, summary);
            }
        }
        pages
    }

    fn of_samples(&self, place: PagePlace) -> PageSummary {
        let size = self.layout.size();
        let last = [place.x, place.z].map(|page| page * size + size - 1);
        let bounds = self.bounds_of([[place.x * size, place.z * size], last]);
        PageSummary { bounds, error_m: 0.0, is_constant: bounds == HeightBounds::of(UNPAINTED_M) }
    }

    /// The error is as it may be: the least that it is allowed, or up to half of all height more.
    fn of_children(&self, place: PagePlace) -> PageSummary {
        let children: Vec<_> =
            place.children(&self.grid, self.layout).map(|child| self.summaries[&child]).collect();
        let bounds = children.iter().map(|child| child.bounds).reduce(HeightBounds::with).unwrap();
        let is_constant = children.iter().all(|child| child.is_constant);
        let least_m = children.iter().map(|child| child.error_m).fold(0.0, f32::max) * MIN_ERROR_GROWTH;
        let more = hash::uniform(place.x, place.z, u32::from(place.level)).powi(4) - 0.05;
        let more_m = more.max(0.0) * (bounds.max_m - bounds.min_m) / 2.0;
        PageSummary { bounds, error_m: if is_constant { 0.0 } else { least_m + more_m }, is_constant }
    }

    /// From a first to a last sample, as far as the terrain has them.
    fn bounds_of(&self, [first, last]: [[u32; 2]; 2]) -> HeightBounds {
        let width = self.grid.width() as usize;
        let [x1, z1] = [last[0].min(self.grid.width() - 1), last[1].min(self.grid.depth() - 1)];
        let rows = (first[1]..=z1).map(|z| &self.heights[z as usize * width..][..width]);
        rows.filter_map(|row| HeightBounds::of_row(&row[first[0] as usize..=x1 as usize]))
            .reduce(HeightBounds::with)
            .unwrap()
    }

    fn relief(&self) -> PageRelief<'_, Self> {
        PageRelief::new(self.grid, self.layout, self)
    }

    fn extent_m(&self) -> [f64; 2] {
        [self.grid.width(), self.grid.depth()].map(|num| f64::from(num - 1) * self.grid.spacing_m())
    }
}

impl fmt::Debug for Pages {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{:?} of pages of {}", self.grid, self.layout.size())
    }
}

impl PageSummaries for Pages {
    fn summary(&self, place: PagePlace) -> PageSummary {
        self.summaries[&place]
    }
}

impl Ground for Pages {
    fn bounds(&self, tile: Tile) -> HeightBounds {
        self.relief().narrow_ring_bounds(tile)
    }

    fn height_m(&self, [x, z]: [u32; 2]) -> f32 {
        self.heights[(z * self.grid.width() + x) as usize]
    }
}

/// Rough ground over 2^20 samples a side with holes of any size, which no one could keep.
struct Vast {
    grid: TerrainGrid,
    layout: PageLayout,
}

impl PageSummaries for Vast {
    fn summary(&self, place: PagePlace) -> PageSummary {
        let top = self.layout.top_level(&self.grid);
        assert!(is_of(&self.grid, self.layout, place), "{place:?}");
        let above = std::iter::successors(Some(place), |place| (place.level < top).then(|| place.parent()));
        let is_hole = |place: PagePlace| {
            place.level + 2 < top && hash::uniform(place.x, place.z, u32::from(place.level)) < 0.05
        };
        if above.into_iter().any(is_hole) {
            return PageSummary { bounds: HeightBounds::of(UNPAINTED_M), error_m: 0.0, is_constant: true };
        }
        let error_m = if place.level == 0 { 0.0 } else { 0.2 * 1.5_f32.powi(i32::from(place.level)) };
        PageSummary { bounds: HeightBounds { min_m: -40.0, max_m: 80.0 }, error_m, is_constant: false }
    }
}

/// Hills, a plateau with a cliff, and squares that were never painted.
fn hills(x: u32, z: u32) -> f32 {
    let (fx, fz) = (x as f32, z as f32);
    if hash::uniform(x / 150, z / 150, 5) < 0.3 {
        UNPAINTED_M
    } else if fx > fz + 400.0 {
        200.0 + 0.01 * fx
    } else {
        60.0 * (fx / 23.0).sin() * (fz / 31.0).cos() + 9.0 * hash::uniform(x, z, 3)
    }
}

static TERRAINS: LazyLock<Vec<Pages>> = LazyLock::new(|| {
    vec![
        Pages::new([1500, 1100], 2.0, 64, hills),
        Pages::new([1500, 1100], 0.5, 256, hills),
        Pages::new([2300, 70], 30.0, 64, hills),
        Pages::new([65, 64], 1.0, 64, hills),
    ]
});

fn terrain() -> impl Strategy<Value = &'static Pages> {
    (0..TERRAINS.len()).prop_map(|index| &TERRAINS[index])
}

/// From a metre over the lowest ground to far away, looking at some place of the terrain.
fn seen_terrain() -> impl Strategy<Value = (&'static Pages, Camera)> {
    let place = || (-0.3..1.3_f64, 0.0..8.5_f64, -0.3..1.3_f64);
    (terrain(), place(), (0.0..1.0_f64, 0.0..1.0_f64), 0.05..2.0_f64, 30..900_u32).prop_map(
        |(pages, (x, height, z), (to_x, to_z), fov, rows)| {
            let [width, depth] = pages.extent_m();
            let eye = DVec3::new(x * width, height.exp() - 60.0, z * depth);
            let target = DVec3::new(to_x * width, 30.0, to_z * depth);
            (pages, Camera::looking_at(eye, target, fov, [rows * 4 / 3, rows]))
        },
    )
}

fn rule() -> impl Strategy<Value = DetailRule> {
    let metric = prop_oneof![Just(Metric::Roughness), Just(Metric::FromAbove)];
    (metric, 0.05..20.0_f64).prop_map(|(metric, max_error_px)| DetailRule { metric, max_error_px })
}

fn is_of(grid: &TerrainGrid, layout: PageLayout, place: PagePlace) -> bool {
    let (columns, rows) = layout.num_pages_at(grid, place.level);
    place.x < columns && place.z < rows
}

fn all_of_level(grid: &TerrainGrid, layout: PageLayout, level: u8) -> impl Iterator<Item = PagePlace> {
    let (columns, rows) = layout.num_pages_at(grid, level);
    (0..rows).flat_map(move |z| (0..columns).map(move |x| PagePlace { level, z, x }))
}

// ---- Relief ----

/// The ring of a tile within the terrain.
fn ring(tile: Tile, grid: &TerrainGrid) -> Option<[[u32; 2]; 2]> {
    let [first, last] = tile.samples(grid)?;
    let end = [grid.width() - 1, grid.depth() - 1];
    let ring_last = [0, 1].map(|axis| end[axis].min(last[axis] + tile.side()));
    Some([first.map(|first| first.saturating_sub(tile.side())), ring_last])
}

fn holds(outer: [[u32; 2]; 2], inner: [[u32; 2]; 2]) -> bool {
    (0..2).all(|axis| outer[0][axis] <= inner[0][axis] && inner[1][axis] <= outer[1][axis])
}

fn is_within(inner: HeightBounds, outer: HeightBounds) -> bool {
    outer.min_m <= inner.min_m && inner.max_m <= outer.max_m
}

/// A tile of a terrain.
fn tile_of(pages: &Pages, [level, x, z]: [prop::sample::Index; 3]) -> Tile {
    let level = level.index(usize::from(Tile::root(&pages.grid).level) + 1) as u8;
    let along = |index: prop::sample::Index, num: u32| {
        index.index((num - 1).div_ceil(TILE_CELLS << level).max(1) as usize) as u32
    };
    Tile { level, z: along(z, pages.grid.depth()), x: along(x, pages.grid.width()) }
}

fn touch(a: Tile, b: Tile) -> bool {
    let (first, second) = (a.origin(), b.origin());
    (0..2).all(|axis| first[axis] <= second[axis] + b.side() && second[axis] <= first[axis] + a.side())
}

proptest! {
    #[test]
    fn bounds_of_tiles_and_rings_hold_all_of_their_heights(pages in terrain(), tile in any::<[prop::sample::Index; 3]>()) {
        let (tile, relief) = (tile_of(pages, tile), pages.relief());
        let heights = pages.bounds_of(ring(tile, &pages.grid).unwrap());
        prop_assert!(is_within(heights, relief.narrow_ring_bounds(tile)), "{tile:?}");
        prop_assert!(is_within(heights, relief.ring_bounds(tile)), "{tile:?}");
        prop_assert!(is_within(relief.narrow_ring_bounds(tile), relief.ring_bounds(tile)), "{tile:?}");
    }

    #[test]
    fn errors_are_none_at_level_0_and_grow_from_level_to_level(pages in terrain(), tile in any::<[prop::sample::Index; 3]>()) {
        let (tile, relief) = (tile_of(pages, tile), pages.relief());
        prop_assert_eq!(relief.top_level(), pages.layout.top_level(&pages.grid));
        prop_assert_eq!(relief.ring_error_m(tile, 0), 0.0);
        for level in 0..relief.top_level() {
            let (finer, coarser) = (relief.ring_error_m(tile, level), relief.ring_error_m(tile, level + 1));
            prop_assert!(coarser >= finer * MIN_ERROR_GROWTH, "{tile:?}, {level}: {finer} and {coarser}");
        }
        // Of each sample of the ring its page counts.
        let [first, last] = ring(tile, &pages.grid).unwrap();
        for level in 0..=relief.top_level() {
            let there = all_of_level(&pages.grid, pages.layout, level).filter(|place| {
                let side = pages.layout.size() << level;
                let [x, z] = [place.x * side, place.z * side];
                x <= last[0] && z <= last[1] && first[0] < x + side && first[1] < z + side
            });
            let error_m = there.map(|place| pages.summary(place).error_m).fold(0.0, f32::max);
            prop_assert!(relief.ring_error_m(tile, level) >= error_m, "{tile:?}, {level}");
        }
    }

    #[test]
    fn a_ring_has_no_less_than_one_within_it(
        pages in terrain(), tile in any::<[prop::sample::Index; 3]>(), finer in -2..4_i8,
    ) {
        let (tile, relief) = (tile_of(pages, tile), pages.relief());
        let outer = ring(tile, &pages.grid).unwrap();
        let level = tile.level.saturating_add_signed(-finer);
        let columns = |axis: usize| outer[0][axis] / (TILE_CELLS << level)..=outer[1][axis] / (TILE_CELLS << level);
        for (z, x) in columns(1).flat_map(|z| columns(0).map(move |x| (z, x))) {
            let other = Tile { level, z, x };
            if ring(other, &pages.grid).is_none_or(|inner| !holds(outer, inner)) {
                continue;
            }
            // A larger tile's pages may reach further, even where the terrain's end leaves it a smaller ring.
            let (inner, outer) = (relief.ring_bounds(other), relief.ring_bounds(tile));
            prop_assert!(level > tile.level || is_within(inner, outer), "{tile:?} and {other:?}");
            for level in 0..=relief.top_level() {
                let (inner, outer) = (relief.ring_error_m(other, level), relief.ring_error_m(tile, level));
                prop_assert!(inner <= outer, "{tile:?} and {other:?} at {level}: {inner} and {outer}");
            }
        }
    }

    #[test]
    fn levels_of_tiles_side_by_side_differ_by_1_at_most((pages, camera) in seen_terrain(), rule in rule()) {
        let drawn = select(&pages.grid, &camera, &rule, &pages.relief(), usize::MAX);
        prop_assert!(!drawn.is_empty());
        for (index, first) in drawn.iter().enumerate() {
            for second in &drawn[..index] {
                let (a, b) = (first.tile, second.tile);
                prop_assert!(a.level.abs_diff(b.level) <= 1 || !touch(a, b), "{a:?} and {b:?}");
            }
        }
    }
}

// ---- Pages that are wanted ----

/// Why a page's children are wanted or not, worked out from what the docs say: by how much what it shows is too coarse.
fn excess(pages: &Pages, place: PagePlace, camera: &Camera, rule: &DetailRule) -> Option<f64> {
    let (summary, spacing_m) = (pages.summary(place), pages.grid.spacing_m());
    // The ground of its last cells lies between its heights and the first of the next pages.
    let around = [(0, 0), (0, 1), (1, 0), (1, 1)]
        .map(|(dz, dx)| PagePlace { z: place.z + dz, x: place.x + dx, ..place })
        .into_iter()
        .filter(|place| is_of(&pages.grid, pages.layout, *place));
    let heights = around.map(|place| pages.summary(place).bounds).reduce(HeightBounds::with)?;
    let bounds = Bounds::of_samples(place.samples(&pages.grid, pages.layout), heights, spacing_m);
    if summary.is_constant || place.level == 0 || !Frustum::of(camera).may_show(&bounds) {
        return None;
    }
    let side_of_tile_m = f64::from(TILE_CELLS << (place.level - 1)) * spacing_m;
    let distance_m = bounds.grown(side_of_tile_m).distance_m(camera.eye_m());
    let px = |length_m: f64| length_m * camera.pixels_at_one_metre() / distance_m;
    let sample_m = spacing_m * f64::from(1 << place.level);
    let off_m = if rule.metric == Metric::Roughness { f64::from(summary.error_m) } else { sample_m };
    let excess = (px(off_m) / rule.max_error_px.max(0.1)).max(px(sample_m));
    (excess > 1.0).then_some(excess)
}

/// All pages that are wanted, with how urgent each is: as the least urgent of those above it.
fn plainly_wanted(pages: &Pages, camera: &Camera, rule: &DetailRule) -> HashMap<PagePlace, f64> {
    let mut found = HashMap::from([(PagePlace::root(&pages.grid, pages.layout), f64::INFINITY)]);
    for level in (0..pages.layout.top_level(&pages.grid)).rev() {
        for place in all_of_level(&pages.grid, pages.layout, level) {
            let above = found.get(&place.parent()).copied();
            let off = || excess(pages, place.parent(), camera, rule);
            if let Some(urgency) = above.and_then(|above| Some(off()?.min(above))) {
                found.insert(place, urgency);
            }
        }
    }
    found
}

/// What holds of any list of all that is wanted.
fn check_order(
    grid: &TerrainGrid,
    layout: PageLayout,
    summaries: &impl PageSummaries,
    wanted: &[PagePlace],
) -> Result<(), TestCaseError> {
    let root = PagePlace::root(grid, layout);
    prop_assert_eq!(wanted.first(), Some(&root));
    let mut before = HashSet::new();
    for place in wanted {
        prop_assert!(is_of(grid, layout, *place), "{place:?}");
        if *place != root {
            prop_assert!(before.contains(&place.parent()), "{place:?} before the one above it");
            prop_assert!(!summaries.summary(place.parent()).is_constant, "{place:?} of a constant one");
        }
        prop_assert!(before.insert(*place), "{place:?} twice");
    }
    Ok(())
}

/// What is left where there is room for so many: the first of those that have to be held, and all others.
fn limited(summaries: &impl PageSummaries, wanted: &[PagePlace], max_pages: usize) -> Vec<PagePlace> {
    let mut num = 0;
    let mut has_room = |place: &PagePlace| {
        let is_held = !summaries.summary(*place).is_constant;
        num += usize::from(is_held);
        !is_held || num <= max_pages
    };
    wanted.iter().copied().filter(|place| has_room(place)).collect()
}

proptest! {
    #[test]
    fn pages_and_those_above_and_below_them_cover_the_same(pages in terrain(), level in 0..9_u8) {
        let (grid, layout) = (&pages.grid, pages.layout);
        let level = level % (layout.top_level(grid) + 1);
        let mut below: Vec<_> =
            all_of_level(grid, layout, level).flat_map(|place| place.children(grid, layout)).collect();
        below.sort();
        let expected = level.checked_sub(1).map(|below| all_of_level(grid, layout, below).collect::<Vec<_>>());
        prop_assert_eq!(&below, &expected.unwrap_or_default());
        for place in below {
            let above = place.parent();
            prop_assert!(above.children(grid, layout).any(|child| child == place));
            prop_assert!(holds(above.samples(grid, layout), place.samples(grid, layout)), "{place:?}");
        }
    }

    #[test]
    fn what_is_wanted_is_what_is_plainly_wanted_most_urgent_first(
        (pages, camera) in seen_terrain(), rule in rule(), max_pages in 1..300_usize,
    ) {
        let wanted_of = |max_pages| {
            wanted_pages(&pages.grid, pages.layout, &camera, &rule, &pages.relief(), max_pages).0
        };
        let wanted = wanted_of(usize::MAX);
        check_order(&pages.grid, pages.layout, pages, &wanted)?;
        let urgency = plainly_wanted(pages, &camera, &rule);
        let places: HashSet<_> = wanted.iter().copied().collect();
        prop_assert_eq!(places, urgency.keys().copied().collect::<HashSet<_>>());
        for places in wanted.windows(2) {
            let [first, second] = [0, 1].map(|index| urgency[&places[index]]);
            prop_assert!(first >= second * (1.0 - 1.0e-9), "{places:?}: {first} and {second}");
        }

        let kept = wanted_of(max_pages);
        prop_assert_eq!(&kept, &limited(pages, &wanted, max_pages));
        let is_held = |place: &&PagePlace| !pages.summary(**place).is_constant;
        prop_assert!(kept.iter().filter(is_held).count() <= max_pages);
        let least = kept.iter().filter(is_held).map(|place| urgency[place]).fold(f64::INFINITY, f64::min);
        for place in wanted.iter().filter(is_held).filter(|place| !kept.contains(place)) {
            prop_assert!(urgency[place] <= least * (1.0 + 1.0e-9), "{place:?} is more urgent than {least}");
        }
        // What has to be held comes after all above it, however little room there is.
        for (index, place) in kept.iter().enumerate().skip(1).filter(|(_, place)| is_held(place)) {
            prop_assert!(kept[..index].contains(&place.parent()), "{place:?}");
        }
    }

    #[test]
    fn where_the_ground_is_seen_no_sample_is_wider_than_a_pixel_unless_there_are_none_finer(
        (pages, camera) in seen_terrain(), rule in rule(), pixels in prop::collection::vec((0.0..=1.0_f64, 0.0..=1.0_f64), 40),
    ) {
        let wanted: HashSet<_> =
            wanted_pages(&pages.grid, pages.layout, &camera, &rule, &pages.relief(), usize::MAX).0.into_iter().collect();
        let [half_width, half_height] = camera.half_extent();
        let [right, up, backward] = camera.axes();
        for (x, y) in pixels {
            let across = right * (2.0 * x - 1.0) * half_width + up * (2.0 * y - 1.0) * half_height;
            let ray = Ray { origin_m: camera.eye_m(), direction: (across - backward).normalize() };
            if let Some(distance_m) = pick(&ray, &pages.grid, pages) {
                check_seen(pages, &camera, &wanted, ray.origin_m + ray.direction * distance_m)?;
            }
        }
    }
}

/// Checks that the page for a point that is seen is there: its samples are no wider than a pixel, or there is none below it.
fn check_seen(
    pages: &Pages,
    camera: &Camera,
    wanted: &HashSet<PagePlace>,
    point: DVec3,
) -> Result<(), TestCaseError> {
    let sample = [(point.x, pages.grid.width()), (point.z, pages.grid.depth())]
        .map(|(at_m, num)| ((at_m / pages.grid.spacing_m()) as u32).min(num - 1));
    let [x, z] = sample.map(|sample| sample / pages.layout.size());
    let place = (0..=pages.layout.top_level(&pages.grid))
        .map(|level| PagePlace { level, z: z >> level, x: x >> level })
        .find(|place| wanted.contains(place))
        .unwrap();
    let distance_m = point.distance(camera.eye_m());
    let sample_m = pages.grid.spacing_m() * f64::from(1 << place.level);
    let width_px = sample_m * camera.pixels_at_one_metre() / distance_m;
    let is_last = place.level == 0 || pages.summary(place).is_constant;
    prop_assert!(is_last || width_px <= 1.0 + 1.0e-6, "{width_px} px at {point}, of {place:?}");
    Ok(())
}

#[test]
fn a_cliff_between_two_pages_is_seen_finely_too() {
    // The face lies in the last cells of the low pages, far above all of their heights.
    let pages = Pages::new([1024, 1024], 1.0, 64, |x, z| {
        if x < 512 { 4.0 + hash::uniform(x, z, 1) } else { 900.0 + hash::uniform(x, z, 1) }
    });
    let eye = DVec3::new(1.0, 880.0, 500.3);
    let camera = Camera::looking_at(eye, DVec3::new(511.5, 700.0, 500.3), 0.2, [1000, 1000]);
    let ray = Ray { origin_m: eye, direction: (DVec3::new(511.7, 700.0, 500.3) - eye).normalize() };
    let point = eye + ray.direction * pick(&ray, &pages.grid, &pages).unwrap();
    assert!((511.0..512.0).contains(&point.x), "{point}");
    let rule = DetailRule::default();
    let wanted = wanted_pages(&pages.grid, pages.layout, &camera, &rule, &pages.relief(), usize::MAX).0;
    check_seen(&pages, &camera, &wanted.into_iter().collect(), point).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn of_a_million_samples_a_side_few_pages_are_wanted(
        (x, height, z) in (0.0..1.05e6_f64, 0.0..12.0_f64, 0.0..1.05e6_f64), turn in 0.0..std::f64::consts::TAU,
        rule in rule(), page_size in prop_oneof![Just(64), Just(256)], max_pages in 1..2000_usize,
    ) {
        let rule = DetailRule { max_error_px: rule.max_error_px.max(1.0), ..rule };
        let vast = Vast {
            grid: TerrainGrid::new(1 << 20, (1 << 20) - 5, 1.0).unwrap(), layout: PageLayout::new(page_size).unwrap(),
        };
        let eye = DVec3::new(x, 60.0 + height.exp(), z);
        let camera = Camera::looking_at(eye, eye + DVec3::new(turn.cos(), -0.3, turn.sin()), 1.0, [320, 240]);
        let relief = PageRelief::new(vast.grid, vast.layout, &vast);
        let wanted = wanted_pages(&vast.grid, vast.layout, &camera, &rule, &relief, usize::MAX).0;
        check_order(&vast.grid, vast.layout, &vast, &wanted)?;
        prop_assert!(wanted.len() < 4_000, "{}", wanted.len());
        let kept = wanted_pages(&vast.grid, vast.layout, &camera, &rule, &relief, max_pages).0;
        prop_assert_eq!(kept, limited(&vast, &wanted, max_pages));
    }
}

// ---- Slots ----

#[derive(Debug, Clone)]
enum Step {
    Want(Vec<PagePlace>),
    Admit(PagePlace),
    /// All of whose columns give this rest by 5.
    Forget(u32),
}

fn some_page() -> impl Strategy<Value = PagePlace> {
    (0..2_u8, 0..3_u32, 0..5_u32).prop_map(|(level, z, x)| PagePlace { level, z, x })
}

fn some_pages(max: usize) -> impl Strategy<Value = Vec<PagePlace>> {
    prop::collection::hash_set(some_page(), 0..=max).prop_map(|pages| pages.into_iter().collect())
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => some_pages(9).prop_map(Step::Want),
        12 => some_page().prop_map(Step::Admit),
        1 => (0..5_u32).prop_map(Step::Forget),
    ]
}

/// All pages that there may be, with their slots.
fn held(slots: &Slots) -> HashMap<PagePlace, u32> {
    let places = (0..2).flat_map(|level| (0..15).map(move |n| PagePlace { level, z: n / 5, x: n % 5 }));
    places.filter_map(|place| Some((place, slots.slot(place)?))).collect()
}

proptest! {
    #[test]
    fn slots_keep_what_is_wanted_and_lose_what_was_not_for_longest(
        num_slots in 0..9_u32, steps in prop::collection::vec(step(), 0..120),
    ) {
        let mut slots = Slots::new(num_slots);
        // In which picture each page that is held was last wanted.
        let mut last: HashMap<PagePlace, usize> = HashMap::new();
        let mut now = 0;
        for step in steps {
            let before = held(&slots);
            match &step {
                Step::Want(wanted) => {
                    now += 1;
                    let expected: Vec<_> =
                        wanted.iter().copied().filter(|place| !before.contains_key(place)).collect();
                    prop_assert_eq!(slots.want(wanted), expected);
                    prop_assert_eq!(held(&slots), before);
                    for place in wanted {
                        last.entry(*place).and_modify(|last| *last = now);
                    }
                }
                Step::Admit(place) => {
                    let slot = slots.admit(*place);
                    let after = held(&slots);
                    let gone: Vec<_> = before.keys().copied().filter(|page| !after.contains_key(page)).collect();
                    prop_assert!(before.iter().all(|(page, slot)| after.get(page).is_none_or(|now| now == slot)));
                    prop_assert_eq!(slots.slot(*place), slot);
                    let oldest = last.values().copied().min().filter(|oldest| *oldest < now);
                    if before.contains_key(place) || before.len() < num_slots as usize {
                        prop_assert!(gone.is_empty() && slot.is_some());
                    } else if let Some(oldest) = oldest {
                        prop_assert_eq!(gone.len(), 1);
                        prop_assert_eq!(last.remove(&gone[0]), Some(oldest));
                        prop_assert_eq!(slot, Some(before[&gone[0]]));
                    } else {
                        prop_assert!(gone.is_empty() && slot.is_none());
                    }
                    if slot.is_some() {
                        last.insert(*place, now);
                    }
                }
                Step::Forget(column) => {
                    slots.forget(|place| place.x == *column);
                    let kept = before.into_iter().filter(|(place, _)| place.x != *column);
                    prop_assert_eq!(held(&slots), kept.collect::<HashMap<_, _>>());
                    last.retain(|place, _| place.x != *column);
                }
            }
            let after = held(&slots);
            let used: HashSet<_> = after.values().copied().collect();
            prop_assert_eq!(used.len(), after.len(), "two pages in one slot: {:?}", after);
            prop_assert!(used.iter().all(|slot| *slot < num_slots));
            prop_assert_eq!(slots.num_held(), after.len());
            prop_assert_eq!(after.keys().collect::<HashSet<_>>(), last.keys().collect::<HashSet<_>>());
        }
    }

    #[test]
    fn where_no_more_is_wanted_than_there_is_room_for_all_of_it_arrives(
        num_slots in 1..9_u32, pictures in prop::collection::vec((some_pages(8), 0..9_usize), 1..30),
    ) {
        let mut slots = Slots::new(num_slots);
        for (mut wanted, num_late) in pictures {
            wanted.truncate(num_slots as usize);
            let missing = slots.want(&wanted);
            let num_arriving = missing.len().saturating_sub(num_late);
            for (index, place) in missing[..num_arriving].iter().enumerate() {
                prop_assert!(slots.admit(*place).is_some());
                prop_assert!(missing[..=index].iter().all(|place| slots.slot(*place).is_some()));
            }
            let is_there = |place: &PagePlace| slots.slot(*place).is_some();
            prop_assert!(wanted.iter().all(|place| is_there(place) != missing[num_arriving..].contains(place)));
        }
    }
}

// ---- The page table ----
