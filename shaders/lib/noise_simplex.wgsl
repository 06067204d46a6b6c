// Gradient noise over triangles, with its gradient; cells and fractions are skewed (Gustavson, "Simplex noise demystified",
// 2005). Twin: orogeny_reference::noise::basis::simplex.
#include "lib/hash.wgsl"
#include "lib/noise_gradient.wgsl"

// (1/2 - r^2)^4 times the slope along a direction, with its derivatives.
fn simplex_corner(direction: vec2<f32>, way: vec2<f32>) -> vec3<f32> {
    let t = max(0.5 - (way.x * way.x + way.y * way.y), 0.0);
    let along = way.x * direction.x + way.y * direction.y;
    let t2 = t * t;
    return vec3<f32>(t2 * t2 * along, t2 * t2 * direction - 8.0 * (t2 * t) * along * way);
}

// Value and derivatives at `f` within a skewed cell.
fn simplex_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32) -> vec3<f32> {
    let unskew = 0.21132487; // (3 - sqrt(3)) / 6
    let first = f - (f.x + f.y) * unskew;
    let step = select(vec2<f32>(0.0, 1.0), vec2<f32>(1.0, 0.0), first.x > first.y);
    let middle = cell + vec2<u32>(step);
    let last = cell + 1u;
    var sum = simplex_corner(unit_direction(hash(cell.x, cell.y, seed)), first);
    sum += simplex_corner(unit_direction(hash(middle.x, middle.y, seed)), first - step + unskew);
    sum += simplex_corner(unit_direction(hash(last.x, last.y, seed)), first - 1.0 + 2.0 * unskew);
    return 100.0401 * sum;
}
