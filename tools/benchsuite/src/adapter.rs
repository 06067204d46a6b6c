//! Fills through the GPU back end beside the same through the CPU back end, on whatever adapter there is.
//!
//! The limit is what the adapter makes of a bare stencil: a back end that loses no more against the CPU than such a kernel, which
//! has nothing of the engine about it, loses against a plain loop is at 100 %.

use std::hint::black_box;

use anyhow::Result;
use orogeny_field::Brush;
use orogeny_gpu::{AdapterChoice, Gpu};
use rayon::prelude::*;

use crate::fill::Fill;
use crate::measure::Times;
use crate::report::{Figure, Report};

/// Samples a side of the stencil's field.
const SIDE: usize = 2048;
const ITERATIONS: usize = 10;
const NUM_SAMPLES: f64 = (SIDE * SIDE * ITERATIONS) as f64;
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
    let stencil = Stencil::new(&gpu)?;
    let mut plain = PlainStencil::new();
    let (mut on_adapter, mut on_cpu) = (Times::default(), Times::default());
    let mut fills = Vec::new();
    for Case { brush, ground, side, spacing_m, .. } in cases {
        let cpu = Fill::new(num_threads, *side, *spacing_m, Some(ground), brush)?;
        let there = Fill::on_gpu(&gpu, *side, *spacing_m, Some(ground), brush)?;
        fills.push([(cpu, Times::default()), (there, Times::default())]);
    }
    for _ in 0..repeat {
        on_adapter.measure(|| stencil.run())?;
        on_cpu.measure(|| plain.run());
        for (fill, times) in fills.iter_mut().flatten() {
            fill.measure(times)?;
        }
    }
    let plain_per_s = NUM_SAMPLES / on_cpu.median_s();
    let ratio = on_cpu.median_s() / on_adapter.median_s();
    report.add(Figure::rate(format!("bare stencil, CPU {num_threads} threads"), &on_cpu, NUM_SAMPLES, None));
    let name = format!("bare stencil, {adapter}");
    report.add(Figure::rate(name, &on_adapter, NUM_SAMPLES, Some(plain_per_s * 8.0)));
    for (case, [(_, cpu), (_, there)]) in cases.iter().zip(&fills) {
        let num = (case.side * case.side) as f64 * f64::from(case.iterations);
        let limit = num / cpu.median_s() * ratio;
        report.add(Figure::rate(format!("{}, {adapter}", case.name), there, num, Some(limit * 8.0)));
    }
    Ok(())
}

/// Iterations of the stencil on a device.
struct Stencil {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
}

impl Stencil {
    fn new(gpu: &Gpu) -> Result<Self> {
        let device = gpu.device();
        let module = device.create_shader_module(wgpu::include_wgsl!("stencil.wgsl"));
        let constants = [("side", SIDE as f64)];
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
        Ok(Self { gpu: gpu.clone(), pipeline, groups })
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

/// The same as a plain loop over rows, on all cores.
struct PlainStencil {
    fields: [Vec<f32>; 2],
}

impl PlainStencil {
    fn new() -> Self {
        Self { fields: [vec![1.0; SIDE * SIDE], vec![0.0; SIDE * SIDE]] }
    }

    fn run(&mut self) {
        let [source, result] = &mut self.fields;
        for _ in 0..ITERATIONS {
            result.par_chunks_mut(SIDE).enumerate().with_min_len(8).for_each(|(z, result)| {
                let row = |z: usize| source.get(z * SIDE..(z + 1) * SIDE).unwrap_or_default();
                let rows = [row(z.saturating_sub(1)), row(z), row((z + 1).min(SIDE - 1))];
                stencil_row(result, rows);
            });
            std::mem::swap(source, result);
        }
        black_box(&self.fields);
    }
}

fn stencil_row(result: &mut [f32], [north, row, south]: [&[f32]; 3]) {
    let value = |here: f32, [west, east, north, south]: [f32; 4]| {
        here + 0.2 * ((west - here) + (east - here) + (north - here) + (south - here))
    };
    let inner = row.windows(3).zip(north.iter().zip(south).skip(1));
    for (result, (around, (north, south))) in result.iter_mut().skip(1).zip(inner) {
        if let [west, here, east] = around {
            *result = value(*here, [*west, *east, *north, *south]);
        }
    }
    // The ends, whose neighbour beyond the border is they themselves.
    for (place, beside) in [(0, 1), (SIDE - 1, SIDE - 2)] {
        let at = |row: &[f32], place: usize| row.get(place).copied().unwrap_or_default();
        if let Some(result) = result.get_mut(place) {
            *result =
                value(at(row, place), [at(row, beside), at(row, place), at(north, place), at(south, place)]);
        }
    }
}
