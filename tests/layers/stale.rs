//! Effects that are kept: they know when what is below them was changed, and can be worked out anew.

use orogeny_engine::ExportSource;
use serde_json::{Value, json};

use crate::support::{
    Site, assert_all_same, assert_differs, assert_near, assert_same, composite, dab, fill, name, noise, read,
};

/// Where the effect works.
const HERE_M: [f64; 2] = [2000.0, 2000.0];
/// Far from it.
const THERE_M: [f64; 2] = [6000.0, 11000.0];

fn brush() -> Value {
    json!({"type": "erode_thermal", "iterations": 10, "talus_angle": 3})
}

/// An effect that works around [`HERE_M`], with layers below, in its group, and above it.
fn site() -> Site {
    let mut site = crate::rich::flat();
    site.apply(&[
        fill("Base", 200.0, 1),
        json!({"op": "add_layer", "name": "Below"}),
        fill("Below", 60.0, 2),
        json!({"op": "add_layer", "name": "Group", "content": {"type": "group"}}),
        json!({"op": "add_layer", "name": "Inside", "group": "Group"}),
        fill("Inside", 50.0, 3),
        json!({"op": "add_layer", "name": "Slid", "group": "Group", "deferred": true,
            "content": {"type": "effect", "brush": brush()}}),
        json!({"op": "set_mask", "layer": "Slid", "from": "nothing"}),
        dab("Slid", "mask", "paint_mask", 900.0, HERE_M),
        json!({"op": "add_layer", "name": "Above"}),
        fill("Above", 30.0, 4),
    ]);
    assert!(site.is_stale("Slid"), "it was never worked out");
    site.apply(&[json!({"op": "refresh_layer", "layer": "Slid"})]);
    assert!(!site.is_stale("Slid"));
    site
}

#[test]
fn what_is_changed_below_makes_it_stale_and_nothing_else_does() {
    let mut site = site();
    let set =
        |layer: &str, field: &str, value: Value| json!({"op": "set_layer", "layer": layer, field: value});
    let raise = |layer: &str, at_m: [f64; 2]| dab(layer, "heights", "raise", 400.0, at_m);
    let cases = [
        (true, raise("Base", HERE_M)),
        (true, raise("Below", HERE_M)),
        (true, raise("Inside", HERE_M)),
        // In the next page, which the region does not reach, but what the effect looks at does.
        (true, raise("Base", [2000.0, 5600.0])),
        (true, dab("Below", "mask", "erase_mask", 400.0, HERE_M)),
        (true, set("Below", "opacity", json!(0.5))),
        (true, set("Below", "visible", json!(false))),
        (true, set("Below", "blend", json!("max"))),
        (true, set("Below", "transform", json!({"move": [50, 0]}))),
        (true, set("Group", "opacity", json!(0.5))),
        (
            true,
            set(
                "Slid",
                "content",
                json!({"type": "effect", "brush": {"type": "erode_thermal", "talus_angle": 9}}),
            ),
        ),
        (true, json!({"op": "set_mask", "layer": "Base", "scale": 0.5})),
        (true, json!({"op": "set_mask", "layer": "Base", "terms": [{"gate": {"selection": true}}]})),
        (true, json!({"op": "move_layer", "layer": "Above", "above": "Base"})),
        (true, json!({"op": "move_layer", "layer": "Below", "above": "Above"})),
        (true, json!({"op": "remove_layer", "layer": "Below"})),
        (true, json!({"op": "add_layer", "name": "New", "above": "Base", "height": 4})),
        // Where its mask lets it count now it was never worked out.
        (true, dab("Slid", "mask", "paint_mask", 900.0, THERE_M)),
        (false, raise("Base", THERE_M)),
        (false, raise("Above", HERE_M)),
        (false, dab("Above", "mask", "erase_mask", 400.0, HERE_M)),
        (false, set("Above", "opacity", json!(0.5))),
        (false, set("Below", "name", json!("Renamed"))),
        (false, set("Below", "locked", json!(true))),
        (false, set("Slid", "opacity", json!(0.5))),
        (false, set("Slid", "visible", json!(false))),
        (false, json!({"op": "add_layer", "name": "New", "height": 4})),
        (false, dab("Slid", "mask", "erase_mask", 200.0, HERE_M)),
        (false, dab("Base", "selection", "paint_mask", 400.0, HERE_M)),
    ];
    for (expected, change) in &cases {
        let mut change = change.clone();
        if change["content"]["type"] == "effect" {
            change["deferred"] = true.into();
        }
        site.apply_one(&change);
        assert_eq!(site.is_stale("Slid"), *expected, "{change}");
        site.terrain.undo(1).unwrap();
        assert!(!site.is_stale("Slid"), "{change} undone");
        site.terrain.redo(1).unwrap();
        assert_eq!(site.is_stale("Slid"), *expected, "{change} redone");
        if *expected {
            site.apply(&[json!({"op": "refresh_layer", "layer": "Slid"})]);
            assert!(!site.is_stale("Slid"), "{change} worked out anew");
            site.terrain.undo(1).unwrap();
            assert!(site.is_stale("Slid"), "{change} as it was before that");
        }
        site.terrain.undo(1).unwrap();
    }
    println!("{} changes", cases.len());
}

/// What a mask below looks at may lie anywhere: above the effect, in the selection, in the mask of the group that both are in.
#[test]
fn what_masks_below_look_at_makes_it_stale_too() {
    let mut site = site();
    site.apply(&[dab("Base", "selection", "paint_mask", 1000.0, HERE_M)]);
    let by_heights = json!([{"heights": {"layer": "Above", "low": 0, "high": 30}}]);
    let terms = |layer: &str, terms: Value| json!({"op": "set_mask", "layer": layer, "terms": terms});
    let refresh = json!({"op": "refresh_layer", "layer": "Slid"});
    let cases = [
        ([terms("Below", by_heights), json!(null)], dab("Above", "heights", "raise", 400.0, HERE_M)),
        (
            [terms("Below", json!([{"gate": {"selection": true}}])), json!(null)],
            dab("Base", "selection", "erase_mask", 400.0, HERE_M),
        ),
        (
            [dab("Above", "mask", "erase_mask", 300.0, HERE_M), terms("Below", json!([{"mask": "Above"}]))],
            dab("Above", "mask", "erase_mask", 500.0, HERE_M),
        ),
        (
            [dab("Group", "mask", "erase_mask", 300.0, HERE_M), json!(null)],
            dab("Group", "mask", "erase_mask", 500.0, HERE_M),
        ),
        (
            [
                json!({"op": "set_layer", "layer": "Slid", "deferred": true, "content": {"type": "effect",
            "brush": {"type": "erode_thermal", "talus_angle": 3, "gate": {"selection": true}}}}),
                json!(null),
            ],
            dab("Base", "selection", "erase_mask", 400.0, HERE_M),
        ),
    ];
    for (first, change) in &cases {
        let first: Vec<Value> = first.iter().filter(|operation| !operation.is_null()).cloned().collect();
        site.apply(&first);
        site.apply_one(&refresh);
        assert!(!site.is_stale("Slid"), "{first:?}");
        site.apply_one(change);
        assert!(site.is_stale("Slid"), "{first:?}, then {change}");
        site.terrain.undo(1).unwrap();
        assert!(!site.is_stale("Slid"), "{first:?}, then {change} undone");
        site.terrain.undo(first.len() as u32 + 1).unwrap();
    }
}

#[test]
fn worked_out_anew_it_is_what_it_would_be_if_it_were_added_now() {
    let mut num = 0;
    for brush in [
        brush(),
        json!({"type": "erode_fluvial", "iterations": 8}),
        json!({"type": "erode_droplets"}),
        json!({"type": "fill_pits"}),
        json!({"type": "erode_thermal", "iterations": 4, "talus_angle": 2, "strength": 0.5, "gate": {"height": {"min": 80, "max": 400, "feather": 50}}}),
    ] {
        let mut site = site();
        let content = json!({"type": "effect", "brush": brush, "seed": 7});
        let paint = [
            dab("Base", "heights", "raise", 700.0, HERE_M),
            dab("Below", "heights", "lower", 500.0, [2500.0, 1500.0]),
        ];
        let add = json!({"op": "add_layer", "name": "Effect", "above": "Slid", "content": content});
        // Refreshed after what was painted …
        site.apply_one(&add);
        let first = composite(&site.terrain, 0);
        site.apply(&paint);
        assert!(site.is_stale("Effect"));
        site.apply(&[json!({"op": "refresh_layer", "layer": "Effect"})]);
        let refreshed = site.composites();
        assert_differs(&first, &refreshed[0], "what was painted");
        site.terrain.undo(4).unwrap();
        // … and added only then.
        site.apply(&paint);
        site.apply(&[add]);
        assert_all_same(&refreshed, &site.composites(), &brush.to_string());
        num += 1;
    }
    println!("{num} brushes");
}

/// What an effect that is kept shows is what a fill with its brush makes of the same ground, but for the rounding of the difference.
#[test]
fn it_shows_what_a_fill_would_make_of_the_ground() {
    let mut site = Site::usual();
    site.apply(&[fill("Base", 200.0, 1)]);
    for brush in [brush(), json!({"type": "fill_pits"}), json!({"type": "erode_fluvial", "iterations": 8})] {
        let before = composite(&site.terrain, 0);
        site.apply(&[json!({"op": "fill", "layer": "Base", "brush": brush})]);
        let expected = composite(&site.terrain, 0);
        assert_differs(&before, &expected, &brush.to_string());
        site.terrain.undo(1).unwrap();
        site.apply(&[
            json!({"op": "add_layer", "name": "Effect", "content": {"type": "effect", "brush": brush}}),
        ]);
        assert_near(&expected, &composite(&site.terrain, 0), 1.0e-4, &brush.to_string());
        site.terrain.undo(1).unwrap();
    }
}

#[test]
fn it_has_no_height_of_its_own() {
    let mut site = Site::usual();
    site.apply(&[fill("Base", 200.0, 1)]);
    let add = |name: &str, height_m: f64| json!({"op": "add_layer", "name": name, "height": height_m, "content": {"type": "effect", "brush": brush()}});
    site.apply(&[add("Without", 0.0)]);
    let expected = site.composites();
    site.terrain.undo(1).unwrap();
    // Such a height is refused, or does not count.
    if site.try_to(&add("With", 40.0)).is_ok() {
        assert_all_same(&expected, &site.composites(), "an effect with a height");
    }
}

#[test]
fn where_its_region_becomes_smaller_what_was_left_beyond_goes() {
    let mut site = Site::usual();
    site.apply(&[
        fill("Base", 200.0, 1),
        json!({"op": "add_layer", "name": "Slid", "content": {"type": "effect", "brush": brush()}}),
        json!({"op": "set_mask", "layer": "Slid", "from": "nothing"}),
        dab("Slid", "mask", "paint_mask", 600.0, HERE_M),
        json!({"op": "refresh_layer", "layer": "Slid"}),
    ]);
    let alone = read(&site.terrain, &ExportSource::Layer(name("Slid")), None, 0);
    assert_eq!(alone.at(250, 480), 0.0);
    let mut num_changed = 0;
    for z in 0..alone.depth() {
        for x in 0..alone.width() {
            num_changed += usize::from(alone.at(x, z) != 0.0);
            assert!(alone.at(x, z) == 0.0 || (x < 128 && z < 128), "{x}, {z}");
        }
    }
    assert!(num_changed > 500);
    // Nothing counts: there is nothing to work out.
    site.apply(&[
        json!({"op": "set_mask", "layer": "Slid", "from": "nothing"}),
        json!({"op": "refresh_layer", "layer": "Slid"}),
    ]);
    assert!(!site.is_stale("Slid"));
    let alone = read(&site.terrain, &ExportSource::Layer(name("Slid")), None, 0);
    assert!(alone.samples().iter().all(|height| *height == 0.0));
    // Noise over it is not what it is made of.
    site.apply(&[json!({"op": "add_layer", "name": "Noise", "content": {"type": "procedural", "brush": noise(9.0, 1)}})]);
    assert!(!site.is_stale("Slid"));
    assert_same(&alone, &read(&site.terrain, &ExportSource::Layer(name("Slid")), None, 0), "alone");
}
