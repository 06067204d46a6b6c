//! The vocabulary of Orogeny: what a terrain, a page, a stroke and a brush *are*, with no GPU and no input or output.
//!
//! Everything above this crate speaks in these types. Three spaces occur, and names say which one is meant:
//!
//! - **world**: metres, `x` to the east along the columns, `z` along the rows; row 0 is the north edge.
//! - **sample**: `i = x / spacing`, `j = z / spacing`; integers name samples, fractions lie between them.
//! - **page**: sample coordinates divided by the page size, rounded down.
//!
//! Positions are `f64` or integers until a kernel gets them: a terrain may have 2^20 samples a side, and one `f32`
//! cannot name a place on it.
//!
//! ```
//! use orogeny_field::{PageLayout, TerrainGrid};
//!
//! let grid = TerrainGrid::new(4096, 4096, 0.5)?;
//! let layout = PageLayout::default();
//! let touched = grid.samples_in_region([100.0, 100.0, 20.0, 20.0])?;
//! assert_eq!(layout.pages_in(touched).count(), 1);
//! # Ok::<(), orogeny_field::Error>(())
//! ```

mod bitmap;
mod brush;
mod curve;
mod drainage;
mod erosion;
mod error;
mod filter;
mod grab;
mod grid;
pub mod hash;
mod height;
mod instance;
mod layer;
mod level;
mod mirrors;
pub mod noise;
mod page;
mod placement;
mod plane;
mod rect;
mod selecting;
mod stroke;

pub use bitmap::{Bitmap, MAX_BITMAP_SIDE};
pub use brush::{
    Alignment, Alpha, AlphaRotation, AspectGate, Band, Blending, Brush, BrushType, CloneBlend, CloneSource,
    Cloning, Coverage, Custom, DataSource, Dynamics, Falloff, FalloffFormula, Gate, GateImage, HeightRange,
    Jitter, LayerReference, LedgeDirection, LevelOnly, MAX_PYRAMID_LEVELS, NoiseGate, PARAMETERS, Parameter,
    ParameterKind, PressureTarget, Profile, ProfileShape, RampAlong, RangeFormula, RangeMap, RangeMapping,
    SmoothMethod, Smoothing, Stamp, StampMode, Symmetry, SymmetryKind, Terrace, TerraceSteps,
};
pub use curve::{CURVE_TABLE_LENGTH, Curve, CurveTable, MAX_CURVE_POINTS};
pub use drainage::{FillPits, FlowMask, FlowRouting, RainMask, RainShows};
pub use erosion::{
    DISC_LANES, DROPLET_BUDGET, DROPLETS_PER_ROUND, DiscPart, DropletKernel, Droplets, MAX_DROPLET_RADIUS,
    MAX_DROPLET_STEPS, MAX_EROSION_ITERATIONS, MAX_ROCK_LAYERS, MAX_TALUS_ANGLE_DEG, MAX_THERMAL_RATE, Pipes,
    PipesKernel, RockLayer, SAMPLES_PER_DROPLET, Thermal, ThermalKernel, ThermalLayer,
};
pub use error::{Error, Result};
pub use filter::{PYRAMID_PHASES, PYRAMID_WEIGHTS, PhaseWeights, b_spline_phases, gaussian_weights};
pub use grab::{Drag, GrabKernel};
pub use grid::{MAX_SIDE_SAMPLES, MAX_SPACING_M, MIN_SPACING_M, TerrainGrid};
pub use height::{MAX_HEIGHT_M, check_height, is_storable_height, sanitized_height};
pub use instance::{Footprint, Instance, WeightMode};
pub use layer::{
    Blend, LAYER_PYRAMID_LEVELS, LayerContent, LayerTransform, MAX_MASK_TERMS, MaskCombine, MaskSource,
    MaskTerm, Procedure,
};
pub use level::{HeightBounds, MIN_ERROR_GROWTH, rect_above, rect_below};
pub use mirrors::{Mirrors, mirrored};
pub use page::{DEFAULT_PAGE_SIZE, FieldId, Page, PageKey, PageLayout};
pub use placement::{Part, Place, Placement, Placing};
pub use plane::Plane;
pub use rect::SampleRect;
pub use selecting::{
    MAX_FEATHER_SAMPLES, MAX_GROW_SAMPLES, MAX_LASSO_POINTS, SelectCombine, SelectLengths, SelectShape,
    Selecting,
};
pub use stroke::{MAX_COORDINATE_SAMPLES, MAX_STROKE_POINTS, PointerSample, Stroke};
