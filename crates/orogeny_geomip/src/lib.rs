//! GeoMipMapping: which tiles of a terrain are drawn, and how finely; where a ray meets the ground.
//!
//! After de Boer, "Fast Terrain Rendering Using Geometrical MipMapping" (2000), over the levels of a plane
//! ([`orogeny_field::level`](orogeny_field)): a tile that is drawn coarsely reads a coarse level, so distant ground needs neither its full
//! resolution nor its vertices. Nothing here knows of pages, files or a GPU.
//!
//! # How finely: one number a tile
//!
//! A tile's *detail* is a level with a fraction: 2.25 is the surface of level 2, a quarter of the way to that of level 3. It follows from
//! the camera without a jump ([`DetailRule`]). A vertex of the surface of detail `k + f` that level `k + 1` has too is `f` of the way from its height
//! on the one to that on the other; any other is `f` of the way to the vertex at half its coordinates, rounded down. So all that
//! go when `f` reaches 1 then lie on one that stays, and nothing pops ([`DrawnTile::vertex_m`]).
//!
//! # No cracks: one rule
//!
//! A vertex on a tile's rim has the coarsest detail of all tiles that touch it there. The tiles then have the same vertices
//! along the rim, whatever their details: the finer tile's further ones fall together with their neighbours, and the
//! triangles between them have no area.
//!
//! # What the ground looks like
//!
//! [`material`]: sets of layers with rules of height, slope, curvature, noise and masks, and the surfaces that they show.
//!
//! # Axes
//!
//! x to the east, z to the south, y up, metres; sample `(0, 0)` is the origin. Right-handed.

mod camera;
mod culling;
mod detail;
mod error;
mod horizon;
mod lattice;
pub mod material;
mod page_place;
mod page_table;
mod picking;
mod relief;
mod renderer;
mod selection;
mod shadow;
mod sky;
mod streaming;
mod tile;

pub use camera::{Camera, MIN_NEAR_M};
pub use culling::{Bounds, Frustum};
pub use detail::{DetailRule, Metric, Relief};
pub use error::{Error, Result};
pub use horizon::above_horizon;
pub use lattice::{DrawnTile, RIM_PARTS, indices};
pub use page_place::PagePlace;
pub use page_table::{MAX_LEVELS, PageTable, TABLE_SIDE};
pub use picking::{Ground, Ray, pick};
pub use relief::{PageRelief, PageSummaries, PageSummary};
pub use renderer::{
    Cursor, Fog, FrameReport, FrameUniform, Light, MAX_CURSORS, MaterialUniform, Mode, Overlay, Renderer,
    Scene, Targets, TileInstance,
};
pub use selection::{select, with_rims};
pub use shadow::{Cascade, MAX_CASCADES, cascades};
pub use sky::{SKY_SIZE, Sky};
pub use streaming::{Holder, Slots, wanted_pages};
pub use tile::{MAX_COARSENING, TILE_CELLS, Tile};
