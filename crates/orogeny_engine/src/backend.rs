//! Which back end does the work.

use orogeny_brush::{CpuExecutor, Executor, GpuBudget, GpuExecutor};
use orogeny_field::PageLayout;
use orogeny_gpu::{AdapterChoice, Gpu};

use crate::Result;
use crate::access::Shares;

/// Bytes of pages that stay resident, unless the caller says otherwise.
const DEFAULT_PAGE_BUDGET_IN_BYTES: u64 = 1 << 30;
/// Pages that working out a layer's brush may take, however small the budget is.
const MIN_COMPOSITE_PAGES: u64 = 16;
/// Layers of one texture array: 64 MiB of pages, so that little is allocated in vain.
const LAYERS_PER_ARRAY: u32 = 256;

/// What calculates.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Adapter {
    /// A real GPU where there is one, else [`Self::Cpu`]. A software driver is never taken: native code is many times
    /// faster.
    #[default]
    Auto,
    /// Native code on all cores.
    Cpu,
    /// A software driver. Slow; for tests.
    Software,
    /// The first adapter whose name contains this.
    Named(String),
    /// The device that the terrain is drawn on: see [`Settings::sharing`].
    Of(Gpu),
}

impl Adapter {
    /// From what a user types: `auto`, `cpu`, `software`, or part of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        match name {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            "software" => Self::Software,
            name => Self::Named(name.to_owned()),
        }
    }

    /// The device that is drawn on, where that is it.
    pub(crate) const fn shared(&self) -> Option<&Gpu> {
        match self {
            Self::Of(gpu) => Some(gpu),
            _ => None,
        }
    }
}

/// How a terrain is worked on. Nothing of it is kept in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// What calculates.
    pub adapter: Adapter,
    /// Bytes of pages that stay resident, in memory or in textures.
    pub page_budget_in_bytes: u64,
    /// Threads of the CPU back end; `None`: one a core.
    pub num_threads: Option<usize>,
    /// Who does the work, for the history.
    pub author: String,
}

impl Settings {
    /// The same for a terrain that is drawn on this device: where brushes would work on one like it, they work on it, and what they make
    /// is drawn from where it lies.
    #[must_use]
    pub fn sharing(&self, gpu: &Gpu) -> Self {
        let is_shared = match &self.adapter {
            Adapter::Cpu => false,
            Adapter::Auto => !gpu.description().is_software,
            Adapter::Software | Adapter::Named(_) | Adapter::Of(_) => true,
        };
        let adapter = if is_shared { Adapter::Of(gpu.clone()) } else { self.adapter.clone() };
        Self { adapter, ..self.clone() }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            adapter: Adapter::Auto,
            page_budget_in_bytes: DEFAULT_PAGE_BUDGET_IN_BYTES,
            num_threads: None,
            author: String::new(),
        }
    }
}

/// What would do the work under these settings, for people; it is opened to be sure that it can.
///
/// # Errors
/// [`crate::Error::Gpu`] when the adapter asked for cannot be used, with what to do about it.
pub fn backend_description(settings: &Settings) -> Result<String> {
    Ok(executor(settings, PageLayout::default())?.description())
}

/// Makes the executor that the settings ask for.
pub(crate) fn executor(settings: &Settings, layout: PageLayout) -> Result<Box<dyn Executor>> {
    executor_within(Shares::of(settings.page_budget_in_bytes).executor_in_bytes, settings, layout)
}

/// Makes the executor that works out brushes of layers: beside the one that paints, whose stroke may look at them.
pub(crate) fn composite_executor(settings: &Settings, layout: PageLayout) -> Result<Box<dyn Executor>> {
    let budget_in_bytes = Shares::of(settings.page_budget_in_bytes).composite_in_bytes / 2;
    executor_within(budget_in_bytes.max(MIN_COMPOSITE_PAGES * layout.size_in_bytes()), settings, layout)
}

fn executor_within(
    budget_in_bytes: u64,
    settings: &Settings,
    layout: PageLayout,
) -> Result<Box<dyn Executor>> {
    let cpu = || -> Result<Box<dyn Executor>> {
        Ok(Box::new(CpuExecutor::new(layout, budget_in_bytes, settings.num_threads)?))
    };
    let on = |gpu: Gpu| -> Result<Box<dyn Executor>> {
        let budget = GpuBudget { budget_in_bytes, layers_per_array: LAYERS_PER_ARRAY };
        Ok(Box::new(GpuExecutor::new(gpu, layout, budget)?))
    };
    let gpu = |choice: AdapterChoice| on(Gpu::open(&choice)?);
    match &settings.adapter {
        Adapter::Cpu => cpu(),
        Adapter::Software => gpu(AdapterChoice::Software),
        Adapter::Named(name) => gpu(AdapterChoice::Named(name.clone())),
        // A lost one does not come back, and another is drawn on then; it is enough to work on one like it.
        Adapter::Of(shared) if shared.is_lost() => {
            gpu(AdapterChoice::Named(shared.description().name.clone()))
        }
        Adapter::Of(shared) => on(shared.clone()),
        Adapter::Auto => gpu(AdapterChoice::RealGpu).or_else(|err| {
            tracing::info!("the CPU back end is used: {err}");
            cpu()
        }),
    }
}
