//! The calls.

use serde_json::{Value, json};

use crate::support::{Served, bits, heights_of, raise};

const TERRAIN: &str = "/v1/terrains/t";

fn stroke(x_m: f64, z_m: f64) -> Value {
    json!({ "op": "stroke", "brush": raise(80.0, 10.0), "points": [[x_m, z_m]] })
}

#[test]
fn what_there_is_is_told() {
    let served = Served::new();
    assert_eq!(served.get("/healthz").ok()["status"], "ok");
    let list = served.get("/v1/terrains").ok();
    assert_eq!(list["terrains"][0]["name"], "t");
    let terrain = served.get(TERRAIN).ok();
    for (field, value) in
        [("width", 700.0), ("depth", 600.0), ("spacing", 2.0), ("page_size", 256.0), ("lowest", 100.0)]
    {
        assert_eq!(terrain[field].as_f64(), Some(value), "{field} of {terrain}");
    }
    assert_eq!(terrain["layers"][0]["name"], "Base");
    assert_eq!(terrain["levels"], 2);
    let brushes = served.get("/v1/brushes").ok();
    let schema = &brushes["brushes"][0]["schema"];
    assert_eq!(schema["properties"]["type"]["const"], brushes["brushes"][0]["type"]);
    let metrics = String::from_utf8(served.get("/metrics").body).unwrap();
    assert!(metrics.contains("orogeny_http_requests_total{status=\"200\"} 4"), "{metrics}");
    assert!(metrics.ends_with("# EOF\n"));
    let page = served.get("/");
    assert!(page.headers["content-security-policy"].contains("default-src 'self'"));
    assert!(String::from_utf8(page.body).unwrap().contains("<!doctype html>"));
    for (path, status) in
        [("/v2", 404), ("/v1/terrains/u", 404), ("/page/none.js", 404), ("/v1/terrains/t/undo", 405)]
    {
        served.get(path).error(status);
    }
}

#[test]
fn operations_are_done_together_and_on_disk_when_it_is_said() {
    let mut served = Served::new();
    let body = json!({ "operations": [stroke(200.0, 200.0), stroke(400.0, 200.0)], "author": "ann" });
    let done = served.post(&format!("{TERRAIN}/operations"), &body).ok();
    assert_eq!(done["entries"], json!([1, 2]));
    let rect: Vec<f64> = serde_json::from_value(done["rect"].clone()).unwrap();
    assert!(rect[0] <= 122.0 && rect[0] + rect[2] >= 478.0 && rect[2] < 400.0, "{rect:?}");
    assert_eq!(done["applied"][0]["brush"], "raise");
    assert!(done["revision"].as_u64() > Some(0));

    let bad = json!({ "operations": [stroke(200.0, 200.0), { "op": "set_layer", "layer": "None", "visible": false }] });
    assert_eq!(served.post(&format!("{TERRAIN}/operations"), &bad).error(422), "refused");
    for body in [json!({ "operations": [{ "op": "nothing" }] }), json!({ "operation": [] }), json!([1])] {
        served.post(&format!("{TERRAIN}/operations"), &body).error(400);
    }
    let history = served.get(&format!("{TERRAIN}/history")).ok();
    assert_eq!(history["head"], 2);
    assert_eq!(history["entries"].as_array().unwrap().len(), 2);
    assert_eq!(history["entries"][0]["author"], "ann");
    let before = served.get(&format!("{TERRAIN}/history?before=2&limit=5")).ok();
    assert_eq!(before["entries"][0]["entry"], 1);
    served.get(&format!("{TERRAIN}/history?limit=0")).error(400);
    let terrain = served.stop();
    assert_eq!(terrain.height_m([400.0, 200.0]).unwrap(), 110.0);
}

#[test]
fn undo_is_each_authors_own_unless_it_is_anyones() {
    let mut served = Served::new();
    let run = |author: &str, x_m: f64| {
        let body = json!({ "operations": [stroke(x_m, 200.0)], "author": author });
        served.post(&format!("{TERRAIN}/operations"), &body).ok();
    };
    let go = |what: &str, body: Value| served.post(&format!("{TERRAIN}/{what}"), &body);
    run("ann", 200.0);
    run("bob", 240.0);
    let undone = go("undo", json!({ "author": "ann" })).ok();
    assert_eq!(undone["entries"], json!([3]), "bob's stroke was done again");
    let redone = go("redo", json!({ "author": "ann" })).ok();
    assert_eq!(redone["entries"], json!([4]));
    go("undo", json!({ "anyone": true, "count": 2 })).ok();
    let history = served.get(&format!("{TERRAIN}/history")).ok();
    assert_eq!(history["head"], 0);
    assert_eq!(go("redo", json!({ "anyone": true, "count": 2 })).ok()["entries"], json!([]));
    assert_eq!(go("undo", json!({ "author": "nobody" })).ok()["entries"], json!([]));
    assert_eq!(go("undo", json!({ "count": 0 })).error(400), "count");
    assert_eq!(go("undo", json!({ "author": "x".repeat(65) })).error(400), "author");
    assert_eq!(go("undo", json!({ "cuont": 1 })).error(400), "not_understood");
    let terrain = served.stop();
    assert_eq!(terrain.height_m([240.0, 200.0]).unwrap(), 115.0);
}

#[test]
fn heights_are_read_as_they_are_and_written_as_they_come() {
    let mut served = Served::new();
    let body = json!({ "operations": [{ "op": "fill", "brush": { "type": "noise", "feature_size": 300, "strength": 50 } }] });
    served.post(&format!("{TERRAIN}/operations"), &body).ok();
    let all = served.get(&format!("{TERRAIN}/heights"));
    assert_eq!(
        (all.headers["orogeny-width"].as_str(), all.headers["orogeny-depth"].as_str()),
        ("700", "600")
    );
    let all = all.floats();
    let part = served.get(&format!("{TERRAIN}/heights?x=100&z=60&width=40&depth=20"));
    for (header, value) in [("x", "100"), ("z", "60"), ("width", "20"), ("depth", "10"), ("spacing", "2")] {
        assert_eq!(part.headers[&format!("orogeny-{header}")], value, "{header}");
    }
    let part = part.floats();
    let expected: Vec<f32> = (30..40).flat_map(|z| all[z * 700 + 50..z * 700 + 70].to_vec()).collect();
    assert_eq!(bits(&part), bits(&expected));
    let coarse = served.get(&format!("{TERRAIN}/heights?level=2&format=npy"));
    assert_eq!(
        (coarse.headers["orogeny-width"].as_str(), coarse.headers["orogeny-spacing"].as_str()),
        ("175", "8")
    );
    assert!(coarse.body.starts_with(b"\x93NUMPY"));
    let picture = served.get(&format!("{TERRAIN}/heights?format=png"));
    assert_eq!(picture.headers["content-type"], "image/png");
    let low: f32 = picture.headers["orogeny-low"].parse().unwrap();
    assert_eq!(low, all.iter().copied().fold(f32::INFINITY, f32::min));

    let raw: Vec<u8> = (0..30 * 20).flat_map(|k| (500.0 + k as f32).to_le_bytes()).collect();
    let written =
        served.put(&format!("{TERRAIN}/heights?x=600&z=400&width=30&depth=20&author=ann"), raw.clone()).ok();
    assert_eq!(written["entries"], json!([2]));
    let back = served.get(&format!("{TERRAIN}/heights?x=600&z=400&width=60&depth=40"));
    assert_eq!(back.body, raw);
    let coded: Vec<u8> = [0_u16, 65535, 32768, 1].into_iter().flat_map(u16::to_le_bytes).collect();
    let path = format!("{TERRAIN}/heights?x=0&z=0&width=2&depth=2&format=r16&low=0&high=65535&layer=New");
    served.put(&path, coded).ok();
    let layer = served.get(&format!("{TERRAIN}/heights?layer=New&width=4&depth=4")).floats();
    assert_eq!(layer, [0.0, 65535.0, 32768.0, 1.0]);
    let mask = served.get(&format!("{TERRAIN}/heights?mask=New&width=4&depth=4")).floats();
    assert_eq!(mask, [1.0; 4]);

    // More than a framework's own limit.
    let raw: Vec<u8> = (0..700 * 600 * 2).flat_map(|k| (k as f32).to_le_bytes()).collect();
    let over_all = served.put(&format!("{TERRAIN}/heights?width=700&depth=1200&author=ann"), raw).ok();
    assert_eq!(over_all["rect"], json!([0.0, 0.0, 1400.0, 1200.0]));
    served.post(&format!("{TERRAIN}/undo"), &json!({ "author": "ann" })).ok();
    // What was changed is told as far as it reaches.
    assert_eq!(written["rect"], json!([600.0, 400.0, 60.0, 40.0]));

    for (query, status) in [
        ("level=9", 400),
        ("level=-1", 400),
        ("x=nan", 400),
        ("x=1e9", 400),
        ("width=-5", 400),
        ("format=jpg", 400),
        ("layer=a&mask=b", 400),
        ("layer=None", 422),
        ("low=3", 400),
        ("format=r16&low=5&high=1", 400),
        ("colour=red", 400),
    ] {
        let answer = served.get(&format!("{TERRAIN}/heights?{query}"));
        assert_eq!(answer.status, status, "{query}: {:?}", answer.json());
    }
    for (query, length) in
        [("width=3&depth=3", 35), ("width=3", 12), ("format=r16&width=1&depth=1", 2), ("format=png", 10)]
    {
        let answer = served.put(&format!("{TERRAIN}/heights?{query}"), vec![0; length]);
        assert!(matches!(answer.status, 400 | 422), "{query}: {:?}", answer.json());
    }
    let holes: Vec<u8> = [f32::NAN, f32::INFINITY].into_iter().flat_map(f32::to_le_bytes).collect();
    assert_eq!(served.put(&format!("{TERRAIN}/heights?width=2&depth=1"), holes).status / 100, 4);
    let terrain = served.stop();
    assert_eq!(terrain.log().unwrap().len(), 4);
    assert_eq!(heights_of(&terrain).len(), all.len());
}

#[test]
fn operations_read_no_files_but_those_that_are_shared() {
    let served = Served::new();
    let folder = served.folder.path();
    std::fs::create_dir_all(folder.join("files/in")).unwrap();
    std::fs::write(folder.join("secret.png"), b"what is in it").unwrap();
    let picture = include_bytes!("../../../../tests/fixtures/service/dot.png");
    std::fs::write(folder.join("files/in/dot.png"), picture).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.join("secret.png"), folder.join("files/link.png")).unwrap();
    let stamp = |file: &str| {
        let brush = json!({ "type": "stamp", "radius": 40, "strength": 1, "alpha": { "file": file } });
        let operation = json!({ "op": "stroke", "brush": brush, "points": [[200, 200]] });
        served.post(&format!("{TERRAIN}/operations"), &json!({ "operations": [operation] }))
    };
    stamp("in/dot.png").ok();
    let absolute = folder.join("secret.png").to_string_lossy().into_owned();
    let mut names = vec![
        "../secret.png",
        "in/../../secret.png",
        "/etc/passwd",
        "none.png",
        "in",
        "",
        ".",
        "..",
        "in/dot.png/",
        "..%2fsecret.png",
        "in\u{0}dot.png",
        "in/dot.png\u{0}.txt",
        "~/secret.png",
        "\\\\server\\share",
        absolute.as_str(),
    ];
    if cfg!(unix) {
        names.push("link.png");
    }
    for name in names {
        let refused = stamp(name);
        assert_eq!(refused.error(400), "operation", "{name:?}");
        assert!(!String::from_utf8_lossy(&refused.body).contains("what is in it"));
    }
}
