//! Grass, blade by blade.

use glam::{Vec2, Vec3, vec2};

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{fbm, smooth};
use crate::material::surface::stamp::{Hit, Stamp, random, strew};

/// Blades a tile.
const BLADES: u32 = 24_000;
/// A blade's bits say what it is by this seed.
const KIND: u32 = 9;

/// What a lawn is made of.
struct Lawn {
    /// Half the length of a blade, in tiles: least and most.
    half_length: [f32; 2],
    half_width: f32,
    /// The share of dry blades, where they are few and where they are many.
    dry: [f32; 2],
    greens: [Vec3; 4],
    straws: [Vec3; 3],
}

pub(super) fn grass(canvas: &Canvas) -> Vec<Texel> {
    let lawn = Lawn {
        half_length: [0.012, 0.026],
        half_width: 0.0021,
        dry: [0.01, 0.10],
        greens: [0x3a4a20, 0x54642c, 0x6c7a38, 0x8d954f].map(hex),
        straws: [0x968c58, 0xb0a46e, 0x756c42].map(hex),
    };
    lawn.texels(canvas, &lawn.blades(canvas))
}

pub(super) fn meadow(canvas: &Canvas) -> Vec<Texel> {
    let lawn = Lawn {
        half_length: [0.010, 0.030],
        half_width: 0.0018,
        dry: [0.08, 0.42],
        greens: [0x3d5424, 0x566b2e, 0x6f7d3a, 0x8c9450].map(hex),
        straws: [0x958a55, 0xb5a672, 0x7c7044].map(hex),
    };
    let mut texels = lawn.texels(canvas, &lawn.blades(canvas));
    let top = texels.iter().map(|texel| texel.height).fold(f32::MIN, f32::max);
    for (texel, flower) in texels.iter_mut().zip(flowers(canvas)) {
        if flower.is_any() {
            let colours = [0xf2efe6, 0xe6c93a, 0xa48ac4, 0xf2efe6].map(hex);
            let radius = flower.on.length();
            let heart = hex(0xc9a02c);
            texel.colour = if radius < 0.3 { heart } else { ramp(&colours, random(flower.id, KIND)) };
            texel.colour *= 0.75 + 0.35 * radius;
            texel.height = top + 0.1 * flower.height;
            texel.roughness = 0.75;
        }
    }
    texels
}

/// Flowers in groups, most of the tile without any.
fn flowers(canvas: &Canvas) -> Vec<Hit> {
    let stamps: Vec<Stamp> = (0..900)
        .map(|number| Stamp::strewn(number, canvas.seed(20)))
        .filter(|stamp| {
            let group = 0.5 + 0.9 * fbm(stamp.place, 4, 3, canvas.seed(21));
            random(stamp.id, 3) < 0.55 * smooth(0.45, 0.85, group)
        })
        .map(|stamp| {
            let radius = 0.003 + 0.0035 * random(stamp.id, 4);
            Stamp { half: Vec2::splat(radius), base: random(stamp.id, 5), ..stamp }
        })
        .collect();
    strew(canvas, &stamps, |_, on| {
        let radius = on.length();
        // Five petals.
        let petals = 0.78 + 0.22 * (5.0 * on.y.atan2(on.x)).cos();
        (radius < petals).then_some(1.0 - 0.4 * radius)
    })
}

impl Lawn {
    fn blades(&self, canvas: &Canvas) -> Vec<Hit> {
        let [short, long] = self.half_length;
        let blade = |number| {
            let stamp = Stamp::strewn(number, canvas.seed(1));
            // Blades of a tuft lean the same way, more or less.
            let lean = 5.0 * fbm(stamp.place, 5, 2, canvas.seed(2)) + 2.2 * (random(stamp.id, 3) - 0.5);
            let tall = 0.5 + 0.5 * fbm(stamp.place, 9, 3, canvas.seed(3));
            let length = short + (long - short) * random(stamp.id, 4) * (0.5 + 0.5 * tall);
            Stamp {
                along: Vec2::from_angle(lean + if random(stamp.id, 6) < 0.3 { 2.1 } else { 0.0 }),
                half: vec2(length, self.half_width * (0.7 + 0.6 * random(stamp.id, 5)) * 1.8),
                base: 0.8 * random(stamp.id, 7) + 0.6 * tall,
                ..stamp
            }
        };
        let stamps: Vec<Stamp> = (0..BLADES).map(blade).collect();
        strew(canvas, &stamps, |stamp, on| {
            let way = 0.5 + 0.5 * on.x;
            // Bent to one side, and pointed.
            let bend = (random(stamp.id, 8) - 0.5) * 1.1;
            let across = (on.y - bend * (way * way - 0.4)) / 0.5;
            let width = (1.0 - way * way * way).max(0.0);
            // It rises from the root, then bows.
            let height = 0.9 * way * (1.5 - 0.6 * way) - 0.18 * across * across;
            (across.abs() <= width.max(0.15)).then_some(height)
        })
    }

    fn texels(&self, canvas: &Canvas, blades: &[Hit]) -> Vec<Texel> {
        let ground = hex(0x2a2a16);
        canvas.texels(|place, index| {
            let blade = blades.get(index).filter(|blade| blade.is_any());
            let Some(blade) = blade else {
                return Texel { height: 0.0, colour: ground, roughness: 0.95 };
            };
            let clump = 0.5 + 0.5 * fbm(place, 7, 4, canvas.seed(10));
            let [few, many] = self.dry;
            let dry = few + (many - few) * smooth(0.35, 0.85, 0.5 + 0.55 * fbm(place, 4, 4, canvas.seed(11)));
            let way = 0.5 + 0.5 * blade.on.x;
            let tone = 0.65 * random(blade.id, KIND + 1) + 0.45 * (clump - 0.3);
            let green = ramp(&self.greens, 0.75 * tone + 0.25 * way);
            let straw = ramp(&self.straws, random(blade.id, KIND + 2));
            let is_dry = random(blade.id, KIND) < dry;
            let colour = if is_dry { straw } else { green.lerp(straw, 0.25 * dry) };
            // The root is in the others' shade; so is what lies deep.
            let light = (0.5 + 0.6 * way) * (0.55 + 0.3 * blade.height.clamp(0.0, 2.0));
            Texel { height: blade.height, colour: colour * light, roughness: 0.82 - 0.12 * way }
        })
    }
}
