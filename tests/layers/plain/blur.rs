//! A Gaussian by its definition, cut at four standard deviations, over the mirrored plane.

use super::Sheet;

/// The widest Gaussian, in samples, that the engine works out directly; wider ones it takes down a pyramid.
const MAX_DIRECT: f64 = 4.0;
/// How far a Gaussian by a pyramid may be from one by its definition, of values 0..1 that have edges: half a thousandth was met, since a
/// step of a pyramid folds a little over.
const PYRAMID_OFF: f64 = 1.0e-3;

/// Blurred by a standard deviation of so many samples; of less than a quarter there is nothing to be seen.
pub fn blurred(sheet: &Sheet, sigma: f64) -> Sheet {
    if sigma < 0.25 {
        return sheet.clone();
    }
    let radius = (4.0 * sigma + 0.5).floor() as i32;
    let weights: Vec<f64> =
        (-radius..=radius).map(|away| (-0.5 * (f64::from(away) / sigma).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let along = |sheet: &Sheet, step: [i32; 2]| {
        Sheet::from_fn(sheet.width, sheet.depth, |x, z| {
            let value =
                |(away, weight): (i32, &f64)| weight * sheet.mirrored(x + step[0] * away, z + step[1] * away);
            (-radius..).zip(&weights).map(value).sum::<f64>() / sum
        })
    };
    let off = if sigma > MAX_DIRECT { PYRAMID_OFF } else { 1.0e-6 };
    along(&along(sheet, [1, 0]), [0, 1]).off_by(sheet.off + off)
}
