//! What brushes bring with them: pictures, kernels of their users, masks and selections. Kept with the terrain, so that a
//! replay needs nothing else.

use orogeny_tests::repository;
use serde_json::json;

use crate::program::Folder;

fn bits(folder: &Folder, terrain: &str) -> Vec<u32> {
    folder.heights_of(terrain).iter().map(|height_m| height_m.to_bits()).collect()
}

/// A grey ramp from black to white, 8 x 8 pixels.
fn picture() -> Vec<u8> {
    let path = repository().join("tests/fixtures/bitmaps/inputs");
    let mut names: Vec<_> = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    let grey = names
        .iter()
        .find(|path| path.to_string_lossy().contains("png") && path.to_string_lossy().contains("16"));
    std::fs::read(grey.or(names.first()).unwrap()).unwrap()
}

#[test]
fn a_picture_is_kept_and_replayed_without_its_file() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 256x256 --spacing 1");
    folder.write("rock.png", picture());
    let alpha = json!({ "file": "rock.png", "rotation": "follow" });
    let points = json!([[60, 60], [190, 100], [100, 200]]);
    let operations = json!([
        { "op": "stroke", "seed": 3, "brush": { "type": "raise", "radius": 40, "alpha": alpha }, "points": points },
        { "op": "stroke", "brush": { "type": "stamp", "radius": 50, "scale": 80, "alpha": alpha }, "points": [[128, 128]] },
    ]);
    folder.apply("t.orogeny", "", &operations);
    let painted = bits(&folder, "t.orogeny");
    assert!(painted.iter().any(|height| *height != 0));
    std::fs::remove_file(folder.path("rock.png")).unwrap();
    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(bits(&folder, "again.orogeny"), painted);
    folder.succeed("check again.orogeny");
    // What the history records names the picture by its content, and may be done again as it stands.
    let log = folder.succeed("log t.orogeny");
    assert!(log.to_string().contains("blake3"), "{log}");
    folder.fail("apply t.orogeny recipe.json", &["rock.png"]);
    assert_eq!(bits(&folder, "t.orogeny"), painted);
}

#[test]
fn a_custom_brush_runs_on_the_software_adapter_and_says_so_on_the_cpu() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 128x128 --spacing 1 --height 50");
    let crater = std::fs::read(repository().join("docs/brushes/crater.wgsl")).unwrap();
    folder.write("crater.wgsl", &crater);
    let shown = folder.succeed("custom crater.wgsl");
    assert!(!shown["parameters"].as_array().unwrap().is_empty(), "{shown}");
    let brush = json!({ "type": "custom", "file": "crater.wgsl", "radius": 30, "falloff": 0 });
    let operations = json!([{ "op": "stroke", "brush": brush, "points": [[64, 64]] }]);
    folder.write("recipe.json", json!({ "operations": operations }).to_string());
    folder.fail("apply t.orogeny recipe.json", &["--adapter software"]);
    folder.apply("t.orogeny", "--adapter software", &operations);
    let painted = bits(&folder, "t.orogeny");
    let flat = 50.0_f32.to_bits();
    assert!(painted[64 * 128 + 64] != flat && painted[0] == flat);
    std::fs::remove_file(folder.path("crater.wgsl")).unwrap();
    folder.succeed("replay t.orogeny again.orogeny --adapter software");
    assert_eq!(bits(&folder, "again.orogeny"), painted);
}

#[test]
fn a_broken_custom_brush_is_told_by_its_file_and_line_and_changes_nothing() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 64x64 --spacing 1");
    for (text, words) in [
        ("fn brush(at: BrushInput) -> f32 {\n    return at.hight_m;\n}\n", "bad.wgsl:2"),
        ("fn brush(at: BrushInput) -> f32 {\n    loop {}\n    return 1.0;\n}\n", "bad.wgsl:2"),
        ("fn brsh(at: BrushInput) -> f32 {\n    return 1.0;\n}\n", "brush"),
    ] {
        folder.write("bad.wgsl", text);
        let brush = json!({ "type": "custom", "file": "bad.wgsl" });
        let stroke = json!({ "op": "stroke", "brush": brush, "points": [[9, 9]] });
        folder.write("recipe.json", json!({ "operations": [stroke] }).to_string());
        for line in ["apply t.orogeny recipe.json --adapter software", "custom bad.wgsl"] {
            folder.fail(line, &[words]);
        }
    }
    let brush = json!({ "type": "custom", "file": "good.wgsl", "parameters": { "stop": 1 } });
    folder.write("good.wgsl", "// @param step: f32 = 1 (0 .. 2) \"a step\"\nfn brush(at: BrushInput) -> f32 {\n    return parameters.step;\n}\n");
    folder.write(
        "recipe.json",
        json!({ "operations": [{ "op": "stroke", "brush": brush, "points": [[9, 9]] }] }).to_string(),
    );
    folder.fail("apply t.orogeny recipe.json --adapter software", &["parameters.stop", "step"]);
}

#[test]
fn a_selection_bounds_what_a_gated_brush_does() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    let paint = json!({ "type": "paint_mask", "radius": 20, "falloff": 0 });
    let raise = json!({ "type": "raise", "strength": 7, "gate": { "selection": true } });
    let operations = json!([
        { "op": "fill", "target": "selection", "brush": paint, "region": [100, 50, 80, 40] },
        { "op": "fill", "brush": raise },
    ]);
    folder.apply("t.orogeny", "", &operations);
    let found = bits(&folder, "t.orogeny");
    for (index, height) in found.iter().enumerate() {
        let (x, z) = (index % 300, index / 300);
        let is_selected = (100..180).contains(&x) && (50..90).contains(&z);
        assert_eq!(f32::from_bits(*height), if is_selected { 7.0 } else { 0.0 }, "{x}, {z}");
    }
    folder.succeed("check t.orogeny");
    folder.succeed("undo t.orogeny -n 2");
    assert!(bits(&folder, "t.orogeny").iter().all(|height| *height == 0));
    folder.succeed("redo t.orogeny -n 2");
    assert_eq!(bits(&folder, "t.orogeny"), found);
    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(bits(&folder, "again.orogeny"), found);
}

#[test]
fn masks_are_painted_undone_and_checked() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    let erase = json!({ "type": "erase_mask", "radius": 60 });
    let noise = json!({ "type": "noise", "feature_size": 40, "strength": 0.5 });
    let operations = json!([
        { "op": "stroke", "brush": erase, "points": [[50, 50], [250, 250]] },
        { "op": "fill", "target": "mask", "brush": noise },
    ]);
    let report = folder.apply("t.orogeny", "", &operations);
    assert_eq!(report["operations"][1]["notices"]["num_clamped_heights"], 0);
    assert!(bits(&folder, "t.orogeny").iter().all(|height| *height == 0), "heights stay");
    folder.succeed("check t.orogeny");
    folder.succeed("undo t.orogeny -n 2");
    folder.succeed("redo t.orogeny -n 1");
    folder.succeed("check t.orogeny");
    folder.write(
        "recipe.json",
        json!({ "operations": [{ "op": "fill", "target": "heights", "brush": erase }] }).to_string(),
    );
    folder.fail("apply t.orogeny recipe.json", &["for masks"]);
}
