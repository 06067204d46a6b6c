//! Two processes on one terrain: one has it open for writing, others read.

use std::io::{BufRead as _, BufReader, Read as _};
use std::sync::Arc;

use orogeny_field::PageKey;
use orogeny_store::{Error, Store};

use crate::support::{acknowledge, acknowledged, assert_whole, child, child_path, create, page};

#[test]
fn a_second_writer_is_told_who_has_it_and_readers_see_the_last_commit() {
    const TEST: &str = "lock::a_second_writer_is_told_who_has_it_and_readers_see_the_last_commit";
    if let Some(path) = child_path() {
        let mut store = Store::open(&path).unwrap();
        let key = PageKey::full_resolution(store.layers()[0].heights, 0, 0);
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&[(key, page(2))]).unwrap();
        acknowledge("locked");
        // Until the parent closes its end.
        std::io::stdin().read_to_end(&mut Vec::new()).unwrap();
        transaction.commit("{}", "child").unwrap();
        acknowledge("committed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut store = create(&path);
    let key = PageKey::full_resolution(store.layers()[0].heights, 0, 0);
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(key, page(1))]).unwrap();
    transaction.commit("{}", "parent").unwrap();
    store.close().unwrap();

    let mut process = child(TEST, &path).spawn().unwrap();
    let mut stdout = BufReader::new(process.stdout.take().unwrap());
    let mut output = Vec::new();
    while acknowledged(&output) != ["locked"] {
        assert!(stdout.read_until(b'\n', &mut output).unwrap() > 0, "{}", String::from_utf8_lossy(&output));
    }
    let err = Store::open(&path).unwrap_err();
    let Error::Busy { holder: Some(holder), .. } = &err else { panic!("{err}") };
    assert_eq!(holder.process, process.id());
    assert!(holder.program.starts_with("storage"), "{holder}");
    assert!(err.to_string().contains(&format!("open for writing in process {}", process.id())), "{err}");
    // Reading goes on, for those who come now too.
    let reader = Store::open_to_read(&path).unwrap();
    let shown = |store: &Store| store.load_page(&key).unwrap().map(Arc::unwrap_or_clone);
    assert_eq!(shown(&reader), Some(page(1)));

    drop(process.stdin.take());
    stdout.read_to_end(&mut output).unwrap();
    assert!(process.wait().unwrap().success());
    assert_eq!(acknowledged(&output), ["locked", "committed"]);
    assert_eq!(shown(&reader), Some(page(2)));
    drop(reader);
    let mut store = Store::open(&path).unwrap();
    assert_eq!(store.undo(2).unwrap().len(), 2);
    assert_whole(&store);
}
