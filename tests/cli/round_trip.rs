//! Import, export and import again give the same heights.

use crate::program::Folder;

/// Heights with all bits in use: rough, negative, tiny.
fn heights() -> Vec<u8> {
    (0..40 * 30)
        .flat_map(|k: u32| {
            let height_m = (k as f32 * 0.7).sin() * 1234.567 - 3.0 / (k + 1) as f32;
            height_m.to_le_bytes()
        })
        .collect()
}

#[test]
fn formats_of_metres_keep_every_bit() {
    let folder = Folder::new();
    folder.write("first.r32", heights());
    folder.succeed("import first.r32 t.orogeny --size 40x30");
    for (file, options) in [
        ("second.r32", "--size 40x30"),
        ("second.tif", ""),
        ("second.npy", ""),
        ("second.raw", "--size 40x30 --sample f32"),
    ] {
        let sample = if file.ends_with(".raw") { "--sample f32" } else { "" };
        folder.succeed(&format!("export t.orogeny {file} {sample}"));
        folder.succeed(&format!("import {file} {file}.orogeny {options}"));
        folder.succeed(&format!("export {file}.orogeny third.r32"));
        assert_eq!(folder.read("third.r32"), folder.read("first.r32"), "{file}");
    }
    folder.succeed("export t.orogeny big.r32 --byte-order big");
    assert_ne!(folder.read("big.r32"), folder.read("first.r32"));
    folder.succeed("import big.r32 big.orogeny --byte-order big --size 40x30");
    folder.succeed("export big.orogeny third.r32");
    assert_eq!(folder.read("third.r32"), folder.read("first.r32"));
}

#[test]
fn formats_of_16_bits_keep_every_sample() {
    let folder = Folder::new();
    folder.write("first.r32", heights());
    folder.succeed("import first.r32 t.orogeny --size 40x30");
    for (file, options) in [("a.png", "--range -1300,1300"), ("a.r16", "--range -1300,1300")] {
        let size = if file.ends_with(".r16") { "--size 40x30" } else { "" };
        folder.succeed(&format!("export t.orogeny {file} {options}"));
        folder.succeed(&format!("import {file} {file}.orogeny {options} {size}"));
        folder.succeed(&format!("export {file}.orogeny second-{file} {options}"));
        assert_eq!(folder.read(file), folder.read(&format!("second-{file}")), "{file}");
        folder.succeed(&format!("export {file}.orogeny now.r32"));
        let half_a_step_m = 2600.0 / 65535.0 / 2.0 + 1.0e-3;
        for (was, is) in folder.heights("first.r32").iter().zip(folder.heights("now.r32")) {
            assert!((was - is).abs() <= half_a_step_m, "{file}: {was} became {is}");
        }
    }
}

#[test]
fn a_layer_and_a_region_go_their_own_ways() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 100x100 --spacing 1 --height 10");
    folder.write("first.r32", heights());
    let imported = folder.succeed("import first.r32 t.orogeny --size 40x30 --layer Detail --at 20,50");
    assert_eq!((&imported["made_terrain"], &imported["made_layer"]), (&false.into(), &true.into()));
    folder.succeed("export t.orogeny layer.r32 --layer Detail --region 20,50,40,30");
    assert_eq!(folder.read("layer.r32"), folder.read("first.r32"));
    folder.succeed("export t.orogeny sum.r32 --region 20,50,40,30");
    for (layer, sum) in folder.heights("layer.r32").iter().zip(folder.heights("sum.r32")) {
        assert_eq!((10.0 + layer).to_bits(), sum.to_bits());
    }
    assert_eq!(folder.succeed("info t.orogeny")["layers"].as_array().unwrap().len(), 2);
    folder.succeed("undo t.orogeny");
    assert_eq!(folder.succeed("info t.orogeny")["layers"].as_array().unwrap().len(), 1);
}

#[test]
fn heights_that_do_not_fit_are_refused_with_the_range_that_does() {
    let folder = Folder::new();
    folder.write("first.r32", heights());
    folder.succeed("import first.r32 t.orogeny --size 40x30");
    let ran = folder.run("export t.orogeny out.png");
    ran.assert_failed("export", &["out.png", "range"]);
    let range = ran.stderr.split_once("the range ").unwrap().1.trim();
    folder.succeed(&format!("export t.orogeny out.png --range {range}"));
}
