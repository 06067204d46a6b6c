//! From a hand's movement to changed pages.
//!
//! The way of a stroke: pointer samples → [`StrokeSampler`] (a curve, and places at equal distances along it) →
//! [`StrokePlanner`] (instances with their strength, the pages and rectangles that they touch, batches) → [`Pass`] and
//! [`Batch`] as plain data → an [`Executor`]: [`CpuExecutor`] or [`GpuExecutor`]. Everything before the executors is pure
//! and is tested without a GPU.
//!
//! How a stroke is cut into batches, pages, tiles and threads changes no bit of the result on one executor: instances act on
//! a sample one after another in stroke order, and a wash keeps a largest weight, which has no order.

mod canvas;
mod curve;
mod dynamics;
mod error;
mod execute;
mod executor_cpu;
mod executor_gpu;
pub mod filter;
mod frames;
mod gate;

pub mod kernels;
mod pattern;
mod plan;
mod planner;
mod resolved;
mod sampler;
mod spacing;
mod spill;
mod symmetry;
mod tiles;

pub use canvas::{Canvas, Resources};
pub use curve::CurveSegment;
pub use error::{Error, Result};
pub use execute::{Executor, Levels, Notices, PageMemory, Watch};
pub use executor_cpu::CpuExecutor;
pub use executor_gpu::{BrushUniform, GpuBudget, GpuExecutor};
pub use filter::CloneGround;

pub use gate::GatePlan;
pub use kernels::custom::{CustomProgram, CustomRule};
pub use kernels::{Rule, Stage};
pub use plan::{Batch, PageWork, Pass};
pub use planner::{MAX_PAGES, StrokePlanner, plan_fill};
pub use resolved::{resolve_gate, resolved};
pub use sampler::{Pen, PlacedSample, StrokeSampler};
pub use spacing::Spacing;
pub use spill::Spill;
pub use symmetry::copies;
pub use tiles::Tile;
