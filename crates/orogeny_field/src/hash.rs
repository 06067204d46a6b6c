//! The integer hash behind everything random: PCG-3D (Jarzynski & Olano, "Hash Functions for GPU Rendering", 2020).

/// 32 random bits of a place and a seed.
#[inline(always)]
#[must_use]
pub const fn hash(x: u32, y: u32, seed: u32) -> u32 {
    const MULTIPLIER: u32 = 1_664_525;
    const INCREMENT: u32 = 1_013_904_223;
    let mut vx = x.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT);
    let mut vy = y.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT);
    let mut vz = seed.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT);
    vx = vx.wrapping_add(vy.wrapping_mul(vz));
    vy = vy.wrapping_add(vz.wrapping_mul(vx));
    vz = vz.wrapping_add(vx.wrapping_mul(vy));
    vx ^= vx >> 16;
    vy ^= vy >> 16;
    vz ^= vz >> 16;
    // Of the last round only `x` is asked for.
    vx.wrapping_add(vy.wrapping_mul(vz))
}

/// Uniform in 0..1, from the upper 24 bits.
#[inline(always)]
#[must_use]
pub const fn uniform(x: u32, y: u32, seed: u32) -> f32 {
    bits_to_uniform(hash(x, y, seed))
}

/// Uniform in -1..1.
#[inline(always)]
#[must_use]
pub const fn signed_uniform(x: u32, y: u32, seed: u32) -> f32 {
    bits_to_signed(hash(x, y, seed))
}

/// 0..1 from the upper 24 of 32 random bits.
#[inline(always)]
#[must_use]
pub const fn bits_to_uniform(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// -1..1 from the upper 24 of 32 random bits.
#[inline(always)]
#[must_use]
pub const fn bits_to_signed(bits: u32) -> f32 {
    2.0 * bits_to_uniform(bits) - 1.0
}
