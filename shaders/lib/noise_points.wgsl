// Random places within cells, for the bases that scatter points. Twin: orogeny_reference::noise::basis.

// A place within a cell, from 32 random bits: 16 for each axis, never on the cell's border.
fn jittered_place(bits: u32) -> vec2<f32> {
    return (vec2<f32>(f32(bits >> 16u), f32(bits & 0xffffu)) + 0.5) * 1.5258789e-5;
}
