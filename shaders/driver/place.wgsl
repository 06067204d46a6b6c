// Places of samples on another ground: a part of each column's and a part of each row's, worked out in 64 bits beforehand. Twin:
// orogeny_field::Place.
#include "driver/between.wgsl"

struct Place {
    cell: vec2<i32>,
    fraction: vec2<f32>,
}

@group(1) @binding(7) var<storage, read> columns: array<Place>;
@group(1) @binding(8) var<storage, read> rows: array<Place>;

// The sample at or before the place of a sample of the result, and how far after it that lies, 0..1.
fn place_of(sample: vec2<i32>) -> Place {
    let local = sample - step_planes.result.origin;
    let column = columns[local.x];
    let row = rows[local.y];
    let fraction = column.fraction + row.fraction;
    // Both are below 1, so at most one whole sample comes of them.
    let whole = select(vec2<f32>(0.0), vec2<f32>(1.0), fraction >= vec2<f32>(1.0));
    return Place(column.cell + row.cell + vec2<i32>(whole), fraction - whole);
}
