//! The levels above full resolution, after any sequence of edits, against a plain evaluation of whole planes.

use orogeny_field::{HeightBounds, Page, PageKey, PageLayout, TerrainGrid};
use orogeny_store::{EntryId, NewTerrain, Store};
use proptest::prelude::*;

use crate::support::{Scratch, assert_whole, bits, error_of, layer, layout};

const CONSTANT_M: f32 = 100.1;

/// A whole plane, row by row.
#[derive(Clone)]
struct Plane {
    width: usize,
    depth: usize,
    heights: Vec<f32>,
}

impl Plane {
    fn at(&self, x: isize, z: isize) -> f32 {
        let x = x.clamp(0, self.width as isize - 1) as usize;
        let z = z.clamp(0, self.depth as isize - 1) as usize;
        self.heights[z * self.width + x]
    }

    /// The next level, sample by sample as it is defined.
    fn above(&self) -> Self {
        let (width, depth) = (self.width.div_ceil(2), self.depth.div_ceil(2));
        let mut heights = Vec::with_capacity(width * depth);
        for z in 0..depth as isize {
            for x in 0..width as isize {
                let column = |dx: isize| {
                    let at = |dz: isize| self.at(2 * x + dx, 2 * z + dz);
                    (at(-1) + at(1)) + (at(0) + at(0))
                };
                let mean = ((column(-1) + column(1)) + (column(0) + column(0))) / 16.0;
                heights.push(if mean.abs() < f32::MIN_POSITIVE { 0.0 } else { mean });
            }
        }
        Self { width, depth, heights }
    }

    /// The height of the triangles of the plane, as a level, at a sample of full resolution.
    fn surface(&self, level: u8, x: usize, z: usize) -> f32 {
        let side = 1 << level;
        let (i, j) = ((x / side) as isize, (z / side) as isize);
        let (fx, fz) = ((x % side) as f32 / side as f32, (z % side) as f32 / side as f32);
        let (first, last) = (self.at(i, j), self.at(i + 1, j + 1));
        if fx >= fz {
            let east = self.at(i + 1, j);
            first + fx * (east - first) + fz * (last - east)
        } else {
            let south = self.at(i, j + 1);
            first + fz * (south - first) + fx * (last - south)
        }
    }

    /// Of the samples of a rectangle that the plane has.
    fn bounds(&self, x0: usize, z0: usize, side: usize) -> HeightBounds {
        let rows = z0..(z0 + side).min(self.depth);
        let inside = rows.flat_map(|z| (x0..(x0 + side).min(self.width)).map(move |x| (x, z)));
        let heights: Vec<f32> = inside.map(|(x, z)| self.heights[z * self.width + x]).collect();
        HeightBounds::of_row(&heights).unwrap()
    }
}

/// Every page of every level, and its bounds, against the plain planes.
fn assert_levels(store: &Store, plane: &Plane) {
    let (grid, layout, field) = (store.grid(), store.layout(), store.layers()[0].heights);
    let size = layout.size() as usize;
    let mut level_plane = plane.clone();
    for level in 0..=layout.top_level(&grid) {
        let (columns, rows) = layout.num_pages_at(&grid, level);
        for (z, x) in (0..rows).flat_map(|z| (0..columns).map(move |x| (z, x))) {
            let key = PageKey { field, level, z, x };
            let found = store.load_page(&key).unwrap();
            let (x0, z0) = (x as usize * size, z as usize * size);
            for (dz, dx) in (0..size).flat_map(|dz| (0..size).map(move |dx| (dz, dx))) {
                if x0 + dx < level_plane.width && z0 + dz < level_plane.depth {
                    let expected = level_plane.heights[(z0 + dz) * level_plane.width + x0 + dx];
                    let found = found.as_ref().map_or(CONSTANT_M, |page| page.samples()[dz * size + dx]);
                    assert_eq!(
                        found.to_bits(),
                        expected.to_bits(),
                        "{key:?} ({dx}, {dz}): {found} {expected}"
                    );
                }
            }
            let bounds = store.page_bounds(&key).unwrap();
            assert_eq!(bounds.is_some(), found.is_some());
            let expected = plane.bounds(x0 << level, z0 << level, size << level);
            assert_eq!(bounds.unwrap_or(HeightBounds::of(CONSTANT_M)), expected, "{key:?}");
            let error_m = error_of(store, &key).unwrap_or(0.0);
            let off = furthest(plane, &level_plane, level, [x0, z0], size);
            assert!(off <= error_m * 1.0001 + 0.01, "{key:?}: {off} {error_m}");
            // Of one level alone it is what it says.
            assert!(level > 1 || error_m <= off * 1.0001 + 0.01, "{key:?}: {off} {error_m}");
        }
        level_plane = level_plane.above();
    }
    assert_eq!((level_plane.width, level_plane.depth), {
        let above = grid.bounds_at(layout.top_level(&grid) + 1);
        (above.width() as usize, above.depth() as usize)
    });
}

/// How far the surface of a level is from the plane, from a page's first sample to the first of the next, or to the plane's end.
fn furthest(plane: &Plane, above: &Plane, level: u8, [x0, z0]: [usize; 2], size: usize) -> f32 {
    let along = |first: usize, num_above: usize, num: usize| {
        let last = first + size;
        (first << level)..if last < num_above { (last << level) + 1 } else { num }
    };
    let (columns, rows) = (along(x0, above.width, plane.width), along(z0, above.depth, plane.depth));
    let off = |(x, z): (usize, usize)| (above.surface(level, x, z) - plane.at(x as isize, z as isize)).abs();
    rows.flat_map(|z| columns.clone().map(move |x| (x, z))).map(off).fold(0.0, f32::max)
}

fn create(scratch: &Scratch, width: usize, depth: usize) -> Store {
    let grid = TerrainGrid::new(width as u64, depth as u64, 1.0).unwrap();
    let new = NewTerrain { grid, layout: layout(), layers: vec![layer("Base", CONSTANT_M)] };
    Store::create(&scratch.path(), &new).unwrap()
}

/// Sets a rectangle to noise, here and in the terrain.
fn paint(store: &mut Store, plane: &mut Plane, [x0, z0, width, depth]: [usize; 4], seed: u32) {
    let size = layout().size() as usize;
    let field = store.layers()[0].heights;
    let (x1, z1) = ((x0 + width).min(plane.width), (z0 + depth).min(plane.depth));
    for (z, x) in (z0..z1).flat_map(|z| (x0..x1).map(move |x| (z, x))) {
        let hash = ((x * 7919 + z) as u32 ^ seed).wrapping_mul(0x9e37_79b9) >> 12;
        // Now and then the constant again, so that pages and edges come and go.
        plane.heights[z * plane.width + x] =
            if seed.is_multiple_of(4) { CONSTANT_M } else { hash as f32 * 0.01 - 5e3 };
    }
    let mut pages = Vec::new();
    for (z, x) in
        (z0 / size..z1.div_ceil(size)).flat_map(|z| (x0 / size..x1.div_ceil(size)).map(move |x| (z, x)))
    {
        let mut page = Page::constant(layout(), CONSTANT_M);
        for (dz, dx) in (0..size).flat_map(|dz| (0..size).map(move |dx| (dz, dx))) {
            let (z, x) = (z * size + dz, x * size + dx);
            if z < plane.depth && x < plane.width {
                page.samples_mut()[dz * size + dx] = plane.heights[z * plane.width + x];
            }
        }
        pages.push((PageKey::full_resolution(field, x as u32, z as u32), page));
    }
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&pages).unwrap();
    transaction.commit("{}", "test").unwrap();
}

#[derive(Debug, Clone)]
enum Step {
    Paint([usize; 4], u32),
    Jump(prop::sample::Index),
    Reopen,
}

fn step() -> impl Strategy<Value = Step> {
    let rect = (0_usize..330, 0_usize..140, 1_usize..150, 1_usize..90);
    prop_oneof![
        4 => (rect, 0_u32..9).prop_map(|((x, z, width, depth), seed)| Step::Paint([x, z, width, depth], seed)),
        2 => any::<prop::sample::Index>().prop_map(Step::Jump),
        1 => Just(Step::Reopen),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn levels_are_those_of_the_whole_plane_whatever_was_done(
        width in 331_usize..400, depth in 141_usize..200, steps in prop::collection::vec(step(), 1..8),
    ) {
        let scratch = Scratch::new();
        let mut store = create(&scratch, width, depth);
        let mut plane = Plane { width, depth, heights: vec![CONSTANT_M; width * depth] };
        let mut states = vec![plane.clone()];
        for step in steps {
            match step {
                Step::Paint(rect, seed) => {
                    paint(&mut store, &mut plane, rect, seed);
                    states.push(plane.clone());
                }
                Step::Jump(target) => {
                    let target = target.index(states.len());
                    store.jump(EntryId(target as u32)).unwrap();
                    plane = states[target].clone();
                }
                Step::Reopen => {
                    store.close().unwrap();
                    store = Store::open(&scratch.path()).unwrap();
                }
            }
            assert_levels(&store, &plane);
        }
        assert_whole(&store);
    }
}

#[test]
fn an_edit_touches_only_what_lies_above_it() {
    let scratch = Scratch::new();
    let grid = TerrainGrid::new(1 << 20, 1 << 20, 1.0).unwrap();
    let new = NewTerrain { grid, layout: PageLayout::default(), layers: vec![layer("Base", 0.0)] };
    let mut store = Store::create(&scratch.path(), &new).unwrap();
    let field = store.layers()[0].heights;
    let key = PageKey::full_resolution(field, 1701, 3111);
    let mut page = Page::constant(PageLayout::default(), 0.0);
    page.samples_mut()[256 * 100 + 100] = 16.0;
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(key, page)]).unwrap();
    transaction.commit("{}", "test").unwrap();
    let mut expected = vec![key];
    for _ in 0..12 {
        expected.push(expected.last().unwrap().parent());
    }
    assert_eq!(store.page_keys(field).unwrap(), expected);
    for key in expected {
        assert_eq!(store.page_bounds(&key).unwrap(), Some(HeightBounds { min_m: 0.0, max_m: 16.0 }));
    }
    // (100, 100) lies on (50, 50) of the next level, which takes a quarter of it.
    let above = store.load_page(&key.parent()).unwrap().unwrap();
    assert_eq!(above.row(128 + 50, 128 + 50, 128 + 51), Some([4.0].as_slice()));
    store.undo(1).unwrap();
    assert!(store.page_keys(field).unwrap().is_empty());
    assert_whole(&store);
}

#[test]
fn an_edge_reaches_into_the_next_page_above_and_goes_with_it() {
    let scratch = Scratch::new();
    let mut store = create(&scratch, 256, 128);
    let mut plane = Plane { width: 256, depth: 128, heights: vec![CONSTANT_M; 256 * 128] };
    paint(&mut store, &mut plane, [127, 10, 1, 1], 1);
    let field = store.layers()[0].heights;
    let beyond = PageKey { field, level: 1, z: 0, x: 1 };
    assert!(store.load_page(&beyond).unwrap().is_some(), "its first column reads column 127");
    assert_levels(&store, &plane);
    paint(&mut store, &mut plane, [127, 10, 1, 1], 4);
    assert!(store.load_page(&beyond).unwrap().is_none());
    assert_levels(&store, &plane);
    let restored = bits(&Page::constant(layout(), CONSTANT_M));
    assert_eq!(bits(&store.load_page(&PageKey::full_resolution(field, 1, 0)).unwrap().unwrap()), restored);
    assert_whole(&store);
}

/// Against what SciPy makes of the definition, in `f64`: `tests/fixtures/field/make.py`.
#[test]
fn levels_are_those_that_scipy_makes() {
    let fixture = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/field/levels.json");
    let cases: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(fixture).unwrap()).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let (mut num_places, mut worst) = (0, 0.0_f64);
    for case in cases.as_array().unwrap() {
        let (width, depth) = (number(&case["width"]) as usize, number(&case["depth"]) as usize);
        let scratch = Scratch::new();
        let mut store = create(&scratch, width, depth);
        paint_ground(&mut store, width, depth);
        let (field, levels) = (store.layers()[0].heights, case["levels"].as_array().unwrap());
        assert_eq!(levels.len(), usize::from(layout().top_level(&store.grid())));
        for (level, expected) in (1_u8..).zip(levels) {
            let rect = store.grid().bounds_at(level);
            assert_eq!(
                (f64::from(rect.width()), f64::from(rect.depth())),
                (number(&expected["width"]), number(&expected["depth"]))
            );
            for place in expected["places"].as_array().unwrap() {
                let (z, x) = (number(&place[0]) as u32, number(&place[1]) as u32);
                let page = store.load_page(&PageKey { field, level, z: z / 64, x: x / 64 }).unwrap().unwrap();
                let found = page.row(z % 64, x % 64, x % 64 + 1).unwrap()[0];
                worst = worst.max((f64::from(found) - number(&place[2])).abs());
                num_places += 1;
            }
            for page in expected["bounds"].as_array().unwrap() {
                let key = PageKey { field, level, z: number(&page[0]) as u32, x: number(&page[1]) as u32 };
                let bounds = HeightBounds { min_m: number(&page[2]) as f32, max_m: number(&page[3]) as f32 };
                assert_eq!(store.page_bounds(&key).unwrap(), Some(bounds), "{key:?}");
            }
        }
    }
    println!("{num_places} samples, at most {worst:e} m apart");
    // A few units in the last place of heights of up to 2,600 m, for three levels.
    assert!(num_places > 300 && worst < 1.0e-3, "{num_places} samples, {worst} m apart");
}

/// The heights of the fixture, which `f32` holds exactly.
fn paint_ground(store: &mut Store, width: usize, depth: usize) {
    let field = store.layers()[0].heights;
    let places = layout().pages_in(store.grid().bounds());
    let pages: Vec<_> = places
        .map(|(page_x, page_z)| {
            let mut page = Page::constant(layout(), CONSTANT_M);
            for (index, height_m) in page.samples_mut().iter_mut().enumerate() {
                let (x, z) = (page_x as usize * 64 + index % 64, page_z as usize * 64 + index / 64);
                if x < width && z < depth {
                    *height_m = ((x * 7919 + z * 104_729 + x * z * 31) % 65_536) as f32 * 0.0625 - 1500.0;
                }
            }
            (PageKey::full_resolution(field, page_x, page_z), page)
        })
        .collect();
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&pages).unwrap();
    transaction.commit("{}", "test").unwrap();
}
