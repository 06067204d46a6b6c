//! The largest terrain costs what is painted on it.

use crate::program::Folder;

#[test]
fn a_stroke_in_the_middle_of_the_largest_terrain_makes_a_small_file() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 1048576x1048576 --spacing 1 --height 10");
    folder.write(
        "recipe.json",
        r#"{"operations": [{"op": "stroke", "brush": {"type": "raise", "radius": 300, "strength": 50},
            "points": [[524288, 524288], [526000, 524800]]}]}"#,
    );
    let applied = folder.succeed("apply t.orogeny recipe.json");
    let num_pages = applied["operations"][0]["num_pages"].as_u64().unwrap();
    assert!((1..100).contains(&num_pages), "{num_pages}");
    let info = folder.succeed("info t.orogeny");
    let num_bytes = info["file_size_in_bytes"].as_u64().unwrap();
    assert!(num_bytes < 20 << 20, "{num_bytes}");

    folder.succeed("export t.orogeny middle.r32 --region 524280,524280,16,16");
    assert!(folder.heights("middle.r32").iter().all(|height_m| *height_m > 20.0));
    folder.succeed("export t.orogeny corner.r32 --region 1048570,1048570,6,6");
    assert_eq!(folder.heights("corner.r32"), [10.0; 36]);
    folder.succeed("render t.orogeny middle.png --map --region 523000,523000,4000,3000 --size 400x400");
    folder.succeed("undo t.orogeny");
    folder.succeed("export t.orogeny middle.r32 --region 524280,524280,16,16");
    assert_eq!(folder.heights("middle.r32"), [10.0; 256]);
}
