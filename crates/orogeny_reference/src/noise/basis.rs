//! One octave of noise at a place of its lattice: the value, about -1..1, and its gradient in lattice coordinates.
//!
//! A place is a cell, wrapped to 32 bits, and what remains within it. Formulas: section 6 of the kernel specification for
//! gradient noise; Perlin (2002) for its curve; Worley (1996); Gustavson, "Simplex noise demystified" (2005); Lewis, "Algorithms
//! for solid noise synthesis" (1989).

use super::Real;
use crate::hash::hash;

/// A value and its derivatives along the two axes of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<T> {
    /// The value.
    pub value: T,
    /// Its derivative along x.
    pub dx: T,
    /// Its derivative along the other axis.
    pub dy: T,
}

/// `2 / (cos pi/8 + sin pi/8)`: the largest value of gradient noise is about 1.
const GRADIENT_SCALE: f64 = 1.530_733_729_460_359;
/// What makes the largest value of simplex noise 1 (`tests/fixtures/noise/make.py`).
const SIMPLEX_SCALE: f64 = 100.040_101;
/// The same in three dimensions.
const SIMPLEX_3D_SCALE: f64 = 76.880_75;
/// One over three standard deviations of two bumps a cell: `sigma^2 = 2 (1/3) (pi / 7)`.
const SPARSE_SCALE: f64 = 0.609_394_399_4;
/// Bumps in a cell.
const SPARSE_IMPULSES: u32 = 2;

/// One of eight unit vectors, 22.5 degrees off the axes and the diagonals, from the upper three of 32 random bits: number `k`
/// is `(cos, sin)` of `(1 + 2k) pi / 8`.
#[inline(always)]
fn direction<T: Real>(bits: u32) -> [T; 2] {
    let (long, short) = (T::of(0.923_879_532_511_286_7), T::of(0.382_683_432_365_089_8));
    // In terms of the bits of `k`, from the topmost: y is negative by the first, x by the first or the second but not both, and
    // the two change places by the second or the third but not both.
    let is_swapped = ((bits << 1) ^ (bits << 2)).cast_signed() < 0;
    let (x, y) = if is_swapped { (short, long) } else { (long, short) };
    [x.turned_by(bits ^ (bits << 1)), y.turned_by(bits)]
}

/// The place within a cell of a random point, from 32 random bits: 16 for each axis, never on the cell's border.
#[inline(always)]
fn jitter<T: Real>(bits: u32) -> [T; 2] {
    let along = |bits: u32| (T::of(f64::from(bits)) + T::of(0.5)) * T::of(1.0 / 65_536.0);
    [along(bits >> 16), along(bits & 0xffff)]
}

/// `6 t^5 - 15 t^4 + 10 t^3`.
#[inline(always)]
fn fade<T: Real>(t: T) -> T {
    t * t * t * (t * (t * T::of(6.0) - T::of(15.0)) + T::of(10.0))
}

/// The derivative of [`fade`].
#[inline(always)]
fn fade_slope<T: Real>(t: T) -> T {
    T::of(30.0) * t * t * (t * (t - T::of(2.0)) + T::of(1.0))
}

/// Perlin's gradient noise.
#[inline(always)]
pub fn gradient<T: Real>([cx, cy]: [u32; 2], [fx, fy]: [T; 2], seed: u32) -> Sample<T> {
    let one = T::of(1.0);
    let (cx1, cy1) = (cx.wrapping_add(1), cy.wrapping_add(1));
    let [g00x, g00y] = direction::<T>(hash(cx, cy, seed));
    let [g10x, g10y] = direction::<T>(hash(cx1, cy, seed));
    let [g01x, g01y] = direction::<T>(hash(cx, cy1, seed));
    let [g11x, g11y] = direction::<T>(hash(cx1, cy1, seed));
    let (gx, gy) = (fx - one, fy - one);
    let a = g00x * fx + g00y * fy;
    let b = g10x * gx + g10y * fy;
    let c = g01x * fx + g01y * gy;
    let d = g11x * gx + g11y * gy;
    let (u, v) = (fade(fx), fade(fy));
    let (du, dv) = (fade_slope(fx), fade_slope(fy));
    let uv = u * v;
    let scale = T::of(GRADIENT_SCALE);
    let twist = a - b - c + d;
    Sample {
        value: scale * (a + u * (b - a) + v * (c - a) + uv * twist),
        dx: scale
            * (g00x
                + u * (g10x - g00x)
                + v * (g01x - g00x)
                + uv * (g00x - g10x - g01x + g11x)
                + du * ((b - a) + v * twist)),
        dy: scale
            * (g00y
                + u * (g10y - g00y)
                + v * (g01y - g00y)
                + uv * (g00y - g10y - g01y + g11y)
                + dv * ((c - a) + u * twist)),
    }
}

/// Random values joined by Catmull-Rom curves.
#[inline(always)]
pub fn value<T: Real>([cx, cy]: [u32; 2], [fx, fy]: [T; 2], seed: u32) -> Sample<T> {
    let weights = |f: T| -> [T; 4] {
        let half = T::of(0.5);
        [
            ((T::of(2.0) - f) * f - T::of(1.0)) * f * half,
            ((T::of(3.0) * f - T::of(5.0)) * f * f + T::of(2.0)) * half,
            ((T::of(4.0) - T::of(3.0) * f) * f + T::of(1.0)) * f * half,
            (f - T::of(1.0)) * f * f * half,
        ]
    };
    let slopes = |f: T| -> [T; 4] {
        let half = T::of(0.5);
        [
            ((T::of(4.0) - T::of(3.0) * f) * f - T::of(1.0)) * half,
            (T::of(9.0) * f - T::of(10.0)) * f * half,
            ((T::of(8.0) - T::of(9.0) * f) * f + T::of(1.0)) * half,
            (T::of(3.0) * f - T::of(2.0)) * f * half,
        ]
    };
    let (along_x, along_y) = (weights(fx), weights(fy));
    let (slope_x, slope_y) = (slopes(fx), slopes(fy));
    let zero = T::of(0.0);
    let mut sum = Sample { value: zero, dx: zero, dy: zero };
    for (j, (weight_y, slope_y)) in (0..).zip(along_y.into_iter().zip(slope_y)) {
        let y = cy.wrapping_add(j).wrapping_sub(1);
        let (mut row, mut row_slope) = (zero, zero);
        for (i, (weight_x, slope_x)) in (0..).zip(along_x.into_iter().zip(slope_x)) {
            let corner = T::signed(hash(cx.wrapping_add(i).wrapping_sub(1), y, seed));
            row += weight_x * corner;
            row_slope += slope_x * corner;
        }
        sum.value += weight_y * row;
        sum.dx += weight_y * row_slope;
        sum.dy += slope_y * row;
    }
    sum
}

/// A nearest point: its squared distance, and the way from it.
#[derive(Clone, Copy)]
struct Nearest<T> {
    squared: T,
    x: T,
    y: T,
}

/// Distances to the four nearest of points scattered one a cell: `2 clamp(sum of w_d F_d, 0, 1) - 1`.
///
/// Four points always lie within 1.85 cells: those of the four cells about the nearest corner, or, from well within a cell, its
/// own and three of its neighbours'. Every point outside the 5 x 5 cells about a place is 2 or more away.
#[inline(always)]
pub fn worley<T: Real>([cx, cy]: [u32; 2], [fx, fy]: [T; 2], seed: u32, weights: [T; 4]) -> Sample<T> {
    let zero = T::of(0.0);
    let far = Nearest { squared: T::of(1.0e9), x: zero, y: zero };
    let [mut first, mut second, mut third, mut fourth] = [far; 4];
    for j in -2_i32..=2 {
        for i in -2_i32..=2 {
            let bits = hash(cx.wrapping_add_signed(i), cy.wrapping_add_signed(j), seed);
            let [px, py] = jitter::<T>(bits);
            let x = fx - (T::of(f64::from(i)) + px);
            let y = fy - (T::of(f64::from(j)) + py);
            let mut next = Nearest { squared: x * x + y * y, x, y };
            for kept in [&mut first, &mut second, &mut third, &mut fourth] {
                let is_nearer = next.squared < kept.squared;
                let (near, rest) = if is_nearer { (next, *kept) } else { (*kept, next) };
                *kept = near;
                next = rest;
            }
        }
    }
    let (mut sum, mut dx, mut dy) = (zero, zero, zero);
    for (weight, nearest) in weights.into_iter().zip([first, second, third, fourth]) {
        let distance = nearest.squared.sqrt();
        let per_distance = if distance > zero { weight / distance } else { zero };
        sum += weight * distance;
        dx += per_distance * nearest.x;
        dy += per_distance * nearest.y;
    }
    let (one, two) = (T::of(1.0), T::of(2.0));
    let slope = if sum > zero && sum < one { two } else { zero };
    Sample { value: two * sum.most(zero).least(one) - one, dx: slope * dx, dy: slope * dy }
}

/// One corner of a simplex: `(1/2 - r^2)^4` times the slope along its direction.
#[inline(always)]
fn corner<T: Real, const N: usize>(direction: [T; N], way: [T; N], sum: &mut T, slope: &mut [T; N]) {
    let zero = T::of(0.0);
    let mut squared = zero;
    let mut along = zero;
    for (way, direction) in way.into_iter().zip(direction) {
        squared += way * way;
        along += way * direction;
    }
    let t = (T::of(0.5) - squared).most(zero);
    let (t2, t3) = (t * t, t * t * t);
    *sum += t2 * t2 * along;
    for (slope, (way, direction)) in slope.iter_mut().zip(way.into_iter().zip(direction)) {
        *slope += t2 * t2 * direction - T::of(8.0) * t3 * along * way;
    }
}

/// Gradient noise over triangles. Cells and fractions are skewed.
#[inline(always)]
pub fn simplex<T: Real>([cx, cy]: [u32; 2], [fx, fy]: [T; 2], seed: u32) -> Sample<T> {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    // (3 - sqrt(3)) / 6
    let unskew = T::of(0.211_324_865_405_187_1);
    let shift = (fx + fy) * unskew;
    let (x0, y0) = (fx - shift, fy - shift);
    let is_right = x0 > y0;
    let (i, j) = if is_right { (1, 0) } else { (0, 1) };
    let (i_real, j_real) = if is_right { (one, zero) } else { (zero, one) };
    let two_unskew = unskew + unskew;
    let (mut sum, mut slope) = (zero, [zero; 2]);
    let (cx1, cy1) = (cx.wrapping_add(1), cy.wrapping_add(1));
    corner(direction::<T>(hash(cx, cy, seed)), [x0, y0], &mut sum, &mut slope);
    let middle = hash(cx.wrapping_add(i), cy.wrapping_add(j), seed);
    corner(direction::<T>(middle), [x0 - i_real + unskew, y0 - j_real + unskew], &mut sum, &mut slope);
    let last = [x0 - one + two_unskew, y0 - one + two_unskew];
    corner(direction::<T>(hash(cx1, cy1, seed)), last, &mut sum, &mut slope);
    let scale = T::of(SIMPLEX_SCALE);
    let [dx, dy] = slope;
    Sample { value: scale * sum, dx: scale * dx, dy: scale * dy }
}

/// One of the twelve ways to the middles of a cube's edges.
#[inline(always)]
fn edge<T: Real>([cx, cy, cw]: [u32; 3], seed: u32) -> [T; 3] {
    let bits = hash(cx, cy, hash(cw, 0x53, seed));
    let index = ((bits >> 16) * 12) >> 16;
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let first = if index & 1 == 1 { -one } else { one };
    let second = if index & 2 == 2 { -one } else { one };
    let (is_xy, is_yw) = (index < 4, index >= 8);
    [
        if is_yw { zero } else { first },
        if is_xy {
            second
        } else if is_yw {
            first
        } else {
            zero
        },
        if is_xy { zero } else { second },
    ]
}

/// Adds the corner of a tetrahedron that lies `steps` from the cell's, each of which leads `back` too far along all axes.
#[inline(always)]
fn add_corner<T: Real>(
    [cx, cy, cw]: [u32; 3],
    [x, y, w]: [T; 3],
    [sx, sy, sw]: [bool; 3],
    back: T,
    seed: u32,
    sum: &mut T,
    slope: &mut [T; 3],
) {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let way = [
        x - if sx { one } else { zero } + back,
        y - if sy { one } else { zero } + back,
        w - if sw { one } else { zero } + back,
    ];
    let cell =
        [cx.wrapping_add(u32::from(sx)), cy.wrapping_add(u32::from(sy)), cw.wrapping_add(u32::from(sw))];
    corner(edge::<T>(cell, seed), way, sum, slope);
}

/// A plane through gradient noise over tetrahedra. Cells and fractions are skewed.
#[inline(always)]
pub fn simplex_3d<T: Real>([cx, cy, cw]: [u32; 3], [fx, fy, fw]: [T; 3], seed: u32) -> Sample<T> {
    let zero = T::of(0.0);
    let unskew = T::of(1.0 / 6.0);
    let shift = (fx + fy + fw) * unskew;
    let (x0, y0, w0) = (fx - shift, fy - shift, fw - shift);
    // The order of the coordinates tells the tetrahedron.
    let (xy, yw, xw) = (x0 >= y0, y0 >= w0, x0 >= w0);
    let first = [xy && xw, !xy && yw, !xw && !yw];
    let second = [xy || xw, !xy || yw, !(xw && yw)];
    let (mut sum, mut slope) = (zero, [zero; 3]);
    let (cell, origin) = ([cx, cy, cw], [x0, y0, w0]);
    add_corner(cell, origin, [false; 3], zero, seed, &mut sum, &mut slope);
    add_corner(cell, origin, first, unskew, seed, &mut sum, &mut slope);
    add_corner(cell, origin, second, unskew + unskew, seed, &mut sum, &mut slope);
    add_corner(cell, origin, [true; 3], unskew + unskew + unskew, seed, &mut sum, &mut slope);
    let scale = T::of(SIMPLEX_3D_SCALE);
    let [dx, dy, _] = slope;
    Sample { value: scale * sum, dx: scale * dx, dy: scale * dy }
}

/// Bumps of random height at random places: `(1 - r^2)^3` each.
#[inline(always)]
pub fn sparse<T: Real>([cx, cy]: [u32; 2], [fx, fy]: [T; 2], seed: u32) -> Sample<T> {
    let zero = T::of(0.0);
    let mut sum = Sample { value: zero, dx: zero, dy: zero };
    for impulse in 0..SPARSE_IMPULSES {
        let impulse_seed = hash(impulse, 0x5c, seed);
        for j in -1_i32..=1 {
            for i in -1_i32..=1 {
                let bits = hash(cx.wrapping_add_signed(i), cy.wrapping_add_signed(j), impulse_seed);
                let [px, py] = jitter::<T>(bits);
                let amplitude = T::signed(hash(bits, impulse, seed));
                let x = fx - (T::of(f64::from(i)) + px);
                let y = fy - (T::of(f64::from(j)) + py);
                let t = (T::of(1.0) - (x * x + y * y)).most(zero);
                let t2 = amplitude * (t * t);
                sum.value += t2 * t;
                let slope = t2 * T::of(-6.0);
                sum.dx += slope * x;
                sum.dy += slope * y;
            }
        }
    }
    let scale = T::of(SPARSE_SCALE);
    Sample { value: scale * sum.value, dx: scale * sum.dx, dy: scale * sum.dy }
}
