//! What light each sample of the ground sends back: sun with cast shadows, the sky as far as it is seen, colour.

use rayon::prelude::*;

use crate::ground::Ground;
use crate::picture::{Ramp, colour_at};

/// Where the sun stands: north-west, the convention of maps; degrees from north, clockwise, and above the horizon.
const SUN_AZIMUTH_DEGREES: f32 = 315.0;
const SUN_ALTITUDE_DEGREES: f32 = 38.0;
/// How far the horizon rises, in tangents, from where it first dims the sun to where it hides it.
const PENUMBRA: f32 = 0.14;

/// A weak light from the south-west, which throws no shadow: without it all that faces the eye would look alike.
const FILL_AZIMUTH_DEGREES: f32 = 235.0;
const FILL_ALTITUDE_DEGREES: f32 = 25.0;

/// Linear colour of what the sun, the weak light, the sky and the ground around send.
const SUN: [f32; 3] = [0.86, 0.81, 0.72];
const FILL: [f32; 3] = [0.20, 0.20, 0.20];
const SKY: [f32; 3] = [0.37, 0.39, 0.42];
const BOUNCE: [f32; 3] = [0.09, 0.085, 0.075];

/// Directions in which the sky is looked for, and how far away, in samples.
const SKY_DIRECTIONS: usize = 12;
const SKY_DISTANCES: [f32; 9] = [1.0, 2.0, 3.5, 6.0, 10.0, 16.0, 26.0, 42.0, 66.0];

/// Colours (sRGB) from the lowest to the highest ground, all of them quiet, so that light and shape speak.
const TINTS: Ramp<7> = [
    (0.0, [92.0, 112.0, 100.0]),
    (0.25, [122.0, 140.0, 112.0]),
    (0.45, [152.0, 163.0, 126.0]),
    (0.55, [170.0, 173.0, 136.0]),
    (0.72, [196.0, 184.0, 150.0]),
    (0.88, [212.0, 202.0, 182.0]),
    (1.0, [236.0, 232.0, 224.0]),
];
/// What shows where it is steep, and the steepness (1 − the normal's height) from which and above which it does.
const ROCK: [f32; 3] = [158.0, 146.0, 132.0];
const ROCK_FROM: f32 = 0.12;
const ROCK_ABOVE: f32 = 0.42;

/// The linear colour of every sample. `ground` has its heights as they are drawn, with exaggeration; `tint_range` are the
/// heights of the first and the last tint in the same measure.
pub(super) fn lit_colours(ground: &Ground, tint_range: [f32; 2]) -> Vec<[f32; 3]> {
    let lights = Lights {
        to_sun: direction(SUN_AZIMUTH_DEGREES, SUN_ALTITUDE_DEGREES),
        to_fill: direction(FILL_AZIMUTH_DEGREES, FILL_ALTITUDE_DEGREES),
        sky: sky_places(),
        highest: ground.range_m()[1],
        tint_range,
    };
    let rows = (0..ground.depth()).into_par_iter();
    let places = rows.flat_map_iter(|z| (0..ground.width).map(move |x| [x.cast_signed(), z.cast_signed()]));
    places.map(|place| lights.lit_colour(ground, place)).collect()
}

/// What is the same for all samples.
struct Lights {
    to_sun: [f32; 3],
    to_fill: [f32; 3],
    sky: Vec<[SkyPlace; SKY_DISTANCES.len()]>,
    highest: f32,
    tint_range: [f32; 2],
}

/// Where something may hide the sky: columns and rows away, and the distance in samples.
type SkyPlace = (isize, isize, f32);

/// For each direction, from near to far.
fn sky_places() -> Vec<[SkyPlace; SKY_DISTANCES.len()]> {
    let of = |index: usize| {
        let (sine, cosine) = (std::f32::consts::TAU * (index as f32 + 0.5) / SKY_DIRECTIONS as f32).sin_cos();
        SKY_DISTANCES.map(|distance| {
            let (columns, rows) = ((sine * distance).round(), (cosine * distance).round());
            (columns as isize, rows as isize, columns.hypot(rows))
        })
    };
    (0..SKY_DIRECTIONS).map(of).collect()
}

/// North is -z.
fn direction(azimuth_degrees: f32, altitude_degrees: f32) -> [f32; 3] {
    let (azimuth, altitude) = (azimuth_degrees.to_radians(), altitude_degrees.to_radians());
    [azimuth.sin() * altitude.cos(), altitude.sin(), -azimuth.cos() * altitude.cos()]
}

impl Lights {
    fn lit_colour(&self, ground: &Ground, place @ [x, z]: [isize; 2]) -> [f32; 3] {
        let normal = ground.normal(x, z);
        let cosine = |to_light: [f32; 3]| {
            let cosine: f32 = normal.iter().zip(to_light).map(|(n, l)| n * l).sum();
            cosine.max(0.0)
        };
        let sun = match cosine(self.to_sun) {
            0.0 => 0.0,
            cosine => cosine * self.sunlight(ground, place),
        };
        let seen = self.sky_seen(ground, place);
        let (fill, sky) = (seen * cosine(self.to_fill), seen * (0.5 + 0.5 * normal[1]));
        let rock = smooth_step((1.0 - normal[1] - ROCK_FROM) / (ROCK_ABOVE - ROCK_FROM));
        let [low, high] = self.tint_range;
        let tint = colour_at(&TINTS, (ground.at(x, z) - low) / (high - low).max(f32::MIN_POSITIVE));
        let mut colour = [0.0; 3];
        let lights = SUN.iter().zip(FILL).zip(SKY.iter().zip(BOUNCE));
        for ((channel, (tint, rock_tint)), lights) in colour.iter_mut().zip(tint.iter().zip(ROCK)).zip(lights)
        {
            let ((of_sun, of_fill), (of_sky, of_ground)) = lights;
            let light = sun * of_sun + fill * of_fill + sky * of_sky + (1.0 - 0.5 * seen) * of_ground;
            *channel = light * linear(tint + rock * (rock_tint - tint));
        }
        colour
    }

    /// The share of the sun's disc that is seen, by what rises on the way to it.
    fn sunlight(&self, ground: &Ground, [x, z]: [isize; 2]) -> f32 {
        let [east, up, south] = self.to_sun;
        let level = east.hypot(south);
        let (towards, tangent) = ([east / level, south / level], up / level);
        let height = ground.at(x, z);
        let mut step = 1.0;
        let mut distance = 1.5;
        let mut horizon = f32::NEG_INFINITY;
        let reach = (ground.width + ground.depth()) as f32;
        while distance < reach {
            let run = distance * ground.spacing_m;
            if height + run * (tangent - PENUMBRA) > self.highest {
                break;
            }
            let place = [x as f32 + towards[0] * distance, z as f32 + towards[1] * distance];
            if !is_within(ground, place) {
                break;
            }
            horizon = horizon.max((ground.between(place) - height) / run);
            distance += step;
            // Far away a shadow is soft, and needs no short steps.
            step = (distance * 0.04).max(1.0);
        }
        smooth_step((tangent + 0.5 * PENUMBRA - horizon) / PENUMBRA)
    }

    /// The share of the sky that is seen from a sample, weighted towards the zenith as flat ground receives it.
    fn sky_seen(&self, ground: &Ground, [x, z]: [isize; 2]) -> f32 {
        let height = ground.at(x, z);
        let mut seen = 0.0;
        for places in &self.sky {
            let rise = |(columns, rows, distance): &SkyPlace| {
                (ground.at(x + columns, z + rows) - height) / (distance * ground.spacing_m)
            };
            let horizon = places.iter().map(rise).fold(0.0, f32::max);
            // cos² of the horizon's angle.
            seen += 1.0 / (1.0 + horizon * horizon);
        }
        seen / self.sky.len().max(1) as f32
    }
}

fn is_within(ground: &Ground, [x, z]: [f32; 2]) -> bool {
    x >= 0.0 && z >= 0.0 && x <= (ground.width - 1) as f32 && z <= (ground.depth() - 1) as f32
}

fn smooth_step(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// sRGB 0..255 → linear 0..1, by the standard's curve.
pub(super) fn linear(channel: f32) -> f32 {
    let value = channel / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear 0..1 → sRGB 0..255, the inverse.
pub(super) fn srgb(value: f32) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground(height: impl Fn(f32, f32) -> f32) -> Ground {
        let heights = (0..64 * 64).map(|k| height((k % 64) as f32, (k / 64) as f32)).collect();
        Ground { width: 64, heights, spacing_m: 1.0 }
    }

    fn brightness(ground: &Ground, x: usize, z: usize) -> f32 {
        lit_colours(ground, [-1000.0, 1000.0])[z * 64 + x].iter().sum()
    }

    #[test]
    fn every_byte_survives_the_way_to_linear_light_and_back() {
        for byte in 0..=255_u8 {
            assert_eq!(srgb(linear(f32::from(byte))), byte);
        }
    }

    #[test]
    fn a_wall_throws_a_shadow_to_the_south_east() {
        let wall = ground(|x, z| if x + z < 50.0 { 20.0 } else { 0.0 });
        let (in_shadow, beyond) = (brightness(&wall, 30, 30), brightness(&wall, 55, 55));
        assert!(in_shadow < 0.6 * beyond, "{in_shadow} {beyond}");
    }

    #[test]
    fn a_pit_sees_less_of_the_sky_than_a_plain() {
        let pit = ground(|x, z| if (x - 32.0).hypot(z - 32.0) < 4.0 { -20.0 } else { 0.0 });
        // The weak light and the sky reach the bottom of a pit less.
        assert!(brightness(&pit, 32, 32) < 0.5 * brightness(&pit, 5, 5));
    }

    #[test]
    fn a_slope_to_the_north_west_is_brighter_than_one_to_the_south_east() {
        let (towards, away) = (ground(|x, z| 0.3 * (x + z)), ground(|x, z| -0.3 * (x + z)));
        assert!(brightness(&towards, 32, 32) > 1.5 * brightness(&away, 32, 32));
    }
}
