//! Thermal erosion: of ground steeper than its angle of repose, some slides to the neighbours below (Musgrave, Kolb & Mace
//! 1989, "The synthesis and rendering of eroded fractal terrains", made to keep mass).
//!
//! Over the 8 neighbours, `T` the drop that holds over the distance (√2 longer for diagonals), the *excess* towards one is
//! `e_n = max(H − H_n − T_n, 0)`. `c · max_n e_n / 2` leaves a sample, shared in proportion to `e_n`. An iteration is two
//! rows: [`shares_row`], `share = (c/2) max_n e_n / Σ e_n`, and [`heights_row`], `H ← H − Σ (share e_n − share_n e_n→)`,
//! where `e_n→` is a neighbour's excess towards the sample. Both ends of a pair work out what passes between them with the
//! same operations, so what one loses is, to the bit, what the other gets; only the sums round.
//!
//! No new extremum for `c ≤ 1/4`: as `Σ e ≥ max e`, a neighbour gives at most `(c/2) e_n→ ≤ (H_n − H)/8`, and there are 8; and
//! a sample loses at most `max e / 8`. So the new height is within the old heights of the 3 × 3 samples around it. Rounding
//! could step over by an ulp of the height only where a talus is under about 1e-6 of the drop (an angle of 0).
//!
//! A sample that gives and receives nothing keeps its bits.
//!
//! An iteration needs 2 samples more around: the shares one, the heights another.

use multiversion::multiversion;
use orogeny_field::{Plane, SampleRect, ThermalKernel, ThermalLayer, sanitized_height};

use super::padded::{Beyond, Channel, LANES, Padded, Place, at, larger, positive};

/// How many samples around its own an iteration reads.
pub const HALO: i32 = 2;

/// Channels of the plane of shares: themselves, and with more than one layer of rock the drops that hold, in metres.
pub const SHARES: u32 = 0;
/// See [`SHARES`].
pub const TALUSES: u32 = 1;

/// What stands where there is no neighbour: nothing slides up it, and, having no share, nothing slides down.
const WALL_M: f32 = 1.0e30;

/// Smaller excesses, in metres, do not move: no sum of them is denormal.
const LEAST_EXCESS_M: f32 = 1.0e-30;

/// Hardness of the ground, 0..1, for each sample; at 1 nothing leaves it.
pub type Hardness<'a> = Option<&'a Plane>;

/// The shares of the samples `first_x ..` of row `z`, 0..1/8, from the heights of a rectangle that holds the row and one sample
/// around, or ends at `bounds`.
///
/// With more than one layer of rock `taluses` gets the drops that hold, in metres; with one it is not written and may be
/// empty.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
#[allow(clippy::too_many_arguments, reason = "a row, where it lies, and what it is made of")]
pub fn shares_row(
    shares: &mut [f32],
    taluses: &mut [f32],
    first_x: i32,
    z: i32,
    heights: &Plane,
    hardness: Hardness,
    bounds: &SampleRect,
    kernel: &ThermalKernel,
) {
    let [lowest, above @ ..] = &kernel.layers;
    let above = above.get(..(kernel.num_layers as usize).saturating_sub(1)).unwrap_or_default();
    let mut taluses = taluses.chunks_mut(LANES);
    for (index, shares) in shares.chunks_mut(LANES).enumerate() {
        let place = Place { x: first_x.wrapping_add((index * LANES) as i32), z, bounds };
        let mut buffers = [[0.0; LANES + 2]; 4];
        let [b0, b1, b2, b3] = &mut buffers;
        let row = |dz, buffer| place.row(Channel(heights, 0), dz, Beyond::Value(WALL_M), buffer);
        let rows = [row(-1, b0), row(0, b1), row(1, b2)];
        let mut new = [0.0; LANES];
        if above.is_empty() {
            share(&mut new, rows, |_| (lowest.talus_m, lowest.half_rate));
        } else {
            let mut rock = Rock { talus_m: [lowest.talus_m; LANES], half_rate: [lowest.half_rate; LANES] };
            rock.pile_up(rows[1], above);
            share(&mut new, rows, |lane| (at(&rock.talus_m, lane), at(&rock.half_rate, lane)));
            for (talus, value) in taluses.next().unwrap_or_default().iter_mut().zip(rock.talus_m) {
                *talus = value;
            }
        }
        if let Some(hardness) = hardness {
            let hardness = place.row(Channel(hardness, 0), 0, Beyond::Value(0.0), b3);
            for (lane, share) in new.iter_mut().enumerate() {
                *share *= 1.0 - at(hardness, lane + 1);
            }
        }
        for (share, value) in shares.iter_mut().zip(new) {
            *share = value;
        }
    }
}

/// Talus and half rate of the layers that heights lie in.
struct Rock {
    talus_m: [f32; LANES],
    half_rate: [f32; LANES],
}

impl Rock {
    /// Whatever lies in a layer above the lowest; layer by layer, so that the samples of a part are worked on at once.
    #[inline(always)]
    fn pile_up(&mut self, heights: &Padded, above: &[ThermalLayer]) {
        for layer in above {
            for (lane, (talus_m, half_rate)) in self.talus_m.iter_mut().zip(&mut self.half_rate).enumerate() {
                let is_there = at(heights, lane + 1) >= layer.from_m;
                *talus_m = if is_there { layer.talus_m } else { *talus_m };
                *half_rate = if is_there { layer.half_rate } else { *half_rate };
            }
        }
    }
}

/// Shares of a part; `rock(lane)` is the drop that holds, and half the rate.
#[inline(always)]
fn share(
    shares: &mut [f32; LANES],
    [north, centre, south]: [&Padded; 3],
    rock: impl Fn(usize) -> (f32, f32),
) {
    for (lane, share) in shares.iter_mut().enumerate() {
        let height = at(centre, lane + 1);
        let (talus_m, half_rate) = rock(lane);
        let diagonal_m = talus_m * std::f32::consts::SQRT_2;
        let straight = |row: &Padded, place| positive((height - at(row, place)) - talus_m);
        let diagonal = |row: &Padded, place| positive((height - at(row, place)) - diagonal_m);
        let (w, e) = (straight(centre, lane), straight(centre, lane + 2));
        let (n, s) = (straight(north, lane + 1), straight(south, lane + 1));
        let (nw, se) = (diagonal(north, lane), diagonal(south, lane + 2));
        let (ne, sw) = (diagonal(north, lane + 2), diagonal(south, lane));
        let largest = larger(larger(larger(w, e), larger(n, s)), larger(larger(nw, se), larger(ne, sw)));
        // Opposite neighbours first: a mirrored field gives mirrored bits.
        let sum = ((w + e) + (n + s)) + ((nw + se) + (ne + sw));
        *share = if largest > LEAST_EXCESS_M { (half_rate * largest) / sum } else { 0.0 };
    }
}

/// The new heights of the samples `first_x ..` of row `z`, from the heights and the shares (and, with more than one layer of
/// rock, the drops that hold, in a channel of their own) of rectangles that hold the row and one sample around, or end at `bounds`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
#[allow(clippy::too_many_arguments, reason = "a row, where it lies, and what it is made of")]
pub fn heights_row(
    new_heights: &mut [f32],
    first_x: i32,
    z: i32,
    heights: &Plane,
    shares: &Plane,
    bounds: &SampleRect,
    kernel: &ThermalKernel,
) {
    let [lowest, ..] = &kernel.layers;
    let same = [lowest.talus_m; LANES + 2];
    for (index, new_heights) in new_heights.chunks_mut(LANES).enumerate() {
        let place = Place { x: first_x.wrapping_add((index * LANES) as i32), z, bounds };
        let mut buffers = [[0.0; LANES + 2]; 9];
        let [b0, b1, b2, b3, b4, b5, b6, b7, b8] = &mut buffers;
        let of = |channel, value, buffers: [_; 3]| {
            let [b0, b1, b2] = buffers;
            let row = |dz, buffer| place.row(channel, dz, Beyond::Value(value), buffer);
            [row(-1, b0), row(0, b1), row(1, b2)]
        };
        let heights = of(Channel(heights, 0), WALL_M, [b0, b1, b2]);
        let (taluses, shares) = (Channel(shares, TALUSES), of(Channel(shares, SHARES), 0.0, [b3, b4, b5]));
        let new = if kernel.num_layers > 1 {
            let [north, centre, south] = of(taluses, 0.0, [b6, b7, b8]);
            settled(heights, shares, [north, centre, south])
        } else {
            settled(heights, shares, [&same; 3])
        };
        for (height, value) in new_heights.iter_mut().zip(new) {
            *height = value;
        }
    }
}

/// New heights of a part, from the heights, the shares and the drops that hold in the rows from the north on.
#[inline(always)]
fn settled(
    [north, centre, south]: [&Padded; 3],
    [north_shares, shares, south_shares]: [&Padded; 3],
    [north_taluses, taluses, south_taluses]: [&Padded; 3],
) -> [f32; LANES] {
    let mut new = [0.0; LANES];
    for (lane, new) in new.iter_mut().enumerate() {
        let (height, share, talus_m) = (at(centre, lane + 1), at(shares, lane + 1), at(taluses, lane + 1));
        let diagonal_m = talus_m * std::f32::consts::SQRT_2;
        // What the sample gives a neighbour, less what it is given.
        let net = |row: &Padded, row_shares: &Padded, holding_m: f32, there_m: f32, place| {
            let drop = height - at(row, place);
            share * positive(drop - holding_m) - at(row_shares, place) * positive(-drop - there_m)
        };
        let straight = |row: &Padded, row_shares: &Padded, row_taluses: &Padded, place| {
            net(row, row_shares, talus_m, at(row_taluses, place), place)
        };
        let diagonal = |row: &Padded, row_shares: &Padded, row_taluses: &Padded, place| {
            net(row, row_shares, diagonal_m, at(row_taluses, place) * std::f32::consts::SQRT_2, place)
        };
        let w = straight(centre, shares, taluses, lane);
        let e = straight(centre, shares, taluses, lane + 2);
        let n = straight(north, north_shares, north_taluses, lane + 1);
        let s = straight(south, south_shares, south_taluses, lane + 1);
        let nw = diagonal(north, north_shares, north_taluses, lane);
        let ne = diagonal(north, north_shares, north_taluses, lane + 2);
        let sw = diagonal(south, south_shares, south_taluses, lane);
        let se = diagonal(south, south_shares, south_taluses, lane + 2);
        *new = sanitized_height(height - (((w + e) + (n + s)) + ((nw + se) + (ne + sw))));
    }
    new
}
