//! One device, with everything that goes wrong on it recorded.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::adapter::{AdapterChoice, AdapterDescription, choose, choose_for_surface, new_instance};
use crate::kernel::BuiltKernels;
use crate::{Error, Result};

/// How long the device may take for what was submitted before it counts as hung.
const TIMEOUT: Duration = Duration::from_secs(60);
/// How long another thread usually takes to tell on what it has heard.
const TELL_TIME: Duration = Duration::from_micros(50);

/// A device and its queue. Cheap to clone; all clones are the same device.
#[derive(Debug, Clone)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    description: AdapterDescription,
    troubles: Arc<Mutex<Troubles>>,
    timeout: Duration,
    kernels: Arc<Mutex<BuiltKernels>>,
}

/// What the driver said outside of any call that could have returned it.
#[derive(Debug, Default)]
struct Troubles {
    lost: Option<String>,
    errors: Vec<String>,
}

/// Whether it is the same device.
impl PartialEq for Gpu {
    fn eq(&self, other: &Self) -> bool {
        // Devices of two instances may have the same number.
        Arc::ptr_eq(&self.troubles, &other.troubles)
    }
}

impl Eq for Gpu {}

impl Gpu {
    /// Opens a device with WebGPU's default limits and no optional features.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when nothing fits the choice; [`Error::Unusable`] when the adapter has less than WebGPU's
    /// default limits or cannot read and write `R32Float` textures in kernels.
    pub fn open(choice: &AdapterChoice) -> Result<Self> {
        Self::of_adapter(&choose(choice, &new_instance())?)
    }

    /// Opens a device that can show what it draws in a window, whose surface was made by the same instance; the best one that fits the
    /// choice.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_for_surface(
        choice: &AdapterChoice,
        instance: &wgpu::Instance,
        surface: &wgpu::Surface<'_>,
    ) -> Result<(Self, wgpu::Adapter)> {
        let adapter = choose_for_surface(choice, instance, surface)?;
        Ok((Self::of_adapter(&adapter)?, adapter))
    }

    fn of_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        let description = AdapterDescription::new(&adapter.get_info());
        let unusable = |reason: String| Error::Unusable { adapter: description.name.clone(), reason };
        let read_write = wgpu::TextureFormatFeatureFlags::STORAGE_READ_WRITE;
        if !adapter.get_texture_format_features(wgpu::TextureFormat::R32Float).flags.contains(read_write) {
            return Err(unusable("kernels cannot read and write R32Float textures on it".to_owned()));
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("orogeny.device"),
            required_features: wgpu::Features::empty(),
            required_limits: wgpu::Limits::defaults(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|err| unusable(format!("it gives no device with WebGPU's default limits: {err}")))?;
        let troubles = Arc::new(Mutex::new(Troubles::default()));
        let noted = Arc::clone(&troubles);
        device.set_device_lost_callback(move |reason, message| {
            lock(&noted).lost = Some(format!("{reason:?} {message}").trim().to_owned());
        });
        let noted = Arc::clone(&troubles);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            lock(&noted).errors.push(error.to_string())
        }));
        Ok(Self { device, queue, description, troubles, timeout: TIMEOUT, kernels: Arc::default() })
    }

    /// The same device, with another time after which it counts as hung; a minute unless this is said.
    #[must_use]
    pub const fn with_timeout(mut self, timeout: Duration) -> Self {
        self.timeout = timeout;
        self
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The kernels that were built for it, for as long as the lock is held.
    pub(crate) fn built_kernels(&self) -> MutexGuard<'_, BuiltKernels> {
        lock(&self.kernels)
    }

    /// Its queue.
    #[must_use]
    pub const fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Which adapter it is.
    #[must_use]
    pub const fn description(&self) -> &AdapterDescription {
        &self.description
    }

    /// Whether all is well so far. To be asked after waiting and before work is called done: a lost device takes further
    /// work in silence.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], for good; or [`Error::Validation`] with what the driver has refused since the last check.
    pub fn check(&self) -> Result<()> {
        let mut troubles = lock(&self.troubles);
        if let Some(reason) = &troubles.lost {
            return Err(Error::DeviceLost { adapter: self.description.name.clone(), reason: reason.clone() });
        }
        if troubles.errors.is_empty() {
            return Ok(());
        }
        Err(Error::Validation { messages: std::mem::take(&mut troubles.errors).join("; ") })
    }

    /// Whether it is gone, for good.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        lock(&self.troubles).lost.is_some()
    }

    /// Waits until all submitted work is done, then [`check`](Self::check)s.
    ///
    /// # Errors
    /// As [`check`](Self::check); [`Error::Timeout`] when the device hangs.
    pub fn wait(&self) -> Result<()> {
        self.poll(None)
    }

    /// Waits until one submission, and all before it, is done, then [`check`](Self::check)s.
    ///
    /// # Errors
    /// As [`wait`](Self::wait).
    pub fn wait_for(&self, submission: wgpu::SubmissionIndex) -> Result<()> {
        self.poll(Some(submission))
    }

    fn poll(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<()> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index, timeout: Some(self.timeout) });
        self.check()?;
        waited.map(|_| ()).map_err(|_| self.hung())
    }

    const fn hung(&self) -> Error {
        Error::Timeout { timeout_s: self.timeout.as_secs_f32() }
    }

    /// Waits until all submitted work is done, and whoever asked was told so: another who waits for the device at the same time may be
    /// the one who hears it, and is yet to tell it on.
    ///
    /// # Errors
    /// As [`wait`](Self::wait).
    pub(crate) fn wait_until_told(&self, is_told: impl Fn() -> bool) -> Result<()> {
        self.wait()?;
        let start = Instant::now();
        while !is_told() {
            self.check()?;
            if start.elapsed() > self.timeout {
                return Err(self.hung());
            }
            std::thread::sleep(TELL_TIME);
        }
        Ok(())
    }

    /// A buffer.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], or [`Error::Validation`] for a size beyond the limits.
    pub fn create_buffer(&self, descriptor: &wgpu::BufferDescriptor<'_>) -> Result<wgpu::Buffer> {
        self.made(descriptor.label, descriptor.size, || self.device.create_buffer(descriptor))
    }

    /// A buffer that holds `content`, of at least 16 bytes.
    ///
    /// # Errors
    /// As [`create_buffer`](Self::create_buffer); [`Error::DeviceLost`] when its memory cannot be reached.
    pub fn create_buffer_with(
        &self,
        label: &str,
        usage: wgpu::BufferUsages,
        content: &[u8],
    ) -> Result<wgpu::Buffer> {
        let size = (content.len() as u64).max(16).next_multiple_of(4);
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: true };
        let buffer = self.create_buffer(&descriptor)?;
        {
            let mut mapped =
                buffer.get_mapped_range_mut(..content.len() as u64).map_err(|_| self.unreachable())?;
            mapped.copy_from_slice(content);
        }
        buffer.unmap();
        Ok(buffer)
    }

    /// The words of a buffer that can be mapped, after waiting for all submitted work.
    ///
    /// # Errors
    /// As [`wait`](Self::wait).
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u32>> {
        let is_told = Arc::new(AtomicBool::new(false));
        let noted = Arc::clone(&is_told);
        // Whether it was mapped is seen below.
        buffer.map_async(wgpu::MapMode::Read, .., move |_| noted.store(true, Ordering::Release));
        self.wait_until_told(|| is_told.load(Ordering::Acquire))?;
        let words = {
            let mapped = buffer.get_mapped_range(..).map_err(|_| self.unreachable())?;
            bytemuck::pod_collect_to_vec(&mapped)
        };
        buffer.unmap();
        Ok(words)
    }

    /// A texture.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], or [`Error::Validation`] for a size beyond the limits.
    pub fn create_texture(&self, descriptor: &wgpu::TextureDescriptor<'_>) -> Result<wgpu::Texture> {
        let size = descriptor.size;
        let texels = u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers);
        let texel_size = u64::from(descriptor.format.block_copy_size(None).unwrap_or(4));
        self.made(descriptor.label, texels * texel_size, || self.device.create_texture(descriptor))
    }

    /// Runs `make` and gives the error that the driver had for it, if any.
    fn made<T>(&self, label: Option<&str>, size_in_bytes: u64, make: impl FnOnce() -> T) -> Result<T> {
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = make();
        let (memory, validation) = (pollster::block_on(memory.pop()), pollster::block_on(validation.pop()));
        if memory.is_some() {
            return Err(Error::OutOfMemory { what: label.unwrap_or("a resource").to_owned(), size_in_bytes });
        }
        match validation {
            Some(error) => Err(Error::Validation { messages: error.to_string() }),
            None => Ok(made),
        }
    }

    /// The error for memory that cannot be mapped: the device is lost, or the driver is broken.
    pub(crate) fn unreachable(&self) -> Error {
        let broken = || Error::Validation { messages: "a buffer could not be mapped".to_owned() };
        // The driver tells that the device is lost only to one who waits.
        self.wait().err().unwrap_or_else(broken)
    }
}

/// A panic while the lock is held cannot leave what is kept half written, so a poisoned one is as good as any.
fn lock<T>(kept: &Mutex<T>) -> MutexGuard<'_, T> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}
