//! What is logged, and what never is.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;

use super::{Serving, WAIT};
use crate::program::Folder;

const TOKEN: &str = "a-token-that-no-log-holds-0123";
const WRONG: &str = "another-token-of-someone-4567";

/// The status of an answer.
fn get(address: &str, path: &str, headers: &str) -> u16 {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(WAIT)).unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n{headers}\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(!answer.contains(TOKEN) && !answer.contains(WRONG), "{answer}");
    answer.split(' ').nth(1).unwrap().parse().unwrap()
}

#[test]
fn tokens_are_in_no_log_and_requests_are() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    folder.write("token", format!("{TOKEN}\n"));
    let serving = Serving::start(&folder, "--token-file token -vv");
    let bearer = |token: &str| format!("authorization: Bearer {token}\r\n");
    let status = |path: &str, headers: &str| get(&serving.address, path, headers);
    assert_eq!(status("/v1/terrains/t", &bearer(TOKEN)), 200);
    assert_eq!(status("/v1/terrains/t", &bearer(WRONG)), 401);
    assert_eq!(status("/v1/terrains/t", ""), 401);
    assert_eq!(status(&format!("/v1/terrains/t?token={TOKEN}"), &bearer(TOKEN)), 400);
    let live = format!("upgrade: websocket\r\nsec-websocket-protocol: orogeny.v1, bearer.{WRONG}\r\n");
    assert_eq!(status("/v1/terrains/t/live", &live), 401);
    serving.stop();
    let log = String::from_utf8(folder.read("serve.log")).unwrap();
    assert!(!log.contains(TOKEN) && !log.contains(WRONG), "{log}");
    let requests: Vec<_> = log.lines().filter(|line| line.contains("request")).collect();
    assert!(
        requests.iter().any(|line| line.contains("path=\"/v1/terrains/t\"") && line.contains("status=401")),
        "{log}"
    );
}

#[test]
fn a_token_that_is_none_is_refused_before_anything_is_served() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    folder.write("short", "secret\n");
    let refused = folder.command("serve t.orogeny --listen 127.0.0.1:0 --token-file short").output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && said.contains("at least 16"), "{said}");
    let open = folder.command("serve t.orogeny --listen 0.0.0.0:0").output().unwrap();
    let said = String::from_utf8_lossy(&open.stderr).into_owned();
    assert!(!open.status.success() && said.contains("--token-file"), "{said}");
}
