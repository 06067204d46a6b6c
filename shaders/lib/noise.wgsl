// One octave of noise at a place of its lattice: the value, about -1..1, and its derivatives along the two axes of the plane.
// Twin: orogeny_reference::noise::basis.
#include "lib/noise_gradient.wgsl"
#include "lib/noise_value.wgsl"
#include "lib/noise_worley.wgsl"
#include "lib/noise_simplex.wgsl"
#include "lib/noise_simplex_3d.wgsl"
#include "lib/noise_sparse.wgsl"

// orogeny_field::noise::Basis
override NOISE_BASIS: u32 = 0u;
const GRADIENT = 0u;
const VALUE = 1u;
const WORLEY = 2u;
const SIMPLEX = 3u;
const SIMPLEX3D = 4u;
const SPARSE = 5u;

fn noise_basis(cell: vec3<u32>, f: vec3<f32>, seed: u32, worley_weights: vec4<f32>) -> vec3<f32> {
    switch NOISE_BASIS {
        case VALUE: {
            return value_noise(cell.xy, f.xy, seed);
        }
        case WORLEY: {
            return worley_noise(cell.xy, f.xy, seed, worley_weights);
        }
        case SIMPLEX: {
            return simplex_noise(cell.xy, f.xy, seed);
        }
        case SIMPLEX3D: {
            return simplex_3d_noise(cell, f, seed);
        }
        case SPARSE: {
            return sparse_noise(cell.xy, f.xy, seed);
        }
        default: { // GRADIENT
            return gradient_noise(cell.xy, f.xy, seed);
        }
    }
}

// What moving one cell along the plane's axes is on the lattice: the simplex bases are skewed.
fn skewed_way(way: vec2<f32>) -> vec3<f32> {
    if NOISE_BASIS == SIMPLEX {
        return vec3<f32>(way + (way.x + way.y) * 0.36602542, 0.0);
    }
    if NOISE_BASIS == SIMPLEX3D {
        return vec3<f32>(way, 0.0) + (way.x + way.y) * 0.33333334;
    }
    return vec3<f32>(way, 0.0);
}
