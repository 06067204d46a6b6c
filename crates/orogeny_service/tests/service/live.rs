//! The live channel.

use serde_json::json;
use tungstenite::Message;

use crate::support::{Served, bits, heights_of, raise};

#[test]
fn a_client_hears_what_there_is_and_sees_what_it_looks_at() {
    let mut served = Served::new();
    let mut ann = served.live("ann");
    for (field, value) in
        [("width", 700.0), ("depth", 600.0), ("spacing", 2.0), ("levels", 2.0), ("page_size", 256.0)]
    {
        assert_eq!(ann.hello[field].as_f64(), Some(value), "{field}");
    }
    assert_eq!((&ann.hello["author"], &ann.hello["terrain"]), (&json!("ann"), &json!("t")));
    let clients = ann.until("clients");
    assert_eq!(clients["clients"], json!([{ "client": ann.hello["client"], "author": "ann" }]));
    let status = ann.until("status");
    assert_eq!(status["layers"][0]["name"], "Base");
    assert_eq!(status["can_undo"], false);

    ann.say(&json!({ "type": "subscribe" }));
    ann.until_pages(|pages| pages.len() == 9);
    let heights = ann.heights(700, 600);
    assert!(heights.iter().all(|height| *height == 100.0));
    let (last, _) = &ann.pages[&(2, 2)];
    assert_eq!((last.width, last.depth), (700 - 512, 600 - 512));

    ann.draw(1, &raise(100.0, 10.0), &[[300.0, 300.0], [520.0, 300.0]]);
    let done = ann.done(1);
    assert_eq!(done["entries"], json!([1]));
    let rect: Vec<f64> = serde_json::from_value(done["rect"].clone()).unwrap();
    assert!(rect[0] <= 202.0 && rect[0] + rect[2] >= 590.0 && rect[3] < 210.0, "{rect:?}");
    let operation = ann.events.iter().rev().find(|event| event["event"] == "operation").unwrap().clone();
    for field in ["revision", "entries", "rect"] {
        assert_eq!(operation[field], done[field], "{field}");
    }
    assert_eq!((&operation["author"], &operation["what"]), (&json!("ann"), &json!("stroke raise")));
    let revision = done["revision"].as_u64().unwrap();
    ann.until_pages(|pages| pages[&(0, 0)].0.revision >= revision && pages[&(1, 0)].0.revision >= revision);
    assert!(ann.pages[&(2, 2)].0.revision < revision, "a page was sent that did not change");
    while ann.last("status")["can_undo"] != true {
        ann.hear();
    }

    ann.say(&json!({ "type": "undo", "id": 2 }));
    let undone = ann.done(2);
    ann.until_pages(|pages| {
        let revision = undone["revision"].as_u64().unwrap();
        pages[&(0, 0)].0.revision >= revision && pages[&(1, 0)].0.revision >= revision
    });
    assert!(ann.heights(700, 600).iter().all(|height| *height == 100.0));
    ann.say(&json!({ "type": "redo", "id": 3 }));
    let redone = ann.done(3);
    ann.until_pages(|pages| {
        let revision = redone["revision"].as_u64().unwrap();
        pages[&(0, 0)].0.revision >= revision && pages[&(1, 0)].0.revision >= revision
    });
    let seen = ann.heights(700, 600);
    drop(ann);
    let terrain = served.stop();
    assert_eq!(bits(&seen), bits(&heights_of(&terrain)));
}

#[test]
fn a_stroke_is_seen_while_it_is_drawn_and_gone_when_it_is_given_up() {
    let served = Served::new();
    let [mut ann, mut bob] = ["ann", "bob"].map(|author| served.live(author));
    bob.say(&json!({ "type": "subscribe", "region": [0, 0, 400, 400] }));
    bob.until_pages(|pages| pages.len() == 1);
    let operation = json!({ "op": "stroke", "brush": raise(60.0, 10.0), "points": [[160, 200], [180, 200], [200, 200], [220, 200]] });
    ann.say(&json!({ "type": "begin_stroke", "id": 7, "operation": operation }));
    bob.until_pages(|pages| pages[&(0, 0)].1[100 * 256 + 90] > 101.0);
    // The hand rests; its cursor is seen, not its own by itself.
    ann.say(&json!({ "type": "cursor", "x": 210, "z": 190, "radius": 60 }));
    let cursor = bob.until("cursor");
    assert_eq!(
        cursor,
        json!({ "event": "cursor", "client": ann.hello["client"], "x": 210.0, "z": 190.0, "radius": 60.0 })
    );
    ann.say(&json!({ "type": "points", "id": 7, "points": [[300, 200, 0.5, 1.5], [340, 200]] }));
    bob.until_pages(|pages| pages[&(0, 0)].1[100 * 256 + 140] > 100.5);
    ann.say(&json!({ "type": "cancel_stroke", "id": 7 }));
    assert_eq!(ann.end_of(7)["code"], "cancelled");
    bob.until_pages(|pages| pages[&(0, 0)].1.iter().all(|height| *height == 100.0));

    // Who goes in mid-stroke takes it along; who had lifted the hand does not.
    ann.draw(8, &raise(60.0, 5.0), &[[700.0, 700.0]]);
    ann.say(&json!({ "type": "begin_stroke", "id": 9, "operation": operation }));
    bob.until_pages(|pages| pages[&(0, 0)].1[100 * 256 + 90] > 101.0);
    let num_operations = bob.events.iter().filter(|event| event["event"] == "operation").count();
    drop(ann);
    bob.until_pages(|pages| pages[&(0, 0)].1.iter().all(|height| *height == 100.0));
    bob.until_alone();
    assert_eq!(num_operations, 1);
}

#[test]
fn a_subscription_is_of_a_region_and_a_level_and_can_be_changed() {
    let served = Served::new();
    let mut ann = served.live("ann");
    ann.say(&json!({ "type": "subscribe", "level": 2, "region": [1000, 900, 100, 100] }));
    ann.until_pages(|pages| pages.len() == 1);
    let (header, _) = ann.pages[&(0, 0)];
    assert_eq!((header.level, header.width, header.depth), (2, 175, 150));
    ann.pages.clear();
    ann.say(&json!({ "type": "subscribe", "level": 1, "region": [1100, 0, 100, 100] }));
    ann.until_pages(|pages| pages.len() == 1);
    assert_eq!(ann.pages.keys().next(), Some(&(1, 0)));
    for (message, code) in [
        (json!({ "type": "subscribe", "level": 3 }), "unknown_level"),
        (json!({ "type": "subscribe", "region": [2000, 0, 10, 10] }), "region"),
        (json!({ "type": "subscribe", "region": [0, 0, -10, 10] }), "region"),
        (json!({ "type": "subscribe", "format": "jpg" }), "not_understood"),
        (
            json!({ "type": "begin_stroke", "id": 1, "operation": { "op": "fill", "brush": raise(9.0, 9.0) } }),
            "operation",
        ),
        (
            json!({ "type": "begin_stroke", "id": 1, "operation": { "op": "stroke", "brush": { "type": "dig" } } }),
            "operation",
        ),
        (json!({ "type": "begin_stroke", "id": 1 }), "not_understood"),
        (json!({ "type": "apply", "id": 1, "operations": [3] }), "operation"),
        (json!({ "type": "points", "id": 1, "points": [[1]] }), "not_understood"),
        (json!({ "type": "shout" }), "not_understood"),
        (json!([]), "not_understood"),
    ] {
        ann.say(&message);
        let error = ann.until("error");
        assert_eq!(error["code"], code, "{message}: {error}");
        assert!(error["message"].as_str().unwrap().len() > 10);
    }
    ann.send(Message::text("{\"type\":"));
    assert_eq!(ann.until("error")["code"], "not_understood");
    ann.send(Message::binary(vec![0; 64]));
    assert_eq!(ann.until("error")["code"], "not_understood");
    // Late words about what is over do no harm.
    for message in
        [json!({ "type": "points", "id": 5, "points": [[1, 1]] }), json!({ "type": "end_stroke", "id": 5 })]
    {
        ann.say(&message);
    }
    ann.say(&json!({ "type": "unsubscribe" }));
    let num_frames = ann.num_frames;
    ann.draw(6, &raise(50.0, 5.0), &[[1150.0, 50.0]]);
    ann.done(6);
    ann.draw(7, &raise(50.0, 5.0), &[[1150.0, 50.0]]);
    ann.done(7);
    assert_eq!(ann.num_frames, num_frames, "a page came that no one looks at");
    ann.say(&json!({ "type": "apply", "id": 8, "operations": [{ "op": "set_layer", "layer": "Base", "opacity": 0.5 }] }));
    let done = ann.done(8);
    assert_eq!(done["rect"], json!(null));
}
