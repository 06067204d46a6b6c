//! Files, paths and values that cannot be used: exit code 1 or 2, a message that names the thing, nothing changed.

use orogeny_tests::repository;

use crate::program::Folder;

fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 64x64 --spacing 1 --height 5");
    folder
}

/// The first `share` of a sound file.
fn truncated(name: &str, share: f64) -> Vec<u8> {
    let bytes = std::fs::read(repository().join("tests/fixtures/formats/inputs").join(name)).unwrap();
    let length = (bytes.len() as f64 * share) as usize;
    bytes[..length].to_vec()
}

/// A grey PNG of 16 bits that says it has this size, with a few bytes of data.
fn png_of_size(width: u32, height: u32) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
        !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
    };
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [kind.as_slice(), data].concat();
        png.extend((data.len() as u32).to_be_bytes());
        png.extend(&body);
        png.extend(crc(&body).to_be_bytes());
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 0, 0, 0, 0]].concat();
    chunk(b"IHDR", &header);
    chunk(b"IDAT", &[0x78, 0x9c, 0x63, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01]);
    chunk(b"IEND", &[]);
    png
}

#[test]
fn files_that_are_not_whole_or_not_sound() {
    let folder = terrain();
    folder.write("cut.png", truncated("png-u16.png", 0.6));
    folder.write("head.png", truncated("png-u16.png", 0.01));
    folder.write("cut.tif", truncated("tiff-i16-strip-none-p1.tif", 0.6));
    folder.write("head.tif", truncated("tiff-i16-strip-none-p1.tif", 0.001));
    folder.write("N34W119.hgt", vec![0; 1201 * 1201 * 2 - 5000]);
    folder.write("cut.npy", truncated("npy-f32-c.npy", 0.6));
    folder.write("wrong.r16", [0; 7 * 2]);
    folder.write("odd.r16", [0; 15]);
    folder.write("empty.r16", []);
    folder.write("text.png", "this is no picture");
    folder.write("text.xyz", "this is no raster");
    let mut heights = [1.0_f32; 16];
    heights[5] = f32::NAN;
    folder.write("nan.r32", heights.map(f32::to_le_bytes).concat());
    heights[5] = f32::INFINITY;
    folder.write("inf.r32", heights.map(f32::to_le_bytes).concat());
    heights[5] = 1.0e30;
    folder.write("huge.r32", heights.map(f32::to_le_bytes).concat());

    for (arguments, words) in [
        ("missing.png", &["missing.png"][..]),
        ("cut.png", &["cut.png", "cut off"]),
        ("head.png", &["head.png"]),
        ("cut.tif", &["cut.tif"]),
        ("head.tif", &["head.tif"]),
        ("N34W119.hgt", &["N34W119.hgt"]),
        ("cut.npy", &["cut.npy"]),
        ("wrong.r16", &["wrong.r16", "no square"]),
        ("wrong.r16 --size 3x3", &["wrong.r16", "18", "14"]),
        ("odd.r16", &["odd.r16"]),
        ("empty.r16", &["empty.r16"]),
        ("text.png", &["text.png"]),
        ("text.xyz", &["text.xyz", ".png"]),
        ("nan.r32", &["nan.r32", "1 of 16", "column 1, row 1"]),
        ("inf.r32", &["inf.r32", "1 of 16"]),
        ("huge.r32", &["huge.r32", "1 of 16"]),
        (".", &["not a file"]),
    ] {
        // Once into a terrain that is there, once to make one.
        let (file, options) = arguments.split_once(' ').unwrap_or((arguments, ""));
        folder.fail(&format!("import {file} t.orogeny {options}"), words);
        folder.fail(&format!("import {file} new.orogeny {options}"), words);
    }
}

#[test]
fn rasters_that_say_they_are_far_larger_than_their_file() {
    let folder = terrain();
    folder.write("bomb.png", png_of_size(1 << 20, 1 << 20));
    folder.write("absurd.png", png_of_size(1 << 30, 1 << 30));
    folder.write("none.png", png_of_size(0, 16));
    folder.write("absurd.npy", {
        let header = format!(
            "{:<117}\n",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1099511627776, 1099511627776), }"
        );
        [b"\x93NUMPY\x01\x00".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes(), &[0; 64]]
            .concat()
    });
    for file in ["bomb.png", "absurd.png", "none.png", "absurd.npy"] {
        folder.fail(&format!("import {file} t.orogeny"), &[file]);
        folder.fail(&format!("import {file} new.orogeny"), &[file]);
    }
}

#[test]
fn sizes_and_values_that_no_terrain_has() {
    let folder = terrain();
    folder.write("a.raw", [0; 200]);
    for (line, words) in [
        ("new u.orogeny --size 0x5 --spacing 1", &["0 x 5"][..]),
        ("new u.orogeny --size 1099511627776x1099511627776 --spacing 1", &["1099511627776"]),
        ("new u.orogeny --size 1048577x1 --spacing 1", &["1048577", "1048576"]),
        ("new u.orogeny --size 99999999999999999999x1 --spacing 1", &["--size"]),
        ("new u.orogeny --size big --spacing 1", &["--size", "big"]),
        ("new u.orogeny --size 5x5 --spacing 0", &["spacing", "0"]),
        ("new u.orogeny --size 5x5 --spacing -1", &["spacing", "-1"]),
        ("new u.orogeny --size 5x5 --spacing NaN", &["spacing", "NaN"]),
        ("new u.orogeny --size 5x5 --spacing 1 --height NaN", &["height", "NaN"]),
        ("new u.orogeny --size 5x5 --spacing 1 --height 1e9", &["height"]),
        ("new u.orogeny --size 5x5", &["--spacing"]),
        ("new t.orogeny --size 5x5 --spacing 1", &["t.orogeny", "exists"]),
        ("new no/such/folder/u.orogeny --size 5x5 --spacing 1", &["folder"]),
        ("import a.raw u.orogeny", &["a.raw", "give"]),
        ("import a.raw u.orogeny --size 0x100 --sample u16", &["0 x 100"]),
        ("import a.raw u.orogeny --size 1099511627776x1 --sample u16", &["--size"]),
        ("import a.raw u.orogeny --size 1000000x1000000 --sample u16", &["a.raw", "200"]),
        ("import a.raw u.orogeny --size 10x10 --sample f64", &["f64"]),
        ("import a.raw u.orogeny --size 10x10 --sample u16 --range 5,1", &["--range"]),
        ("import a.raw u.orogeny --size 10x10 --sample u16 --at 5,1", &["--at"]),
        (
            "import a.raw u.orogeny --size 10x10 --sample u16 --rotate 45",
            &["45 degrees", "0, 90, 180 or 270"],
        ),
        ("import a.raw u.orogeny --size 10x10 --sample u16 --rotate -90", &["--rotate"]),
        ("import a.raw u.orogeny --size 10x10 --sample u16 --flip up", &["up", "east-west", "north-south"]),
        ("import a.raw t.orogeny --size 10x10 --sample u16 --at 64,0", &["outside"]),
        ("import a.raw t.orogeny --size 10x10 --sample u16 --at 1e300,0", &["outside"]),
        ("import a.raw t.orogeny --size 10x10 --sample u16 --spacing 2", &["2 m", "1 m"]),
        ("export t.orogeny out.exr", &["out.exr", ".tif"]),
        ("export t.orogeny no/such/folder/out.tif", &["folder"]),
        ("export t.orogeny out.tif --layer Lost", &["Lost", "Base"]),
        ("export t.orogeny out.tif --region 64,0,5,5", &["outside"]),
        ("export t.orogeny out.tif --region 0,0,-5,5", &["region"]),
        ("export t.orogeny out.png --range 0,4", &["out.png", "5,6"]),
        ("render t.orogeny out.png --size 0x5", &["0 x 5"]),
        ("render t.orogeny out.png --size 9000x5", &["9000", "8192"]),
        ("render t.orogeny out.png --eye 1,2", &["X,Y,Z"]),
        ("render t.orogeny out.png --eye 1e12,2,3", &["1000000000000", "100000000"]),
        ("render t.orogeny out.png --fov 0", &["field of view", "1 to 150"]),
        ("render t.orogeny out.png --sun 1,200", &["altitude", "200"]),
        ("render t.orogeny out.png --sun noon", &["AZIMUTH,ALTITUDE"]),
        ("render t.orogeny out.png --mode xray", &["xray", "wireframe"]),
        ("render t.orogeny out.png --map --mode slope", &["--map", "--mode"]),
        ("render t.orogeny out.png --region 0,0,5,5", &["--map"]),
        ("render t.orogeny out.png --fly lost.json", &["lost.json"]),
        ("render t.orogeny out.png --adapter nonsense", &["nonsense"]),
        ("render t.orogeny out.png --map --size 0x5", &["0 x 5"]),
        ("render t.orogeny out.png --map --size 1000000x5", &["1000000"]),
        ("render t.orogeny no/such/folder/out.png --map", &["out.png"]),
        ("undo t.orogeny -n 0", &["0"]),
        ("undo t.orogeny -n -1", &["-1"]),
        ("log t.orogeny --threads 0", &["--threads"]),
        ("log t.orogeny --page-budget 0", &["--page-budget"]),
        ("brushes melt", &["melt", "raise"]),
        ("paint t.orogeny", &["paint"]),
        ("apply t.orogeny - --adapter nonsense", &["nonsense"]),
    ] {
        if line.contains(" - ") {
            folder.fail_with_stdin(
                line,
                r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}}]}"#,
                words,
            );
        } else {
            folder.fail(line, words);
        }
    }
}

#[test]
fn paths_that_are_no_terrain() {
    let folder = terrain();
    folder.write("recipe.json", r#"{"operations": []}"#);
    folder.write("empty.orogeny", "");
    folder.write("text.orogeny", "this is no terrain, and long enough to be looked at ".repeat(40));
    let mut cut = folder.read("t.orogeny");
    cut.truncate(cut.len() / 3);
    folder.write("cut.orogeny", cut);
    for path in ["missing.orogeny", "empty.orogeny", "text.orogeny", "cut.orogeny", "."] {
        let named = if path == "." { "folder" } else { path };
        for line in ["info PATH", "log PATH", "undo PATH", "apply PATH recipe.json", "export PATH out.tif"] {
            folder.fail(&line.replace("PATH", path), &[named]);
        }
    }
}

#[test]
fn empty_paths() {
    let folder = terrain();
    for arguments in [
        &["new", "", "--size", "5x5", "--spacing", "1"][..],
        &["import", "", "u.orogeny"],
        &["import", "a.png", ""],
        &["apply", "t.orogeny", ""],
        &["export", "t.orogeny", ""],
        &["render", "t.orogeny", "", "--map"],
        &["info", ""],
        &["demo", ""],
    ] {
        let before = folder.state();
        let output = folder.command("").args(arguments).output().unwrap();
        let what = arguments.join(" ");
        crate::program::Ran::from(output).assert_failed(&what, &[]);
        folder.assert_state(&before, &what);
    }
}
