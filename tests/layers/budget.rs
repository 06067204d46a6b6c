//! A large terrain with a small budget: it reads right, and keeps to it.

use orogeny_engine::{ExportSource, Settings, Terrain};
use serde_json::{Value, json};

use crate::support::{Site, assert_same, dab, noise, read, settings};

const SIDE: u64 = 4096;
const BUDGET_BYTES: u64 = 64 << 20;

/// Ten layers, of all kinds.
fn operations() -> Vec<Value> {
    let middle_m = [4096.0, 4096.0];
    let layer = |name: &str, more: Value| {
        let mut add = json!({"op": "add_layer", "name": name});
        add.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        add
    };
    vec![
        json!({"op": "fill", "layer": "Base", "brush": noise(150.0, 1), "region": [0, 0, 4096, 8192]}),
        layer("Hills", json!({"content": {"type": "procedural", "brush": noise(80.0, 2)}})),
        layer("Ridge", json!({"blend": "max", "opacity": 0.8})),
        dab("Ridge", "heights", "raise", 2500.0, middle_m),
        layer(
            "Smoothed",
            json!({"content": {"type": "effect", "brush": {"type": "smooth", "width": 14}},
            "mask": [{"gate": {"slope": {"min": 3, "max": 90, "feather": 5}}}]}),
        ),
        layer(
            "Slid",
            json!({"deferred": true, "content": {"type": "effect", "brush": {"type": "erode_thermal", "iterations": 5}}}),
        ),
        json!({"op": "set_mask", "layer": "Slid", "from": "nothing"}),
        dab("Slid", "mask", "paint_mask", 500.0, middle_m),
        json!({"op": "refresh_layer", "layer": "Slid"}),
        layer("Group", json!({"content": {"type": "group"}, "opacity": 0.9})),
        layer(
            "Steps",
            json!({"group": "Group", "content": {"type": "effect", "brush": {"type": "terrace", "step": 30}},
            "mask": [{"gate": {"height": {"min": 100, "max": 500, "feather": 40}}, "blur": 30}]}),
        ),
        layer("Blended", json!({"group": "Group", "blend": "laplacian", "opacity": 0.7, "height": 60})),
        dab("Blended", "heights", "raise", 1500.0, [2500.0, 5500.0]),
        dab("Blended", "mask", "erase_mask", 2000.0, [6000.0, 2000.0]),
        layer("Moved", json!({})),
        dab("Moved", "heights", "raise", 2500.0, [5000.0, 3000.0]),
        json!({"op": "set_layer", "layer": "Moved", "transform": {"rotate": 30, "scale": 0.5, "move": [500, 900]}}),
        layer(
            "Sharp",
            json!({"content": {"type": "effect", "brush": {"type": "sharpen", "width": 6}}, "opacity": 0.5}),
        ),
    ]
}

#[test]
fn a_large_stack_keeps_to_its_budget_and_reads_right() {
    let mut site = Site::new([SIDE, SIDE], 2.0, 256);
    let limited = Settings { page_budget_in_bytes: BUDGET_BYTES, ..settings() };
    let assert_within = |terrain: &Terrain, what: &str| {
        let memory = terrain.memory();
        assert_eq!(memory.budget_in_bytes, BUDGET_BYTES);
        assert!(memory.total_in_bytes() <= BUDGET_BYTES, "{what}: {memory:?}");
        memory.pages_in_bytes
    };
    for operation in operations() {
        site.apply_one(&operation);
        assert_within(&site.terrain, &operation.to_string());
    }
    assert_eq!(site.layers().len(), 10);
    // Rows of it, and columns, across many pages; of coarse levels all of it.
    let regions = [
        [1500.0, 3000.0, 2500.0, 40.0],
        [4000.0, 3500.0, 30.0, 1100.0],
        [3800.0, 3800.0, 400.0, 900.0],
        [8000.0, 7900.0, 300.0, 300.0],
    ];
    let large =
        Terrain::open_to_read(&site.path, Settings { page_budget_in_bytes: 4 << 30, ..settings() }).unwrap();
    let small = Terrain::open_to_read(&site.path, limited).unwrap();
    let mut most = 0;
    let mut reads: Vec<_> = regions.into_iter().map(|region_m| (Some(region_m), 0)).collect();
    reads.extend((2..=site.top_level()).map(|level| (None, level)));
    for (region_m, level) in &reads {
        let what = format!("{region_m:?} at level {level}");
        let expected = read(&large, &ExportSource::Composite, *region_m, *level);
        assert_same(&expected, &read(&small, &ExportSource::Composite, *region_m, *level), &what);
        most = most.max(assert_within(&small, &what));
    }
    println!("{} reads, at most {} MiB of pages", reads.len(), most >> 20);
    assert!(most > 0);
}
