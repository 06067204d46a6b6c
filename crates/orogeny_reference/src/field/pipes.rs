//! Erosion by running water on the grid: every sample is a column of water joined to its four neighbours by pipes (after Mei,
//! Decaudin & Hu 2007, "Fast hydraulic erosion simulation and visualization on GPU"), with the sediment in flux form.
//!
//! `b` is the terrain, `d` the water, `s` the sediment that the water carries, all in metres; `q_n` the water that passes to
//! neighbour `n` in an iteration, in metres of the sample's own (the paper's flux times `dt / l²`). An iteration is two rows.
//! [`flux_row`], with `d₁ = d + rain`:
//!
//! - `q_n ← max(0, q_n · flowing + k ((b − b_n) + (d₁ − d₁ₙ)))`, `k = dt² A g / l³`; nothing passes the region's border;
//! - all four are scaled by `min(1, d₁ / Σ q)`, so that no more leaves than is there.
//!
//! [`ground_row`]:
//!
//! - `d₂ = (d₁ − Σ out) + Σ in`;
//! - every pipe takes its share of the sediment: `s ← (s − Σ s q_n/d₁) + Σ sₙ q_n→/d₁ₙ`: water carries along what it holds, where
//!   the paper traces it back, which loses some;
//! - capacity `C = K · max(sin α, sin α_min) · |v| · d̄`: what a volume of water holds grows with slope and velocity, and the
//!   velocity is the paper's `v = Δq l / (dt d̄)`, so that depth cancels out. The paper has no `d̄`: there a film of water on a
//!   slope, which moves on entirely in each step, digs as much as a river. `sin α` by central differences, with the border's
//!   own height beyond it;
//! - below capacity the water takes up `dissolving (C − s)` of the ground (less where it is hard), but at most half of the drop to
//!   the lowest of the four neighbours, so that it digs no pits; above, it lays down `deposition (s − C)`, but at most half of
//!   the rise to the highest or half of its depth, whichever is more: towers do not grow, and lakes fill. What changes hands is
//!   the difference of the heights *after* rounding, so terrain and sediment together lose nothing to the coarse `f32` of a
//!   high place;
//! - `d ← d₂ · staying`: evaporation leaves the sediment behind.
//!
//! At the end [`settle_row`] lays down all that is still carried, where it is.
//!
//! An iteration needs 2 samples more around: the flows one, the rest another.

use multiversion::multiversion;
use orogeny_field::{PipesKernel, Plane, SampleRect, sanitized_height};

use super::padded::{Beyond, Channel, LANES, Padded, Place, at, larger, positive, smaller};

/// How many samples around its own an iteration reads.
pub const HALO: i32 = 2;

/// Channels of a plane of ground, water and sediment.
pub const TERRAIN: u32 = 0;
/// Depth of the water.
pub const WATER: u32 = 1;
/// What the water carries.
pub const SEDIMENT: u32 = 2;

/// Channels of the plane of flows, by the neighbour that they lead to.
pub const WEST: u32 = 0;
/// To `x + 1`.
pub const EAST: u32 = 1;
/// To `z - 1`.
pub const NORTH: u32 = 2;
/// To `z + 1`.
pub const SOUTH: u32 = 3;

/// Less water, flow or sediment, in metres, is none: nothing becomes denormal.
const LEAST_M: f32 = 1.0e-20;

/// A wall around the region, in metres: no water gets over it.
const WALL_M: f32 = 1.0e30;

/// What leaves a sample is less than all of its water by this share, so that rounding cannot make it more.
const KEPT: f32 = 1.0 - 1.0 / 1_048_576.0;

/// What there is between two iterations.
#[derive(Debug, Clone, Copy)]
pub struct State<'a> {
    /// Height of the ground, in metres.
    pub terrain: Channel<'a>,
    /// Depth of the water, in metres.
    pub water: Channel<'a>,
    /// What the water carries, in metres of rock.
    pub sediment: Channel<'a>,
}

/// One row of what an iteration makes.
#[derive(Debug)]
pub struct StateRow<'a> {
    /// Height of the ground, in metres.
    pub terrain: &'a mut [f32],
    /// Depth of the water, in metres.
    pub water: &'a mut [f32],
    /// What the water carries, in metres of rock.
    pub sediment: &'a mut [f32],
}

/// Brings the flows of the samples `first_x ..` of row `z` up to date, in place: a flow depends on no other. Terrain and water
/// hold the row and one sample around, or end at `bounds`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn flux_row(
    [west, east, north, south]: [&mut [f32]; 4],
    first_x: i32,
    z: i32,
    terrain: Channel,
    water: Channel,
    bounds: &SampleRect,
    kernel: &PipesKernel,
) {
    let parts = west
        .chunks_mut(LANES)
        .zip(east.chunks_mut(LANES))
        .zip(north.chunks_mut(LANES))
        .zip(south.chunks_mut(LANES));
    for (index, (((west, east), north), south)) in parts.enumerate() {
        let place = Place { x: first_x.wrapping_add((index * LANES) as i32), z, bounds };
        let mut buffers = [[0.0; LANES + 2]; 6];
        let [b0, b1, b2, b3, b4, b5] = &mut buffers;
        let row = |channel, dz, value, buffer| place.row(channel, dz, Beyond::Value(value), buffer);
        let ground = [row(terrain, -1, WALL_M, b0), row(terrain, 0, WALL_M, b1), row(terrain, 1, WALL_M, b2)];
        let water = [row(water, -1, 0.0, b3), row(water, 0, 0.0, b4), row(water, 1, 0.0, b5)];
        let mut flows = [[0.0; LANES]; 4];
        let [w, e, n, s] = &mut flows;
        for (part, old) in [(&mut *w, &*west), (&mut *e, &*east), (&mut *n, &*north), (&mut *s, &*south)] {
            for (value, old) in part.iter_mut().zip(old) {
                *value = *old;
            }
        }
        flow([w, e, n, s], ground, water, kernel);
        for (part, new) in [(west, w), (east, e), (north, n), (south, s)] {
            for (value, new) in part.iter_mut().zip(new) {
                *value = *new;
            }
        }
    }
}

#[inline(always)]
fn flow(
    [west, east, north, south]: [&mut [f32; LANES]; 4],
    [north_ground, ground, south_ground]: [&Padded; 3],
    [north_water, water, south_water]: [&Padded; 3],
    kernel: &PipesKernel,
) {
    let flows = west.iter_mut().zip(east).zip(north).zip(south);
    for (lane, (((west, east), north), south)) in flows.enumerate() {
        let (height, depth) = (at(ground, lane + 1), at(water, lane + 1));
        // Ground by ground and water by water: a surface far above sea level has fewer digits than either difference.
        let flow = |old: f32, ground: &Padded, water: &Padded, place| {
            let drop = (height - at(ground, place)) + (depth - at(water, place));
            positive(old * kernel.flowing + kernel.acceleration * drop)
        };
        let (w, e) = (flow(*west, ground, water, lane), flow(*east, ground, water, lane + 2));
        let n = flow(*north, north_ground, north_water, lane + 1);
        let s = flow(*south, south_ground, south_water, lane + 1);
        let all = (w + e) + (n + s);
        let scale = smaller(1.0, ((depth + kernel.rain_m) * KEPT) / larger(all, LEAST_M));
        *west = enough(w * scale);
        *east = enough(e * scale);
        *north = enough(n * scale);
        *south = enough(s * scale);
    }
}

/// A quantity, or 0 where it is next to nothing.
#[inline(always)]
fn enough(value: f32) -> f32 {
    if value >= LEAST_M { value } else { 0.0 }
}

/// Ground, water and sediment of the samples `first_x ..` of row `z` after an iteration, from those before it and the flows
/// that [`flux_row`] has brought up to date. The planes hold the row and one sample around, or end at `bounds`; `hardness`,
/// 0..1 for each sample, keeps its share of the ground from being taken up.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
#[allow(clippy::too_many_arguments, reason = "a row, where it lies, and what it is made of")]
pub fn ground_row(
    row: StateRow,
    first_x: i32,
    z: i32,
    state: &State,
    flux: &Plane,
    hardness: Option<&Plane>,
    bounds: &SampleRect,
    kernel: &PipesKernel,
) {
    let parts =
        row.terrain.chunks_mut(LANES).zip(row.water.chunks_mut(LANES)).zip(row.sediment.chunks_mut(LANES));
    for (index, ((terrain, water), sediment)) in parts.enumerate() {
        let place = Place { x: first_x.wrapping_add((index * LANES) as i32), z, bounds };
        let mut buffers = [[0.0; LANES + 2]; 16];
        let [t0, t1, t2, w0, w1, w2, s0, s1, s2, f0, f1, f2, f3, f4, f5, h0] = &mut buffers;
        let nearest = |channel, dz, buffer| place.row(channel, dz, Beyond::Nearest, buffer);
        let none = |channel, dz, buffer| place.row(channel, dz, Beyond::Value(0.0), buffer);
        let flows = |direction, dz, buffer| none(Channel(flux, direction), dz, buffer);
        let around = Around {
            terrain: [
                nearest(state.terrain, -1, t0),
                nearest(state.terrain, 0, t1),
                nearest(state.terrain, 1, t2),
            ],
            water: [none(state.water, -1, w0), none(state.water, 0, w1), none(state.water, 1, w2)],
            sediment: [
                none(state.sediment, -1, s0),
                none(state.sediment, 0, s1),
                none(state.sediment, 1, s2),
            ],
            out: [flows(WEST, 0, f0), flows(EAST, 0, f1), flows(NORTH, 0, f2), flows(SOUTH, 0, f3)],
            from_north: flows(SOUTH, -1, f4),
            from_south: flows(NORTH, 1, f5),
        };
        let soft = hardness.map(|plane| none(Channel(plane, 0), 0, h0));
        let mut new = [[0.0; LANES]; 3];
        match soft {
            Some(hardness) => around.step(&mut new, |lane| 1.0 - at(hardness, lane + 1), kernel),
            None => around.step(&mut new, |_| 1.0, kernel),
        }
        for (part, new) in [terrain, water, sediment].into_iter().zip(&new) {
            for (value, new) in part.iter_mut().zip(new) {
                *value = *new;
            }
        }
    }
}

/// What a part is made of: rows from the north, flows by direction.
struct Around<'a> {
    terrain: [&'a Padded; 3],
    water: [&'a Padded; 3],
    sediment: [&'a Padded; 3],
    out: [&'a Padded; 4],
    from_north: &'a Padded,
    from_south: &'a Padded,
}

impl Around<'_> {
    #[inline(always)]
    fn step(
        &self,
        [terrain, water, sediment]: &mut [[f32; LANES]; 3],
        soft: impl Fn(usize) -> f32,
        kernel: &PipesKernel,
    ) {
        let [north_ground, ground, south_ground] = self.terrain;
        let [north_water, own_water, south_water] = self.water;
        let [north_sediment, own_sediment, south_sediment] = self.sediment;
        let [to_west, to_east, to_north, to_south] = self.out;
        let rows = terrain.iter_mut().zip(water).zip(sediment);
        for (lane, ((terrain, water), sediment)) in rows.enumerate() {
            let here = lane + 1;
            let depth = at(own_water, here) + kernel.rain_m;
            let (out_w, out_e) = (at(to_west, here), at(to_east, here));
            let (out_n, out_s) = (at(to_north, here), at(to_south, here));
            let (in_w, in_e) = (at(to_east, lane), at(to_west, lane + 2));
            let (in_n, in_s) = (at(self.from_north, here), at(self.from_south, here));
            let left = depth - ((out_w + out_e) + (out_n + out_s));
            let new_depth = left + ((in_w + in_e) + (in_n + in_s));
            *water = enough(new_depth * kernel.staying);

            // Both ends of a pipe work out the same share.
            let carried = |sediment: &Padded, water: &Padded, place, flow: f32| {
                at(sediment, place) * (flow / larger(at(water, place) + kernel.rain_m, LEAST_M))
            };
            let gone = |flow| carried(own_sediment, own_water, here, flow);
            let lost = (gone(out_w) + gone(out_e)) + (gone(out_n) + gone(out_s));
            let won = (carried(own_sediment, own_water, lane, in_w)
                + carried(own_sediment, own_water, lane + 2, in_e))
                + (carried(north_sediment, north_water, here, in_n)
                    + carried(south_sediment, south_water, here, in_s));
            let load = positive(at(own_sediment, here) - lost) + won;

            let height = at(ground, here);
            let (west, east) = (at(ground, lane), at(ground, lane + 2));
            let (north, south) = (at(north_ground, here), at(south_ground, here));
            let (slope_x, slope_z) =
                ((east - west) * kernel.slope_scale, (south - north) * kernel.slope_scale);
            let squared = slope_x * slope_x + slope_z * slope_z;
            let sine = (squared / (1.0 + squared)).sqrt();
            let flow_x = ((in_w - out_w) + (out_e - in_e)) * 0.5;
            let flow_z = ((in_n - out_n) + (out_s - in_s)) * 0.5;
            let flow = (flow_x * flow_x + flow_z * flow_z).sqrt();
            let capacity = (kernel.capacity * larger(sine, kernel.min_slope)) * flow;

            let lowest = smaller(smaller(west, east), smaller(north, south));
            let highest = larger(larger(west, east), larger(north, south));
            let lacking = capacity - load;
            let taken = smaller((kernel.dissolving * soft(lane)) * lacking, positive(height - lowest) * 0.5);
            let room = larger(positive(highest - height), new_depth) * 0.5;
            let laid = smaller(kernel.deposition * -lacking, room);
            let new_height = sanitized_height(height - if lacking > 0.0 { taken } else { -laid });
            let new_load = load + (height - new_height);
            // A height's ulp may be more than there is to lay down.
            let is_covered = new_load >= 0.0;
            *terrain = if is_covered { new_height } else { height };
            *sediment = enough(if is_covered { new_load } else { load });
        }
    }
}

/// At the end: lays down what the water still carries.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn settle_row(terrain: &mut [f32], sediment: &[f32]) {
    for (height, sediment) in terrain.iter_mut().zip(sediment) {
        *height = sanitized_height(*height + sediment);
    }
}
