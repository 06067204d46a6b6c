//! A bit of a page that flipped: it is named, made again from the history where that has it, and else worked around.

use rusqlite::Connection;

use crate::program::Folder;

const OPERATIONS: &str = r#"{"operations": [
    {"op": "stroke", "brush": {"type": "raise", "radius": 300, "strength": 40}, "points": [[150, 150], [800, 600, 0.5]]},
    {"op": "stroke", "brush": {"type": "ledge", "radius": 120, "strength": 9}, "points": [[200, 700], [700, 300]]},
    {"op": "fill", "brush": {"type": "raise", "strength": 2}, "region": [100, 400, 500, 300]}
]}"#;

/// As errors name the page that [`flip_a_bit`] damages: samples 256..512 along x, 512..768 along z.
const DAMAGED: &str = "column 1 row 2 of level 0 of field 1";
const WIDTH: usize = 1000;
const DEPTH: usize = 800;

/// A painted terrain of 4 x 4 pages and its heights, in `whole.r32`.
fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed(&format!("new t.orogeny --size {WIDTH}x{DEPTH} --spacing 1 --height 100"));
    folder.write("recipe.json", OPERATIONS);
    folder.succeed("apply t.orogeny recipe.json");
    folder.succeed("export t.orogeny whole.r32");
    folder
}

/// Flips a bit in the middle of a page's bytes.
fn flip_a_bit(folder: &Folder) {
    let conn = Connection::open(folder.path("t.orogeny")).unwrap();
    let at = "SELECT id, bytes FROM page_data
              WHERE id = (SELECT data FROM page WHERE field = 1 AND level = 0 AND z = 2 AND x = 1)";
    let (id, mut bytes): (i64, Vec<u8>) =
        conn.query_row(at, [], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    conn.execute("UPDATE page_data SET bytes = ?2 WHERE id = ?1", (id, bytes)).unwrap();
}

/// A terrain whose damaged page is in no history any more.
fn terrain_beyond_repair() -> Folder {
    let folder = terrain();
    folder.succeed("compact t.orogeny --history-budget 0KiB");
    flip_a_bit(&folder);
    folder
}

fn is_damaged(index: usize) -> bool {
    (256..512).contains(&(index % WIDTH)) && (512..768).contains(&(index / WIDTH))
}

#[test]
fn a_whole_terrain_is_found_whole() {
    let folder = terrain();
    let before = folder.state();
    let report = folder.succeed("check t.orogeny");
    assert_eq!((&report["is_whole"], &report["problems"]), (&true.into(), &serde_json::json!([])));
    // 16 at full resolution or fewer, and coarser ones; each operation with what it did to its pages.
    assert!((8..32).contains(&report["num_pages"].as_u64().unwrap()), "{report}");
    assert!(report["num_deltas"].as_u64().unwrap() > 3, "{report}");
    assert_eq!((&report["num_entries"], &report["num_blobs"]), (&4.into(), &0.into()));
    let ran = folder.run("check t.orogeny");
    assert!(ran.code == Some(0) && ran.stdout.contains("whole; "), "{ran:?}");
    assert!(ran.stdout.contains("3 operations"), "{ran:?}");
    folder.assert_state(&before, "checking");
    assert_eq!(folder.succeed("check t.orogeny --repair")["repairs"], serde_json::json!([]));
    folder.assert_state(&before, "repairing what is whole");
}

#[test]
fn a_flipped_bit_is_named_and_mended_from_the_history() {
    let folder = terrain();
    flip_a_bit(&folder);
    let before = folder.state();
    let ran = folder.run("check t.orogeny --json");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(report["is_whole"], false);
    let problems = report["problems"].as_array().unwrap();
    assert!(problems.iter().any(|problem| problem.as_str().unwrap().contains(DAMAGED)), "{report}");
    assert!(ran.stderr.contains("t.orogeny") && ran.stderr.contains("damaged"), "{ran:?}");
    let ran = folder.run("check t.orogeny");
    assert!(
        ran.code == Some(1) && ran.stdout.contains("problem: ") && ran.stdout.contains(DAMAGED),
        "{ran:?}"
    );
    folder.assert_state(&before, "checking");
    folder.fail("export t.orogeny out.r32", &[DAMAGED, "check --repair"]);

    let repaired = folder.succeed("check t.orogeny --repair");
    assert_eq!(repaired["is_whole"], true);
    let repairs = repaired["repairs"].to_string();
    assert!(repairs.contains("column 1 row 2 of field 1 was made again from the history"), "{repairs}");
    folder.succeed("export t.orogeny mended.r32");
    assert_eq!(folder.read("mended.r32"), folder.read("whole.r32"));
    folder.succeed("check t.orogeny");
    folder.succeed("undo t.orogeny -n 3");
    folder.succeed("redo t.orogeny -n 3");
    folder.succeed("export t.orogeny again.r32");
    assert_eq!(folder.read("again.r32"), folder.read("whole.r32"));
}

#[test]
fn a_page_that_is_in_no_history_is_lost_by_name_and_the_rest_works() {
    let folder = terrain_beyond_repair();
    let ran = folder.run("check t.orogeny --repair");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stdout.contains("repair: ") && ran.stdout.contains("could not be made again"), "{ran:?}");
    assert!(ran.stdout.contains("problem: ") && ran.stdout.contains(DAMAGED), "{ran:?}");

    folder.fail("export t.orogeny all.r32", &[DAMAGED]);
    folder.fail("export t.orogeny part.r32 --region 500,760,20,20", &[DAMAGED]);
    let whole = folder.heights("whole.r32");
    // The rows of pages to the north of it, and the columns to the east.
    for (region, x0, z0) in [("0,0,1000,512", 0, 0), ("512,500,488,300", 512, 500)] {
        let exported = folder.succeed(&format!("export t.orogeny beside.r32 --region {region}"));
        let width = exported["width"].as_u64().unwrap() as usize;
        let heights = folder.heights("beside.r32");
        assert_eq!(heights.len(), width * exported["depth"].as_u64().unwrap() as usize);
        for (index, height_m) in heights.iter().enumerate() {
            let (x, z) = (x0 + index % width, z0 + index / width);
            assert_eq!(*height_m, whole[z * WIDTH + x], "{region}: sample {x}, {z}");
        }
    }

    let drawn = folder.succeed("render t.orogeny map.png --map --size 1000x800");
    assert_eq!((&drawn["level"], drawn["notices"].as_array().unwrap().len()), (&0.into(), 1));
    let ran = folder.run("render t.orogeny map.png --map --size 1000x800");
    let note = "note: the page at column 1 row 2 of level 0 is damaged; a coarser level is shown";
    assert!(ran.code == Some(0) && ran.stdout.contains(note), "{ran:?}");
}

#[test]
fn salvage_saves_the_rest_and_what_a_coarser_level_knows() {
    let folder = terrain_beyond_repair();
    let before = folder.read("t.orogeny");
    let salvaged = folder.succeed("salvage t.orogeny saved.orogeny");
    assert_eq!(folder.read("t.orogeny"), before);
    assert_eq!(salvaged["num_pages_from_coarser_levels"], 1, "{salvaged}");
    assert_eq!((&salvaged["num_pages_from_history"], &salvaged["num_lost_pages"]), (&0.into(), &0.into()));
    assert!(salvaged["num_whole_pages"].as_u64().unwrap() >= 8, "{salvaged}");
    assert!(salvaged["notices"].to_string().contains("level 1 was left of it"), "{salvaged}");

    assert_eq!(folder.succeed("check saved.orogeny")["is_whole"], true);
    folder.succeed("export saved.orogeny saved.r32");
    let (whole, saved) = (folder.heights("whole.r32"), folder.heights("saved.r32"));
    let mut largest_m = 0.0_f32;
    for (index, (whole_m, saved_m)) in whole.iter().zip(&saved).enumerate() {
        match is_damaged(index) {
            true => largest_m = largest_m.max((whole_m - saved_m).abs()),
            false => assert_eq!(whole_m, saved_m, "sample {}, {}", index % WIDTH, index / WIDTH),
        }
    }
    // What is between every other sample is gone, no more.
    assert!((0.0001..5.0).contains(&largest_m), "{largest_m}");
    folder.fail("salvage t.orogeny saved.orogeny", &["saved.orogeny", "exists"]);
    folder.fail("salvage missing.orogeny new.orogeny", &["missing.orogeny"]);
}

#[test]
fn salvage_takes_a_damaged_page_from_the_history_where_that_has_it() {
    let folder = terrain();
    flip_a_bit(&folder);
    let ran = folder.run("salvage t.orogeny saved.orogeny");
    assert!(ran.code == Some(0) && ran.stdout.contains("1 from the history"), "{ran:?}");
    assert!(ran.stdout.contains("note: the page at column 1 row 2 of field 1"), "{ran:?}");
    folder.succeed("export saved.orogeny saved.r32");
    assert_eq!(folder.read("saved.r32"), folder.read("whole.r32"));
    assert_eq!(folder.succeed("log saved.orogeny")["entries"][0]["operation"]["op"], "salvage");
}
