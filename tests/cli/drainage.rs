//! Where water goes: valleys found by a mask of flow, filled pits, droplets; done again from the history alone.

use serde_json::{Value, json};

use crate::program::Folder;

const SIDE: usize = 200;

/// A terrain of two valleys along z, at x = 50 and 150, that fall to the south.
fn terrain(folder: &Folder) -> Vec<f32> {
    let at = |x: usize, z: usize| {
        let away = (x % 100).abs_diff(50) as f32;
        500.0 + 3.0 * away - 0.25 * z as f32
    };
    let ground: Vec<u8> =
        (0..SIDE * SIDE).flat_map(|index| at(index % SIDE, index / SIDE).to_le_bytes()).collect();
    folder.write("ground.r32", ground);
    folder.succeed(&format!("import ground.r32 t.orogeny --size {SIDE}x{SIDE} --spacing 2"));
    folder.heights_of("t.orogeny")
}

/// Does everything again from the history, in another terrain.
fn assert_replayed(folder: &Folder, expected: &[f32]) {
    folder.succeed("check t.orogeny");
    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(folder.heights_of("again.orogeny"), expected);
}

#[test]
fn what_is_gated_by_a_mask_of_flow_changes_the_valleys_only() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let flow = json!({ "type": "flow_mask", "from": 4000, "to": 20000 });
    let gated = json!({ "type": "lower", "strength": 10, "gate": { "selection": true } });
    folder.apply(
        "t.orogeny",
        "",
        &json!([
            { "op": "fill", "target": "selection", "brush": flow },
            { "op": "fill", "brush": gated },
        ]),
    );
    let after = folder.heights_of("t.orogeny");
    for (index, (before, after)) in before.iter().zip(&after).enumerate() {
        let (x, z) = (index % SIDE, index / SIDE);
        match x {
            // 400 m² for each row of a valley: 20,000 m² after 50 rows.
            50 | 150 if z > 60 => assert_eq!(*after, before - 10.0, "{x}, {z}"),
            50 | 150 => {}
            _ if z < SIDE - 1 => assert_eq!(after.to_bits(), before.to_bits(), "{x}, {z}"),
            _ => {}
        }
    }
    assert_replayed(&folder, &after);
    folder.succeed("undo t.orogeny");
    assert_eq!(folder.heights_of("t.orogeny"), before);
}

#[test]
fn pits_are_filled_and_droplets_run_and_both_can_be_done_again_and_undone() {
    let folder = Folder::new();
    let before = terrain(&folder);
    let dig = json!({ "type": "lower", "radius": 30, "strength": 40 });
    let stroke = |brush: &Value| json!({ "op": "stroke", "brush": brush, "points": [[90, 200], [150, 260]], "seed": 3 });
    folder.apply("t.orogeny", "", &json!([{ "op": "stroke", "brush": dig, "points": [[100, 200]] }]));
    let dug = folder.heights_of("t.orogeny");
    assert!(dug[100 * SIDE + 50] < before[100 * SIDE + 50] - 39.0);
    folder.apply(
        "t.orogeny",
        "",
        &json!([{ "op": "fill", "brush": { "type": "fill_pits" }, "region": [40, 100, 300, 250] }]),
    );
    let filled = folder.heights_of("t.orogeny");
    // The pit's outlet is where the valley goes on, 15 samples further south.
    let outlet = filled[100 * SIDE + 50];
    assert!(outlet > dug[100 * SIDE + 50] + 30.0 && outlet < before[100 * SIDE + 50], "{outlet}");
    folder.apply(
        "t.orogeny",
        "",
        &json!([stroke(&json!({ "type": "erode_droplets", "radius": 50, "droplets": 2 }))]),
    );
    let eroded = folder.heights_of("t.orogeny");
    let num_changed = eroded.iter().zip(&filled).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert!(num_changed > 500, "{num_changed}");
    assert_replayed(&folder, &eroded);
    folder.succeed("undo t.orogeny");
    assert_eq!(folder.heights_of("t.orogeny"), filled);
}

#[test]
fn what_cannot_be_worked_out_is_refused_and_nothing_changes() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 16384x16384 --spacing 1");
    let fill = |brush: Value| json!({ "op": "fill", "brush": brush });
    let mut on_heights = fill(json!({ "type": "flow_mask" }));
    on_heights["target"] = "heights".into();
    for (operation, words) in [
        (on_heights, vec!["target", "flow_mask"]),
        (fill(json!({ "type": "fill_pits" })), vec!["fill_pits", "268435456", "67108864", "region"]),
        (fill(json!({ "type": "flow_mask", "from": 10, "to": 10 })), vec!["from", "below"]),
        (fill(json!({ "type": "flow_mask", "exponent": 3 })), vec!["exponent", "shared"]),
        (fill(json!({ "type": "erode_droplets", "max_steps": 0 })), vec!["max_steps"]),
        (fill(json!({ "type": "fill_pits", "slope": -1 })), vec!["slope"]),
    ] {
        folder.write("recipe.json", json!({ "operations": [operation] }).to_string());
        folder.fail("apply t.orogeny recipe.json", &words);
    }
    assert_eq!(folder.succeed("log t.orogeny")["entries"].as_array().map(Vec::len), Some(0));
}

#[test]
fn what_rain_leaves_is_seen_as_a_selection() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 96x96 --spacing 10");
    // A bowl: water runs to its middle.
    let bowl = json!({ "type": "lower", "radius": 450, "strength": 200 });
    let stroke = json!({ "op": "stroke", "brush": bowl, "points": [[480, 480]] });
    let mask = |shows: &str| {
        let brush = json!({ "type": "rain_mask", "shows": shows, "iterations": 150, "from": 0, "to": 1 });
        json!({ "op": "fill", "target": "selection", "brush": brush })
    };
    let raise =
        json!({ "op": "fill", "brush": { "type": "raise", "strength": 7, "gate": { "selection": true } } });
    let changes = |shows: &str| {
        let heights = |operations: &Value| {
            folder.write("recipe.json", json!({ "operations": operations }).to_string());
            folder.succeed("apply t.orogeny recipe.json");
            folder.succeed("export t.orogeny out.r32");
            folder.heights("out.r32")
        };
        let before = heights(&json!([stroke]));
        let after = heights(&json!([mask(shows), raise]));
        folder.succeed("undo t.orogeny -n 3");
        let change = |x: usize, z: usize| after[z * 96 + x] - before[z * 96 + x];
        // In the middle, on the slope, on the flat rim.
        [change(48, 48), change(48, 30), change(2, 2)]
    };
    let [water, _, dry] = changes("water");
    assert!(water > 5.0 && dry < 4.0, "{water} and {dry}");
    let [deposits, slope, _] = changes("deposits");
    assert!(deposits > slope, "{deposits} and {slope}");
    let [middle, worn, flat] = changes("wear");
    assert!(worn > middle && worn > flat, "{worn}, {middle} and {flat}");
}
