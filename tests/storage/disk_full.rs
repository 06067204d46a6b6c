//! A disk that fills up in mid-save.

use std::path::Path;
use std::process::Command;

use orogeny_field::{PageKey, TerrainGrid};
use orogeny_store::{Error, NewTerrain, Store};

use crate::support::{
    PAGES, acknowledge, acknowledged, as_child, assert_whole, child_arguments, child_path, contents, create,
    layout, page, skip,
};

/// Bytes kept aside, to be freed when the disk is full.
const BALLAST_BYTES: usize = 3 << 20;

/// Mounts a small disk that is gone with the process and its children, and becomes the test in it.
const IN_A_SMALL_DISK: &str = r#"mount -t tmpfs -o size=6m none "$0" && exec "$@""#;

/// Paints on a disk of 6 MiB until it is full.
fn fill(folder: &Path) {
    let path = folder.join("t.orogeny");
    std::fs::write(folder.join("ballast"), vec![1; BALLAST_BYTES]).unwrap();
    let mut store = create(&path);
    let field = store.layers()[0].heights;
    let pages = |seed: u32| -> Vec<_> {
        (0..PAGES.0)
            .map(|x| (PageKey::full_resolution(field, x, seed % PAGES.1), page(seed * 10 + x)))
            .collect()
    };
    acknowledge("mounted");

    let commit = |store: &mut Store, seed: u32| {
        let mut transaction = store.begin()?;
        transaction.write_pages(&pages(seed))?;
        transaction.commit("{}", "child")
    };
    let mut shown = contents(&store);
    let mut num_commits = 0;
    let err = loop {
        match commit(&mut store, num_commits) {
            Ok(_) => {
                num_commits += 1;
                shown = contents(&store);
            }
            Err(err) => break err,
        }
        assert!(num_commits < 10_000, "the disk is not small");
    };
    assert!(matches!(err, Error::DiskFull { .. }), "{err:?}");
    assert!(err.to_string().contains("no space is left"), "{err}");
    assert!(num_commits > 3, "{num_commits}");
    assert_eq!(contents(&store), shown);
    assert_eq!(store.log().unwrap().len(), num_commits as usize);
    acknowledge("full");

    // One operation larger than what is left, whose failure is seen half-way.
    let mut transaction = store.begin().unwrap();
    let failed = (0..10_000).find_map(|seed| transaction.write_pages(&pages(seed)).err()).or_else(|| {
        transaction.add_layer(&orogeny_store::NewLayer { name: "x".to_owned(), constant_m: 0.0 }).err()
    });
    match failed {
        Some(err) => {
            assert!(matches!(err, Error::DiskFull { .. }), "{err:?}");
            assert!(matches!(transaction.commit("{}", "child"), Err(Error::TransactionFailed)));
        }
        None => assert!(matches!(transaction.commit("{}", "child"), Err(Error::DiskFull { .. }))),
    }
    assert_eq!(contents(&store), shown);
    assert_whole(&store);
    acknowledge("large");

    // What is left is taken, so that not even an empty terrain fits.
    let mut filler = std::fs::File::create(folder.join("filler")).unwrap();
    while std::io::Write::write_all(&mut filler, &[1; 4096]).is_ok() {}
    let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
    let new = NewTerrain { grid, layout: layout(), layers: Vec::new() };
    let err = Store::create(&folder.join("new.orogeny"), &new).unwrap_err();
    assert!(matches!(err, Error::DiskFull { .. }), "{err:?}");
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(names.into_iter().all(|name| !name.to_string_lossy().starts_with("new")));
    acknowledge("create");

    std::fs::remove_file(folder.join("ballast")).unwrap();
    std::fs::remove_file(folder.join("filler")).unwrap();
    commit(&mut store, num_commits).unwrap();
    assert_eq!(store.undo(u32::MAX).unwrap().len(), num_commits as usize + 1);
    assert_whole(&store);
    store.close().unwrap();
    assert_whole(&Store::open(&path).unwrap());
    acknowledge("freed");
}

#[test]
fn a_full_disk_costs_nothing_that_was_acknowledged() {
    if let Some(folder) = child_path() {
        return fill(&folder);
    }
    let scratch = tempfile::tempdir().unwrap();
    let mut command = Command::new("unshare");
    as_child(&mut command, scratch.path())
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", IN_A_SMALL_DISK])
        .args([scratch.path(), &std::env::current_exe().unwrap()])
        .args(child_arguments("disk_full::a_full_disk_costs_nothing_that_was_acknowledged"));
    let output = match command.output() {
        Ok(output) => output,
        Err(err) => return skip(&format!("a full disk: no small disk can be mounted (unshare: {err})")),
    };
    let lines = acknowledged(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    if lines.is_empty() && !output.status.success() && !errors.contains("panicked") {
        return skip(&format!("a full disk: no small disk can be mounted ({})", errors.trim()));
    }
    assert!(output.status.success(), "{errors}");
    assert_eq!(lines, ["mounted", "full", "large", "create", "freed"]);
}
