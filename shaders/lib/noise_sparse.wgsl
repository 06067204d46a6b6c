// Bumps of random height at random places (Lewis 1989), with the gradient. Twin: orogeny_reference::noise::basis::sparse.
#include "lib/hash.wgsl"
#include "lib/noise_points.wgsl"

// Value and derivatives at `f` within a cell: (1 - r^2)^3 for each of two bumps a cell.
fn sparse_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    for (var impulse = 0u; impulse < 2u; impulse++) {
        let impulse_seed = hash(impulse, 0x5cu, seed);
        for (var j = -1; j <= 1; j++) {
            for (var i = -1; i <= 1; i++) {
                let bits = hash(cell.x + u32(i), cell.y + u32(j), impulse_seed);
                let way = f - (vec2<f32>(f32(i), f32(j)) + jittered_place(bits));
                let t = max(1.0 - (way.x * way.x + way.y * way.y), 0.0);
                let t2 = signed_uniform(bits, impulse, seed) * (t * t);
                sum += vec3<f32>(t2 * t, t2 * -6.0 * way);
            }
        }
    }
    return 0.6093944 * sum;
}
