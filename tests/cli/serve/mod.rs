//! The service as its users run it: the real program, killed, and driven by its clients.

mod clients;
mod kill;
mod logs;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::program::Folder;

const WAIT: Duration = Duration::from_secs(60);

/// `orogeny serve`, which ends with the test.
struct Serving {
    child: Child,
    address: String,
}

impl Drop for Serving {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

impl Serving {
    /// Serves `t.orogeny` of the folder.
    fn start(folder: &Folder, more: &str) -> Self {
        Self::start_at(folder, "127.0.0.1:0", more)
    }

    /// Serves it at an address, as where it was before.
    fn start_at(folder: &Folder, address: &str, more: &str) -> Self {
        let mut command = folder.command(&format!("serve t.orogeny --listen {address} --json {more}"));
        command.stdout(Stdio::piped()).stderr(std::fs::File::create(folder.path("serve.log")).unwrap());
        let mut child = command.spawn().unwrap();
        let mut report = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        while !report.contains("\n}") {
            if output.read_line(&mut report).unwrap() == 0 {
                panic!("it did not start: {}", String::from_utf8_lossy(&folder.read("serve.log")));
            }
        }
        let report: Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["terrains"], json!(["t"]));
        Self { child, address: report["address"].as_str().unwrap().to_owned() }
    }

    fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Asks it to stop, as the system would, and waits for the end.
    fn stop(mut self) {
        let id = self.child.id().to_string();
        let asked = std::process::Command::new("kill").args(["-TERM", &id]).status().unwrap();
        assert!(asked.success());
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < WAIT, "it did not stop");
            std::thread::sleep(Duration::from_millis(20));
        };
        assert!(status.success(), "{status}");
    }
}

/// Waits for something.
fn until(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < WAIT, "never: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The answer to a request, `None` where the other side was gone before it had come whole.
fn post(address: &str, path: &str, body: &Value) -> Option<Value> {
    let body = body.to_string();
    let mut stream = TcpStream::connect(address).ok()?;
    stream.set_read_timeout(Some(WAIT)).ok()?;
    let head = format!(
        "POST {path} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).ok()?;
    stream.write_all(body.as_bytes()).ok()?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).ok()?;
    let (head, content) = answer.split_once("\r\n\r\n")?;
    let content = serde_json::from_str(content).ok()?;
    assert!(head.starts_with("HTTP/1.1 200"), "{head}: {content}");
    Some(content)
}
