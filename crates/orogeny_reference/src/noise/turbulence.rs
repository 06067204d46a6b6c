//! Octaves summed (section 7 of the kernel specification), for a group of samples at once.
//!
//! Sources: Perlin (1985) for the absolute values; Quilez, "Value noise derivatives"; de Carpentier (2008), section 8.3.3, and
//! his later Swiss and Jordan turbulences; Musgrave in Ebert et al., "Texturing and Modeling", for the three multifractals.

use orogeny_field::CurveTable;
use orogeny_field::noise::{Basis, NoiseKernel, Turbulence, skewed};

use super::basis::{self, Sample};
use super::{LANES, Real};
use crate::curve::look_up;

/// One number for each sample of a group.
pub type Lanes<T> = [T; LANES];

/// How far an erosive turbulence bends along its slopes, and how its height tells its roughness.
const EROSIVE_WARP: f64 = 0.15;
const EROSIVE_ROUGHNESS: f64 = 1.1;
/// de Carpentier's published parameters of Jordan turbulence.
const JORDAN_FIRST_GAIN: f64 = 0.8;
const JORDAN_FIRST_WARP: f64 = 0.4;
const JORDAN_WARP: f64 = 0.35;
const JORDAN_DAMP: f64 = 0.8;

/// Where a group of samples lies on the lattices of a noise.
pub trait Places<T> {
    /// What is the same for all samples of the group on one octave's lattice.
    type Octave: Copy;

    /// Octave `l` of turbulence `m`, 0 the main one.
    fn octave(&self, m: u32, l: u32) -> Self::Octave;

    /// The cell from whose corner places are told, and the octave's seed.
    fn origin(octave: &Self::Octave) -> ([u32; 3], u32);

    /// Where sample `lane` of the group lies, from that corner. Called in the loop over samples, which it must not keep from
    /// becoming vector instructions.
    fn place(octave: &Self::Octave, lane: usize) -> [T; 3];
}

/// What moves places, a list for each axis of the plane, and by how many cells one of it moves them.
type Bend<'a, T> = (&'a [Lanes<T>; 2], T);

/// The values of one octave, and their gradients where they were asked for.
struct Values<T> {
    value: Lanes<T>,
    dx: Lanes<T>,
    dy: Lanes<T>,
}

/// The raw sum at each sample of a group: `T(p + weight (D1, D2))`; with a roughness `r`, 0..1, octave `l` weighs `w^l r^l`.
#[inline(always)]
pub fn sum<T: Real>(kernel: &NoiseKernel, places: &impl Places<T>, roughness: Option<&Lanes<T>>) -> Lanes<T> {
    let zero = T::of(0.0);
    let mut shift = [[zero; LANES]; 2];
    if kernel.slots.distortion > 0 {
        let weight = T::of(kernel.distortion_weight);
        for (m, shift) in [1, 2].into_iter().zip(&mut shift) {
            *shift = sum_of(kernel, kernel.distortion_turbulence, m, places, None, None)
                .map(|number| weight * number);
        }
        sum_of(kernel, kernel.turbulence, 0, places, Some(&shift), roughness)
    } else {
        sum_of(kernel, kernel.turbulence, 0, places, None, roughness)
    }
}

/// The raw sum of one turbulence, looked up `shift` feature sizes away.
#[inline(always)]
fn sum_of<T: Real>(
    kernel: &NoiseKernel,
    turbulence: Turbulence,
    m: u32,
    places: &impl Places<T>,
    shift: Option<&[Lanes<T>; 2]>,
    roughness: Option<&Lanes<T>>,
) -> Lanes<T> {
    let summing = Summing {
        kernel,
        m,
        places,
        shift,
        roughness,
        num_octaves: if m == 0 { kernel.slots.main } else { kernel.slots.distortion },
    };
    match turbulence {
        Turbulence::Fbm => summing.plain(|n| n),
        Turbulence::Billowy => summing.plain(|n| n.abs().least(T::of(1.0))),
        Turbulence::Ridged => summing.plain(|n| T::of(1.0) - n.abs().least(T::of(1.0))),
        Turbulence::Quilez => summing.quilez(),
        Turbulence::Erosive => summing.erosive(),
        Turbulence::Jordan => summing.jordan(),
        Turbulence::Heterogeneous => summing.heterogeneous(),
        Turbulence::Multiplicative => summing.multiplicative(),
        Turbulence::Hybrid => summing.hybrid(),
    }
}

/// One turbulence being summed.
struct Summing<'a, T, P> {
    kernel: &'a NoiseKernel,
    m: u32,
    places: &'a P,
    shift: Option<&'a [Lanes<T>; 2]>,
    roughness: Option<&'a Lanes<T>>,
    num_octaves: u32,
}

impl<T: Real, P: Places<T>> Summing<'_, T, P> {
    #[inline(always)]
    fn weight(&self, l: u32) -> T {
        let slot = self.kernel.slots.index(self.m, l);
        T::of(self.kernel.scales.get(slot).map_or(0.0, |scale| scale.weight))
    }

    /// What octave `l` weighs at each sample, from what the one before it did without its own weight.
    #[inline(always)]
    fn rougher(&self, l: u32, power: &mut Lanes<T>) {
        if let Some(roughness) = self.roughness.filter(|_| l > 0) {
            for (power, roughness) in power.iter_mut().zip(roughness) {
                *power = *power * *roughness;
            }
        }
    }

    #[inline(always)]
    fn frequency(&self, l: u32) -> T {
        let slot = self.kernel.slots.index(self.m, l);
        T::of(self.kernel.scales.get(slot).map_or(0.0, |scale| scale.frequency))
    }

    /// The values of octave `l`, moved by what distorts the noise and by `bend`.
    #[inline(always)]
    fn octave<const GRADIENT: bool>(&self, l: u32, bend: Option<Bend<'_, T>>) -> Values<T> {
        let octave = self.places.octave(self.m, l);
        let shift = self.shift.map(|shift| (shift, self.frequency(l)));
        let mut values = match (shift, bend) {
            (None, None) => {
                evaluate::<T, P, GRADIENT, false>(self.kernel, &octave, &[[T::of(0.0); LANES]; 2])
            }
            (Some(one), None) | (None, Some(one)) => {
                evaluate::<T, P, GRADIENT, true>(self.kernel, &octave, &in_cells(one))
            }
            (Some(shift), Some(bend)) => {
                let (mut both, [bend_x, bend_y]) = (in_cells(shift), in_cells(bend));
                for (axis, bend) in both.iter_mut().zip([bend_x, bend_y]) {
                    for (number, bend) in axis.iter_mut().zip(bend) {
                        *number += bend;
                    }
                }
                evaluate::<T, P, GRADIENT, true>(self.kernel, &octave, &both)
            }
        };
        if let Some(table) = &self.kernel.transfer {
            transfer::<T, GRADIENT>(table, &mut values);
        }
        values
    }

    #[inline(always)]
    fn plain(&self, of: impl Fn(T) -> T) -> Lanes<T> {
        self.folded(T::of(0.0), |_, weight, sum, value| sum + weight * of(value))
    }

    /// `sum of w^l N_l / (1 + |D_l|^2)`, `D_l` the sum of the gradients so far.
    #[inline(always)]
    fn quilez(&self) -> Lanes<T> {
        let zero = T::of(0.0);
        let (mut sum, mut slope, mut power) = ([zero; LANES], [[zero; LANES]; 2], [T::of(1.0); LANES]);
        for l in 0..self.num_octaves {
            let weight = self.weight(l);
            self.rougher(l, &mut power);
            let values = self.octave::<true>(l, None);
            let [slope_x, slope_y] = &mut slope;
            for (lane, power) in power.iter().enumerate() {
                let Some((sum, [value, dx, dy], [slope_x, slope_y])) =
                    of_lane(lane, &mut sum, &values, slope_x, slope_y)
                else {
                    continue;
                };
                *slope_x += dx;
                *slope_y += dy;
                *sum += weight * *power * value / (T::of(1.0) + (*slope_x * *slope_x + *slope_y * *slope_y));
            }
        }
        sum
    }

    /// `h += g (1 - |q|)`, `D += g (-q) grad q`, `g <- g w clamp(beta h, 0, 1)`, with `q = N_l(lambda^l (p + alpha D))`.
    #[inline(always)]
    fn erosive(&self) -> Lanes<T> {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let gain = T::of(self.gain());
        let warp = T::of(EROSIVE_WARP);
        let (mut sum, mut slope, mut weight) = ([zero; LANES], [[zero; LANES]; 2], [one; LANES]);
        let mut power = [one; LANES];
        for l in 0..self.num_octaves {
            self.rougher(l, &mut power);
            let bend = slope.map(|slope| slope.map(|number| warp * number));
            let values = self.octave::<true>(l, Some((&bend, self.frequency(l))));
            let [slope_x, slope_y] = &mut slope;
            for (lane, (weight, power)) in weight.iter_mut().zip(power).enumerate() {
                let Some((sum, [value, dx, dy], [slope_x, slope_y])) =
                    of_lane(lane, &mut sum, &values, slope_x, slope_y)
                else {
                    continue;
                };
                *sum += *weight * power * (one - value.abs().least(one));
                let down = -(*weight * power * value);
                *slope_x += down * dx;
                *slope_y += down * dy;
                *weight = *weight * gain * (T::of(EROSIVE_ROUGHNESS) * *sum).most(zero).least(one);
            }
        }
        sum
    }

    /// de Carpentier's Jordan turbulence, bent in cells of each octave as published.
    #[inline(always)]
    fn jordan(&self) -> Lanes<T> {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let gain = T::of(self.gain());
        let (mut sum, mut bend, mut damp) = ([zero; LANES], [[zero; LANES]; 2], [[zero; LANES]; 2]);
        let (mut weight, mut power) = ([one; LANES], [one; LANES]);
        let mut amplitude = T::of(JORDAN_FIRST_GAIN);
        for l in 0..self.num_octaves {
            self.rougher(l, &mut power);
            let values = self.octave::<true>(l, (l > 0).then_some((&bend, one)));
            let (warp, damping) = if l == 0 {
                (T::of(JORDAN_FIRST_WARP), one)
            } else {
                amplitude = amplitude * gain;
                (T::of(JORDAN_WARP), T::of(JORDAN_DAMP))
            };
            let ([bend_x, bend_y], [damp_x, damp_y]) = (&mut bend, &mut damp);
            for (lane, ((bend_x, bend_y), power)) in bend_x.iter_mut().zip(bend_y).zip(power).enumerate() {
                let (Some((sum, [value, dx, dy], [damp_x, damp_y])), Some(weight)) =
                    (of_lane(lane, &mut sum, &values, damp_x, damp_y), weight.get_mut(lane))
                else {
                    continue;
                };
                *sum += *weight * power * value * value;
                *bend_x += warp * value * dx;
                *bend_y += warp * value * dy;
                *damp_x += damping * value * dx;
                *damp_y += damping * value * dy;
                *weight = if l == 0 {
                    amplitude * gain
                } else {
                    amplitude * (one - one / (one + (*damp_x * *damp_x + *damp_y * *damp_y)))
                };
            }
        }
        sum
    }

    /// `h += (N_l + e) w^l h`.
    #[inline(always)]
    fn heterogeneous(&self) -> Lanes<T> {
        let elevation = T::of(self.kernel.elevation);
        self.folded(T::of(0.0), |l, weight, sum, value| {
            if l == 0 { elevation + value } else { sum + (value + elevation) * weight * sum }
        })
    }

    /// The product of `w^l N_l + e`.
    #[inline(always)]
    fn multiplicative(&self) -> Lanes<T> {
        let elevation = T::of(self.kernel.elevation);
        self.folded(T::of(1.0), |_, weight, sum, value| sum * (weight * value + elevation))
    }

    /// Octave after octave, what `next` makes of its number, its weight, the sum so far and its value.
    #[inline(always)]
    fn folded(&self, first: T, next: impl Fn(u32, T, T, T) -> T) -> Lanes<T> {
        let (mut sum, mut power) = ([first; LANES], [T::of(1.0); LANES]);
        for l in 0..self.num_octaves {
            let weight = self.weight(l);
            self.rougher(l, &mut power);
            let values = self.octave::<false>(l, None);
            for ((sum, power), value) in sum.iter_mut().zip(power).zip(values.value) {
                *sum = next(l, weight * power, *sum, value);
            }
        }
        sum
    }

    /// Each octave counts as much as those before it were high.
    #[inline(always)]
    fn hybrid(&self) -> Lanes<T> {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let elevation = T::of(self.kernel.elevation);
        let (mut sum, mut share, mut power) = ([zero; LANES], [one; LANES], [one; LANES]);
        for l in 0..self.num_octaves {
            let weight = self.weight(l);
            self.rougher(l, &mut power);
            let values = self.octave::<false>(l, None);
            for (((sum, share), power), value) in sum.iter_mut().zip(&mut share).zip(power).zip(values.value)
            {
                let signal = (value + elevation) * (weight * power);
                let least = share.least(one);
                *sum += least * signal;
                *share = least * signal;
            }
        }
        sum
    }

    const fn gain(&self) -> f64 {
        let [main, distortion] = self.kernel.gains;
        if self.m == 0 { main } else { distortion }
    }
}

/// What belongs to one sample: its sum, its value and gradient, and what is kept for it along the two axes.
#[inline(always)]
fn of_lane<'a, T: Real>(
    lane: usize,
    sum: &'a mut Lanes<T>,
    values: &Values<T>,
    x: &'a mut Lanes<T>,
    y: &'a mut Lanes<T>,
) -> Option<(&'a mut T, [T; 3], [&'a mut T; 2])> {
    let sample = [*values.value.get(lane)?, *values.dx.get(lane)?, *values.dy.get(lane)?];
    Some((sum.get_mut(lane)?, sample, [x.get_mut(lane)?, y.get_mut(lane)?]))
}

/// A bend in cells of its octave.
#[inline(always)]
fn in_cells<T: Real>(([x, y], cells): Bend<'_, T>) -> [Lanes<T>; 2] {
    [x.map(|number| cells * number), y.map(|number| cells * number)]
}

/// One octave at all places of a group, moved by `bend`, in cells, where it is `BENT`.
#[inline(always)]
fn evaluate<T: Real, P: Places<T>, const GRADIENT: bool, const BENT: bool>(
    kernel: &NoiseKernel,
    octave: &P::Octave,
    bend: &[Lanes<T>; 2],
) -> Values<T> {
    match kernel.basis {
        Basis::Gradient => each::<T, P, Gradient, GRADIENT, BENT>(kernel, octave, bend),
        Basis::Value => each::<T, P, Value, GRADIENT, BENT>(kernel, octave, bend),
        Basis::Worley => each::<T, P, Worley, GRADIENT, BENT>(kernel, octave, bend),
        Basis::Simplex => each::<T, P, Simplex, GRADIENT, BENT>(kernel, octave, bend),
        Basis::Simplex3d => each::<T, P, Simplex3d, GRADIENT, BENT>(kernel, octave, bend),
        Basis::Sparse => each::<T, P, Sparse, GRADIENT, BENT>(kernel, octave, bend),
    }
}

/// A basis as a type, so that a loop is compiled for each; a closure might be compiled by itself, for the baseline.
trait Look {
    fn up<T: Real>(kernel: &NoiseKernel, cell: [u32; 3], fraction: [T; 3], seed: u32) -> Sample<T>;
}

macro_rules! looks {
    ($($name:ident = |$kernel:ident, [$x:ident, $y:ident, $w:ident], [$fx:ident, $fy:ident, $fw:ident], $seed:ident| $sample:expr;)*) => {$(
        struct $name;

        impl Look for $name {
            #[inline(always)]
            fn up<T: Real>($kernel: &NoiseKernel, [$x, $y, $w]: [u32; 3], [$fx, $fy, $fw]: [T; 3], $seed: u32) -> Sample<T> {
                $sample
            }
        }
    )*};
}

looks! {
    Gradient = |_kernel, [x, y, _w], [fx, fy, _fw], seed| basis::gradient([x, y], [fx, fy], seed);
    Value = |_kernel, [x, y, _w], [fx, fy, _fw], seed| basis::value([x, y], [fx, fy], seed);
    Worley = |kernel, [x, y, _w], [fx, fy, _fw], seed| {
        let [first, second, third, fourth] = kernel.worley_weights;
        let weights = [T::of(first), T::of(second), T::of(third), T::of(fourth)];
        basis::worley([x, y], [fx, fy], seed, weights)
    };
    Simplex = |_kernel, [x, y, _w], [fx, fy, _fw], seed| basis::simplex([x, y], [fx, fy], seed);
    Simplex3d = |_kernel, [x, y, w], [fx, fy, fw], seed| basis::simplex_3d([x, y, w], [fx, fy, fw], seed);
    Sparse = |_kernel, [x, y, _w], [fx, fy, _fw], seed| basis::sparse([x, y], [fx, fy], seed);
}

#[inline(always)]
#[expect(clippy::indexing_slicing, reason = "lanes are counted up to the length of each list")]
fn each<T: Real, P: Places<T>, L: Look, const GRADIENT: bool, const BENT: bool>(
    kernel: &NoiseKernel,
    octave: &P::Octave,
    [bend_x, bend_y]: &[Lanes<T>; 2],
) -> Values<T> {
    let zero = T::of(0.0);
    let mut values = Values { value: [zero; LANES], dx: [zero; LANES], dy: [zero; LANES] };
    let ([cell_x, cell_y, cell_w], seed) = P::origin(octave);
    // Skewing is linear: what it makes of the two unit vectors says all.
    let [along_x, along_y] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|axis| skewed(kernel.basis, axis).map(T::of));
    for lane in 0..LANES {
        let [mut x, mut y, mut w] = P::place(octave, lane);
        if BENT {
            let (bend_x, bend_y) = (bend_x[lane], bend_y[lane]);
            x += bend_x * along_x[0] + bend_y * along_y[0];
            y += bend_x * along_x[1] + bend_y * along_y[1];
            w += bend_x * along_x[2] + bend_y * along_y[2];
        }
        let (floor_x, floor_y, floor_w) = (x.floor(), y.floor(), w.floor());
        // Only what is bent may lead far from its block.
        let wrapped = |floor: T| if BENT { floor.wrapped() } else { floor.wrapped_near() };
        let cell = [
            cell_x.wrapping_add(wrapped(floor_x)),
            cell_y.wrapping_add(wrapped(floor_y)),
            cell_w.wrapping_add(wrapped(floor_w)),
        ];
        let found = L::up(kernel, cell, [x - floor_x, y - floor_y, w - floor_w], seed);
        values.value[lane] = found.value;
        if GRADIENT {
            values.dx[lane] = found.dx;
            values.dy[lane] = found.dy;
        }
    }
    values
}

/// Turns values into what a curve makes of them, and their gradients with them.
#[inline(always)]
fn transfer<T: Real, const GRADIENT: bool>(table: &CurveTable, values: &mut Values<T>) {
    let outputs = values.value.iter_mut().zip(&mut values.dx).zip(&mut values.dy);
    for ((value, dx), dy) in outputs {
        let (found, slope) = look_up(table, *value);
        *value = found;
        if GRADIENT {
            *dx = slope * *dx;
            *dy = slope * *dy;
        }
    }
}
