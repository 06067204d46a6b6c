//! What pictures are drawn into, and their way back to memory.

use orogeny_gpu::{Gpu, Result};

/// Light of any strength, before the tone curve.
pub(super) const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Reversed: 1 near, 0 infinitely far.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// What a screen or a file shows.
pub(super) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Textures of one size.
#[derive(Debug)]
pub struct Targets {
    pub(super) size: [u32; 2],
    pub(super) light: wgpu::Texture,
    pub(super) depth: wgpu::Texture,
    pub(super) picture: wgpu::Texture,
}

impl Targets {
    /// For pictures of so many pixels.
    ///
    /// # Errors
    /// When there is no memory, or the device has no textures of that size.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self> {
        let [width, height] = size;
        let texture = |label: &str, format, more| {
            gpu.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | more,
                view_formats: &[format.remove_srgb_suffix()],
            })
        };
        Ok(Self {
            size,
            light: texture("orogeny.light", LIGHT_FORMAT, wgpu::TextureUsages::TEXTURE_BINDING)?,
            depth: texture(
                "orogeny.depth",
                DEPTH_FORMAT,
                wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
            )?,
            picture: texture(
                "orogeny.picture",
                PICTURE_FORMAT,
                wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING,
            )?,
        })
    }

    /// How far the ground of the last picture is: [`MIN_NEAR_M`](crate::MIN_NEAR_M) over the distance before the eye, 0 where there is none. For those who
    /// draw more into it.
    #[must_use]
    pub const fn depth(&self) -> &wgpu::Texture {
        &self.depth
    }

    /// The picture that was drawn last, its bytes as they are: who samples it gets sRGB, which is what user interfaces mix colours in.
    #[must_use]
    pub fn picture_view(&self) -> wgpu::TextureView {
        self.picture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(PICTURE_FORMAT.remove_srgb_suffix()),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// Waits for the picture, and gives its pixels: red, green, blue (sRGB) and alpha, row by row.
    ///
    /// # Errors
    /// When the device is lost or hangs.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u8>> {
        let [width, height] = self.size;
        let row_bytes = width * 4;
        let padded = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("orogeny.picture.read"),
            size: u64::from(padded) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })?;
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.picture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: None,
                },
            },
            self.picture.size(),
        );
        gpu.queue().submit([encoder.finish()]);
        let words = gpu.read_buffer(&buffer)?;
        let rows = words.chunks_exact((padded / 4) as usize);
        Ok(rows.flat_map(|row| row.iter().take(width as usize).flat_map(|word| word.to_le_bytes())).collect())
    }
}
