// A bare stencil, with nothing of the engine about it: what an adapter makes of neighbours.

@group(0) @binding(0) var<storage, read> source: array<f32>;
@group(0) @binding(1) var<storage, read_write> result: array<f32>;

override side: u32;

@compute @workgroup_size(16, 16)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= side || id.y >= side {
        return;
    }
    let last = side - 1u;
    let row = id.y * side;
    let here = source[row + id.x];
    let west = source[row + max(id.x, 1u) - 1u];
    let east = source[row + min(id.x + 1u, last)];
    let north = source[(max(id.y, 1u) - 1u) * side + id.x];
    let south = source[min(id.y + 1u, last) * side + id.x];
    result[row + id.x] = here + 0.2 * ((west - here) + (east - here) + (north - here) + (south - here));
}
