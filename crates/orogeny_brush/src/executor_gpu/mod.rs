//! The GPU back end: tiles of pages, in place, in texture arrays.
//!
//! A step makes up to [`STEP_BYTES`] of pages resident (what has to make room is read back by copies that are only collected
//! when they arrive), dispatches one workgroup a tile, and submits. Pages are uploaded by commands of the same submission, so
//! that everything happens in the order in which it is written here.

mod goals;
mod levels;
mod planes;
mod resident;
mod uniforms;
mod weights;

use std::collections::BTreeSet;
use std::sync::Arc;

use orogeny_field::{Bitmap, FieldId, Page, PageKey, PageLayout, SampleRect, TerrainGrid, WeightMode};
use orogeny_gpu::{Gpu, ReadBack, ReadbackBelt};
use orogeny_pages::{AtlasLimits, PageStore, Slot};

use crate::execute::{Executor, Levels, Notices, PageMemory, Watch};
use crate::filter::region::Regions;
use crate::kernels::{OwnData, Rule, noise};
use crate::plan::{Batch, PageWork, Pass};
use crate::tiles::{PageLayers, TileList};
use crate::{Error, Result};
use planes::{GpuPlane, GpuPlanes};
use resident::{Gates, Heights, Resident, Scratch, bitmap_view};

pub use uniforms::BrushUniform;

/// Bytes of pages made resident at once: bounds the memory of uploads and readbacks in flight.
const STEP_BYTES: u64 = 16 << 20;
/// Instances of tiles after which a step is cut: at 1,024 samples each it then takes a weak GPU no longer than a driver waits.
const STEP_INDICES: usize = 256 << 10;
/// Operations of a kernel that [`STEP_INDICES`] is meant for.
const USUAL_OPERATIONS: u64 = 50;
/// Of what is cut into pages and is none.
const NO_FIELD: FieldId = FieldId(u32::MAX);
/// Pages a gated wash needs at once: its heights, its heights from before, its weights and its gate.
const SMALLEST_BUDGET_PAGES: u64 = 4;

/// How much texture memory a GPU executor may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GpuBudget {
    /// Bytes of all textures together; room for four pages is the least.
    pub budget_in_bytes: u64,
    /// Layers of one texture array, up to the device's limit.
    pub layers_per_array: u32,
}

/// Applies batches on a GPU.
#[derive(Debug)]
pub struct GpuExecutor {
    gpu: Gpu,
    layout: PageLayout,
    heights: Heights,
    scratch: Scratch,
    gates: Gates,
    planes: GpuPlanes,
    /// On the CPU: see [`crate::filter::RegionKernel`].
    regions: Regions,
    /// Pages that the running operation has changed: their heights are no longer those from before it.
    changed: BTreeSet<PageKey>,
    /// The alpha bitmap that was last used, and one of a single pixel where there is none.
    alpha: Option<(Arc<Bitmap>, wgpu::TextureView)>,
    no_alpha: wgpu::TextureView,
    belt: ReadbackBelt<ReadbackTag>,
    counters: wgpu::Buffer,
    /// The last step that was submitted.
    last_step: Option<wgpu::SubmissionIndex>,
}

/// What all tiles of a batch share.
#[derive(Debug)]
struct Shared {
    uniform: wgpu::Buffer,
    curves: wgpu::Buffer,
    instances: wgpu::Buffer,
    own_buffers: Vec<wgpu::Buffer>,
    constants: Vec<(&'static str, u32)>,
}

/// The texture arrays that a dispatch works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Arrays {
    heights: u32,
    scratch: u32,
    gates: u32,
}

/// Instances of tiles after which a step is cut, by what a pass costs: a user's kernel may take many times as long as others.
fn max_indices(pass: &Pass) -> usize {
    match &pass.rule {
        Rule::Custom(rule) => {
            let times = rule.num_operations() / USUAL_OPERATIONS;
            STEP_INDICES / usize::try_from(times.max(1)).unwrap_or(usize::MAX)
        }
        _ => STEP_INDICES,
    }
}

fn constants(batch: &Batch, own: &OwnData) -> Vec<(&'static str, u32)> {
    uniforms::constants(batch).chain(own.constants.iter().copied()).collect()
}

/// The tiles of a dispatch: a kernel asks for their number, so the binding ends with the last one.
fn tiles_binding<'a>(buffer: &'a wgpu::Buffer, list: &TileList) -> wgpu::BindingResource<'a> {
    let size = wgpu::BufferSize::new(size_of_val(list.tiles.as_slice()) as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

/// One workgroup a tile, in as many columns as there may be; there is a tile at least.
fn workgroups(gpu: &Gpu, list: &TileList) -> [u32; 2] {
    let num_tiles = list.tiles.len() as u32;
    let columns = num_tiles.min(gpu.device().limits().max_compute_workgroups_per_dimension);
    [columns, num_tiles.div_ceil(columns)]
}

/// What a page on its way back is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReadbackTag {
    Heights(PageKey),
    Weights(PageKey),
}

impl GpuExecutor {
    /// An executor on a device.
    ///
    /// # Errors
    /// [`orogeny_pages::Error::Budget`] for a budget under four pages; [`Error::Gpu`] when the device fails.
    pub fn new(gpu: Gpu, layout: PageLayout, budget: GpuBudget) -> Result<Self> {
        let num_pages = budget.budget_in_bytes / layout.size_in_bytes();
        if num_pages < SMALLEST_BUDGET_PAGES {
            let budget_in_bytes = budget.budget_in_bytes;
            let needed = SMALLEST_BUDGET_PAGES;
            return Err(orogeny_pages::Error::Budget { budget_in_bytes, num_pages, needed }.into());
        }
        // A quarter each for the heights from before and the weights of a wash, an eighth for gates, the rest for heights.
        let limits = |num_pages: u64| AtlasLimits {
            budget_in_bytes: num_pages * layout.size_in_bytes(),
            layers_per_array: budget.layers_per_array,
        };
        let num_gates = (num_pages / 8).max(1);
        let heights = Heights::new(&gpu, layout, limits(num_pages - 2 * (num_pages / 4) - num_gates))?;
        let scratch = Scratch::new(&gpu, layout, limits(num_pages / 4))?;
        let gates = Gates::new(&gpu, layout, limits(num_gates))?;
        let no_alpha = bitmap_view(&gpu, &Bitmap::new(1, 1, vec![1.0])?)?;
        let counters = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("orogeny.brush.counters"),
            size: uniforms::COUNTERS_SIZE_IN_BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })?;
        Ok(Self {
            layout,
            heights,
            scratch,
            gates,
            planes: GpuPlanes::default(),
            regions: Regions::default(),
            changed: BTreeSet::new(),
            alpha: None,
            no_alpha,
            belt: ReadbackBelt::new(gpu.clone(), layout.size()),
            counters,
            last_step: None,
            gpu,
        })
    }

    /// The device it works on.
    #[must_use]
    pub const fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Bytes of the textures made so far.
    #[must_use]
    pub fn texture_size_in_bytes(&self) -> u64 {
        let atlases =
            self.heights.size_in_bytes() + self.scratch.size_in_bytes() + self.gates.size_in_bytes();
        atlases + self.planes.size_in_bytes()
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu
            .device()
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("orogeny.brush.step") })
    }

    fn step_pages(&self) -> usize {
        usize::try_from(STEP_BYTES / self.layout.size_in_bytes()).unwrap_or(usize::MAX).max(1)
    }

    /// Submits a step once the one before the last is done, so that no more than two are ever under way.
    fn submit(&mut self, encoder: wgpu::CommandEncoder) -> Result<()> {
        let submitted = self.gpu.queue().submit([encoder.finish()]);
        self.belt.after_submit();
        match self.last_step.replace(submitted) {
            Some(before) => Ok(self.gpu.wait_for(before)?),
            None => Ok(()),
        }
    }

    /// Applies a batch to some of its pages, step by step; `goal` is what a filter made of the ground there.
    fn apply(
        &mut self,
        batch: &Batch,
        works: &[PageWork],
        shared: &Shared,
        goal: Option<&GpuPlane>,
        store: &mut dyn PageStore,
    ) -> Result<()> {
        let mut rest = works;
        while !rest.is_empty() {
            // Asked anew for each step: texture memory may turn out to be short. With no room at all a step fails.
            let num_pages = self.step_pages().min(self.num_slots(&batch.pass)).max(1);
            let step = rest.get(..num_pages).unwrap_or(rest);
            let num_taken = self.step(batch, step, shared, goal, store)?;
            rest = rest.get(num_taken..).unwrap_or_default();
        }
        Ok(())
    }

    /// One step: makes its pages resident and dispatches its tiles. Gives back how many of the works it took: none of them
    /// where texture memory turned out to be short and the step is to be tried again with less.
    fn step(
        &mut self,
        batch: &Batch,
        works: &[PageWork],
        shared: &Shared,
        goal: Option<&GpuPlane>,
        store: &mut dyn PageStore,
    ) -> Result<usize> {
        let is_wash = batch.pass.weight_mode() == WeightMode::Wash;
        let has_scratch = is_wash || batch.pass.roughness.is_some();
        let keys: Vec<_> = works.iter().map(|work| work.key).collect();
        self.await_pages(&keys, store)?;
        let mut encoder = self.encoder();
        let mut resident =
            self.heights.make_resident(&self.gpu, &mut encoder, &mut self.belt, works, store)?;
        if is_wash && matches!(resident, Resident::All) {
            resident = self.scratch.make_resident(&self.gpu, &mut encoder, &mut self.belt, works, store)?;
        }
        if let (Some(roughness), Resident::All) = (&batch.pass.roughness, &resident) {
            resident = self.scratch.make_rough(&self.gpu, &mut encoder, works, roughness, store)?;
        }
        if let (Some(gate), Resident::All) = (&batch.pass.gate, &resident) {
            resident = self.gates.make_resident(&self.gpu, &mut encoder, works, gate, store)?;
        }
        if let Resident::TextureMemoryShort(err) = resident {
            self.submit(encoder)?;
            return self.make_do(err);
        }
        let mut lists = std::collections::BTreeMap::<Arrays, TileList>::new();
        let mut num_indices = 0;
        let mut num_taken = 0;
        for work in works {
            if num_indices > max_indices(&batch.pass) {
                break;
            }
            num_taken += 1;
            let Some(slot) = self.heights.slot(&work.key) else { continue };
            let nowhere = Slot { array: 0, layer: 0 };
            let scratch_slot = self.scratch.slot(&work.key).filter(|_| has_scratch).unwrap_or(nowhere);
            let gate_slot =
                batch.pass.gate.as_ref().and_then(|_| self.gates.slot(&work.key)).unwrap_or(nowhere);
            let arrays = Arrays { heights: slot.array, scratch: scratch_slot.array, gates: gate_slot.array };
            let list = lists.entry(arrays).or_default();
            let before = list.indices.len();
            let layers =
                PageLayers { heights: slot.layer, scratch: scratch_slot.layer, gate: gate_slot.layer };
            list.add_page(batch, work, self.layout, layers);
            num_indices += list.indices.len() - before;
            self.heights.mark_dirty(&work.key);
            self.changed.insert(work.key);
        }
        for (arrays, list) in lists {
            if !list.tiles.is_empty() {
                self.dispatch(&mut encoder, batch, shared, arrays, list, goal)?;
            }
        }
        self.submit(encoder)?;
        let arrived = if self.belt.num_under_way() > self.step_pages() {
            self.belt.collect_all()
        } else {
            self.belt.collect_arrived()
        };
        self.keep(arrived?, store)?;
        Ok(num_taken)
    }

    /// Waits for pages, in order, that are still on their way out of the atlas.
    fn await_pages(&mut self, keys: &[PageKey], store: &mut dyn PageStore) -> Result<()> {
        let is_needed = |tag: &ReadbackTag| {
            let (ReadbackTag::Heights(key) | ReadbackTag::Weights(key)) = tag;
            keys.binary_search(key).is_ok()
        };
        if self.belt.is_under_way(is_needed) {
            let arrived = self.belt.collect_all()?;
            self.keep(arrived, store)?;
        }
        Ok(())
    }

    /// Keeps what has come back: heights in the store, weights of a wash aside.
    fn keep(&mut self, arrived: Vec<ReadBack<ReadbackTag>>, store: &mut dyn PageStore) -> Result<()> {
        let mut heights = Vec::new();
        for ReadBack { tag, samples } in arrived {
            let page = Page::from_samples(self.layout, samples)?;
            match tag {
                ReadbackTag::Heights(key) => heights.push((key, page)),
                ReadbackTag::Weights(key) => self.scratch.keep_weights(key, &page)?,
            }
        }
        if heights.is_empty() {
            return Ok(());
        }
        store.save(heights).map_err(|err| orogeny_pages::Error::Source(err).into())
    }

    /// Uploads a picture, unless it is the one that was last used.
    fn use_alpha(&mut self, bitmap: Option<&Arc<Bitmap>>) -> Result<()> {
        if let Some(bitmap) = bitmap
            && !self.alpha.as_ref().is_some_and(|(known, _)| Arc::ptr_eq(known, bitmap))
        {
            self.alpha = Some((Arc::clone(bitmap), bitmap_view(&self.gpu, bitmap)?));
        }
        Ok(())
    }

    /// The picture that was last used, or one of a single pixel where there is none.
    fn alpha_view(&self, bitmap: Option<&Arc<Bitmap>>) -> &wgpu::TextureView {
        match &self.alpha {
            Some((_, view)) if bitmap.is_some() => view,
            _ => &self.no_alpha,
        }
    }

    /// Uploads what all tiles of a batch share.
    fn share(&mut self, batch: &Batch) -> Result<Shared> {
        let storage = wgpu::BufferUsages::STORAGE;
        let own = uniforms::own_data(batch);
        self.use_alpha(batch.pass.bitmap())?;
        let uniform = BrushUniform::from(&batch.pass);
        let usage = wgpu::BufferUsages::UNIFORM;
        let own_buffers = uniforms::own_buffers(&self.gpu, &own)?;
        Ok(Shared {
            uniform: self.gpu.create_buffer_with(
                "orogeny.brush.uniform",
                usage,
                bytemuck::bytes_of(&uniform),
            )?,
            curves: self.gpu.create_buffer_with(
                "orogeny.brush.curves",
                storage,
                bytemuck::cast_slice(&uniforms::curves(&batch.pass)),
            )?,
            instances: self.gpu.create_buffer_with(
                "orogeny.brush.instances",
                storage,
                bytemuck::cast_slice(&batch.instances),
            )?,
            own_buffers,
            constants: constants(batch, &own),
        })
    }

    fn dispatch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        batch: &Batch,
        shared: &Shared,
        arrays: Arrays,
        mut list: TileList,
        goal: Option<&GpuPlane>,
    ) -> Result<()> {
        let stem = batch.pass.rule.stage().stem();
        let kernel = match &batch.pass.rule {
            Rule::Custom(rule) => {
                let program = &rule.program;
                self.gpu.kernel_of(&program.brush.shader, &program.identity, &shared.constants)?
            }
            _ => self.gpu.kernel(stem, &shared.constants)?,
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let lattice = match &batch.pass.rule {
            Rule::Noise(kernel) => {
                let lattice = noise::lattice(kernel, &mut list.tiles);
                let bytes = bytemuck::cast_slice(&lattice);
                Some(self.gpu.create_buffer_with("orogeny.brush.lattice", storage, bytes)?)
            }
            _ => None,
        };
        let goal_place = match goal {
            Some(goal) => {
                let usage = wgpu::BufferUsages::UNIFORM;
                let place = goal.uniform();
                Some(self.gpu.create_buffer_with("orogeny.brush.goal", usage, bytemuck::bytes_of(&place))?)
            }
            None => None,
        };
        let tiles =
            self.gpu.create_buffer_with("orogeny.brush.tiles", storage, bytemuck::cast_slice(&list.tiles))?;
        let indices = self.gpu.create_buffer_with(
            "orogeny.brush.indices",
            storage,
            bytemuck::cast_slice(&list.indices),
        )?;
        // A page that has a slot has its texture.
        let Some(heights) = self.heights.view(arrays.heights) else { return Ok(()) };
        let (before, weights) = self.scratch.views(arrays.scratch);
        let alpha = self.alpha_view(batch.pass.bitmap());
        let mut resources = vec![
            shared.uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(alpha),
            shared.curves.as_entire_binding(),
            shared.instances.as_entire_binding(),
            tiles_binding(&tiles, &list),
            indices.as_entire_binding(),
            self.counters.as_entire_binding(),
            wgpu::BindingResource::TextureView(heights),
            wgpu::BindingResource::TextureView(before),
            wgpu::BindingResource::TextureView(weights),
            wgpu::BindingResource::TextureView(self.gates.view(arrays.gates)),
        ];
        let goal = goal_place.iter().chain(goal.map(|goal| &goal.buffer));
        let own = shared.own_buffers.iter().chain(&lattice).chain(goal);
        resources.extend(own.map(wgpu::Buffer::as_entire_binding));
        kernel.record(&self.gpu, encoder, stem, resources, workgroups(&self.gpu, &list));
        Ok(())
    }

    fn num_slots(&self, pass: &Pass) -> usize {
        let has_scratch = pass.weight_mode() == WeightMode::Wash || pass.roughness.is_some();
        let scratch = if has_scratch { self.scratch.num_slots() } else { usize::MAX };
        let gates = if pass.gate.is_some() { self.gates.num_slots() } else { usize::MAX };
        self.heights.num_slots().min(scratch).min(gates)
    }

    /// Out of texture memory, the budget shrinks to what there is, and the step is to be tried again from its start: 0 of
    /// its works are done.
    ///
    /// # Errors
    /// `err` where that leaves no room at all.
    fn make_do(&mut self, err: orogeny_pages::Error) -> Result<usize> {
        let has_shrunk = self.heights.shrink_to_existing()
            | self.scratch.shrink_to_existing()
            | self.gates.shrink_to_existing();
        if has_shrunk && self.heights.num_slots() > 0 { Ok(0) } else { Err(err.into()) }
    }

    /// Reads and clears the counter of clamped heights.
    fn take_num_clamped(&mut self) -> Result<u64> {
        let size = uniforms::COUNTERS_SIZE_IN_BYTES;
        let buffer = self.gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("orogeny.brush.counters.readback"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })?;
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(&self.counters, 0, &buffer, 0, size);
        encoder.clear_buffer(&self.counters, 0, None);
        self.submit(encoder)?;
        let mapped = self.gpu.read_buffer(&buffer)?;
        Ok(mapped.first().copied().map_or(0, u64::from))
    }
}

impl Executor for GpuExecutor {
    fn description(&self) -> String {
        format!("GPU, {}", self.gpu.description())
    }

    fn run_watched(&mut self, batch: &Batch, store: &mut dyn PageStore, watch: Watch<'_>) -> Result<()> {
        let (expected, actual) = (self.layout.size(), store.layout().size());
        if expected != actual {
            return Err(Error::PageSize { expected, actual });
        }
        if batch.pages.is_empty() {
            return Ok(());
        }
        let shared = self.share(batch)?;
        match &batch.pass.rule {
            Rule::Filter(filter) => self.run_filter(filter, batch, &shared, store, watch),
            _ => self.apply(batch, &batch.pages, &shared, None, store),
        }
    }

    fn save(&mut self, store: &mut dyn PageStore) -> Result<()> {
        let arrived = self.belt.collect_all()?;
        self.keep(arrived, store)?;
        for pages in self.heights.take_dirty().chunks(self.step_pages()) {
            let mut encoder = self.encoder();
            for (key, slot) in pages {
                self.heights.schedule_readback(&mut encoder, &mut self.belt, *key, *slot)?;
            }
            self.submit(encoder)?;
            let arrived = self.belt.collect_all()?;
            self.keep(arrived, store)?;
        }
        Ok(())
    }

    fn finish(&mut self, store: &mut dyn PageStore) -> Result<Notices> {
        self.save(store)?;
        self.scratch.forget_all();
        self.gates.forget_all();
        self.planes.clear();
        self.regions.clear();
        self.changed.clear();
        let num_clamped_heights = self.take_num_clamped()?;
        self.gpu.check()?;
        Ok(Notices { num_clamped_heights })
    }

    fn cancel(&mut self) {
        self.belt.forget_all();
        self.scratch.forget_all();
        self.gates.forget_all();
        self.heights.forget_all();
        self.planes.clear();
        self.regions.clear();
        self.changed.clear();
        // Not waited for: the device may be gone, which the next operation sees.
        let mut encoder = self.encoder();
        encoder.clear_buffer(&self.counters, 0, None);
        self.gpu.queue().submit([encoder.finish()]);
    }

    fn forget(&mut self, keys: &[PageKey]) {
        for key in keys {
            self.heights.forget(key);
        }
    }

    fn device(&self) -> Option<&Gpu> {
        Some(&self.gpu)
    }

    fn levels(
        &mut self,
        field: FieldId,
        grid: &TerrainGrid,
        wanted: &[SampleRect],
        store: &mut dyn PageStore,
    ) -> Result<Option<Levels>> {
        match self.work_out_levels(field, grid, wanted, store) {
            // Whoever looks can do without.
            Err(Error::Gpu(orogeny_gpu::Error::OutOfMemory { .. })) => {
                self.planes.clear();
                Ok(None)
            }
            levels => levels,
        }
    }

    fn memory(&self) -> PageMemory {
        PageMemory { host_in_bytes: 0, textures_in_bytes: self.texture_size_in_bytes() }
    }
}
