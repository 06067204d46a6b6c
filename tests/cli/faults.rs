//! A folder that may not be written and a disk that is full. What a machine cannot set up is skipped, and counted.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use orogeny_tests::skip;

use crate::program::{Folder, Ran, binary};

const RECIPE: &str = r#"{"operations": [{"op": "fill", "brush": {"type": "roughen", "strength": 100}}]}"#;

fn set_mode(path: &Path, mode: u32) {
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
}

fn runs(program: &str, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

/// The program as someone who may not write where they are not allowed to: as it is, or, for root, who may write anywhere,
/// as nobody. `None`, with a skip, where root cannot become someone else.
fn restricted(folder: &Folder, test: &str) -> Option<impl Fn(&str) -> Command> {
    let is_root =
        std::fs::metadata("/proc/self").is_ok_and(|own| std::os::unix::fs::MetadataExt::uid(&own) == 0);
    let nobody = ["--reuid=65534", "--regid=65534", "--clear-groups"];
    if is_root && !runs("setpriv", &[&nobody[..], &["true"]].concat()) {
        skip(test, "root could not become someone else with setpriv");
        return None;
    }
    // Where everybody may run it.
    let program = folder.path("program");
    std::fs::copy(binary(), &program).unwrap();
    set_mode(&program, 0o755);
    let place = folder.path("");
    Some(move |line: &str| {
        let mut command = if is_root { Command::new("setpriv") } else { Command::new(&program) };
        if is_root {
            command.args(nobody).arg(&program);
        }
        command.args(line.split(' ')).args(["--adapter", "cpu"]).current_dir(&place);
        command
    })
}

#[test]
fn a_read_only_folder() {
    let folder = Folder::new();
    let Some(command) = restricted(&folder, "cli::faults::a_read_only_folder") else { return };
    folder.succeed("new t.orogeny --size 64x64 --spacing 1");
    folder.write("recipe.json", RECIPE);
    folder.write("a.r16", [0; 32]);
    set_mode(&folder.path("t.orogeny"), 0o444);
    set_mode(&folder.path(""), 0o555);

    let before = folder.state();
    for (line, word) in [
        ("new u.orogeny --size 5x5 --spacing 1", "u.orogeny"),
        ("import a.r16 u.orogeny", "u.orogeny"),
        ("import a.r16 t.orogeny", "t.orogeny"),
        ("apply t.orogeny recipe.json", "t.orogeny"),
        ("undo t.orogeny", "t.orogeny"),
        ("jump t.orogeny 0", "t.orogeny"),
        ("compact t.orogeny", "t.orogeny"),
        ("check t.orogeny --repair", "t.orogeny"),
        ("replay t.orogeny u.orogeny", "u.orogeny"),
        ("salvage t.orogeny u.orogeny", "u.orogeny"),
        ("demo made", "made"),
    ] {
        let output = command(line).output().unwrap();
        Ran::from(output).assert_failed(line, &[word]);
        folder.assert_state(&before, line);
    }
    set_mode(&folder.path(""), 0o755);
}

#[test]
fn what_only_reads_works_on_a_read_only_file_in_a_read_only_folder() {
    const TEST: &str = "cli::faults::what_only_reads_works_on_a_read_only_file_in_a_read_only_folder";
    let folder = Folder::new();
    let Some(command) = restricted(&folder, TEST) else { return };
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    folder.write("recipe.json", RECIPE);
    folder.succeed("apply t.orogeny recipe.json");
    folder.succeed("export t.orogeny here.r32");
    std::fs::create_dir(folder.path("out")).unwrap();
    set_mode(&folder.path("out"), 0o777);
    set_mode(&folder.path("t.orogeny"), 0o444);
    set_mode(&folder.path(""), 0o555);

    let before = folder.state();
    for (line, word) in [
        ("info t.orogeny --heights", "1 applied"),
        ("log t.orogeny", "fill roughen"),
        ("check t.orogeny", "whole"),
        ("export t.orogeny out/there.r32", "wrote"),
        ("export t.orogeny out/coarse.r32 --level 1", "150 x 150"),
        ("render t.orogeny out/map.png --map", "drew"),
        ("replay t.orogeny out/replayed.orogeny", "replayed 1 operation"),
        ("salvage t.orogeny out/saved.orogeny", "saved"),
    ] {
        let ran = Ran::from(command(line).output().unwrap());
        assert_eq!(ran.code, Some(0), "{line}: {ran:?}");
        assert!(ran.stdout.contains(word), "{line}: `{word}` is not in {}", ran.stdout);
        folder.assert_state(&before, line);
    }
    set_mode(&folder.path(""), 0o755);
    assert_eq!(folder.read("out/there.r32"), folder.read("here.r32"));
    for copy in ["replayed", "saved"] {
        folder.succeed(&format!("export out/{copy}.orogeny copy.r32"));
        assert_eq!(folder.read("copy.r32"), folder.read("here.r32"), "{copy}");
    }
}

/// A small disk, mounted on a folder.
struct SmallDisk<'a>(&'a Path);

impl<'a> SmallDisk<'a> {
    fn mount(at: &'a Path) -> Option<Self> {
        let at_text = at.to_str()?;
        runs("mount", &["-t", "tmpfs", "-o", "size=2m", "tmpfs", at_text]).then_some(Self(at))
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        assert!(Command::new("umount").arg(self.0).status().is_ok_and(|status| status.success()));
    }
}

#[test]
fn a_full_disk() {
    let outside = Folder::new();
    let place = outside.path("disk");
    std::fs::create_dir(&place).unwrap();
    let Some(_disk) = SmallDisk::mount(&place) else {
        return skip("cli::faults::a_full_disk", "a small disk could not be mounted, which takes root");
    };
    outside.write("recipe.json", RECIPE);
    // Noise, which does not compress.
    let noise = (0..1 << 20).map(|k: u32| (k.wrapping_mul(2_654_435_761) >> 8) as f32 / 4096.0);
    outside.write("heights.r32", noise.flat_map(f32::to_le_bytes).collect::<Vec<_>>());
    outside.succeed("new disk/t.orogeny --size 1024x1024 --spacing 1");
    let read = || std::fs::read(place.join("t.orogeny")).unwrap();
    let names = || {
        let entries = std::fs::read_dir(&place).unwrap();
        entries.map(|entry| entry.unwrap().file_name()).collect::<std::collections::BTreeSet<_>>()
    };
    let before = (read(), names());
    for (line, words) in [
        ("apply disk/t.orogeny recipe.json", &["t.orogeny", "space"][..]),
        ("import heights.r32 disk/t.orogeny", &["t.orogeny", "space"]),
        ("import heights.r32 disk/u.orogeny", &["u.orogeny", "space"]),
        ("export disk/t.orogeny disk/out.r32", &["out.r32", "space"]),
        ("demo disk/made", &["made"]),
    ] {
        outside.run(line).assert_failed(line, words);
        std::fs::remove_dir_all(place.join("made")).ok(); // the demo leaves what it could make
        assert_eq!(names(), before.1, "{line}");
        assert!(read() == before.0, "{line} changed the terrain");
    }
    // It still works, for what fits.
    outside.write(
        "small.json",
        r#"{"operations": [{"op": "stroke", "brush": {"type": "raise"}, "points": [[9, 9]]}]}"#,
    );
    outside.succeed("apply disk/t.orogeny small.json");
}
