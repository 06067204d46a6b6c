//! Uses of `layer` that are refused: what is named, the exit code, nothing changed.

use serde_json::json;

use super::{dab, terrain};

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
