//! Texture layers on their way back to memory.
//!
//! A copy is scheduled into an encoder, sent off after the submission, and collected later. Nothing waits unless it is asked
//! to. Rows need no padding: a page row is a multiple of 256 bytes.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::{Gpu, Result};

/// A square texture layer of `f32` that has arrived.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadBack<T> {
    /// What was scheduled with it.
    pub tag: T,
    /// Its samples, row by row.
    pub samples: Vec<f32>,
}

/// Copies under way, oldest first. `T` says what a copy is of.
#[derive(Debug)]
pub struct ReadbackBelt<T> {
    gpu: Gpu,
    side: u32,
    free: Vec<wgpu::Buffer>,
    scheduled: Vec<(T, wgpu::Buffer)>,
    under_way: VecDeque<UnderWay<T>>,
}

#[derive(Debug)]
struct UnderWay<T> {
    tag: T,
    buffer: wgpu::Buffer,
    /// [`WAITING`], [`MAPPED`] or [`FAILED`], set by the driver's callback.
    state: Arc<AtomicU8>,
}

const WAITING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

impl<T> ReadbackBelt<T> {
    /// A belt for layers of `side x side` samples, `side` a multiple of 64.
    #[must_use]
    pub const fn new(gpu: Gpu, side: u32) -> Self {
        Self { gpu, side, free: Vec::new(), scheduled: Vec::new(), under_way: VecDeque::new() }
    }

    /// Records the copy of one layer. What the texture holds when the encoder's commands run is what arrives.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`] when there is no memory for the copy.
    pub fn schedule(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
        layer: u32,
        tag: T,
    ) -> Result<()> {
        let buffer = match self.free.pop() {
            Some(buffer) => buffer,
            None => self.gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("orogeny.gpu.readback"),
                size: u64::from(self.side) * u64::from(self.side) * 4,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })?,
        };
        let source = wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.side * 4),
            rows_per_image: None,
        };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        let size = wgpu::Extent3d { width: self.side, height: self.side, depth_or_array_layers: 1 };
        encoder.copy_texture_to_buffer(source, target, size);
        self.scheduled.push((tag, buffer));
        Ok(())
    }

    /// Asks for what was scheduled. To be called once the encoder's commands are submitted.
    pub fn after_submit(&mut self) {
        for (tag, buffer) in self.scheduled.drain(..) {
            let state = Arc::new(AtomicU8::new(WAITING));
            let noted = Arc::clone(&state);
            buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
                noted.store(if mapped.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
            });
            self.under_way.push_back(UnderWay { tag, buffer, state });
        }
    }

    /// Copies not yet collected.
    #[must_use]
    pub fn num_under_way(&self) -> usize {
        self.scheduled.len() + self.under_way.len()
    }

    /// Whether a copy that fits is not yet collected.
    pub fn is_under_way(&self, mut fits: impl FnMut(&T) -> bool) -> bool {
        self.scheduled
            .iter()
            .map(|(tag, _)| tag)
            .chain(self.under_way.iter().map(|one| &one.tag))
            .any(&mut fits)
    }

    /// The copies that have arrived, oldest first, without waiting.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`] and everything else that [`Gpu::check`] finds.
    pub fn collect_arrived(&mut self) -> Result<Vec<ReadBack<T>>> {
        // The result of polling says only whether the queue is empty; what matters is in the callbacks and the check.
        let _ = self.gpu.device().poll(wgpu::PollType::Poll);
        self.gpu.check()?;
        self.collect()
    }

    /// All copies, oldest first, after waiting for them.
    ///
    /// # Errors
    /// As [`collect_arrived`](Self::collect_arrived), and [`crate::Error::Timeout`].
    pub fn collect_all(&mut self) -> Result<Vec<ReadBack<T>>> {
        if self.under_way.is_empty() {
            return Ok(Vec::new());
        }
        let has_arrived = |one: &UnderWay<T>| one.state.load(Ordering::Acquire) != WAITING;
        self.gpu.wait_until_told(|| self.under_way.iter().all(has_arrived))?;
        self.collect()
    }

    fn collect(&mut self) -> Result<Vec<ReadBack<T>>> {
        let mut arrived = Vec::new();
        while let Some(first) = self.under_way.pop_front() {
            match first.state.load(Ordering::Acquire) {
                WAITING => {
                    self.under_way.push_front(first);
                    break;
                }
                MAPPED => {}
                _ => return Err(self.gpu.unreachable()),
            }
            let samples = {
                let mapped = first.buffer.get_mapped_range(..).map_err(|_| self.gpu.unreachable())?;
                bytemuck::pod_collect_to_vec(&mapped)
            };
            first.buffer.unmap();
            self.free.push(first.buffer);
            arrived.push(ReadBack { tag: first.tag, samples });
        }
        Ok(arrived)
    }

    /// Drops what is under way, as after a cancelled operation.
    pub fn forget_all(&mut self) {
        self.scheduled.clear();
        self.under_way.clear();
    }
}
