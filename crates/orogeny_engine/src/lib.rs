//! The terrain as a document: open it, run operations on it, undo them, read it, export it, draw a map of it.
//!
//! This is what the fronts (command line, and later the editor and the service) talk to; they see no other crate. A
//! [`Terrain`] is one file. An [`Operation`] is one JSON object, the same in a recipe, in the history and in a replay. An
//! operation is done when its transaction is on disk, not before; until then an error, a cancel or a crash leaves the terrain
//! as it was.
//!
//! ```
//! use orogeny_engine::{Adapter, Operation, Quiet, Settings, Terrain, TerrainGrid};
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("hill.orogeny");
//! let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
//! let mut terrain = Terrain::create(&path, TerrainGrid::new(512, 512, 2.0)?, 100.0, settings)?;
//! let hill = Operation::from_json_text(
//!     r#"{"op": "stroke", "brush": {"type": "raise", "radius": 200, "strength": 80}, "points": [[512, 512]]}"#,
//! )?;
//! terrain.apply(&[hill], &mut Quiet)?;
//! assert_eq!(terrain.height_m([512.0, 512.0])?, 180.0);
//! terrain.undo(1)?;
//! assert_eq!(terrain.height_m([512.0, 512.0])?, 100.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod access;
mod apply;
mod backend;
mod brushes;
mod clone_source;
mod composite;
mod custom;
mod description;
mod error;
mod export;
mod fit;
mod ground;
mod hand;
mod history;
mod import;
mod layers;
mod map;
mod operation;
mod pages;
mod palette;
mod picture;
pub mod presets;
mod preview;
mod progress;
mod recorded;
mod relief;
mod replay;
mod resources;
mod seen;
mod select;
pub mod session;
#[cfg(test)]
mod stub_executor;
mod take_back;
mod terrain;
mod view;
mod whole_file;

pub use apply::Applied;
pub use backend::{Adapter, Settings, backend_description};
pub use brushes::{BrushDescription, ProfileRipple, brush_descriptions, brush_schema};
pub use custom::{CustomBrushFile, CustomParameter};
pub use description::{Description, HeightStatistics, LayerDescription, MemoryUse};
pub use error::{Error, Result};
pub use export::{ExportRequest, ExportSource, ExportSummary};
pub use fit::{ExportSize, Fit};
pub use import::{ImportRequest, ImportSummary};
pub use map::{MapRequest, MapSummary};
pub use operation::{
    AddLayer, BrushOperation, CollapseLayer, DuplicateLayer, LayerOperation, MaskFrom, MoveLayer, Operation,
    Recipe, RefreshLayer, RemoveLayer, SetLayer, SetMask, Target,
};
pub use orogeny_field::{
    Blend, BrushType, Coverage, Curve, LayerContent, LayerReference, LayerTransform, MAX_CURVE_POINTS,
    MaskTerm, PageKey, Parameter, ParameterKind, PointerSample, Procedure, SampleRect, SelectCombine,
    SelectShape, Selecting, TerrainGrid,
};
pub use orogeny_formats::{
    ByteOrder, Direction, ExportOptions, Flip, Format, ImportOptions, MAX_SAMPLES_PER_SIDE, NodataPolicy,
    SampleType,
};
pub use orogeny_geomip::{Camera, Cursor, FrameReport, Metric, Mode, PagePlace, PageSummary};
pub use orogeny_gpu::{AdapterDescription, Gpu, list_adapters};
pub use orogeny_store::{
    Change, CheckReport, Direction as HistoryDirection, Dropped, Entry, EntryId, EntryState, HistorySummary,
    Layer, Repaired, Salvaged,
};
pub use picture::Picture;
pub use presets::{Preset, Presets};
pub use preview::ImportPreview;
pub use progress::{Observer, Progress, Quiet};
pub use replay::Replayed;
pub use take_back::Redone;
pub use terrain::Terrain;
pub use view::{
    Drawn, Flight, HeightAt, LiveView, MaterialDescription, Materials, Place, View, ViewRequest, WindowGpu,
    drawing_gpu, material_descriptions, window_gpu,
};
