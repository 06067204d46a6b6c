// Distances to the nearest of points scattered one a cell (Worley 1996), with the gradient.
// Twin: orogeny_reference::noise::basis::worley.
#include "lib/hash.wgsl"
#include "lib/noise_points.wgsl"

// 2 clamp(sum of w_d F_d, 0, 1) - 1 and its derivatives at `f` within a cell. Four points always lie within 1.85 cells, and
// every point outside the 5 x 5 cells about a place is 2 or more away.
fn worley_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32, weights: vec4<f32>) -> vec3<f32> {
    // Squared distance, and the way from the point.
    var nearest = array<vec3<f32>, 4>(vec3<f32>(1e9, 0.0, 0.0), vec3<f32>(1e9, 0.0, 0.0), vec3<f32>(1e9, 0.0, 0.0), vec3<f32>(1e9, 0.0, 0.0));
    for (var j = -2; j <= 2; j++) {
        for (var i = -2; i <= 2; i++) {
            let bits = hash(cell.x + u32(i), cell.y + u32(j), seed);
            let way = f - (vec2<f32>(f32(i), f32(j)) + jittered_place(bits));
            var next = vec3<f32>(way.x * way.x + way.y * way.y, way);
            for (var d = 0; d < 4; d++) {
                if next.x < nearest[d].x {
                    let further = nearest[d];
                    nearest[d] = next;
                    next = further;
                }
            }
        }
    }
    var sum = 0.0;
    var slope = vec2<f32>(0.0);
    for (var d = 0; d < 4; d++) {
        let distance = sqrt(nearest[d].x);
        sum += weights[d] * distance;
        if distance > 0.0 {
            slope += weights[d] / distance * nearest[d].yz;
        }
    }
    let steepness = select(0.0, 2.0, sum > 0.0 && sum < 1.0);
    return vec3<f32>(2.0 * clamp(sum, 0.0, 1.0) - 1.0, steepness * slope);
}
