// One workgroup's work on a page. Twin: orogeny_brush::Tile.

struct Tile {
    page_origin: vec2<i32>, // of the page's first sample, on the terrain
    first: vec2<u32>,       // first sample to change, in the page
    end: vec2<u32>,         // one past the last
    heights_layer: u32,
    scratch_layer: u32,     // of `before` and `weights`; wash only
    gate_layer: u32,        // of `gates`; gated brushes only
    first_index: u32,       // its instances: tile_instances[first_index .. end_index]
    end_index: u32,
    first_lattice: u32,     // of its places on the lattices of a noise; see driver/noise.wgsl
}
