//! Snow and ice.

use glam::vec2;

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{cells, fbm, fbm_stretched, ridges, smooth, warped};
use crate::material::surface::stamp::random;

pub(super) fn snow(canvas: &Canvas) -> Vec<Texel> {
    let whites = [0xdfe6f0, 0xeef2f7, 0xf8f9fb].map(hex);
    canvas.texels(|place, index| {
        let led = warped(place, 3, 4, 0.06, canvas.seed(1));
        // Low drifts that the wind drew out, with a crust that it bit into.
        let drift = fbm_stretched(led, [3, 6], 5, canvas.seed(2));
        let bite = ridges(vec2(led.x, led.y), 6, 4, canvas.seed(3));
        let carved = smooth(0.45, 0.75, 0.5 + 0.6 * fbm(place, 4, 3, canvas.seed(4)));
        let fine = fbm(place, 64, 3, canvas.seed(5));
        let grain = random(index as u32, canvas.seed(6));
        let height = 0.55 * drift + 0.2 * carved * bite + 0.03 * fine + 0.014 * grain;
        let tone = 0.6 + 0.22 * drift + 0.12 * fine + 0.14 * carved * (bite - 0.5);
        let glint = if grain > 0.992 { 0.3 } else { 0.0 };
        Texel {
            height,
            colour: ramp(&whites, tone) * (0.97 + 0.05 * grain),
            roughness: 0.72 + 0.08 * fine - glint + 0.05 * (1.0 - carved),
        }
    })
}

pub(super) fn ice(canvas: &Canvas) -> Vec<Texel> {
    let blues = [0x7fa9bf, 0xa5c6d4, 0xc6dce4, 0xe4eef0].map(hex);
    let white = hex(0xf2f6f7);
    canvas.texels(|place, _| {
        let led = warped(place, 5, 3, 0.03, canvas.seed(1));
        let broad = fbm(led, 3, 4, canvas.seed(2));
        let fine = fbm(place, 52, 3, canvas.seed(3));
        // Cracks of three depths: the deeper, the fainter.
        let crack = |period: u32, width: f32, seed: u32| {
            let border = cells(led, [period, period], canvas.seed(seed)).border();
            let open = smooth(-0.2, 0.5, fbm(place, 6, 2, canvas.seed(seed + 20)));
            (1.0 - smooth(0.0, width, border)) * open
        };
        let (wide, middle, thin) = (crack(4, 0.018, 4), crack(9, 0.025, 5), crack(19, 0.035, 6));
        let cloud = smooth(0.4, 0.85, ridges(led, 4, 4, canvas.seed(7)));
        let bubbles = cells(place, [58, 58], canvas.seed(8));
        let bubble = smooth(0.22, 0.1, bubbles.nearest) * smooth(0.55, 0.7, bubbles.random(1));
        let frost = smooth(0.5, 0.8, 0.5 + 0.5 * fbm(place, 5, 5, canvas.seed(9)) + 0.1 * fine);
        let tone = 0.42 + 0.26 * broad + 0.08 * fine + 0.2 * cloud;
        let pale = (0.75 * wide + 0.45 * middle + 0.25 * thin + 0.3 * bubble + 0.65 * frost).min(1.0);
        Texel {
            height: 0.35 * broad + 0.06 * fine - 0.4 * wide - 0.16 * middle - 0.05 * thin + 0.22 * frost,
            colour: ramp(&blues, tone).lerp(white, 0.8 * pale),
            roughness: 0.16 + 0.42 * frost + 0.2 * wide.max(middle) + 0.04 * fine,
        }
    })
}
