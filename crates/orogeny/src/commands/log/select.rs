//! A change of the selection in a line.

use serde_json::Value;

use crate::output::count;

/// What is selected, and what becomes of it; nothing of other operations.
pub(super) fn summary(operation: &Value) -> Option<String> {
    let field = |name: &str| operation.get(name);
    let shape = field("shape")?.as_object().filter(|_| field("op") == Some(&"select".into()))?;
    let mut line = "select".to_owned();
    for (name, value) in shape {
        line.push_str(&match value {
            Value::Bool(_) | Value::Object(_) => format!(" {name}"),
            Value::Array(points) if name == "lasso" => {
                format!(" {name} of {}", count(points.len() as u64, "point"))
            }
            _ => format!(" {name} {value}"),
        });
    }
    match field("combine").and_then(Value::as_str) {
        None | Some("replace") => {}
        Some(combine) => line.push_str(&format!(", {combine}")),
    }
    for what in ["grow", "shrink", "feather"] {
        let length_m = field(what).and_then(Value::as_f64).unwrap_or_default();
        if length_m > 0.0 {
            line.push_str(&format!(", {what} {length_m} m"));
        }
    }
    if field("invert") == Some(&true.into()) {
        line.push_str(", invert");
    }
    Some(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn selections_are_told_in_a_line() {
        for (selection, line) in [
            (
                json!({"op": "select", "shape": {"lasso": [[0, 0], [9, 0], [9, 9]]}, "combine": "add", "grow": 3.5,
                    "shrink": 0.0, "feather": 2.0, "invert": true}),
                "select lasso of 3 points, add, grow 3.5 m, feather 2 m, invert",
            ),
            (
                json!({"op": "select", "shape": {"mask": 3, "region": [0, 1, 2, 3]}, "combine": "replace"}),
                "select mask 3 region [0,1,2,3]",
            ),
            (
                json!({"op": "select", "shape": {"gate": {"slope": {"min": 3}}}, "invert": false}),
                "select gate",
            ),
            (json!({"op": "select", "shape": {"all": true}}), "select all"),
        ] {
            assert_eq!(summary(&selection).as_deref(), Some(line));
        }
        assert_eq!(summary(&json!({"op": "fill", "region": [0, 0, 1, 1]})), None);
    }
}
