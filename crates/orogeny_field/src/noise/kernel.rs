//! A noise as kernels take it: tables of octaves, and lattice places worked out in `f64`.

use super::{Basis, Noise, Normalization, Seeding, Turbulence};
use crate::hash::uniform;
use crate::{CurveTable, Error, Result};

/// The most octaves of one turbulence.
pub const MAX_OCTAVES: u32 = 16;

/// Samples a side of the blocks, on the terrain's grid, that share a lattice place: positions within one are small `f32`, and
/// do not depend on how a terrain is cut into pages.
pub const LATTICE_BLOCK: u32 = 32;

/// Fixed directions of a noise that follows the stroke, over half a turn.
pub const NUM_DIRECTIONS: usize = 16;

/// Frequency and weight of one octave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctaveScale {
    /// `lacunarity^l`.
    pub frequency: f64,
    /// `gain^l`.
    pub weight: f64,
}

/// Where on an octave's lattice a place lies: three coordinates, of which the last is for [`Basis::Simplex3d`] alone.
/// The layout is that of `LatticePoint` in `shaders/driver/noise.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LatticePoint {
    /// The cell, wrapped to 32 bits.
    pub cell: [u32; 3],
    /// Nothing: 16 bytes a vector.
    pub unused0: u32,
    /// From the cell's corner, 0..1.
    pub fraction: [f32; 3],
    /// Nothing.
    pub unused1: u32,
}

/// How far one sample along x and along z moves on an octave's lattice.
/// The layout is that of `LatticeStep` in `shaders/driver/noise.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LatticeStep {
    /// Cells for one sample along x.
    pub x: [f32; 3],
    /// [`OctaveScale::frequency`].
    pub frequency: f32,
    /// Cells for one sample along z.
    pub z: [f32; 3],
    /// [`OctaveScale::weight`].
    pub weight: f32,
}

/// From samples of the terrain to feature sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine {
    /// Feature sizes for one sample along x, and along z.
    pub(super) columns: [[f64; 2]; 2],
    /// What sample (0, 0) is moved to.
    pub(super) origin: [f64; 2],
}

impl Affine {
    fn at(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let [[xx, xz], [zx, zz]] = self.columns;
        let [origin_x, origin_z] = self.origin;
        [origin_x + x * xx + z * zx, origin_z + x * xz + z * zz]
    }
}

/// Which rows of the octave tables belong to which turbulence: the main one, then the two of the distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slots {
    /// Octaves of the main turbulence.
    pub main: u32,
    /// Octaves of each of the two that distort it.
    pub distortion: u32,
}

impl Slots {
    /// The row of octave `l` of turbulence `m`, 0 the main one.
    #[must_use]
    pub const fn index(self, m: u32, l: u32) -> usize {
        (match m {
            0 => l,
            m => self.main + (m - 1) * self.distortion + l,
        }) as usize
    }

    /// Rows in all.
    #[must_use]
    pub const fn len(self) -> usize {
        (self.main + 2 * self.distortion) as usize
    }

    /// Whether there is no octave at all.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }
}

/// A noise as kernels take it.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseKernel {
    /// What one octave is made of.
    pub basis: Basis,
    /// How the main octaves become one sum.
    pub turbulence: Turbulence,
    /// How those of the distortion do; [`Turbulence::Fbm`] where there is none.
    pub distortion_turbulence: Turbulence,
    /// How far the distortion goes, in feature sizes; 0 where there is none.
    pub distortion_weight: f64,
    /// Which rows of the tables belong to which turbulence.
    pub slots: Slots,
    /// Frequency and weight of each row.
    pub scales: Vec<OctaveScale>,
    /// The factor from one octave's weight to the next: of the main turbulence, and of the distortion.
    pub gains: [f64; 2],
    /// Weights of the four nearest distances.
    pub worley_weights: [f64; 4],
    /// What the multifractals add to each octave.
    pub elevation: f64,
    /// The slice of [`Basis::Simplex3d`], in feature sizes.
    pub slice: f64,
    /// What each octave is turned into; domain -1..1.
    pub transfer: Option<CurveTable>,
    /// What the normalised sum is turned into; domain -1..1.
    pub curve: Option<CurveTable>,
    /// Where seeds and coordinates come from.
    pub seeding: Seeding,
    /// Subtracted from the sum.
    pub offset: f64,
    /// What the rest is multiplied by.
    pub scale: f64,
    /// One, or [`NUM_DIRECTIONS`] and the first again where the noise follows the stroke.
    pub(super) directions: Vec<Affine>,
}

impl NoiseKernel {
    /// A noise on a terrain whose samples lie `spacing_m` apart. `anchor_m` is the place that stretching leaves where it is:
    /// the stroke's first point.
    ///
    /// # Errors
    /// [`Error::FeatureSize`] where not even the first octave is two samples long.
    pub fn new(noise: &Noise, spacing_m: f64, anchor_m: [f64; 2]) -> Result<Self> {
        let limit_m = 2.0 * spacing_m;
        let feature_size_m = noise.feature_size_m;
        let visible = |octaves: u32, lacunarity: f64| {
            (0..octaves).take_while(|l| feature_size_m / lacunarity.powi(*l as i32) >= limit_m).count() as u32
        };
        let slots = Slots {
            main: visible(noise.octaves, noise.lacunarity),
            distortion: noise
                .distortion
                .map_or(0, |distortion| visible(distortion.octaves, distortion.lacunarity)),
        };
        if slots.main == 0 {
            return Err(Error::FeatureSize { feature_size_m, spacing_m, limit_m });
        }
        let mut kernel = Self::without_place(noise, slots);
        kernel.directions = directions(noise, spacing_m, anchor_m);
        Ok(kernel)
    }

    /// All octaves of a noise, with no place on any terrain: what normalising looks at.
    #[must_use]
    pub fn in_feature_sizes(noise: &Noise) -> Self {
        let distortion = noise.distortion.map_or(0, |distortion| distortion.octaves);
        Self::without_place(noise, Slots { main: noise.octaves, distortion })
    }

    fn without_place(noise: &Noise, slots: Slots) -> Self {
        let scales = |octaves: u32, lacunarity: f64, gain: f64| {
            (0..octaves.cast_signed())
                .map(move |l| OctaveScale { frequency: lacunarity.powi(l), weight: gain.powi(l) })
        };
        let gain = noise.gain.factor(noise.lacunarity);
        let mut rows: Vec<_> = scales(slots.main, noise.lacunarity, gain).collect();
        let mut gains = [gain, 0.0];
        if let (Some(distortion), [_, distortion_gain]) = (noise.distortion, &mut gains) {
            *distortion_gain = distortion.gain.factor(distortion.lacunarity);
            for _ in 0..2 {
                rows.extend(scales(slots.distortion, distortion.lacunarity, *distortion_gain));
            }
        }
        let (offset, scale) = match noise.normalization {
            Normalization::Given { offset, scale } => (offset, scale),
            Normalization::Wanted | Normalization::Off => (0.0, 1.0),
        };
        Self {
            basis: noise.basis,
            turbulence: noise.turbulence,
            distortion_turbulence: noise
                .distortion
                .map_or(Turbulence::Fbm, |distortion| distortion.turbulence),
            distortion_weight: noise.distortion.map_or(0.0, |distortion| distortion.weight),
            slots,
            scales: rows,
            gains,
            worley_weights: noise.worley_weights,
            elevation: noise.elevation,
            slice: noise.slice,
            transfer: noise.transfer.as_ref().map(|curve| curve.table(-1.0, 1.0)),
            curve: noise.curve.as_ref().map(|curve| curve.table(-1.0, 1.0)),
            seeding: noise.seeding,
            offset,
            scale,
            directions: Vec::new(),
        }
    }

    /// Directions in which its pattern may be laid: 1, or 17 where it follows the stroke.
    #[must_use]
    pub const fn num_directions(&self) -> usize {
        self.directions.len()
    }

    /// Whether it has the same value at a sample for all instances of a stroke.
    #[must_use]
    pub const fn is_shared(&self) -> bool {
        matches!(self.seeding, Seeding::World | Seeding::Stroke) && self.num_directions() == 1
    }

    /// Where the origin of feature sizes lies on the lattice of octave `l` of turbulence `m`, before it is skewed: moved at
    /// random, so that octaves share no lattice point, and along the third axis to the slice.
    #[must_use]
    pub fn octave_origin(&self, seed: u32, m: u32, l: u32) -> [f64; 3] {
        let along = |axis: u32| f64::from(uniform(l, axis + 16 * m, seed));
        let slice = match self.basis {
            Basis::Simplex3d => {
                let frequency = self.scales.get(self.slots.index(m, l)).map_or(1.0, |scale| scale.frequency);
                along(0x53) + self.slice * frequency
            }
            _ => 0.0,
        };
        [along(0x51), along(0x52), slice]
    }

    /// Where sample `[x, z]` of the terrain lies on the lattice of a row of the octave tables, without what a frame adds.
    #[must_use]
    pub fn lattice(&self, direction: usize, slot: usize, sample: [i32; 2]) -> LatticePoint {
        let (Some(affine), Some(scale)) = (self.directions.get(direction), self.scales.get(slot)) else {
            return LatticePoint::ORIGIN;
        };
        let [x, z] = affine.at(sample.map(f64::from));
        LatticePoint::of(skewed(self.basis, [x * scale.frequency, z * scale.frequency, 0.0]))
    }

    /// How far one sample moves on the lattice of a row of the octave tables.
    #[must_use]
    pub fn step(&self, direction: usize, slot: usize) -> LatticeStep {
        let (Some(affine), Some(scale)) = (self.directions.get(direction), self.scales.get(slot)) else {
            return LatticeStep { x: [0.0; 3], frequency: 0.0, z: [0.0; 3], weight: 0.0 };
        };
        let [x, z] = affine.columns.map(|[x, z]| {
            skewed(self.basis, [x * scale.frequency, z * scale.frequency, 0.0]).map(|number| number as f32)
        });
        LatticeStep { x, frequency: scale.frequency as f32, z, weight: scale.weight as f32 }
    }
}

impl LatticePoint {
    /// The corner of cell 0.
    pub const ORIGIN: Self = Self { cell: [0; 3], unused0: 0, fraction: [0.0; 3], unused1: 0 };

    /// From lattice coordinates.
    #[must_use]
    pub fn of(place: [f64; 3]) -> Self {
        let cell = place.map(f64::floor);
        let fraction = |axis: usize| match (place.get(axis), cell.get(axis)) {
            // Rounded to `f32` it may be 1, which is the next cell's corner: the kernels take the floor of a sum anyway.
            (Some(place), Some(cell)) => (place - cell) as f32,
            _ => 0.0,
        };
        Self {
            cell: cell.map(|number| number as i64 as u32),
            unused0: 0,
            fraction: [fraction(0), fraction(1), fraction(2)],
            unused1: 0,
        }
    }
}

/// Lattice coordinates of a place: those of the simplex bases are skewed, so that their cells are unit squares and cubes.
#[must_use]
pub fn skewed(basis: Basis, [x, y, w]: [f64; 3]) -> [f64; 3] {
    /// `(sqrt(3) - 1) / 2`.
    const SKEW_2D: f64 = 0.366_025_403_784_438_65;
    match basis {
        Basis::Simplex => {
            let skew = (x + y) * SKEW_2D;
            [x + skew, y + skew, 0.0]
        }
        Basis::Simplex3d => {
            let skew = (x + y + w) / 3.0;
            [x + skew, y + skew, w + skew]
        }
        Basis::Gradient | Basis::Value | Basis::Worley | Basis::Sparse => [x, y, w],
    }
}

/// The ways from samples to feature sizes: rotation and offset, then what stretches along each direction.
fn directions(noise: &Noise, spacing_m: f64, anchor_m: [f64; 2]) -> Vec<Affine> {
    let (sin, cos) = noise.rotation_deg.to_radians().sin_cos();
    let per_m = 1.0 / noise.feature_size_m;
    let turned = |[x, z]: [f64; 2]| [per_m * (cos * x + sin * z), per_m * (cos * z - sin * x)];
    // Coordinates that go with the instance have its centre for an anchor.
    let anchor_m = if noise.seeding == Seeding::Instance { noise.offset_m } else { anchor_m };
    let [anchor_x, anchor_z] = anchor_m;
    let [offset_x, offset_z] = noise.offset_m;
    let anchor = turned([anchor_x - offset_x, anchor_z - offset_z]);
    let origin = turned([-offset_x, -offset_z]);
    let columns = [turned([spacing_m, 0.0]), turned([0.0, spacing_m])];
    let Some(direction) = noise.direction else { return vec![Affine { columns, origin }] };
    let shrink = 1.0 - 1.0 / direction.stretch;
    let along = |angle: f64| {
        let (e_z, e_x) = angle.sin_cos();
        let stretched = |[x, z]: [f64; 2]| {
            let length = (x * e_x + z * e_z) * shrink;
            [x - e_x * length, z - e_z * length]
        };
        let [[ox, oz], [ax, az]] = [origin, anchor];
        let [from_x, from_z] = stretched([ox - ax, oz - az]);
        Affine { columns: columns.map(stretched), origin: [ax + from_x, az + from_z] }
    };
    if direction.follows_stroke {
        let half_turn = std::f64::consts::PI;
        (0..=NUM_DIRECTIONS)
            .map(|k| along(half_turn * (k % NUM_DIRECTIONS) as f64 / NUM_DIRECTIONS as f64))
            .collect()
    } else {
        vec![along(direction.angle_deg.to_radians())]
    }
}
