// Random values joined by Catmull-Rom curves, with the gradient. Twin: orogeny_reference::noise::basis::value.
#include "lib/hash.wgsl"

fn catmull_rom_weights(f: f32) -> vec4<f32> {
    return 0.5 * vec4<f32>(
        ((2.0 - f) * f - 1.0) * f,
        (3.0 * f - 5.0) * f * f + 2.0,
        ((4.0 - 3.0 * f) * f + 1.0) * f,
        (f - 1.0) * f * f,
    );
}

fn catmull_rom_slopes(f: f32) -> vec4<f32> {
    return 0.5 * vec4<f32>(
        (4.0 - 3.0 * f) * f - 1.0,
        (9.0 * f - 10.0) * f,
        (8.0 - 9.0 * f) * f + 1.0,
        (3.0 * f - 2.0) * f,
    );
}

// Value and derivatives at `f` within a cell.
fn value_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32) -> vec3<f32> {
    let along_x = catmull_rom_weights(f.x);
    let along_y = catmull_rom_weights(f.y);
    let slope_x = catmull_rom_slopes(f.x);
    let slope_y = catmull_rom_slopes(f.y);
    var sum = vec3<f32>(0.0);
    for (var j = 0u; j < 4u; j++) {
        var row = 0.0;
        var row_slope = 0.0;
        for (var i = 0u; i < 4u; i++) {
            let corner = signed_uniform(cell.x + i - 1u, cell.y + j - 1u, seed);
            row += along_x[i] * corner;
            row_slope += slope_x[i] * corner;
        }
        sum += vec3<f32>(along_y[j] * row, along_y[j] * row_slope, slope_y[j] * row);
    }
    return sum;
}
