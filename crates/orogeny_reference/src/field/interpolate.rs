//! A coarse grid turned into one `factor` times as fine, along one axis: the steps up a pyramid, and B-splines over a lattice.
//!
//! Value `x` lies at `i + t` between the coarse samples `i = ⌊x / factor⌋` and `i + 1` and is `b + w0 (a − b) + w2 (c − b) + w3 (d − b)`
//! of the samples `a b c d` from `i − 1` on, with the weights of its phase `x mod factor`. They sum to 1 with that of `b`.

use multiversion::multiversion;
use orogeny_field::PhaseWeights;

/// Coarse samples whose values are worked out at once.
const LANES: usize = 64;

/// One row, along x. Its first value is `first_phase` (below the number of phases) after a coarse sample, the second one of
/// `source`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row_along_x(target: &mut [f32], source: &[f32], phases: &[PhaseWeights], first_phase: usize) {
    if let ([even, odd], 0) = (phases, first_phase) {
        return twice(target, source, even, odd);
    }
    let mut around = source.windows(4);
    let mut target = target.iter_mut();
    let mut skipped = first_phase;
    while let Some([a, b, c, d]) = around.next() {
        for weights in phases.iter().skip(skipped) {
            let Some(target) = target.next() else { return };
            *target = value(*a, *b, *c, *d, weights);
        }
        skipped = 0;
    }
}

/// As [`row_along_x`] with two phases: each is a row of its own, then both are put together.
#[inline(always)]
fn twice(target: &mut [f32], source: &[f32], even: &PhaseWeights, odd: &PhaseWeights) {
    let mut values = [[0.0; 2]; LANES];
    for (target, source) in
        target.chunks_mut(2 * LANES).zip((0..).step_by(LANES).map_while(|first| source.get(first..)))
    {
        let part = |place: usize| source.get(place..).unwrap_or_default();
        let around = part(0).iter().zip(part(1)).zip(part(2).iter().zip(part(3)));
        for (values, ((a, b), (c, d))) in values.iter_mut().zip(around) {
            *values = [value(*a, *b, *c, *d, even), value(*a, *b, *c, *d, odd)];
        }
        for (target, value) in target.iter_mut().zip(values.as_flattened()) {
            *target = *value;
        }
    }
}

/// One row, along z, of a phase, from the four coarse rows around it, the northernmost first.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row_along_z(target: &mut [f32], rows: [&[f32]; 4], weights: &PhaseWeights) {
    let [north, above, below, south] = rows;
    let around = north.iter().zip(above).zip(below.iter().zip(south));
    for (target, ((a, b), (c, d))) in target.iter_mut().zip(around) {
        *target = value(*a, *b, *c, *d, weights);
    }
}

#[inline(always)]
fn value(a: f32, b: f32, c: f32, d: f32, weights: &PhaseWeights) -> f32 {
    b + weights.before * (a - b) + weights.next * (c - b) + weights.after_next * (d - b)
}
