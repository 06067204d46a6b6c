//! Surfaces that ship with the program: each is worked out, not stored, and its tiles fit each other on all sides.

mod canvas;
mod colour;
mod finish;
mod kinds;
mod mips;
mod noise;
mod stamp;
mod texture;

use serde::{Deserialize, Serialize};

use crate::{Error, Result};

pub use texture::{MAX_SURFACE_SIZE, MIN_SURFACE_SIZE, SURFACE_SIZE, SurfaceTexture};

/// A kind of ground that can be worked out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Surface {
    /// Dense short grass.
    Grass,
    /// Grass with dry stalks, clover and flowers.
    Meadow,
    /// Fallen leaves, twigs and moss over dark soil.
    ForestFloor,
    /// Cushions of moss and lichen.
    Moss,
    /// Loose soil with crumbs and few stones.
    Soil,
    /// Dried mud, broken into plates.
    CrackedEarth,
    /// Wet mud with puddles.
    Mud,
    /// Sand with wind ripples, which run across the tile.
    Sand,
    /// Rounded pebbles of many sizes.
    Gravel,
    /// Broken, angular stones.
    Scree,
    /// Weathered rock with cracks and lichen.
    Rock,
    /// Rock in level layers, for steep faces.
    Cliff,
    /// Dark lava with cracks and vesicles.
    Basalt,
    /// Snow that the wind has packed.
    Snow,
    /// Glacier ice with cracks.
    Ice,
}

/// What is known of a surface before it is worked out.
struct Traits {
    name: &'static str,
    tile_m: f32,
    /// The mean luminance of its albedo, 0..1, linear: of visible light, in which plants are darker than over the whole of sunlight.
    luminance: f32,
    /// The height of its relief, 5 standard deviations, in widths of the tile.
    relief: f32,
    /// How much of what is as large as the tile is taken out, 0..1: what is left is seen again in every repeat.
    evenness: f32,
}

impl Surface {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Grass,
        Self::Meadow,
        Self::ForestFloor,
        Self::Moss,
        Self::Soil,
        Self::CrackedEarth,
        Self::Mud,
        Self::Sand,
        Self::Gravel,
        Self::Scree,
        Self::Rock,
        Self::Cliff,
        Self::Basalt,
        Self::Snow,
        Self::Ice,
    ];

    const fn traits(self) -> Traits {
        let (name, tile_m, luminance, relief, evenness) = match self {
            Self::Grass => ("grass", 3.0, 0.105, 0.030, 0.8),
            Self::Meadow => ("meadow", 4.0, 0.130, 0.028, 0.7),
            Self::ForestFloor => ("forest_floor", 3.0, 0.085, 0.028, 0.8),
            Self::Moss => ("moss", 2.0, 0.100, 0.045, 0.7),
            Self::Soil => ("soil", 3.0, 0.110, 0.035, 0.8),
            Self::CrackedEarth => ("cracked_earth", 4.0, 0.260, 0.030, 0.8),
            Self::Mud => ("mud", 4.0, 0.085, 0.035, 0.7),
            Self::Sand => ("sand", 4.0, 0.330, 0.015, 0.7),
            Self::Gravel => ("gravel", 2.0, 0.220, 0.045, 0.85),
            Self::Scree => ("scree", 5.0, 0.230, 0.070, 0.85),
            Self::Rock => ("rock", 8.0, 0.240, 0.080, 0.7),
            Self::Cliff => ("cliff", 12.0, 0.230, 0.080, 0.6),
            Self::Basalt => ("basalt", 6.0, 0.055, 0.070, 0.75),
            Self::Snow => ("snow", 6.0, 0.820, 0.016, 0.7),
            Self::Ice => ("ice", 8.0, 0.560, 0.020, 0.7),
        };
        Traits { name, tile_m, luminance, relief, evenness }
    }

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.traits().name
    }

    /// The surface of a name.
    ///
    /// # Errors
    /// [`Error::UnknownSurface`], with the names that there are.
    pub fn from_name(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|surface| surface.name() == name).ok_or_else(|| Error::UnknownSurface {
            name: name.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }

    /// The size that it is meant to be seen at: metres of one tile.
    #[must_use]
    pub const fn tile_m(self) -> f32 {
        self.traits().tile_m
    }

    /// The mean luminance of its albedo without a tint: linear, 0..1.
    #[must_use]
    pub const fn luminance(self) -> f32 {
        self.traits().luminance
    }

    /// The height of its relief in widths of a tile: from height 0 in a texture to height 1. Normals show this relief.
    #[must_use]
    pub const fn relief(self) -> f32 {
        self.traits().relief
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files() {
        for surface in Surface::ALL {
            assert_eq!(Surface::from_name(surface.name()).unwrap(), surface);
            assert_eq!(serde_json::to_value(surface).unwrap(), surface.name());
        }
        let err = Surface::from_name("lawn").unwrap_err().to_string();
        assert!(err.contains("lawn") && err.contains("forest_floor"), "{err}");
    }
}
