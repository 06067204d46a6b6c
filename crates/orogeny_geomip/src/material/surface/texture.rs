//! The texture of a surface.

use glam::Vec3;

use super::canvas::Canvas;
use super::{Surface, finish, kinds};
use crate::{Error, Result};

/// Texels a side, where nothing else is asked for.
pub const SURFACE_SIZE: u32 = 512;
/// The fewest texels a side.
pub const MIN_SURFACE_SIZE: u32 = 64;
/// The most texels a side.
pub const MAX_SURFACE_SIZE: u32 = 4096;

/// A square texture that repeats without a seam. Rows from the north to the south, columns from the west to the east.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SurfaceTexture {
    /// Texels a side: a power of two.
    pub size: u32,
    /// 4 bytes a texel: albedo in sRGB, then the relief's height, linear.
    pub albedo_height: Vec<u8>,
    /// 4 bytes a texel, all linear: x and y of the unit normal (east and south, 0 at 127.5), roughness, ambient occlusion (255: open).
    pub normal_roughness: Vec<u8>,
}

impl SurfaceTexture {
    /// Works a surface out. Textures of two seeds are alike but not the same. `tint` multiplies the albedo in linear light.
    ///
    /// The same values give the same bytes on one machine, however many threads there are; another one's powers and sines may differ in
    /// the last bit.
    ///
    /// # Errors
    /// [`Error::SurfaceSize`] for a size that is no power of two within [`MIN_SURFACE_SIZE`]`..=`[`MAX_SURFACE_SIZE`].
    pub fn generate(surface: Surface, size: u32, seed: u32, tint: [f32; 3]) -> Result<Self> {
        if !size.is_power_of_two() || !(MIN_SURFACE_SIZE..=MAX_SURFACE_SIZE).contains(&size) {
            return Err(Error::SurfaceSize { size, min: MIN_SURFACE_SIZE, max: MAX_SURFACE_SIZE });
        }
        let canvas = Canvas { size, seed: seed.wrapping_mul(31).wrapping_add(surface as u32) };
        let texels = kinds::paint(surface, &canvas);
        Ok(finish::finish(surface, canvas, texels, Vec3::from_array(tint)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour::{LUMINANCE, to_linear};
    use super::*;

    fn texture(surface: Surface, size: u32, seed: u32) -> SurfaceTexture {
        SurfaceTexture::generate(surface, size, seed, [1.0; 3]).unwrap()
    }

    /// The mean absolute difference of a column from the next one, or of a row, over bytes of all channels.
    fn step(bytes: &[u8], size: usize, from: usize, along_rows: bool) -> f64 {
        let at = |line: usize, place: usize, channel: usize| {
            let (x, z) = if along_rows { (place, line) } else { (line, place) };
            f64::from(bytes[(z * size + x) * 4 + channel])
        };
        let next = (from + 1) % size;
        let differences = (0..size).flat_map(|place| {
            (0..4).map(move |channel| (at(from, place, channel) - at(next, place, channel)).abs())
        });
        differences.sum::<f64>() / (4 * size) as f64
    }

    #[test]
    fn no_seam_shows_between_tiles() {
        let size = 256;
        for surface in Surface::ALL {
            let texture = texture(surface, size as u32, 2);
            for bytes in [&texture.albedo_height, &texture.normal_roughness] {
                for along_rows in [false, true] {
                    let inside: Vec<f64> =
                        (0..size - 1).map(|line| step(bytes, size, line, along_rows)).collect();
                    let largest = inside.iter().copied().fold(0.0, f64::max);
                    let typical = inside.iter().sum::<f64>() / inside.len() as f64;
                    let seam = step(bytes, size, size - 1, along_rows);
                    assert!(
                        seam <= largest.min(1.5 * typical),
                        "{}: {seam} {typical} {largest}",
                        surface.name()
                    );
                }
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        for surface in Surface::ALL {
            let alone = one.install(|| texture(surface, 64, 7));
            assert_eq!(alone, three.install(|| texture(surface, 64, 7)));
            assert_ne!(alone, texture(surface, 64, 8), "{}", surface.name());
        }
    }

    #[test]
    fn albedo_is_as_bright_as_is_said() {
        for surface in Surface::ALL {
            let texture = texture(surface, 128, 0);
            let texels = texture.albedo_height.chunks_exact(4);
            let luminance = |texel: &[u8]| {
                LUMINANCE.dot(Vec3::from_array(
                    [0, 1, 2].map(|channel| to_linear(f32::from(texel[channel]) / 255.0)),
                ))
            };
            let mean = texels.map(luminance).sum::<f32>() / (128.0 * 128.0);
            let said = surface.luminance();
            // What is brighter than white is cut off.
            assert!((0.93..1.03).contains(&(mean / said)), "{}: {mean} {said}", surface.name());
        }
    }

    #[test]
    fn relief_fills_its_range_around_the_middle() {
        for surface in Surface::ALL {
            let heights: Vec<f64> = texture(surface, 128, 0)
                .albedo_height
                .chunks_exact(4)
                .map(|texel| f64::from(texel[3]))
                .collect();
            let mean = heights.iter().sum::<f64>() / heights.len() as f64;
            let deviation =
                (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / heights.len() as f64).sqrt();
            assert!(
                (115.0..140.0).contains(&mean) && (42.0..56.0).contains(&deviation),
                "{}: {mean} {deviation}",
                surface.name()
            );
        }
    }

    #[test]
    fn a_tint_multiplies_linear_light() {
        let plain = texture(Surface::Rock, 64, 0);
        let red = SurfaceTexture::generate(Surface::Rock, 64, 0, [1.0, 0.5, 0.0]).unwrap();
        for (plain, red) in plain.albedo_height.chunks_exact(4).zip(red.albedo_height.chunks_exact(4)) {
            assert_eq!((red[0], red[2], red[3]), (plain[0], 0, plain[3]));
            let halved = to_linear(f32::from(red[1]) / 255.0) / to_linear(f32::from(plain[1]) / 255.0);
            assert!((halved - 0.5).abs() < 0.06, "{halved}");
        }
    }

    #[test]
    fn a_size_that_is_no_power_of_two_is_refused() {
        for size in [0, 32, 100, 8192] {
            let err = SurfaceTexture::generate(Surface::Snow, size, 0, [1.0; 3]).unwrap_err().to_string();
            assert!(err.contains(&size.to_string()) && err.contains("power of two"), "{err}");
        }
    }
}
