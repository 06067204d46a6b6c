//! A stack with something of everything in it.

use serde_json::{Value, json};

use crate::support::{Site, dab, fill, noise};

/// Middle of the terrain.
pub const MIDDLE_M: [f64; 2] = [3700.0, 6400.0];

/// What makes it, from a terrain of one layer.
pub fn operations() -> Vec<Value> {
    vec![
        fill("Base", 180.0, 1),
        json!({"op": "add_layer", "name": "Massif", "content": {"type": "group"}, "opacity": 0.8,
            "mask": [{"gate": {"height": {"min": 60, "max": 400, "feather": 100}}}]}),
        json!({"op": "add_layer", "name": "Hill", "group": "Massif"}),
        fill("Hill", 90.0, 2),
        json!({"op": "add_layer", "name": "Rocks", "group": "Massif", "blend": "max",
            "content": {"type": "procedural", "brush": noise(160.0, 3), "seed": 5},
            "mask": [{"gate": {"slope": {"min": 1, "max": 90, "feather": 5}}, "blur": 60}]}),
        dab("Massif", "mask", "erase_mask", 1800.0, [2000.0, 3000.0]),
        json!({"op": "add_layer", "name": "Moved", "opacity": 0.9}),
        fill("Moved", 70.0, 4),
        dab("Moved", "mask", "erase_mask", 2500.0, [4000.0, 4000.0]),
        json!({"op": "set_layer", "layer": "Moved",
            "transform": {"move": [700, -900], "rotate": 30, "scale": 0.6, "pivot": MIDDLE_M, "height_scale": 1.2}}),
        json!({"op": "add_layer", "name": "Smoothed", "content": {"type": "effect", "brush": {"type": "smooth", "width": 90}},
            "mask": [{"heights": {"layer": "Hill", "low": -20, "high": 60}}, {"gate": {"selection": true}, "combine": "max"}]}),
        json!({"op": "stroke", "target": "selection", "brush": {"type": "paint_mask", "radius": 1500}, "points": [MIDDLE_M]}),
        json!({"op": "add_layer", "name": "Slid", "deferred": true,
            "content": {"type": "effect", "brush": {"type": "erode_thermal", "iterations": 6, "talus_angle": 4}}}),
        json!({"op": "set_mask", "layer": "Slid", "from": "nothing"}),
        dab("Slid", "mask", "paint_mask", 1200.0, MIDDLE_M),
        json!({"op": "refresh_layer", "layer": "Slid"}),
        json!({"op": "add_layer", "name": "Blended", "blend": "laplacian", "opacity": 0.6, "height": 120}),
        fill("Blended", 80.0, 6),
        dab("Blended", "mask", "erase_mask", 3000.0, [1000.0, 11000.0]),
    ]
}

/// The terrain that it is made on.
pub fn flat() -> Site {
    Site::new([101, 173], 75.0, 64)
}

/// A terrain with it.
pub fn site() -> Site {
    let mut site = flat();
    site.apply(&operations());
    site
}

/// Every operation on it at least once, in most of its ways; each does something, and could be done first.
pub fn changes() -> Vec<Value> {
    let set =
        |layer: &str, field: &str, value: Value| json!({"op": "set_layer", "layer": layer, field: value});
    vec![
        json!({"op": "add_layer", "name": "New 1", "height": 12, "above": "Base"}),
        json!({"op": "add_layer", "name": "New 2", "group": "Massif", "blend": "min", "opacity": 0.5,
            "content": {"type": "procedural", "brush": noise(200.0, 7)}, "mask": [{"mask": "Moved", "invert": true}]}),
        json!({"op": "add_layer", "name": "New 3", "above": "Base",
            "content": {"type": "effect", "brush": {"type": "terrace", "step": 40}}}),
        json!({"op": "add_layer", "name": "New 4", "content": {"type": "effect", "brush": {"type": "fill_pits"}}}),
        set("Hill", "visible", json!(false)),
        set("Massif", "visible", json!(false)),
        set("Massif", "opacity", json!(0.2)),
        set("Blended", "blend", json!("subtract")),
        set("Moved", "transform", json!({"move": [-3000, 250]})),
        set("Moved", "transform", json!({})),
        set("Rocks", "content", json!({"type": "procedural", "brush": noise(30.0, 8)})),
        set("Smoothed", "content", json!({"type": "effect", "brush": {"type": "smooth", "width": 200}})),
        set(
            "Slid",
            "content",
            json!({"type": "effect", "brush": {"type": "erode_thermal", "iterations": 12, "talus_angle": 2}}),
        ),
        json!({"op": "move_layer", "layer": "Base", "above": "Smoothed"}),
        json!({"op": "move_layer", "layer": "Massif", "above": "Blended"}),
        json!({"op": "move_layer", "layer": "Blended"}),
        json!({"op": "move_layer", "layer": "Moved", "above": "Hill", "group": "Massif"}),
        json!({"op": "remove_layer", "layer": "Massif"}),
        json!({"op": "remove_layer", "layer": "Blended"}),
        json!({"op": "remove_layer", "layer": "Slid"}),
        json!({"op": "duplicate_layer", "layer": "Moved"}),
        json!({"op": "duplicate_layer", "layer": "Slid", "name": "Slid twice"}),
        json!({"op": "duplicate_layer", "layer": "Smoothed"}),
        json!({"op": "collapse_layer", "layer": "Moved"}),
        json!({"op": "collapse_layer", "layer": "Smoothed"}),
        json!({"op": "collapse_layer", "layer": "Rocks"}),
        json!({"op": "collapse_layer", "layer": "Slid"}),
        json!({"op": "collapse_layer", "layer": "Slid", "below": true}),
        json!({"op": "set_mask", "layer": "Blended", "invert": true, "scale": 0.5}),
        json!({"op": "set_mask", "layer": "Massif", "from": "nothing"}),
        json!({"op": "set_mask", "layer": "Massif", "from": "all", "terms": []}),
        json!({"op": "set_mask", "layer": "Hill", "from": "selection"}),
        json!({"op": "set_mask", "layer": "Hill", "terms": [{"gate": {"slope": {"min": 0, "max": 3, "feather": 2}}}]}),
    ]
}
