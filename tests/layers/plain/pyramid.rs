//! A Laplacian blend as Burt and Adelson have it (1983): the pyramids of both grounds, the Gaussian one of the weights, blended level by
//! level and summed up again.

use orogeny_field::LAYER_PYRAMID_LEVELS;

use super::Sheet;
use super::sheet::ulps;

/// Samples by which the mirrored terrain goes on, so that where that ends is not seen: a multiple of the coarsest level's, for its
/// samples to lie on those of the terrain.
const MARGIN: i32 = 5 << LAYER_PYRAMID_LEVELS;

/// `below` and `heights`, as `weights` say.
pub fn blended(below: &Sheet, heights: &Sheet, weights: &Sheet) -> Sheet {
    let [c, h, w] = [below, heights, weights].map(extended);
    let (c, h, w) = (laplacian(&c), laplacian(&h), gaussian(&w));
    let mut bands =
        c.iter().zip(&h).zip(&w).map(|((c, h), w)| c.zip3(h, w, |c, h, w| (1.0 - w) * c + w * h)).rev();
    let coarsest = bands.next().unwrap();
    let sum = bands
        .fold(coarsest, |coarser, band| band.zip(&expanded(&coarser, band.width, band.depth), |a, b| a + b));
    // Weights that are off take as much too much or too little of what both grounds differ by on each level.
    let apart: f64 = c.iter().zip(&h).map(|(c, h)| c.zip(h, |c, h| h - c).largest()).sum();
    // Each band is at most two of what it is made of, and there is one more than levels.
    let num_bands = 2.0 * f64::from(LAYER_PYRAMID_LEVELS + 1);
    let off =
        below.off * (1.0 + num_bands) + num_bands * heights.off + apart * (weights.off + ulps(2.0, 1.0));
    Sheet::from_fn(below.width, below.depth, |x, z| sum.at(x + MARGIN, z + MARGIN)).off_by(off)
}

fn extended(sheet: &Sheet) -> Sheet {
    let wide = |samples: usize| samples + 2 * MARGIN as usize;
    Sheet::from_fn(wide(sheet.width), wide(sheet.depth), |x, z| sheet.mirrored(x - MARGIN, z - MARGIN))
}

/// From the finest level.
fn gaussian(sheet: &Sheet) -> Vec<Sheet> {
    let mut levels = vec![sheet.clone()];
    for _ in 0..LAYER_PYRAMID_LEVELS {
        levels.push(reduced(levels.last().unwrap()));
    }
    levels
}

fn laplacian(sheet: &Sheet) -> Vec<Sheet> {
    let levels = gaussian(sheet);
    let difference =
        |pair: &[Sheet]| pair[0].zip(&expanded(&pair[1], pair[0].width, pair[0].depth), |a, b| a - b);
    let mut bands: Vec<Sheet> = levels.windows(2).map(difference).collect();
    bands.push(levels.last().unwrap().clone());
    bands
}

const KERNEL: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

fn reduced(sheet: &Sheet) -> Sheet {
    let (width, depth) = (sheet.width.div_ceil(2), sheet.depth.div_ceil(2));
    let narrow = Sheet::from_fn(width, sheet.depth, |x, z| {
        (-2..).zip(KERNEL).map(|(away, weight)| weight * clamped(sheet, 2 * x + away, z)).sum()
    });
    Sheet::from_fn(width, depth, |x, z| {
        (-2..).zip(KERNEL).map(|(away, weight)| weight * clamped(&narrow, x, 2 * z + away)).sum()
    })
}

/// Zeros between the samples, the same kernel, and twice as much along each axis.
fn expanded(sheet: &Sheet, width: usize, depth: usize) -> Sheet {
    let spread = |place: i32, value: &dyn Fn(i32) -> f64| -> f64 {
        let of_kernel = (-2..).zip(KERNEL).filter(|(away, _)| (place + away) % 2 == 0);
        of_kernel.map(|(away, weight)| 2.0 * weight * value((place + away) / 2)).sum()
    };
    let wide = Sheet::from_fn(width, sheet.depth, |x, z| spread(x, &|x| clamped(sheet, x, z)));
    Sheet::from_fn(width, depth, |x, z| spread(z, &|z| clamped(&wide, x, z)))
}

/// Beyond the margin it does not matter what there is.
fn clamped(sheet: &Sheet, x: i32, z: i32) -> f64 {
    sheet.at(x.clamp(0, sheet.width as i32 - 1), z.clamp(0, sheet.depth as i32 - 1))
}

#[test]
fn a_pyramid_comes_to_what_it_was_made_of() {
    let sheet = |seed: i32| Sheet::from_fn(61, 45, |x, z| f64::from((x * 37 + z * 11 + seed) % 19));
    let (a, b) = (sheet(0), sheet(5));
    let weight = |value| Sheet::constant(61, 45, value);
    for (weight, expected) in [(weight(0.0), &a), (weight(1.0), &b)] {
        let blended = blended(&a, &b, &weight);
        assert!(blended.zip(expected, |a, b| a - b).largest() < 1.0e-9);
    }
    // Half of both is the mean of both.
    let half = blended(&a, &b, &weight(0.5));
    assert!(half.zip(&a.zip(&b, |a, b| 0.5 * (a + b)), |a, b| a - b).largest() < 1.0e-9);
}
