// The integer hash behind everything random: PCG-3D (Jarzynski & Olano 2020). Twin: orogeny_reference::hash.

// 32 random bits of a place and a seed.
fn hash(x: u32, y: u32, seed: u32) -> u32 {
    var v = vec3<u32>(x, y, seed) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    return v.x + v.y * v.z;
}

// Uniform in -1..1, from the upper 24 bits.
fn signed_uniform(x: u32, y: u32, seed: u32) -> f32 {
    return 2.0 * (f32(hash(x, y, seed) >> 8u) * 5.9604645e-8) - 1.0;
}
