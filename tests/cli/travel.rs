//! Going to any entry of the history, and doing all of it again elsewhere.

use crate::program::Folder;

/// Four operations that do not come to the same in another order.
const OPERATIONS: [&str; 4] = [
    r#"{"op": "stroke", "brush": {"type": "raise", "radius": 60, "strength": 20}, "points": [[100, 100], [400, 380, 0.5]]}"#,
    r#"{"op": "stroke", "brush": {"type": "ledge", "radius": 50, "strength": 9}, "points": [[80, 300], [420, 200]]}"#,
    r#"{"op": "fill", "brush": {"type": "roughen", "strength": 2}, "seed": 9, "region": [200, 200, 200, 100]}"#,
    r#"{"op": "stroke", "brush": {"type": "level", "radius": 40, "height": 90}, "points": [[50, 50], [300, 300]]}"#,
];

fn apply(folder: &Folder, operation: &str) {
    folder.write("recipe.json", format!(r#"{{"operations": [{operation}]}}"#));
    folder.succeed("apply t.orogeny recipe.json");
}

fn heights(folder: &Folder, terrain: &str) -> Vec<u8> {
    folder.succeed(&format!("export {terrain} now.r32"));
    folder.read("now.r32")
}

#[test]
fn jump_goes_to_branches_to_the_start_and_back_bit_for_bit() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 500x500 --spacing 1 --height 100");
    let mut states = vec![heights(&folder, "t.orogeny")];
    for operation in &OPERATIONS[..3] {
        apply(&folder, operation);
        states.push(heights(&folder, "t.orogeny"));
    }
    folder.succeed("undo t.orogeny -n 2");
    apply(&folder, OPERATIONS[3]);
    states.push(heights(&folder, "t.orogeny"));
    for (entry, undone, redone) in [
        (3, vec![4], vec![2, 3]),
        (2, vec![3], vec![]),
        (4, vec![2], vec![4]),
        (4, vec![], vec![]),
        (0, vec![4, 1], vec![]),
        (3, vec![], vec![1, 2, 3]),
        (1, vec![3, 2], vec![]),
    ] {
        let report = folder.succeed(&format!("jump t.orogeny {entry}"));
        assert_eq!(report["entry"], entry);
        assert_eq!(report["undone"], serde_json::json!(undone), "to {entry}");
        assert_eq!(report["redone"], serde_json::json!(redone), "to {entry}");
        assert!(heights(&folder, "t.orogeny") == states[entry], "entry {entry} came back otherwise");
    }
    // Redo goes where one was last.
    folder.succeed("redo t.orogeny -n 9");
    assert!(heights(&folder, "t.orogeny") == states[3]);
    let ran = folder.run("jump t.orogeny 4");
    assert!(
        ran.code == Some(0) && ran.stdout.contains("at entry 4; undone 2 operations, redone 1 operation"),
        "{ran:?}"
    );
    folder.fail("jump t.orogeny 5", &["no entry 5"]);
    folder.fail("jump t.orogeny 4000000000", &["no entry 4000000000"]);
    assert_eq!(folder.run("jump t.orogeny last").code, Some(2));
    assert!(heights(&folder, "t.orogeny") == states[4]);
    folder.succeed("check t.orogeny");
}

/// A terrain with an imported layer, whose file is gone, and operations below, on and after it; some do not show.
fn with_an_imported_layer() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 500x500 --spacing 1 --height 100");
    let samples = (0..300 * 200_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 20) as f32 / 16.0);
    folder.write("hills.r32", samples.flat_map(f32::to_le_bytes).collect::<Vec<_>>());
    apply(&folder, OPERATIONS[0]);
    folder.succeed("import hills.r32 t.orogeny --size 300x200 --layer Hills --at 150,100");
    apply(&folder, &OPERATIONS[1].replacen("{", r#"{"layer": "Hills", "#, 1));
    apply(&folder, OPERATIONS[2]);
    folder.succeed("undo t.orogeny");
    apply(&folder, OPERATIONS[3]);
    apply(&folder, OPERATIONS[0]);
    folder.succeed("undo t.orogeny");
    std::fs::remove_file(folder.path("hills.r32")).unwrap();
    folder
}

#[test]
fn replay_makes_the_same_terrain_from_the_history_alone() {
    let folder = with_an_imported_layer();
    let before = folder.read("t.orogeny");
    let replayed = folder.succeed("replay t.orogeny copy.orogeny");
    assert_eq!((&replayed["num_operations"], &replayed["num_left_out"]), (&4.into(), &2.into()));
    assert!(folder.read("t.orogeny") == before, "replaying changed the terrain");
    for layer in ["", " --layer Base", " --layer Hills"] {
        folder.succeed(&format!("export t.orogeny original.r32{layer}"));
        folder.succeed(&format!("export copy.orogeny copy.r32{layer}"));
        assert!(folder.read("original.r32") == folder.read("copy.r32"), "it differs{layer}");
    }
    let log = folder.succeed("log copy.orogeny");
    let operations: Vec<_> =
        log["entries"].as_array().unwrap().iter().map(|entry| entry["operation"]["op"].clone()).collect();
    assert_eq!(operations, ["stroke", "import", "stroke", "stroke"]);
    assert_eq!(folder.succeed("check copy.orogeny")["num_blobs"], 1);
    // The copy has what it takes to be replayed in turn.
    let ran = folder.run("replay copy.orogeny copy2.orogeny");
    assert!(ran.code == Some(0) && ran.stdout.contains("replayed 4 operations of copy.orogeny"), "{ran:?}");
    assert_eq!(heights(&folder, "copy2.orogeny"), heights(&folder, "t.orogeny"));
}

#[test]
fn a_terrain_that_was_imported_replays_too() {
    let folder = Folder::new();
    let samples = (0..333 * 222_u32).map(|k| (k % 333) as f32 * 0.5 + (k / 333) as f32);
    folder.write("ground.r32", samples.flat_map(f32::to_le_bytes).collect::<Vec<_>>());
    folder.succeed("import ground.r32 t.orogeny --size 333x222 --spacing 2");
    apply(&folder, OPERATIONS[0]);
    std::fs::remove_file(folder.path("ground.r32")).unwrap();
    folder.succeed("replay t.orogeny copy.orogeny");
    assert_eq!(heights(&folder, "copy.orogeny"), heights(&folder, "t.orogeny"));
}

#[test]
fn replay_refuses_a_cut_history_and_never_replaces_a_file() {
    let folder = with_an_imported_layer();
    folder.write("there.orogeny", "precious");
    folder.fail("replay t.orogeny there.orogeny", &["there.orogeny", "exists"]);
    folder.succeed("compact t.orogeny --history-budget 1KiB");
    folder.fail("replay t.orogeny copy.orogeny", &["cannot be replayed", "dropped from the history"]);
}
