//! Presets: listed, shared between users, used in recipes, drawn.

use orogeny_tests::repository;
use serde_json::{Value, json};

use crate::program::Folder;

/// How many come with the program.
fn num_factory() -> usize {
    std::fs::read_dir(repository().join("assets/presets")).unwrap().count()
}

/// Applies a stroke with a brush to a new terrain, and gives the heights' bits.
fn painted(folder: &Folder, name: &str, brush: &Value) -> Vec<u32> {
    let stroke =
        json!({"op": "stroke", "seed": 3, "brush": brush, "points": [[40, 60], [150, 90, 0.5], [210, 200]]});
    folder.write("recipe.json", json!({ "operations": [stroke] }).to_string());
    folder.succeed(&format!("new {name}.orogeny --size 256x256 --spacing 1"));
    folder.succeed(&format!("apply {name}.orogeny recipe.json"));
    folder.succeed(&format!("export {name}.orogeny {name}.r32"));
    folder.heights(&format!("{name}.r32")).iter().map(|height_m| height_m.to_bits()).collect()
}

/// Size of a PNG by its header.
fn size_of_png(bytes: &[u8]) -> [u32; 2] {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    [16, 20].map(|place| u32::from_be_bytes(bytes[place..place + 4].try_into().unwrap()))
}

#[test]
fn those_that_come_with_the_program_are_listed_and_shown() {
    let folder = Folder::new();
    for line in ["presets", "presets list"] {
        let report = folder.succeed(line);
        let presets = report["presets"].as_array().unwrap();
        assert_eq!(presets.len(), num_factory());
        assert!(presets.iter().all(|preset| preset["from"] == "factory" && preset["description"] != ""));
        let hill = presets.iter().find(|preset| preset["preset"] == "Soft hill").unwrap();
        assert_eq!((&hill["brush"], &hill["tags"]), (&json!("raise"), &json!(["hill", "soft"])));
    }
    let text = folder.run("presets").stdout;
    assert!(
        text.contains("Soft hill") && text.contains(&format!("{} presets, 0 of them in ", num_factory())),
        "{text}"
    );
    let shown = folder.succeed("presets show SOFT-HILL");
    assert_eq!((&shown["preset"], &shown["brush"]["type"]), (&json!("Soft hill"), &json!("raise")));
    let text = folder.run("presets show soft-hill").stdout;
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), shown);
}

#[test]
fn a_preset_goes_from_user_to_user_and_paints_the_same_bits() {
    let folder = Folder::new();
    let brush = r#"{"type":"raise","radius":37.5,"profile":"gauss","strength":12.3}"#;
    let saved = folder
        .succeed(&format!("presets save Lone-ridge --brush {brush} --description Steep --tag mountain"));
    assert_eq!(saved["done"], "saved");
    folder.succeed("presets export lone-ridge ridge.json");
    let exported: Value = serde_json::from_slice(&folder.read("ridge.json")).unwrap();
    assert!(exported["thumbnail"].as_str().unwrap().starts_with("data:image/png;base64,"));

    let other = Folder::new();
    other.write("ridge.json", folder.read("ridge.json"));
    let words = &["operation 1 of 1", "Lone-ridge"];
    other.write("recipe.json", r#"{"operations": [{"op": "fill", "brush": {"preset": "Lone-ridge"}}]}"#);
    other.succeed("new t.orogeny --size 9x9 --spacing 1");
    other.fail("apply t.orogeny recipe.json", words);
    other.succeed("presets import ridge.json");
    let brush: Value = serde_json::from_str(brush).unwrap();
    let by_name = painted(&other, "by-name", &json!({"preset": "lone ridge"}));
    assert_eq!(by_name, painted(&other, "explicit", &brush));
    assert!(by_name.iter().any(|bits| *bits != 0));

    // Fields beside the name take the place of the preset's; the history holds the whole brush, and needs no preset.
    let by_name = painted(&other, "wider", &json!({"preset": "Lone ridge", "radius": 60, "profile": "tip"}));
    let mut wider = brush;
    (wider["radius"], wider["profile"]) = (json!(60), json!("tip"));
    assert_eq!(by_name, painted(&other, "explicit-wider", &wider));
    other.succeed("presets remove lone-ridge");
    other.succeed("replay wider.orogeny again.orogeny");
    other.succeed("export again.orogeny again.r32");
    assert_eq!(other.read("again.r32"), other.read("wider.r32"));
}

#[test]
fn a_users_preset_stands_in_for_the_programs() {
    let folder = Folder::new();
    let saved = folder.succeed(r#"presets save trench --brush {"preset":"Trench","strength":3}"#);
    assert!(saved["note"].as_str().unwrap().contains("stands in"));
    let shown = folder.succeed("presets show Trench");
    assert_eq!((&shown["brush"]["strength"], &shown["brush"]["falloff"]), (&json!(3), &json!(14)));
    folder.fail(r#"presets save trench --brush {"type":"raise"}"#, &["trench", "already", "trench.json"]);
    folder.succeed(r#"presets save trench --brush {"type":"raise"} --replace"#);
    assert_eq!(folder.succeed("presets show trench")["brush"], json!({"type": "raise"}));
    assert_eq!(folder.succeed("presets")["presets"].as_array().unwrap().len(), num_factory());
    assert!(folder.succeed("presets remove trench")["note"].as_str().unwrap().contains("again"));
    assert_eq!(folder.succeed("presets show trench")["brush"]["type"], "lower");
}

#[test]
fn what_cannot_be_used_is_named_and_nothing_is_changed() {
    let folder = Folder::new();
    folder.write("cut.json", r#"{"preset": "Cut", "brush": {"#);
    folder.write("field.json", r#"{"preset": "Field", "brush": {"type": "raise"}, "colour": 1}"#);
    folder.write("brush.json", r#"{"preset": "Brush", "brush": {"type": "raise", "radios": 1}}"#);
    folder.write("slash.json", r#"{"preset": "a/b", "brush": {"type": "raise"}}"#);
    folder.write("long.json", format!(r#"{{"preset": "Long", "thumbnail": "{}"}}"#, "x".repeat(1 << 20)));
    folder.write("binary.json", b"\xff\xfe\x00");
    folder.succeed("presets save mine --presets . --brush {\"type\":\"raise\"}");
    for (line, words) in [
        ("show sofd-hill", &["sofd-hill", "`Soft hill`"][..]),
        ("show xyzzy", &["xyzzy", "none of the ", "6 of the files in `.`"]),
        ("show a/b", &["a/b", "`/`"]),
        ("show cut", &["cut.json", "cannot be used"]),
        ("import cut.json", &["cut.json"]),
        ("import field.json", &["field.json", "colour"]),
        ("import brush.json", &["brush.json", "radios"]),
        ("import slash.json", &["slash.json", "a/b", "`/`"]),
        ("import long.json", &["long.json", "1048576"]),
        ("import binary.json", &["binary.json", "UTF-8"]),
        ("import missing.json", &["missing.json"]),
        ("import .", &["not a file"]),
        ("import mine.json", &["mine", "already"]),
        ("save a/b --brush {\"type\":\"raise\"}", &["a/b", "`/`"]),
        ("save a\\b --brush {\"type\":\"raise\"}", &["`\\`"]),
        ("save a --brush {\"type\":\"raise\",\"radius\":0}", &["radius"]),
        ("save a --brush {\"preset\":\"trench\",\"type\":\"raise\"}", &["Trench", "raise", "lower"]),
        ("save a --brush [1]", &["--brush"]),
        ("save a --brush {\"type\":\"raise\"} --tag xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx", &["tag", "32"]),
        ("remove soft-hill", &["soft-hill", "comes with the program"]),
        ("remove xyzzy", &["xyzzy"]),
        ("export xyzzy out.json", &["xyzzy"]),
        ("export trench no/such/folder/out.json", &["out.json"]),
        ("thumbnail xyzzy out.png", &["xyzzy"]),
        ("thumbnail trench out.png --size 0", &["0 x"]),
        ("thumbnail trench out.png --size 9000", &["9000"]),
        ("--gallery out.png --size 10", &["10"]),
        ("--gallery out.png --size 8000", &["000 x "]),
        ("--size 100", &["--gallery"]),
        ("list --gallery out.png", &["--gallery"]),
        ("melt", &["melt"]),
    ] {
        folder.fail(&format!("presets {line} --presets ."), words);
    }
    folder.fail("presets show trench --presets mine.json", &["trench", "mine.json"]);
    let ran = folder.run("presets --presets .");
    assert!(
        ran.stdout.contains("note: `./cut.json`")
            && ran.stdout.contains(&format!("{} presets, 1 of them in .", num_factory() + 1)),
        "{ran:?}"
    );
}

#[test]
fn all_of_them_are_drawn_in_one_picture() {
    let folder = Folder::new();
    let report = folder.succeed("presets --gallery gallery.png --size 96");
    let bytes = folder.read("gallery.png");
    assert_eq!(json!(size_of_png(&bytes)), json!([report["width_px"], report["height_px"]]));
    // Below each picture two lines for a name at most.
    let num_columns = (num_factory() as f64).sqrt().ceil() as usize;
    let num_rows = num_factory().div_ceil(num_columns) as u64;
    assert_eq!(report["width_px"], num_columns * 96);
    assert!((num_rows * 90..num_rows * 120).contains(&report["height_px"].as_u64().unwrap()), "{report}");
    assert!((num_factory() * 500..num_factory() * 8_000).contains(&bytes.len()), "{} bytes", bytes.len());

    folder.succeed("presets thumbnail trench trench.png --size 200");
    folder.succeed("presets thumbnail soft-hill hill.png --size 200");
    assert_eq!(size_of_png(&folder.read("trench.png")), [200, 150]);
    assert_ne!(folder.read("trench.png"), folder.read("hill.png"));
}

#[test]
fn a_preset_that_cannot_be_drawn_leaves_its_place_empty() {
    let folder = Folder::new();
    let preset = json!({"preset": "Odd", "brush": {"type": "ledge"}, "sample": {"kind": "fill"}});
    folder.write("odd.json", preset.to_string());
    folder.succeed("presets import odd.json");
    let report = folder.succeed("presets --gallery gallery.png --size 80");
    let notice = report["notices"][0].as_str().unwrap();
    assert!(notice.contains("`Odd`") && notice.contains("height"), "{notice}");
    folder.fail("presets thumbnail odd odd.png", &["height"]);
}
