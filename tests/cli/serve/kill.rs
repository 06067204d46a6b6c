//! Killed under load: what was acknowledged is there.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::{Value, json};

use super::{Serving, post, until};
use crate::program::Folder;

#[test]
fn what_was_acknowledged_survives_a_kill_at_any_moment() {
    let num_kills = if std::env::var_os("OROGENY_TEST_LONG").is_some() { 200 } else { 6 };
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 600x600 --spacing 1");
    let acknowledged = Arc::new(Mutex::new(BTreeSet::<u64>::new()));
    let mut num_undone = 0;
    for round in 0..num_kills {
        let mut serving = Serving::start(&folder, "");
        let at_start = acknowledged.lock().unwrap().len();
        let is_over = Arc::new(AtomicBool::new(false));
        let painters: Vec<_> = (0..4_u64)
            .map(|painter| {
                let (address, is_over) = (serving.address.clone(), Arc::clone(&is_over));
                let acknowledged = Arc::clone(&acknowledged);
                std::thread::spawn(move || {
                    for stroke in 0.. {
                        if is_over.load(Ordering::SeqCst) {
                            break;
                        }
                        // The seed says which stroke it is.
                        let seed = (round * 4 + painter) * 100_000 + stroke;
                        let at = [50 + (seed * 37) % 500, 50 + (seed * 91) % 500];
                        let brush = json!({ "type": "roughen", "radius": 40, "strength": 2 });
                        let operation =
                            json!({ "op": "stroke", "seed": seed, "brush": brush, "points": [at] });
                        let body =
                            json!({ "operations": [operation], "author": format!("painter {painter}") });
                        if post(&address, "/v1/terrains/t/operations", &body).is_some() {
                            acknowledged.lock().unwrap().insert(seed);
                        }
                    }
                })
            })
            .collect();
        // A slow machine takes its time to get going.
        until("strokes are acknowledged", || acknowledged.lock().unwrap().len() >= at_start + 8);
        // One who undoes from under the others, which is one commit or none.
        std::thread::sleep(Duration::from_millis(60 + (round * 83) % 240));
        let before = acknowledged.lock().unwrap().len();
        let body = json!({ "author": "painter 0" });
        let undone = post(&serving.address, "/v1/terrains/t/undo", &body);
        num_undone += u64::from(undone.is_some_and(|undone| undone["rect"] != json!([0.0, 0.0, 0.0, 0.0])));
        std::thread::sleep(Duration::from_millis((round * 57) % 90));
        serving.child.kill().unwrap();
        serving.child.wait().unwrap();
        is_over.store(true, Ordering::SeqCst);
        painters.into_iter().for_each(|painter| painter.join().unwrap());
        assert!(acknowledged.lock().unwrap().len() >= before);

        let report = folder.succeed("check t.orogeny");
        assert_eq!(report["problems"].as_array().map(Vec::len), Some(0), "{report}");
        let log = folder.succeed("log t.orogeny");
        let seeds = |is_counted: fn(&Value) -> bool| -> BTreeSet<u64> {
            let entries = log["entries"].as_array().unwrap().iter().filter(|entry| is_counted(entry));
            entries.map(|entry| entry["operation"]["seed"].as_u64().unwrap()).collect()
        };
        let (all, applied) = (seeds(|_| true), seeds(|entry| entry["state"] == "applied"));
        let acknowledged = acknowledged.lock().unwrap();
        let lost: Vec<_> = acknowledged.difference(&all).collect();
        assert!(lost.is_empty(), "acknowledged and lost: {lost:?}");
        // Nothing but what was undone is gone from sight: one stroke of the first painter a round.
        let hidden: Vec<_> = acknowledged.difference(&applied).collect();
        assert!(hidden.len() as u64 <= round + 1, "{hidden:?} do not show");
        assert!(hidden.iter().all(|seed| **seed / 100_000 % 4 == 0), "{hidden:?} do not show");
    }
    assert!(num_undone > 0, "no undo came through");
    assert!(acknowledged.lock().unwrap().len() as u64 > num_kills * 4, "hardly anything was painted");
}

#[test]
fn asked_to_stop_it_ends_what_is_drawn_and_leaves_one_file() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 600x600 --spacing 1");
    let serving = Serving::start(&folder, "");
    let brush = json!({ "type": "raise", "radius": 40, "strength": 2 });
    let operation = json!({ "op": "stroke", "brush": brush, "points": [[100, 100]] });
    post(&serving.address, "/v1/terrains/t/operations", &json!({ "operations": [operation] })).unwrap();
    serving.stop();
    let mut files: Vec<_> = folder.state().into_keys().collect();
    files.retain(|name| name.starts_with("t."));
    assert_eq!(files, ["t.orogeny"]);
    assert_eq!(folder.succeed("log t.orogeny")["entries"].as_array().unwrap().len(), 1);
}
