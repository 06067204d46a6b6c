//! Soil, mud and sand.

use glam::{Vec2, vec2};

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{cells, fbm, fbm_stretched, smooth, warped};
use crate::material::surface::stamp::{Stamp, random, strew};

pub(super) fn soil(canvas: &Canvas) -> Vec<Texel> {
    let crumb = |number| {
        let stamp = Stamp::strewn(number, canvas.seed(21));
        let size = 0.002 + 0.013 * random(stamp.id, 3).powi(5);
        let half = vec2(size, size * (0.65 + 0.35 * random(stamp.id, 4)));
        Stamp { half, base: -0.4 * size, ..stamp }
    };
    let crumbs: Vec<Stamp> = (0..9_000).map(crumb).collect();
    let hits = strew(canvas, &crumbs, |stamp, on| {
        // Between an ellipse and a box, cut off on one side.
        let (square, cut) = ((on * on).dot(on * on), on.x + 0.6 * (random(stamp.id, 9) - 0.5) * on.y);
        let radius = square.max(0.75 * cut + 0.35);
        (square < 1.0 && radius < 1.0).then(|| stamp.half.y * 1.4 * (1.0 - radius).sqrt())
    });
    let browns = [0x38291c, 0x533f2b, 0x6b543b, 0x85694b, 0x9c8263].map(hex);
    let greys = [0x665d53, 0x857968].map(hex);
    canvas.texels(|place, index| {
        let broad = fbm(place, 4, 6, canvas.seed(1));
        let fine = fbm(place, 60, 3, canvas.seed(2));
        let clods = cells(warped(place, 12, 3, 0.025, canvas.seed(3)), [16, 16], canvas.seed(4));
        let clod = smooth(0.0, 0.3, clods.border()) * (0.4 + 0.6 * clods.random(1));
        let ground = 0.014 * broad + 0.011 * clod + 0.0035 * fine;
        let tone = 0.42 + 0.22 * broad + 0.2 * fine + 0.12 * (clods.random(2) - 0.5);
        let mut texel = Texel { height: ground, colour: ramp(&browns, tone), roughness: 0.94 };
        if let Some(crumb) = hits.get(index).filter(|hit| hit.is_any() && hit.height > 0.0) {
            texel.height += crumb.height;
            let is_stone = random(crumb.id, 6) < 0.12;
            texel.colour = if is_stone {
                ramp(&greys, random(crumb.id, 7)) * (1.0 + 0.2 * fine)
            } else {
                ramp(&browns, tone + 0.35 * (random(crumb.id, 8) - 0.4))
            };
        }
        // Damp where it is low.
        let damp = smooth(0.2, -0.5, broad);
        texel.colour *= 1.0 - 0.22 * damp;
        texel.roughness -= 0.1 * damp;
        texel
    })
}

pub(super) fn cracked_earth(canvas: &Canvas) -> Vec<Texel> {
    let tans = [0x8c7355, 0xa98d69, 0xbda27c, 0xcdb592].map(hex);
    let deep = hex(0x3d2f22);
    canvas.texels(|place, _| {
        let fine = fbm(place, 60, 3, canvas.seed(1));
        let broad = fbm(place, 4, 5, canvas.seed(2));
        let led = warped(place, 14, 4, 0.014, canvas.seed(3));
        let large = cells(led, [6, 6], canvas.seed(14));
        let small = cells(led + Vec2::splat(0.31), [15, 15], canvas.seed(5));
        // Large cracks are wide, those within a plate thin and not everywhere.
        let width = 0.035 + 0.02 * fbm(place, 9, 2, canvas.seed(6));
        let wide = 1.0 - smooth(0.3 * width, 1.3 * width, large.border());
        let thin_width = 0.05 * smooth(-0.5, 0.5, fbm(place, 5, 2, canvas.seed(7)));
        let thin = 1.0 - smooth(0.2 * thin_width, thin_width + 0.02, small.border());
        let crack = wide.max(0.75 * thin * smooth(0.0, 0.03, thin_width));
        // Plates curl up at their rims.
        let curl = smooth(0.3, 0.04, large.border());
        let tone = 0.45
            + 0.25 * broad
            + 0.22 * fine
            + 0.18 * (large.random(1) - 0.5)
            + 0.2 * (small.random(1) - 0.5);
        let height =
            0.25 * curl + 0.08 * large.random(2) + 0.06 * small.random(2) + 0.1 * broad + 0.07 * fine;
        let colour = ramp(&tans, tone + 0.12 * curl);
        Texel {
            height: height - 1.1 * crack,
            colour: colour.lerp(deep, 0.9 * crack),
            roughness: 0.9 + 0.05 * fine,
        }
    })
}

pub(super) fn mud(canvas: &Canvas) -> Vec<Texel> {
    let browns = [0x2f2519, 0x443625, 0x5a4832, 0x715c42].map(hex);
    let water = hex(0x2b241b);
    canvas.texels(|place, _| {
        let led = warped(place, 6, 3, 0.03, canvas.seed(1));
        let broad = fbm(led, 5, 4, canvas.seed(2));
        // Dents of hooves and boots, with the rims that they pushed up.
        let dents = cells(led, [9, 9], canvas.seed(3));
        let depth = smooth(0.25, 0.75, dents.random(1));
        let dent = depth
            * (smooth(0.42, 0.2, dents.nearest)
                - 0.45 * smooth(0.2, 0.45, dents.nearest) * smooth(0.0, 0.16, dents.border()));
        let lumps = cells(warped(place, 14, 3, 0.03, canvas.seed(4)), [22, 22], canvas.seed(5));
        let lump = (1.0 - lumps.nearest * lumps.nearest).max(0.0);
        let fine = fbm(place, 48, 3, canvas.seed(6));
        let coarse = 0.5 * broad + 0.14 * lump - 0.42 * dent;
        let level = -0.18;
        let wet = smooth(level + 0.32, level, coarse);
        let height = coarse + (0.07 - 0.055 * wet) * fine;
        let puddle = smooth(level + 0.012, level - 0.012, height);
        let tone = 0.5 + 0.22 * broad + 0.22 * fine + 0.16 * (lumps.random(1) - 0.5);
        let colour = ramp(&browns, tone) * (1.0 - 0.38 * wet);
        Texel {
            // Water is level.
            height: height.max(level - 0.02 * puddle),
            colour: colour.lerp(water, 0.75 * puddle),
            roughness: (0.82 - 0.42 * wet) * (1.0 - puddle) + 0.08 * puddle + 0.04 * fine * (1.0 - puddle),
        }
    })
}

pub(super) fn sand(canvas: &Canvas) -> Vec<Texel> {
    let tans = [0xa9885d, 0xc2a274, 0xd3b88c, 0xe2cca6].map(hex);
    canvas.texels(|place, index| {
        let fine = fbm(place, 90, 2, canvas.seed(1));
        let broad = fbm(place, 3, 5, canvas.seed(2));
        // Crests run across, wander, and end where two run together.
        let wander = 0.05 * fbm_stretched(place, [2, 4], 2, canvas.seed(3))
            + 0.007 * fbm(place, 11, 2, canvas.seed(4));
        let wave = |crests: f32| {
            let phase = std::f32::consts::TAU * crests * (place.y + wander);
            // Steeper to the lee.
            0.5 + 0.5 * (phase + 0.55 * phase.sin()).sin()
        };
        let other = smooth(-0.12, 0.12, fbm(place, 3, 2, canvas.seed(7)));
        let ripple = wave(21.0) * (1.0 - other) + wave(23.0) * other;
        let strength = 0.45 + 0.55 * smooth(-0.6, 0.5, fbm(place, 5, 3, canvas.seed(5)));
        let speck = random(index as u32, canvas.seed(6));
        let colour = ramp(&tans, 0.45 + 0.16 * broad + 0.16 * fine + 0.16 * (ripple - 0.5) * strength);
        let grain = 0.86 + 0.28 * speck - if speck > 0.985 { 0.5 } else { 0.0 };
        Texel {
            height: 0.6 * ripple * strength + 0.25 * broad + 0.035 * fine + 0.03 * speck,
            colour: colour * grain,
            roughness: 0.88 + 0.05 * fine,
        }
    })
}
