//! Layers baked into heights: what they come to at full resolution stays, to the bit.

use orogeny_engine::ExportSource;
use serde_json::{Value, json};

use crate::rich;
use crate::support::{
    Site, assert_differs, assert_near, assert_same, composite, fill, name, noise, range_m, read,
};

/// Collapses a layer and compares the composite, and the layer alone.
fn assert_keeps(site: &mut Site, collapse: &Value) {
    let before = site.composites();
    let layer = ExportSource::Layer(name(collapse["layer"].as_str().unwrap()));
    let below = collapse["below"] == true;
    let alone = (!below).then(|| read(&site.terrain, &layer, None, 0));
    site.apply_one(collapse);
    let what = collapse.to_string();
    assert_same(&before[0], &composite(&site.terrain, 0), &what);
    // Coarse levels are now those of what was baked: near what they were.
    for (level, before) in (1..).zip(&before[1..]) {
        assert_near(before, &composite(&site.terrain, level), 0.4 * range_m(before), &what);
    }
    if let Some(alone) = alone {
        assert_same(&alone, &read(&site.terrain, &layer, None, 0), &what);
        let layer = site.terrain.layer(Some(&name(collapse["layer"].as_str().unwrap()))).unwrap();
        assert!(layer.content.name() == "heights" && layer.transform.is_identity(), "{what}");
    }
    site.terrain.undo(1).unwrap();
    assert_same(&before[0], &composite(&site.terrain, 0), &format!("{what} undone"));
}

#[test]
fn a_collapsed_layer_shows_what_it_showed() {
    let mut site = rich::site();
    let of = |layer: &str| json!({"op": "collapse_layer", "layer": layer});
    let below = |layer: &str| json!({"op": "collapse_layer", "layer": layer, "below": true});
    let cases = ["Rocks", "Moved", "Smoothed", "Slid"].map(of);
    for case in &cases {
        assert_keeps(&mut site, case);
    }
    for case in ["Smoothed", "Slid", "Blended", "Rocks", "Massif"].map(below) {
        // A mask looks at `Hill`.
        let looks = json!({"op": "set_mask", "layer": "Smoothed", "terms": []});
        site.apply(&[looks]);
        assert_keeps(&mut site, &case);
        site.terrain.undo(1).unwrap();
    }
    // Hidden layers too: what they are made of is baked.
    for layer in ["Rocks", "Moved", "Smoothed", "Slid"] {
        site.apply(&[json!({"op": "set_layer", "layer": layer, "visible": false})]);
        let alone = read(&site.terrain, &ExportSource::Layer(name(layer)), None, 0);
        assert_keeps(&mut site, &of(layer));
        site.apply(&[of(layer)]);
        assert_same(&alone, &read(&site.terrain, &ExportSource::Layer(name(layer)), None, 0), layer);
        site.terrain.undo(2).unwrap();
    }
}

#[test]
fn what_was_moved_and_made_smaller_is_baked_at_full_resolution() {
    // Of a layer made smaller, coarser levels are looked at: those of what was painted in the same recipe too.
    let mut site = Site::usual();
    let transform = json!({"move": [900, 300], "rotate": 20, "scale": 0.2, "pivot": rich::MIDDLE_M});
    let recipe = [
        json!({"op": "add_layer", "name": "Small"}),
        fill("Small", 300.0, 9),
        json!({"op": "set_layer", "layer": "Small", "transform": transform}),
    ];
    site.apply(&recipe);
    let expected = composite(&site.terrain, 0);
    site.apply(&[json!({"op": "collapse_layer", "layer": "Small"})]);
    assert_same(&expected, &composite(&site.terrain, 0), "painted before");
    let mut other = Site::usual();
    let all: Vec<_> = recipe
        .iter()
        .chain([&json!({"op": "collapse_layer", "layer": "Small"})])
        .map(crate::support::operation)
        .collect();
    other.terrain.apply(&all, &mut orogeny_engine::Quiet).unwrap();
    assert_same(&expected, &composite(&other.terrain, 0), "painted in the same recipe");
    // And what was painted over pages that have coarser levels already.
    let again = [
        json!({"op": "set_layer", "layer": "Base", "transform": {}}),
        json!({"op": "add_layer", "name": "Again"}),
        fill("Again", 100.0, 10),
    ];
    site.apply(&again);
    let all = [
        fill("Again", 250.0, 11),
        json!({"op": "set_layer", "layer": "Again", "transform": transform}),
        json!({"op": "collapse_layer", "layer": "Again"}),
    ];
    site.apply(&all[..2]);
    let expected = composite(&site.terrain, 0);
    site.terrain.undo(2).unwrap();
    assert_differs(&expected, &composite(&site.terrain, 0), "what was undone");
    let all: Vec<_> = all.iter().map(crate::support::operation).collect();
    site.terrain.apply(&all, &mut orogeny_engine::Quiet).unwrap();
    assert_same(&expected, &composite(&site.terrain, 0), "painted again in the same recipe");
}

#[test]
fn collapsing_all_below_takes_what_counts_and_leaves_the_rest() {
    let mut site = Site::usual();
    let group = |name: &str, group: Value| json!({"op": "add_layer", "name": name, "content": {"type": "group"}, "group": group});
    site.apply(&[
        fill("Base", 100.0, 1),
        group("Outer", Value::Null),
        group("Inner", json!("Outer")),
        json!({"op": "add_layer", "name": "Seen", "group": "Inner", "content": {"type": "procedural", "brush": noise(40.0, 2)}}),
        json!({"op": "add_layer", "name": "Hidden", "group": "Inner", "height": 70, "visible": false}),
        json!({"op": "add_layer", "name": "Top", "height": 5}),
    ]);
    let expected = composite(&site.terrain, 0);
    // A layer over groups that have a hidden layer left.
    site.apply(&[json!({"op": "collapse_layer", "layer": "Top", "below": true})]);
    assert_same(&expected, &composite(&site.terrain, 0), "a layer");
    let names =
        |site: &Site| -> Vec<String> { site.layers().iter().map(|layer| layer.name.clone()).collect() };
    let mut left = names(&site);
    left.sort();
    assert_eq!(left, ["Hidden", "Inner", "Outer", "Top"]);
    site.terrain.undo(1).unwrap();
    // Groups of which nothing is left go, the outer one with the inner one.
    site.apply(&[
        json!({"op": "remove_layer", "layer": "Hidden"}),
        json!({"op": "collapse_layer", "layer": "Top", "below": true}),
    ]);
    assert_eq!(names(&site), ["Top"]);
    assert_same(&expected, &composite(&site.terrain, 0), "a layer over groups");
    site.terrain.undo(2).unwrap();
    // A group becomes a layer; what was hidden in it is in no group that is none.
    site.apply(&[json!({"op": "collapse_layer", "layer": "Inner", "below": true})]);
    assert_same(&expected, &composite(&site.terrain, 0), "a group");
    for layer in site.layers() {
        if let Some(group) = layer.group {
            let group = site.layers().into_iter().find(|other| other.id == group);
            assert!(group.is_some_and(|group| group.content.name() == "group"), "{layer:?}");
        }
    }
}

#[test]
fn locked_layers_are_baked_into_nothing() {
    let mut site = Site::usual();
    site.apply(&[
        fill("Base", 100.0, 1),
        json!({"op": "add_layer", "name": "Group", "content": {"type": "group"}, "locked": true}),
        json!({"op": "add_layer", "name": "Inside", "group": "Group", "height": 7}),
        json!({"op": "add_layer", "name": "Top", "height": 5}),
    ]);
    let err = site.try_to(&json!({"op": "collapse_layer", "layer": "Top", "below": true})).unwrap_err();
    assert!(err.to_string().contains("locked"), "{err}");
}
