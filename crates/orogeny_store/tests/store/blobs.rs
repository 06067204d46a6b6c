//! Data from outside.

use std::io::Read;

use orogeny_store::{BlobHash, Error, Store};

use crate::support::{Scratch, assert_whole, commit, key, page};

/// Bytes that do not compress, larger than a piece.
fn data(length: usize, seed: u64) -> Vec<u8> {
    let mut state = seed | 1;
    let next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    std::iter::repeat_with(next).take(length).collect()
}

fn keep(store: &mut Store, data: &[u8]) -> BlobHash {
    let mut transaction = store.begin().unwrap();
    let hash = transaction.keep_blob(&mut &*data).unwrap();
    transaction.commit("{}", "test").unwrap();
    hash
}

fn read(store: &Store, hash: &BlobHash) -> Vec<u8> {
    let mut bytes = Vec::new();
    store.read_blob(hash, &mut bytes).unwrap();
    bytes
}

#[test]
fn data_comes_back_by_its_hash_and_is_kept_once() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let (large, empty) = (data(9 << 20, 1), Vec::new());
    let hash = keep(&mut store, &large);
    assert_eq!(hash.to_string(), blake3::hash(&large).to_string());
    assert_eq!(BlobHash::from_hex(&hash.to_string()), Some(hash));
    let size = store.history_summary().unwrap().size_in_bytes;
    assert!(size > 9 << 20, "{size}");
    assert_eq!(keep(&mut store, &large), hash);
    let nothing = keep(&mut store, &empty);
    assert!(store.history_summary().unwrap().size_in_bytes < size + 100);
    store.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!(read(&store, &hash), large);
    assert_eq!(read(&store, &nothing), empty);
    let report = store.check().unwrap();
    assert_eq!((report.num_blobs, report.problems.len()), (2, 0));
    let unknown = store.read_blob(&BlobHash([7; 32]), &mut Vec::new()).unwrap_err();
    assert!(matches!(unknown, Error::UnknownBlob { .. }), "{unknown}");
}

#[test]
fn data_that_is_there_is_kept_by_its_hash_alone() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let bytes = data(100_000, 5);
    let hash = keep(&mut store, &bytes);
    let mut transaction = store.begin().unwrap();
    assert_eq!(transaction.keep_known_blob(&hash).unwrap(), 100_000);
    transaction.commit("{}", "test").unwrap();
    assert_eq!(read(&store, &hash), bytes);
    assert_whole(&store);
    let mut transaction = store.begin().unwrap();
    let unknown = transaction.keep_known_blob(&BlobHash([7; 32])).unwrap_err();
    assert!(matches!(unknown, Error::UnknownBlob { .. }), "{unknown}");
    // Nothing was changed by it: the transaction goes on.
    transaction.keep_known_blob(&hash).unwrap();
    transaction.commit("{}", "test").unwrap();
}

#[test]
fn data_goes_with_the_last_entry_that_needs_it() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let hash = keep(&mut store, &data(100_000, 2));
    let at = key(&store, 0, 0);
    commit(&mut store, &[(at, page(1))]);
    keep(&mut store, &data(100_000, 2));
    store.undo(1).unwrap();
    commit(&mut store, &[(at, page(2))]);
    // The branch goes, the first entry still needs it.
    assert_eq!(store.drop_branches().unwrap().entries.len(), 1);
    assert_eq!(read(&store, &hash).len(), 100_000);
    assert_whole(&store);
    // A budget that the two strokes alone keep to.
    let all = store.history_summary().unwrap().size_in_bytes;
    let dropped = store.set_history_budget(Some(all - 1)).unwrap();
    assert_eq!(dropped.entries.len(), 1);
    assert!(matches!(store.read_blob(&hash, &mut Vec::new()), Err(Error::UnknownBlob { .. })));
    assert_whole(&store);
}

#[test]
fn data_that_cannot_be_read_in_leaves_no_trace() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the cable is out"))
        }
    }
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let mut transaction = store.begin().unwrap();
    let err = transaction.keep_blob(&mut (&*data(5 << 20, 3)).chain(Broken)).unwrap_err();
    assert!(err.to_string().contains("the cable is out"), "{err}");
    assert!(matches!(transaction.commit("{}", "test"), Err(Error::TransactionFailed)));
    assert_eq!(store.check().unwrap().num_blobs, 0);
    assert_whole(&store);
}

#[test]
fn damaged_data_is_named() {
    for sql in [
        "UPDATE blob_chunk SET bytes = zeroblob(10) WHERE number = 0",
        "UPDATE blob_chunk SET bytes = zeroblob(40000000) WHERE number = 0",
        "DELETE FROM blob_chunk WHERE number = 1",
        "UPDATE blob SET size = size + 1",
    ] {
        let scratch = Scratch::new();
        let mut store = scratch.create();
        let hash = keep(&mut store, &data(5 << 20, 4));
        store.close().unwrap();
        rusqlite::Connection::open(scratch.path()).unwrap().execute_batch(sql).unwrap();
        let store = Store::open_to_read(&scratch.path()).unwrap();
        let err = store.read_blob(&hash, &mut Vec::new()).unwrap_err();
        assert!(
            matches!(err, Error::Blob { .. }) && err.to_string().contains(&hash.to_string()),
            "{sql}: {err}"
        );
        let problems = store.check().unwrap().problems;
        assert!(problems.iter().any(|problem| matches!(problem, Error::Blob { .. })), "{sql}: {problems:?}");
    }
}
