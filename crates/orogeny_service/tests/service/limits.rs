//! How much is let in, and what is told where it is too much.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use orogeny_service::Limits;
use serde_json::json;
use tungstenite::Message;

use crate::support::{Live, Served, WAIT, raise};

fn connect(served: &Served) -> TcpStream {
    let stream = TcpStream::connect(served.address).unwrap();
    stream.set_read_timeout(Some(WAIT)).unwrap();
    stream
}

/// What comes until the other side closes.
fn rest(mut stream: TcpStream) -> String {
    let mut bytes = Vec::new();
    // Whatever is reset after the answer has come all the same.
    stream.read_to_end(&mut bytes).ok();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn a_body_is_bounded_in_length_whether_it_says_so_or_not() {
    let served = Served::with(Limits { body_in_bytes: 10_000, ..Limits::default() }, None);
    let long = served.put("/v1/terrains/t/heights?width=60&depth=60", vec![0; 14_400]);
    assert_eq!(long.error(413), "body_too_long");
    assert_eq!(long.json()["error"]["limit"], 10_000);
    // Four gibibytes are claimed, and none of them is waited for.
    let mut stream = connect(&served);
    let head = format!("POST /v1/terrains/t/operations HTTP/1.1\r\nhost: {}\r\n", served.address);
    stream.write_all(format!("{head}content-length: 4294967296\r\n\r\n{{").as_bytes()).unwrap();
    let start = Instant::now();
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 413");
    assert!(start.elapsed() < Duration::from_secs(10));
    // A length that is not told beforehand.
    let mut stream = connect(&served);
    stream.write_all(format!("{head}transfer-encoding: chunked\r\n\r\n").as_bytes()).unwrap();
    for _ in 0..40 {
        // It may have hung up by now.
        let chunk = format!("200\r\n{}\r\n", "x".repeat(512));
        if stream.write_all(chunk.as_bytes()).is_err() {
            break;
        }
    }
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 413");
    assert_eq!(served.get("/healthz").status, 200);
}

#[test]
fn who_speaks_too_slowly_is_not_waited_for() {
    let limits =
        Limits { head: Duration::from_millis(300), body: Duration::from_millis(300), ..Limits::default() };
    let served = Served::with(limits, None);
    let mut stream = connect(&served);
    let start = Instant::now();
    for byte in b"GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-slow: " {
        if stream.write_all(&[*byte]).is_err() {
            break;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    rest(stream);
    assert!(start.elapsed() < Duration::from_secs(20), "the head was waited for");
    let mut stream = connect(&served);
    let head = format!(
        "POST /v1/terrains/t/operations HTTP/1.1\r\nhost: {}\r\nconnection: close\r\n",
        served.address
    );
    stream.write_all(format!("{head}content-length: 100\r\n\r\n{{").as_bytes()).unwrap();
    let answer = rest(stream);
    assert!(answer.starts_with("HTTP/1.1 408") && answer.contains("body_too_slow"), "{answer}");
    assert_eq!(served.get("/healthz").status, 200);
}

#[test]
fn connections_are_bounded_and_live_ones_count() {
    let served = Served::with(Limits { connections: 3, ..Limits::default() }, None);
    let mut lives: Vec<Live> = (0..3).map(|k| served.live(&format!("c{k}"))).collect();
    let refused = served.get("/healthz");
    assert_eq!(refused.error(429), "too_many_connections");
    assert_eq!(refused.json()["error"]["limit"], 3);
    let mut last = lives.pop().unwrap();
    last.say(&json!({ "type": "unsubscribe" }));
    drop(last);
    let start = Instant::now();
    while served.get("/healthz").status != 200 {
        assert!(start.elapsed() < WAIT, "a place was not given back");
        std::thread::sleep(Duration::from_millis(10));
    }
    lives[0].draw(1, &raise(40.0, 2.0), &[[100.0, 100.0]]);
    lives[0].done(1);
}

#[test]
fn what_a_client_asks_for_is_bounded() {
    let limits = Limits {
        tasks_per_client: 4,
        points_per_client: 100,
        pages_per_subscription: 8,
        samples_per_answer: 100_000,
        ..Limits::default()
    };
    let served = Served::with(limits, None);
    let big = served.get("/v1/terrains/t/heights");
    assert_eq!(big.error(413), "too_many_samples");
    assert_eq!(big.json()["error"]["limit"], 100_000);
    assert_eq!(served.get("/v1/terrains/t/heights?level=2").status, 200);

    let mut ann = served.live("ann");
    ann.say(&json!({ "type": "subscribe" }));
    let error = ann.until("error");
    assert_eq!((&error["code"], &error["limit"]), (&json!("too_many_pages"), &json!(8)));

    let begin = |id: u64| json!({ "type": "begin_stroke", "id": id, "operation": { "op": "stroke", "brush": raise(40.0, 2.0) } });
    for id in 1..=4 {
        ann.say(&begin(id));
    }
    ann.say(&begin(4));
    assert_eq!(ann.until("error")["code"], "too_many_tasks");
    let points: Vec<_> = (0..101).map(|k| [100 + k, 100]).collect();
    ann.say(&json!({ "type": "points", "id": 2, "points": points }));
    let error = ann.until("error");
    assert_eq!(
        (&error["code"], &error["id"], &error["limit"]),
        (&json!("too_many_points"), &json!(2), &json!(100))
    );
    ann.say(&json!({ "type": "cancel_stroke", "id": 1 }));
    ann.end_of(1);
    assert_eq!(ann.end_of(2)["code"], "cancelled");
    ann.say(&begin(4));
    assert_eq!(ann.until("error")["code"], "id_in_use");
}

#[test]
fn a_message_that_is_too_long_ends_the_connection_and_no_other() {
    let served = Served::with(Limits { message_in_bytes: 4096, ..Limits::default() }, None);
    let [mut ann, mut bob] = ["ann", "bob"].map(|author| served.live(author));
    ann.send(Message::text(format!("{{\"type\": \"{}\"}}", "x".repeat(5000))));
    assert_eq!(ann.closed(), 1002);
    bob.draw(1, &raise(40.0, 2.0), &[[100.0, 100.0]]);
    bob.done(1);
}

#[test]
fn half_and_false_frames_of_a_websocket_end_their_connection_and_no_other() {
    let served = Served::new();
    let mut bob = served.live("bob");
    let head = format!(
        "GET /v1/terrains/t/live HTTP/1.1\r\nhost: {}\r\nupgrade: websocket\r\nconnection: upgrade\r\nsec-websocket-version: \
         13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        served.address
    );
    let frames: [&[u8]; 7] = [
        // 4 GiB are claimed, masked; 2^63; a reserved opcode; reserved bits; not masked; a close of one byte; half a head.
        &[0x81, 0xff, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 3, 4, b'{'],
        &[0x82, 0xff, 0x80, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4],
        &[0x83, 0x80, 1, 2, 3, 4],
        &[0xf1, 0x80, 1, 2, 3, 4],
        &[0x81, 0x02, b'{', b'}'],
        &[0x88, 0x81, 0, 0, 0, 0, 1],
        &[0x81],
    ];
    for frame in frames {
        let mut stream = connect(&served);
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(frame).unwrap();
        // What is only half there is no fault before its end.
        if frame.len() == 1 {
            stream.shutdown(std::net::Shutdown::Write).unwrap();
        }
        // It ends by the other side's doing.
        let answer = rest(stream);
        assert!(answer.starts_with("HTTP/1.1 101"), "{answer}");
    }
    bob.draw(1, &raise(40.0, 2.0), &[[100.0, 100.0]]);
    bob.done(1);
    bob.until_alone();
}

#[test]
fn what_all_clients_ask_for_is_bounded_too() {
    let served = Served::with(Limits { tasks_per_terrain: 3, ..Limits::default() }, None);
    let [mut ann, mut bob] = ["ann", "bob"].map(|author| served.live(author));
    let begin = |id: u64| json!({ "type": "begin_stroke", "id": id, "operation": { "op": "stroke", "brush": raise(40.0, 2.0) } });
    // All by one, whom no one keeps waiting: else the first of them would be ended for the others' sake.
    for id in 1..=3 {
        ann.say(&begin(id));
    }
    ann.say(&json!({ "type": "nothing" }));
    ann.until("error");
    bob.say(&begin(1));
    let error = bob.until("error");
    assert_eq!(
        (&error["code"], &error["limit"], &error["id"]),
        (&json!("too_many_tasks"), &json!(3), &json!(1))
    );
    let body = json!({ "operations": [{ "op": "fill", "brush": raise(40.0, 2.0) }] });
    assert_eq!(served.post("/v1/terrains/t/operations", &body).error(429), "too_many_tasks");
    for id in 1..=3 {
        ann.say(&json!({ "type": "cancel_stroke", "id": id }));
        ann.end_of(id);
    }
    served.post("/v1/terrains/t/operations", &body).ok();
}

#[test]
fn what_a_client_sends_is_not_said_back_at_length() {
    let served = Served::new();
    let mut ann = served.live("ann");
    ann.send(Message::text(format!("{{\"type\": \"{}\"}}", "x".repeat(500_000))));
    let error = ann.until("error");
    assert!(error["message"].as_str().unwrap().len() < 1100);
}
