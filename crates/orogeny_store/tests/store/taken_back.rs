//! Recordings that are dropped: what went wrong in them concerns no one else.

use orogeny_field::PageKey;
use orogeny_store::{Error, Recorder};

use crate::support::{Scratch, page};

#[test]
fn what_failed_in_a_recording_that_was_dropped_fails_nothing_after_it() {
    let scratch = Scratch::new();
    let store = scratch.create();
    let field = store.layers()[0].heights;
    let mut recorder = Recorder::start(store, 1 << 20, 1 << 20).unwrap();
    let (inside, outside) = (PageKey::full_resolution(field, 0, 0), PageKey::full_resolution(field, 99, 0));
    for round in 0..10 {
        let mut recording = recorder.begin().unwrap();
        recording.write_pages(vec![(outside, page(1))]).unwrap();
        drop(recording);
        // Nothing is left of it, neither pages nor its failure.
        let mut recording = recorder.begin().unwrap();
        recording.write_pages(vec![(inside, page(round))]).unwrap();
        recording.record("{}".to_owned(), "someone").unwrap();
        recording.finish().unwrap();
        recorder.flush().unwrap();
    }
    assert_eq!(recorder.on_disk().unwrap().log().unwrap().len(), 10);
    // Whoever goes on to its end is told, at the first call after the thread has seen it.
    let mut recording = recorder.begin().unwrap();
    recording.write_pages(vec![(outside, page(1))]).unwrap();
    let recorded = recording.record("{}".to_owned(), "someone");
    let finished = match recorded {
        Ok(_) => recording.finish(),
        Err(err) => {
            drop(recording);
            Err(err)
        }
    };
    let err = finished.and_then(|()| recorder.flush()).unwrap_err();
    assert!(matches!(err, Error::PageOutside { .. }), "{err}");
    recorder.flush().unwrap();
    assert_eq!(recorder.on_disk().unwrap().log().unwrap().len(), 10);
}
