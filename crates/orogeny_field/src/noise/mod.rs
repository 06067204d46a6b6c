//! Noise as a value: a basis, how its octaves are summed, and what bends, stretches and scales the sum.
//!
//! [`Noise`] is what people choose. [`NoiseKernel`] is what the kernels take: every number that is the same for all samples,
//! worked out in `f64`, and the lattice places of any sample ([`NoiseKernel::lattice`]), so that a kernel never holds a
//! position in one large `f32`.

mod frame;
mod kernel;

pub use frame::{FrameOctave, NoiseFrame};
pub use kernel::{
    LATTICE_BLOCK, LatticePoint, LatticeStep, MAX_OCTAVES, NUM_DIRECTIONS, NoiseKernel, OctaveScale, Slots,
    skewed,
};

use crate::{Curve, Gate};

/// What one octave is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u32)]
pub enum Basis {
    /// Perlin's gradient noise over a square lattice, with eight directions.
    Gradient = 0,
    /// Random values on a square lattice, joined by Catmull-Rom curves.
    Value = 1,
    /// Distances to the nearest of points scattered one a cell (Worley 1996).
    Worley = 2,
    /// Gradient noise over triangles.
    Simplex = 3,
    /// A plane through gradient noise over tetrahedra: `slice` moves the plane.
    Simplex3d = 4,
    /// Sparse convolution (Lewis 1989): smooth bumps of random height at random places.
    Sparse = 5,
}

/// How octaves become one sum (section 7 of the kernel specification).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u32)]
pub enum Turbulence {
    /// The plain sum: rolling land.
    Fbm = 0,
    /// Sum of absolute values: round hills between creases.
    Billowy = 1,
    /// Sum of what the absolute values leave to 1: sharp crests.
    Ridged = 2,
    /// Less detail where the sum so far is steep (Quilez).
    Quilez = 3,
    /// Ridges that bend along their own slopes and smooth out in valleys (de Carpentier's Swiss turbulence).
    Erosive = 4,
    /// Squares that bend and damp each other (de Carpentier's Jordan turbulence).
    Jordan = 5,
    /// Rougher where it is higher (Musgrave's heterogeneous terrain).
    Heterogeneous = 6,
    /// A product instead of a sum (Musgrave's multiplicative multifractal).
    Multiplicative = 7,
    /// Smooth valleys, rough peaks (Musgrave's hybrid multifractal).
    Hybrid = 8,
}

/// Where a noise gets its seed and its coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Seeding {
    /// The brush's seed, the world's coordinates: painting twice finds the same pattern.
    World,
    /// The brush's seed, coordinates from each instance's centre: every instance is the same.
    Instance,
    /// A new seed for each stroke, the world's coordinates.
    Stroke,
    /// A new seed for each instance, the world's coordinates.
    Random,
}

/// How an octave's weight follows from the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gain {
    /// `lacunarity^-hurst`.
    Hurst(f64),
    /// As it is.
    Given(f64),
}

impl Gain {
    /// The factor from one octave's weight to the next.
    #[must_use]
    pub fn factor(self, lacunarity: f64) -> f64 {
        match self {
            Self::Hurst(hurst) => lacunarity.powf(-hurst),
            Self::Given(gain) => gain,
        }
    }
}

/// Two further turbulences that move the place at which a noise is looked up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distortion {
    /// Of both.
    pub turbulence: Turbulence,
    /// Of both.
    pub octaves: u32,
    /// How far, in feature sizes.
    pub weight: f64,
    /// Ratio of the frequencies of successive octaves.
    pub lacunarity: f64,
    /// Ratio of their weights.
    pub gain: Gain,
}

/// A noise that is stretched along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseDirection {
    /// Degrees from world x towards z; with [`Self::follows_stroke`], from the stroke's direction.
    pub angle_deg: f64,
    /// Whether the angle is relative to the stroke.
    pub follows_stroke: bool,
    /// How many times longer features are along the direction, 1 or more.
    pub stretch: f64,
}

/// What turns a raw sum into about 0..1 or -1..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Normalization {
    /// By percentiles, still to be found.
    Wanted,
    /// The raw sum as it is.
    Off,
    /// `(sum - offset) * scale`.
    Given {
        /// Subtracted from the sum.
        offset: f64,
        /// What the rest is multiplied by.
        scale: f64,
    },
}

/// A noise with all its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// What one octave is made of.
    pub basis: Basis,
    /// How octaves become one sum.
    pub turbulence: Turbulence,
    /// Size of the first octave's cell, metres.
    pub feature_size_m: f64,
    /// How many octaves at most; those shorter than two samples are left out.
    pub octaves: u32,
    /// Ratio of the frequencies of successive octaves.
    pub lacunarity: f64,
    /// Ratio of their weights.
    pub gain: Gain,
    /// Which of all noises.
    pub seed: u32,
    /// Where seed and coordinates come from.
    pub seeding: Seeding,
    /// What the sum is scaled by.
    pub normalization: Normalization,
    /// Weights of the four nearest distances of [`Basis::Worley`].
    pub worley_weights: [f64; 4],
    /// Where [`Basis::Simplex3d`] is cut, in feature sizes.
    pub slice: f64,
    /// What the multifractals add to each octave.
    pub elevation: f64,
    /// What each octave's -1..1 is turned into before it is summed.
    pub transfer: Option<Curve>,
    /// What the normalised sum, -1..1, is turned into.
    pub curve: Option<Curve>,
    /// What moves the place.
    pub distortion: Option<Distortion>,
    /// What stretches the pattern.
    pub direction: Option<NoiseDirection>,
    /// Where the pattern's origin lies, metres.
    pub offset_m: [f64; 2],
    /// Degrees by which the pattern is turned from x towards z.
    pub rotation_deg: f64,
    /// How rough it is where, 0..1: each octave's weight is multiplied by it once more than that of the one before.
    pub roughness: Option<Box<Gate>>,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            basis: Basis::Gradient,
            turbulence: Turbulence::Fbm,
            feature_size_m: 100.0,
            octaves: 8,
            lacunarity: 1.92,
            gain: Gain::Hurst(0.85),
            seed: 0,
            seeding: Seeding::World,
            normalization: Normalization::Wanted,
            worley_weights: [1.0, 0.0, 0.0, 0.0],
            slice: 0.0,
            elevation: 0.7,
            transfer: None,
            curve: None,
            distortion: None,
            direction: None,
            offset_m: [0.0; 2],
            rotation_deg: 0.0,
            roughness: None,
        }
    }
}

impl Turbulence {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Fbm,
        Self::Billowy,
        Self::Ridged,
        Self::Quilez,
        Self::Erosive,
        Self::Jordan,
        Self::Heterogeneous,
        Self::Multiplicative,
        Self::Hybrid,
    ];

    /// Whether its sum lies about 0, so that normalising leaves 0 where it is.
    #[must_use]
    pub const fn is_signed(self) -> bool {
        matches!(self, Self::Fbm | Self::Quilez)
    }

    /// Whether it asks the basis for its gradient.
    #[must_use]
    pub const fn needs_gradient(self) -> bool {
        matches!(self, Self::Quilez | Self::Erosive | Self::Jordan)
    }
}

impl Basis {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Gradient, Self::Value, Self::Worley, Self::Simplex, Self::Simplex3d, Self::Sparse];
}
