//! Erosion by single drops of water: each runs down from a random place, takes up rock while it can hold more, and lays down
//! what it cannot hold (after Beyer 2015, "Implementation of a method for hydraulic erosion", lengths in samples so that it
//! does not depend on the spacing).
//!
//! Droplets come in rounds, all of which read the heights from before the round. What they change is counted in 2^-16 m, so the
//! order in which they run does not matter, and rock is neither won nor lost: a droplet's load is the sum of what it took.
//! [`settle_row`] applies a round's changes, and keeps what the heights were too coarse to take for the next.
//!
//! A sample gets at most [`DROPLET_BUDGET`] units from one droplet, and loses at most as much, since that is the most that it
//! takes up in its life: 4,096 of them, with half an ulp of the largest height left over, stay within an `i32`.
//!
//! A droplet at `p`, on the bilinear surface with gradient `∇h` (metres a sample), speed `v` (1 at first), water `w` (1 at
//! first), load `s`:
//!
//! - direction `e ← (inertia e − (1 − inertia) ∇h)` normalised; where that is 0, it ends; `p' = p + e`, one sample on; where that is
//!   outside the region, it ends;
//! - `Δ = h(p') − h(p)`; `C = capacity · max(−Δ, least drop) · v · w`, in metres;
//! - uphill (`Δ > 0`) it lays down `min(Δ, s)` at `p`, and above capacity `deposition (s − C)`, on the four samples around by
//!   bilinear weights; otherwise it takes up `min(erosion (C − s), −Δ)` from the disc around `p`;
//! - `v ← √max(0, v² − gravity Δ)`, `w ← w · staying`.
//!
//! What it carries at its end is laid down on the disc where it is.

use multiversion::multiversion;
use orogeny_field::hash::{bits_to_uniform, hash};
use orogeny_field::{DISC_LANES, DROPLET_BUDGET, DropletKernel, Plane, SampleRect, sanitized_height};

use super::padded::{larger, smaller};

/// Units a metre.
const UNITS: f32 = 65_536.0;
/// Metres a unit.
const UNIT_M: f32 = 1.0 / 65_536.0;
/// Shorter directions, in metres a sample, are none.
const LEAST_SLOPE: f32 = 1.0e-12;

/// A place between samples: the one to its north-west, and how far on, 0..1.
#[derive(Debug, Clone, Copy)]
struct Spot {
    cell: [i32; 2],
    fraction: [f32; 2],
}

/// The bilinear surface at a spot.
#[derive(Debug, Clone, Copy)]
struct Surface {
    height: f32,
    slope: [f32; 2],
}

/// The sample to the north-west of where a droplet starts. What it reads and changes lies within [`DropletKernel::reach`] of it.
#[must_use]
pub fn start(index: u32, round: u32, bounds: &SampleRect, kernel: &DropletKernel) -> [i32; 2] {
    Spot::first(index, round, bounds, kernel.seed).cell
}

/// Traces droplet `index` of a round over heights that hold all of its [`DropletKernel::reach`], or end at `bounds`, and calls
/// `change(x, z, units)` with changes of the samples `x ..` of row `z`, all within `bounds`, in units of 2^-16 m. Those of one
/// droplet sum to 0.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn trace<F: FnMut(i32, i32, &[i32])>(
    index: u32,
    round: u32,
    heights: &Plane,
    bounds: &SampleRect,
    kernel: &DropletKernel,
    mut change: F,
) {
    if bounds.width() < 2 || bounds.depth() < 2 {
        return;
    }
    let ground = Ground::new(heights);
    let mut spot = Spot::first(index, round, bounds, kernel.seed);
    let mut surface = ground.at(&spot);
    let mut direction = [0.0_f32; 2];
    let (mut speed, mut water) = (1.0_f32, 1.0_f32);
    let (mut load, mut budget) = (0_i32, DROPLET_BUDGET);
    for _ in 0..kernel.max_steps {
        let downhill = 1.0 - kernel.inertia;
        for (direction, slope) in direction.iter_mut().zip(surface.slope) {
            *direction = *direction * kernel.inertia - slope * downhill;
        }
        let [dx, dz] = direction;
        let length = (dx * dx + dz * dz).sqrt();
        if length < LEAST_SLOPE {
            break;
        }
        let inverse = 1.0 / length;
        direction = [dx * inverse, dz * inverse];
        let next = spot.moved(direction);
        if !next.is_within(bounds) {
            break;
        }
        let next_surface = ground.at(&next);
        let rise = next_surface.height - surface.height;
        let capacity = ((kernel.capacity * larger(-rise, kernel.min_drop_m)) * speed) * water;
        let load_m = load as f32 * UNIT_M;
        if rise > 0.0 || load_m > capacity {
            let laid_m =
                if rise > 0.0 { smaller(rise, load_m) } else { (load_m - capacity) * kernel.deposition };
            let laid = ((laid_m * UNITS) as i32).min(load);
            if laid > 0 {
                lay_around(&spot, laid, &mut change);
                load -= laid;
            }
        } else {
            let taken_m = smaller((capacity - load_m) * kernel.erosion, -rise);
            let taken = larger(smaller(taken_m * UNITS, budget as f32), 0.0);
            let taken = move_disc(&spot, -taken, bounds, kernel, &mut change);
            load -= taken;
            budget += taken;
        }
        speed = larger(speed * speed - kernel.gravity * rise, 0.0).sqrt();
        water *= kernel.staying;
        (spot, surface) = (next, next_surface);
    }
    if load > 0 {
        let laid = move_disc(&spot, load as f32, bounds, kernel, &mut change);
        // What rounding and the border have left.
        let [x, z] = spot.nearest();
        if laid != load {
            change(x, z, &[load - laid]);
        }
    }
}

impl Spot {
    #[inline(always)]
    fn first(index: u32, round: u32, bounds: &SampleRect, seed: u32) -> Self {
        let first = hash(index, round, seed);
        let second = hash(index, round, first);
        let mut spot = Self { cell: [0; 2], fraction: [0.0; 2] };
        let lengths = [(first, bounds.x0, bounds.width()), (second, bounds.z0, bounds.depth())];
        for ((cell, fraction), (bits, from, length)) in
            spot.cell.iter_mut().zip(&mut spot.fraction).zip(lengths)
        {
            // Between `length` samples there are `length - 1` cells.
            let place = bits_to_uniform(bits) * length.saturating_sub(1) as f32;
            let whole = smaller(place.trunc(), length.saturating_sub(2) as f32);
            *cell = from.wrapping_add(whole as i32);
            *fraction = place - whole;
        }
        spot
    }

    #[inline(always)]
    fn moved(&self, direction: [f32; 2]) -> Self {
        let mut moved = *self;
        for ((cell, fraction), step) in moved.cell.iter_mut().zip(&mut moved.fraction).zip(direction) {
            let place = *fraction + step;
            let whole = i32::from(place >= 1.0) - i32::from(place < 0.0);
            *cell = cell.wrapping_add(whole);
            *fraction = place - whole as f32;
        }
        moved
    }

    /// Whether all four samples around are.
    #[inline(always)]
    fn is_within(&self, bounds: &SampleRect) -> bool {
        let [x, z] = self.cell;
        x >= bounds.x0 && x < bounds.x1 - 1 && z >= bounds.z0 && z < bounds.z1 - 1
    }

    #[inline(always)]
    fn nearest(&self) -> [i32; 2] {
        let ([x, z], [u, v]) = (self.cell, self.fraction);
        [x + i32::from(u >= 0.5), z + i32::from(v >= 0.5)]
    }
}

/// Heights, to be read where no two reads lie in a row.
struct Ground<'a> {
    samples: &'a [f32],
    width: usize,
    x0: i32,
    z0: i32,
}

impl<'a> Ground<'a> {
    fn new(heights: &'a Plane) -> Self {
        let rect = heights.rect();
        Self { samples: heights.samples(), width: rect.width() as usize, x0: rect.x0, z0: rect.z0 }
    }

    #[inline(always)]
    fn at(&self, spot: &Spot) -> Surface {
        let ([x, z], [u, v]) = (spot.cell, spot.fraction);
        let first = (z.wrapping_sub(self.z0)) as usize * self.width + x.wrapping_sub(self.x0) as usize;
        let pair = |first: usize| match self.samples.get(first..first.wrapping_add(2)) {
            Some([west, east]) => [*west, *east],
            _ => [0.0; 2],
        };
        let ([nw, ne], [sw, se]) = (pair(first), pair(first.wrapping_add(self.width)));
        let (north, south) = (ne - nw, se - sw);
        let (west, east) = (sw - nw, se - ne);
        let slope_x = north + v * (south - north);
        // From one corner, so that a height far above sea level costs no precision before the last sum.
        let height = nw + (u * slope_x + v * west);
        Surface { height, slope: [slope_x, west + u * (east - west)] }
    }
}

/// Lays units down on the four samples around a spot.
#[inline(always)]
fn lay_around(spot: &Spot, units: i32, change: &mut impl FnMut(i32, i32, &[i32])) {
    let ([x, z], [u, v]) = (spot.cell, spot.fraction);
    let part = |share: f32| (units as f32 * share) as i32;
    let (ne, sw, se) = (part(u * (1.0 - v)), part((1.0 - u) * v), part(u * v));
    change(x, z, &[units - (ne + sw + se), ne]);
    change(x, z + 1, &[sw, se]);
}

/// Changes the samples of the disc around a spot by their shares of `units` and gives what that made in all. What
/// lies outside the region is left out.
#[inline(always)]
fn move_disc(
    spot: &Spot,
    units: f32,
    bounds: &SampleRect,
    kernel: &DropletKernel,
    change: &mut impl FnMut(i32, i32, &[i32]),
) -> i32 {
    let [x, z] = spot.nearest();
    let mut sums = [0; DISC_LANES];
    for part in &kernel.disc {
        let (x, z) = (x + part.dx, z + part.dz);
        let mut parts = [0; DISC_LANES];
        for (part, weight) in parts.iter_mut().zip(part.weights) {
            *part = rounded(units * weight);
        }
        let count = part.num_samples as i32;
        if z < bounds.z0 || z >= bounds.z1 {
            continue;
        }
        if x < bounds.x0 || x + DISC_LANES as i32 > bounds.x1 {
            for (x, part) in (x..).zip(&mut parts) {
                *part = if x >= bounds.x0 && x < bounds.x1 { *part } else { 0 };
            }
            let first = (bounds.x0 - x).clamp(0, count);
            let end = (bounds.x1 - x).clamp(first, count);
            if let Some(parts @ [_, ..]) = parts.get(first as usize..end as usize) {
                change(x + first, z, parts);
            }
        } else {
            // With the zeros at its end: parts of one length are added at once.
            change(x, z, &parts);
        }
        for (sum, part) in sums.iter_mut().zip(parts) {
            *sum += part;
        }
    }
    sums.iter().sum()
}

/// The nearest integer, the even one of two; for magnitudes below 2^22. Adding 1.5 · 2^23 leaves it in the last bits, which unlike
/// a conversion vectorises.
#[inline(always)]
fn rounded(value: f32) -> i32 {
    const SHIFT: f32 = 12_582_912.0;
    (value + SHIFT).to_bits().cast_signed().wrapping_sub(SHIFT.to_bits().cast_signed())
}

/// Applies a round's changes to a row of heights, and leaves in them what the heights are too coarse for: added in the next
/// round, so that of many small changes none is lost.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn settle_row(heights: &mut [f32], changes: &mut [i32]) {
    for (height, change) in heights.iter_mut().zip(changes) {
        let new = sanitized_height(*height + *change as f32 * UNIT_M);
        // Whole metres first: neither part is too large to be rounded fast, and both are exact.
        let taken_m = new - *height;
        let metres = rounded(taken_m);
        *change -= metres * UNITS as i32 + rounded((taken_m - metres as f32) * UNITS);
        *height = new;
    }
}

/// Adds what a droplet changes side by side.
#[inline(always)]
pub fn add(sums: &mut [i32], units: &[i32]) {
    if let Some(sums) = sums.first_chunk_mut::<DISC_LANES>()
        && let Ok(units) = <&[i32; DISC_LANES]>::try_from(units)
    {
        for (sum, units) in sums.iter_mut().zip(units) {
            *sum += units;
        }
        return;
    }
    for (sum, units) in sums.iter_mut().zip(units) {
        *sum += units;
    }
}

/// Runs rounds of droplets over a plane, one after the other: `num_droplets` in all, from round `first_round` on.
pub fn run(heights: &mut Plane, kernel: &DropletKernel, num_droplets: u32, first_round: u32) {
    run_while(heights, kernel, num_droplets, first_round, |_| true);
}

/// The same with a look before each round at whether to go on, given the share of the droplets that have run; whether all of them
/// have.
pub fn run_while(
    heights: &mut Plane,
    kernel: &DropletKernel,
    num_droplets: u32,
    first_round: u32,
    mut goes_on: impl FnMut(f64) -> bool,
) -> bool {
    let bounds = heights.rect();
    let width = bounds.width() as usize;
    let mut changes = vec![0_i32; heights.samples().len()];
    let per_round = DropletKernel::droplets_per_round(bounds.area());
    let (mut left, mut round) = (num_droplets, first_round);
    while left > 0 {
        if !goes_on(1.0 - f64::from(left) / f64::from(num_droplets)) {
            return false;
        }
        let count = left.min(per_round);
        for index in 0..count {
            trace(index, round, heights, &bounds, kernel, |x, z, units| {
                let place = z.wrapping_sub(bounds.z0) as usize * width + x.wrapping_sub(bounds.x0) as usize;
                add(changes.get_mut(place..).unwrap_or_default(), units);
            });
        }
        settle_row(heights.samples_mut(), &mut changes);
        (left, round) = (left - count, round.wrapping_add(1));
    }
    true
}
