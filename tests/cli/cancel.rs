//! Ctrl-C in the middle of an operation: the terrain is as it was before.
#![cfg(unix)]

use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Command, Stdio};

use crate::program::Folder;

const APPLY: &str = "apply t.orogeny endless.json";

/// One fill that goes on for minutes unless it is stopped within.
const EROSION: &str =
    r#"{"operations": [{"op": "fill", "brush": {"type": "erode_fluvial", "iterations": 600}}]}"#;

/// Fills that go on for minutes unless they are stopped.
fn endless_recipe() -> String {
    let fill = r#"{"op": "fill", "brush": {"type": "raise", "strength": 1}}"#;
    format!(r#"{{"operations": [{}]}}"#, vec![fill; 2000].join(","))
}

/// Stops a command that reads a file `endless.json` of this content.
fn interrupt(line: &str, endless: &str, marker: &str, signal: &str) {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 4096x4096 --spacing 1");
    folder.write(
        "one.json",
        r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}, "region": [9, 9, 999, 999]}]}"#,
    );
    folder.succeed("apply t.orogeny one.json");
    folder.write("endless.json", endless);
    let before = folder.state();

    let mut command = folder.command(&format!("{line} -v --page-budget 8"));
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains(marker) {
        line.clear();
        assert_ne!(stderr.read_line(&mut line).unwrap(), 0, "it ended before it could be stopped");
    }
    // Into the middle of it.
    std::thread::sleep(std::time::Duration::from_millis(200));
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-s", signal, &pid]).status().unwrap().success());
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(rest.contains("error: cancelled; nothing was changed"), "{rest}");
    folder.assert_state(&before, "cancelling");
    assert_eq!(folder.succeed("info t.orogeny")["history"]["num_applied"], 1);
}

#[test]
fn ctrl_c_leaves_the_terrain_as_before() {
    interrupt(APPLY, &endless_recipe(), "operation 3 of 2000", "INT");
}

#[test]
fn a_request_to_terminate_does_too() {
    interrupt(APPLY, &endless_recipe(), "operation 3 of 2000", "TERM");
}

/// Were it heard only once the simulation is over, this test would take many minutes.
#[test]
fn ctrl_c_is_heard_within_a_simulation() {
    interrupt(APPLY, EROSION, "operation 1 of 1", "INT");
}

#[test]
fn ctrl_c_is_heard_while_an_effect_is_worked_out() {
    let brush = r#"{"type": "erode_fluvial", "iterations": 600}"#;
    interrupt("layer add t.orogeny Rain --effect endless.json", brush, "operation 1 of 1", "INT");
}
