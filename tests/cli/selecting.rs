//! The selection changed by operations: with brushes that it gates, undone, done again on another terrain, refused.

use orogeny_tests::repository;
use serde_json::{Value, json};

use crate::program::Folder;

const SIDE: usize = 300;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 2");
    folder
}

fn raise_selected() -> Value {
    json!({ "op": "fill", "brush": { "type": "raise", "strength": 10, "gate": { "selection": true } } })
}

/// What a fill of 10 m through the selection leaves on level ground, as a share of them.
fn selected(folder: &Folder, terrain: &str) -> Vec<f32> {
    folder.heights_of(terrain).iter().map(|height_m| height_m / 10.0).collect()
}

fn at(values: &[f32], x: usize, z: usize) -> f32 {
    values[z * SIDE + x]
}

#[test]
fn a_brush_works_where_a_recipe_selected() {
    let folder = folder();
    let operations = json!([
        { "op": "select", "shape": { "rectangle": [100, 100, 200, 200] } },
        { "op": "select", "shape": { "lasso": [[250, 250], [500, 250], [500, 500]] }, "combine": "add" },
        { "op": "select", "shape": { "rectangle": [140, 140, 40, 40] }, "combine": "subtract", "grow": 10 },
        raise_selected(),
    ]);
    let applied = folder.apply("t.orogeny", "", &operations);
    let names: Vec<_> =
        applied["operations"].as_array().unwrap().iter().map(|one| &one["operation"]).collect();
    assert_eq!(names, ["select", "select", "select", "fill"]);
    let values = selected(&folder, "t.orogeny");
    assert!(values.iter().all(|value| [0.0, 1.0].contains(value)));
    // Spacing 2 m: the square from sample 50 on, grown by five, with a hole that was 20 wide.
    for (x, z, expected) in [
        (45, 100, 1.0),
        (44, 100, 0.0),
        (154, 100, 1.0),
        (100, 155, 0.0),
        (46, 46, 0.0),
        (48, 46, 1.0),
        (200, 140, 1.0),
        (250, 240, 1.0),
        (140, 240, 0.0),
        (75, 84, 0.0),
        (74, 80, 1.0),
    ] {
        assert_eq!(at(&values, x, z), expected, "{x}, {z}");
    }
    let log = folder.run("log t.orogeny");
    assert!(log.stdout.contains("select lasso of 3 points, add"), "{}", log.stdout);
    // Undone and done again, one after the other.
    folder.succeed("undo t.orogeny -n 2");
    folder.apply("t.orogeny", "", &json!([raise_selected()]));
    let without_hole = selected(&folder, "t.orogeny");
    assert_eq!((at(&without_hole, 69, 75), at(&without_hole, 46, 100)), (1.0, 0.0));
    folder.succeed("undo t.orogeny -n 3");
    folder.succeed("redo t.orogeny -n 3");
    assert_eq!(selected(&folder, "t.orogeny"), without_hole);
    folder.succeed("check t.orogeny");
}

#[test]
fn what_was_selected_is_the_same_in_a_replay_without_its_files() {
    let folder = folder();
    let picture = repository().join("tests/fixtures/bitmaps/inputs/png-grey-u16.png");
    std::fs::copy(picture, folder.path("where.png")).unwrap();
    let hills =
        json!({ "op": "fill", "seed": 4, "brush": { "type": "noise", "strength": 80, "feature_size": 90 } });
    let image = json!({ "file": "where.png", "region": [0, 0, 600, 600] });
    let noise = json!({ "min": -0.5, "max": 0.5, "feather": 0.2, "pattern": { "feature_size": 70 } });
    let operations = json!([
        hills,
        { "op": "add_layer", "name": "Sand" },
        { "op": "stroke", "layer": "Sand", "target": "mask", "brush": { "type": "erase_mask", "radius": 90 }, "points": [[300, 300]] },
        { "op": "select", "shape": { "gate": { "slope": { "min": 10, "feather": 5 }, "image": image } }, "feather": 6 },
        { "op": "select", "shape": { "gate": { "noise": noise }, "region": [50, 50, 400, 300] }, "combine": "add", "grow": 7 },
        { "op": "select", "shape": { "mask": "Sand" }, "combine": "intersect", "shrink": 3, "invert": true },
        { "op": "fill", "layer": "Sand", "brush": { "type": "raise", "strength": 10, "gate": { "selection": true } } },
    ]);
    folder.apply("t.orogeny", "", &operations);
    std::fs::remove_file(folder.path("where.png")).unwrap();
    folder.succeed("replay t.orogeny again.orogeny");
    let bits = |terrain: &str| -> Vec<u32> {
        folder.succeed(&format!("export {terrain} sand.r32 --layer Sand"));
        folder.heights("sand.r32").into_iter().map(f32::to_bits).collect()
    };
    let sand = bits("t.orogeny");
    let num_soft = sand.iter().filter(|bits| (0.1..9.9).contains(&f32::from_bits(**bits))).count();
    assert!(num_soft > 1000, "{num_soft}");
    assert_eq!(bits("again.orogeny"), sand);
    folder.succeed("check again.orogeny");
}

#[test]
fn a_selection_that_cannot_be_made_is_refused_and_changes_nothing() {
    let folder = folder();
    folder.apply("t.orogeny", "", &json!([{ "op": "select", "shape": { "rectangle": [0, 0, 50, 50] } }]));
    let before = folder.succeed("log t.orogeny");
    for (operation, word) in [
        (json!({ "op": "select" }), "shape"),
        (json!({ "op": "select", "shape": { "lasso": [[0, 0], [1, 1]] } }), "shape.lasso"),
        (json!({ "op": "select", "shape": { "all": true }, "grow": 2050 }), "2048 m"),
        (json!({ "op": "select", "shape": { "mask": "Snow" } }), "Snow"),
        (
            json!({ "op": "select", "shape": { "gate": { "image": { "file": "a.png", "region": [0, 0, 1, 1] } } } }),
            "a.png",
        ),
    ] {
        let operations =
            json!({ "operations": [{ "op": "select", "shape": { "nothing": true } }, operation] });
        folder.write("recipe.json", operations.to_string());
        folder.fail("apply t.orogeny recipe.json", &[word]);
    }
    assert_eq!(folder.succeed("log t.orogeny")["entries"], before["entries"]);
    folder.apply("t.orogeny", "", &json!([raise_selected()]));
    assert_eq!(at(&selected(&folder, "t.orogeny"), 24, 24), 1.0);
    // As everywhere, what would change more than one operation may is refused, and costs nothing.
    folder.succeed("new vast.orogeny --size 1048576x1048576 --spacing 1");
    let vast = json!({ "operations": [{ "op": "select", "shape": { "all": true } }] });
    folder.write("recipe.json", vast.to_string());
    folder.fail("apply vast.orogeny recipe.json", &["16777216 pages", "1048576"]);
}
