//! Layers made, listed, set, moved, copied and removed.

use serde_json::json;

use super::{at, dab, height, heights, layer, layers, names, terrain};

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
