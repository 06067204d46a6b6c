//! What is worked out of layers: baked, painted on what is seen, masks, effects that are kept.

use serde_json::json;

use super::{at, dab, exported, height, heights, layer, names, selecting, terrain};

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
