// Runs a brush that a user wrote over tiles of pages. Each time one is compiled (module `custom` of orogeny_shaders), its
// text stands in the place of driver/custom_brush.wgsl. It has no twin: what it does is known to its user alone.
#include "driver/local.wgsl"
#include "lib/custom.wgsl"
#include "driver/custom_parameters.wgsl"
#include "driver/custom_brush.wgsl"

struct Custom {
    spacing_m: f32, // of the terrain's samples
    radius_m: f32,  // of the brush, whatever the pen's pressure makes of it
    seed: u32,      // of the stroke
}

@group(1) @binding(12) var<uniform> custom: Custom;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    // Outside the brush nothing changes, whatever a user's function makes of no weight: how far tiles reach must not show.
    if amount == 0.0 {
        return height;
    }
    var place = vec2<f32>(sample);
    var radius_m = custom.radius_m;
    // A fill has no centre, and a wash many: which of them is first depends on the tile, and must not show either.
    if WEIGHT_MODE != WASH && instance.inverse_radius > 0.0 {
        place = vec2<f32>(sample - instance.cell) - instance.fraction;
        radius_m = 1.0 / instance.inverse_radius_m;
    }
    let place_m = custom.spacing_m * place;
    let made = apply(BrushInput(height, amount, place_m, sample, radius_m, custom.spacing_m, custom.seed));
    let is_finite = (bitcast<u32>(made) & 0x7fffffffu) < 0x7f800000u;
    return select(height, made, is_finite);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
