//! What lies and grows under trees.

use glam::{Vec3, vec2};

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{cells, fbm, smooth, warped};
use crate::material::surface::stamp::{Hit, Stamp, random, strew};

const LEAVES: u32 = 5_200;
const TWIGS: u32 = 260;
const NEEDLES: u32 = 6_000;

pub(super) fn forest_floor(canvas: &Canvas) -> Vec<Texel> {
    let (leaves, twigs, needles) = (leaves(canvas), twigs(canvas), needles(canvas));
    let browns = [0x3f2d1c, 0x5d4226, 0x7a5a33, 0x94703f, 0x8a5a2c, 0xa98b58].map(hex);
    let (mosses, soils) = ([0x36471a, 0x556a26, 0x77893a].map(hex), [0x1e1811, 0x33281b, 0x4a3a28].map(hex));
    canvas.texels(|place, index| {
        let fine = fbm(place, 48, 3, canvas.seed(1));
        let bumps = fbm(place, 6, 5, canvas.seed(2));
        let ground = 0.5 * bumps;
        let mut texel = Texel {
            height: ground + 0.1 * fine,
            colour: ramp(&soils, 0.5 + 0.4 * fine + 0.3 * bumps),
            roughness: 0.95,
        };
        let wear = 1.0 + 0.22 * fine;
        if let Some(needle) = needles.get(index).filter(|hit| hit.is_any()) {
            texel.height += 0.12 + 0.1 * random(needle.id, 4);
            texel.colour = ramp(&browns, 0.25 + 0.55 * random(needle.id, 5)) * (0.8 * wear);
        }
        if let Some(leaf) = leaves.get(index).filter(|hit| hit.is_any()) {
            let vein = 1.0 - smooth(0.0, 0.12, leaf.on.y.abs());
            let side = smooth(0.03, 0.0, (leaf.on.y.abs() * 5.0 - leaf.on.x * 3.0).rem_euclid(1.0) - 0.9);
            let tone = random(leaf.id, 5);
            let colour = ramp(&browns, tone) * (0.75 + 0.5 * random(leaf.id, 6));
            texel.colour = colour * wear * (1.0 - 0.25 * vein + 0.04 * side);
            texel.height = texel.height.max(0.55 * ground + leaf.height);
            texel.roughness = 0.78 + 0.1 * tone;
        }
        // Moss grows over what has lain long.
        let moss = smooth(0.5, 0.85, 0.5 + 0.5 * fbm(place, 4, 5, canvas.seed(3)) + 0.08 * fine);
        if moss > 0.0 {
            let cushion = fbm(place, 24, 4, canvas.seed(4));
            texel.height += moss * (0.28 + 0.22 * cushion);
            texel.colour = texel.colour.lerp(ramp(&mosses, 0.5 + 0.6 * cushion), 0.65 * moss);
            texel.roughness += moss * (0.95 - texel.roughness);
        }
        if let Some(twig) = twigs.get(index).filter(|hit| hit.is_any()) {
            let bark = fbm(place, 60, 2, canvas.seed(5));
            texel.height = texel.height.max(0.5 * ground + twig.height);
            texel.colour =
                ramp(&[0x3a2d20, 0x5f4d38, 0x8a7a62].map(hex), 0.5 * random(twig.id, 5) + 0.4 * bark);
            texel.roughness = 0.85;
        }
        texel
    })
}

fn leaves(canvas: &Canvas) -> Vec<Hit> {
    let leaf = |number| {
        let stamp = Stamp::strewn(number, canvas.seed(11));
        let length = 0.011 + 0.016 * random(stamp.id, 3) * random(stamp.id, 9);
        let half = vec2(length, length * (0.38 + 0.25 * random(stamp.id, 4)));
        Stamp { half, base: 0.1 + 0.75 * random(stamp.id, 7), ..stamp }
    };
    let stamps: Vec<Stamp> = (0..LEAVES).map(leaf).collect();
    strew(canvas, &stamps, |stamp, on| {
        // Pointed at both ends, with a slightly ragged edge; curled up at the rim, tilted.
        let ragged = 0.06 * (17.0 * on.x + 6.0 * random(stamp.id, 8)).sin();
        let width = (1.0 - on.x * on.x) * (1.0 + 0.25 * on.x) + ragged;
        let tilt = vec2(random(stamp.id, 10) - 0.5, random(stamp.id, 12) - 0.5);
        let curl = 0.16 * random(stamp.id, 13) * (on.y * on.y + 0.6 * on.x * on.x);
        (on.y.abs() <= width).then(|| 0.08 + curl + 0.22 * tilt.dot(on) - 0.05 * smooth(0.1, 0.0, on.y.abs()))
    })
}

fn twigs(canvas: &Canvas) -> Vec<Hit> {
    let twig = |number| {
        let stamp = Stamp::strewn(number, canvas.seed(31));
        let length = 0.015 + 0.09 * random(stamp.id, 3) * random(stamp.id, 4) * random(stamp.id, 8);
        let width = 0.0016 + 0.045 * length;
        Stamp { half: vec2(length, width), base: 0.5 + 0.4 * random(stamp.id, 7), ..stamp }
    };
    let stamps: Vec<Stamp> = (0..TWIGS).map(twig).collect();
    strew(canvas, &stamps, |stamp, on| {
        let bend = 0.55 * (2.0 * on.x + 6.0 * random(stamp.id, 9)).sin();
        let across = (on.y - bend) / 0.45;
        (across.abs() < 0.9 - 0.35 * on.x.abs()).then_some(0.3 * (1.0 - across * across))
    })
}

fn needles(canvas: &Canvas) -> Vec<Hit> {
    let needle = |number| {
        let stamp = Stamp::strewn(number, canvas.seed(41));
        let half = vec2(0.006 + 0.006 * random(stamp.id, 3), 0.0011);
        Stamp { half, base: random(stamp.id, 7), ..stamp }
    };
    let stamps: Vec<Stamp> = (0..NEEDLES).map(needle).collect();
    strew(canvas, &stamps, |_, _| Some(0.0))
}

pub(super) fn moss(canvas: &Canvas) -> Vec<Texel> {
    let greens: [Vec3; 5] = [0x2a3814, 0x465420, 0x64702c, 0x86893e, 0xa39c56].map(hex);
    let (reds, greys) = ([0x5a3a24, 0x7d4a2c].map(hex), [0xa9a891, 0xcfcdb8].map(hex));
    canvas.texels(|place, _| {
        let led = warped(place, 6, 3, 0.035, canvas.seed(1));
        let cushion = cells(led, [9, 9], canvas.seed(2));
        let small = cells(warped(place, 20, 2, 0.01, canvas.seed(3)), [34, 34], canvas.seed(4));
        let fine = fbm(place, 70, 3, canvas.seed(5));
        let dome = (1.0 - cushion.nearest * cushion.nearest).max(0.0) * smooth(0.0, 0.22, cushion.border());
        let star = (1.0 - small.nearest).max(0.0);
        let broad = fbm(place, 4, 5, canvas.seed(6));
        let height = 0.55 * dome + 0.28 * star + 0.16 * fine + 0.2 * broad;
        let tone =
            0.28 + 0.34 * cushion.random(1) + 0.25 * star + 0.16 * fine + 0.2 * broad + 0.12 * dome - 0.1;
        let mut colour = ramp(&greens, tone);
        // Heath and dead shoots in the hollows, lichen on some heights.
        let red = smooth(0.55, 0.8, 0.5 + 0.5 * fbm(place, 6, 4, canvas.seed(7)) - 0.3 * dome + 0.1 * fine);
        colour = colour.lerp(ramp(&reds, 0.5 + fine), 0.75 * red);
        let tufts = cells(led, [28, 28], canvas.seed(8));
        let many = smooth(0.45, 0.85, 0.5 + 0.5 * fbm(place, 5, 3, canvas.seed(9)));
        let tuft = smooth(0.5, 0.12, tufts.nearest + 0.25 * fine)
            * smooth(0.0, 0.14, tufts.border())
            * smooth(1.0 - 0.85 * many, 1.05 - 0.85 * many, tufts.random(1));
        colour = colour.lerp(ramp(&greys, 0.5 + 0.8 * fine), 0.75 * tuft);
        Texel { height: height + 0.2 * tuft * (1.0 + fine), colour, roughness: 0.93 - 0.06 * star }
    })
}
