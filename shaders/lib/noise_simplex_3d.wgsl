// A plane through gradient noise over tetrahedra, with its gradient; cells and fractions are skewed (Gustavson 2005).
// Twin: orogeny_reference::noise::basis::simplex_3d.
#include "lib/hash.wgsl"

// One of the twelve ways to the middles of a cube's edges.
fn edge_direction(cell: vec3<u32>, seed: u32) -> vec3<f32> {
    let index = ((hash(cell.x, cell.y, hash(cell.z, 0x53u, seed)) >> 16u) * 12u) >> 16u;
    let first = select(1.0, -1.0, (index & 1u) == 1u);
    let second = select(1.0, -1.0, (index & 2u) == 2u);
    if index < 4u {
        return vec3<f32>(first, second, 0.0);
    }
    return select(vec3<f32>(0.0, first, second), vec3<f32>(first, 0.0, second), index < 8u);
}

fn simplex_3d_corner(cell: vec3<u32>, way: vec3<f32>, seed: u32) -> vec3<f32> {
    let direction = edge_direction(cell, seed);
    let t = max(0.5 - (way.x * way.x + way.y * way.y + way.z * way.z), 0.0);
    let along = way.x * direction.x + way.y * direction.y + way.z * direction.z;
    let t2 = t * t;
    return vec3<f32>(t2 * t2 * along, t2 * t2 * direction.xy - 8.0 * (t2 * t) * along * way.xy);
}

// Value and derivatives in the plane at `f` within a skewed cell.
fn simplex_3d_noise(cell: vec3<u32>, f: vec3<f32>, seed: u32) -> vec3<f32> {
    let unskew = 0.16666667;
    let origin = f - (f.x + f.y + f.z) * unskew;
    // The order of the coordinates tells the tetrahedron.
    let xy = origin.x >= origin.y;
    let yw = origin.y >= origin.z;
    let xw = origin.x >= origin.z;
    let first = vec3<bool>(xy && xw, !xy && yw, !xw && !yw);
    let second = vec3<bool>(xy || xw, !xy || yw, !(xw && yw));
    var sum = simplex_3d_corner(cell, origin, seed);
    sum += simplex_3d_corner(cell + vec3<u32>(first), origin - vec3<f32>(first) + unskew, seed);
    sum += simplex_3d_corner(cell + vec3<u32>(second), origin - vec3<f32>(second) + 2.0 * unskew, seed);
    sum += simplex_3d_corner(cell + 1u, origin - 1.0 + 3.0 * unskew, seed);
    return 76.88075 * sum;
}
