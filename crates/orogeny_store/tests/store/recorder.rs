//! Commits behind the painting: what is on its way is seen, arrives in order, and fails as a whole.

use std::sync::Arc;

use orogeny_field::{Page, PageKey};
use orogeny_store::{EntryId, EntryState, Error, Recorder, Store};

use crate::support::{Scratch, assert_whole, bits, key, layer, layout, page, painted};

/// More than any test writes.
const AMPLE_BYTES: u64 = 1 << 30;

fn recorder(scratch: &Scratch, max_pending_bytes: u64) -> (Recorder, PageKey) {
    let store = scratch.create();
    let at = key(&store, 1, 1);
    (Recorder::start(store, max_pending_bytes, 1 << 20).unwrap(), at)
}

fn read(recorder: &Recorder, key: &PageKey) -> Option<Vec<u32>> {
    recorder.load_page(key).unwrap().map(|page| bits(&page))
}

#[test]
fn what_is_on_its_way_is_seen_and_arrives_in_order() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    for seed in 1..=20 {
        let mut recording = recorder.begin().unwrap();
        assert_eq!(
            recording.load_page(&at).unwrap().map(|page| bits(&page)),
            (seed > 1).then(|| bits(&page(seed - 1)))
        );
        recording.write_pages(vec![(at, page(1000 + seed))]).unwrap();
        recording.write_pages(vec![(at, page(seed)), (PageKey { x: 2, ..at }, page(seed + 50))]).unwrap();
        assert_eq!(bits(&recording.load_page(&at).unwrap().unwrap()), bits(&page(seed)));
        let before = recording.load_page_before(&at).unwrap().map(|page| bits(&page));
        assert_eq!(before, (seed > 1).then(|| bits(&page(seed - 1))));
        assert_eq!(recording.record(format!("{{\"seed\": {seed}}}"), "test").unwrap(), EntryId(seed));
        recording.finish().unwrap();
        // On disk or not: it is what everyone sees.
        assert_eq!(read(&recorder, &at), Some(bits(&page(seed))));
    }
    recorder.flush().unwrap();
    let log = recorder.on_disk().unwrap().log().unwrap();
    assert_eq!(
        log.iter().map(|entry| entry.operation_json.clone()).collect::<Vec<_>>(),
        (1..=20).map(|seed| format!("{{\"seed\": {seed}}}")).collect::<Vec<_>>()
    );
    assert_eq!(bits(&recorder.on_disk().unwrap().load_page(&at).unwrap().unwrap()), bits(&page(20)));
    assert_eq!(recorder.undo(5).unwrap().len(), 5);
    assert_eq!(read(&recorder, &at), Some(bits(&page(15))));
    assert_eq!(recorder.jump(EntryId(18)).unwrap().len(), 3);
    recorder.close().unwrap();
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
    assert_whole(&Store::open(&scratch.path()).unwrap());
}

#[test]
fn several_entries_are_done_together_or_not_at_all() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    for is_finished in [false, true] {
        let mut recording = recorder.begin().unwrap();
        for seed in 1..=3 {
            recording.write_pages(vec![(at, page(seed))]).unwrap();
            assert_eq!(recording.record("{}".to_owned(), "test").unwrap(), EntryId(seed));
            // The next entry's past is this one.
            assert_eq!(bits(&recording.load_page_before(&at).unwrap().unwrap()), bits(&page(seed)));
        }
        if is_finished {
            recording.finish().unwrap();
        } else {
            drop(recording);
        }
        assert_eq!(read(&recorder, &at), is_finished.then(|| bits(&page(3))));
    }
    recorder.flush().unwrap();
    assert_eq!(recorder.on_disk().unwrap().log().unwrap().len(), 3);
}

#[test]
fn a_dropped_recording_leaves_no_trace() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, page(1))]).unwrap();
    recording.add_layer(layer("Lost", 0.0)).unwrap();
    recording.record("{}".to_owned(), "test").unwrap();
    recording.write_pages(vec![(at, page(2))]).unwrap();
    drop(recording);
    assert_eq!((recorder.memory_in_bytes(), read(&recorder, &at)), (0, None));
    let mut recording = recorder.begin().unwrap();
    assert_eq!(recording.layers().len(), 1);
    recording.write_pages(vec![(at, page(3))]).unwrap();
    assert_eq!(recording.record("{}".to_owned(), "test").unwrap(), EntryId(1));
    recording.finish().unwrap();
    recorder.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!(painted(&store, at.field), [(at, bits(&page(3)))]);
    assert_whole(&store);
}

#[test]
fn pages_that_are_in_the_transaction_already_come_from_there() {
    let scratch = Scratch::new();
    // No room: each write waits until the one before has reached the transaction.
    let (mut recorder, at) = recorder(&scratch, 0);
    let keys: Vec<PageKey> = (0..5).flat_map(|x| (0..3).map(move |z| PageKey { x, z, ..at })).collect();
    for round in 0..3_u32 {
        let mut recording = recorder.begin().unwrap();
        for (key, seed) in keys.iter().zip(round * 100..) {
            recording.write_pages(vec![(*key, page(seed))]).unwrap();
        }
        for (key, seed) in keys.iter().zip(round * 100..) {
            assert_eq!(bits(&recording.load_page(key).unwrap().unwrap()), bits(&page(seed)));
            let before = recording.load_page_before(key).unwrap().map(|page| bits(&page));
            assert_eq!(before, (round > 0).then(|| bits(&page(seed - 100))));
        }
        recording.record("{}".to_owned(), "test").unwrap();
        recording.finish().unwrap();
        for (key, seed) in keys.iter().zip(round * 100..) {
            assert_eq!(read(&recorder, key), Some(bits(&page(seed))));
        }
    }
    recorder.close().unwrap();
    assert_whole(&Store::open(&scratch.path()).unwrap());
}

#[test]
fn a_new_layer_is_there_for_everyone_at_once() {
    let scratch = Scratch::new();
    let (mut recorder, _) = recorder(&scratch, AMPLE_BYTES);
    let mut recording = recorder.begin().unwrap();
    let sculpt = recording.add_layer(layer("Sculpt", 4.0)).unwrap();
    let at = PageKey::full_resolution(sculpt.heights, 0, 0);
    recording.write_pages(vec![(at, page(1))]).unwrap();
    recording.record("{}".to_owned(), "test").unwrap();
    recording.finish().unwrap();
    assert_eq!(recorder.on_disk().unwrap().layers().len(), 2);
    assert_eq!(read(&recorder, &at), Some(bits(&page(1))));
    recorder.undo(1).unwrap();
    assert_eq!(recorder.on_disk().unwrap().layers().len(), 1);
}

#[test]
fn what_cannot_be_written_fails_the_operation_and_the_one_on_top_of_it() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, page(1))]).unwrap();
    recording.record("{}".to_owned(), "test").unwrap();
    recording.finish().unwrap();

    // A height that is none comes to light in the thread.
    let mut broken = page(2);
    broken.samples_mut()[7] = f32::NAN;
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, broken)]).unwrap();
    recording.record("{}".to_owned(), "test").unwrap();
    // The operation before it is on disk by then, so it is handed over; unless the failure is known already.
    let finished = recording.finish();
    let painted_on_top = finished.and_then(|()| {
        let mut recording = recorder.begin()?;
        recording.write_pages(vec![(PageKey { x: 0, ..at }, page(3))])?;
        recording.record("{}".to_owned(), "test")?;
        recording.finish()
    });
    let err = painted_on_top.unwrap_err();
    assert!(matches!(err, Error::Height { x: 7, z: 0, .. }), "{err}");
    recorder.flush().unwrap();
    assert_eq!(read(&recorder, &at), Some(bits(&page(1))));
    assert_eq!(read(&recorder, &PageKey { x: 0, ..at }), None);

    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, page(4))]).unwrap();
    assert_eq!(recording.record("{}".to_owned(), "test").unwrap(), EntryId(2));
    recording.finish().unwrap();
    recorder.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!(painted(&store, at.field), [(at, bits(&page(4)))]);
    assert!(store.log().unwrap().iter().all(|entry| entry.state == EntryState::Applied));
    assert_whole(&store);
}

#[test]
fn an_operation_that_is_no_json_fails_at_the_flush() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, page(1))]).unwrap();
    recording.record("{".to_owned(), "test").unwrap();
    let failed = recording.finish().and_then(|()| recorder.flush());
    assert!(matches!(failed, Err(Error::Operation { .. })), "{failed:?}");
    assert_eq!(read(&recorder, &at), None);
    recorder.close().unwrap();
}

#[test]
fn only_a_store_that_is_open_for_writing_can_be_recorded_to() {
    let scratch = Scratch::new();
    scratch.create().close().unwrap();
    let reader = Store::open_to_read(&scratch.path()).unwrap();
    assert!(matches!(Recorder::start(reader, 0, 1 << 20), Err(Error::OpenedToRead { .. })));
}

#[test]
fn what_is_counted_is_what_is_on_its_way() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let page_bytes = layout().size_in_bytes();
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, Page::constant(layout(), 1.0))]).unwrap();
    recording.record("{}".to_owned(), "test").unwrap();
    recording.finish().unwrap();
    recorder.flush().unwrap();
    recorder.with_store(|_| Ok(())).unwrap();
    // What was on its way has arrived; the store remembers the page and those above it.
    assert!(
        (page_bytes..=8 * page_bytes).contains(&recorder.memory_in_bytes()),
        "{}",
        recorder.memory_in_bytes()
    );
    let _: Option<Arc<Page>> = recorder.load_page(&at).unwrap();
}

#[test]
fn what_is_done_after_going_back_stands_on_what_was_there_before() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let [beside, new] = [PageKey { x: 2, ..at }, PageKey { x: 3, ..at }];
    for (key, seed) in [(at, 1), (at, 2), (beside, 3)] {
        let mut recording = recorder.begin().unwrap();
        recording.write_pages(vec![(key, page(seed))]).unwrap();
        recording.record(format!("{{\"seed\": {seed}}}"), "test").unwrap();
        recording.finish().unwrap();
    }
    recorder.flush().unwrap();
    let states = |recorder: &Recorder| {
        let log = recorder.on_disk().unwrap().log().unwrap();
        log.iter().map(|entry| (entry.parent.0, entry.state)).collect::<Vec<_>>()
    };
    let before = states(&recorder);
    for is_finished in [false, true] {
        let mut recording = recorder.begin().unwrap();
        assert_eq!(recording.go_back_to(EntryId(1)).unwrap(), [at, beside]);
        let seen = |recording: &mut orogeny_store::Recording<'_>, key| {
            let now = recording.load_page(&key).unwrap().map(|page| bits(&page));
            let past = recording.load_page_before(&key).unwrap().map(|page| bits(&page));
            [now, past]
        };
        assert_eq!(seen(&mut recording, at), [Some(bits(&page(1))), Some(bits(&page(1)))]);
        assert_eq!(seen(&mut recording, beside), [None, None]);
        recording.write_pages(vec![(beside, page(4)), (new, page(5))]).unwrap();
        assert_eq!(seen(&mut recording, beside), [Some(bits(&page(4))), None]);
        assert_eq!(recording.record("{}".to_owned(), "test").unwrap(), EntryId(4));
        if is_finished {
            recording.finish().unwrap();
            recorder.flush().unwrap();
        } else {
            drop(recording);
            assert_eq!(states(&recorder), before);
            assert_eq!(read(&recorder, &at), Some(bits(&page(2))));
            assert_eq!(read(&recorder, &beside), Some(bits(&page(3))));
        }
    }
    use EntryState::{Applied, Branch};
    assert_eq!(states(&recorder), [(0, Applied), (1, Branch), (2, Branch), (1, Applied)]);
    assert_eq!(read(&recorder, &at), Some(bits(&page(1))));
    assert_eq!(read(&recorder, &beside), Some(bits(&page(4))));
    assert_eq!(recorder.jump(EntryId(3)).unwrap().len(), 3);
    assert_eq!(read(&recorder, &beside), Some(bits(&page(3))));
    assert_eq!(read(&recorder, &new), None);
    recorder.close().unwrap();
    assert_whole(&Store::open(&scratch.path()).unwrap());
}

#[test]
fn going_back_comes_first_and_to_what_shows() {
    let scratch = Scratch::new();
    let (mut recorder, at) = recorder(&scratch, AMPLE_BYTES);
    let paint = |recorder: &mut Recorder, seed| {
        let mut recording = recorder.begin().unwrap();
        recording.write_pages(vec![(at, page(seed))]).unwrap();
        recording.record("{}".to_owned(), "test").unwrap();
        recording.finish().unwrap();
    };
    paint(&mut recorder, 1);
    paint(&mut recorder, 2);
    recorder.undo(1).unwrap();
    let mut recording = recorder.begin().unwrap();
    let unknown = recording.go_back_to(EntryId(2)).unwrap_err();
    assert!(matches!(unknown, Error::UnknownEntry { entry: EntryId(2) }), "{unknown}");
    drop(recording);
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(at, page(3))]).unwrap();
    let late = recording.go_back_to(EntryId(0)).unwrap_err();
    assert!(matches!(late, Error::TransactionFailed), "{late}");
    drop(recording);
    assert_eq!(read(&recorder, &at), Some(bits(&page(1))));
    recorder.close().unwrap();
    assert_whole(&Store::open(&scratch.path()).unwrap());
}
