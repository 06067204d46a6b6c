//! `render` from somewhere: what it writes and says, and what it refuses.

use serde_json::json;

use crate::program::Folder;

fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 700x500 --spacing 2 --height 100");
    let brush = json!({"type": "raise", "radius": 300, "strength": 150});
    let recipe =
        json!({"operations": [{"op": "stroke", "brush": brush, "points": [[600, 500], [800, 450]]}]});
    folder.write("recipe.json", recipe.to_string());
    folder.succeed("apply t.orogeny recipe.json");
    folder
}

/// Width and height of a PNG, from its header.
fn size_of(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[1..4], b"PNG");
    let number = |start: usize| u32::from_be_bytes(png[start..start + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn a_picture_is_of_the_size_and_from_the_place_that_was_asked_for() {
    let folder = terrain();
    let all = folder.succeed("render t.orogeny all.png --size 64x48 --adapter software");
    assert_eq!(size_of(&folder.read("all.png")), (64, 48));
    assert_eq!((&all["width_px"], &all["missing_pages"]), (&json!(64), &json!(0)));
    // Far enough off for all of it.
    assert!(all["eye_m"][1].as_f64().unwrap() > 500.0, "{all}");

    let line =
        "render t.orogeny near.png --size 64x48 --eye 600,+50,900 --target 600,+0,500 --adapter software";
    let near = folder.succeed(line);
    // Beyond the stroke the ground is as it was made.
    let eye: Vec<f64> =
        near["eye_m"].as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect();
    assert_eq!(eye, [600.0, 150.0, 900.0]);
    assert!(near["target_m"][1].as_f64().unwrap() > 150.0, "{near}");
    assert!(near["triangles"].as_u64() > all["triangles"].as_u64(), "{near} {all}");
    assert_ne!(folder.read("near.png"), folder.read("all.png"));

    let told = folder.run("render t.orogeny again.png --size 64x48 --mode slope --adapter software");
    assert_eq!(told.code, Some(0));
    for word in ["drew again.png", "64 x 48", "triangles"] {
        assert!(told.stdout.contains(word), "{word}: {}", told.stdout);
    }
}

#[test]
fn the_cpu_back_end_draws_by_whatever_can() {
    let folder = terrain();
    let drawn = folder.succeed("render t.orogeny t.png --size 32x32 --mode shaded --adapter cpu");
    assert!(!drawn["adapter"].as_str().unwrap().is_empty());
}

#[test]
fn a_flight_writes_numbered_pictures() {
    let folder = terrain();
    let key = |x: u32| json!({"eye": [x, 60, 950], "target": [600, 20, 500]});
    let flight = json!({"frames": 3, "above_ground": true, "keys": [key(200), key(900)]});
    folder.write("way.json", flight.to_string());
    let report = folder
        .succeed("render t.orogeny out.png --size 48x32 --mode shaded --fly way.json --adapter software");
    assert_eq!(report["files"], json!(["out-0001.png", "out-0002.png", "out-0003.png"]));
    let pictures = ["out-0001.png", "out-0002.png", "out-0003.png"].map(|file| folder.read(file));
    assert!(pictures.iter().all(|png| size_of(png) == (48, 32)));
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    assert_eq!(report["frames"][2]["eye_m"][0], json!(900.0));
}

#[test]
fn a_material_set_of_a_user_s_own_shows_and_a_broken_one_is_named() {
    let folder = terrain();
    let set = |surface: &str| json!({"name": "mine", "layers": [{"name": "all", "surface": surface}, {"name": "steep", "surface": "rock", "slope_degrees": [20, 90]}]});
    folder.write("sand.json", set("sand").to_string());
    folder.write("snow.json", set("snow").to_string());
    for name in ["sand", "snow"] {
        folder.succeed(&format!(
            "render t.orogeny {name}.png --size 48x32 --materials {name}.json --adapter software"
        ));
    }
    assert_ne!(folder.read("sand.png"), folder.read("snow.png"));
    folder.write("broken.json", set("cheese").to_string());
    let ran = folder.run("render t.orogeny out.png --size 48x32 --materials broken.json --adapter software");
    ran.assert_failed("broken set", &["broken.json", "cheese"]);
    let ran = folder.run("render t.orogeny out.png --size 48x32 --materials lost.json --adapter software");
    ran.assert_failed("lost set", &["lost.json"]);
    let files = json!({"name": "mine", "layers": [{"name": "all", "surface": {"albedo": "lost.png"}}]});
    folder.write("files.json", files.to_string());
    let ran = folder.run("render t.orogeny out.png --size 48x32 --materials files.json --adapter software");
    ran.assert_failed("lost texture", &["lost.png"]);
    // A picture of the program's own is a texture as good as any.
    let files = json!({"name": "mine", "layers": [{"name": "all", "surface": {"albedo": "sand.png"}}]});
    folder.write("files.json", files.to_string());
    folder.succeed("render t.orogeny out.png --size 48x32 --materials files.json --adapter software");
}

#[test]
fn masks_show_over_the_ground_and_hold_materials_back() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 500x500 --spacing 2 --height 100");
    let set = json!({"name": "mine", "layers": [{"name": "all", "surface": "grass"}, {"name": "snow", "surface": "snow", "mask": "Base"}]});
    folder.write("set.json", set.to_string());
    let draw = |name: &str, more: &str| {
        folder.succeed(&format!("render t.orogeny {name}.png --size 64x48 --adapter software {more}"));
        folder.read(&format!("{name}.png"))
    };
    let (nothing, snow) = (draw("a", "--mode mask"), draw("b", "--materials set.json"));
    let stroke = |target: &str, brush: &str| json!({"op": "stroke", "target": target, "brush": {"type": brush, "radius": 250}, "points": [[500, 500]]});
    let recipe = json!({"operations": [stroke("selection", "paint_mask"), stroke("mask", "erase_mask")]});
    folder.write("recipe.json", recipe.to_string());
    folder.succeed("apply t.orogeny recipe.json");
    // The ground is as flat as before; what lies over it shows all the same.
    let (selection, mask) = (draw("c", "--mode mask"), draw("d", "--mode mask --mask Base"));
    assert!(selection != nothing && mask != nothing && mask != selection);
    assert_ne!(draw("e", "--materials set.json"), snow);
    let ran = folder.run("render t.orogeny out.png --size 48x32 --mode mask --mask Lost --adapter software");
    ran.assert_failed("lost mask", &["Lost", "Base", "selection"]);
    let ran = folder.run("render t.orogeny out.png --size 48x32 --materials lunar --adapter software");
    ran.assert_failed("lost set", &["lunar", "alpine"]);
}

#[test]
fn the_difference_to_an_earlier_entry_is_shown() {
    let folder = terrain();
    let before = folder.state();
    let draw = |name: &str, more: &str| {
        let line =
            format!("render t.orogeny {name}.png --size 64x48 --mode difference --adapter software {more}");
        (folder.succeed(&line)["difference_m"].as_f64().unwrap(), folder.read(&format!("{name}.png")))
    };
    let ((most_m, since_made), (none_m, since_now)) = (draw("a", "--since 0"), draw("b", "--since 1"));
    assert!(most_m > 100.0 && none_m < 0.01, "{most_m} {none_m}");
    assert_ne!(since_made, since_now);
    let (given_m, given) = draw("c", "--since 0 --range -900,300");
    assert!(given_m == 900.0 && given != since_made, "{given_m}");
    let told =
        folder.run("render t.orogeny d.png --size 64x48 --mode difference --since 0 --adapter software");
    assert!(told.stdout.contains("m higher than it was"), "{}", told.stdout);
    let line = "render t.orogeny e.png --size 48x32 --mode difference --adapter software";
    folder.run(line).assert_failed("since when", &["--since"]);
    folder.run(&format!("{line} --since 7")).assert_failed("since when", &["no entry 7", "log"]);
    for name in ["a", "b", "c", "d"] {
        std::fs::remove_file(folder.path(&format!("{name}.png"))).unwrap();
    }
    folder.assert_state(&before, "looking back");
}

#[test]
fn the_sets_that_come_along_are_listed_and_can_be_started_from() {
    let folder = terrain();
    let sets = folder.succeed("materials")["sets"].clone();
    let names: Vec<_> =
        sets.as_array().unwrap().iter().map(|set| set["name"].as_str().unwrap().to_owned()).collect();
    assert_eq!(names, ["alpine", "arctic", "desert", "volcanic"]);
    let told = folder.run("materials");
    assert!(told.stdout.contains("desert") && told.stdout.contains("cracked_earth"), "{}", told.stdout);
    let desert = folder.run("materials desert");
    folder.write("mine.json", &desert.stdout);
    folder.succeed("render t.orogeny mine.png --size 48x32 --materials mine.json --adapter software");
    folder.succeed("render t.orogeny theirs.png --size 48x32 --materials desert --adapter software");
    assert_eq!(folder.read("mine.png"), folder.read("theirs.png"));
    folder.run("materials lunar").assert_failed("no such set", &["lunar", "alpine"]);
}

#[test]
fn a_brush_s_ring_shows_where_it_is() {
    let folder = terrain();
    let draw = |name: &str, more: &str| {
        folder.succeed(&format!(
            "render t.orogeny {name}.png --size 64x48 --mode shaded --adapter software {more}"
        ));
        folder.read(&format!("{name}.png"))
    };
    let plain = draw("a", "");
    assert_ne!(draw("b", "--cursor 700,500,200,0.5"), plain);
    assert_eq!(draw("c", "--cursor 90000,500,200,0.5"), plain);
    folder.run("render t.orogeny d.png --cursor 1,2,0,0").assert_failed("no radius", &["radius"]);
}
