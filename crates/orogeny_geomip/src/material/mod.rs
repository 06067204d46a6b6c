//! What ground looks like: sets of materials, where each of them lies, and the surfaces that they show.
//!
//! A [`MaterialSet`] is a JSON file of layers. [`MaterialSet::resolved`] turns it, for one terrain, into a [`LayerRule`] for each layer: numbers
//! alone, as a GPU takes them. [`weights`] is the truth of how much each layer shows at a place; a shader must agree with it.
//! [`SurfaceTexture`] works out what a [`Surface`] looks like. Nothing here reads files or knows of a GPU.

mod factory;
mod layer;
mod noise;
mod read;
mod resolve;
mod rule;
mod set;
mod surface;
mod weights;

pub use factory::{DEFAULT_FACTORY_SET, factory_set, factory_sets};
pub use layer::{LayerNoise, LayerSurface, MaterialLayer, ProceduralSurface, SurfaceFiles};
pub use noise::layer_noise;
pub use resolve::ResolvedSet;
pub use rule::{LayerRule, NO_MASK, SetRule};
pub use set::{MAX_LAYERS, MacroVariation, MaterialSet};
pub use surface::{MAX_SURFACE_SIZE, MIN_SURFACE_SIZE, SURFACE_SIZE, Surface, SurfaceTexture};
pub use weights::{Ground, LayerInput, weights};
