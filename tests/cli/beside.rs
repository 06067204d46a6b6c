//! Several programs on one terrain: one writes, the others are told who it is, or read what it committed; and one that was
//! killed.
#![cfg(unix)]

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Stdio};

use orogeny_engine::{Adapter, Operation, Quiet, Settings, Terrain};

use crate::program::Folder;

const DAB: &str =
    r#"{"op": "stroke", "brush": {"type": "raise", "radius": 200, "strength": 20}, "points": [[900, 900]]}"#;

/// A terrain with one operation, and its heights in `before.r32`.
fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 4096x4096 --spacing 1");
    folder.write("dab.json", format!(r#"{{"operations": [{DAB}]}}"#));
    folder.succeed("apply t.orogeny dab.json");
    folder.succeed("export t.orogeny before.r32 --region 700,700,400,400");
    folder
}

fn files(folder: &Folder) -> Vec<String> {
    folder.state().into_keys().filter(|name| name.starts_with("t.orogeny")).collect()
}

/// What writes is told who writes already.
fn assert_others_do_not_write(folder: &Folder, process: u32) {
    let holder = format!("process {process}");
    for line in [
        "apply t.orogeny dab.json",
        "import before.r32 t.orogeny --size 400x400",
        "undo t.orogeny",
        "redo t.orogeny",
        "jump t.orogeny 0",
        "compact t.orogeny",
        "check t.orogeny --repair",
    ] {
        folder.run(line).assert_failed(line, &["t.orogeny", "open for writing", &holder]);
    }
}

/// What reads shows what was committed.
fn assert_others_read(folder: &Folder, num_applied: u64) {
    assert_eq!(folder.succeed("info t.orogeny")["history"]["num_applied"], num_applied);
    let log = folder.succeed("log t.orogeny");
    assert_eq!(log["entries"].as_array().unwrap().len() as u64, num_applied);
    folder.succeed("export t.orogeny now.r32 --region 700,700,400,400");
    folder.succeed("render t.orogeny map.png --map --size 100x100");
    assert_eq!(folder.succeed("check t.orogeny")["is_whole"], true);
}

#[test]
fn beside_a_writer_others_read_and_are_told_who_it_is() {
    let folder = terrain();
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let mut writer = Terrain::open(&folder.path("t.orogeny"), settings).unwrap();
    assert_others_do_not_write(&folder, std::process::id());
    assert_others_read(&folder, 1);
    assert_eq!(folder.read("now.r32"), folder.read("before.r32"));
    // What it commits meanwhile shows to those who look then.
    writer.apply(&[Operation::from_json_text(DAB).unwrap()], &mut Quiet).unwrap();
    assert_others_read(&folder, 2);
    assert_ne!(folder.read("now.r32"), folder.read("before.r32"));
    writer.close().unwrap();
    assert_eq!(files(&folder), ["t.orogeny"]);
    folder.succeed("undo t.orogeny");
    folder.succeed("export t.orogeny now.r32 --region 700,700,400,400");
    assert_eq!(folder.read("now.r32"), folder.read("before.r32"));
}

/// The program in the middle of a recipe that goes on for minutes, its third operation begun.
fn in_mid_apply(folder: &Folder) -> Child {
    let fill = r#"{"op": "fill", "brush": {"type": "raise", "strength": 1}}"#;
    folder.write("endless.json", format!(r#"{{"operations": [{}]}}"#, vec![fill; 2000].join(",")));
    let mut command = folder.command("apply t.orogeny endless.json -v --page-budget 8");
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("operation 3 of 2000") {
        line.clear();
        assert_ne!(stderr.read_line(&mut line).unwrap(), 0, "it ended before its third operation");
    }
    // Its notes go nowhere from here on, but must not fail.
    std::thread::spawn(move || std::io::copy(&mut stderr, &mut std::io::sink()));
    child
}

#[test]
fn a_program_killed_in_mid_apply_leaves_the_terrain_as_before_for_the_next_one() {
    let folder = terrain();
    let mut child = in_mid_apply(&folder);
    assert_others_do_not_write(&folder, child.id());
    assert_others_read(&folder, 1);
    assert_eq!(folder.read("now.r32"), folder.read("before.r32"));
    assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
    child.kill().unwrap(); // SIGKILL
    child.wait().unwrap();

    // Reading takes it up, and so does writing, which leaves nothing of the other one behind.
    assert_others_read(&folder, 1);
    assert_eq!(folder.read("now.r32"), folder.read("before.r32"));
    folder.succeed("apply t.orogeny dab.json");
    assert_eq!(files(&folder), ["t.orogeny"]);
    assert_others_read(&folder, 2);
    folder.succeed("undo t.orogeny");
    folder.succeed("export t.orogeny now.r32 --region 700,700,400,400");
    assert_eq!(folder.read("now.r32"), folder.read("before.r32"));
}
