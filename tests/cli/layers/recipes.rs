//! All operations on layers in one recipe; what is undone, replayed, saved, told and exported of it.

use serde_json::{Value, json};

use super::{SIDE, at, dab, exported, heights, layer, layers, names, selecting, terrain};

/// Every operation on layers.
fn recipe() -> Value {
    let noise = json!({"type": "noise", "feature_size": 30, "strength": 6});
    json!([
        {"op": "add_layer", "name": "Hills", "content": {"type": "procedural", "brush": noise, "seed": 3}},
        {"op": "add_layer", "name": "Mound", "above": "Base"},
        dab("Mound"),
        {"op": "add_layer", "name": "Weather", "content": {"type": "group"}},
        {"op": "add_layer", "name": "Slide", "group": "Weather",
         "content": {"type": "effect", "brush": {"preset": "Slide"}}, "mask": [{"gate": {"slope": {"min": 5, "feather": 5}}}]},
        {"op": "set_layer", "layer": "Mound", "transform": {"move": [30, 10], "rotate": 20}, "opacity": 0.9},
        selecting(),
        {"op": "set_mask", "layer": "Hills", "from": "selection", "invert": true, "scale": 0.5,
         "terms": [{"heights": {"layer": "Mound", "low": 5, "high": 0}, "blur": 3, "combine": "max"}]},
        {"op": "duplicate_layer", "layer": "Mound", "name": "Second"},
        {"op": "set_layer", "layer": "Second", "transform": {"move": [-10, -10], "scale": 2, "pivot": [30, 40]}},
        {"op": "move_layer", "layer": "Second", "above": "Hills"},
        {"op": "collapse_layer", "layer": "Second"},
        {"op": "refresh_layer", "layer": "Slide"},
        {"op": "add_layer", "name": "Spare", "height": 90},
        {"op": "remove_layer", "layer": "Spare"},
    ])
}

#[test]
fn a_recipe_of_all_operations_is_undone_redone_and_replayed() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    let before = heights(&folder);
    let report = folder.apply("t.orogeny", "", &recipe());
    assert_eq!(report["operations"][4]["made_layer"], 5);
    assert_eq!(names(&folder), ["Base", "Mound", "Hills", "Second", "Slide", "Weather"]);
    assert_eq!(layer(&folder, "Slide")["is_stale"], false);
    let after = heights(&folder);
    assert_ne!(after, before);
    let stack = layers(&folder);
    folder.succeed("check t.orogeny");
    folder.succeed("undo t.orogeny -n 100");
    assert_eq!((heights(&folder), names(&folder)), (before, vec!["Base".to_owned()]));
    folder.succeed("redo t.orogeny -n 100");
    assert_eq!((heights(&folder), layers(&folder)), (after.clone(), stack));

    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(folder.heights_of("again.orogeny"), after);
    // One by one it comes to the same.
    folder.succeed(&format!("new one.orogeny --size {SIDE}x{SIDE} --spacing 1 --height 100"));
    for operation in recipe().as_array().unwrap() {
        folder.apply("one.orogeny", "", &json!([operation]));
    }
    assert_eq!(folder.heights_of("one.orogeny"), after);
    // Tried out it changes nothing.
    folder.succeed("undo t.orogeny -n 100");
    let state = folder.succeed("info t.orogeny")["layers"].clone();
    folder.apply("t.orogeny", "--dry-run", &recipe());
    assert_eq!(folder.succeed("info t.orogeny")["layers"], state);
}

#[test]
fn a_stack_is_saved_with_all_that_it_is_made_of() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    folder.apply("t.orogeny", "", &recipe());
    // A picture, a mask that is younger than the layers above it, and ids that the copies do not get.
    folder.succeed("render t.orogeny shades.png --map --size 50x50");
    let gate = json!({"image": {"file": "shades.png", "region": [0, 0, 100, 100]}});
    folder.write("rough.json", json!({"type": "roughen", "strength": 2, "gate": gate}).to_string());
    folder.succeed("layer add t.orogeny Rough --procedural rough.json --above Base --in Weather");
    folder.succeed("layer mask t.orogeny Base --nothing --invert --scale 0.5");
    folder.succeed("layer remove t.orogeny Second");
    let (whole, names_before) = (heights(&folder), names(&folder));
    folder.succeed("salvage t.orogeny saved.orogeny");
    assert_eq!(folder.heights_of("saved.orogeny"), whole);
    std::fs::rename(folder.path("saved.orogeny"), folder.path("t.orogeny")).unwrap();
    assert_eq!(names(&folder), names_before);
    assert_eq!(layer(&folder, "Slide")["group"], layer(&folder, "Weather")["id"]);
    folder.succeed("layer refresh t.orogeny Slide");
    folder.succeed("check t.orogeny");
}

#[test]
fn the_log_tells_each_operation_in_a_line() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    folder.apply("t.orogeny", "", &recipe());
    folder.succeed("layer collapse t.orogeny Hills --below");
    let text = folder.run("log t.orogeny").stdout;
    let lines = [
        "add_layer 2 `Hills`, procedural noise",
        "add_layer 3 `Mound`, above 1",
        "stroke raise, radius 10 m, strength 10, 1 point, layer 3",
        "add_layer 4 `Weather`, group",
        "add_layer 5 `Slide`, effect erode_thermal, in 4, 1 mask term",
        "set_layer 3, opacity 0.9, moved by 30,10 m, turned by 20 degrees",
        "fill paint_mask, strength 1, region [50.0,50.0,20.0,20.0], selection",
        "set_mask 2, from the selection, inverted, scale 0.5, 1 mask term",
        "duplicate_layer 3, as 6, named `Second`",
        "set_layer 6, moved by -10,-10 m, scale 2",
        "move_layer 6, above 2",
        "collapse_layer 6",
        "refresh_layer 5",
        "add_layer 7 `Spare`, height 90 m",
        "remove_layer 7",
        "collapse_layer 2, with all below",
    ];
    assert_eq!(text.lines().count(), lines.len(), "{text}");
    for (told, line) in text.lines().zip(lines) {
        assert!(told.ends_with(&format!("  {line}")), "{told}: {line}");
    }
}

#[test]
fn a_layer_a_mask_and_the_selection_are_exported_alone() {
    let folder = terrain();
    folder.succeed("layer add t.orogeny Hill --height 1 --hidden --opacity 0.5");
    folder.apply("t.orogeny", "", &json!([dab("Hill"), selecting()]));
    folder.succeed("layer mask t.orogeny Hill --selection --scale 0.5");
    let alone = exported(&folder, "--layer Hill");
    assert_eq!((at(&alone, 30, 40), at(&alone, 60, 60)), (11.0, 1.0));
    assert_eq!(exported(&folder, "--layer #2"), alone);
    assert_eq!(at(&exported(&folder, "--layer Base"), 30, 40), 100.0);
    let mask = exported(&folder, "--mask Hill");
    assert_eq!((at(&mask, 30, 40), at(&mask, 60, 60)), (0.0, 0.5));
    assert!(exported(&folder, "--mask #1").iter().all(|weight| *weight == 1.0));
    let selection = exported(&folder, "--selection");
    assert_eq!((at(&selection, 60, 60), at(&selection, 30, 40)), (1.0, 0.0));
    assert_eq!(selection.iter().sum::<f32>(), 400.0);

    // A group's mask counts for its layers, and a group has no heights.
    folder.succeed("layer add t.orogeny Group --group");
    folder.succeed("layer mask t.orogeny Group --nothing --invert --scale 0.5");
    folder.succeed("layer move t.orogeny Hill --above Base --in Group");
    assert_eq!(at(&exported(&folder, "--mask Hill"), 60, 60), 0.25);
    folder.fail("export t.orogeny part.r32 --layer Group", &["Group", "it is a group"]);
    folder.fail("export t.orogeny part.r32 --mask Lost", &["Lost"]);
}
