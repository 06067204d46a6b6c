//! One device, and more than one who works on it: whoever else waits for it takes nothing from those whose copies arrive then.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use orogeny_gpu::{Gpu, ReadbackBelt};
use orogeny_tests::gpu;

const SIDE: u32 = 64;
const NUM_ROUNDS: u32 = 200;
const SLOW: Duration = Duration::from_millis(2);
const NUM_COPIES: u32 = 8;

/// While something is done, another who waits for the device, and is slow to hear of what arrives: what arrives for others meanwhile is told
/// to them by the same thread, once it is done with that.
fn beside_another<T>(gpu: &Gpu, work: impl FnOnce() -> T) -> T {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
            let descriptor =
                wgpu::BufferDescriptor { label: None, size: 16, usage, mapped_at_creation: false };
            let buffer = gpu.create_buffer(&descriptor).unwrap();
            while !is_over.load(Ordering::Relaxed) {
                buffer.map_async(wgpu::MapMode::Read, .., |_| std::thread::sleep(SLOW));
                gpu.wait().unwrap();
                buffer.unmap();
            }
        });
        let done = catch_unwind(AssertUnwindSafe(work));
        is_over.store(true, Ordering::Relaxed);
        done.unwrap_or_else(|panic| resume_unwind(panic))
    })
}

fn bytes_of(words: impl Iterator<Item = u32>) -> Vec<u8> {
    words.flat_map(u32::to_le_bytes).collect()
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

#[test]
fn all_copies_are_collected_while_others_wait_for_the_device() {
    let gpu = gpu();
    let texture = gpu
        .create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: NUM_COPIES },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
        .unwrap();
    let samples: Vec<f32> = (0..SIDE * SIDE * NUM_COPIES).map(|place| place as f32).collect();
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIDE * 4), rows_per_image: Some(SIDE) };
    gpu.queue().write_texture(
        texture.as_image_copy(),
        &bytes_of(samples.iter().map(|sample| sample.to_bits())),
        layout,
        texture.size(),
    );
    let mut belt = ReadbackBelt::new(gpu.clone(), SIDE);
    beside_another(&gpu, || {
        for round in 0..NUM_ROUNDS {
            let mut encoder = encoder(&gpu);
            for layer in 0..NUM_COPIES {
                belt.schedule(&mut encoder, &texture, layer, layer).unwrap();
            }
            gpu.queue().submit([encoder.finish()]);
            belt.after_submit();
            let arrived = belt.collect_all().unwrap();
            assert_eq!(arrived.len(), NUM_COPIES as usize, "round {round}");
            for (copy, expected) in arrived.iter().zip(samples.chunks_exact((SIDE * SIDE) as usize)) {
                assert!(copy.samples == expected, "round {round}, layer {}", copy.tag);
            }
        }
    });
    gpu.check().unwrap();
}

#[test]
fn a_buffer_is_read_while_others_wait_for_the_device() {
    let gpu = gpu();
    let content: Vec<u32> = (0..1024).collect();
    let from = gpu
        .create_buffer_with("a test's", wgpu::BufferUsages::COPY_SRC, &bytes_of(content.iter().copied()))
        .unwrap();
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let descriptor = wgpu::BufferDescriptor { label: None, size: 4096, usage, mapped_at_creation: false };
    let to = gpu.create_buffer(&descriptor).unwrap();
    beside_another(&gpu, || {
        for round in 0..NUM_ROUNDS {
            let mut encoder = encoder(&gpu);
            encoder.copy_buffer_to_buffer(&from, 0, &to, 0, 4096);
            gpu.queue().submit([encoder.finish()]);
            let read = gpu.read_buffer(&to).unwrap_or_else(|err| panic!("round {round}: {err}"));
            assert!(read == content, "round {round}");
        }
    });
    gpu.check().unwrap();
}
