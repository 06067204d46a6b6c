//! A symmetric filter along one axis, of every sample or of every `stride`-th one: Gaussians, and the steps down a pyramid.
//!
//! A value is `c + Σ w_t ((west_t − c) + (east_t − c))` about its centre `c`, nearest neighbours first. The weights sum to 1 with the
//! centre's, so this is the weighted mean; written so, a constant comes back bit for bit, heights far above sea level lose no
//! precision, and no value leaves the range of those that it is made of (their weights together are well below 1).

use multiversion::multiversion;

/// Values whose sums are kept in registers at once.
const LANES: usize = 64;
/// The widest filter whose every second value is worked out from even and odd samples apart.
const MAX_RADIUS_OF_TWO: usize = 16;

/// One row, along x. `weights` are those of the neighbours 1, 2, … away, the same on both sides; `source` begins as many
/// samples before the first value's centre, and has [`source_length`] samples.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row_along_x(target: &mut [f32], source: &[f32], weights: &[f32], stride: usize) {
    let radius = weights.len();
    if stride == 1 {
        // The same samples as rows that lie one further each.
        let shifted = |offset: usize| source.get(offset..).unwrap_or_default();
        let mut first = 0;
        for target in target.chunks_mut(LANES) {
            sum(target, weights, |place| shifted(first + place), radius);
            first += LANES;
        }
        return;
    }
    if stride == 2 && radius <= MAX_RADIUS_OF_TWO {
        return every_second(target, source, weights);
    }
    for (place, target) in target.iter_mut().enumerate() {
        let Some(around) = source.get(place * stride..place * stride + 2 * radius + 1) else { return };
        let centre = around.get(radius).copied().unwrap_or_default();
        let mut value = centre;
        let east = around.iter().skip(radius + 1);
        for ((weight, west), east) in weights.iter().zip(around.iter().take(radius).rev()).zip(east) {
            value += weight * ((west - centre) + (east - centre));
        }
        *target = value;
    }
}

/// As [`row_along_x`] with a stride of two: the even samples and the odd ones apart are rows of their own.
#[inline(always)]
fn every_second(target: &mut [f32], source: &[f32], weights: &[f32]) {
    let radius = weights.len();
    let (mut even, mut odd) = ([0.0; LANES + MAX_RADIUS_OF_TWO + 1], [0.0; LANES + MAX_RADIUS_OF_TWO + 1]);
    for (target, source) in
        target.chunks_mut(LANES).zip((0..).step_by(2 * LANES).map_while(|first| source.get(first..)))
    {
        let mut num_apart = 0;
        if let (Some(pairs), Some(even), Some(odd)) = (
            source.as_chunks().0.first_chunk(),
            even.first_chunk_mut::<LANES>(),
            odd.first_chunk_mut::<LANES>(),
        ) {
            take_apart(pairs, even, odd);
            num_apart = LANES;
        }
        let rest = source.chunks(2).zip(even.iter_mut().zip(&mut odd)).take(LANES + radius + 1);
        for (pair, (even, odd)) in rest.skip(num_apart) {
            (*even, *odd) =
                (pair.first().copied().unwrap_or_default(), pair.get(1).copied().unwrap_or_default());
        }
        let part = |place: usize| {
            let samples = if place.is_multiple_of(2) { &even } else { &odd };
            samples.get(place / 2..).unwrap_or_default()
        };
        sum(target, weights, part, radius);
    }
}

/// Written so that it becomes a few shuffles.
#[inline(always)]
fn take_apart(pairs: &[[f32; 2]; LANES], even: &mut [f32; LANES], odd: &mut [f32; LANES]) {
    for ((even, odd), [first, second]) in even.iter_mut().zip(odd).zip(pairs) {
        (*even, *odd) = (*first, *second);
    }
}

/// One row, along z, from `2 weights.len() + 1` rows around its own, the northernmost first.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row_along_z(target: &mut [f32], rows: &[&[f32]], weights: &[f32]) {
    let mut first = 0;
    for target in target.chunks_mut(LANES) {
        // A closure within this one would not be inlined, and the sums would leave their registers for its sake.
        let part = |place: usize| match rows.get(place) {
            Some(row) => row.get(first..).unwrap_or_default(),
            None => &[],
        };
        sum(target, weights, part, weights.len());
        first += LANES;
    }
}

/// How many samples a row of `num_values` values is made of.
#[must_use]
pub const fn source_length(num_values: usize, num_weights: usize, stride: usize) -> usize {
    if num_values == 0 { 0 } else { (num_values - 1) * stride + 2 * num_weights + 1 }
}

/// At most [`LANES`] values; `part(p)` are the samples `p - radius` away from theirs.
#[inline(always)]
fn sum<'a>(target: &mut [f32], weights: &[f32], part: impl Fn(usize) -> &'a [f32], radius: usize) {
    if let Ok(target) = <&mut [f32; LANES]>::try_from(&mut *target)
        && let Some(centre) = part(radius).first_chunk::<LANES>()
    {
        let mut value = *centre;
        for (place, weight) in weights.iter().enumerate() {
            let west = part(radius - 1 - place).first_chunk::<LANES>();
            let east = part(radius + 1 + place).first_chunk::<LANES>();
            let (Some(west), Some(east)) = (west, east) else { continue };
            for (((value, centre), west), east) in value.iter_mut().zip(centre).zip(west).zip(east) {
                *value += weight * ((west - centre) + (east - centre));
            }
        }
        *target = value;
        return;
    }
    // The last few of a row: the same sums, one by one.
    let one = |place: usize, lane: usize| part(place).get(lane).copied().unwrap_or_default();
    for (lane, target) in target.iter_mut().enumerate() {
        let centre = one(radius, lane);
        let mut value = centre;
        for (place, weight) in weights.iter().enumerate() {
            value += weight
                * ((one(radius - 1 - place, lane) - centre) + (one(radius + 1 + place, lane) - centre));
        }
        *target = value;
    }
}
