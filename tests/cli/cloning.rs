//! Ground cloned from another layer, a file, another terrain, and only what is selected; done again from the history alone.

use serde_json::{Value, json};

use crate::program::Folder;

const SIDE: usize = 200;

/// A terrain whose heights tell where they are.
fn terrain(folder: &Folder) -> Vec<f32> {
    folder.succeed(&format!("new t.orogeny --size {SIDE}x{SIDE} --spacing 2"));
    let ridge = json!({ "type": "ramp", "radius": 600, "falloff": 0, "height": 0, "end_height": 300 });
    let roughen = json!({ "type": "roughen", "strength": 4 });
    folder.apply(
        "t.orogeny",
        "",
        &json!([
            { "op": "stroke", "brush": ridge, "points": [[0, 200], [398, 200]] },
            { "op": "fill", "brush": roughen },
        ]),
    );
    folder.heights_of("t.orogeny")
}

/// A fill of the square of 40 m from (300, 300) m on by a clone with its place at (100, 120) m.
fn fill(source: &Value) -> Value {
    let mut source = source.clone();
    source["to"] = json!([300, 300]);
    let brush = json!({ "type": "clone", "blend": "plain", "source": source });
    json!({ "op": "fill", "brush": brush, "region": [300, 300, 40, 40] })
}

/// Whether the square has what lies at a place of another field, and all else is as it was.
fn assert_cloned(before: &[f32], after: &[f32], expected: impl Fn(usize, usize) -> f32) {
    for (index, (before, after)) in before.iter().zip(after).enumerate() {
        let (x, z) = (index % SIDE, index / SIDE);
        let is_inside = (150..170).contains(&x) && (150..170).contains(&z);
        let expected = if is_inside { expected(x - 150, z - 150) } else { *before };
        assert_eq!(after.to_bits(), expected.to_bits(), "{x}, {z}: {after} and {expected}");
    }
    assert_eq!(after.len(), SIDE * SIDE);
}

/// Takes away all files but the terrain and does all again.
fn assert_replayed(folder: &Folder, files: &[&str], expected: &[f32]) {
    for file in files {
        std::fs::remove_file(folder.path(file)).unwrap();
    }
    folder.succeed("check t.orogeny");
    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(folder.heights_of("again.orogeny"), expected);
}

#[test]
fn a_place_of_the_same_layer_is_copied() {
    let folder = Folder::new();
    let before = terrain(&folder);
    folder.apply("t.orogeny", "", &json!([fill(&json!({ "at": [100, 120] }))]));
    let after = folder.heights_of("t.orogeny");
    assert_cloned(&before, &after, |x, z| before[(60 + z) * SIDE + 50 + x]);
    assert_replayed(&folder, &[], &after);
    folder.succeed("undo t.orogeny");
    assert_eq!(folder.heights_of("t.orogeny"), before);
}

#[test]
fn another_layer_is_copied_and_named_by_its_id() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let detail: Vec<u8> = (0..SIDE * SIDE).flat_map(|index| (1000.0 + index as f32).to_le_bytes()).collect();
    folder.write("detail.r32", detail);
    folder.succeed(&format!("import detail.r32 t.orogeny --layer Detail --size {SIDE}x{SIDE}"));
    let with_layer = folder.heights_of("t.orogeny");
    assert_eq!(with_layer[7], before[7] + 1007.0);
    folder.apply("t.orogeny", "", &json!([fill(&json!({ "at": [100, 120], "layer": "Detail" }))]));
    let after = folder.heights_of("t.orogeny");
    let index = |x: usize, z: usize| z * SIDE + x;
    assert_cloned(&with_layer, &after, |x, z| {
        (1000.0 + index(50 + x, 60 + z) as f32) + (1000.0 + index(150 + x, 150 + z) as f32)
    });
    let log = folder.succeed("log t.orogeny").to_string();
    assert!(!log.contains("\"layer\":\"Detail\""), "{log}");
    assert_replayed(&folder, &["detail.r32"], &after);
}

#[test]
fn a_file_and_another_terrain_are_copied_and_kept() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let at = |x: usize, z: usize| 5.0 * x as f32 - z as f32;
    let raster: Vec<u8> = (0..90).flat_map(|z| (0..120).flat_map(move |x| at(x, z).to_le_bytes())).collect();
    folder.write("piece.r32", raster);
    folder.succeed("import piece.r32 other.orogeny --size 120x90 --spacing 2");
    folder.succeed("export other.orogeny piece.npy");
    for file in ["piece.npy", "other.orogeny"] {
        folder.apply("t.orogeny", "", &json!([fill(&json!({ "at": [100, 120], "file": file }))]));
        let after = folder.heights_of("t.orogeny");
        // Sample (50, 60) of it lies on the square's first; beyond its last row nothing is copied.
        assert_cloned(&before, &after, |x, z| at(50 + x, 60 + z));
        folder.succeed("undo t.orogeny");
    }
    folder.succeed("redo t.orogeny");
    let after = folder.heights_of("t.orogeny");
    assert_replayed(&folder, &["piece.npy", "other.orogeny", "piece.r32"], &after);
    folder.write("recipe.json", json!({ "operations": [fill(&json!({ "file": "gone.npy" }))] }).to_string());
    folder.fail("apply t.orogeny recipe.json", &["gone.npy"]);
}

#[test]
fn only_what_is_selected_at_the_source_is_copied() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let paint = json!({ "type": "paint_mask", "radius": 20, "falloff": 0 });
    folder.apply(
        "t.orogeny",
        "",
        &json!([
            { "op": "fill", "target": "selection", "brush": paint, "region": [100, 120, 20, 40] },
            fill(&json!({ "at": [100, 120], "selection": true })),
        ]),
    );
    let after = folder.heights_of("t.orogeny");
    assert_cloned(&before, &after, |x, z| {
        if x < 10 { before[(60 + z) * SIDE + 50 + x] } else { before[(150 + z) * SIDE + 150 + x] }
    });
    assert_replayed(&folder, &[], &after);
}

#[test]
fn what_cannot_be_cloned_is_refused_and_nothing_changes() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let clone = |source: Value| json!({ "type": "clone", "source": source });
    let stroke = |brush: &Value| json!({ "op": "stroke", "brush": brush, "points": [[50, 50], [90, 90]] });
    let region = json!([0, 0, 50, 50]);
    let blended = json!({ "type": "clone", "blend": "laplacian", "source": { "alignment": "fixed" } });
    for (operation, words) in [
        (stroke(&json!({ "type": "clone" })), vec!["source"]),
        (stroke(&clone(json!({ "alignment": "aligned" }))), vec!["source.to"]),
        (stroke(&blended), vec!["fixed", "feathered"]),
        (json!({ "op": "fill", "brush": clone(json!({})), "region": region }), vec!["source.to", "fill"]),
        (stroke(&clone(json!({ "layer": "None such" }))), vec!["None such"]),
        (stroke(&clone(json!({ "layer": 1, "file": "a.npy" }))), vec!["source.layer", "file"]),
        (stroke(&clone(json!({ "spacing": 3 }))), vec!["source.spacing", "file"]),
        (stroke(&clone(json!({ "scale": 0 }))), vec!["source.scale"]),
        (stroke(&clone(json!({ "file": "t.r32" }))), vec!["t.r32"]),
        (
            stroke(&json!({ "type": "clone", "levels": 12, "source": { "scale": 0.02 } })),
            vec!["levels", "scale"],
        ),
        (json!({ "op": "fill", "brush": { "type": "grab" }, "region": region }), vec!["grab", "stroke"]),
    ] {
        folder.write("recipe.json", json!({ "operations": [operation] }).to_string());
        folder.fail("apply t.orogeny recipe.json", &words);
    }
    assert_eq!(folder.heights_of("t.orogeny"), before);
}

/// A piece is placed as a whole: turned, it is not cut by the square that it comes from.
#[test]
fn a_region_is_pasted_turned_and_mirrored_and_costs_what_it_touches() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let source = json!({ "region": [100, 120, 40, 20], "to": [320, 300], "rotation": 90, "mirrored": true });
    let paste = json!({ "op": "fill", "brush": { "type": "clone", "blend": "plain", "source": source } });
    let report = folder.apply("t.orogeny", "", &json!([paste]));
    assert_eq!(report["operations"][0]["num_pages"], 1, "{report}");
    let after = folder.heights_of("t.orogeny");
    // The piece is 20 x 10 samples about (60, 65), its middle comes to (160, 150): a quarter turn of its mirror image.
    let mut num_pasted = 0;
    for (index, (before_there, after)) in before.iter().zip(&after).enumerate() {
        let (x, z) = ((index % SIDE) as i64 - 160, (index / SIDE) as i64 - 150);
        let (from_x, from_z) = (60 - z, 65 - x);
        let is_pasted = (50..70).contains(&from_x) && (60..70).contains(&from_z);
        let expected =
            if is_pasted { before[(from_z * SIDE as i64 + from_x) as usize] } else { *before_there };
        assert_eq!(after.to_bits(), expected.to_bits(), "{x}, {z}");
        num_pasted += usize::from(is_pasted);
    }
    assert_eq!(num_pasted, 200);
    assert_replayed(&folder, &[], &after);
}

/// Of a source that is too large to be kept whole, what the stroke needs is.
#[test]
fn only_what_is_needed_of_a_vast_terrain_is_kept() {
    let folder = Folder::new();
    let before = terrain(&folder);
    folder.succeed("new big.orogeny --size 8192x8192 --spacing 2");
    let hill = json!({ "type": "noise", "radius": 200, "feature_size": 60, "strength": 90 });
    let stroke = json!({ "op": "stroke", "brush": hill, "points": [[12000, 10000]] });
    folder.write("hill.json", json!({ "operations": [stroke] }).to_string());
    folder.succeed("apply big.orogeny hill.json");
    folder.succeed("export big.orogeny piece.r32 --region 11800,9800,400,400");
    let piece = folder.heights("piece.r32");
    let source = json!({ "file": "big.orogeny", "at": [12000, 10000], "to": [9, 9] });
    let brush = json!({ "type": "clone", "blend": "plain", "radius": 60, "source": source });
    folder.apply("t.orogeny", "", &json!([{ "op": "stroke", "brush": brush, "points": [[200, 200]] }]));
    let after = folder.heights_of("t.orogeny");
    for (index, after) in after.iter().enumerate() {
        let (x, z) = (index % SIDE, index / SIDE);
        let is_inside = (x as f64 - 100.0).hypot(z as f64 - 100.0) < 29.999;
        let expected = if is_inside { piece[index] } else { before[index] };
        assert_eq!(after.to_bits(), expected.to_bits(), "{x}, {z}");
    }
    assert!(std::fs::metadata(folder.path("t.orogeny")).unwrap().len() < 4 << 20);
    assert_replayed(&folder, &["big.orogeny"], &after);
    let all = json!({ "type": "clone", "source": { "file": "big.orogeny", "to": [0, 0], "scale": 0.02 } });
    folder.succeed("new big.orogeny --size 8192x8192 --spacing 2");
    folder.write("recipe.json", json!({ "operations": [{ "op": "fill", "brush": all }] }).to_string());
    folder.fail("apply t.orogeny recipe.json", &["big.orogeny", "scale"]);
}
