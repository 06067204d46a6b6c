//! How much ground drains through each sample, and masks of it.

use std::collections::VecDeque;

use multiversion::multiversion;
use orogeny_field::{FillPits, FlowMask, FlowRouting, Plane};

use super::around::{INVERSE_DISTANCES, at, map_inside, offsets, opposite, put};
use super::fill_pits::fill_pits;
use crate::transcendental::{exp_minus_one, natural_log};

/// A sample whose water leaves the region.
const OUT: u8 = 8;
/// A sample without a lower neighbour.
const LEVEL: u8 = 9;
/// Added to a direction that is not final.
const WAITS: u8 = 16;

/// The area that drains through each sample, itself included, in samples.
///
/// The heights are taken as they are after [`fill_pits`] without a slope. A sample on the border sends its water out of the
/// region, whatever lies beside it, and all others to lower neighbours by `routing`; the steepest is the first of equals, in
/// the order north, east, south, west, north-east, south-east, south-west, north-west. Where the ground is level, filled pits
/// above all, all water goes back on the way on which a flood would have come from the outlets: into the deepest water first
/// and then up the sides, so that rivers follow the bed of the lake that they cross, and over ground that was level already
/// by the fewest steps. So no water stays inside, and the areas on the border add up to the region's.
///
/// Areas are summed in integers ([`FlowRouting::Steepest`]) or in `f64`, always in the same order, and rounded once. A region
/// has under 2^32 samples.
#[must_use]
pub fn flow(heights: &Plane, routing: FlowRouting) -> Plane {
    let rect = heights.rect();
    let (width, area) = (rect.width() as usize, rect.area() as usize);
    let mut filled = heights.clone();
    fill_pits(&mut filled, &FillPits::default());
    let surface = filled.samples().get(..area).unwrap_or(&[]);
    let directions = directions(heights.samples(), surface, width);
    let areas = match routing {
        FlowRouting::Steepest => {
            let areas = steepest(&directions, width);
            areas.into_iter().map(|area| area as f32).collect()
        }
        FlowRouting::Shared { exponent } => {
            let areas = shared(surface, width, &directions, exponent);
            areas.into_iter().map(|area| area as f32).collect()
        }
    };
    drop(directions);
    Plane::from_samples(rect, 1, areas).unwrap_or(filled)
}

/// Turns areas in samples, as [`flow`] gives them, into a mask: 0 up to the first area of `mask`, 1 from the second on, and in
/// between as the logarithm of the area.
#[must_use]
pub fn flow_mask(areas: &Plane, spacing_m: f64, mask: &FlowMask) -> Plane {
    let mut values = areas.clone();
    mask_values(values.samples_mut(), (spacing_m * spacing_m) as f32, mask);
    values
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn mask_values(values: &mut [f32], sample_m2: f32, mask: &FlowMask) {
    let inverse_from = 1.0 / mask.from_m2;
    let inverse_range = 1.0 / natural_log(mask.to_m2 * inverse_from);
    for value in values {
        let area_m2 = *value * sample_m2;
        let between = (natural_log(area_m2 * inverse_from) * inverse_range).clamp(0.0, 1.0);
        let from_below = if area_m2 >= mask.to_m2 { 1.0 } else { between };
        // Asked this way round, since a comparison with NaN is false.
        *value = if area_m2 > mask.from_m2 { from_below } else { 0.0 };
    }
}

/// Where each sample's water goes, all or most of it: a direction or [`OUT`].
fn directions(bed: &[f32], surface: &[f32], width: usize) -> Vec<u8> {
    let mut directions = vec![OUT; surface.len()];
    towards_steepest(surface, width, &mut directions);
    let offsets = offsets(width);
    let same_level = |place: usize, step: isize| {
        let neighbour = place.wrapping_add_signed(step);
        (at(surface, neighbour, f32::NAN) == at(surface, place, 0.0)).then_some(neighbour)
    };
    let depth = |place: usize| at(surface, place, 0.0) - at(bed, place, 0.0);
    let mut outlets = Vec::new();
    for (place, _) in directions.iter().enumerate().filter(|(_, direction)| **direction == LEVEL) {
        let out = offsets.iter().zip(0_u8..).find(|(step, _)| {
            same_level(place, **step).is_some_and(|neighbour| at(&directions, neighbour, LEVEL) != LEVEL)
        });
        if let Some((_, direction)) = out {
            outlets.push((place, direction));
        }
    }
    let mut flood = DeepestFirst::new();
    for (place, direction) in outlets {
        put(&mut directions, place, direction | WAITS);
        flood.push(depth(place), place);
    }
    while let Some(place) = flood.pop() {
        let mut towards = at(&directions, place, OUT) & !WAITS;
        let (here, mut steepest) = (at(bed, place, 0.0), 0.0);
        for ((step, inverse_distance), direction) in offsets.iter().zip(INVERSE_DISTANCES).zip(0_u8..) {
            let Some(neighbour) = same_level(place, *step) else { continue };
            match at(&directions, neighbour, OUT) {
                LEVEL => {
                    put(&mut directions, neighbour, opposite(direction) | WAITS);
                    flood.push(depth(neighbour), neighbour);
                }
                WAITS.. => {}
                _ => {
                    let slope = (here - at(bed, neighbour, here)) * inverse_distance;
                    if slope > steepest {
                        (steepest, towards) = (slope, direction);
                    }
                }
            }
        }
        put(&mut directions, place, towards);
    }
    directions
}

/// A queue of samples under water: the deepest comes first, of depths within 1/128 of each other the one that came first.
struct DeepestFirst {
    of_depth: Vec<VecDeque<u32>>,
    /// No deeper queue has anything in it.
    deepest: usize,
}

impl DeepestFirst {
    /// Bits of a depth that do not tell it from others.
    const IGNORED_BITS: u32 = 16;

    fn new() -> Self {
        let num_depths = (f32::INFINITY.to_bits() >> Self::IGNORED_BITS) as usize + 1;
        Self { of_depth: vec![VecDeque::new(); num_depths], deepest: 0 }
    }

    fn push(&mut self, depth: f32, place: usize) {
        let queue = (depth.max(0.0).to_bits() >> Self::IGNORED_BITS) as usize;
        if let Some(places) = self.of_depth.get_mut(queue) {
            places.push_back(place as u32);
            self.deepest = self.deepest.max(queue);
        }
    }

    fn pop(&mut self) -> Option<usize> {
        loop {
            if let Some(place) = self.of_depth.get_mut(self.deepest)?.pop_front() {
                return Some(place as usize);
            }
            self.deepest = self.deepest.checked_sub(1)?;
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn towards_steepest(surface: &[f32], width: usize, directions: &mut [u8]) {
    map_inside(surface, width, directions, |centre, around| {
        let (mut steepest, mut direction) = (0.0, u32::from(LEVEL));
        for ((height, inverse_distance), towards) in around.into_iter().zip(INVERSE_DISTANCES).zip(0..) {
            let slope = (centre - height) * inverse_distance;
            let is_steeper = slope > steepest;
            steepest = if is_steeper { slope } else { steepest };
            direction = if is_steeper { towards } else { direction };
        }
        direction as u8
    });
}

/// Areas where each sample sends all its water one way: from each spring down, as far as all that flows in is known.
fn steepest(directions: &[u8], width: usize) -> Vec<u32> {
    let offsets = offsets(width);
    let below = |place: usize| {
        let direction = at(directions, place, OUT);
        offsets.get(usize::from(direction)).map(|step| place.wrapping_add_signed(*step))
    };
    let mut num_unknown = vec![0_u8; directions.len()];
    for place in 0..directions.len() {
        if let Some(num) = below(place).and_then(|below| num_unknown.get_mut(below)) {
            *num += 1;
        }
    }
    let mut areas = vec![1_u32; directions.len()];
    // What has been passed on is marked, so that no way is gone twice.
    const PASSED_ON: u8 = u8::MAX;
    for spring in 0..directions.len() {
        let mut place = spring;
        while at(&num_unknown, place, PASSED_ON) == 0 {
            put(&mut num_unknown, place, PASSED_ON);
            let Some(below) = below(place) else { break };
            let area = at(&areas, place, 0);
            if let (Some(there), Some(num)) = (areas.get_mut(below), num_unknown.get_mut(below)) {
                *there += area;
                *num -= 1;
            }
            place = below;
        }
    }
    areas
}

/// Areas where each sample shares its water among its lower neighbours. Those on level ground go by `directions`.
fn shared(surface: &[f32], width: usize, directions: &[u8], exponent: f32) -> Vec<f64> {
    let offsets = offsets(width);
    let power = Power::new(exponent);
    let mut num_unknown = vec![0_u8; surface.len()];
    count_higher(surface, width, &mut num_unknown);
    for place in 0..surface.len() {
        let here = at(surface, place, 0.0);
        match at(directions, place, OUT) {
            OUT => {
                // The border sends nothing inside. What lies beside it across the end of a row is border too.
                put(&mut num_unknown, place, NEVER);
                for step in offsets {
                    let inside = place.wrapping_add_signed(step);
                    if at(directions, inside, OUT) != OUT && at(surface, inside, here) < here {
                        add(&mut num_unknown, inside, u8::MAX);
                    }
                }
            }
            direction => {
                let below = place.wrapping_add_signed(at(&offsets, usize::from(direction), 0));
                if at(surface, below, f32::NAN) == here {
                    add(&mut num_unknown, below, 1);
                }
            }
        }
    }
    let mut areas = vec![1.0_f64; surface.len()];
    let mut known = Vec::new();
    for spring in 0..surface.len() {
        if at(&num_unknown, spring, NEVER) != 0 {
            continue;
        }
        put(&mut num_unknown, spring, NEVER);
        known.push(spring);
        while let Some(place) = known.pop() {
            let area = at(&areas, place, 0.0);
            let [first, second, third] = [place - width - 1, place - 1, place + width - 1];
            let row = |first: usize| surface.get(first..).and_then(<[f32]>::first_chunk::<3>);
            let (Some([nw, n, ne]), Some([w, here, e]), Some([sw, s, se])) =
                (row(first), row(second), row(third))
            else {
                continue;
            };
            let heights = [*n, *e, *s, *w, *ne, *se, *sw, *nw];
            let (weights, sum) = power.shares(*here, heights);
            if sum > 0.0 {
                let unit = area / sum;
                let [n, e, s, w, ne, se, sw, nw] = weights.map(|weight| unit * f64::from(weight));
                let [is_n, is_e, is_s, is_w, is_ne, is_se, is_sw, is_nw] =
                    heights.map(|height| u8::from(height < *here));
                // To all neighbours, since asking which are lower takes longer than adding 0.
                send(&mut areas, &mut num_unknown, first, [nw, n, ne], [is_nw, is_n, is_ne], &mut known);
                send(&mut areas, &mut num_unknown, second, [w, 0.0, e], [is_w, 0, is_e], &mut known);
                send(&mut areas, &mut num_unknown, third, [sw, s, se], [is_sw, is_s, is_se], &mut known);
            } else {
                let step = at(&offsets, usize::from(at(directions, place, OUT)), 0);
                let below = place.wrapping_add_signed(step);
                send(&mut areas, &mut num_unknown, below, [area], [1], &mut known);
            }
        }
    }
    areas
}

/// Adds shares to samples of a row from the first on, and lists those that are complete by it.
#[inline(always)]
fn send<const N: usize>(
    areas: &mut [f64],
    num_unknown: &mut [u8],
    first: usize,
    shares: [f64; N],
    nums: [u8; N],
    known: &mut Vec<usize>,
) {
    let areas = areas.get_mut(first..).and_then(<[f64]>::first_chunk_mut::<N>);
    let num_unknown = num_unknown.get_mut(first..).and_then(<[u8]>::first_chunk_mut::<N>);
    if let (Some(areas), Some(num_unknown)) = (areas, num_unknown) {
        for (area, share) in areas.iter_mut().zip(shares) {
            *area += share;
        }
        for ((unknown, num), place) in num_unknown.iter_mut().zip(nums).zip(first..) {
            *unknown = unknown.wrapping_sub(num);
            if *unknown == 0 {
                *unknown = NEVER;
                known.push(place);
            }
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn count_higher(surface: &[f32], width: usize, nums: &mut [u8]) {
    map_inside(surface, width, nums, |centre, around| {
        around.into_iter().fold(0_u32, |num, height| num + u32::from(height > centre)) as u8
    });
}

/// A count of what a sample waits for that never comes to 0: it has sent on its water, or sends none.
const NEVER: u8 = 128;

fn add(counts: &mut [u8], place: usize, count: u8) {
    if let Some(there) = counts.get_mut(place) {
        *there = there.wrapping_add(count);
    }
}

/// A power of slopes, by straight lines between [`Power::NUM_PARTS`] places in each octave: within `exponent² / 32768` of the
/// power. It is asked eight times a sample, and a logarithm and an exponential would take longer than all the rest.
struct Power {
    /// Of `2^-OCTAVES ..= 2`: values, and how much they grow to the next.
    table: Vec<[f32; 2]>,
}

impl Power {
    /// Neighbours whose slope is less than `2^-OCTAVES` of the steepest get nothing.
    const OCTAVES: u32 = 24;
    /// More is taken as this, where half the slope already gets 2^-100.
    const MAX_EXPONENT: f32 = 100.0;
    const PART_BITS: u32 = 6;
    const NUM_PARTS: u32 = 1 << Self::PART_BITS;
    const LINE_BITS: u32 = f32::MANTISSA_DIGITS - 1 - Self::PART_BITS;
    const ONE_LINE: f32 = 1.0 / (1_u32 << Self::LINE_BITS) as f32;

    fn new(exponent: f32) -> Self {
        // Asked this way round, since a comparison with NaN is false.
        let exponent = if exponent > 0.0 { exponent.min(Self::MAX_EXPONENT) } else { 0.0 };
        let lowest = (0.5_f32).powi(Self::OCTAVES.cast_signed()).to_bits();
        let power = |part: u32| {
            let place = f32::from_bits(lowest + (part << Self::LINE_BITS));
            // Of half the place, which is 1 at most, so that the largest exponent does not overflow; as one over the power of
            // the inverse, which keeps the digits of small ones.
            1.0 / (exp_minus_one(-exponent * natural_log(0.5 * place)) + 1.0)
        };
        let num_parts = (Self::OCTAVES + 1) * Self::NUM_PARTS;
        let table = (0..num_parts).map(|part| [power(part), power(part + 1) - power(part)]).collect();
        Self { table }
    }

    /// What each neighbour gets, in proportion, and the sum; all 0 where none is lower.
    #[inline(always)]
    fn shares(&self, here: f32, heights: [f32; 8]) -> ([f32; 8], f64) {
        let larger = |first: f32, second: f32| if first > second { first } else { second };
        let mut slopes = [0.0; 8];
        for ((slope, height), inverse_distance) in slopes.iter_mut().zip(heights).zip(INVERSE_DISTANCES) {
            *slope = larger((here - height) * inverse_distance, 0.0);
        }
        let [n, e, s, w, ne, se, sw, nw] = slopes;
        let steepest = larger(larger(larger(n, e), larger(s, w)), larger(larger(ne, se), larger(sw, nw)));
        if steepest <= 0.0 {
            return (slopes, 0.0);
        }
        // The bits of a slope from those of the steepest's octave, and so the place in the table of their ratio.
        let octave = steepest.to_bits() >> (f32::MANTISSA_DIGITS - 1);
        let lowest = octave.saturating_sub(Self::OCTAVES) << (f32::MANTISSA_DIGITS - 1);
        let share = |slope: f32| {
            let ratio = slope.to_bits().saturating_sub(lowest);
            let [value, growth] = at(&self.table, (ratio >> Self::LINE_BITS) as usize, [0.0; 2]);
            let along = (ratio & ((1 << Self::LINE_BITS) - 1)).cast_signed() as f32 * Self::ONE_LINE;
            if ratio > 0 { value + along * growth } else { 0.0 }
        };
        let shares = [share(n), share(e), share(s), share(w), share(ne), share(se), share(sw), share(nw)];
        let [n, e, s, w, ne, se, sw, nw] = shares.map(f64::from);
        (shares, ((n + e) + (s + w)) + ((ne + se) + (sw + nw)))
    }
}
