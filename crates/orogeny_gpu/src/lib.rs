//! The GPU as Orogeny uses it: one device with its loss seen, kernels built from the embedded shaders, and copies that never
//! block a frame.
//!
//! - [`list_adapters`], [`AdapterChoice`]: what there is, and which of it to take.
//! - [`Gpu`]: device and queue, with every error and the loss of the device recorded; [`Gpu::check`] is asked before
//!   anything is called done, since wgpu reports nothing once a device is gone.
//! - [`Gpu::kernel`]: compute pipelines by stem and constants, built once for a device. Bind group layouts come from the shader's reflection.
//! - [`Gpu::drawing`]: render pipelines, laid out the same way from both of their stages.
//! - [`ReadbackBelt`]: texture layers on their way back to memory.
//! - [`DevicePlane`]: samples that one who works on the device leaves there for another.
//!
//! Limits: only WebGPU's default limits and no optional features are asked for.

mod adapter;
mod context;
mod drawing;
mod error;
mod kernel;
mod plane;
mod readback;

pub use adapter::{AdapterChoice, AdapterDescription, list_adapters, new_instance};
pub use context::Gpu;
pub use drawing::{Drawing, DrawingRequest};
pub use error::{Error, Result};
pub use kernel::Kernel;
pub use plane::DevicePlane;
pub use readback::{ReadBack, ReadbackBelt};
