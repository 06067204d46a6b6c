//! Several clients on one terrain: all see the same, and one that is slow keeps no one.

use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::support::{Live, Served, bits, heights_of, raise};

fn operations(live: &Live) -> Vec<Value> {
    live.events.iter().filter(|event| event["event"] == "operation").cloned().collect()
}

#[test]
fn eight_paint_at_once_and_all_end_with_the_servers_heights() {
    let long = std::env::var_os("OROGENY_TEST_LONG").is_some();
    let num_strokes = if long { 200 } else { 12 };
    let mut served = Served::new();
    let clients: Vec<Live> = (0..8)
        .map(|k| {
            let mut live = served.live(&format!("client-{k}"));
            live.say(&json!({ "type": "subscribe", "window": 4 }));
            live
        })
        .collect();
    let painters: Vec<_> = clients
        .into_iter()
        .enumerate()
        .map(|(k, mut live)| {
            thread::spawn(move || {
                for stroke in 0..num_strokes {
                    let id = stroke + 1;
                    // Over borders, over each other; now and then a stroke is given up, or undone.
                    let at = |n: u64| {
                        [
                            (k as u64 * 131 + stroke * 97 + n * 40) % 1400,
                            (k as u64 * 71 + stroke * 53 + n * 30) % 1200,
                        ]
                    };
                    let points: Vec<[f64; 2]> = (0..4).map(|n| at(n).map(|side| side as f64)).collect();
                    let brush = match (k + stroke as usize) % 3 {
                        0 => raise(50.0, 3.0),
                        1 => json!({ "type": "smooth", "radius": 60, "width": 8 }),
                        _ => json!({ "type": "noise", "radius": 60, "strength": 4, "feature_size": 40 }),
                    };
                    if stroke % 5 == 3 {
                        let operation = json!({ "op": "stroke", "brush": brush, "points": points });
                        live.say(&json!({ "type": "begin_stroke", "id": id, "operation": operation }));
                        live.say(&json!({ "type": "cancel_stroke", "id": id }));
                        assert_eq!(live.end_of(id)["code"], "cancelled");
                    } else {
                        live.draw(id, &brush, &points);
                        live.done(id);
                    }
                    if stroke % 6 == 5 {
                        live.say(&json!({ "type": "undo", "id": 1_000_000 + id }));
                        live.done(1_000_000 + id);
                    }
                }
                live
            })
        })
        .collect();
    let mut clients: Vec<Live> = painters.into_iter().map(|painter| painter.join().unwrap()).collect();
    let revision = served.get("/v1/terrains/t").ok()["revision"].as_u64().unwrap();
    let last = |live: &Live| operations(live).last().map(|event| event["revision"].as_u64().unwrap());
    for live in &mut clients {
        // Every page that was changed by the last revision has come once nothing more is under way: a mark tells when.
        while last(live) < Some(revision) {
            live.hear();
        }
    }
    let terrain_heights = {
        for live in &mut clients {
            live.say(&json!({ "type": "subscribe", "window": 4 }));
            live.until_pages(|pages| pages.values().all(|(header, _)| header.revision == revision));
        }
        let terrain = served.stop();
        let log = terrain.log().unwrap();
        assert!(log.len() >= 8 * num_strokes as usize * 3 / 5, "{} entries", log.len());
        heights_of(&terrain)
    };
    let heard = operations(&clients[0]);
    let revisions: Vec<_> = heard.iter().map(|event| event["revision"].as_u64().unwrap()).collect();
    assert!(revisions.is_sorted() && revisions.len() as u64 >= num_strokes * 8 / 2);
    for (k, live) in clients.iter().enumerate() {
        assert!(
            bits(&live.heights(700, 600)) == bits(&terrain_heights),
            "what client {k} sees is not what is there"
        );
        let own = operations(live);
        // Whoever came later missed nothing that came after.
        assert_eq!(own[..], heard[heard.len() - own.len()..], "client {k} heard something else");
    }
}

#[test]
fn frames_alone_keep_a_view_true() {
    let mut served = Served::new();
    let [mut ann, mut bob] = ["ann", "bob"].map(|author| served.live(author));
    bob.say(&json!({ "type": "subscribe", "window": 2 }));
    bob.until_pages(|pages| pages.len() == 9);
    for id in 1..=20 {
        let at = [100.0 + 60.0 * id as f64, 80.0 + 50.0 * id as f64];
        ann.draw(id, &raise(90.0, 5.0), &[at, [at[0] + 50.0, at[1]]]);
    }
    let last = ann.done(20)["revision"].as_u64().unwrap();
    let operation = bob.until_event(|event| event["event"] == "operation" && event["revision"] == last);
    assert_eq!(operation["author"], "ann");
    // The pages under the last stroke come as of it, and those before them need not come again.
    let rect: Vec<f64> = serde_json::from_value(operation["rect"].clone()).unwrap();
    let page = ((rect[0] + rect[2] / 2.0) as u32 / 512, (rect[1] + rect[3] / 2.0) as u32 / 512);
    bob.until_pages(|pages| pages[&page].0.revision >= last);
    let start = Instant::now();
    let terrain = served.stop();
    let expected = heights_of(&terrain);
    while bits(&bob.heights(700, 600)) != bits(&expected) {
        bob.hear();
        assert!(start.elapsed() < crate::support::WAIT);
    }
}

#[test]
fn whoever_does_not_acknowledge_gets_the_latest_once_it_does_and_keeps_no_one() {
    let mut served = Served::new();
    let [mut ann, mut bob, mut cem] = ["ann", "bob", "cem"].map(|author| served.live(author));
    bob.acknowledges = false;
    bob.say(&json!({ "type": "subscribe", "window": 3 }));
    cem.say(&json!({ "type": "subscribe" }));
    cem.until_pages(|pages| pages.len() == 9);
    let mut slowest = Duration::ZERO;
    for id in 1..=60 {
        let start = Instant::now();
        ann.draw(id, &raise(60.0, 1.0), &[[300.0, 300.0]]);
        let revision = ann.done(id)["revision"].as_u64().unwrap();
        cem.until_pages(|pages| pages[&(0, 0)].0.revision >= revision);
        slowest = slowest.max(start.elapsed());
    }
    println!("the slowest of 60 strokes was seen by the others after {slowest:?}");
    // Not one more than the window, though the page changed sixty times.
    let done = bob.until_event(|event| event["event"] == "operation" && event["what"] == "stroke raise");
    assert!(done["revision"].is_u64());
    let last = cem.pages[&(0, 0)].0.revision;
    bob.until_event(|event| event["event"] == "operation" && event["revision"] == last);
    assert_eq!(bob.num_frames, 3);
    bob.acknowledges = true;
    bob.say(&json!({ "type": "ack", "frames": 3 }));
    bob.until_pages(|pages| pages.len() == 9 && pages[&(0, 0)].0.revision == last);
    assert!(bob.num_frames <= 10, "{} frames", bob.num_frames);
    let terrain = served.stop();
    assert_eq!(bits(&bob.heights(700, 600)), bits(&heights_of(&terrain)));
}

#[test]
fn the_order_of_two_on_the_same_page_is_the_order_in_the_history() {
    let long = std::env::var_os("OROGENY_TEST_LONG").is_some();
    let num_rounds: u64 = if long { 5000 } else { 100 };
    let mut served = Served::new();
    let painters = ["ann", "bob"].map(|author| {
        let mut live = served.live(author);
        thread::spawn(move || {
            for id in 1..=num_rounds {
                // Which of the two comes last is seen: the heights are set.
                let height_m = id as f64 + if author == "ann" { 0.25 } else { 0.75 };
                let brush = json!({ "type": "set_height", "radius": 20, "falloff": 0, "height": height_m });
                live.draw(id, &brush, &[[100.0, 100.0]]);
                live.done(id);
            }
            live
        })
    });
    let clients = painters.map(|painter| painter.join().unwrap());
    let revision = served.get("/v1/terrains/t").ok()["revision"].as_u64().unwrap();
    let heard = clients.map(|mut live| {
        while operations(&live).last().is_none_or(|event| event["revision"].as_u64() < Some(revision)) {
            live.hear();
        }
        let operations = operations(&live);
        operations
            .iter()
            .map(|event| (event["revision"].as_u64().unwrap(), event["author"].clone()))
            .collect::<Vec<_>>()
    });
    let [ann, bob] = heard;
    let common = ann.len().min(bob.len());
    assert_eq!(ann[ann.len() - common..], bob[bob.len() - common..]);
    let terrain = served.stop();
    let log = terrain.log().unwrap();
    assert_eq!(log.len() as u64, 2 * num_rounds);
    let authors: Vec<_> = log.iter().map(|entry| json!(entry.author)).collect();
    let told: Vec<_> = ann.iter().map(|(_, author)| author.clone()).collect();
    assert_eq!(authors[authors.len() - told.len()..], told);
    let last = &log.last().unwrap().operation_json;
    let operation: Value = serde_json::from_str(last).unwrap();
    assert_eq!(
        operation["brush"]["height"].as_f64().map(|height| height as f32),
        Some(terrain.height_m([100.0, 100.0]).unwrap())
    );
}

#[test]
fn what_was_acknowledged_is_there_and_clients_are_told_of_the_end() {
    let mut served = Served::new();
    let [mut ann, mut bob] = ["ann", "bob"].map(|author| served.live(author));
    ann.draw(1, &raise(60.0, 7.0), &[[300.0, 300.0]]);
    ann.done(1);
    let running = served.running.take().unwrap();
    let stopping = thread::spawn(move || running.stop());
    bob.until("closing");
    assert_eq!(bob.closed(), 1001);
    assert_eq!(ann.closed(), 1001);
    stopping.join().unwrap().unwrap();
    served.start(orogeny_service::Limits::default());
    let heights = served.get("/v1/terrains/t/heights?x=300&z=300&width=2&depth=2").floats();
    assert_eq!(heights, [107.0]);
    // What was done before can still be undone by whoever did it.
    let undone = served.post("/v1/terrains/t/undo", &json!({ "author": "ann" })).ok();
    assert_eq!(undone["entries"], json!([]));
    let heights = served.get("/v1/terrains/t/heights?x=300&z=300&width=2&depth=2").floats();
    assert_eq!(heights, [100.0]);
}
