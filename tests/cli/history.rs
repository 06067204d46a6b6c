//! Undo, redo, dry runs and recipes that fail half way, each command a process of its own.

use crate::program::Folder;

const OPERATIONS: [&str; 3] = [
    r#"{"op": "stroke", "brush": {"type": "raise", "radius": 60, "strength": 20}, "points": [[100, 100], [400, 380, 0.5]]}"#,
    r#"{"op": "stroke", "brush": {"type": "ledge", "radius": 50, "strength": 9}, "points": [[80, 300], [420, 200]]}"#,
    r#"{"op": "fill", "brush": {"type": "roughen", "strength": 2}, "seed": 9, "region": [200, 200, 200, 100]}"#,
];

fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 500x500 --spacing 1 --height 100");
    folder
}

fn recipe(operations: &[&str]) -> String {
    format!(r#"{{"operations": [{}]}}"#, operations.join(", "))
}

fn heights(folder: &Folder) -> Vec<u8> {
    folder.succeed("export t.orogeny now.r32");
    folder.read("now.r32")
}

#[test]
fn undo_and_redo_are_exact_across_processes() {
    let folder = terrain();
    let mut states = vec![heights(&folder)];
    for operation in OPERATIONS {
        folder.write("recipe.json", recipe(&[operation]));
        folder.succeed("apply t.orogeny recipe.json");
        states.push(heights(&folder));
    }
    assert!(states.windows(2).all(|pair| pair[0] != pair[1]));
    for (line, state) in [
        ("undo t.orogeny", 2),
        ("undo t.orogeny --number 2", 0),
        ("undo t.orogeny", 0),
        ("redo t.orogeny -n 1", 1),
        ("redo t.orogeny -n 100", 3),
        ("redo t.orogeny", 3),
        ("undo t.orogeny -n 100", 0),
    ] {
        folder.succeed(line);
        assert_eq!(heights(&folder), states[state], "{line}");
    }
}

#[test]
fn a_recipe_at_once_is_the_same_as_one_by_one() {
    let (at_once, one_by_one) = (terrain(), terrain());
    at_once.write("recipe.json", recipe(&OPERATIONS));
    at_once.succeed("apply t.orogeny recipe.json");
    for operation in OPERATIONS {
        one_by_one.write("recipe.json", recipe(&[operation]));
        one_by_one.succeed("apply t.orogeny recipe.json");
    }
    assert_eq!(heights(&at_once), heights(&one_by_one));
}

#[test]
fn what_was_undone_before_a_new_operation_is_left_behind_and_still_told() {
    let folder = terrain();
    folder.write("recipe.json", recipe(&OPERATIONS));
    folder.succeed("apply t.orogeny recipe.json");
    folder.succeed("undo t.orogeny -n 2");
    folder.write("recipe.json", recipe(&OPERATIONS[2..]));
    folder.succeed("apply t.orogeny recipe.json");
    let log = folder.succeed("log t.orogeny");
    let states: Vec<_> =
        log["entries"].as_array().unwrap().iter().map(|entry| entry["state"].clone()).collect();
    assert_eq!(states, ["applied", "branch", "branch", "applied"]);
    assert_eq!(folder.succeed("redo t.orogeny")["entries"], serde_json::json!([]));
    let history = folder.succeed("info t.orogeny")["history"].clone();
    assert_eq!((&history["num_applied"], &history["num_branch"]), (&2.into(), &2.into()));
}

#[test]
fn a_dry_run_tells_what_would_be_and_changes_nothing() {
    let folder = terrain();
    folder.write("recipe.json", recipe(&OPERATIONS));
    let before = folder.state();
    let tried = folder.succeed("apply t.orogeny recipe.json --dry-run");
    folder.assert_state(&before, "a dry run");
    let applied = folder.succeed("apply t.orogeny recipe.json");
    for (tried, applied) in
        tried["operations"].as_array().unwrap().iter().zip(applied["operations"].as_array().unwrap())
    {
        assert_eq!(tried["num_pages"], applied["num_pages"]);
    }
    assert_eq!((&tried["dry_run"], &applied["dry_run"]), (&true.into(), &false.into()));
}

#[test]
fn a_recipe_that_fails_at_its_third_operation_does_nothing() {
    let folder = terrain();
    let lost = r#"{"op": "stroke", "layer": "Lost", "brush": {"type": "raise"}, "points": [[1, 1]]}"#;
    folder.write("recipe.json", recipe(&[OPERATIONS[0], OPERATIONS[1], lost]));
    folder.fail("apply t.orogeny recipe.json", &["operation 3 of 3", "Lost", "`Base`"]);
    folder.fail("apply t.orogeny recipe.json --dry-run", &["operation 3 of 3", "Lost"]);
    assert_eq!(folder.succeed("log t.orogeny")["entries"], serde_json::json!([]));
}

#[test]
fn a_recipe_may_come_through_a_pipe() {
    use std::io::Write as _;
    let folder = terrain();
    let mut command = folder.command("apply t.orogeny - --json");
    command.stdin(std::process::Stdio::piped()).stdout(std::process::Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(recipe(&OPERATIONS).as_bytes()).unwrap();
    assert!(child.wait_with_output().unwrap().status.success());
    assert_eq!(folder.succeed("info t.orogeny")["history"]["num_applied"], 3);
}
