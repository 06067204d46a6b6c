//! Fills through the GPU back end beside the same through the CPU back end, on whatever adapter there is.
//!
//! The limit is what the adapter makes of a bare stencil: a back end that loses no more against the CPU than such a kernel, which
//! has nothing of the engine about it and reads as many values at once, loses against a plain loop is at 100 %.

use std::hint::black_box;

use anyhow::Result;
use multiversion::multiversion;
use orogeny_field::Brush;
use orogeny_gpu::{AdapterChoice, Gpu};
use rayon::prelude::*;

use crate::fill::Fill;
use crate::measure::Times;
use crate::report::{Figure, Report, Unit};

/// Samples a side of the stencil's field: so few that it lies in the caches of two cores. On four times as many the plain loop ran at a
/// fifth to all of its speed by what else used the memory, which a driver that computes more does not notice.
const SIDE: usize = 1024;
const ITERATIONS: usize = 40;
const NUM_SAMPLES: f64 = (SIDE * SIDE * ITERATIONS) as f64;
/// Of stencils along a row: of 5 values, as a level of a pyramid and a step of erosion have about, and of 23, as a Gaussian has.
const RADII: [usize; 2] = [2, 11];
const WORKGROUP_SIDE: u32 = 16;

/// What is filled.
pub struct Case<'a> {
    pub name: String,
    pub brush: Brush,
    /// The brush that makes the ground of a plain.
    pub ground: &'a Brush,
    pub side: u64,
    pub spacing_m: f64,
    /// How often each sample is worked on.
    pub iterations: u32,
    /// One of [`RADII`]: that of the stencil which reads about as many values.
    pub stencil_radius: usize,
}

pub fn run(report: &mut Report, repeat: usize, cases: &[Case<'_>]) -> Result<()> {
    let gpu = match Gpu::open(&AdapterChoice::RealGpu).or_else(|_| Gpu::open(&AdapterChoice::Software)) {
        Ok(gpu) => gpu,
        Err(err) => {
            report.note(format!("no adapter measured: {err}"));
            return Ok(());
        }
    };
    let adapter = gpu.description().name.clone();
    let num_threads = rayon::current_num_threads();
    let mut stencils = Vec::new();
    for radius in RADII.into_iter().filter(|radius| cases.iter().any(|case| case.stencil_radius == *radius)) {
        stencils.push((
            Stencil::new(&gpu, radius)?,
            PlainStencil::new(radius),
            [Times::default(), Times::default()],
        ));
    }
    let mut fills = Vec::new();
    for Case { brush, ground, side, spacing_m, .. } in cases {
        let cpu = Fill::new(num_threads, *side, *spacing_m, Some(ground), brush)?;
        let there = Fill::on_gpu(&gpu, *side, *spacing_m, Some(ground), brush)?;
        fills.push([(cpu, Times::default()), (there, Times::default())]);
    }
    for _ in 0..repeat {
        for (stencil, plain, [there, cpu]) in &mut stencils {
            there.measure(|| stencil.run())?;
            cpu.measure(|| plain.run());
        }
        for (fill, times) in fills.iter_mut().flatten() {
            fill.measure(times)?;
        }
    }
    let mut add = |name: String, times: &Times, num: f64, limit| {
        report.add(Figure::per_second(name, Unit::SamplesPerSecond, times, num, limit));
    };
    for (stencil, _, [there, cpu]) in &stencils {
        let name = format!("bare stencil of {}", 2 * stencil.radius + 1);
        add(format!("{name}, CPU {num_threads} threads"), cpu, NUM_SAMPLES, None);
        add(format!("{name}, {adapter}"), there, NUM_SAMPLES, Some(NUM_SAMPLES / cpu.median_s()));
    }
    for (case, [(_, cpu), (_, there)]) in cases.iter().zip(&fills) {
        let num = (case.side * case.side) as f64 * f64::from(case.iterations);
        let stencil = stencils.iter().find(|(stencil, ..)| stencil.radius == case.stencil_radius);
        let limit = stencil.map(|(.., [there, cpu])| cpu.median_s() / there.median_s());
        let limit = limit.map(|ratio| num / cpu.median_s() * ratio);
        add(format!("{}, {adapter}", case.name), there, num, limit);
    }
    Ok(())
}

/// Iterations of the stencil on a device.
struct Stencil {
    radius: usize,
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
}

impl Stencil {
    fn new(gpu: &Gpu, radius: usize) -> Result<Self> {
        let device = gpu.device();
        let module = device.create_shader_module(wgpu::include_wgsl!("stencil.wgsl"));
        let constants = [("side", SIDE as f64), ("radius", radius as f64)];
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("benchsuite.stencil"),
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            cache: None,
        });
        let field = || {
            gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("benchsuite.stencil"),
                size: (SIDE * SIDE * 4) as u64,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let (first, second) = (field()?, field()?);
        let groups = [[&first, &second], [&second, &first]].map(|[source, result]| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("benchsuite.stencil"),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: source.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: result.as_entire_binding() },
                ],
            })
        });
        gpu.check()?;
        Ok(Self { radius, gpu: gpu.clone(), pipeline, groups })
    }

    fn run(&self) -> Result<()> {
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for group in self.groups.iter().cycle().take(ITERATIONS) {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            let num_groups = (SIDE as u32).div_ceil(WORKGROUP_SIDE);
            pass.dispatch_workgroups(num_groups, num_groups, 1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        Ok(self.gpu.wait()?)
    }
}

/// The same as a plain loop over rows, on all cores, with the instructions that the CPU back end has.
struct PlainStencil {
    fields: [Vec<f32>; 2],
    radius: usize,
}

impl PlainStencil {
    fn new(radius: usize) -> Self {
        Self { fields: [vec![1.0; SIDE * SIDE], vec![0.0; SIDE * SIDE]], radius }
    }

    fn run(&mut self) {
        let Self { fields: [source, result], radius } = self;
        for _ in 0..ITERATIONS {
            let rows = source.par_chunks(SIDE).zip(result.par_chunks_mut(SIDE)).with_min_len(8);
            rows.for_each(|(source, result)| stencil_row(result, source, *radius));
            std::mem::swap(source, result);
        }
        black_box(&self.fields);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn stencil_row(result: &mut [f32], source: &[f32], radius: usize) {
    const LANES: usize = 64;
    let weight = 1.0 / (2 * radius + 1) as f32;
    let Some(inner) = result.get_mut(radius..SIDE - radius) else { return };
    for (number, result) in inner.chunks_mut(LANES).enumerate() {
        let mut sums = [0.0; LANES];
        for place in 0..=2 * radius {
            let Some(source) = source.get(number * LANES + place..) else { return };
            // A fixed number of them is a tenth faster, and a limit is to be as fast as it can.
            if let Some(source) = source.first_chunk::<LANES>() {
                for (sum, value) in sums.iter_mut().zip(source) {
                    *sum += value;
                }
            } else {
                for (sum, value) in sums.iter_mut().zip(source) {
                    *sum += value;
                }
            }
        }
        for (result, sum) in result.iter_mut().zip(sums) {
            *result = weight * sum;
        }
    }
}
