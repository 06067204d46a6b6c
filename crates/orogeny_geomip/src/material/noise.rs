//! The noise of a layer: it breaks up borders and makes patches.

use glam::{Vec2, vec2};
use orogeny_field::hash::hash;

/// So that the values of three octaves spread over -1..1: found by trial, and tested.
const SCALE: f32 = 4.6;

/// The noise of a layer at a place, -1..1, spread over that range about evenly: the share of ground above `1 - 2 c` is about `c`.
///
/// `x` and `z` are in features: metres times [`LayerRule::noise`](super::LayerRule)`[0]`. Three octaves of gradient noise: of 0.4, 1 and 2.5 times the
/// frequency, of weights 3, 4 and 2, of the seeds `seed`, `seed + 1` and `seed + 2` (wrapping). Their weighted mean `s` becomes `t (1.5 - 0.5 t²)`
/// of `t = clamp(4.6 s, -1, 1)`. A lattice point `(i, j)` (integers, wrapping to 32 bits) has the gradient
/// `(low 16 bits, high 16 bits)` of [`hash`]`(i, j, seed)`, each `/ 32767.5 - 1`; between points the fade is `f³ (f (6 f - 15) + 10)`.
#[must_use]
pub fn layer_noise(x: f32, z: f32, seed: u32) -> f32 {
    let place = vec2(x, z);
    // Larger ones too: patches of one size only look like a leopard's.
    let sum = 3.0 * gradient_noise(0.4 * place, seed)
        + 4.0 * gradient_noise(place, seed.wrapping_add(1))
        + 2.0 * gradient_noise(2.5 * place, seed.wrapping_add(2));
    let t = (SCALE / 9.0 * sum).clamp(-1.0, 1.0);
    t * (1.5 - 0.5 * t * t)
}

fn gradient_noise(place: Vec2, seed: u32) -> f32 {
    let cell = place.floor();
    let within = place - cell;
    let (x, z) = (cell.x as i32 as u32, cell.y as i32 as u32);
    let at = |right: u32, down: u32| {
        let bits = hash(x.wrapping_add(right), z.wrapping_add(down), seed);
        let gradient = vec2((bits & 0xffff) as f32, (bits >> 16) as f32) * (1.0 / 32767.5) - 1.0;
        gradient.dot(within - vec2(right as f32, down as f32))
    };
    let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let top = at(0, 0) + fade.x * (at(1, 0) - at(0, 0));
    let bottom = at(0, 1) + fade.x * (at(1, 1) - at(0, 1));
    top + fade.y * (bottom - top)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_spread_about_evenly() {
        let values: Vec<f32> =
            (0..40_000).map(|k| layer_noise((k % 200) as f32 * 0.713, (k / 200) as f32 * 0.713, 5)).collect();
        for coverage in [0.1_f32, 0.25, 0.5, 0.75, 0.9] {
            let above =
                values.iter().filter(|value| **value > 1.0 - 2.0 * coverage).count() as f32 / 40_000.0;
            assert!((above - coverage).abs() < 0.06, "{coverage}: {above}");
        }
    }

    #[test]
    fn it_is_continuous_over_cells_and_the_origin() {
        for step in -300..300 {
            let x = step as f32 * 0.01;
            assert!((layer_noise(x, 0.37, 1) - layer_noise(x + 0.001, 0.37, 1)).abs() < 0.04, "{x}");
        }
    }
}
