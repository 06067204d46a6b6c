//! Loose stones: rounded by water, or broken off.

use glam::{Vec2, Vec3, vec2};

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{fbm, ridges, smooth};
use crate::material::surface::stamp::{Hit, Stamp, random, strew};

pub(super) fn gravel(canvas: &Canvas) -> Vec<Texel> {
    // Many small ones, few large ones: half as large, four times as many, less some.
    let stamps =
        sizes(canvas, &[(0.042, 40), (0.028, 170), (0.018, 620), (0.011, 2_000), (0.0065, 5_000)], 0.62);
    let hits = strew(canvas, &stamps, |stamp, on| {
        let power = 2.0 + 0.9 * random(stamp.id, 9);
        // Egg-shaped, and a little bent.
        let on = vec2(on.x, on.y + 0.22 * (random(stamp.id, 10) - 0.5) * (1.0 - 2.0 * on.x * on.x));
        let on = on * vec2(1.0, 1.08 + 0.3 * (random(stamp.id, 11) - 0.5) * on.x);
        let radius = on.x.abs().powf(power) + on.y.abs().powf(power);
        (radius < 1.0).then(|| stamp.half.y * 1.4 * (1.0 - radius).sqrt())
    });
    let stones = [0x6b6660, 0x8d877c, 0xa69b8a, 0xb9a98f, 0x7f7468, 0x97877a, 0xaea798, 0x5c5a58].map(hex);
    stones_over_sand(canvas, &hits, &stones, &[0x4b4236, 0x7d705c, 0x9a8c74].map(hex), 0.0)
}

pub(super) fn scree(canvas: &Canvas) -> Vec<Texel> {
    let stamps = sizes(
        canvas,
        &[(0.085, 16), (0.055, 60), (0.034, 230), (0.020, 800), (0.011, 2_400), (0.006, 3_600)],
        0.75,
    );
    let hits = strew(canvas, &stamps, broken);
    let stones = [0x5f5e5c, 0x7d7b76, 0x908c84, 0x86807a, 0xa39d92, 0x74706b, 0x94897a].map(hex);
    stones_over_sand(canvas, &hits, &stones, &[0x45413b, 0x6d675d, 0x8b8376].map(hex), 1.0)
}

/// Stones of sizes, each with how many there are.
fn sizes(canvas: &Canvas, sizes: &[(f32, u32)], flatness: f32) -> Vec<Stamp> {
    let of_size = |(which, &(size, count)): (usize, &(f32, u32))| {
        let seed = canvas.seed(100 + which as u32);
        (0..count).map(move |number| {
            let stamp = Stamp::strewn(number, seed);
            let length = size * (0.72 + 0.56 * random(stamp.id, 3));
            let half = vec2(length, length * (flatness + (1.0 - flatness) * random(stamp.id, 4)));
            // Large stones lie deeper: what is among them stays in sight.
            let base = 0.012 * random(stamp.id, 5) - 0.35 * size;
            Stamp { half, base, ..stamp }
        })
    };
    sizes.iter().enumerate().flat_map(of_size).collect()
}

/// The height of a stone that planes bound: sides with random faces, a top that is tilted.
fn broken(stamp: &Stamp, on: Vec2) -> Option<f32> {
    const SIDES: u32 = 7;
    if on.length_squared() > 1.0 {
        return None;
    }
    let tilt = vec2(random(stamp.id, 20) - 0.5, random(stamp.id, 21) - 0.5) * 0.9;
    // Within the circle that bounds it.
    let mut height = (0.62 + tilt.dot(on)).min(6.0 * (1.0 - on.length()));
    let second = vec2(random(stamp.id, 22) - 0.5, random(stamp.id, 23) - 0.5) * 1.7;
    height = height.min(0.75 + second.dot(on));
    for side in 0..SIDES {
        let turn =
            (side as f32 + 0.75 * random(stamp.id, 30 + side)) * (std::f32::consts::TAU / SIDES as f32);
        let reach = 0.55 + 0.36 * random(stamp.id, 40 + side);
        let steep = 1.2 + 3.5 * random(stamp.id, 50 + side);
        height = height.min(steep * (reach - Vec2::from_angle(turn).dot(on)));
    }
    (height > 0.0).then_some(height * stamp.half.y * 1.3)
}

/// Stones with ground between them. `broken` 1 roughens their faces, 0 leaves them smooth.
fn stones_over_sand<const N: usize>(
    canvas: &Canvas,
    hits: &[Hit],
    stones: &[Vec3; N],
    sands: &[Vec3; 3],
    broken: f32,
) -> Vec<Texel> {
    canvas.texels(|place, index| {
        let fine = fbm(place, 64, 3, canvas.seed(1));
        let broad = fbm(place, 5, 4, canvas.seed(2));
        let ground = 0.006 * broad - 0.012;
        let sand = Texel {
            height: ground + 0.0022 * fine,
            colour: ramp(sands, 0.45 + 0.5 * fine + 0.2 * broad),
            roughness: 0.95,
        };
        let Some(stone) = hits.get(index).filter(|stone| stone.height > ground - 0.004) else { return sand };
        let tone = random(stone.id, 60);
        let own = ramp(stones, tone) * (0.78 + 0.4 * random(stone.id, 61));
        // Each stone has its own grain; some have veins.
        let shift = vec2(random(stone.id, 62), random(stone.id, 63));
        let grain = fbm(place + shift, 40, 3, canvas.seed(3));
        let vein = if random(stone.id, 64) < 0.3 {
            smooth(0.86, 0.97, ridges(place + shift, 9, 2, canvas.seed(4)))
        } else {
            0.0
        };
        let colour = own * (1.0 + 0.28 * grain + 0.12 * fine) + 0.12 * vein;
        let weathered = hex(0x8a8264).lerp(hex(0x6f6a58), tone);
        let stain = smooth(0.5, 0.8, 0.5 + 0.5 * fbm(place, 10, 4, canvas.seed(5)));
        // Low flanks are dusty: no line is drawn around a stone.
        let dust = 1.0 - smooth(0.0, 0.008, stone.height - ground);
        Texel {
            height: stone.height + broken * (0.0035 * grain + 0.001 * fine) + 0.0006 * fine,
            colour: colour.lerp(weathered, 0.25 * stain).lerp(sand.colour, 0.6 * dust),
            roughness: 0.68 + 0.18 * broken + 0.06 * grain,
        }
    })
}
