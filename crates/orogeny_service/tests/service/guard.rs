//! Who is let in.

use orogeny_service::{Limits, Running, ServiceOptions, Token};

use crate::support::{Live, Served, TOKEN, settings};

const WRONG: &str = "Bearer another-token-0123456789";

#[test]
fn without_the_token_nothing_is_told_of_any_terrain() {
    let served = Served::with(Limits::default(), Some(TOKEN));
    for path in ["/", "/healthz", "/openapi.json", "/page/page.css"] {
        assert_eq!(served.ask("GET", path, &[("authorization", "")], Vec::new()).status, 200, "{path}");
    }
    let calls = [
        ("GET", "/v1/terrains"),
        ("GET", "/v1/terrains/t"),
        ("GET", "/v1/terrains/none"),
        ("GET", "/v1/brushes"),
        ("GET", "/metrics"),
        ("GET", "/v1/terrains/t/heights"),
        ("PUT", "/v1/terrains/t/heights"),
        ("POST", "/v1/terrains/t/operations"),
        ("POST", "/v1/terrains/t/undo"),
        ("POST", "/v1/terrains/t/redo"),
        ("GET", "/v1/terrains/t/history"),
        ("GET", "/v1/terrains/t/live"),
        ("GET", "/nothing"),
    ];
    let basic = format!("Basic {TOKEN}");
    for (method, path) in calls {
        for header in ["", WRONG, TOKEN, "Bearer", "Bearer ", &basic] {
            // What is wrong with the body is not even looked at.
            let body = if method == "GET" { Vec::new() } else { b"{".to_vec() };
            let answer = served.ask(method, path, &[("authorization", header)], body);
            assert_eq!(answer.error(401), "token", "{method} {path} with {header:?}");
        }
        let lower = format!("bearer {TOKEN}");
        let answer = served.ask(method, path, &[("authorization", &lower)], b" ".to_vec());
        assert_ne!(answer.status, 401, "{method} {path}");
    }
    for query in ["token", "access_token", "Authorization", "bearer"] {
        let path = format!("/v1/terrains?{query}={TOKEN}");
        assert_eq!(
            served.ask("GET", &path, &[("authorization", "")], Vec::new()).error(400),
            "token_in_address"
        );
    }
    let metrics = String::from_utf8(served.get("/metrics").body).unwrap();
    assert!(!metrics.contains(TOKEN));
}

#[test]
fn the_live_channel_takes_the_token_as_a_subprotocol() {
    let served = Served::with(Limits::default(), Some(TOKEN));
    let mut live = served.live("ann");
    live.until("status");
    for token in [None, Some("another-token-0123456789")] {
        let refused = Live::try_open(served.address, "/v1/terrains/t/live", token).err().unwrap();
        let tungstenite::Error::Http(answer) = refused else { panic!("{refused}") };
        assert_eq!(answer.status(), 401);
    }
}

#[test]
fn pages_of_other_sites_are_refused() {
    let served = Served::new();
    let own = format!("http://{}", served.address);
    let get = |headers: &[(&str, &str)]| served.ask("GET", "/v1/terrains", headers, Vec::new());
    assert_eq!(get(&[("origin", &own)]).status, 200);
    for origin in ["https://evil.example", "null", "http://127.0.0.1:1", "http://localhost.evil.example"] {
        assert_eq!(get(&[("origin", origin)]).error(403), "origin", "{origin}");
    }
    for host in ["evil.example", "127.0.0.1.evil.example:80", "192.168.1.1"] {
        assert_eq!(get(&[("host", host)]).error(403), "host", "{host}");
    }
    let port = served.address.port();
    for host in [format!("localhost:{port}"), "[::1]:80".to_owned()] {
        assert_eq!(get(&[("host", &host)]).status, 200, "{host}");
    }
    use tungstenite::client::IntoClientRequest as _;
    let mut request = format!("ws://{}/v1/terrains/t/live", served.address).into_client_request().unwrap();
    request.headers_mut().insert("origin", "https://evil.example".parse().unwrap());
    let refused = Live::open(served.address, request).err().unwrap();
    let tungstenite::Error::Http(answer) = refused else { panic!("{refused}") };
    assert_eq!(answer.status(), 403);
}

#[test]
fn other_machines_need_a_token_and_terrains_a_name() {
    let served = Served::new();
    let options = |terrains: Vec<std::path::PathBuf>, ip: [u8; 4], token: Option<Token>| ServiceOptions {
        terrains,
        address: (ip, 0).into(),
        token,
        files: None,
        limits: Limits::default(),
        settings: settings(),
        presets: orogeny_engine::Presets::open(None),
    };
    let refused = |options| Running::start(options).unwrap_err().to_string();
    let open = refused(options(vec![served.path()], [0, 0, 0, 0], None));
    assert!(open.contains("--token-file"), "{open}");
    assert!(refused(options(Vec::new(), [127, 0, 0, 1], None)).contains("no terrain"));
    let locked = refused(options(vec![served.path()], [127, 0, 0, 1], None));
    assert!(locked.contains("t.orogeny"), "{locked}");
    let odd = served.folder.path().join("a?b.orogeny");
    assert!(refused(options(vec![odd], [127, 0, 0, 1], None)).contains("no name"));
    let taken = Running::start(ServiceOptions {
        address: served.address,
        ..options(Vec::new(), [127, 0, 0, 1], None)
    });
    assert!(taken.is_err());
}
