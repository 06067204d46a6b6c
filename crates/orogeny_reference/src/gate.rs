//! What a gate lets through at each sample of a row, 0..1: the product of its bands over slope, height, aspect and curvature of
//! the ground. Derivatives are central differences; curvature is `-(H_xx + H_zz) / 2`.

use multiversion::multiversion;
use orogeny_field::{AspectGate, Band, Bitmap, Gate};

use crate::store::lerp;

/// Three rows of heights, in metres, each with one sample more at either end than the row that is gated.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// The row to the north.
    pub north: &'a [f32],
    /// The row itself.
    pub here: &'a [f32],
    /// The row to the south.
    pub south: &'a [f32],
    /// Metres between samples.
    pub spacing_m: f64,
}

/// Samples of a row that are worked at once: what is known of them stays in the first-level cache.
const CHUNK: usize = 128;

/// Multiplies a row of weights by what a gate makes of the ground.
pub fn multiply_by_ground(weights: &mut [f32], gate: &Gate, ground: &Ground<'_>) {
    for (number, weights) in weights.chunks_mut(CHUNK).enumerate() {
        // With the samples at either end.
        let first = number * CHUNK;
        let part = first..first + weights.len() + 2;
        let rows = [ground.north, ground.here, ground.south].map(|row| row.get(part.clone()));
        let [Some(north), Some(here), Some(south)] = rows else { continue };
        multiply_chunk(weights, gate, &Ground { north, here, south, ..*ground });
    }
}

/// The same for at most [`CHUNK`] samples: band after band, each a loop that vectorises.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn multiply_chunk(weights: &mut [f32], gate: &Gate, ground: &Ground<'_>) {
    let Ground { north, here, south, spacing_m } = *ground;
    let num_samples = weights.len();
    let mut through = [1.0_f64; CHUNK];
    let Some(through) = through.get_mut(..num_samples) else { return };
    let across =
        || {
            part(here, num_samples, 2)
                .zip(part(here, num_samples, 0))
                .zip(part(south, num_samples, 1).zip(part(north, num_samples, 1)))
        };
    let per_m = 1.0 / (2.0 * spacing_m);
    let slopes = |((east, west), (south, north)): ((&f32, &f32), (&f32, &f32))| {
        let along = |after: f32, before: f32| (f64::from(after) - f64::from(before)) * per_m;
        [along(*east, *west), along(*south, *north)]
    };
    if let Some(band) = &gate.height_m {
        for (through, centre) in through.iter_mut().zip(part(here, num_samples, 1)) {
            *through *= within(f64::from(*centre), band);
        }
    }
    if let Some(band) = &gate.slope_deg {
        for (through, around) in through.iter_mut().zip(across()) {
            let [slope_x, slope_z] = slopes(around);
            let steepness = (slope_x * slope_x + slope_z * slope_z).sqrt();
            *through *= within(arctangent(steepness).to_degrees(), band);
        }
    }
    if let Some(aspect) = &gate.aspect {
        for (through, around) in through.iter_mut().zip(across()) {
            let [slope_x, slope_z] = slopes(around);
            *through *= facing([-slope_x, -slope_z], aspect);
        }
    }
    if let Some(band) = &gate.curvature_per_km {
        for ((through, centre), ((east, west), (south, north))) in
            through.iter_mut().zip(part(here, num_samples, 1)).zip(across())
        {
            let [west, centre, east] = [west, centre, east].map(|height| f64::from(*height));
            let (north, south) = (f64::from(*north), f64::from(*south));
            let bend = (west + east + north + south - 4.0 * centre) / (spacing_m * spacing_m);
            *through *= within(-500.0 * bend, band);
        }
    }
    for (weight, through) in weights.iter_mut().zip(through) {
        *weight *= *through as f32;
    }
}

/// So many samples of a row from one on.
#[inline(always)]
fn part(row: &[f32], num_samples: usize, first: usize) -> std::slice::Iter<'_, f32> {
    row.get(first..first + num_samples).unwrap_or_default().iter()
}

/// Multiplies a row of weights by what a band lets through of other values, such as a noise.
pub fn multiply_by_band(weights: &mut [f32], values: &[f32], band: &Band) {
    for (weight, value) in weights.iter_mut().zip(values) {
        *weight *= within(f64::from(*value), band) as f32;
    }
}

/// Multiplies a row of weights by a selection, 0..1.
pub fn multiply_by_selection(weights: &mut [f32], selection: &[f32]) {
    for (weight, selected) in weights.iter_mut().zip(selection) {
        *weight *= selected.clamp(0.0, 1.0);
    }
}

/// Multiplies a row of weights by a picture laid over the world, bilinear between the middles of its pixels: `x_at` says where each
/// of the row's samples lies in the picture, 0..1, and `z` where the row does.
pub fn multiply_by_image(weights: &mut [f32], bitmap: &Bitmap, x_at: impl Fn(usize) -> f64, z: f64) {
    let along = |share: f64, size: u32| {
        let place = share * f64::from(size) - 0.5;
        let pixel = place.floor();
        (pixel as i32, (place - pixel) as f32)
    };
    let (row, share_z) = along(z, bitmap.height());
    for (index, weight) in weights.iter_mut().enumerate() {
        let (column, share_x) = along(x_at(index), bitmap.width());
        let (right, below) = (column.saturating_add(1), row.saturating_add(1));
        let upper = lerp(bitmap.pixel(column, row), bitmap.pixel(right, row), share_x);
        let lower = lerp(bitmap.pixel(column, below), bitmap.pixel(right, below), share_x);
        *weight *= lerp(upper, lower, share_z).clamp(0.0, 1.0);
    }
}

/// Lets through what was not.
pub fn invert(weights: &mut [f32]) {
    for weight in weights {
        *weight = 1.0 - *weight;
    }
}

/// 1 within a band, 0 further than its feather outside, a smooth step between.
#[inline(always)]
#[must_use]
pub fn within(value: f64, band: &Band) -> f64 {
    let outside = (band.min - value).max(value - band.max).max(0.0);
    // Worked out whether it is asked for or not, which vectorises.
    let t = 1.0 - outside / band.feather;
    let step = t * t * (3.0 - 2.0 * t);
    if outside <= 0.0 {
        1.0
    } else if outside >= band.feather {
        0.0
    } else {
        step
    }
}

/// The angle in radians whose tangent is `tangent`, at least 0: a rational function of what is left by 45 or 90 degrees (Cephes), which
/// vectorises. Within 4 units in the last place; 0 is exact.
#[inline(always)]
fn arctangent(tangent: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    const ABOVE: [f64; 5] = [
        -8.750_608_600_031_904e-1,
        -1.615_753_718_733_365e1,
        -7.500_855_792_314_705e1,
        -1.228_866_684_490_136_2e2,
        -6.485_021_904_942_025e1,
    ];
    const BELOW: [f64; 6] = [
        1.0,
        2.485_846_490_142_306_3e1,
        1.650_270_098_316_988_5e2,
        4.328_810_604_912_903e2,
        4.853_903_996_359_137e2,
        1.945_506_571_482_614e2,
    ];
    let (is_steep, is_level) = (tangent > 2.414_213_562_373_095, tangent <= 0.66);
    let (angle, above, below) = match (is_steep, is_level) {
        (true, _) => (FRAC_PI_2, -1.0, tangent),
        (_, true) => (0.0, tangent, 1.0),
        _ => (FRAC_PI_4, tangent - 1.0, tangent + 1.0),
    };
    let rest = above / below;
    let squared = rest * rest;
    let of = |terms: &[f64]| terms.iter().fold(0.0, |sum, term| sum * squared + term);
    angle + (rest + rest * (squared * of(&ABOVE) / of(&BELOW)))
}

/// How far a way down the ground is one that an aspect lets through; level ground faces nowhere.
fn facing([x, z]: [f64; 2], aspect: &AspectGate) -> f64 {
    if x.hypot(z) < 1.0e-9 {
        return 0.0;
    }
    let turned = (z.atan2(x).to_degrees() - aspect.angle_deg).rem_euclid(360.0);
    let off = turned.min(360.0 - turned);
    within(off, &Band { min: 0.0, max: aspect.width_deg, feather: aspect.feather_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a gate makes of a plane or paraboloid at its middle.
    fn through(gate: &Gate, height_m: impl Fn(f64, f64) -> f64) -> f32 {
        let row = |z: f64| [-1.0, 0.0, 1.0].map(|x| height_m(2.0 * x, 2.0 * z) as f32);
        let (north, here, south) = (row(-1.0), row(0.0), row(1.0));
        let ground = Ground { north: &north, here: &here, south: &south, spacing_m: 2.0 };
        let mut weights = [1.0];
        multiply_by_ground(&mut weights, gate, &ground);
        weights[0]
    }

    #[test]
    fn slope_aspect_and_curvature_are_those_of_known_surfaces() {
        let band = |min, max| Some(Band { min, max, feather: 0.0 });
        let rising_east = |x: f64, _: f64| x * 30.0_f64.to_radians().tan();
        for (min, max, expected) in [(29.9, 30.1, 1.0), (30.1, 40.0, 0.0), (0.0, 29.9, 0.0)] {
            assert_eq!(
                through(&Gate { slope_deg: band(min, max), ..Gate::default() }, rising_east),
                expected
            );
        }
        let facing = |angle_deg| Gate {
            aspect: Some(AspectGate { angle_deg, width_deg: 10.0, feather_deg: 0.0 }),
            ..Gate::default()
        };
        // It rises to the east, so it falls to the west.
        assert_eq!((through(&facing(180.0), rising_east), through(&facing(0.0), rising_east)), (1.0, 0.0));
        assert_eq!(through(&facing(-180.0), rising_east), 1.0);
        assert_eq!(through(&facing(90.0), |_, z| -z), 1.0, "falls to the south");
        assert_eq!(through(&facing(90.0), |_, _| 7.0), 0.0, "level");
        // A dome of 250 m radius bends by 1/250 m = 4/km in each direction.
        let dome = |x: f64, z: f64| -(x * x + z * z) / 500.0;
        assert_eq!(through(&Gate { curvature_per_km: band(3.9, 4.1), ..Gate::default() }, dome), 1.0);
        assert_eq!(through(&Gate { curvature_per_km: band(-4.1, -3.9), ..Gate::default() }, dome), 0.0);
        assert_eq!(through(&Gate { height_m: band(-1.0, 1.0), ..Gate::default() }, dome), 1.0);
    }

    #[test]
    fn a_picture_lies_over_its_region_and_its_border_goes_on() {
        let bitmap = Bitmap::new(2, 2, vec![0.0, 1.0, 0.5, 0.5]).unwrap();
        let row = |z: f64| {
            let mut weights = [1.0; 5];
            multiply_by_image(&mut weights, &bitmap, |index| 0.25 * index as f64 - 0.25, z);
            weights
        };
        // Middles of pixels lie at a quarter and three quarters.
        assert_eq!(row(0.25), [0.0, 0.0, 0.0, 0.5, 1.0]);
        assert_eq!(row(0.75), [0.5; 5]);
        assert_eq!(row(-3.0), row(0.25));
    }

    #[test]
    fn arctangents_are_those_of_the_standard_library() {
        assert_eq!(arctangent(0.0), 0.0);
        for step in 0..40_000 {
            let tangent = (f64::from(step) * 1.0e-3 - 20.0).exp2();
            let (found, expected) = (arctangent(tangent), tangent.atan());
            assert!(
                (found - expected).abs() <= 4.0 * f64::EPSILON * expected,
                "{tangent}: {found}, {expected}"
            );
        }
        assert_eq!(arctangent(f64::INFINITY), std::f64::consts::FRAC_PI_2);
    }

    #[test]
    fn a_feather_is_a_smooth_step_outside_its_band() {
        let band = Band { min: 10.0, max: 20.0, feather: 4.0 };
        for (value, expected) in [(10.0, 1.0), (20.0, 1.0), (8.0, 0.5), (22.0, 0.5), (6.0, 0.0), (24.1, 0.0)]
        {
            assert_eq!(within(value, &band), expected, "{value}");
        }
    }
}
