//! Steps of graphs on the CPU: a plane row by row, on all cores.

use orogeny_field::{Mirrors, PYRAMID_PHASES, Place, Plane, SampleRect};
use orogeny_reference::field::between::Ground;
use orogeny_reference::field::{
    Channel, band, channel, combine, convolve, cover, grab, interpolate, lerp, pipes, resample, sharpen,
    shift, thermal,
};
use rayon::prelude::*;

use crate::filter::{Axis, MAX_INPUTS, PipesPhase, Step, ThermalPhase};

/// Rows that a thread takes at once.
const TASK_ROWS: usize = 8;
/// Rows and columns of a piece that is filtered along both axes: what is between them stays in a core's second-level cache.
const MIN_PIECE_ROWS: usize = 16;
const MAX_PIECE_ROWS: usize = 128;
/// Some odd times as many as a kernel works on at once: rows a power of two apart would fall onto the same few lines of the
/// first-level cache.
const PIECE_COLUMNS: usize = 320;

/// A plane as a step reads it.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) plane: &'a Plane,
    /// Where what it is a part of is mirrored.
    pub(super) mirrors: Mirrors,
}

impl<'a> Source<'a> {
    const fn ground(&self) -> Ground<'a> {
        Ground { plane: self.plane, mirrors: self.mirrors }
    }

    /// `length` samples of a row from column `x` on, none of which lies beyond the border.
    fn part(&self, z: i32, x: i32, length: usize) -> &'a [f32] {
        part(self.plane, 0, x, self.mirrors.row(z), length)
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
        let row = self.plane.row(self.mirrors.row(z)).unwrap_or_default();
        let part = |from: i32, to: i32| row.get(from.abs_diff(x0) as usize..to.abs_diff(x0) as usize);
        let (inner, outer) = (x.max(x0).min(end), end.min(x1).max(x));
        buffer.clear();
        for (from, to) in [(x, inner), (inner, outer), (outer, end)] {
            if from >= to {
                continue;
            }
            // Between two mirrors the samples lie in one piece, forwards or backwards.
            let (first, last) = (self.mirrors.column(from), self.mirrors.column(to - 1));
            let one_piece = first.abs_diff(last) == (to - 1).abs_diff(from);
            match part(first.min(last), first.max(last) + 1).filter(|_| one_piece) {
                Some(samples) if first <= last => buffer.extend_from_slice(samples),
                Some(samples) => buffer.extend(samples.iter().rev()),
                None => buffer.extend((from..to).map(|x| {
                    let place = self.mirrors.column(x);
                    part(place, place + 1).and_then(|sample| sample.first().copied()).unwrap_or_default()
                })),
            }
        }
        buffer
    }
}

/// Works out all rows of a plane.
pub(super) fn fill(plane: &mut Plane, step: &Step, sources: &[Source<'_>], extent: [u32; 2]) {
    let rect = plane.rect();
    let (width, area) = (rect.width() as usize, rect.area() as usize);
    let columns: Vec<Place> = match step {
        Step::Resample { placement, .. } | Step::Cover { placement, .. } => {
            (rect.x0..rect.x1).map(|x| placement.column(x)).collect()
        }
        _ => Vec::new(),
    };
    if plane.num_channels() == 1 {
        let rows = plane.samples_mut().par_chunks_mut(width).enumerate().with_min_len(TASK_ROWS);
        rows.for_each_init(
            || [const { Vec::new() }; MAX_INPUTS],
            |buffers, (row, target)| {
                let first = [rect.x0, rect.z0 + row as i32];
                match step {
                    Step::Thermal { .. } | Step::Pipes { .. } => {
                        erode_row(&mut [target], first, step, sources, extent)
                    }
                    _ => work_out_row(target, first, step, sources, &columns, buffers),
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

/// Works out a plane along one axis, of what a step along the other, `before`, makes of its sources: piece by piece, so that
/// what is between them, and is mirrored so, never goes through memory.
pub(super) fn fill_through(
    plane: &mut Plane,
    step: &Step,
    before: &Step,
    mirrors: Mirrors,
    sources: &[Source<'_>],
) {
    let rect = plane.rect();
    let width = rect.width() as usize;
    let num_rows = (rect.depth() as usize).div_ceil(4 * rayon::current_num_threads());
    // Rows about a piece are worked out for each of two: not more of them than the piece has.
    let around = step.source_rect(&SampleRect::new(0, 0, 1, 1), 0).depth() as usize;
    let num_rows = num_rows.clamp(MIN_PIECE_ROWS.max(around.min(MAX_PIECE_ROWS)), MAX_PIECE_ROWS);
    plane.samples_mut().par_chunks_mut(width * num_rows).enumerate().for_each_init(
        || (Plane::constant(SampleRect::EMPTY, 0.0), [const { Vec::new() }; MAX_INPUTS]),
        |(memory, buffers), (number, band)| {
            let z0 = rect.z0 + (number * num_rows) as i32;
            let z1 = z0 + (band.len() / width) as i32;
            for first in (0..width).step_by(PIECE_COLUMNS) {
                let columns = first..width.min(first + PIECE_COLUMNS);
                let [x0, x1] = [columns.start, columns.end].map(|column| rect.x0 + column as i32);
                let between = mirrors.shown(&step.source_rect(&SampleRect::new(x0, z0, x1, z1), 0));
                let mut half =
                    std::mem::replace(memory, Plane::constant(SampleRect::EMPTY, 0.0)).reused(between, 1);
                for z in between.z0..between.z1 {
                    let Some(row) = half.row_mut(z) else { continue };
                    work_out_row(row, [between.x0, z], before, sources, &[], buffers);
                }
                let source = [Source { plane: &half, mirrors }];
                for (z, row) in (z0..).zip(band.chunks_mut(width)) {
                    let Some(row) = row.get_mut(columns.clone()) else { continue };
                    work_out_row(row, [x0, z], step, &source, &[], buffers);
                }
                *memory = half;
            }
        },
    );
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
            thermal::shares_row(shares, taluses, x, z, first, second, bounds, kernel);
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
            let hardness = sources.get(2).map(|source| source.plane);
            pipes::ground_row(row, x, z, &state, flux, hardness, bounds, kernel);
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
    columns: &[Place],
    buffers: &mut [Vec<f32>; MAX_INPUTS],
) {
    let length = target.len();
    let [buffer, other, ..] = buffers;
    match (step, sources) {
        (Step::Convolve { axis: Axis::X, stride, weights }, [source]) => {
            let first = x * stride.cast_signed() - weights.len() as i32;
            let stride = *stride as usize;
            let source_length = convolve::source_length(length, weights.len(), stride);
            let source = source.columns(z, first, source_length, buffer);
            convolve::row_along_x(target, source, weights, stride);
        }
        (Step::Convolve { axis: Axis::Z, stride, weights }, [source]) => {
            let first = z * stride.cast_signed() - weights.len() as i32;
            let mut rows = Vec::with_capacity(2 * weights.len() + 1);
            rows.extend((first..).take(2 * weights.len() + 1).map(|z| source.part(z, x, length)));
            convolve::row_along_z(target, &rows, weights);
        }
        (Step::Interpolate { axis: Axis::X, phases }, [source]) => {
            let factor = phases.len().max(1) as i32;
            let (coarse, phase) = (x.div_euclid(factor), x.rem_euclid(factor));
            let num_coarse = (phase as usize + length).div_ceil(phases.len().max(1)) + 3;
            let source = source.columns(z, coarse - 1, num_coarse, buffer);
            interpolate::row_along_x(target, source, phases, phase as usize);
        }
        (Step::Interpolate { axis: Axis::Z, phases }, [source]) => {
            let factor = phases.len().max(1) as i32;
            let (coarse, phase) = (z.div_euclid(factor), z.rem_euclid(factor));
            let Some(weights) = phases.get(phase as usize) else { return };
            let rows = [coarse - 1, coarse, coarse + 1, coarse + 2].map(|z| source.part(z, x, length));
            interpolate::row_along_z(target, rows, weights);
        }
        (Step::Sharpen { gain }, [heights, smoothed]) => {
            let heights = heights.columns(z, x, length, buffer);
            sharpen::row(target, heights, smoothed.columns(z, x, length, other), *gain);
        }
        (Step::Shift { cell: [cell_x, cell_z], fraction }, [source]) => {
            let north = source.columns(z + cell_z, x + cell_x, length + 1, buffer);
            let south = source.columns(z + cell_z + 1, x + cell_x, length + 1, other);
            shift::row(target, north, south, *fraction);
        }
        (Step::Resample { placement, heights }, [source]) => {
            if let (Some([cell_x, cell_z]), [1.0, 0.0]) = (placement.whole_samples(), heights) {
                target.copy_from_slice(source.columns(
                    z.saturating_add(cell_z),
                    x.saturating_add(cell_x),
                    length,
                    buffer,
                ));
                return;
            }
            resample::row(target, &source.ground(), columns, placement.row(z), *heights);
        }
        (Step::Cover { placement, part }, selection) => {
            let selection = selection.first().map(Source::ground);
            cover::row(target, selection.as_ref(), columns, placement.row(z), part);
        }
        (Step::Lerp, [first, second, mask]) => {
            let [buffer, other, third, ..] = buffers;
            let first = first.columns(z, x, length, buffer);
            let second = second.columns(z, x, length, other);
            lerp::row(target, first, second, mask.columns(z, x, length, third));
        }
        (Step::Combine { factors }, [first, second]) => {
            let first = first.columns(z, x, length, buffer);
            combine::row(target, first, second.columns(z, x, length, other), *factors);
        }
        (Step::Band { factor }, [mask, level]) => {
            let mask = mask.columns(z, x, length, buffer);
            band::coarsest_row(target, mask, level.columns(z, x, length, other), *factor);
        }
        (Step::Band { factor }, [mask, level, coarser, below]) => {
            let [buffer, other, coarser_row, below_row] = buffers;
            let coarser = expand_row(coarser_row, coarser, [x, z], length);
            let below = expand_row(below_row, below, [x, z], length);
            let mask = mask.columns(z, x, length, buffer);
            let level = level.columns(z, x, length, other);
            band::row(target, mask, level, coarser, below, *factor);
        }
        (Step::Channel { number, from, inverse_width }, [source]) => {
            channel::row(target, part(source.plane, *number, x, z, length), *from, *inverse_width);
        }
        (Step::Grab(kernel), [source]) => grab::row(target, x, z, &source.ground(), kernel),
        _ => debug_assert!(false, "{step:?} of {} planes", sources.len()),
    }
}

/// The next finer level along x of a row of a coarser one, from a sample on.
fn expand_row<'b>(row: &'b mut Vec<f32>, coarser: &Source<'_>, [x, z]: [i32; 2], length: usize) -> &'b [f32] {
    // From the coarse sample on, which is quicker than from between two of them.
    let (coarse, phase) = (x.div_euclid(2), x.rem_euclid(2) as usize);
    row.resize(phase + length, 0.0);
    let mut buffer = Vec::new();
    let source = coarser.columns(z, coarse - 1, (phase + length).div_ceil(2) + 3, &mut buffer);
    interpolate::row_along_x(row, source, &PYRAMID_PHASES, 0);
    row.get(phase..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::{gaussian_weights, hash, mirrored};

    /// More columns than a piece has, more rows too, and borders that lie in neither's middle.
    const WIDTH: u32 = 2 * PIECE_COLUMNS as u32 + 77;
    const DEPTH: u32 = 2 * MAX_PIECE_ROWS as u32 + 33;

    fn filters() -> [[Step; 2]; 3] {
        let convolve = |stride, sigma| {
            let weights: std::sync::Arc<[f32]> = gaussian_weights(sigma).into();
            [Axis::X, Axis::Z].map(|axis| Step::Convolve { axis, stride, weights: weights.clone() })
        };
        let expand = [Axis::Z, Axis::X].map(|axis| Step::Interpolate { axis, phases: PYRAMID_PHASES.into() });
        [convolve(1, 2.5), convolve(2, 0.9), expand]
    }

    #[test]
    fn pieces_filtered_along_both_axes_have_the_bits_of_whole_planes() {
        let extent = [WIDTH, DEPTH];
        let mut ground = Plane::constant(SampleRect::new(0, 0, WIDTH as i32, DEPTH as i32), 0.0);
        for (place, height) in (0..).zip(ground.samples_mut()) {
            *height = 900.0 * hash::uniform(place, 1, 2);
        }
        for [first, second] in filters() {
            let is_coarser = matches!(&first, Step::Convolve { stride: 2, .. });
            let target = if is_coarser {
                SampleRect::new(-5, 3, PIECE_COLUMNS as i32 + 40, MAX_PIECE_ROWS as i32 + 9)
            } else {
                SampleRect::new(-9, 11, WIDTH as i32 - 30, DEPTH as i32 - 20)
            };
            let between = second.source_rect(&target, 0);
            // What is read along z must be there; along x it is mirrored.
            let needed = first.source_rect(&between, 0);
            let mut source = Plane::constant(needed, 0.0);
            for z in needed.z0..needed.z1 {
                let from = ground.row(mirrored(z, DEPTH)).unwrap();
                for (x, height) in (needed.x0..needed.x1).zip(source.row_mut(z).unwrap()) {
                    *height = from[mirrored(x, WIDTH) as usize];
                }
            }
            let sources = [Source { plane: &source, mirrors: Mirrors::NONE }];
            let sentinel = |rect| Plane::constant(rect, f32::NAN);
            let (mut half, mut whole, mut in_pieces) =
                (sentinel(between), sentinel(target), sentinel(target));
            fill(&mut half, &first, &sources, extent);
            fill(&mut whole, &second, &[Source { plane: &half, mirrors: Mirrors::NONE }], extent);
            fill_through(&mut in_pieces, &second, &first, Mirrors::NONE, &sources);
            let bits =
                |plane: &Plane| plane.samples().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert!(bits(&whole) == bits(&in_pieces), "{first:?}");
            assert!(whole.samples().iter().all(|value| value.is_finite()));
        }
    }
}
