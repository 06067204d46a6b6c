//! A disk that is full while a stroke is on its way: that stroke and the one on top of it are not done, and nothing else is
//! lost.

use std::path::Path;
use std::process::Command;

use orogeny_engine::{Error, ExportRequest, ImportRequest, Quiet, Terrain};
use orogeny_store::Error as StoreError;
use orogeny_tests::child::{acknowledge, acknowledged, as_child, child_arguments, child_path};
use orogeny_tests::skip;
use serde_json::json;

use crate::support::{
    apply, assert_is_replay, assert_same_heights, assert_whole, create, heights, operation, stroke,
};

const TEST: &str = "small_disk::a_stroke_that_finds_no_space_fails_the_one_on_top_of_it_too";

/// Mounts a small disk that is gone with the process and its children, and becomes the test in it.
const IN_A_SMALL_DISK: &str = r#"mount -t tmpfs -o size=24m none "$0" && exec "$@""#;

/// Takes all space that is left on the disk.
fn fill_up(folder: &Path) {
    let mut filler = std::fs::File::create(folder.join("filler")).unwrap();
    while std::io::Write::write_all(&mut filler, &[1; 4096]).is_ok() {}
}

fn free(folder: &Path) {
    std::fs::remove_file(folder.join("filler")).unwrap();
}

fn is_disk_full(err: &Error) -> bool {
    match err {
        Error::Store(err) => matches!(err, StoreError::DiskFull { .. }),
        Error::InRecipe { source, .. } => is_disk_full(source),
        Error::Brush(_) => err.to_string().contains("no space is left"),
        _ => false,
    }
}

/// Rough strokes on top of each other: of pages that take space.
fn rough(number: u32) -> orogeny_engine::Operation {
    let brush = json!({"type": "roughen", "radius": 120, "strength": 30});
    operation(json!({"op": "stroke", "seed": number, "brush": brush, "points": [[250, 250], [330, 260]]}))
}

/// What a failed stroke may leave: nothing.
fn assert_unchanged(terrain: &Terrain, path: &Path, num_entries: usize) {
    assert_eq!(terrain.log().unwrap().len(), num_entries);
    assert_eq!(assert_is_replay(terrain, path), num_entries as u64);
}

fn paint_on_a_full_disk(folder: &Path) {
    let path = folder.join("t.orogeny");
    let mut terrain = create(&path);
    apply(&mut terrain, &(1..=3).map(stroke).collect::<Vec<_>>());
    let before = heights(&path);
    acknowledge("mounted");

    for round in 0..3 {
        fill_up(folder);
        // Accepted, as nothing is known of the disk yet; what is painted on it is not.
        terrain.submit(&[rough(1)], &mut Quiet).unwrap();
        let err = terrain.submit(&[rough(2)], &mut Quiet).unwrap_err();
        assert!(is_disk_full(&err), "{err:?}");
        // Everyone was told.
        terrain.flush().unwrap();
        assert_unchanged(&terrain, &path, 3);
        assert_same_heights(&heights(&path), &before);
        // One alone is told of by the flush.
        terrain.submit(&[rough(3)], &mut Quiet).unwrap();
        let err = terrain.flush().unwrap_err();
        assert!(is_disk_full(&err), "{err:?}");
        assert_unchanged(&terrain, &path, 3);
        acknowledge(&format!("full {round}"));
        free(folder);
    }

    // The same strokes as on a terrain on which the failed ones never were.
    apply(&mut terrain, &[rough(2), stroke(4)]);
    assert_unchanged(&terrain, &path, 5);
    acknowledge("freed");

    // An import that is told of a failed stroke leaves nothing of it in memory either.
    let elsewhere = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
    let raster = elsewhere.path().join("raster.tif");
    let region_m = Some([300.0, 200.0, 64.0, 64.0]);
    terrain.export(&ExportRequest { region_m, ..ExportRequest::new(&raster) }, &mut Quiet).unwrap();
    fill_up(folder);
    terrain.submit(&[rough(5)], &mut Quiet).unwrap();
    let err = terrain.import(&ImportRequest::new(&raster), &mut Quiet).unwrap_err();
    assert!(is_disk_full(&err), "{err:?}");
    free(folder);
    apply(&mut terrain, &[rough(6)]);
    assert_unchanged(&terrain, &path, 6);
    acknowledge("import");

    assert_eq!(terrain.undo(u32::MAX).unwrap().len(), 6);
    assert!(heights(&path).is_empty());
    assert_eq!(terrain.redo(3).unwrap().len(), 3);
    assert_same_heights(&heights(&path), &before);
    terrain.close().unwrap();
    assert_whole(&path);
    acknowledge("closed");
}

#[test]
fn a_stroke_that_finds_no_space_fails_the_one_on_top_of_it_too() {
    if let Some(folder) = child_path() {
        return paint_on_a_full_disk(&folder);
    }
    let scratch = tempfile::tempdir().unwrap();
    let mut command = Command::new("unshare");
    as_child(&mut command, scratch.path())
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", IN_A_SMALL_DISK])
        .args([scratch.path(), &std::env::current_exe().unwrap()])
        .args(child_arguments(TEST));
    let output = match command.output() {
        Ok(output) => output,
        Err(err) => return skip(TEST, &format!("no small disk can be mounted (unshare: {err})")),
    };
    let lines = acknowledged(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    if lines.is_empty() && !output.status.success() && !errors.contains("panicked") {
        return skip(TEST, &format!("no small disk can be mounted ({})", errors.trim()));
    }
    assert!(output.status.success(), "{errors}");
    assert_eq!(lines, ["mounted", "full 0", "full 1", "full 2", "freed", "import", "closed"]);
    println!("10 strokes and an import on a full disk, none of them done, and 8 operations kept");
}
