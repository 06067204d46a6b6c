// Perlin's gradient noise with its gradient. Twin: orogeny_reference::noise::basis::gradient.
#include "lib/hash.wgsl"

// One of eight unit vectors, (cos, sin) of (1 + 2k) pi / 8, from the upper three bits.
fn unit_direction(bits: u32) -> vec2<f32> {
    let k = bits >> 29u;
    var way = vec2<f32>(0.9238795, 0.38268343);
    if (((k + 1u) >> 1u) & 1u) == 1u {
        way = way.yx;
    }
    let is_negative = vec2<bool>((((k + 2u) >> 2u) & 1u) == 1u, (k >> 2u) == 1u);
    return select(way, -way, is_negative);
}

// Value and derivatives at `f` within a cell. Section 6 of the kernel specification; the curve is Perlin's of 2002.
fn gradient_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32) -> vec3<f32> {
    let g00 = unit_direction(hash(cell.x, cell.y, seed));
    let g10 = unit_direction(hash(cell.x + 1u, cell.y, seed));
    let g01 = unit_direction(hash(cell.x, cell.y + 1u, seed));
    let g11 = unit_direction(hash(cell.x + 1u, cell.y + 1u, seed));
    let g = f - 1.0;
    let a = g00.x * f.x + g00.y * f.y;
    let b = g10.x * g.x + g10.y * f.y;
    let c = g01.x * f.x + g01.y * g.y;
    let d = g11.x * g.x + g11.y * g.y;
    let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    let uv = u.x * u.y;
    let twist = a - b - c + d;
    let value = a + u.x * (b - a) + u.y * (c - a) + uv * twist;
    let slope = g00 + u.x * (g10 - g00) + u.y * (g01 - g00) + uv * (g00 - g10 - g01 + g11)
        + du * vec2<f32>((b - a) + u.y * twist, (c - a) + u.x * twist);
    return 1.5307337 * vec3<f32>(value, slope);
}
