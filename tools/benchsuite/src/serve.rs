//! `serve`: from the points of a stroke that a client sends to the page frame that it gets back, on this machine, through the CPU back end; alone,
//! and while seven others paint. Beside it the time of a message that nothing is done for.

use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use orogeny_engine::{Adapter, Presets, Settings, Terrain, TerrainGrid};
use orogeny_service::{FrameHeader, Limits, Running, ServiceOptions};
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::measure::Times;
use crate::report::{Figure, Report};

const SIDE: u64 = 2048;
const RADIUS_M: f64 = 64.0;
/// Points of a stroke, each a message of its own.
const POINTS: u32 = 16;
/// Strokes for each of the repetitions that are asked for.
const STROKES: usize = 4;
const NUM_OTHERS: u64 = 7;
/// Between the points of the others, as a pointer gives them.
const OTHERS_EVERY: Duration = Duration::from_millis(16);
const WAIT: Duration = Duration::from_secs(60);

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("t.orogeny");
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    Terrain::create(&path, TerrainGrid::new(SIDE, SIDE, 1.0)?, 0.0, settings.clone())?.close()?;
    let running = Running::start(ServiceOptions {
        terrains: vec![path],
        address: ([127, 0, 0, 1], 0).into(),
        token: None,
        files: None,
        limits: Limits::default(),
        settings,
        presets: Presets::open(None),
    })?;
    let mut client = Client::new(running.address(), "measured")?;
    client.look_at([0.0, 0.0, 1024.0, 1024.0])?;

    let mut bare = Times::default();
    for _ in 0..repeat * 20 {
        bare.measure(|| client.ask_nothing())?;
    }
    let mut alone = Times::default();
    for stroke in 0..repeat * STROKES {
        client.draw(stroke as u64, &mut alone)?;
    }
    let is_over = Arc::new(AtomicBool::new(false));
    let others: Vec<_> = (1..=NUM_OTHERS)
        .map(|other| {
            let (address, is_over) = (running.address(), Arc::clone(&is_over));
            thread::spawn(move || paint_until(&is_over, address, other))
        })
        .collect();
    thread::sleep(Duration::from_millis(500));
    let mut among = Times::default();
    for stroke in 0..repeat * STROKES {
        client.draw(1_000_000 + stroke as u64, &mut among)?;
    }
    is_over.store(true, Ordering::SeqCst);
    for other in others {
        other.join().map_err(|_| anyhow::anyhow!("a client panicked"))??;
    }
    for (name, times) in [
        ("a message that nothing is done for", &bare),
        ("points to page frame, radius 64, alone", &alone),
        ("points to page frame, radius 64, of eight", &among),
    ] {
        report.add(Figure::time(format!("serve {name}"), times));
        report.add(Figure::percentile(format!("serve {name}, 99th percentile"), times, 0.99));
    }
    report.add(Figure::ratio(
        "serve points to page frame, of a bare message".to_owned(),
        vec![alone.median_s() / bare.median_s()],
    ));
    running.stop()?;
    Ok(())
}

/// Paints strokes one after another, as a person would, and looks at what there is.
fn paint_until(is_over: &AtomicBool, address: SocketAddr, number: u64) -> Result<()> {
    let mut client = Client::new(address, &format!("other {number}"))?;
    client.look_at([0.0, 0.0, 2048.0, 2048.0])?;
    let mut id = 0;
    while !is_over.load(Ordering::SeqCst) {
        id += 1;
        client.begin(id)?;
        for point in 0..POINTS {
            client.points(id, &[place(number * 7 + id, point)])?;
            thread::sleep(OTHERS_EVERY);
        }
        client.say(&json!({ "type": "end_stroke", "id": id }))?;
        client.until(|event| event["id"] == id && (event["event"] == "done" || event["event"] == "error"))?;
    }
    Ok(())
}

/// Where a stroke's points lie: within the pages that are looked at, over their borders.
fn place(stroke: u64, point: u32) -> [f64; 2] {
    let start = [200 + (stroke * 131) % 400, 200 + (stroke * 71) % 500];
    // Further apart than the brush's instances, so that every point is seen.
    [start[0] as f64 + 20.0 * f64::from(point), start[1] as f64 + 12.0 * f64::from(point)]
}

struct Client {
    socket: WebSocket<TcpStream>,
    num_frames: u64,
    /// The revision of the last frame.
    revision: u64,
}

impl Client {
    fn new(address: SocketAddr, author: &str) -> Result<Self> {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(WAIT))?;
        let author = author.replace(' ', "%20");
        let url = format!("ws://{address}/v1/terrains/t/live?author={author}");
        let (socket, _) = tungstenite::client(url, stream).map_err(|err| anyhow::anyhow!("{err}"))?;
        let mut client = Self { socket, num_frames: 0, revision: 0 };
        client.until(|event| event["event"] == "hello")?;
        Ok(client)
    }

    fn say(&mut self, message: &Value) -> Result<()> {
        Ok(self.socket.send(Message::text(message.to_string()))?)
    }

    /// The next event; `None` for a frame, which is acknowledged.
    fn hear(&mut self) -> Result<Option<Value>> {
        match self.socket.read()? {
            Message::Text(text) => Ok(Some(serde_json::from_str(&text)?)),
            Message::Binary(bytes) => {
                let (header, _) = FrameHeader::read(&bytes).context("what came is no frame")?;
                self.revision = self.revision.max(header.revision);
                self.num_frames += 1;
                self.say(&json!({ "type": "ack", "frames": self.num_frames }))?;
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    fn until(&mut self, is_it: impl Fn(&Value) -> bool) -> Result<Value> {
        let start = Instant::now();
        while start.elapsed() < WAIT {
            if let Some(event) = self.hear()?
                && is_it(&event)
            {
                return Ok(event);
            }
        }
        anyhow::bail!("an event did not come")
    }

    fn look_at(&mut self, region_m: [f64; 4]) -> Result<()> {
        self.say(&json!({ "type": "subscribe", "region": region_m, "window": 64 }))?;
        let num_pages = (region_m[2] / 256.0) * (region_m[3] / 256.0);
        while (self.num_frames as f64) < num_pages {
            self.hear()?;
        }
        Ok(())
    }

    /// A message, and an answer for which nothing was done.
    fn ask_nothing(&mut self) -> Result<()> {
        self.say(&json!({ "type": "nothing" }))?;
        self.until(|event| event["event"] == "error").map(drop)
    }

    fn begin(&mut self, id: u64) -> Result<()> {
        let brush = json!({ "type": "raise", "radius": RADIUS_M, "strength": 1 });
        self.say(
            &json!({ "type": "begin_stroke", "id": id, "operation": { "op": "stroke", "brush": brush } }),
        )
    }

    fn points(&mut self, id: u64, points: &[[f64; 2]]) -> Result<()> {
        self.say(&json!({ "type": "points", "id": id, "points": points }))
    }

    /// Draws a stroke, and measures from each of its points to the first frame that is newer. The first points come together: what lies between two is drawn
    /// once the third is known.
    fn draw(&mut self, id: u64, times: &mut Times) -> Result<()> {
        self.begin(id)?;
        self.points(id, &[0, 1, 2].map(|point| place(id, point)))?;
        self.await_newer(self.revision)?;
        for point in 3..POINTS {
            // What came of the points before has all come.
            self.settle()?;
            let before = self.revision;
            let start = Instant::now();
            self.points(id, &[place(id, point)])?;
            self.await_newer(before)?;
            times.add(start.elapsed().as_secs_f64());
        }
        self.say(&json!({ "type": "end_stroke", "id": id }))?;
        let end =
            self.until(|event| event["id"] == id && (event["event"] == "done" || event["event"] == "error"))?;
        ensure!(end.get("event").is_some_and(|event| event == "done"), "{end}");
        Ok(())
    }

    fn await_newer(&mut self, revision: u64) -> Result<()> {
        let start = Instant::now();
        while self.revision <= revision {
            self.hear()?;
            ensure!(start.elapsed() < WAIT, "no frame came");
        }
        Ok(())
    }

    /// An answer comes after all that was on its way before it.
    fn settle(&mut self) -> Result<()> {
        self.ask_nothing()?;
        self.ask_nothing()
    }
}
