//! Exports as another program wants them: so many samples, the southern row first, by a preset. What was written is read here byte by
//! byte, and compared with what it should be by the rules that the guide tells.

use serde_json::Value;

use crate::program::Folder;

const WIDTH: usize = 40;
const DEPTH: usize = 30;

/// The terrain's heights: no two rows, columns or quarters are alike, and halves of sums are exact.
fn height_m(x: usize, z: usize) -> f32 {
    (100 * x + 7 * z + (x * z) % 13) as f32 / 8.0 - 90.0
}

fn terrain() -> Folder {
    let folder = Folder::new();
    let heights = (0..WIDTH * DEPTH).flat_map(|k| height_m(k % WIDTH, k / WIDTH).to_le_bytes());
    folder.write("first.r32", heights.collect::<Vec<u8>>());
    folder.succeed("import first.r32 t.orogeny --size 40x30 --spacing 2");
    folder
}

/// The place in the terrain that a sample of a middle lies at: what is beyond it is its edge.
fn of_middle([x, z]: [usize; 2], [width, depth]: [usize; 2]) -> f32 {
    let along = |index: usize, side: usize, samples: usize| {
        let first = (samples as i64 - side as i64).div_euclid(2);
        (first + index as i64).clamp(0, samples as i64 - 1) as usize
    };
    height_m(along(x, width, WIDTH), along(z, depth, DEPTH))
}

/// The place in the terrain that a sample lies at whose corners are its corners, along straight lines.
fn resampled([x, z]: [usize; 2], [width, depth]: [usize; 2]) -> f64 {
    let at =
        |index: usize, side: usize, samples: usize| index as f64 * (samples - 1) as f64 / (side - 1) as f64;
    let (x, z) = (at(x, width, WIDTH), at(z, depth, DEPTH));
    let corner =
        |x: f64, z: f64| f64::from(height_m((x as usize).min(WIDTH - 1), (z as usize).min(DEPTH - 1)));
    let (share_x, share_z) = (x.fract(), z.fract());
    let row = |z: f64| corner(x, z) * (1.0 - share_x) + corner(x + 1.0, z) * share_x;
    row(z) * (1.0 - share_z) + row(z + 1.0) * share_z
}

/// Whole samples of 16 bits.
fn samples(folder: &Folder, name: &str, from_bytes: fn([u8; 2]) -> u16) -> Vec<u16> {
    let bytes = folder.read(name);
    let (pairs, rest) = bytes.as_chunks();
    assert!(rest.is_empty(), "{name} holds no whole samples");
    pairs.iter().map(|pair| from_bytes(*pair)).collect()
}

/// The sample that stands for a height.
fn sample_of(height_m: f64, [low_m, high_m]: [f64; 2]) -> f64 {
    (height_m - low_m) / (high_m - low_m) * 65_535.0
}

fn has_notice(report: &Value, words: &str) -> bool {
    report["notices"].as_array().unwrap().iter().any(|notice| notice.as_str().unwrap().contains(words))
}

#[test]
fn the_southern_row_comes_first_where_that_is_asked_for() {
    let folder = terrain();
    let report = folder.succeed("export t.orogeny a.r32 --south-first");
    assert!(has_notice(&report, "southern row"));
    let turned: Vec<f32> = (0..DEPTH).rev().flat_map(|z| (0..WIDTH).map(move |x| height_m(x, z))).collect();
    assert_eq!(folder.heights("a.r32"), turned);
    assert!(!has_notice(&folder.succeed("export t.orogeny b.r32"), "southern row"));
    assert_eq!(folder.read("b.r32"), folder.read("first.r32"));
    // Of a region too: 15 x 8 samples from (5, 10) on.
    let report = folder.succeed("export t.orogeny c.r32 --south-first --region 10,20,30,16");
    assert_eq!((&report["width"], &report["depth"]), (&15.into(), &8.into()));
    let region: Vec<f32> = (10..18).rev().flat_map(|z| (5..20).map(move |x| height_m(x, z))).collect();
    assert_eq!(folder.heights("c.r32"), region);
}

#[test]
fn a_size_takes_the_middle_and_the_edge_goes_on() {
    let folder = terrain();
    for (options, size, is_south_first) in [
        ("--size 20x50 --fit middle", [20, 50], false),
        ("--size 20x50 --fit middle --south-first", [20, 50], true),
        ("--size 43x1 --fit middle", [43, 1], false),
        ("--size 40x30 --fit middle", [WIDTH, DEPTH], false),
    ] {
        let report = folder.succeed(&format!("export t.orogeny a.r32 {options}"));
        assert_eq!((&report["width"], &report["depth"]), (&size[0].into(), &size[1].into()), "{options}");
        assert!(!has_notice(&report, "apart along"), "{options}");
        let row = |z: usize| (0..size[0]).map(move |x| of_middle([x, z], size));
        let rows = (0..size[1]).map(|z| if is_south_first { size[1] - 1 - z } else { z });
        assert_eq!(folder.heights("a.r32"), rows.flat_map(row).collect::<Vec<_>>(), "{options}");
    }
}

#[test]
fn a_size_is_read_between_samples() {
    let folder = terrain();
    for (options, size, is_oblong) in [
        ("--size 79x59", [79, 59], false),
        ("--size 79x59 --fit resample", [79, 59], false),
        ("--size 27x20 --fit resample", [27, 20], true),
        ("--size 2x2", [2, 2], true),
    ] {
        let report = folder.succeed(&format!("export t.orogeny a.r32 {options}"));
        assert_eq!(has_notice(&report, "apart along x"), is_oblong, "{options}: {report}");
        let heights = folder.heights("a.r32");
        assert_eq!(heights.len(), size[0] * size[1], "{options}");
        for (index, height_m) in heights.iter().enumerate() {
            let place = [index % size[0], index / size[0]];
            let expected_m = resampled(place, size);
            assert!(
                (f64::from(*height_m) - expected_m).abs() < 1.0e-3,
                "{options} {place:?}: {height_m} {expected_m}"
            );
        }
        // Corners are corners, bit for bit.
        assert_eq!(heights[0], height_m(0, 0), "{options}");
        assert_eq!(heights[size[0] * size[1] - 1], height_m(WIDTH - 1, DEPTH - 1), "{options}");
    }
}

#[test]
fn a_preset_makes_the_file_that_its_program_reads() {
    let folder = terrain();
    // 33 is the largest of Unity's sides below 40 samples.
    let report = folder.succeed("export t.orogeny a.raw --preset unity-raw");
    let size = [33, 33];
    assert_eq!((&report["width"], &report["depth"]), (&33.into(), &33.into()));
    let advice = report["advice"].to_string();
    assert!(advice.contains("Byte Order Windows, Flip Vertically off"), "{advice}");
    let range_m = [f64::from(height_m(0, 0)), f64::from(height_m(WIDTH - 1, DEPTH - 1))];
    let written = samples(&folder, "a.raw", u16::from_le_bytes);
    assert_eq!(written.len(), 33 * 33);
    for (index, sample) in written.iter().enumerate() {
        let expected = sample_of(resampled([index % 33, 32 - index / 33], size), range_m);
        assert!((f64::from(*sample) - expected).abs() < 0.6, "{index}: {sample} {expected}");
    }
    let sidecar: Value = serde_json::from_slice(&folder.read("a.raw.json")).unwrap();
    assert_eq!((&sidecar["width"], &sidecar["depth"]), (&33.into(), &33.into()), "{sidecar}");

    // Of a middle every step is used: the range is that of what is written, not that of the terrain.
    folder.succeed("export t.orogeny b.raw --preset unity-raw --fit middle");
    let middle: Vec<f32> = (0..33 * 33).map(|index| of_middle([index % 33, 32 - index / 33], size)).collect();
    let low_m = f64::from(middle.iter().copied().fold(f32::INFINITY, f32::min));
    let high_m = f64::from(middle.iter().copied().fold(f32::NEG_INFINITY, f32::max));
    let written = samples(&folder, "b.raw", u16::from_le_bytes);
    assert_eq!((written.iter().min(), written.iter().max()), (Some(&0), Some(&65_535)));
    for (sample, height_m) in written.iter().zip(middle) {
        let expected = sample_of(f64::from(height_m), [low_m, high_m]);
        assert!((f64::from(*sample) - expected).abs() < 0.6, "{sample} {expected}");
    }
}

#[test]
fn presets_of_other_programs_and_of_one_s_own() {
    let folder = terrain();
    // A PNG says its width, height, bits and colours from its 16th byte on.
    for (preset, side) in [("unreal-png", [127_u32; 2]), ("blender-png", [40, 30]), ("png-16-bits", [40, 30])]
    {
        folder.succeed(&format!("export t.orogeny a.png --preset {preset}"));
        let bytes = folder.read("a.png");
        let header = [side[0].to_be_bytes().as_slice(), &side[1].to_be_bytes(), &[16, 0]].concat();
        assert_eq!(bytes[16..26], header, "{preset}");
    }
    folder.succeed("export t.orogeny a.raw --preset godot-hterrain-raw");
    assert_eq!(folder.read("a.raw").len(), 2 * 65 * 65);
    folder.succeed("export t.orogeny a.tif --preset tiff-metres");
    folder.succeed("import a.tif back.orogeny");
    assert_eq!(folder.heights_of("back.orogeny"), folder.heights("first.r32"));

    std::fs::create_dir_all(folder.path("presets/exports")).unwrap();
    let own = r#"{"export_preset": "Our island", "ending": "r16", "sizes": {"square": [17]}, "fit": "middle",
        "range": {"own": [-500, 3500]}, "byte_order": "big", "is_south_first": true}"#;
    folder.write("presets/exports/our-island.json", own);
    folder.succeed("export t.orogeny a.r16 --preset our-island");
    let written = samples(&folder, "a.r16", u16::from_be_bytes);
    assert_eq!(written.len(), 17 * 17);
    for (index, sample) in written.iter().enumerate() {
        let height_m = of_middle([index % 17, 16 - index / 17], [17, 17]);
        let expected = sample_of(f64::from(height_m), [-500.0, 3500.0]);
        assert!((f64::from(*sample) - expected).abs() < 0.6, "{index}: {sample} {expected}");
    }
}

#[test]
fn options_beside_a_preset_count_more() {
    let folder = terrain();
    let line = "export t.orogeny a.raw --preset unity-raw --size 40x30 --range -1000,4000 --byte-order big";
    let report = folder.succeed(line);
    assert!(report["advice"].to_string().contains("Byte Order Mac"), "{report}");
    let written = samples(&folder, "a.raw", u16::from_be_bytes);
    assert_eq!(written.len(), WIDTH * DEPTH);
    for (index, sample) in written.iter().enumerate() {
        let height_m = height_m(index % WIDTH, DEPTH - 1 - index / WIDTH);
        let expected = sample_of(f64::from(height_m), [-1000.0, 4000.0]);
        assert!((f64::from(*sample) - expected).abs() < 0.6, "{index}: {sample} {expected}");
    }
}

#[test]
fn what_cannot_be_written_so_is_refused_and_leaves_no_file() {
    let folder = terrain();
    std::fs::create_dir_all(folder.path("presets/exports")).unwrap();
    folder.write("presets/exports/torn.json", r#"{"export_preset": "Torn", "ending": "#);
    folder.write("there.raw", "what was there before");
    for (options, words) in [
        ("a.r32 --size 0x5", &["0 x 5"][..]),
        ("a.r32 --size 5x0 --fit middle", &["5 x 0"]),
        ("a.r32 --size 1048577x1", &["1048577", "1048576"]),
        ("a.r32 --size 4294967295x4294967295 --south-first", &["4294967295"]),
        ("a.r32 --size 5", &["--size", "4096x2048"]),
        ("a.r32 --size 5x5 --fit stretch", &["stretch", "resample", "middle"]),
        ("a.r32 --fit middle", &["--size", "--preset"]),
        ("a.r16 --preset unreal-5", &["unreal-5", "`Unreal R16`"]),
        // Why one of the user's is not there is said.
        ("a.r16 --preset torn", &["torn", "torn.json"]),
        ("a.png --preset unity-raw", &["Unity RAW", "a.png", "a.raw"]),
        ("a.xyz --preset unity-raw", &["a.xyz"]),
        ("a.raw --preset unity-raw --size 0x5", &["0 x 5"]),
        ("a.raw --preset unity-raw --size 4294967295x4294967295", &["4294967295"]),
        ("there.raw --preset unity-raw --range 0,10", &["there.raw", "range"]),
        ("there.raw --preset unity-raw --region 90,0,5,5", &["outside"]),
        ("there.raw --preset unity-raw --level 9", &["level 9"]),
        ("there.raw --preset unity-raw --layer Lost", &["Lost"]),
        ("no/such/a.raw --preset unity-raw", &["folder"]),
        ("a.hgt --size 1200x1200", &["1201 x 1201", "1200 x 1200"]),
    ] {
        folder.fail(&format!("export t.orogeny {options}"), words);
    }
}
