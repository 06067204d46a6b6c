//! Rasters that are turned and mirrored as they are imported: the same heights elsewhere, bit for bit, and again by a replay.

use serde_json::json;

use crate::program::Folder;

/// Wider and deeper than a page, and no multiple of one.
const WIDTH: usize = 700;
const DEPTH: usize = 301;

fn height_m(x: usize, z: usize) -> f32 {
    ((x * 31 + z * 17) as f32 * 0.37).sin() * 500.0 + x as f32 - 2.0 * z as f32
}

fn folder() -> Folder {
    let folder = Folder::new();
    let heights = (0..WIDTH * DEPTH).flat_map(|k| height_m(k % WIDTH, k / WIDTH).to_le_bytes());
    folder.write("first.r32", heights.collect::<Vec<u8>>());
    folder
}

/// Of each sample of what is imported the place in the file, for each way of turning.
type From = fn(usize, usize) -> (usize, usize);

#[test]
fn a_file_lies_as_it_was_turned() {
    let folder = folder();
    let ways: [(&str, bool, From); 6] = [
        ("--rotate 90", true, |x, z| (z, DEPTH - 1 - x)),
        ("--rotate 180", false, |x, z| (WIDTH - 1 - x, DEPTH - 1 - z)),
        ("--rotate 270", true, |x, z| (WIDTH - 1 - z, x)),
        ("--flip east-west", false, |x, z| (WIDTH - 1 - x, z)),
        ("--flip north-south", false, |x, z| (x, DEPTH - 1 - z)),
        // It is turned first.
        ("--rotate 90 --flip east-west", true, |x, z| (z, x)),
    ];
    for (index, (options, is_upright, from)) in ways.into_iter().enumerate() {
        let terrain = format!("t{index}.orogeny");
        let report = folder.succeed(&format!("import first.r32 {terrain} --size 700x301 {options}"));
        let [width, depth] = if is_upright { [DEPTH, WIDTH] } else { [WIDTH, DEPTH] };
        assert_eq!((&report["width"], &report["depth"]), (&json!(width), &json!(depth)), "{options}");
        let expected: Vec<f32> =
            (0..width * depth).map(|k| from(k % width, k / width)).map(|(x, z)| height_m(x, z)).collect();
        let heights = folder.heights_of(&terrain);
        assert!(heights == expected, "{options}");
        // The history has it all: the same again.
        folder.succeed(&format!("replay {terrain} again-{terrain}"));
        assert!(folder.heights_of(&format!("again-{terrain}")) == heights, "{options}, replayed");
    }
    let log = folder.succeed("log t5.orogeny");
    let recorded = &log["entries"][0]["operation"]["options"];
    assert_eq!((&recorded["rotate"], &recorded["flip"]), (&json!(90), &json!("east_west")), "{log}");
}

#[test]
fn four_quarters_and_two_mirrors_come_back() {
    let folder = folder();
    let mut size = "700x301";
    let mut next = "301x700";
    folder.write("now.r32", folder.read("first.r32"));
    for (index, options) in ["--rotate 90"; 4].into_iter().enumerate() {
        folder.succeed(&format!("import now.r32 q{index}.orogeny --size {size} {options}"));
        folder.succeed(&format!("export q{index}.orogeny now.r32"));
        assert_eq!(folder.read("now.r32") == folder.read("first.r32"), index == 3);
        (size, next) = (next, size);
    }
    for options in ["--flip east-west", "--flip north-south", "--rotate 180", "--flip both --rotate 180"] {
        for index in 0..2 {
            let terrain = format!("m{index}-{}.orogeny", options.replace([' ', '-'], ""));
            folder.succeed(&format!("import now.r32 {terrain} --size {size} {options}"));
            folder.succeed(&format!("export {terrain} now.r32"));
            let is_nothing = index == 1 || options.contains("both");
            assert_eq!(folder.read("now.r32") == folder.read("first.r32"), is_nothing, "{options} {index}");
        }
    }
}

/// Into a layer of a terrain, past its edge: what is put somewhere is the turned one.
#[test]
fn a_turned_file_goes_to_a_place_and_is_undone() {
    let folder = folder();
    folder.succeed("new t.orogeny --size 500x500 --spacing 1 --height 3");
    let line = "import first.r32 t.orogeny --size 700x301 --rotate 270 --at 250,-100 --layer Turned";
    let report = folder.succeed(line);
    assert_eq!((&report["width"], &report["depth"]), (&json!(DEPTH), &json!(WIDTH)));
    let heights = folder.heights_of("t.orogeny");
    for (x, z) in [(0, 0), (249, 499), (250, 0), (255, 255), (256, 256), (499, 499), (430, 17)] {
        let expected = if x < 250 { 3.0 } else { 3.0 + height_m(WIDTH - 1 - (z + 100), x - 250) };
        assert_eq!(heights[500 * z + x], expected, "{x} {z}");
    }
    folder.succeed("undo t.orogeny");
    assert!(folder.heights_of("t.orogeny").iter().all(|height_m| *height_m == 3.0));
    folder.succeed("redo t.orogeny");
    assert!(folder.heights_of("t.orogeny") == heights);
}
