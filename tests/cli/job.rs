//! The main job, and the demo that does it in one go.

use orogeny_tests::repository;

use crate::program::Folder;

const RECIPE: &str = r#"{"operations": [
    {"op": "stroke", "brush": {"type": "raise", "radius": 900, "strength": 400}, "points": [[4000, 4000], [9000, 6000, 0.5]]},
    {"op": "stroke", "brush": {"type": "level", "radius": 150, "falloff": 60, "height": 600}, "points": [[3000, 9000], [9000, 9500]]},
    {"op": "fill", "brush": {"type": "roughen", "strength": 3}, "region": [12000, 12000, 3000, 2000]}
]}"#;

#[test]
fn a_real_terrain_is_imported_brushed_undone_drawn_and_exported() {
    let folder = Folder::new();
    let raster = repository().join("assets/terrain/frazier_1024_int16.tif");
    std::fs::copy(raster, folder.path("frazier.tif")).unwrap();
    folder.write("recipe.json", RECIPE);

    let imported = folder.succeed("import frazier.tif t.orogeny");
    assert_eq!(imported["made_terrain"], true);
    assert_eq!(imported["width"], 1024);
    assert!(imported["notices"][0].as_str().unwrap().contains("resampled"));
    let heights = |folder: &Folder| folder.succeed("info t.orogeny --heights")["heights"].clone();
    let before = heights(&folder);
    assert!(before["min_m"].as_f64().unwrap() > 200.0 && before["max_m"].as_f64().unwrap() < 2500.0);

    folder.succeed("export t.orogeny before.r32");
    folder.succeed("render t.orogeny before.png --map --size 500x500");
    let applied = folder.succeed("apply t.orogeny recipe.json");
    assert!(applied["backend"].as_str().unwrap().starts_with("CPU"));
    let brushes: Vec<_> =
        applied["operations"].as_array().unwrap().iter().map(|one| one["brush"].as_str().unwrap()).collect();
    assert_eq!(brushes, ["raise", "level", "roughen"]);
    assert!(applied["operations"][0]["num_pages"].as_u64().unwrap() > 0);
    assert_ne!(heights(&folder), before);

    folder.succeed("render t.orogeny after.png --map --size 500x500 --range 253,2446");
    assert_ne!(folder.read("before.png"), folder.read("after.png"));
    let exported = folder.succeed("export t.orogeny out.png --range 200,2600");
    assert_eq!((&exported["width"], &exported["depth"]), (&imported["width"], &imported["depth"]));
    assert!(folder.path("out.png.json").exists());
    folder.succeed("export t.orogeny out.tif");

    let log = folder.succeed("log t.orogeny");
    let ops: Vec<_> =
        log["entries"].as_array().unwrap().iter().map(|e| e["operation"]["op"].clone()).collect();
    assert_eq!(ops, ["import", "stroke", "stroke", "fill"]);
    assert_eq!(folder.succeed("undo t.orogeny -n 3")["entries"], serde_json::json!([4, 3, 2]));
    folder.succeed("export t.orogeny undone.r32");
    assert_eq!(folder.read("before.r32"), folder.read("undone.r32"));
}

#[test]
fn what_is_told_is_told_as_text_too() {
    let folder = Folder::new();
    folder.write("recipe.json", RECIPE);
    for (line, words) in [
        (
            "new t.orogeny --size 1000x800 --spacing 20 --height 500",
            &["t.orogeny", "1000 x 800", "500 m"][..],
        ),
        ("apply t.orogeny recipe.json --dry-run", &["3/3", "fill roughen", "tried out", "CPU"]),
        ("apply t.orogeny recipe.json", &["1/3", "stroke raise", "applied 3 operations", "CPU"]),
        ("undo t.orogeny", &["undone 1 operation"]),
        ("redo t.orogeny", &["redone 1 operation"]),
        ("redo t.orogeny", &["nothing"]),
        ("log t.orogeny", &["stroke raise, radius 900 m, strength 400, 2 points", "ago"]),
        ("info t.orogeny --heights", &["1000 x 800", "20000 x 16000 m", "3 applied", "heights"]),
        ("export t.orogeny t.r32", &["wrote t.r32", "1000 x 800", "note:"]),
        ("render t.orogeny t.png --map", &["drew t.png", "1000 x 800"]),
        ("import t.png u.orogeny", &[]),
    ] {
        let ran = folder.run(line);
        if words.is_empty() {
            ran.assert_failed(line, &["t.png"]); // a picture in colours is no heightfield
            continue;
        }
        assert_eq!(ran.code, Some(0), "{line}: {ran:?}");
        for word in words {
            assert!(ran.stdout.contains(word), "{line}: `{word}` is not in {}", ran.stdout);
        }
        assert!(!ran.stderr.contains('\u{1b}'), "{line} draws a bar into a pipe: {}", ran.stderr);
    }
}

#[test]
fn the_demo_does_it_in_one_go_and_again() {
    let folder = Folder::new();
    let files = [
        "terrain.orogeny",
        "frazier_1024_int16.tif",
        "recipe.json",
        "before.png",
        "after.png",
        "view.png",
        "terrain.tif",
        "terrain.png",
        "terrain.png.json",
        "terrain.r16",
        "terrain.r16.json",
    ];
    let mut first = None;
    for _ in 0..2 {
        let report = folder.succeed("demo made");
        assert_eq!(report["files"].as_array().unwrap().len(), files.len());
        for file in files {
            assert!(folder.path("made").join(file).metadata().unwrap().len() > 0, "{file}");
        }
        let brushes: std::collections::BTreeSet<_> = report["operations"]
            .as_array()
            .unwrap()
            .iter()
            .map(|one| one["brush"].as_str().unwrap())
            .collect();
        assert!(
            ["raise", "level", "ledge", "roughen", "erode_fluvial"].iter().all(|name| brushes.contains(name))
        );
        let exported = folder.read("made/terrain.tif");
        assert_eq!(*first.get_or_insert_with(|| exported.clone()), exported);
        assert_ne!(folder.read("made/before.png"), folder.read("made/after.png"));
    }
    let log = folder.succeed("log made/terrain.orogeny");
    let states: Vec<_> = log["entries"].as_array().unwrap().iter().map(|e| e["state"].clone()).collect();
    assert_eq!(states.last().unwrap(), "undone");
    assert_eq!(states.iter().filter(|state| **state == "undone").count(), 1);
}
