// Values of the first plane between its samples: the Catmull-Rom spline along x and then along z, held to the samples that it is
// made of. Twin: orogeny_reference::field::between, which has the source.
#include "driver/plane.wgsl"

// Of the sample before, the next one and the one after it; the one at `t` = 0 has what is left to 1.
fn spline_weights(t: f32) -> vec3<f32> {
    return vec3<f32>(t * (t * (1.0 - 0.5 * t) - 0.5), t * (t * (2.0 - 1.5 * t) + 0.5), t * t * (0.5 * t - 0.5));
}

fn spline(samples: vec4<f32>, weights: vec3<f32>) -> f32 {
    return samples.y + weights.x * (samples.x - samples.y) + weights.y * (samples.z - samples.y)
        + weights.z * (samples.w - samples.y);
}

fn first_between(cell: vec2<i32>, fraction: vec2<f32>) -> f32 {
    if all(fraction == vec2<f32>(0.0)) {
        return first_at(cell);
    }
    let weights_x = spline_weights(fraction.x);
    var column = vec4<f32>(0.0);
    var lowest = first_at(cell);
    var highest = lowest;
    for (var k = 0; k < 4; k++) {
        let west = cell + vec2<i32>(-1, k - 1);
        let row = vec4<f32>(
            first_at(west),
            first_at(west + vec2<i32>(1, 0)),
            first_at(west + vec2<i32>(2, 0)),
            first_at(west + vec2<i32>(3, 0)),
        );
        lowest = min(lowest, min(min(row.x, row.y), min(row.z, row.w)));
        highest = max(highest, max(max(row.x, row.y), max(row.z, row.w)));
        column[k] = spline(row, weights_x);
    }
    return min(max(spline(column, spline_weights(fraction.y)), lowest), highest);
}
