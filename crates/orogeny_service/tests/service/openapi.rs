//! The description of the calls is true: every call is in it, and every call in it is there.

use crate::support::Served;

#[test]
fn every_call_that_is_described_is_there_and_takes_the_methods_it_says() {
    let served = Served::new();
    let document = served.get("/openapi.json").ok();
    let paths = document["paths"].as_object().unwrap();
    assert_eq!(paths.len(), 12);
    for (path, methods) in paths {
        let path = path.replace("{name}", "t");
        for method in ["get", "put", "post", "delete", "patch"] {
            let answer = served.ask(&method.to_uppercase(), &path, &[], b"[".to_vec());
            let is_described = methods.get(method).is_some();
            assert_eq!(answer.status != 405, is_described, "{method} {path} answers {}", answer.status);
            assert_ne!(answer.status, 404, "{method} {path}");
            let Some(described) = methods.get(method) else { continue };
            let statuses = described["responses"].as_object().unwrap();
            assert!(
                statuses.contains_key(&answer.status.to_string()),
                "{method} {path} answers {}",
                answer.status
            );
        }
    }
}

#[test]
fn the_guide_has_a_row_for_every_call() {
    let served = Served::new();
    let document = served.get("/openapi.json").ok();
    let guide = include_str!("../../../../docs/service.md");
    for (path, methods) in document["paths"].as_object().unwrap() {
        let last = path.rsplit('/').next().unwrap();
        for method in methods.as_object().unwrap().keys().filter(|key| *key != "parameters") {
            // Of calls that are alike, the second one is shortened.
            let whole = format!("`{} {path}`", method.to_uppercase());
            let is_there =
                [whole, format!("`…/{last}`"), format!("`/{last}`"), format!("/{last}?author=NAME`")];
            assert!(is_there.iter().any(|call| guide.contains(call.as_str())), "{method} {path}");
        }
    }
}
