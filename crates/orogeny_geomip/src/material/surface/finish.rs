//! From what was painted to bytes: relief, normals, cavities, brightness.

use glam::{Vec2, Vec3, vec2};
use rayon::prelude::*;

use super::canvas::{Canvas, Plane, Texel};
use super::colour::{LUMINANCE, byte, to_srgb};
use super::{Surface, SurfaceTexture};

/// Heights 0 and 1 of a texture are so many standard deviations below and above the mean.
const HEIGHT_DEVIATIONS: f32 = 2.5;
/// Evened out is what is larger than a tile divided by this, to either side.
const EVEN_SHARE: u32 = 10;
/// How strongly cavities are darkened, by the mean slope of their sides.
const CAVITY_STRENGTH: f32 = 0.55;
/// How much of that is in the albedo too, where dirt and moisture gather.
const CAVITY_IN_ALBEDO: f32 = 0.5;

/// The texture of a painted canvas. `tint` multiplies the albedo.
pub(super) fn finish(surface: Surface, canvas: Canvas, texels: Vec<Texel>, tint: Vec3) -> SurfaceTexture {
    let traits = surface.traits();
    let size = canvas.size;
    let heights = Plane::new(size, texels.iter().map(|texel| texel.height).collect());
    let relief = unit_heights(&evened(&heights, size / EVEN_SHARE, traits.evenness));
    let cavity = cavities(&relief, size, traits.relief);
    let colours = colours(&texels, &cavity, size, traits.evenness, traits.luminance, tint);

    let side = size as usize;
    let mut albedo_height = vec![0; side * side * 4];
    let mut normal_roughness = vec![0; side * side * 4];
    let rows = albedo_height.par_chunks_mut(side * 4).zip(normal_roughness.par_chunks_mut(side * 4));
    let sources = colours.par_chunks(side).zip(relief.values().par_chunks(side));
    let rest = texels.par_chunks(side).zip(cavity.par_chunks(side));
    rows.zip(sources).zip(rest).enumerate().for_each(|(z, (((albedo, normal), (colour, height)), rest))| {
        for (texel, (colour, height)) in
            albedo.as_chunks_mut::<4>().0.iter_mut().zip(colour.iter().zip(height))
        {
            let [red, green, blue] = colour.to_array().map(|value| byte(to_srgb(value)));
            *texel = [red, green, blue, byte(*height)];
        }
        let (texels, cavity) = rest;
        let normals = normal.as_chunks_mut::<4>().0.iter_mut();
        for (x, (texel, (source, cavity))) in normals.zip(texels.iter().zip(cavity)).enumerate() {
            let [x, y] = normal_at(&relief, x as i32, z as i32, traits.relief).to_array();
            *texel = [byte(0.5 + 0.5 * x), byte(0.5 + 0.5 * y), byte(source.roughness), byte(*cavity)];
        }
    });
    SurfaceTexture { size, albedo_height, normal_roughness }
}

/// A plane less a share of what is larger than `radius` texels.
fn evened(plane: &Plane, radius: u32, share: f32) -> Plane {
    let (mean, large) = (plane.mean(), plane.blurred(radius));
    let values = plane.values().iter().zip(large.values());
    Plane::new(plane.size(), values.map(|(value, large)| value - share * (large - mean)).collect())
}

/// Heights as [`Surface::relief`] counts them: the mean at 0.5, and not kept to 0..1.
fn unit_heights(plane: &Plane) -> Plane {
    let mean = plane.mean();
    let variance = plane.clone().map(|height| (height - mean) * (height - mean)).mean();
    let scale = 0.5 / (HEIGHT_DEVIATIONS * variance.sqrt().max(1.0e-9));
    plane.clone().map(|height| 0.5 + (height - mean) * scale)
}

/// x and y of the unit normal of a relief whose heights are in units of `relief` tiles: (-dh/du, -dh/dv, 1), normalised.
///
/// By central differences; x to the east (with the columns), y to the south (with the rows).
pub(super) fn normal_at(heights: &Plane, x: i32, z: i32, relief: f32) -> Vec2 {
    let per_tile = 0.5 * heights.size() as f32 * relief;
    let slope =
        vec2(heights.at(x - 1, z) - heights.at(x + 1, z), heights.at(x, z - 1) - heights.at(x, z + 1))
            * per_tile;
    slope / (1.0 + slope.length_squared()).sqrt()
}

/// How open each texel is to the sky, 0..1: less the deeper it lies below its surroundings of three sizes.
fn cavities(heights: &Plane, size: u32, relief: f32) -> Vec<f32> {
    let surroundings = [size / 200, size / 70, size / 24].map(|radius| {
        let radius = radius.max(1);
        // Depth over radius: the slope of the sides.
        (heights.blurred(radius), relief * size as f32 / radius as f32)
    });
    let [near, middle, far] = &surroundings;
    let rows = near.0.values().par_iter().zip(middle.0.values()).zip(far.0.values());
    rows.zip(heights.values())
        .map(|(((near_mean, middle_mean), far_mean), height)| {
            let depth = |mean: f32, scale: f32| (mean - height).max(0.0) * scale;
            let slopes = depth(*near_mean, near.1) + depth(*middle_mean, middle.1) + depth(*far_mean, far.1);
            1.0 / (1.0 + CAVITY_STRENGTH * slopes)
        })
        .collect()
}

/// Albedo in linear light, of the wanted mean luminance.
fn colours(
    texels: &[Texel],
    cavity: &[f32],
    size: u32,
    evenness: f32,
    luminance: f32,
    tint: Vec3,
) -> Vec<Vec3> {
    let dirty = |(texel, cavity): (&Texel, &f32)| texel.colour * (1.0 - CAVITY_IN_ALBEDO * (1.0 - cavity));
    let colours: Vec<Vec3> = texels.par_iter().zip(cavity).map(dirty).collect();
    let of_channel = |channel: usize| {
        let values =
            colours.par_iter().map(|colour| colour.to_array().get(channel).copied().unwrap_or_default());
        let plane = Plane::new(size, values.collect());
        (plane.mean(), plane.blurred(size / EVEN_SHARE))
    };
    let [(red, reds), (green, greens), (blue, blues)] = [0, 1, 2].map(of_channel);
    let mean = Vec3::new(red, green, blue);
    let scale = tint * (luminance / mean.dot(LUMINANCE).max(1.0e-6));
    let large = reds.values().par_iter().zip(greens.values()).zip(blues.values());
    large
        .zip(&colours)
        .map(|(((red, green), blue), colour)| {
            let large = Vec3::new(*red, *green, *blue).max(Vec3::splat(1.0e-6));
            // As a factor: a dark place that is made brighter keeps its contrast.
            let even = Vec3::ONE + evenness * (mean / large - Vec3::ONE);
            (*colour * even * scale).clamp(Vec3::ZERO, Vec3::ONE)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round hill of 0.1 tiles' height on a tile: its normals are those of its formula.
    #[test]
    fn normals_are_those_of_the_heights() {
        let size = 128;
        let height = |x: f32, z: f32| (-32.0 * ((x - 0.5).powi(2) + (z - 0.5).powi(2))).exp();
        let values = (0..size * size)
            .map(|index| height((index % size) as f32 / size as f32, (index / size) as f32 / size as f32));
        let plane = Plane::new(size, values.collect());
        for (x, z) in [(40, 64), (80, 64), (64, 50), (70, 90), (64, 64)] {
            let (u, v) = (x as f32 / size as f32, z as f32 / size as f32);
            let slope = vec2(64.0 * (u - 0.5), 64.0 * (v - 0.5)) * height(u, v) * 0.1;
            let expected = slope / (1.0 + slope.length_squared()).sqrt();
            let normal = normal_at(&plane, x, z, 0.1);
            assert!((normal - expected).length() < 0.005, "{x} {z}: {normal} {expected}");
        }
        // West of the top the ground faces west.
        assert!(normal_at(&plane, 50, 64, 0.1).x < -0.1);
    }
}
