//! Giving space back, a limit of the history, and what `info` says of both.

use crate::program::Folder;

fn apply(folder: &Folder, place_m: u32) -> serde_json::Value {
    folder.write("recipe.json", recipe(place_m));
    folder.succeed("apply t.orogeny recipe.json")
}

fn recipe(place_m: u32) -> String {
    format!(
        r#"{{"operations": [{{"op": "stroke", "brush": {{"type": "raise", "radius": 90, "strength": 20}},
            "points": [[{place_m}, 100], [{place_m}, 400]]}}]}}"#
    )
}

/// Five operations that show, and two that were left behind.
fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 500x500 --spacing 1 --height 100");
    for place_m in [50, 100, 150, 200, 250] {
        apply(&folder, place_m);
    }
    folder.succeed("undo t.orogeny -n 2");
    for place_m in [300, 350] {
        apply(&folder, place_m);
    }
    folder
}

fn heights(folder: &Folder) -> Vec<u8> {
    folder.succeed("export t.orogeny now.r32");
    folder.read("now.r32")
}

fn ids(folder: &Folder) -> Vec<u64> {
    let log = folder.succeed("log t.orogeny");
    log["entries"].as_array().unwrap().iter().map(|entry| entry["id"].as_u64().unwrap()).collect()
}

#[test]
fn dropping_branches_gives_their_space_back_and_changes_nothing_else() {
    let folder = terrain();
    let before = heights(&folder);
    let report = folder.succeed("compact t.orogeny --drop-branches");
    // What stood on another goes before it.
    assert_eq!(report["dropped_branches"]["entries"], serde_json::json!([5, 4]));
    assert_eq!(report["dropped"]["entries"], serde_json::json!([]));
    let [before_in_bytes, after_in_bytes] =
        ["before_in_bytes", "after_in_bytes"].map(|name| report[name].as_u64().unwrap());
    let dropped_in_bytes = report["dropped_branches"]["size_in_bytes"].as_u64().unwrap();
    assert!(dropped_in_bytes > 10_000, "{report}");
    assert!(before_in_bytes - after_in_bytes > dropped_in_bytes / 2, "{report}");
    assert_eq!(folder.read("t.orogeny").len() as u64, after_in_bytes);
    assert_eq!((heights(&folder), ids(&folder)), (before.clone(), vec![1, 2, 3, 6, 7]));
    assert_eq!(folder.succeed("undo t.orogeny -n 9")["entries"], serde_json::json!([7, 6, 3, 2, 1]));
    folder.succeed("redo t.orogeny -n 9");
    assert!(heights(&folder) == before);
    let ran = folder.run("compact t.orogeny --drop-branches");
    assert!(
        ran.code == Some(0) && ran.stdout.contains("before, ") && !ran.stdout.contains("note:"),
        "{ran:?}"
    );
    folder.succeed("check t.orogeny");
}

#[test]
fn a_history_budget_is_kept_and_what_goes_is_named() {
    let folder = terrain();
    let history = |folder: &Folder| folder.succeed("info t.orogeny")["history"].clone();
    let all_in_bytes = history(&folder)["size_in_bytes"].as_u64().unwrap();
    assert_eq!(history(&folder)["budget_in_bytes"], serde_json::Value::Null);
    let before = heights(&folder);
    let budget_in_bytes = all_in_bytes / 2 / 1024 * 1024;
    let report = folder.succeed(&format!("compact t.orogeny --history-budget {}KiB", budget_in_bytes / 1024));
    // What was left behind goes first, and then the oldest.
    let gone = report["dropped"]["entries"].as_array().unwrap().len();
    assert!((3..7).contains(&gone), "{report}");
    assert_eq!(ids(&folder).len(), 7 - gone);
    assert!(ids(&folder).ends_with(&[6, 7]));
    assert!(heights(&folder) == before, "a smaller history changed the terrain");
    assert_eq!(history(&folder)["budget_in_bytes"], budget_in_bytes);

    let mut last_kept = ids(&folder)[0];
    for place_m in [400, 450, 20] {
        let applied = apply(&folder, place_m);
        let gone = applied["dropped"]["entries"].as_array().unwrap();
        assert!(!gone.is_empty(), "{applied}");
        assert_eq!(gone[0].as_u64().unwrap(), last_kept);
        last_kept = ids(&folder)[0];
        assert!(history(&folder)["size_in_bytes"].as_u64().unwrap() <= budget_in_bytes);
    }
    folder.write("recipe.json", recipe(77));
    let ran = folder.run("apply t.orogeny recipe.json");
    assert!(ran.stdout.contains("note: ") && ran.stdout.contains("went from the history"), "{ran:?}");
    assert!(ran.stdout.contains(&format!(" from {last_kept} to ")), "{ran:?}");
    let kept = ids(&folder);
    let undone = folder.succeed("undo t.orogeny -n 99")["entries"].as_array().unwrap().len();
    assert_eq!(undone, kept.len());
    folder.succeed("check t.orogeny");

    folder.succeed("redo t.orogeny -n 99");
    folder.succeed("compact t.orogeny --history-budget none");
    assert_eq!(history(&folder)["budget_in_bytes"], serde_json::Value::Null);
    assert_eq!(apply(&folder, 33)["dropped"]["entries"], serde_json::json!([]));
    let ran = folder.run("compact t.orogeny --history-budget 0KiB");
    assert!(ran.code == Some(0) && ran.stdout.contains("can no longer be undone"), "{ran:?}");
    assert_eq!(
        (ids(&folder).len(), folder.succeed("undo t.orogeny")["entries"].clone()),
        (0, serde_json::json!([]))
    );
}

#[test]
fn sizes_that_are_none_are_wrong_use() {
    let folder = terrain();
    let before = folder.state();
    for size in ["5", "5MB", "-1MiB", "1.5GiB", "99999999TiB", "GiB", "nothing"] {
        let ran = folder.run(&format!("compact t.orogeny --history-budget {size}"));
        assert_eq!(ran.code, Some(2), "{size}: {ran:?}");
        folder.assert_state(&before, size);
    }
    let ran = folder.run("compact t.orogeny --history-budget 5MB");
    for word in ["--history-budget", "500MiB", "none"] {
        assert!(ran.stderr.contains(word), "`{word}` is not in {}", ran.stderr);
    }
    folder.fail("compact missing.orogeny", &["missing.orogeny"]);
}

#[test]
fn info_tells_all_of_it() {
    let folder = terrain();
    let info = folder.succeed("info t.orogeny --page-budget 64");
    for (field, value) in [("width", 500), ("depth", 500), ("page_size", 256), ("num_levels_above", 1)] {
        assert_eq!(info[field], value, "{field}");
    }
    assert_eq!((&info["width_m"], &info["spacing_m"]), (&500.0.into(), &1.0.into()));
    let history = &info["history"];
    for (field, value) in [("num_applied", 5), ("num_undone", 0), ("num_branch", 2)] {
        assert_eq!(history[field], value, "{field}");
    }
    let size_in_bytes = info["file_size_in_bytes"].as_u64().unwrap();
    assert_eq!(size_in_bytes, folder.read("t.orogeny").len() as u64);
    assert!((10_000..size_in_bytes).contains(&history["size_in_bytes"].as_u64().unwrap()), "{info}");
    assert_eq!(info["layers"][0]["num_pages"], 4);
    let memory = &info["memory"];
    assert_eq!(memory["budget_in_bytes"], 64 << 20);
    for field in ["pages_in_bytes", "textures_in_bytes", "store_in_bytes"] {
        assert_eq!(memory[field], 0, "{field}: it was only read");
    }
    let num_commits = info["num_commits"].as_u64().unwrap();
    apply(&folder, 5);
    assert_eq!(folder.succeed("info t.orogeny")["num_commits"], num_commits + 1);
    folder.succeed("compact t.orogeny --history-budget 3GiB");
    let ran = folder.run("info t.orogeny");
    for words in
        ["1 coarser level", "2 left behind", "of at most 3.00 GiB", "memory   ", "of a budget of 1.00 GiB"]
    {
        assert!(ran.stdout.contains(words), "`{words}` is not in {}", ran.stdout);
    }
}
