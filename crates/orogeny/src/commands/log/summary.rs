//! An operation in a line.

use serde_json::Value;

use super::{layers, select};
use crate::output::count;

/// An operation, as the history records it, in a line.
pub(super) fn summary(operation: &Value) -> String {
    if let Some(line) = layers::summary(operation).or_else(|| select::summary(operation)) {
        return line;
    }
    let field = |path: &str| operation.pointer(path);
    let name = field("/op").and_then(Value::as_str).unwrap_or("?");
    let mut line = name.to_owned();
    if let Some(brush) = field("/brush/type").and_then(Value::as_str) {
        line.push_str(&format!(" {brush}"));
    }
    // A fill has no instances, and for all but one brush no radius.
    let is_stroke = field("/points").is_some();
    for (what, path, unit) in [
        ("radius", "/brush/radius", " m"),
        ("strength", "/brush/strength", ""),
        ("height", "/brush/height", " m"),
        ("region", "/region", ""),
        ("file", "/file", ""),
    ] {
        match field(path).filter(|_| what != "radius" || is_stroke) {
            Some(Value::Number(number)) => {
                // What a slider was moved to has digits that no one chose: seven are enough to tell one from another.
                line.push_str(&format!(", {what} {}{unit}", number.as_f64().unwrap_or_default() as f32));
            }
            Some(value) => line.push_str(&format!(", {what} {value}{unit}")),
            None => {}
        }
    }
    if let Some(points) = field("/points").and_then(Value::as_array) {
        line.push_str(&format!(", {}", count(points.len() as u64, "point")));
    }
    let layer = field("/layer").map(Value::to_string).unwrap_or_default();
    match field("/target").and_then(Value::as_str) {
        Some("selection") => line.push_str(", selection"),
        Some("mask") => line.push_str(&format!(", mask of layer {layer}")),
        Some("heights") => line.push_str(&format!(", own heights of layer {layer}")),
        _ if layer.is_empty() => {}
        _ => line.push_str(&format!(", layer {layer}")),
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn operations_are_told_in_a_line() {
        let brush = json!({"type": "raise", "radius": 40.5, "strength": 12.0});
        let stroke =
            json!({"op": "stroke", "layer": 1, "target": "seen", "brush": brush, "points": [[1, 2]]});
        assert_eq!(summary(&stroke), "stroke raise, radius 40.5 m, strength 12, 1 point, layer 1");
        let slid = json!({"op": "stroke", "brush": {"type": "raise", "radius": 82.0, "strength": 8.200000000000001}, "points": []});
        assert_eq!(summary(&slid), "stroke raise, radius 82 m, strength 8.2, 0 points");
        for (target, end) in
            [("mask", "mask of layer 7"), ("selection", "selection"), ("heights", "own heights of layer 7")]
        {
            let brush = json!({"type": "roughen", "radius": 50.0, "strength": 0.5});
            let fill = json!({"op": "fill", "layer": 7, "target": target, "brush": brush});
            assert_eq!(summary(&fill), format!("fill roughen, strength 0.5, {end}"));
        }
        assert_eq!(summary(&json!({"op": "import", "file": "a.tif"})), r#"import, file "a.tif""#);
        assert_eq!(summary(&Value::Null), "?");
    }
}
