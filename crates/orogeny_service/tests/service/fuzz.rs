//! Whatever clients say: no panic, no growth, and a terrain that is whole.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};
use tungstenite::Message;

use crate::support::{Live, Served, WAIT, raise};

fn number() -> impl Strategy<Value = Value> {
    prop_oneof![
        4 => (0_u32..1400).prop_map(|value| json!(value)),
        1 => any::<f64>().prop_map(|value| json!(value)),
        1 => any::<i64>().prop_map(|value| json!(value)),
        1 => Just(json!(1e300)),
    ]
}

/// Any JSON, not too deep.
fn anything() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        number(),
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        "[a-z_\\\\/\u{0}\u{202e}é]{0,12}".prop_map(Value::from),
        Just(json!("stroke")),
    ];
    leaf.prop_recursive(3, 24, 6, |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
            proptest::collection::btree_map("[a-z]{1,8}", inner, 0..6).prop_map(|fields| json!(fields)),
        ]
    })
}

fn point() -> impl Strategy<Value = Value> {
    prop_oneof![
        6 => (number(), number()).prop_map(|(x, z)| json!([x, z])),
        1 => proptest::collection::vec(number(), 0..7).prop_map(Value::from),
        1 => anything(),
    ]
}

fn brush() -> impl Strategy<Value = Value> {
    prop_oneof![
        4 => (1_u32..60, -5_i32..5).prop_map(|(radius_m, strength_m)| raise(radius_m.into(), strength_m.into())),
        1 => (number(), number()).prop_map(|(radius, strength)| json!({ "type": "raise", "radius": radius, "strength": strength })),
        1 => anything(),
    ]
}

/// A message that may be understood: of a few ids, so that strokes are begun, drawn, ended and given up in every order.
fn message() -> impl Strategy<Value = Value> {
    let id = 0_u64..4;
    let points = proptest::collection::vec(point(), 0..5);
    prop_oneof![
        3 => (id.clone(), brush()).prop_map(|(id, brush)| {
            json!({ "type": "begin_stroke", "id": id, "operation": { "op": "stroke", "brush": brush } })
        }),
        4 => (id.clone(), points).prop_map(|(id, points)| json!({ "type": "points", "id": id, "points": points })),
        3 => id.clone().prop_map(|id| json!({ "type": "end_stroke", "id": id })),
        2 => id.clone().prop_map(|id| json!({ "type": "cancel_stroke", "id": id })),
        1 => (id.clone(), any::<bool>()).prop_map(|(id, anyone)| json!({ "type": "undo", "id": id, "anyone": anyone })),
        1 => (id.clone(), any::<bool>()).prop_map(|(id, anyone)| json!({ "type": "redo", "id": id, "anyone": anyone })),
        1 => (id.clone(), brush()).prop_map(|(id, brush)| {
            json!({ "type": "apply", "id": id, "operations": [{ "op": "fill", "region": [0, 0, 200, 200], "brush": brush }] })
        }),
        1 => (id.clone(), anything()).prop_map(|(id, operation)| json!({ "type": "apply", "id": id, "operations": [operation] })),
        2 => (0_u8..4, number(), number(), 0_u32..80).prop_map(|(level, x, width, window)| {
            json!({ "type": "subscribe", "level": level, "region": [x, 0, width, 900], "window": window })
        }),
        1 => any::<u64>().prop_map(|frames| json!({ "type": "ack", "frames": frames })),
        1 => (number(), number()).prop_map(|(x, z)| json!({ "type": "cursor", "x": x, "z": z, "radius": 1 })),
        1 => ("[a-z_]{0,12}", anything()).prop_map(|(name, value)| json!({ "type": name, "id": value.clone(), "points": value })),
        1 => anything(),
    ]
}

/// What goes over the wire: messages, whole or broken, and bytes.
fn wire() -> impl Strategy<Value = Message> {
    prop_oneof![
        12 => message().prop_map(|message| Message::text(message.to_string())),
        1 => (message(), any::<prop::sample::Index>()).prop_map(|(message, cut)| {
            let text = message.to_string();
            let cut = text.floor_char_boundary(cut.index(text.len() + 1));
            Message::text(text[..cut].to_owned())
        }),
        1 => proptest::collection::vec(any::<u8>(), 0..80).prop_map(Message::binary),
        1 => proptest::collection::vec(any::<u8>(), 0..60).prop_map(|bytes| Message::Ping(bytes.into())),
    ]
}

/// What the corpus has on a line; `None` for a remark.
fn of_line(line: &str) -> Option<Message> {
    let bytes = |digits: &str| -> Vec<u8> {
        let digits = digits.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
        digits.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect()
    };
    if line.starts_with('#') {
        return None;
    }
    Some(match (line.strip_prefix("hex:"), line.strip_prefix("ping:")) {
        (Some(digits), _) => Message::binary(bytes(digits)),
        (_, Some(digits)) => Message::Ping(bytes(digits).into()),
        _ => Message::text(line.to_owned()),
    })
}

/// A text that lies near another: cut short, with a character put for another, or with a number put for another.
fn near(text: &str) -> impl Strategy<Value = String> + use<> {
    let text = text.to_owned();
    (any::<prop::sample::Index>(), 0_u8..3, " -~", number()).prop_map(move |(at, how, character, value)| {
        let at = text.floor_char_boundary(at.index(text.len() + 1));
        let (before, after) = text.split_at(at);
        match how {
            0 => before.to_owned(),
            1 => format!("{before}{character}{}", after.chars().skip(1).collect::<String>()),
            _ => {
                let (skipped, rest) =
                    after.split_at(after.find(|c: char| c.is_ascii_digit()).unwrap_or(after.len()));
                let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit() || ".eE+-".contains(c));
                format!("{before}{skipped}{value}{rest}")
            }
        }
    })
}

/// Bytes of memory that this process has resident.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kibibytes| kibibytes * 1024)
}

/// Ends what a client has under way, and hears an answer of afterwards.
fn settle(live: &mut Live) {
    for id in 0..4 {
        live.say(&json!({ "type": "cancel_stroke", "id": id }));
    }
    live.say(&json!({ "type": "apply", "id": 999, "operations": [] }));
    let end = live.end_of(999);
    // As long as all others are under way there may be no room.
    assert!(end["event"] == "done" || end["code"] == "too_many_tasks", "{end}");
}

#[test]
fn whatever_clients_say_the_service_goes_on() {
    let long = std::env::var_os("OROGENY_TEST_LONG").is_some();
    let mut served = Served::new();
    let mut watcher = served.live("watcher");
    let mut runner = TestRunner::deterministic();
    let mut num_messages = 0;
    let before = resident_bytes();
    let strategy = proptest::collection::vec((0_usize..3, wire()), 1..60);
    let mut clients: Vec<Live> = (0..3).map(|k| served.live(&format!("fuzz-{k}"))).collect();
    for _ in 0..if long { 200 } else { 25 } {
        let messages = strategy.new_tree(&mut runner).unwrap().current();
        num_messages += messages.len();
        for (client, message) in messages {
            clients[client].send(message);
        }
        for live in &mut clients {
            settle(live);
            live.events.clear();
            live.pages.clear();
        }
    }
    let grown = before.zip(resident_bytes()).map(|(before, after)| after.saturating_sub(before));
    watcher.draw(1, &raise(40.0, 2.0), &[[100.0, 100.0]]);
    watcher.done(1);
    assert!(num_messages > 300, "{num_messages} messages");
    println!("{num_messages} messages; grown by {grown:?} bytes");
    // The pages' budget is 64 MiB, and their history is on disk.
    assert!(grown.is_none_or(|grown| grown < 256 << 20), "grown by {grown:?} bytes");
    drop(clients);
    watcher.until_alone();
    served.stop();
}

#[test]
fn the_corpus_and_what_lies_near_it_do_no_harm() {
    let long = std::env::var_os("OROGENY_TEST_LONG").is_some();
    let mut served = Served::new();
    let mut watcher = served.live("watcher");
    let mut client = served.live("corpus");
    let mut runner = TestRunner::deterministic();
    let mut messages: Vec<Message> =
        include_str!("../corpus/messages.txt").lines().filter_map(of_line).collect();
    let num_kept = messages.len();
    for k in 0..num_kept {
        let Message::Text(text) = &messages[k] else { continue };
        let strategy = near(text.as_str());
        let near = (0..if long { 200 } else { 4 }).map(|_| strategy.new_tree(&mut runner).unwrap().current());
        let near: Vec<Message> = near.map(Message::text).collect();
        messages.extend(near);
    }
    assert!(num_kept > 60 && messages.len() > 4 * num_kept, "{num_kept} kept, {} sent", messages.len());
    let before = resident_bytes();
    for some in messages.chunks(16) {
        for message in some {
            client.send(message.clone());
        }
        settle(&mut client);
        client.events.clear();
        client.pages.clear();
    }
    let grown = before.zip(resident_bytes()).map(|(before, after)| after.saturating_sub(before));
    assert!(grown.is_none_or(|grown| grown < 256 << 20), "grown by {grown:?} bytes");
    // Who said none of it is served as before.
    watcher.draw(1, &raise(40.0, 2.0), &[[100.0, 100.0]]);
    watcher.done(1);
    drop(client);
    watcher.until_alone();
    served.stop();
}

#[test]
fn whoever_stops_reading_costs_a_bounded_memory_and_is_let_go() {
    let limits =
        orogeny_service::Limits { send: Duration::from_secs(2), ..orogeny_service::Limits::default() };
    let served = Served::with(limits, None);
    let mut ann = served.live("ann");
    // They take nothing from here on: neither frames nor messages.
    let mut stalled: Vec<Live> = (0..4).map(|k| served.live(&format!("stalled-{k}"))).collect();
    for live in &mut stalled {
        live.say(&json!({ "type": "subscribe", "window": 64 }));
    }
    let before = resident_bytes();
    let start = Instant::now();
    let mut slowest = Duration::ZERO;
    let mut id = 0;
    while ann.last("clients")["clients"].as_array().is_none_or(|clients| clients.len() != 1) {
        id += 1;
        let begun = Instant::now();
        ann.draw(id, &raise(200.0, 1.0), &[[300.0, 300.0], [900.0, 900.0]]);
        ann.done(id);
        slowest = slowest.max(begun.elapsed());
        assert!(start.elapsed() < WAIT, "who takes nothing was not let go");
    }
    let grown = before.zip(resident_bytes()).map(|(before, after)| after.saturating_sub(before));
    println!("{id} strokes beside four who take nothing, the slowest {slowest:?}; grown by {grown:?} bytes");
    // Their windows hold 64 frames of 256 KiB each at most, and the pages' budget is 64 MiB.
    assert!(
        grown.is_none_or(|grown| grown < (4 * 64 * 256 + 64 * 1024 + 64 * 1024) * 1024),
        "grown by {grown:?} bytes"
    );
    assert!(slowest < Duration::from_secs(20), "{slowest:?}");
}
