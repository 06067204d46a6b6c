//! Solid rock.

use glam::{Vec2, vec2};

use super::ramp;
use crate::material::surface::canvas::{Canvas, Texel};
use crate::material::surface::colour::hex;
use crate::material::surface::noise::{Cells, cells, fbm, fbm_stretched, ridges, smooth, warped};

/// A face of its own height for each cell, with slanted edges `bevel` cells wide.
fn facet(cell: &Cells, bevel: f32) -> f32 {
    cell.random(13) * smooth(0.0, bevel, cell.border())
}

/// A crack along the borders of cells, which is open only here and there: 0..1.
fn crack(place: Vec2, cell: &Cells, width: f32, seed: u32) -> f32 {
    let open = width * smooth(-0.15, 0.55, fbm(place, 5, 3, seed));
    1.0 - smooth(0.25 * open, open + 1.0e-4, cell.border())
}

pub(super) fn rock(canvas: &Canvas) -> Vec<Texel> {
    let greys = [0x4c4a47, 0x696662, 0x827d76, 0x98928a, 0xada79e].map(hex);
    let (rusts, lichens) = ([0x6f5a45, 0x8c7258].map(hex), [0x8f9376, 0xb4b592].map(hex));
    canvas.texels(|place, _| {
        let led = warped(place, 4, 3, 0.055, canvas.seed(1));
        // Drawn out along one way, as bedding or cleavage is.
        let blocks = cells(led, [4, 8], canvas.seed(2));
        let chips = cells(led + vec2(0.31, 0.17), [11, 20], canvas.seed(4));
        let broad = fbm(led, 4, 4, canvas.seed(5));
        let ridged = ridges(led, 5, 4, canvas.seed(6));
        let fine = fbm(place, 40, 3, canvas.seed(7));
        let crack = crack(place, &blocks, 0.075, canvas.seed(12));
        let height = 0.34 * facet(&blocks, 0.3)
            + 0.2 * facet(&chips, 0.25)
            + 0.34 * broad
            + 0.55 * ridged
            + 0.1 * fine
            - 0.3 * crack;
        let tone = 0.46
            + 0.22 * broad
            + 0.17 * fine
            + 0.18 * (blocks.random(1) - 0.5)
            + 0.16 * (chips.random(1) - 0.5)
            + 0.18 * (ridged - 0.5);
        let mut colour = ramp(&greys, tone) * (1.0 - 0.45 * crack);
        let rust = smooth(0.52, 0.85, 0.5 + 0.5 * fbm(led, 5, 3, canvas.seed(8)) + 0.12 * fine);
        colour = colour.lerp(ramp(&rusts, tone), 0.4 * rust);
        let spots = cells(warped(place, 20, 2, 0.012, canvas.seed(9)), [24, 24], canvas.seed(10));
        let grown = smooth(0.5, 0.75, 0.5 + 0.5 * fbm(place, 5, 3, canvas.seed(11)));
        let lichen =
            smooth(0.42, 0.3, spots.nearest + 0.12 * fine) * grown * smooth(0.35, 0.4, spots.random(1));
        colour = colour.lerp(ramp(&lichens, spots.random(2)), 0.55 * lichen);
        Texel { height, colour, roughness: 0.84 + 0.06 * fine + 0.06 * lichen - 0.05 * crack }
    })
}

pub(super) fn cliff(canvas: &Canvas) -> Vec<Texel> {
    let greys = [0x5b554e, 0x77706a, 0x8c8378, 0x9d9487, 0xb3aa9b].map(hex);
    let (ochres, streaks) = ([0x7d6b55, 0x9a8466].map(hex), hex(0x3a3733));
    canvas.texels(|place, _| {
        let fold = 0.045 * fbm(place, 2, 3, canvas.seed(1)) + 0.012 * fbm(place, 9, 2, canvas.seed(2));
        let bedded = vec2(place.x, place.y + fold);
        // Beds: each of a hardness of its own, which sets how far it stands out.
        let bed = fbm_stretched(bedded, [1, 9], 3, canvas.seed(3));
        let laminae = fbm_stretched(bedded, [3, 48], 2, canvas.seed(4));
        let step = (bed * 3.2).floor() / 3.2 + smooth(0.0, 0.35, (bed * 3.2).rem_euclid(1.0)) / 3.2;
        // Joints cut the beds into blocks, other ones in each.
        let joints = cells(warped(bedded, 10, 2, 0.018, canvas.seed(5)), [6, 13], canvas.seed(6));
        let joint = crack(place, &joints, 0.09, canvas.seed(12));
        let led = warped(place, 6, 2, 0.04, canvas.seed(7));
        let broken = ridges(led, 7, 4, canvas.seed(8));
        let fine = fbm(place, 48, 3, canvas.seed(9));
        let height = 0.75 * step + 0.3 * facet(&joints, 0.22) + 0.12 * laminae + 0.28 * broken + 0.09 * fine
            - 0.2 * joint;
        let tone = 0.46
            + 0.28 * bed
            + 0.13 * laminae
            + 0.14 * fine
            + 0.16 * (joints.random(2) - 0.5)
            + 0.14 * (broken - 0.5);
        let ochre = smooth(0.45, 0.8, 0.5 + 0.5 * fbm_stretched(bedded, [2, 7], 3, canvas.seed(10)));
        let mut colour = ramp(&greys, tone).lerp(ramp(&ochres, tone), 0.5 * ochre) * (1.0 - 0.4 * joint);
        // Where water runs down.
        let run = smooth(0.25, 0.9, fbm_stretched(led, [14, 2], 3, canvas.seed(11)));
        colour = colour.lerp(streaks, 0.35 * run);
        Texel { height, colour, roughness: 0.85 + 0.06 * fine - 0.12 * run }
    })
}

pub(super) fn basalt(canvas: &Canvas) -> Vec<Texel> {
    let blacks = [0x1d1b1c, 0x2e2b2b, 0x403c3a, 0x565049].map(hex);
    let rust = hex(0x5a3a28);
    canvas.texels(|place, _| {
        let led = warped(place, 5, 3, 0.05, canvas.seed(1));
        let crust = cells(led, [7, 7], canvas.seed(2));
        let clinker = cells(warped(place, 16, 2, 0.02, canvas.seed(3)), [22, 22], canvas.seed(4));
        let broad = fbm(led, 4, 4, canvas.seed(5));
        let fine = fbm(place, 60, 3, canvas.seed(6));
        // Ropes: folds of the skin as it was dragged along.
        let rope = (std::f32::consts::TAU * (11.0 * place.y + 4.0 * fbm(place, 3, 2, canvas.seed(7)))).sin();
        let roped = smooth(-0.1, 0.3, fbm(place, 4, 2, canvas.seed(8)));
        let crack = crack(place, &crust, 0.11, canvas.seed(11));
        let clink = (1.0 - clinker.nearest).max(0.0) * (0.4 + 0.6 * clinker.random(1));
        let bubble = cells(place, [72, 72], canvas.seed(9));
        let vesicle = smooth(0.3, 0.16, bubble.nearest) * smooth(0.35, 0.5, bubble.random(1));
        let height = 0.45 * broad
            + 0.25 * facet(&crust, 0.3)
            + 0.09 * roped * rope
            + 0.45 * (1.0 - roped) * clink
            + 0.1 * fine
            - 0.42 * crack
            - 0.08 * vesicle;
        let tone = 0.42
            + 0.2 * broad
            + 0.2 * fine
            + 0.2 * (clink - 0.4)
            + 0.06 * roped * rope
            + 0.14 * (crust.random(2) - 0.5);
        let oxide = smooth(0.5, 0.85, 0.5 + 0.5 * fbm(led, 4, 3, canvas.seed(10)));
        let colour =
            ramp(&blacks, tone).lerp(rust, 0.28 * oxide) * (1.0 - 0.5 * crack) * (1.0 - 0.3 * vesicle);
        Texel { height, colour, roughness: 0.74 - 0.12 * roped + 0.07 * fine }
    })
}
