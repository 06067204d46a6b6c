//! Smaller copies of a texture, each of the means of four texels of the one before.

use std::sync::LazyLock;

use glam::{Vec3, Vec4, vec3, vec4};
use rayon::prelude::*;

use super::SurfaceTexture;
use super::colour::{byte, to_linear, to_srgb};

/// Linear light of each sRGB byte.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|value| to_linear(value as f32 / 255.0)));

/// A texel as it is averaged: every part of it can be.
#[derive(Debug, Clone, Copy)]
struct Sums {
    /// Albedo in linear light, and the height.
    albedo_height: Vec4,
    /// The mean of unit normals: shorter than 1 where they differ.
    normal: Vec3,
    /// The square of GGX's alpha, which is the roughness squared.
    alpha_squared: f32,
    openness: f32,
}

impl SurfaceTexture {
    /// All smaller copies, of half the size each, down to a single texel.
    ///
    /// Albedo is averaged in linear light, so that a far surface has the colour of a near one. Unit normals are averaged as they are: by
    /// how much their mean, of length L, is short of 1 says how much they differ, and that is roughness where they can no longer be
    /// seen (after Toksvig, "Mipmapping Normal Maps", 2005). For normals spread after von Mises and Fisher, of concentration
    /// κ = (3 L - L³) / (1 - L²) (Banerjee et al. 2005), each slope varies by 1 / κ, which GGX's alpha takes as
    /// alpha'² = alpha² + 2 / κ; alpha is the roughness squared, and alpha² is averaged. The normal is stored as a unit vector.
    #[must_use]
    pub fn mips(&self) -> Vec<Self> {
        let mut size = self.size;
        let texels = self.albedo_height.as_chunks::<4>().0.par_iter();
        let mut level: Vec<Sums> = texels
            .zip(self.normal_roughness.as_chunks::<4>().0)
            .map(|(albedo_height, normal_roughness)| Sums::read(*albedo_height, *normal_roughness))
            .collect();
        let mut mips = Vec::new();
        while size > 1 {
            level = halved(&level, size as usize);
            size /= 2;
            mips.push(Self {
                size,
                albedo_height: level.iter().flat_map(Sums::albedo_height).collect(),
                normal_roughness: level.iter().flat_map(Sums::normal_roughness).collect(),
            });
        }
        mips
    }
}

impl Sums {
    fn read([red, green, blue, height]: [u8; 4], normal_roughness: [u8; 4]) -> Self {
        let linear = |value: u8| LINEAR.get(usize::from(value)).copied().unwrap_or_default();
        let unit = |value: u8| f32::from(value) / 255.0;
        let [x, y, roughness, openness] = normal_roughness.map(unit);
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        Self {
            albedo_height: vec4(linear(red), linear(green), linear(blue), unit(height)),
            normal: vec3(x, y, z).normalize_or(Vec3::Z),
            alpha_squared: roughness.powi(4),
            openness,
        }
    }

    fn albedo_height(&self) -> [u8; 4] {
        let [red, green, blue, height] = self.albedo_height.to_array();
        [byte(to_srgb(red)), byte(to_srgb(green)), byte(to_srgb(blue)), byte(height)]
    }

    fn normal_roughness(&self) -> [u8; 4] {
        let length = self.normal.length().min(1.0);
        let unit = self.normal.normalize_or(Vec3::Z);
        let spread = (1.0 - length * length) / (3.0 * length - length.powi(3)).max(1.0e-3);
        let alpha_squared = (self.alpha_squared + 2.0 * spread).min(1.0);
        [
            byte(0.5 + 0.5 * unit.x),
            byte(0.5 + 0.5 * unit.y),
            byte(alpha_squared.sqrt().sqrt()),
            byte(self.openness),
        ]
    }

    fn mean(texels: [Self; 4]) -> Self {
        let [mut sum, b, c, d] = texels;
        for texel in [b, c, d] {
            sum.albedo_height += texel.albedo_height;
            sum.normal += texel.normal;
            sum.alpha_squared += texel.alpha_squared;
            sum.openness += texel.openness;
        }
        Self {
            albedo_height: sum.albedo_height * 0.25,
            normal: sum.normal * 0.25,
            alpha_squared: sum.alpha_squared * 0.25,
            openness: sum.openness * 0.25,
        }
    }
}

fn halved(level: &[Sums], size: usize) -> Vec<Sums> {
    let rows = level.par_chunks_exact(size * 2).flat_map_iter(|pair| {
        let (upper, lower) = pair.split_at(size);
        let squares = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        squares.map(|([a, b], [c, d])| Sums::mean([*a, *b, *c, *d]))
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::super::Surface;
    use super::*;

    fn mean_colour(texture: &SurfaceTexture) -> Vec3 {
        let texels = texture.albedo_height.chunks_exact(4);
        let sum = texels
            .map(|texel| Vec3::from_array([0, 1, 2].map(|channel| LINEAR[usize::from(texel[channel])])));
        sum.sum::<Vec3>() / (texture.size * texture.size) as f32
    }

    #[test]
    fn a_far_surface_has_the_colour_of_a_near_one() {
        for surface in Surface::ALL {
            let texture = SurfaceTexture::generate(surface, 64, 1, [1.0; 3]).unwrap();
            let mips = texture.mips();
            assert_eq!(mips.iter().map(|mip| mip.size).collect::<Vec<_>>(), [32, 16, 8, 4, 2, 1]);
            let near = mean_colour(&texture);
            for mip in &mips {
                // A byte is 1/255 in sRGB, of which the curve makes at most 2.3 times as much.
                let difference = (mean_colour(mip) - near).abs().max_element();
                assert!(difference < 1.2 / 255.0, "{}: {difference}", surface.name());
            }
        }
    }

    #[test]
    fn normals_that_cancel_out_make_a_surface_rough() {
        let normals = [[230, 128, 51, 255], [26, 128, 51, 255]];
        let texture = SurfaceTexture {
            size: 2,
            albedo_height: vec![128; 16],
            normal_roughness: [normals[0], normals[1], normals[1], normals[0]].concat(),
        };
        let mip = &texture.mips()[0];
        let &[x, y, roughness, openness] = mip.normal_roughness.as_slice() else { unreachable!() };
        assert!(x.abs_diff(128) <= 1 && y.abs_diff(128) <= 1 && openness == 255, "{x} {y}");
        // L = 0.6: 1 / κ = 0.64 / 1.584.
        let expected = 255.0 * (0.2_f32.powi(4) + 2.0 * 0.64 / 1.584).sqrt().sqrt();
        assert!((f32::from(roughness) - expected).abs() < 2.0, "{roughness} {expected}");

        let flat = SurfaceTexture {
            size: 2,
            albedo_height: vec![9; 16],
            normal_roughness: [[128, 128, 51, 200]; 4].concat(),
        };
        assert_eq!(flat.mips()[0].normal_roughness, [128, 128, 51, 200]);
    }
}
