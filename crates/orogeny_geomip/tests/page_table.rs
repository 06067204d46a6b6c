//! The page table: from which page the shaders read, beside plain evaluations.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "helpers of tests, which clippy does not take for tests"
)]

use std::collections::HashMap;
use std::fmt;

use orogeny_field::{PageLayout, TerrainGrid, hash};
use orogeny_geomip::{Holder, PagePlace, PageTable, TABLE_SIDE};
use proptest::prelude::*;

/// `find` of `shaders/scene/ground.wgsl`: the entry for a sample of a level.
fn find(table: &PageTable, [top, page_size_log2]: [u32; 2], level: u32, sample: [i32; 2]) -> u32 {
    const SIDE: i32 = TABLE_SIDE.cast_signed();
    for above in level..=top {
        let page = sample.map(|sample| (sample >> (above - level)) >> page_size_log2);
        let window = table.windows()[above as usize];
        if page[0] >= window[0] && page[1] >= window[1] && page[0] < window[2] && page[1] < window[3] {
            let wrapped = page.map(|page| page & (SIDE - 1));
            let index = (above.cast_signed() * SIDE + wrapped[1]) * SIDE + wrapped[0];
            return table.entries()[usize::try_from(index).unwrap()];
        }
    }
    u32::MAX
}

/// What an entry says to the shaders: the level and what holds the page.
fn read_entry(entry: u32) -> Option<(u8, Holder)> {
    let slot = entry & 0x07ff_ffff;
    let holder = if slot == 0x07ff_ffff { Holder::Constant } else { Holder::Slot(slot) };
    (entry != u32::MAX).then_some(((entry >> 27) as u8, holder))
}

fn is_in(window: [i32; 4], place: PagePlace) -> bool {
    let [x, z] = [place.x, place.z].map(u32::cast_signed);
    (window[0]..window[2]).contains(&x) && (window[1]..window[3]).contains(&z)
}

struct Tabled {
    grid: TerrainGrid,
    layout: PageLayout,
    eye: [i32; 2],
    held: HashMap<PagePlace, Holder>,
    seed: u32,
}

impl fmt::Debug for Tabled {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { grid, layout, eye, held, seed } = self;
        write!(to, "{grid:?} of pages of {}, {} held, eye {eye:?}, seed {seed}", layout.size(), held.len())
    }
}

fn side() -> impl Strategy<Value = u64> {
    prop_oneof![1..300_u64, 1..40_000_u64, 500_000..=1_u64 << 20, Just(1 << 20)]
}

/// Pages around an eye, over the terrain or beside it, that are held by chance.
fn tabled() -> impl Strategy<Value = Tabled> {
    let eye = || prop_oneof![0.0..=1.0_f64, -1.0..2.0_f64, Just(0.0), Just(1.0), Just(-2000.0), Just(2000.0)];
    let page_size = prop_oneof![Just(64), Just(256), Just(4096)];
    ((side(), side()), page_size, (eye(), eye()), 0.0..1.0_f32, any::<u32>()).prop_map(
        |((width, depth), page_size, (eye_x, eye_z), share, seed)| {
            let grid = TerrainGrid::new(width, depth, 1.0).unwrap();
            let layout = PageLayout::new(page_size).unwrap();
            // It stops at the ends of 32 bits.
            let eye = [eye_x * (width - 1) as f64, eye_z * (depth - 1) as f64].map(|at| at as i32);
            let mut held = HashMap::new();
            for level in 0..=layout.top_level(&grid) {
                let (columns, rows) = layout.num_pages_at(&grid, level);
                let first = [(eye[0], columns), (eye[1], rows)].map(|(eye, num)| {
                    let page = (eye >> level) / layout.size().cast_signed();
                    page.clamp(0, num.cast_signed() - 1).unsigned_abs().saturating_sub(40)
                });
                let [xs, zs] =
                    [(first[0], columns), (first[1], rows)].map(|(first, num)| first..num.min(first + 80));
                for (z, x) in zs.flat_map(|z| xs.clone().map(move |x| (z, x))) {
                    let chance = hash::uniform(x, z, seed.wrapping_add(level.into()));
                    if chance < share * share {
                        let slot = held.len() as u32;
                        let holder = if chance < 0.1 * share { Holder::Constant } else { Holder::Slot(slot) };
                        held.insert(PagePlace { level, z, x }, holder);
                    }
                }
            }
            Tabled { grid, layout, eye, held, seed }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn a_page_is_read_from_itself_or_the_next_one_above_that_is_there(tabled in tabled()) {
        let Tabled { grid, layout, eye, held, seed } = tabled;
        let table = PageTable::new(&grid, layout, eye, &held);
        let (top, windows) = (layout.top_level(&grid), table.windows());
        let above = |place: PagePlace| {
            std::iter::successors(Some(place), |place| (place.level < top).then(|| place.parent()))
        };
        prop_assert_eq!(table.entries().len(), (usize::from(top) + 1) * (TABLE_SIDE * TABLE_SIDE) as usize);
        for level in 0..=top {
            let (columns, rows) = layout.num_pages_at(&grid, level);
            let window = windows[usize::from(level)];
            for number in 0..60 {
                let chance = |axis| hash::hash(number, axis, seed ^ u32::from(level));
                // Within the window, or anywhere.
                let [x, z] = [(0, columns), (1, rows)].map(|(axis, num)| {
                    let (first, last) = (window[axis], window[axis + 2]);
                    if number % 4 == 0 {
                        chance(axis as u32) % num
                    } else {
                        first.unsigned_abs() + chance(axis as u32) % (last - first).unsigned_abs()
                    }
                });
                let place = PagePlace { level, z, x };
                let in_window = above(place).find(|place| is_in(windows[usize::from(place.level)], *place)).unwrap();
                // Windows lie within those above them: what is held is found.
                prop_assert!(above(in_window).all(|place| is_in(windows[usize::from(place.level)], place)));
                let expected = above(in_window).find_map(|place| Some((place.level, *held.get(&place)?)));
                prop_assert_eq!(table.lookup(place), expected, "{:?}", place);

                let within = |axis: u32| (chance(axis) % layout.size()).cast_signed();
                let sample = [(x, 2), (z, 3)].map(|(page, axis)| (page * layout.size()).cast_signed() + within(axis));
                let entry = find(&table, [top.into(), layout.size().trailing_zeros()], level.into(), sample);
                prop_assert_eq!(read_entry(entry), expected, "{:?}", place);
            }
        }
    }

    #[test]
    fn a_window_lies_around_the_eye_and_holds_all_of_a_small_level(tabled in tabled()) {
        let Tabled { grid, layout, eye, held, .. } = tabled;
        let windows = PageTable::new(&grid, layout, eye, &held).windows();
        for (level, window) in (0..).zip(windows) {
            if level > layout.top_level(&grid) {
                prop_assert_eq!(window, [0; 4]);
                continue;
            }
            let (columns, rows) = layout.num_pages_at(&grid, level);
            for (axis, num) in [columns, rows].into_iter().enumerate() {
                let (first, end) = (window[axis], window[axis + 2]);
                if num <= TABLE_SIDE {
                    prop_assert_eq!([first, end], [0, num.cast_signed()]);
                }
                prop_assert!(first >= 0 && end <= num.cast_signed());
                prop_assert_eq!((end - first).unsigned_abs(), num.min(TABLE_SIDE));
                // That next to the eye, with as many on both sides as there are.
                let page = (eye[axis] >> level).div_euclid(layout.size().cast_signed()).clamp(0, num.cast_signed() - 1);
                let half = TABLE_SIDE.cast_signed() / 2;
                prop_assert!(first <= (page - half).max(0) && end >= (page + half).min(num.cast_signed()));
            }
        }
    }
}
