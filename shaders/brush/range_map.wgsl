// Heights of a range spread anew over it. Twin: orogeny_reference::brush::range_map.
#include "driver/local.wgsl"

// orogeny_field::RangeFormula
override RANGE_FORMULA: u32 = 0u;
const RANGE_BIAS = 0u;
const RANGE_GAIN = 1u;
const RANGE_CURVE = 2u;

struct Range {
    low_m: f32,
    high_m: f32,
    inverse_width: f32,
    exponent: f32,
}

@group(1) @binding(11) var<uniform> range: Range;

fn bias(z: f32) -> f32 {
    let power = exp_minus_one(range.exponent * natural_log(max(z, SMALLEST_NORMAL))) + 1.0;
    return select(0.0, clamp(power, 0.0, 1.0), z > 0.0);
}

fn mapped(z: f32) -> f32 {
    if RANGE_FORMULA == RANGE_GAIN {
        let is_lower = z < 0.5;
        let half = 0.5 * bias(select(2.0 - 2.0 * z, 2.0 * z, is_lower));
        return select(1.0 - half, half, is_lower);
    }
    if RANGE_FORMULA == RANGE_CURVE {
        return curve_value(RESULT_CURVE, z * 255.0).x;
    }
    return bias(z);
}

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    if height < range.low_m || height > range.high_m {
        return height;
    }
    let z = clamp((height - range.low_m) * range.inverse_width, 0.0, 1.0);
    return lerp(height, range.low_m + (range.high_m - range.low_m) * mapped(z), amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
