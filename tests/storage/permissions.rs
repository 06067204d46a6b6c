//! Folders and files that may not be written.

use std::fs::{Permissions, set_permissions};
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::Command;

use orogeny_field::TerrainGrid;
use orogeny_store::{Error, NewTerrain, Store};

use crate::support::{acknowledge, acknowledged, as_child, child_arguments, child_path, create, layout};

/// Whom to be instead of root, to whom permissions do not apply.
const NOBODY: u32 = 65_534;

fn set_mode(path: &Path, mode: u32) {
    set_permissions(path, Permissions::from_mode(mode)).unwrap();
}

/// What must be refused, by a process to which permissions apply.
fn assert_refused(folder: &Path) {
    let refused = |name: &str| {
        let path = folder.join(name);
        let err = Store::open(&path).unwrap_err();
        assert!(matches!(err, Error::ReadOnly { .. }), "{name}: {err:?}");
        assert!(err.to_string().contains("cannot be written"), "{err}");
        acknowledge(name);
    };
    refused("closed/t.orogeny");
    refused("open/readonly.orogeny");
    refused("open/unreadable.orogeny");
    let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
    let new = NewTerrain { grid, layout: layout(), layers: Vec::new() };
    let err = Store::create(&folder.join("closed/new.orogeny"), &new).unwrap_err();
    assert!(matches!(err, Error::ReadOnly { .. }), "{err:?}");
    acknowledge("closed/new.orogeny");
    // The same process in the same place, where it may write: it is the permissions that were refused.
    Store::create(&folder.join("open/new.orogeny"), &new).unwrap().close().unwrap();
    Store::open(&folder.join("open/new.orogeny")).unwrap().begin().unwrap().commit("{}", "nobody").unwrap();
    acknowledge("open/new.orogeny");
}

#[test]
fn what_may_not_be_written_is_refused_and_as_it_was() {
    const TEST: &str = "permissions::what_may_not_be_written_is_refused_and_as_it_was";
    if let Some(folder) = child_path() {
        return assert_refused(&folder);
    }
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path();
    let terrains = ["closed/t.orogeny", "open/readonly.orogeny", "open/unreadable.orogeny"];
    for name in ["closed", "open"] {
        std::fs::create_dir(folder.join(name)).unwrap();
    }
    for name in terrains {
        create(&folder.join(name)).close().unwrap();
        set_mode(&folder.join(name), 0o666);
    }
    let bytes = || terrains.map(|name| std::fs::read(folder.join(name)).unwrap());
    let before = bytes();
    // The test binary may lie where another user cannot go.
    let program = folder.join("test");
    std::fs::copy(std::env::current_exe().unwrap(), &program).unwrap();
    for (name, mode) in [
        ("", 0o755),
        ("test", 0o755),
        ("closed", 0o555),
        ("open", 0o777),
        ("open/readonly.orogeny", 0o444),
        ("open/unreadable.orogeny", 0o000),
    ] {
        set_mode(&folder.join(name), mode);
    }
    let mut command = Command::new(&program);
    as_child(&mut command, folder).args(child_arguments(TEST)).current_dir(folder);
    if std::fs::metadata(folder).unwrap().uid() == 0 {
        command.uid(NOBODY).gid(NOBODY);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let expected = [terrains.as_slice(), ["closed/new.orogeny", "open/new.orogeny"].as_slice()].concat();
    assert_eq!(acknowledged(&output.stdout), expected);

    set_mode(&folder.join("open/unreadable.orogeny"), 0o600);
    assert_eq!(bytes(), before);
    let names = std::fs::read_dir(folder.join("closed")).unwrap();
    assert_eq!(names.map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>(), ["t.orogeny"]);
    set_mode(&folder.join("closed"), 0o755);
}
