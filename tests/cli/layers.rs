//! The layer stack by the command `layer`, by recipes and as it is exported, each command a process of its own.

use serde_json::{Value, json};

use crate::program::Folder;

const SIDE: usize = 100;

/// Flat, at 100 m.
fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed(&format!("new t.orogeny --size {SIDE}x{SIDE} --spacing 1 --height 100"));
    folder
}

/// What `info` says of the layers, from the bottom.
fn layers(folder: &Folder) -> Vec<Value> {
    folder.succeed("info t.orogeny")["layers"].as_array().unwrap().clone()
}

fn layer(folder: &Folder, name: &str) -> Value {
    let layers = layers(folder);
    layers.into_iter().find(|layer| layer["name"] == name).unwrap_or_else(|| panic!("there is no {name}"))
}

/// The names from the bottom.
fn names(folder: &Folder) -> Vec<String> {
    layers(folder).iter().map(|layer| layer["name"].as_str().unwrap().to_owned()).collect()
}

fn heights(folder: &Folder) -> Vec<f32> {
    folder.heights_of("t.orogeny")
}

/// The height that is the same everywhere.
fn height(folder: &Folder) -> f32 {
    let heights = heights(folder);
    assert!(heights.iter().all(|height_m| *height_m == heights[0]), "it is not the same everywhere");
    heights[0]
}

fn exported(folder: &Folder, options: &str) -> Vec<f32> {
    folder.succeed(&format!("export t.orogeny part.r32 {options}"));
    folder.heights("part.r32")
}

fn at(plane: &[f32], x: usize, z: usize) -> f32 {
    plane[z * SIDE + x]
}

/// A dab of 10 m at (30, 40) m, with a radius of 10 m and no slope.
fn dab(layer: &str) -> Value {
    let brush = json!({"type": "raise", "radius": 10, "falloff": 0, "strength": 10});
    json!({"op": "stroke", "layer": layer, "brush": brush, "points": [[30, 40]]})
}

/// Selects the square of 20 m from (50, 50) m on.
fn selecting() -> Value {
    json!({"op": "fill", "target": "selection", "brush": {"type": "paint_mask"}, "region": [50, 50, 20, 20]})
}

#[test]
fn a_layer_is_made_of_heights_by_a_brush_or_is_a_group() {
    let folder = terrain();
    let made = folder.succeed("layer add t.orogeny Plateau --height 5");
    assert_eq!(
        (&made["made_layer"], &made["layer"], &made["name"]),
        (&2.into(), &2.into(), &"Plateau".into())
    );
    assert_eq!(layer(&folder, "Plateau")["constant_m"], 5.0);
    assert_eq!(height(&folder), 105.0);

    let raise = r#"{"type":"raise","strength":3}"#;
    folder.succeed(&format!("layer add t.orogeny Lift --procedural {raise} --opacity 0.5 --seed 7 --locked"));
    let lift = layer(&folder, "Lift");
    assert_eq!((&lift["content"], &lift["brush"]), (&"procedural".into(), &"raise".into()));
    assert_eq!(
        (&lift["opacity"], &lift["locked"], &lift["blend"]),
        (&0.5.into(), &true.into(), &"add".into())
    );
    assert_eq!(height(&folder), 106.5);

    // A brush from a file, and one that is a preset.
    folder.write("flat.json", r#"{"type": "set_height", "height": 50, "strength": 1}"#);
    folder.succeed("layer add t.orogeny Flat --effect flat.json --hidden");
    assert_eq!(layer(&folder, "Flat")["visible"], false);
    assert_eq!(height(&folder), 106.5);
    folder.succeed(r#"presets save Sea --brush {"type":"set_height","height":0,"strength":1}"#);
    folder.succeed("layer add t.orogeny Sea --effect sea --blend min --above Base");
    assert_eq!(layer(&folder, "Sea")["blend"], "min");
    assert_eq!(height(&folder), 6.5);

    folder.succeed("layer add t.orogeny Group --group");
    folder.succeed("layer add t.orogeny Inner --height 2 --in Group --blend max");
    assert_eq!(layer(&folder, "Inner")["group"], layer(&folder, "Group")["id"]);
    assert_eq!(names(&folder), ["Base", "Sea", "Plateau", "Lift", "Flat", "Inner", "Group"]);
    assert_eq!(height(&folder), 6.5);
    folder.succeed("layer add t.orogeny Higher --height 20 --in #6 --blend max --above Inner");
    assert_eq!(height(&folder), 20.0);
    folder.succeed("layer set t.orogeny Group --hide");
    assert_eq!(height(&folder), 6.5);
}

#[test]
fn a_mask_of_terms_and_a_seed_come_with_a_new_layer() {
    let folder = terrain();
    folder.apply("t.orogeny", "", &json!([dab("Base")]));
    let mask = r#"[{"gate":{"height":{"min":105,"max":200}}}]"#;
    folder.succeed(&format!("layer add t.orogeny Snow --height 4 --mask {mask}"));
    assert_eq!(layer(&folder, "Snow")["mask_terms"][0]["gate"]["height"]["min"], 105.0);
    let snowed = heights(&folder);
    assert_eq!((at(&snowed, 30, 40), at(&snowed, 60, 40)), (114.0, 100.0));

    let roughen = r#"{"type":"roughen","strength":1}"#;
    let mut seen = Vec::new();
    for seed in [1, 2, 1] {
        folder.succeed(&format!("layer add t.orogeny Rough --procedural {roughen} --seed {seed}"));
        seen.push(heights(&folder));
        folder.succeed("undo t.orogeny");
    }
    assert!(seen[0] == seen[2] && seen[0] != seen[1] && seen[0] != snowed);
}

#[test]
fn the_stack_is_listed_from_the_top() {
    let folder = terrain();
    for line in
        ["Group --group", "Inner --in Group --hidden", r#"Noise --procedural {"type":"noise"} --seed 9"#]
    {
        folder.succeed(&format!("layer add t.orogeny {line}"));
    }
    let text = folder.run("layer list t.orogeny").stdout;
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 5, "{text}");
    for (line, words) in lines.iter().zip([
        &["id", "made of", "opacity"][..],
        &[" 4  Noise", "procedural noise", "add"],
        &[" 2  Group", "group"],
        &[" 3    Inner", "heights, 0 pages", "in `Group`, hidden"],
        &[" 1  Base", "heights, 0 pages"],
    ]) {
        assert!(words.iter().all(|word| line.contains(word)), "{line}: {words:?}");
    }
    let report = folder.succeed("layer list t.orogeny");
    assert_eq!(report["layers"][0]["procedure"]["seed"], 9);
    assert_eq!(report["layers"][0]["procedure"]["brush"]["type"], "noise");
    let listed: Vec<_> = report["layers"].as_array().unwrap().iter().map(|one| one["id"].clone()).collect();
    assert_eq!(listed, [4, 2, 3, 1]);
    // What both say of a layer is the same.
    let mut from_info = layer(&folder, "Inner");
    from_info.as_object_mut().unwrap().remove("memory");
    assert_eq!(report["layers"][2], from_info);
}

#[test]
fn what_is_set_is_changed_and_nothing_else() {
    let folder = terrain();
    folder.succeed("layer add t.orogeny Hill");
    folder.apply("t.orogeny", "", &json!([dab("Hill")]));
    let before = layer(&folder, "Hill");
    for (options, field, value) in [
        ("--opacity 0.5", "opacity", json!(0.5)),
        ("--blend subtract", "blend", json!("subtract")),
        ("--hide", "visible", json!(false)),
        ("--lock", "locked", json!(true)),
        ("--unlock", "locked", json!(false)),
        ("--name Mound", "name", json!("Mound")),
    ] {
        let set = folder.succeed(&format!("layer set t.orogeny #2 {options}"));
        assert_eq!((&set["layer"], &set["operation"]), (&2.into(), &"set_layer".into()), "{options}");
        assert_eq!(layers(&folder)[1][field], value, "{options}");
    }
    assert_eq!(height(&folder), 100.0);
    folder.succeed("layer set t.orogeny Mound --show");
    assert_eq!(at(&heights(&folder), 30, 40), 95.0);
    folder.succeed("layer set t.orogeny Mound --opacity 1 --blend add --name Hill");
    assert_eq!(layer(&folder, "Hill"), before);
    assert_eq!(folder.succeed("info t.orogeny")["history"]["num_applied"], 10);
}

#[test]
fn one_number_of_a_transform_is_set_and_the_others_stay() {
    let folder = terrain();
    folder.succeed("layer add t.orogeny Hill");
    folder.apply("t.orogeny", "", &json!([dab("Hill")]));
    folder.succeed("layer set t.orogeny Hill --move 20,-5");
    let moved = heights(&folder);
    assert_eq!((at(&moved, 30, 40), at(&moved, 50, 35)), (100.0, 110.0));
    folder.succeed("layer set t.orogeny Hill --height-scale -2");
    assert_eq!(at(&heights(&folder), 50, 35), 80.0);
    for options in ["--rotate 90", "--pivot 30,40", "--scale 2"] {
        folder.succeed(&format!("layer set t.orogeny Hill {options}"));
    }
    assert_eq!(
        layer(&folder, "Hill")["transform"],
        json!({"move": [20.0, -5.0], "rotate": 90.0, "scale": 2.0, "pivot": [30.0, 40.0], "height_scale": -2.0})
    );
    // About its own centre, twice as wide.
    let turned = heights(&folder);
    assert_eq!((at(&turned, 50, 35), at(&turned, 67, 35), at(&turned, 73, 35)), (80.0, 80.0, 100.0));
    folder.succeed("undo t.orogeny -n 5");
    assert_eq!(at(&heights(&folder), 30, 40), 110.0);
    assert!(layer(&folder, "Hill")["transform"].is_null());
}

#[test]
fn a_layer_gets_another_brush_and_keeps_its_seed() {
    let folder = terrain();
    folder.succeed(r#"layer add t.orogeny Lift --procedural {"type":"raise","strength":3} --seed 5"#);
    let procedure = || folder.succeed("layer list t.orogeny")["layers"][0]["procedure"].clone();
    folder.succeed(r#"layer set t.orogeny Lift --brush {"type":"lower","strength":8}"#);
    assert_eq!((&procedure()["seed"], height(&folder)), (&5.into(), 92.0));
    folder.succeed("layer set t.orogeny Lift --seed 6");
    assert_eq!((&procedure()["seed"], &procedure()["brush"]["strength"]), (&6.into(), &8.0.into()));
    folder.fail(r#"layer set t.orogeny Base --brush {"type":"raise"}"#, &["Base", "`heights`"]);
}

#[test]
fn layers_are_moved_copied_and_removed() {
    let folder = terrain();
    for line in ["A --height 1", "B --height 30 --blend max", "Group --group", "C --height 4 --in Group"] {
        folder.succeed(&format!("layer add t.orogeny {line}"));
    }
    assert_eq!(
        (names(&folder), height(&folder)),
        (["Base", "A", "B", "C", "Group"].map(String::from).into(), 105.0)
    );
    folder.succeed("layer move t.orogeny Base --above B");
    assert_eq!(names(&folder), ["A", "B", "Base", "C", "Group"]);
    assert_eq!(height(&folder), 134.0);
    folder.succeed("layer move t.orogeny Group --bottom");
    assert_eq!(names(&folder), ["C", "Group", "A", "B", "Base"]);
    assert_eq!(height(&folder), 130.0);
    folder.succeed("layer move t.orogeny A --above C --in Group");
    assert_eq!(layer(&folder, "A")["group"], layer(&folder, "Group")["id"]);
    folder.succeed("layer move t.orogeny C --above Base");
    assert!(layer(&folder, "C")["group"].is_null());
    assert_eq!(
        (names(&folder), height(&folder)),
        (["A", "Group", "B", "Base", "C"].map(String::from).into(), 134.0)
    );

    let copied = folder.succeed("layer duplicate t.orogeny C");
    assert_eq!((&copied["made_layer"], &copied["name"]), (&6.into(), &"C copy".into()));
    folder.apply("t.orogeny", "", &json!([dab("C copy")]));
    let copied = folder.succeed("layer duplicate t.orogeny #6 --name Third");
    assert_eq!(copied["num_pages"], 1);
    assert_eq!(names(&folder)[4..], ["C", "C copy", "Third"]);
    let summed = heights(&folder);
    assert_eq!((at(&summed, 30, 40), at(&summed, 60, 40)), (162.0, 142.0));

    folder.succeed("layer remove t.orogeny Group");
    assert_eq!(names(&folder), ["A", "B", "Base", "C", "C copy", "Third"]);
    assert!(layer(&folder, "A")["group"].is_null());
    folder.succeed("undo t.orogeny");
    folder.succeed("layer remove t.orogeny Group --members");
    assert_eq!(names(&folder), ["B", "Base", "C", "C copy", "Third"]);
    folder.succeed("undo t.orogeny -n 10");
    assert_eq!((names(&folder), height(&folder)), (["Base", "A", "B"].map(String::from).into(), 101.0));
    folder.succeed("redo t.orogeny -n 9");
    assert_eq!(heights(&folder), summed);
}

#[test]
fn what_a_layer_shows_is_baked_and_can_be_painted_on() {
    let folder = terrain();
    folder.succeed(r#"layer add t.orogeny Rough --procedural {"type":"roughen","strength":2}"#);
    let rough = heights(&folder);
    folder.write("recipe.json", json!({"operations": [dab("Rough")]}).to_string());
    folder.fail("apply t.orogeny recipe.json", &["Rough", "collapse"]);
    folder.succeed("layer collapse t.orogeny Rough");
    assert_eq!(layer(&folder, "Rough")["content"], "heights");
    assert_eq!(heights(&folder), rough);
    folder.apply("t.orogeny", "", &json!([dab("Rough")]));
    let painted = heights(&folder);
    assert_eq!(at(&painted, 60, 40), at(&rough, 60, 40));
    assert!((at(&painted, 30, 40) - at(&rough, 30, 40) - 10.0).abs() < 1e-4);
    folder.fail("layer collapse t.orogeny Rough", &["Rough", "lie where they are"]);

    folder.succeed(r#"layer add t.orogeny Half --effect {"type":"set_height","height":50} --opacity 0.5"#);
    folder.succeed("layer add t.orogeny Hidden --height 7 --hidden");
    let whole = heights(&folder);
    folder.succeed("layer collapse t.orogeny Half --below");
    assert_eq!(names(&folder), ["Half", "Hidden"]);
    assert_eq!(heights(&folder), whole);
    assert_eq!(
        (&layer(&folder, "Half")["opacity"], &layer(&folder, "Half")["blend"]),
        (&1.0.into(), &"add".into())
    );
    folder.succeed("undo t.orogeny");
    assert_eq!((names(&folder).len(), heights(&folder)), (4, whole));

    // Of a group what is hidden in it stays, in no group.
    folder.succeed("layer add t.orogeny Group --group");
    folder.succeed("layer move t.orogeny Hidden --above Half --in Group");
    folder.succeed("layer add t.orogeny Seen --in Group --height 3");
    let whole = heights(&folder);
    folder.succeed("layer collapse t.orogeny Group --below");
    assert_eq!((names(&folder), heights(&folder)), (vec!["Group".to_owned(), "Hidden".to_owned()], whole));
    assert!(layer(&folder, "Hidden")["group"].is_null());
}

#[test]
fn a_brush_on_an_upper_layer_works_on_what_is_seen_unless_it_is_told_otherwise() {
    let folder = terrain();
    folder.succeed("layer add t.orogeny Top --height 8");
    let set = json!({"type": "set_height", "height": 50, "strength": 1});
    folder.apply("t.orogeny", "", &json!([{"op": "fill", "layer": "Top", "brush": set}]));
    assert_eq!(height(&folder), 50.0);
    assert!(exported(&folder, "--layer Top").iter().all(|height_m| *height_m == -50.0));
    folder.succeed("undo t.orogeny");
    folder.apply(
        "t.orogeny",
        "",
        &json!([{"op": "fill", "layer": "Top", "target": "heights", "brush": set}]),
    );
    assert_eq!(height(&folder), 150.0);
    assert!(folder.run("log t.orogeny").stdout.contains("height 50 m, own heights of layer 2"));
}

#[test]
fn masks_are_painted_at_once_faded_and_worked_out() {
    let folder = terrain();
    folder.apply("t.orogeny", "", &json!([selecting(), dab("Base")]));
    folder.succeed("layer add t.orogeny Top --height 8");
    let seen = |line: &str| {
        folder.succeed(&format!("layer mask t.orogeny Top {line}"));
        let plane = heights(&folder);
        [at(&plane, 60, 60), at(&plane, 10, 10)]
    };
    assert_eq!(seen("--nothing"), [100.0, 100.0]);
    assert_eq!(layer(&folder, "Top")["has_painted_mask"], true);
    assert_eq!(seen("--selection"), [108.0, 100.0]);
    assert_eq!(seen("--scale 0.5"), [104.0, 100.0]);
    assert_eq!(seen("--invert"), [104.0, 108.0]);
    assert_eq!(seen("--selection --invert --scale 0.25"), [100.0, 102.0]);
    assert_eq!(seen("--all"), [108.0, 108.0]);
    assert_eq!(layer(&folder, "Top")["has_painted_mask"], false);
    assert_eq!(seen(r#"--keep --terms [{"gate":{"selection":true},"invert":true}]"#), [100.0, 108.0]);
    assert_eq!(layer(&folder, "Top")["mask_terms"][0]["invert"], true);
    assert_eq!(seen("--nothing --invert"), [100.0, 108.0]);
    assert_eq!(seen("--terms []"), [108.0, 108.0]);
    assert!(layer(&folder, "Top")["mask_terms"].is_null());
}

#[test]
fn a_mask_that_a_brush_made_is_made_again_when_that_is_asked_for() {
    let folder = terrain();
    folder.apply("t.orogeny", "", &json!([dab("Base")]));
    folder.succeed("layer add t.orogeny Top --height 8");
    let high = r#"{"type":"paint_mask","gate":{"height":{"min":105,"max":200}}}"#;
    folder.succeed(&format!("layer mask t.orogeny Top --brush {high} --seed 3 --scale 0.5"));
    let seen = || {
        let plane = heights(&folder);
        [at(&plane, 30, 40), at(&plane, 70, 70), at(&plane, 10, 10)]
    };
    assert_eq!((seen(), layer(&folder, "Top")["is_stale"].clone()), ([114.0, 100.0, 100.0], false.into()));
    let mut second = dab("Base");
    second["points"] = json!([[70, 70]]);
    folder.apply("t.orogeny", "", &json!([second]));
    assert_eq!((seen(), layer(&folder, "Top")["is_stale"].clone()), ([114.0, 110.0, 100.0], true.into()));
    folder.succeed("salvage t.orogeny saved.orogeny");
    folder.succeed("layer refresh t.orogeny Top");
    assert_eq!((seen(), layer(&folder, "Top")["is_stale"].clone()), ([114.0, 114.0, 100.0], false.into()));
    assert!(folder.run("log t.orogeny").stdout.contains("set_mask 2, painted by paint_mask, scale 0.5"));
    // What was saved has no history that would tell what its mask was made of.
    assert_eq!(folder.succeed("info saved.orogeny")["layers"][1]["is_stale"], true);
    folder.succeed("layer refresh saved.orogeny Top");
    assert_eq!(folder.heights_of("saved.orogeny"), heights(&folder));
}

#[test]
fn an_effect_that_is_kept_is_worked_out_when_that_is_asked_for() {
    let folder = terrain();
    let slide = r#"{"type":"erode_thermal","talus_angle":20}"#;
    folder.succeed(&format!("layer add t.orogeny Slide --effect {slide}"));
    assert_eq!((height(&folder), layer(&folder, "Slide")["is_stale"].clone()), (100.0, false.into()));
    folder.apply("t.orogeny", "", &json!([dab("Base")]));
    let unslid = heights(&folder);
    assert_eq!(layer(&folder, "Slide")["is_stale"], true);
    assert!(folder.run("info t.orogeny").stdout.contains("`layer refresh`"));
    let refreshed = folder.succeed("layer refresh t.orogeny Slide");
    assert_eq!((&refreshed["operation"], &refreshed["num_pages"]), (&"refresh_layer".into(), &1.into()));
    assert_eq!(layer(&folder, "Slide")["is_stale"], false);
    let slid = heights(&folder);
    assert!(at(&slid, 38, 40) < at(&unslid, 38, 40) && at(&slid, 42, 40) > at(&unslid, 42, 40));

    folder
        .succeed(r#"layer set t.orogeny Slide --brush {"type":"erode_thermal","talus_angle":10} --deferred"#);
    assert_eq!((heights(&folder), layer(&folder, "Slide")["is_stale"].clone()), (slid.clone(), true.into()));
    folder.succeed("layer refresh t.orogeny Slide");
    assert_ne!(heights(&folder), slid);
    folder.succeed("undo t.orogeny -n 3");
    assert_eq!((heights(&folder), layer(&folder, "Slide")["is_stale"].clone()), (unslid, true.into()));

    // How it would join what is below is no matter: the difference is added.
    folder.succeed("undo t.orogeny");
    folder.succeed("layer set t.orogeny Slide --blend max");
    assert_eq!(layer(&folder, "Slide")["is_stale"], false);

    folder.succeed(&format!("layer add t.orogeny Later --effect {slide} --deferred"));
    assert_eq!(layer(&folder, "Later")["is_stale"], true);
    folder.fail("layer refresh t.orogeny Base", &["Base", "no effect that is kept"]);
}

#[test]
fn wrong_uses_are_refused_and_change_nothing() {
    let folder = terrain();
    for line in [
        "Group --group",
        "Inner --in Group",
        "Held --in Group --locked",
        r#"Noise --procedural {"type":"noise"}"#,
        "Locked --locked",
    ] {
        folder.succeed(&format!("layer add t.orogeny {line}"));
    }
    let clone = json!({"type": "clone", "source": {"layer": "Noise", "at": [0, 0], "to": [0, 0]}});
    let cloning = json!({"operations": [{"op": "fill", "layer": "Base", "brush": clone}]});
    folder.write("cloning.json", cloning.to_string());
    let tall = json!({"op": "add_layer", "name": "Tall", "height": 5, "content": {"type": "group"}});
    folder.write("tall.json", json!({"operations": [tall]}).to_string());
    folder.write("recipe.json", json!({"operations": [dab("Locked")]}).to_string());
    folder.write("bad.json", r#"{"type": "noise", "octves": 3}"#);
    for (line, words) in [
        ("layer set t.orogeny Lost --hide", &["Lost", "Base"][..]),
        ("layer set t.orogeny #77 --hide", &["id 77"]),
        ("layer move t.orogeny Base --above Lost", &["Lost"]),
        ("layer add t.orogeny New --in Lost", &["Lost"]),
        ("layer add t.orogeny New --in Base", &["Base", "no group"]),
        ("layer add t.orogeny Noise", &["`Noise` already"]),
        ("layer set t.orogeny Inner --name Base", &["`Base` already"]),
        ("layer duplicate t.orogeny Noise --name Inner", &["`Inner` already"]),
        ("layer duplicate t.orogeny Group", &["Group", "it is a group"]),
        ("layer move t.orogeny Group --above Inner", &["Group", "Inner"]),
        ("layer move t.orogeny Group --bottom --in Group", &["in itself"]),
        ("layer set t.orogeny Locked --move 1,1", &["Locked", "locked"]),
        ("layer remove t.orogeny Locked", &["Locked", "locked"]),
        ("layer mask t.orogeny Locked --nothing", &["Locked", "locked"]),
        ("layer collapse t.orogeny Locked --below", &["Locked", "locked"]),
        ("apply t.orogeny recipe.json", &["Locked", "locked"]),
        ("layer set t.orogeny Noise --scale 2", &["Noise", "feature_size"]),
        ("layer set t.orogeny Base --scale 0", &["transform.scale", "0.01 to 100"]),
        ("layer set t.orogeny Base --opacity 1.5", &["opacity", "1.5"]),
        ("layer set t.orogeny Base --opacity -1", &["opacity", "-1"]),
        ("layer mask t.orogeny Base --scale 2", &["scale", "2"]),
        (r#"layer add t.orogeny New --procedural {"type":"noise","octves":3}"#, &["octves"]),
        ("layer add t.orogeny New --procedural bad.json", &["octves"]),
        ("layer add t.orogeny New --procedural lost.json", &["lost.json"]),
        ("layer add t.orogeny New --procedural Trensh", &["Trensh", "`Trench`"]),
        (r#"layer add t.orogeny New --procedural {"type":"erode_fluvial"}"#, &["erode_fluvial", "`effect`"]),
        (r#"layer add t.orogeny New --effect {"type":"smear"}"#, &["smear"]),
        (r#"layer set t.orogeny Noise --brush {"type":"noise","feature_size":1}"#, &["feature_size"]),
        ("layer remove t.orogeny Group --members", &["Held", "locked"]),
        ("layer collapse t.orogeny Group --below", &["Held", "locked"]),
        ("apply t.orogeny cloning.json", &["Noise", "cloned"]),
        ("apply t.orogeny tall.json", &["Tall", "`height`"]),
        ("layer add lost.orogeny New", &["lost.orogeny"]),
        ("layer refresh t.orogeny Noise", &["Noise"]),
    ] {
        folder.fail(line, words);
        assert_eq!(folder.run(line).code, Some(1), "{line}");
    }
    for (line, words) in [
        ("layer", &["list"][..]),
        ("layer melt t.orogeny", &["melt"]),
        ("layer add t.orogeny", &["NAME"]),
        ("layer add t.orogeny New --group --procedural {}", &["--group", "--procedural"]),
        ("layer add t.orogeny New --effect {} --procedural {}", &["--effect", "--procedural"]),
        ("layer add t.orogeny New --group --height 5", &["--group", "--height"]),
        ("layer add t.orogeny New --seed 5", &["--effect"]),
        ("layer add t.orogeny New --procedural {} --deferred", &["--procedural", "--deferred"]),
        ("layer add t.orogeny New --deferred", &["--effect"]),
        ("layer add t.orogeny New --group --seed 5", &["--group", "--seed"]),
        ("layer add t.orogeny New --procedural {", &["--procedural", "JSON object"]),
        ("layer add t.orogeny New --procedural [1]", &["--procedural", "JSON object"]),
        ("layer add t.orogeny New --blend screen", &["screen", "laplacian"]),
        (r#"layer add t.orogeny New --mask {"mask":1}"#, &["--mask", "JSON array"]),
        (r#"layer add t.orogeny New --mask [{"mask":1,"blurr":2}]"#, &["--mask", "blurr"]),
        (r#"layer add t.orogeny New --mask [{"gate":{"slop":{}}}]"#, &["--mask", "slop"]),
        (r#"layer mask t.orogeny Base --terms [{"blur":2}]"#, &["--terms", "one of"]),
        ("layer set t.orogeny Base", &["--opacity", "--brush"]),
        ("layer set t.orogeny Base --show --hide", &["--show", "--hide"]),
        ("layer set t.orogeny Base --lock --unlock", &["--lock", "--unlock"]),
        ("layer set t.orogeny Base --move 5", &["--move", "X,Z"]),
        ("layer set t.orogeny Base --hide --deferred", &["--brush"]),
        ("layer move t.orogeny Base", &["--above", "--bottom"]),
        ("layer move t.orogeny Base --above Inner --bottom", &["--above", "--bottom"]),
        ("layer mask t.orogeny Base", &["--all", "--terms"]),
        ("layer mask t.orogeny Base --all --nothing", &["--all", "--nothing"]),
        ("layer mask t.orogeny Base --all --brush {}", &["--all", "--brush"]),
        ("layer mask t.orogeny Base --all --seed 1", &["--all", "--seed"]),
        ("export t.orogeny out.r32 --layer Base --mask Base", &["--layer", "--mask"]),
        ("export t.orogeny out.r32 --selection --mask Base", &["--selection", "--mask"]),
    ] {
        folder.fail(line, words);
        assert_eq!(folder.run(line).code, Some(2), "{line}");
    }
}

/// Every operation on layers.
fn recipe() -> Value {
    let noise = json!({"type": "noise", "feature_size": 30, "strength": 6});
    json!([
        {"op": "add_layer", "name": "Hills", "content": {"type": "procedural", "brush": noise, "seed": 3}},
        {"op": "add_layer", "name": "Mound", "above": "Base"},
        dab("Mound"),
        {"op": "add_layer", "name": "Weather", "content": {"type": "group"}},
        {"op": "add_layer", "name": "Slide", "group": "Weather",
         "content": {"type": "effect", "brush": {"preset": "Slide"}}, "mask": [{"gate": {"slope": {"min": 5, "feather": 5}}}]},
        {"op": "set_layer", "layer": "Mound", "transform": {"move": [30, 10], "rotate": 20}, "opacity": 0.9},
        selecting(),
        {"op": "set_mask", "layer": "Hills", "from": "selection", "invert": true, "scale": 0.5,
         "terms": [{"heights": {"layer": "Mound", "low": 5, "high": 0}, "blur": 3, "combine": "max"}]},
        {"op": "duplicate_layer", "layer": "Mound", "name": "Second"},
        {"op": "set_layer", "layer": "Second", "transform": {"move": [-10, -10], "scale": 2, "pivot": [30, 40]}},
        {"op": "move_layer", "layer": "Second", "above": "Hills"},
        {"op": "collapse_layer", "layer": "Second"},
        {"op": "refresh_layer", "layer": "Slide"},
        {"op": "add_layer", "name": "Spare", "height": 90},
        {"op": "remove_layer", "layer": "Spare"},
    ])
}

#[test]
fn a_recipe_of_all_operations_is_undone_redone_and_replayed() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    let before = heights(&folder);
    let report = folder.apply("t.orogeny", "", &recipe());
    assert_eq!(report["operations"][4]["made_layer"], 5);
    assert_eq!(names(&folder), ["Base", "Mound", "Hills", "Second", "Slide", "Weather"]);
    assert_eq!(layer(&folder, "Slide")["is_stale"], false);
    let after = heights(&folder);
    assert_ne!(after, before);
    let stack = layers(&folder);
    folder.succeed("check t.orogeny");
    folder.succeed("undo t.orogeny -n 100");
    assert_eq!((heights(&folder), names(&folder)), (before, vec!["Base".to_owned()]));
    folder.succeed("redo t.orogeny -n 100");
    assert_eq!((heights(&folder), layers(&folder)), (after.clone(), stack));

    folder.succeed("replay t.orogeny again.orogeny");
    assert_eq!(folder.heights_of("again.orogeny"), after);
    // One by one it comes to the same.
    folder.succeed(&format!("new one.orogeny --size {SIDE}x{SIDE} --spacing 1 --height 100"));
    for operation in recipe().as_array().unwrap() {
        folder.apply("one.orogeny", "", &json!([operation]));
    }
    assert_eq!(folder.heights_of("one.orogeny"), after);
    // Tried out it changes nothing.
    folder.succeed("undo t.orogeny -n 100");
    let state = folder.succeed("info t.orogeny")["layers"].clone();
    folder.apply("t.orogeny", "--dry-run", &recipe());
    assert_eq!(folder.succeed("info t.orogeny")["layers"], state);
}

#[test]
fn a_stack_is_saved_with_all_that_it_is_made_of() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    folder.apply("t.orogeny", "", &recipe());
    // A picture, a mask that is younger than the layers above it, and ids that the copies do not get.
    folder.succeed("render t.orogeny shades.png --map --size 50x50");
    let gate = json!({"image": {"file": "shades.png", "region": [0, 0, 100, 100]}});
    folder.write("rough.json", json!({"type": "roughen", "strength": 2, "gate": gate}).to_string());
    folder.succeed("layer add t.orogeny Rough --procedural rough.json --above Base --in Weather");
    folder.succeed("layer mask t.orogeny Base --nothing --invert --scale 0.5");
    folder.succeed("layer remove t.orogeny Second");
    let (whole, names_before) = (heights(&folder), names(&folder));
    folder.succeed("salvage t.orogeny saved.orogeny");
    assert_eq!(folder.heights_of("saved.orogeny"), whole);
    std::fs::rename(folder.path("saved.orogeny"), folder.path("t.orogeny")).unwrap();
    assert_eq!(names(&folder), names_before);
    assert_eq!(layer(&folder, "Slide")["group"], layer(&folder, "Weather")["id"]);
    folder.succeed("layer refresh t.orogeny Slide");
    folder.succeed("check t.orogeny");
}

#[test]
fn the_log_tells_each_operation_in_a_line() {
    let folder = terrain();
    folder.succeed(r#"presets save Slide --brush {"type":"erode_thermal","talus_angle":15}"#);
    folder.apply("t.orogeny", "", &recipe());
    folder.succeed("layer collapse t.orogeny Hills --below");
    let text = folder.run("log t.orogeny").stdout;
    let lines = [
        "add_layer 2 `Hills`, procedural noise",
        "add_layer 3 `Mound`, above 1",
        "stroke raise, radius 10 m, strength 10, 1 point, layer 3",
        "add_layer 4 `Weather`, group",
        "add_layer 5 `Slide`, effect erode_thermal, in 4, 1 mask term",
        "set_layer 3, opacity 0.9, moved by 30,10 m, turned by 20 degrees",
        "fill paint_mask, strength 1, region [50.0,50.0,20.0,20.0], selection",
        "set_mask 2, from the selection, inverted, scale 0.5, 1 mask term",
        "duplicate_layer 3, as 6, named `Second`",
        "set_layer 6, moved by -10,-10 m, scale 2",
        "move_layer 6, above 2",
        "collapse_layer 6",
        "refresh_layer 5",
        "add_layer 7 `Spare`, height 90 m",
        "remove_layer 7",
        "collapse_layer 2, with all below",
    ];
    assert_eq!(text.lines().count(), lines.len(), "{text}");
    for (told, line) in text.lines().zip(lines) {
        assert!(told.ends_with(&format!("  {line}")), "{told}: {line}");
    }
}

#[test]
fn a_layer_a_mask_and_the_selection_are_exported_alone() {
    let folder = terrain();
    folder.succeed("layer add t.orogeny Hill --height 1 --hidden --opacity 0.5");
    folder.apply("t.orogeny", "", &json!([dab("Hill"), selecting()]));
    folder.succeed("layer mask t.orogeny Hill --selection --scale 0.5");
    let alone = exported(&folder, "--layer Hill");
    assert_eq!((at(&alone, 30, 40), at(&alone, 60, 60)), (11.0, 1.0));
    assert_eq!(exported(&folder, "--layer #2"), alone);
    assert_eq!(at(&exported(&folder, "--layer Base"), 30, 40), 100.0);
    let mask = exported(&folder, "--mask Hill");
    assert_eq!((at(&mask, 30, 40), at(&mask, 60, 60)), (0.0, 0.5));
    assert!(exported(&folder, "--mask #1").iter().all(|weight| *weight == 1.0));
    let selection = exported(&folder, "--selection");
    assert_eq!((at(&selection, 60, 60), at(&selection, 30, 40)), (1.0, 0.0));
    assert_eq!(selection.iter().sum::<f32>(), 400.0);

    // A group's mask counts for its layers, and a group has no heights.
    folder.succeed("layer add t.orogeny Group --group");
    folder.succeed("layer mask t.orogeny Group --nothing --invert --scale 0.5");
    folder.succeed("layer move t.orogeny Hill --above Base --in Group");
    assert_eq!(at(&exported(&folder, "--mask Hill"), 60, 60), 0.25);
    folder.fail("export t.orogeny part.r32 --layer Group", &["Group", "it is a group"]);
    folder.fail("export t.orogeny part.r32 --mask Lost", &["Lost"]);
}
