//! Raises closed depressions, so that from each sample a way down, or level, leads to the border of the region.
//!
//! The heights are those of a priority-flood (Barnes, Lehman & Mulla 2014): each sample gets the lowest height that a way
//! to the border must climb over. They are found without a queue of samples. Following lower neighbours, each sample
//! belongs to the basin of one local minimum, and water at a sample stands as high as at that minimum, or not at all. So
//! only the basins are flooded, over their lowest passes in ascending order (as Cordonnier, Bovy & Braun 2019 do for
//! routing), and the samples are passed over row by row.
//!
//! A region has under 2^32 samples.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use multiversion::multiversion;
use orogeny_field::{FillPits, MAX_HEIGHT_M, Plane, sanitized_height};

use super::around::{at, map_inside, offsets, put};

/// The basin of all samples that drain over the border without being raised.
const OUTSIDE: u32 = 0;
/// A sample that is its own lowest neighbour.
const LOWEST: u8 = 8;
/// What no place in a list is.
const NOWHERE: u32 = u32::MAX;

/// Raises the heights of the first channel, in metres, wherever water could not leave the region over its border.
///
/// Neighbours are the eight around a sample. Samples on the border are never raised, none is ever lowered, and with a slope
/// of 0 those that are in no pit keep their bits. With a slope above 0 also level ground is raised, and what lies above a
/// raised sample by less than that was raised: then every sample inside has a neighbour that is lower, by at least the
/// slope where the sample was raised. The result depends on the heights alone, not on any order. Should a height be none
/// (NaN or infinite), it becomes one first.
pub fn fill_pits(heights: &mut Plane, options: &FillPits) {
    let rect = heights.rect();
    let (width, area) = (rect.width() as usize, rect.area() as usize);
    let Some(samples) = heights.samples_mut().get_mut(..area) else { return };
    for height in samples.iter_mut().filter(|height| !height.is_finite()) {
        *height = sanitized_height(*height);
    }
    if rect.width() < 3 || rect.depth() < 3 {
        return;
    }
    let mut basins = Basins::of(samples, width);
    let passes = basins.passes(samples, width);
    let mut levels = basins.levels(&passes);
    let kept = options.max_depth_m.map(|max_depth_m| {
        let kept = basins.deep_levels(&passes, &levels, max_depth_m);
        for (level, kept) in levels.iter_mut().zip(&kept) {
            if *kept > f32::NEG_INFINITY {
                *level = f32::NEG_INFINITY;
            }
        }
        kept
    });
    raise(samples, &basins.of_sample, &levels);
    if options.slope_m > 0.0 {
        let kept = kept.as_deref().unwrap_or(&[]);
        let is_kept = |place: usize, height: f32| {
            let basin = at(&basins.of_sample, place, OUTSIDE);
            height < at(kept, basin as usize, f32::NEG_INFINITY)
        };
        Tilt::new(samples, width, options.slope_m, is_kept).run();
    }
}

/// Which basin each sample is in, and the height of each basin's lowest sample.
struct Basins {
    of_sample: Vec<u32>,
    lowest_m: Vec<f32>,
    /// For each provisional number in `of_sample`, until [`Self::passes`] replaces it: the basin.
    of_number: Vec<u32>,
}

/// The lowest way from one basin to another.
#[derive(Clone, Copy)]
struct Pass {
    height_m: f32,
    basins: [u32; 2],
}

impl Basins {
    /// Follows lowest neighbours. Samples are numbered in rows: one whose lowest neighbour has a number already takes it,
    /// any other starts a number, which is the same basin as that of the neighbour once this has one.
    fn of(samples: &[f32], width: usize) -> Self {
        let mut directions = vec![LOWEST; samples.len()];
        towards_lowest(samples, width, &mut directions);
        let offsets = offsets(width);
        let mut of_sample = vec![OUTSIDE; samples.len()];
        // The sample whose number each number follows, and the height of the sample that started it.
        let (mut followed, mut starts_m) = (vec![NOWHERE], vec![f32::NEG_INFINITY]);
        let (last_column, last_row) = (width - 1, samples.len() / width - 1);
        for row in 1..last_row {
            for place in row * width + 1..row * width + last_column {
                let direction = at(&directions, place, LOWEST);
                let lowest = offsets.get(usize::from(direction)).map(|step| place.wrapping_add_signed(*step));
                let number = match lowest {
                    Some(lowest) if lowest < place => at(&of_sample, lowest, OUTSIDE),
                    _ => {
                        followed.push(lowest.map_or(NOWHERE, |lowest| lowest as u32));
                        starts_m.push(at(samples, place, 0.0));
                        followed.len() as u32 - 1
                    }
                };
                put(&mut of_sample, place, number);
            }
        }
        let mut of_number = vec![NOWHERE; followed.len()];
        put(&mut of_number, 0, OUTSIDE);
        let mut lowest_m = vec![f32::NEG_INFINITY];
        let mut way = Vec::new();
        for number in 1..followed.len() as u32 {
            let mut end = number;
            let basin = loop {
                let known = at(&of_number, end as usize, OUTSIDE);
                if known != NOWHERE {
                    break known;
                }
                way.push(end);
                let next = at(&followed, end as usize, NOWHERE);
                if next == NOWHERE {
                    lowest_m.push(at(&starts_m, end as usize, 0.0));
                    break lowest_m.len() as u32 - 1;
                }
                end = at(&of_sample, next as usize, OUTSIDE);
            };
            for number in way.drain(..) {
                put(&mut of_number, number as usize, basin);
            }
        }
        Self { of_sample, lowest_m, of_number }
    }

    /// The passes between basins that touch. A pair may occur more than once: its lowest pass is among them.
    fn passes(&mut self, samples: &[f32], width: usize) -> Vec<Pass> {
        let mut passes = LowestPasses::new();
        let (mut north_heights, mut north_basins): (&[f32], &[u32]) = (&[], &[]);
        for (heights, basins) in samples.chunks_exact(width).zip(self.of_sample.chunks_exact_mut(width)) {
            for basin in basins.iter_mut() {
                *basin = at(&self.of_number, *basin as usize, OUTSIDE);
            }
            let basins: &[u32] = basins;
            let (east_heights, east_basins) = (but_first(heights), but_first(basins));
            passes.between(east_heights, east_basins, heights, basins);
            passes.between(heights, basins, north_heights, north_basins);
            passes.between(east_heights, east_basins, north_heights, north_basins);
            passes.between(heights, basins, but_first(north_heights), but_first(north_basins));
            (north_heights, north_basins) = (heights, basins);
        }
        self.of_number = Vec::new();
        passes.into_sorted()
    }

    /// The height that water in each basin must reach to get out, from passes in ascending order: basins grow together,
    /// and all of those that a pass joins to the outside drain over it.
    fn levels(&self, passes: &[Pass]) -> Vec<f32> {
        let num_basins = self.lowest_m.len();
        let mut levels = vec![f32::NEG_INFINITY; num_basins];
        let mut groups = Groups::new(num_basins);
        // The basins of a group, each with the next.
        let mut next = vec![NOWHERE; num_basins];
        let mut last: Vec<u32> = (0..num_basins as u32).collect();
        for pass in passes {
            let [first, second] = pass.basins.map(|basin| groups.root(basin));
            if first == second {
                continue;
            }
            let (kept, joined) = if second == OUTSIDE { (second, first) } else { (first, second) };
            groups.join(joined, kept);
            if kept == OUTSIDE {
                let mut basin = joined;
                while basin != NOWHERE {
                    put(&mut levels, basin as usize, pass.height_m);
                    basin = at(&next, basin as usize, NOWHERE);
                }
            } else {
                put(&mut next, at(&last, kept as usize, NOWHERE) as usize, joined);
                let end = at(&last, joined as usize, NOWHERE);
                put(&mut last, kept as usize, end);
            }
        }
        levels
    }

    /// The levels of the basins whose lake is deeper than that; no level for the others. Basins share a lake where the pass
    /// between them lies under water.
    fn deep_levels(&self, passes: &[Pass], levels: &[f32], max_depth_m: f32) -> Vec<f32> {
        let level_of = |basin: u32| at(levels, basin as usize, f32::NEG_INFINITY);
        let mut groups = Groups::new(levels.len());
        for pass in passes {
            let [first, second] = pass.basins;
            if pass.height_m < level_of(first) && pass.height_m < level_of(second) {
                let roots = [groups.root(first), groups.root(second)];
                groups.join(roots[0], roots[1]);
            }
        }
        let mut is_deep = vec![false; levels.len()];
        for (basin, (level, lowest)) in levels.iter().zip(&self.lowest_m).enumerate() {
            if level - lowest > max_depth_m {
                put(&mut is_deep, groups.root(basin as u32) as usize, true);
            }
        }
        let kept = |(basin, level): (usize, &f32)| {
            if at(&is_deep, groups.root(basin as u32) as usize, false) { *level } else { f32::NEG_INFINITY }
        };
        levels.iter().enumerate().map(kept).collect()
    }
}

/// For each sample inside, the direction of its lowest neighbour, by height and then by place; [`LOWEST`] where that is the
/// sample.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn towards_lowest(samples: &[f32], width: usize, directions: &mut [u8]) {
    map_inside(samples, width, directions, |centre, [n, e, s, w, ne, se, sw, nw]| {
        let (mut lowest, mut direction) = (centre, u32::from(LOWEST));
        // Those before the sample win over their equals, those after it do not: so no way comes round in a circle.
        for (height, towards) in [(w, 3), (ne, 4), (n, 0), (nw, 7)] {
            let is_lower = height <= lowest;
            lowest = if is_lower { height } else { lowest };
            direction = if is_lower { towards } else { direction };
        }
        for (height, towards) in [(e, 1), (sw, 6), (s, 2), (se, 5)] {
            let is_lower = height < lowest;
            lowest = if is_lower { height } else { lowest };
            direction = if is_lower { towards } else { direction };
        }
        direction as u8
    });
}

fn but_first<T>(row: &[T]) -> &[T] {
    row.get(1..).unwrap_or(&[])
}

fn raise(samples: &mut [f32], of_sample: &[u32], levels: &[f32]) {
    for (height, basin) in samples.iter_mut().zip(of_sample) {
        let level = at(levels, *basin as usize, f32::NEG_INFINITY);
        *height = if level > *height { level } else { *height };
    }
}

/// Gathers passes. A small table of pairs met lately keeps most repetitions away.
struct LowestPasses {
    lately: Vec<Pass>,
    passes: Vec<Pass>,
}

impl LowestPasses {
    const TABLE_BITS: u32 = 12;
    const NONE: Pass = Pass { height_m: f32::INFINITY, basins: [NOWHERE; 2] };

    fn new() -> Self {
        Self { lately: vec![Self::NONE; 1 << Self::TABLE_BITS], passes: Vec::new() }
    }

    /// Between the samples of one row and those beside them in another.
    fn between(&mut self, heights: &[f32], basins: &[u32], other_heights: &[f32], other_basins: &[u32]) {
        for ((height, basin), (other_height, other)) in
            heights.iter().zip(basins).zip(other_heights.iter().zip(other_basins))
        {
            if basin != other {
                self.add(height.max(*other_height), *basin, *other);
            }
        }
    }

    fn add(&mut self, height_m: f32, first: u32, second: u32) {
        let basins = [first.min(second), first.max(second)];
        let mixed = basins[0].wrapping_mul(0x9e37_79b1) ^ basins[1].wrapping_mul(0x85eb_ca77);
        let place = mixed >> (u32::BITS - Self::TABLE_BITS);
        if let Some(there) = self.lately.get_mut(place as usize) {
            if there.basins == basins {
                there.height_m = there.height_m.min(height_m);
            } else {
                if there.height_m < f32::INFINITY {
                    self.passes.push(*there);
                }
                *there = Pass { height_m, basins };
            }
        }
    }

    fn into_sorted(self) -> Vec<Pass> {
        let Self { lately, mut passes } = self;
        passes.extend(lately.into_iter().filter(|pass| pass.height_m < f32::INFINITY));
        passes.sort_unstable_by(|first, second| first.height_m.total_cmp(&second.height_m));
        passes
    }
}

/// Sets that only ever grow together.
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn new(num: usize) -> Self {
        Self { parents: (0..num as u32).collect() }
    }

    fn root(&mut self, member: u32) -> u32 {
        let mut member = member;
        loop {
            let parent = at(&self.parents, member as usize, member);
            if parent == member {
                return member;
            }
            let above = at(&self.parents, parent as usize, parent);
            put(&mut self.parents, member as usize, above);
            member = above;
        }
    }

    /// Makes the members of one root's set those of another's.
    fn join(&mut self, root: u32, with: u32) {
        put(&mut self.parents, root as usize, with);
    }
}

/// Is raised, or being raised.
const RAISED: u8 = 1;
/// Has been looked at, or is in the queue for it.
const QUEUED: u8 = 2;
/// Is never raised: on the border, or in a lake that stays.
const FIXED: u8 = 4;

/// Gives level ground a slope: from its outlets inwards, in ascending order of the heights that come out.
///
/// A sample that is not raised passes its own height on. Whether it has to be raised, because all that lay below it has been
/// raised past it, is asked when all lower heights are final; only those beside raised samples are asked.
struct Tilt<'a> {
    /// As they come out; infinite for samples to be raised of which no neighbour is final.
    heights: &'a mut [f32],
    states: Vec<u8>,
    offsets: [isize; 8],
    slope_m: f32,
    /// Samples to be asked, the lowest first.
    asked: Asked,
    /// Samples with their new heights, in ascending order of them.
    rising: VecDeque<u32>,
}

impl<'a> Tilt<'a> {
    fn new(heights: &'a mut [f32], width: usize, slope_m: f32, is_kept: impl Fn(usize, f32) -> bool) -> Self {
        let mut states = vec![FIXED; heights.len()];
        level_ground(heights, width, &mut states);
        for (place, (state, height)) in states.iter_mut().zip(heights.iter()).enumerate() {
            if is_kept(place, *height) {
                *state = FIXED;
            }
        }
        let offsets = offsets(width);
        let mut asked = Asked::default();
        let raised: Vec<usize> = states
            .iter()
            .enumerate()
            .filter(|(_, state)| **state == RAISED)
            .map(|(place, _)| place)
            .collect();
        for place in &raised {
            ask_around(*place, &offsets, &mut states, heights, |entry| asked.first.push(entry));
        }
        asked.first.sort_unstable_by_key(|entry| Reverse(*entry));
        for place in raised {
            put(heights, place, f32::INFINITY);
        }
        Self { heights, states, offsets, slope_m, asked, rising: VecDeque::new() }
    }

    fn run(mut self) {
        let mut steady = Vec::new();
        loop {
            let of_rising = self.rising.front().map(|place| at(self.heights, *place as usize, f32::INFINITY));
            let Some(level) = self.asked.lowest().into_iter().chain(of_rising).reduce(f32::min) else {
                break;
            };
            while let Some(place) = self.asked.pop_up_to(level) {
                if self.is_overtaken(place as usize, level) {
                    put(&mut self.states, place as usize, RAISED | QUEUED);
                    let asked = &mut self.asked;
                    let (offsets, states) = (&self.offsets, &mut self.states);
                    ask_around(place as usize, offsets, states, self.heights, |(height, place)| {
                        asked.later.push(Reverse((height, place)));
                    });
                    put(self.heights, place as usize, f32::INFINITY);
                } else {
                    steady.push(place);
                }
            }
            for place in steady.drain(..) {
                self.raise_around(place as usize, level);
            }
            while let Some(place) = self.rising.front().copied()
                && at(self.heights, place as usize, f32::INFINITY) <= level
            {
                self.rising.pop_front();
                self.raise_around(place as usize, level);
            }
        }
    }

    fn is_overtaken(&self, place: usize, height: f32) -> bool {
        let neighbour = |step: &isize| at(self.heights, place.wrapping_add_signed(*step), f32::INFINITY);
        at(&self.states, place, FIXED) & FIXED == 0
            && !self.offsets.iter().any(|step| neighbour(step) < height)
    }

    fn raise_around(&mut self, place: usize, height: f32) {
        let raised = raised_by(height, self.slope_m).min(MAX_HEIGHT_M);
        for step in self.offsets {
            let neighbour = place.wrapping_add_signed(step);
            if at(&self.states, neighbour, 0) & RAISED != 0
                && at(self.heights, neighbour, 0.0) == f32::INFINITY
            {
                put(self.heights, neighbour, raised);
                self.rising.push_back(neighbour as u32);
            }
        }
    }
}

/// Heights, by [`ordered`], and samples: most are known at first and are sorted once.
#[derive(Default)]
struct Asked {
    /// In descending order.
    first: Vec<(u32, u32)>,
    later: BinaryHeap<Reverse<(u32, u32)>>,
}

impl Asked {
    fn lowest(&self) -> Option<f32> {
        let first = self.first.last().map(|(height, _)| *height);
        let later = self.later.peek().map(|Reverse((height, _))| *height);
        first.into_iter().chain(later).min().map(from_ordered)
    }

    fn pop_up_to(&mut self, level: f32) -> Option<u32> {
        if self.first.last().is_some_and(|(height, _)| from_ordered(*height) <= level) {
            return self.first.pop().map(|(_, place)| place);
        }
        let is_due = self.later.peek().is_some_and(|Reverse((height, _))| from_ordered(*height) <= level);
        if is_due { self.later.pop().map(|Reverse((_, place))| place) } else { None }
    }
}

/// Queues the neighbours of a raised sample that are not raised and have not been asked.
fn ask_around(
    place: usize,
    offsets: &[isize; 8],
    states: &mut [u8],
    heights: &[f32],
    mut ask: impl FnMut((u32, u32)),
) {
    let height = at(heights, place, 0.0);
    for step in offsets {
        let neighbour = place.wrapping_add_signed(*step);
        let there = at(heights, neighbour, f32::NEG_INFINITY);
        if let Some(state) = states.get_mut(neighbour)
            && *state & (RAISED | QUEUED) == 0
            && there >= height
        {
            *state |= QUEUED;
            ask((ordered(there), neighbour as u32));
        }
    }
}

/// Marks the samples inside that have no lower neighbour.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn level_ground(heights: &[f32], width: usize, states: &mut [u8]) {
    map_inside(heights, width, states, |centre, around| {
        let has_lower = around.into_iter().fold(false, |has_lower, height| has_lower | (height < centre));
        u8::from(!has_lower) * RAISED
    });
}

/// The lowest `f32` that is above a height, and by no less than the slope.
fn raised_by(height: f32, slope_m: f32) -> f32 {
    let sum = height + slope_m;
    let is_enough = sum > height && f64::from(sum) - f64::from(height) >= f64::from(slope_m);
    if is_enough { sum } else { sum.next_up() }
}

/// Bits in the order of the heights.
const fn ordered(height: f32) -> u32 {
    let bits = height.to_bits();
    if bits >> 31 == 0 { bits ^ 0x8000_0000 } else { !bits }
}

/// The height of ordered bits.
const fn from_ordered(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 == 0 { !bits } else { bits ^ 0x8000_0000 })
}
