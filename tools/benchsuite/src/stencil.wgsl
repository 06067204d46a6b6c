// A bare stencil along rows, with nothing of the engine about it: what an adapter makes of neighbours.

@group(0) @binding(0) var<storage, read> source: array<f32>;
@group(0) @binding(1) var<storage, read_write> result: array<f32>;

override side: u32;
override radius: u32;

@compute @workgroup_size(16, 16)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < radius || id.x + radius >= side || id.y >= side {
        return;
    }
    let first = id.y * side + id.x - radius;
    var sum = 0.0;
    for (var k = 0u; k <= 2u * radius; k++) {
        sum += source[first + k];
    }
    result[first + radius] = sum / f32(2u * radius + 1u);
}
