//! Recipes that cannot be run: a message that names the field, and an untouched terrain.

use crate::program::Folder;

fn stroke(brush: &str, points: &str) -> String {
    format!(r#"{{"operations": [{{"op": "stroke", "brush": {brush}, "points": {points}}}]}}"#)
}

#[test]
fn every_bad_recipe_is_refused_with_the_field_named() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    let raise = r#"{"type": "raise"}"#;
    for (recipe, words) in [
        (String::new(), &["recipe"][..]),
        ("[]".to_owned(), &["recipe"]),
        (r#"{"operations": [{"op": "stroke""#.to_owned(), &["recipe"]),
        (r#"{"operations": [], "comment": 1}"#.to_owned(), &["comment"]),
        (r#"{"operations": [{"op": "melt"}]}"#.to_owned(), &["operation 1 of 1", "melt"]),
        (
            r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}, "regoin": [0, 0, 1, 1]}]}"#
                .to_owned(),
            &["regoin"],
        ),
        (
            r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}, "region": [0, 0, 0, 1]}]}"#
                .to_owned(),
            &["region"],
        ),
        (r#"{"operations": [{"op": "fill", "layer": 77, "brush": {"type": "raise"}}]}"#.to_owned(), &["77"]),
        (stroke(r#"{"type": "raise", "radios": 5}"#, "[[1, 1]]"), &["radios"]),
        (stroke(r#"{"type": "raze"}"#, "[[1, 1]]"), &["raze"]),
        (stroke(r#"{"type": "raise", "radius": 0}"#, "[[1, 1]]"), &["radius", "0"]),
        (stroke(r#"{"type": "raise", "strength": -5}"#, "[[1, 1]]"), &["strength", "-5"]),
        (stroke(r#"{"type": "raise", "strength": NaN}"#, "[[1, 1]]"), &["recipe"]),
        (stroke(r#"{"type": "raise", "strength": "NaN"}"#, "[[1, 1]]"), &["strength", "NaN"]),
        (stroke(r#"{"type": "raise", "strength": null}"#, "[[1, 1]]"), &["strength", "null"]),
        (stroke(r#"{"type": "raise", "strength": 1e999}"#, "[[1, 1]]"), &["recipe"]),
        (stroke(r#"{"type": "set_height"}"#, "[[1, 1]]"), &["height"]),
        (stroke(raise, "[]"), &["no points"]),
        (stroke(raise, "[[1]]"), &["point"]),
        (stroke(raise, "[[1, 1, 2]]"), &["pressure", "2"]),
        (stroke(raise, "[[1e300, 1]]"), &["x = "]),
    ] {
        folder.write("recipe.json", &recipe);
        folder.fail("apply t.orogeny recipe.json", words);
    }
    folder.write("recipe.json", b"\xff\xfe\x00");
    folder.fail("apply t.orogeny recipe.json", &["recipe.json", "UTF-8"]);
    folder.fail("apply t.orogeny missing.json", &["missing.json"]);
    folder.fail("apply t.orogeny .", &["`.`"]);
}

#[test]
fn errors_are_json_where_json_is_asked_for() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    for (line, word) in [
        ("apply t.orogeny missing.json --json", "missing.json"),
        ("log missing.orogeny --json", "missing.orogeny"),
        ("lag t.orogeny --json", "lag"),
    ] {
        let ran = folder.run(line);
        assert!(matches!(ran.code, Some(1 | 2)), "{line}: {ran:?}");
        assert_eq!(ran.stdout, "");
        let error: serde_json::Value = serde_json::from_str(ran.stderr.lines().last().unwrap()).unwrap();
        assert!(error["error"].as_str().unwrap().contains(word), "{line}: {error}");
    }
}
