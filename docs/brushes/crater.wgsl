// An impact crater: a bowl, a raised rim and rubble around it. One dab makes one crater as wide as the brush.
//
// Use it with a falloff of 0, which is a weight of 1 up to the edge: the shape fades out by itself.

// @param depth_m: f32 = 12 (0 .. 500) "depth of the bowl below the old ground, metres"
// @param rim_m: f32 = 3 (0 .. 100) "height of the rim above the old ground, metres"
// @param bowl: f32 = 0.55 (0.2 .. 0.9) "radius of the rim, as a share of the brush's"
// @param rubble_m: f32 = 0.6 (0 .. 20) "height of the rubble on and around the rim, metres"
// @param rubble_size_m: f32 = 6 (1 .. 200) "size of the rubble, metres"

// The shape over r, the distance from the centre as a share of the radius: metres above the old ground.
fn crater_m(r: f32) -> f32 {
    if r < parameters.bowl {
        // A parabola from the lowest point up to the rim.
        let q = r / parameters.bowl;
        return (parameters.depth_m + parameters.rim_m) * q * q - parameters.depth_m;
    }
    return parameters.rim_m * outside(r);
}

// 1 on the rim, 0 at the edge of the brush.
fn outside(r: f32) -> f32 {
    let t = clamp((1.0 - r) / (1.0 - parameters.bowl), 0.0, 1.0);
    return t * t * t;
}

fn brush(at: BrushInput) -> f32 {
    let r = length(at.place_m) / at.radius_m;
    let rubble = fbm_at(at.sample, parameters.rubble_size_m / at.spacing_m, 4u, 0.5, at.seed);
    // None at the bottom of the bowl, most on the rim.
    let roughness_m = parameters.rubble_m * outside(r) * smoothstep(0.3, 1.0, r / parameters.bowl);
    return at.height_m + at.weight * (crater_m(r) + roughness_m * rubble);
}
