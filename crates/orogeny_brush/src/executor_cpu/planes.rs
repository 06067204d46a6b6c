//! Graphs worked out on the CPU: each plane row by row, on all cores.

use orogeny_field::{Plane, SampleRect, mirrored};
use orogeny_reference::field::{Channel, convolve, interpolate, pipes, sharpen, shift, thermal};
use rayon::prelude::*;

use crate::execute::Watch;
use crate::filter::{Axis, Graph, PipesPhase, Step, ThermalPhase};
use crate::{Error, Result};

/// Rows that a thread takes at once.
const TASK_ROWS: usize = 8;
/// Memory of planes that is kept for the next graph.
const MAX_POOLED: usize = 8;

/// Works out graphs, and keeps the memory of their planes.
#[derive(Debug, Default)]
pub(super) struct Planes {
    pool: Vec<Plane>,
}

/// A plane as a step reads it.
#[derive(Clone, Copy)]
struct Source<'a> {
    plane: &'a Plane,
    /// Samples of the terrain, where the plane is mirrored at its border.
    mirrored_in: Option<[u32; 2]>,
}

impl Planes {
    /// Works out the last plane of a graph over `target`; `heights` loads the heights of a rectangle.
    pub(super) fn work_out(
        &mut self,
        threads: &rayon::ThreadPool,
        graph: &Graph,
        target: SampleRect,
        heights: impl FnOnce(Plane) -> Result<Plane>,
        watch: Watch<'_>,
    ) -> Result<Plane> {
        let rects = graph.plan(target);
        let mut heights = Some(heights);
        let mut planes: Vec<Option<Plane>> = Vec::with_capacity(rects.len());
        for (place, (node, rect)) in graph.nodes().iter().zip(&rects).enumerate() {
            if !watch(place as f64 / rects.len() as f64) {
                return Err(Error::Interrupted);
            }
            let mut plane = self.memory(*rect, node.step.num_channels());
            if let Step::Heights = node.step {
                plane = match heights.take() {
                    Some(heights) => heights(plane)?,
                    None => plane,
                };
            } else if !rect.is_empty() {
                let sources: Vec<_> =
                    node.inputs.iter().filter_map(|input| source(graph, &planes, *input)).collect();
                threads.install(|| fill(&mut plane, &node.step, &sources, graph.extent()));
            }
            planes.push(Some(plane));
            // What no later plane is made of gives its memory back.
            for input in graph.done_with(place) {
                if let Some(plane) = planes.get_mut(input).and_then(Option::take) {
                    self.give_back(plane);
                }
            }
        }
        Ok(planes.pop().flatten().unwrap_or_else(|| Plane::constant(SampleRect::EMPTY, 0.0)))
    }

    /// Takes back the memory of a plane that is no longer needed.
    pub(super) fn give_back(&mut self, plane: Plane) {
        if self.pool.len() < MAX_POOLED {
            self.pool.push(plane);
        }
    }

    /// Gives up the memory that is kept.
    pub(super) fn clear(&mut self) {
        self.pool.clear();
    }

    /// A plane whose values are to be written.
    fn memory(&mut self, rect: SampleRect, num_channels: u32) -> Plane {
        // The smallest that is large enough, else the largest.
        let size = rect.area() as usize * num_channels as usize;
        let is_better = |plane: &Plane| (plane.capacity() < size, plane.capacity().abs_diff(size));
        let best =
            self.pool.iter().enumerate().min_by_key(|(_, plane)| is_better(plane)).map(|(place, _)| place);
        match best {
            Some(place) => self.pool.swap_remove(place).reused(rect, num_channels),
            None => Plane::with_channels(rect, num_channels, 0.0),
        }
    }
}

fn source<'a>(graph: &Graph, planes: &'a [Option<Plane>], input: usize) -> Option<Source<'a>> {
    let is_given = graph.nodes().get(input).is_some_and(|node| node.step == Step::Heights);
    let plane = planes.get(input)?.as_ref()?;
    Some(Source { plane, mirrored_in: is_given.then(|| graph.extent()) })
}

impl<'a> Source<'a> {
    /// Where row `z` lies in the plane.
    fn mirrored_row(&self, z: i32) -> i32 {
        self.mirrored_in.map_or(z, |[_, depth]| mirrored(z, depth))
    }

    /// `length` samples of a row from column `x` on, none of which lies beyond the border.
    fn part(&self, z: i32, x: i32, length: usize) -> &'a [f32] {
        part(self.plane, 0, x, self.mirrored_row(z), length)
    }

    /// `length` samples of a row from column `x` on; through the buffer where they lie beyond the border.
    fn columns<'b>(&self, z: i32, x: i32, length: usize, buffer: &'b mut Vec<f32>) -> &'b [f32]
    where
        'a: 'b,
    {
        let SampleRect { x0, x1, .. } = self.plane.rect();
        let end = x + length as i32;
        if x >= x0 && end <= x1 {
            return self.part(z, x, length);
        }
        let row = self.plane.row(self.mirrored_row(z)).unwrap_or_default();
        let part = |from: i32, to: i32| row.get(from.abs_diff(x0) as usize..to.abs_diff(x0) as usize);
        let width = self.mirrored_in.map_or(u32::MAX, |[width, _]| width);
        let (inner, outer) = (x.max(x0).min(end), end.min(x1).max(x));
        buffer.clear();
        for (from, to) in [(x, inner), (inner, outer), (outer, end)] {
            if from >= to {
                continue;
            }
            // Between two mirrors the samples lie in one piece, forwards or backwards.
            let (first, last) = (mirrored(from, width), mirrored(to - 1, width));
            let one_piece = first.abs_diff(last) == (to - 1).abs_diff(from);
            match part(first.min(last), first.max(last) + 1).filter(|_| one_piece) {
                Some(samples) if first <= last => buffer.extend_from_slice(samples),
                Some(samples) => buffer.extend(samples.iter().rev()),
                None => buffer.extend((from..to).map(|x| {
                    let place = mirrored(x, width);
                    part(place, place + 1).and_then(|sample| sample.first().copied()).unwrap_or_default()
                })),
            }
        }
        buffer
    }
}

/// Works out all rows of a plane.
fn fill(plane: &mut Plane, step: &Step, sources: &[Source<'_>], extent: [u32; 2]) {
    let rect = plane.rect();
    let (width, area) = (rect.width() as usize, rect.area() as usize);
    if plane.num_channels() == 1 {
        let rows = plane.samples_mut().par_chunks_mut(width).enumerate().with_min_len(TASK_ROWS);
        rows.for_each_init(
            || (Vec::new(), Vec::new()),
            |(buffer, other), (row, target)| {
                let first = [rect.x0, rect.z0 + row as i32];
                match step {
                    Step::Thermal { .. } | Step::Pipes { .. } => {
                        erode_row(&mut [target], first, step, sources, extent)
                    }
                    _ => work_out_row(target, first, step, sources, buffer, other),
                }
            },
        );
        return;
    }
    // The rows of all channels that belong together.
    let mut rows: Vec<Vec<&mut [f32]>> = (0..rect.depth()).map(|_| Vec::new()).collect();
    for channel in plane.samples_mut().chunks_mut(area) {
        for (rows, row) in rows.iter_mut().zip(channel.chunks_mut(width)) {
            rows.push(row);
        }
    }
    rows.par_iter_mut().enumerate().with_min_len(TASK_ROWS).for_each(|(row, targets)| {
        erode_row(targets, [rect.x0, rect.z0 + row as i32], step, sources, extent);
    });
}

/// Works out a row, in all channels, of a step of erosion, beyond whose terrain there is nothing.
fn erode_row(
    targets: &mut [&mut [f32]],
    [x, z]: [i32; 2],
    step: &Step,
    sources: &[Source<'_>],
    [width, depth]: [u32; 2],
) {
    let bounds = &SampleRect::new(0, 0, width.cast_signed(), depth.cast_signed());
    let Some(first) = sources.first().map(|source| source.plane) else { return };
    let second = sources.get(1).map(|source| source.plane);
    let of = |channel| Channel(first, channel);
    match (step, second, targets) {
        (Step::Thermal { phase: ThermalPhase::Shares, kernel }, _, [shares, taluses @ ..]) => {
            let taluses = taluses.first_mut().map_or(&mut [][..], |taluses| taluses);
            thermal::shares_row(shares, taluses, x, z, first, None, bounds, kernel);
        }
        (Step::Thermal { phase: ThermalPhase::Heights, kernel }, Some(shares), [heights]) => {
            thermal::heights_row(heights, x, z, first, shares, bounds, kernel);
        }
        (Step::Pipes { phase: PipesPhase::Begin, .. }, _, [terrain, water, sediment]) => {
            terrain.copy_from_slice(part(first, 0, x, z, terrain.len()));
            water.fill(0.0);
            sediment.fill(0.0);
        }
        (
            Step::Pipes { phase: PipesPhase::FirstFlux | PipesPhase::Flux, kernel },
            before,
            [west, east, north, south],
        ) => {
            let flows = [&mut **west, &mut **east, &mut **north, &mut **south];
            for (channel, flows) in (0..).zip(flows) {
                match before {
                    Some(before) => flows.copy_from_slice(part(before, channel, x, z, flows.len())),
                    None => flows.fill(0.0),
                }
            }
            pipes::flux_row(
                [west, east, north, south],
                x,
                z,
                of(pipes::TERRAIN),
                of(pipes::WATER),
                bounds,
                kernel,
            );
        }
        (Step::Pipes { phase: PipesPhase::Ground, kernel }, Some(flux), [terrain, water, sediment]) => {
            let row = pipes::StateRow { terrain, water, sediment };
            let state = pipes::State {
                terrain: of(pipes::TERRAIN),
                water: of(pipes::WATER),
                sediment: of(pipes::SEDIMENT),
            };
            pipes::ground_row(row, x, z, &state, flux, None, bounds, kernel);
        }
        (Step::Pipes { phase: PipesPhase::Settle, .. }, _, [heights]) => {
            heights.copy_from_slice(part(first, pipes::TERRAIN, x, z, heights.len()));
            pipes::settle_row(heights, part(first, pipes::SEDIMENT, x, z, heights.len()));
        }
        _ => debug_assert!(false, "a step of erosion without its planes"),
    }
}

/// `length` samples of a channel from a place on, which the plane has.
fn part(plane: &Plane, channel: u32, x: i32, z: i32, length: usize) -> &[f32] {
    let first = x.abs_diff(plane.rect().x0) as usize;
    let part = plane.channel_row(channel, z).and_then(|row| row.get(first..first + length));
    debug_assert!(part.is_some(), "{length} samples from {x}, {z} on of {:?}", plane.rect());
    part.unwrap_or_default()
}

/// Works out a row that begins at a sample.
fn work_out_row(
    target: &mut [f32],
    [x, z]: [i32; 2],
    step: &Step,
    sources: &[Source<'_>],
    buffer: &mut Vec<f32>,
    other: &mut Vec<f32>,
) {
    let Some(source) = sources.first() else { return };
    let length = target.len();
    match step {
        Step::Heights | Step::Thermal { .. } | Step::Pipes { .. } => {}
        Step::Convolve { axis: Axis::X, stride, weights } => {
            let first = x * stride.cast_signed() - weights.len() as i32;
            let stride = *stride as usize;
            let source_length = convolve::source_length(length, weights.len(), stride);
            let source = source.columns(z, first, source_length, buffer);
            convolve::row_along_x(target, source, weights, stride);
        }
        Step::Convolve { axis: Axis::Z, stride, weights } => {
            let first = z * stride.cast_signed() - weights.len() as i32;
            let mut rows = Vec::with_capacity(2 * weights.len() + 1);
            rows.extend((first..).take(2 * weights.len() + 1).map(|z| source.part(z, x, length)));
            convolve::row_along_z(target, &rows, weights);
        }
        Step::Interpolate { axis: Axis::X, phases } => {
            let factor = phases.len().max(1) as i32;
            let (coarse, phase) = (x.div_euclid(factor), x.rem_euclid(factor));
            let num_coarse = (phase as usize + length).div_ceil(phases.len().max(1)) + 3;
            let source = source.columns(z, coarse - 1, num_coarse, buffer);
            interpolate::row_along_x(target, source, phases, phase as usize);
        }
        Step::Interpolate { axis: Axis::Z, phases } => {
            let factor = phases.len().max(1) as i32;
            let (coarse, phase) = (z.div_euclid(factor), z.rem_euclid(factor));
            let Some(weights) = phases.get(phase as usize) else { return };
            let rows = [coarse - 1, coarse, coarse + 1, coarse + 2].map(|z| source.part(z, x, length));
            interpolate::row_along_z(target, rows, weights);
        }
        Step::Sharpen { gain } => {
            let heights = source.columns(z, x, length, buffer);
            let Some(smoothed) = sources.get(1) else { return };
            let smoothed = smoothed.columns(z, x, length, other);
            sharpen::row(target, heights, smoothed, *gain);
        }
        Step::Shift { cell: [cell_x, cell_z], fraction } => {
            let north = source.columns(z + cell_z, x + cell_x, length + 1, buffer);
            let south = source.columns(z + cell_z + 1, x + cell_x, length + 1, other);
            shift::row(target, north, south, *fraction);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Filter;
    use orogeny_field::{Brush, BrushType, SmoothMethod, Smoothing, TerrainGrid, gaussian_weights};

    const WIDTH: i32 = 157;
    const DEPTH: i32 = 118;

    fn ground() -> Plane {
        let rect = SampleRect::new(0, 0, WIDTH, DEPTH);
        let height = |x: u32, z: u32| {
            let random = orogeny_field::hash::uniform(x, z, 7);
            1500.0 + 300.0 * (x as f32 / 40.0).sin() - 2.0 * z as f32 + 25.0 * random
        };
        let places = (0..DEPTH.unsigned_abs()).flat_map(|z| (0..WIDTH.unsigned_abs()).map(move |x| (x, z)));
        Plane::from_samples(rect, 1, places.map(|(x, z)| height(x, z)).collect()).unwrap()
    }

    fn graphs() -> Vec<(String, Filter)> {
        let grid = TerrainGrid::new(WIDTH as u64, DEPTH as u64, 1.0).unwrap();
        let mut graphs = Vec::new();
        for method in [SmoothMethod::Gaussian, SmoothMethod::Lattice] {
            for width in [0.7, 1.0, 3.0, 4.1, 9.0, 30.0] {
                let smoothing = Smoothing { method, width_m: Some(width), ..Smoothing::default() };
                let brush = Brush { smoothing, ..Brush::new(BrushType::Smooth, 10.0, 1.0) };
                graphs.push((format!("{method:?} {width}"), Filter::of(&brush, &grid).unwrap().unwrap()));
            }
        }
        graphs.push(("drag".to_owned(), Filter::drag(&grid, [3.25, -7.5])));
        let sharpen = Brush::new(BrushType::Sharpen, 20.0, 1.0);
        graphs.push(("sharpen".to_owned(), Filter::of(&sharpen, &grid).unwrap().unwrap()));
        graphs
    }

    fn part_of(ground: &Plane, mut plane: Plane) -> Plane {
        let rect = plane.rect();
        assert!(ground.rect().contains(&rect), "{rect:?}");
        for z in rect.z0..rect.z1 {
            let columns = rect.x0.unsigned_abs() as usize..rect.x1.unsigned_abs() as usize;
            plane.row_mut(z).unwrap().copy_from_slice(&ground.row(z).unwrap()[columns]);
        }
        plane
    }

    fn work_out(graph: &Graph, ground: &Plane, target: SampleRect) -> Plane {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut planes = Planes::default();
        // Memory that was used before, and is not what it should be.
        planes.give_back(Plane::constant(SampleRect::new(0, 0, 500, 500), f32::NAN));
        planes.work_out(&threads, graph, target, |plane| Ok(part_of(ground, plane)), &mut |_| true).unwrap()
    }

    #[test]
    fn a_part_has_the_bits_of_the_whole_wherever_it_lies() {
        let ground = ground();
        for (name, filter) in graphs() {
            let whole = work_out(&filter.graph, &ground, ground.rect());
            for rect in [
                (0, 0, 1, 1),
                (0, 50, 64, 113),
                (63, 1, 128, 65),
                (100, 17, WIDTH, DEPTH),
                (156, 117, 157, 118),
            ] {
                let rect = SampleRect::new(rect.0, rect.1, rect.2, rect.3);
                let part = work_out(&filter.graph, &ground, rect);
                for z in rect.z0..rect.z1 {
                    for x in rect.x0..rect.x1 {
                        let (a, b) = (part.at(x, z).unwrap(), whole.at(x, z).unwrap());
                        assert_eq!(a.to_bits(), b.to_bits(), "{name}: {x}, {z}: {a} and {b}");
                    }
                }
            }
        }
    }

    /// The direct Gaussian in `f64`, on the terrain mirrored without an end.
    fn direct(ground: &Plane, sigma: f64) -> Vec<f64> {
        let half = gaussian_weights(sigma);
        let sum: f64 = 1.0 + 2.0 * half.iter().map(|w| f64::from(*w)).sum::<f64>();
        let centre = 1.0 - (sum - 1.0);
        let along = |values: &[f64], is_x: bool| -> Vec<f64> {
            let at = |x: i32, z: i32| {
                let (x, z) = (mirrored(x, WIDTH.unsigned_abs()), mirrored(z, DEPTH.unsigned_abs()));
                values[(z * WIDTH + x) as usize]
            };
            (0..DEPTH)
                .flat_map(|z| (0..WIDTH).map(move |x| (x, z)))
                .map(|(x, z)| {
                    let pair = |away: i32| {
                        if is_x {
                            at(x - away, z) + at(x + away, z)
                        } else {
                            at(x, z - away) + at(x, z + away)
                        }
                    };
                    centre * at(x, z)
                        + (1..).zip(&half).map(|(away, w)| f64::from(*w) * pair(away)).sum::<f64>()
                })
                .collect()
        };
        let heights: Vec<f64> = ground.samples().iter().map(|height| f64::from(*height)).collect();
        along(&along(&heights, true), false)
    }

    #[test]
    fn gaussians_of_any_width_change_the_ground_as_the_direct_one_does_within_a_hundredth() {
        let ground = ground();
        let grid = TerrainGrid::new(WIDTH as u64, DEPTH as u64, 1.0).unwrap();
        for sigma in [0.5, 2.0, 3.9, 4.1, 6.0, 7.9, 8.5, 16.0, 33.0, 64.0] {
            let smoothing = Smoothing { width_m: Some(sigma), ..Smoothing::default() };
            let brush = Brush { smoothing, ..Brush::new(BrushType::Smooth, 10.0, 1.0) };
            let filter = Filter::of(&brush, &grid).unwrap().unwrap();
            let whole = work_out(&filter.graph, &ground, ground.rect());
            let (mut error, mut change) = (0.0, 0.0);
            for ((height, direct), ours) in
                ground.samples().iter().zip(direct(&ground, sigma)).zip(whole.samples())
            {
                error += (f64::from(*ours) - direct).powi(2);
                change += (f64::from(*height) - direct).powi(2);
            }
            let ratio = (error / change).sqrt();
            println!("sigma {sigma}: {ratio:.6} of the change");
            let limit = if sigma <= 4.0 { 1.0e-4 } else { 0.01 };
            assert!(ratio < limit, "sigma {sigma}: {ratio}");
        }
    }
}
