//! A service on a port of its own, and clients for it.

use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpStream};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use orogeny_engine::{Adapter, Presets, Settings, Terrain, TerrainGrid};
use orogeny_service::{FrameFormat, FrameHeader, Limits, Running, ServiceOptions, Token};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

/// How long anything may take.
pub const WAIT: Duration = Duration::from_secs(60);
pub const TOKEN: &str = "a-token-of-tests-0123456789";

pub fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() }
}

/// A service with one terrain, `t`, of 700 × 600 samples 2 m apart.
pub struct Served {
    pub folder: tempfile::TempDir,
    pub running: Option<Running>,
    pub address: SocketAddr,
    pub token: Option<&'static str>,
}

impl Served {
    pub fn new() -> Self {
        Self::with(Limits::default(), None)
    }

    pub fn with(limits: Limits, token: Option<&'static str>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let grid = TerrainGrid::new(700, 600, 2.0).unwrap();
        Terrain::create(&folder.path().join("t.orogeny"), grid, 100.0, settings()).unwrap().close().unwrap();
        let mut served = Self { folder, running: None, address: ([127, 0, 0, 1], 0).into(), token };
        served.start(limits);
        served
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("t.orogeny")
    }

    pub fn start(&mut self, limits: Limits) {
        let options = ServiceOptions {
            terrains: vec![self.path()],
            address: ([127, 0, 0, 1], 0).into(),
            token: self.token.map(|token| Token::new(token).unwrap()),
            files: Some(self.folder.path().join("files")),
            limits,
            settings: settings(),
            presets: Presets::open(None),
        };
        let running = Running::start(options).unwrap();
        self.address = running.address();
        self.running = Some(running);
    }

    /// Stops it, and gives the terrain as it is on disk.
    pub fn stop(&mut self) -> Terrain {
        self.running.take().unwrap().stop().unwrap();
        assert_eq!(Terrain::check(&self.path()).unwrap().problems.len(), 0);
        Terrain::open_to_read(&self.path(), settings()).unwrap()
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], Vec::new())
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        self.ask("POST", path, &[], body.to_string().into_bytes())
    }

    pub fn put(&self, path: &str, body: Vec<u8>) -> Answer {
        self.ask("PUT", path, &[], body)
    }

    /// With the token, unless the headers have one.
    pub fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: Vec<u8>) -> Answer {
        let config = ureq::Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .timeout_global(Some(WAIT))
            .build();
        let mut request =
            ureq::http::Request::builder().method(method).uri(format!("http://{}{path}", self.address));
        if let Some(token) = self.token.filter(|_| headers.iter().all(|(name, _)| *name != "authorization")) {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        for (name, value) in headers.iter().filter(|(_, value)| !value.is_empty()) {
            request = request.header(*name, *value);
        }
        let agent = ureq::Agent::new_with_config(config);
        let mut answer = if body.is_empty() && method == "GET" {
            agent.run(request.body(()).unwrap())
        } else {
            agent.run(request.body(body).unwrap())
        }
        .unwrap();
        let headers = answer
            .headers()
            .iter()
            .map(|(name, value)| (name.to_string(), value.to_str().unwrap().to_owned()))
            .collect();
        let body = answer.body_mut().with_config().limit(1 << 30).read_to_vec().unwrap();
        Answer { status: answer.status().as_u16(), headers, body }
    }

    pub fn live(&self, author: &str) -> Live {
        let mut live =
            Live::try_open(self.address, &format!("/v1/terrains/t/live?author={author}"), self.token)
                .unwrap();
        live.hello = live.until("hello");
        live
    }
}

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: BTreeMap<String, String>,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|err| panic!("{err}: {self:?}"))
    }

    /// The body of an answer that is good.
    pub fn ok(&self) -> Value {
        let json = self.json();
        assert_eq!(self.status, 200, "{json}");
        json
    }

    /// The code of an error of that status, whose message and limit are there where they should be.
    pub fn error(&self, status: u16) -> String {
        let json = self.json();
        assert_eq!(self.status, status, "{json}");
        assert!(json["error"]["message"].as_str().is_some_and(|message| message.len() > 10), "{json}");
        json["error"]["code"].as_str().unwrap().to_owned()
    }

    pub fn floats(&self) -> Vec<f32> {
        assert_eq!(self.status, 200, "{:?}", String::from_utf8_lossy(&self.body));
        self.body.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
    }
}

/// A client of the live channel.
pub struct Live {
    socket: WebSocket<TcpStream>,
    pub hello: Value,
    pub num_frames: u64,
    /// Whether frames are acknowledged as they come.
    pub acknowledges: bool,
    /// What frames have brought, by page.
    pub pages: BTreeMap<(u32, u32), (FrameHeader, Vec<f32>)>,
    /// Every event so far.
    pub events: Vec<Value>,
}

impl Live {
    pub fn try_open(
        address: SocketAddr,
        path: &str,
        token: Option<&str>,
    ) -> Result<Self, tungstenite::Error> {
        let mut request = format!("ws://{address}{path}").into_client_request()?;
        if let Some(token) = token {
            let protocols = format!("orogeny.v1, bearer.{token}");
            request.headers_mut().insert("sec-websocket-protocol", protocols.parse().unwrap());
        }
        Self::open(address, request)
    }

    pub fn open(
        address: SocketAddr,
        request: tungstenite::handshake::client::Request,
    ) -> Result<Self, tungstenite::Error> {
        let stream = TcpStream::connect(address)?;
        stream.set_read_timeout(Some(WAIT))?;
        stream.set_nodelay(true)?;
        let (socket, _) = tungstenite::client(request, stream).map_err(|err| match err {
            tungstenite::HandshakeError::Failure(err) => err,
            tungstenite::HandshakeError::Interrupted(_) => panic!("the handshake took too long"),
        })?;
        Ok(Self {
            socket,
            hello: Value::Null,
            num_frames: 0,
            acknowledges: true,
            pages: BTreeMap::new(),
            events: Vec::new(),
        })
    }

    pub fn say(&mut self, message: &Value) {
        self.send(Message::text(message.to_string()));
    }

    pub fn send(&mut self, message: Message) {
        self.socket.send(message).unwrap();
    }

    /// The next event, or `None` for a frame, which is kept.
    pub fn hear(&mut self) -> Option<Value> {
        match self.socket.read().unwrap() {
            Message::Text(text) => {
                let event: Value = serde_json::from_str(&text).unwrap();
                self.events.push(event.clone());
                Some(event)
            }
            Message::Binary(bytes) => {
                self.num_frames += 1;
                let Some((header, payload)) = FrameHeader::read(&bytes) else {
                    panic!("{bytes:?} is no frame")
                };
                assert_eq!(header.format, FrameFormat::R32);
                let heights =
                    payload.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
                if let Some((before, _)) = self.pages.insert((header.x, header.z), (header, heights)) {
                    assert!(before.revision <= header.revision, "a page came older than it was");
                }
                if self.acknowledges {
                    self.say(&json!({ "type": "ack", "frames": self.num_frames }));
                }
                None
            }
            Message::Ping(_) | Message::Pong(_) => None,
            other => panic!("{other:?}"),
        }
    }

    /// The code that the connection is closed with.
    pub fn closed(&mut self) -> u16 {
        let start = Instant::now();
        while start.elapsed() < WAIT {
            match self.socket.read() {
                Ok(Message::Close(frame)) => return frame.map_or(0, |frame| frame.code.into()),
                Ok(_) => {}
                Err(err) => panic!("it ended without a code: {err}"),
            }
        }
        panic!("it was not closed");
    }

    /// The next event of that name.
    pub fn until(&mut self, name: &str) -> Value {
        self.until_event(|event| event["event"] == name)
    }

    /// How what was asked for as `id` ended.
    pub fn end_of(&mut self, id: u64) -> Value {
        self.until_event(|event| event["id"] == id && (event["event"] == "done" || event["event"] == "error"))
    }

    pub fn done(&mut self, id: u64) -> Value {
        let end = self.end_of(id);
        assert_eq!(end["event"], "done", "{end}");
        end
    }

    pub fn until_event(&mut self, is_it: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            if let Some(event) = self.hear()
                && is_it(&event)
            {
                return event;
            }
            assert!(start.elapsed() < WAIT, "it did not come; heard {:?}", self.events);
        }
    }

    /// The last event of that name so far.
    pub fn last(&self, name: &str) -> Value {
        self.events.iter().rev().find(|event| event["event"] == name).cloned().unwrap_or_default()
    }

    /// Hears until no one else is there.
    pub fn until_alone(&mut self) {
        while self.last("clients")["clients"].as_array().is_none_or(|clients| clients.len() != 1) {
            self.hear();
        }
    }

    /// Hears until what the frames have brought fulfils a condition.
    pub fn until_pages(&mut self, is_so: impl Fn(&BTreeMap<(u32, u32), (FrameHeader, Vec<f32>)>) -> bool) {
        let start = Instant::now();
        while !is_so(&self.pages) {
            self.hear();
            assert!(start.elapsed() < WAIT, "the pages did not come; heard {:?}", self.events);
        }
    }

    /// Begins, draws and ends a stroke, without waiting for its end.
    pub fn draw(&mut self, id: u64, brush: &Value, points: &[[f64; 2]]) {
        let operation = json!({ "op": "stroke", "seed": id, "brush": brush });
        self.say(&json!({ "type": "begin_stroke", "id": id, "operation": operation }));
        for points in points.chunks(2) {
            self.say(&json!({ "type": "points", "id": id, "points": points }));
        }
        self.say(&json!({ "type": "end_stroke", "id": id }));
    }

    /// What the frames of level 0 of all of the terrain have brought.
    pub fn heights(&self, width: usize, depth: usize) -> Vec<f32> {
        let mut heights = vec![f32::NAN; width * depth];
        for (header, page) in self.pages.values() {
            assert_eq!(header.level, 0);
            let (x0, z0) = (header.x as usize * 256, header.z as usize * 256);
            for (row, samples) in page.chunks(header.width.into()).enumerate() {
                let at = (z0 + row) * width + x0;
                heights[at..at + samples.len()].copy_from_slice(samples);
            }
        }
        heights
    }
}

pub fn raise(radius_m: f64, strength_m: f64) -> Value {
    json!({ "type": "raise", "radius": radius_m, "strength": strength_m })
}

/// All heights of a terrain.
pub fn heights_of(terrain: &Terrain) -> Vec<f32> {
    terrain.heights(&orogeny_engine::ExportSource::Composite, None, 0).unwrap().2
}

/// Bits, for comparing.
pub fn bits(heights: &[f32]) -> Vec<u32> {
    heights.iter().map(|height| height.to_bits()).collect()
}
