//! The users' guide to custom brushes says what holds.

#![expect(clippy::unwrap_used, reason = "helpers of tests, which clippy does not take for tests")]

use std::fs;
use std::path::{Path, PathBuf};

use orogeny_shaders::custom::{MAX_OPERATIONS, MAX_PARAMETERS, RULES, compile_custom};
use orogeny_shaders::{Error, LINTS};

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

fn guide() -> String {
    fs::read_to_string(docs().join("custom-brushes.md")).unwrap()
}

#[test]
fn every_rule_is_in_it() {
    let guide = guide();
    for rule in RULES.iter().chain(LINTS.iter().filter(|lint| lint.name == "nan_test")) {
        let row = format!("| `{}` | {} |", rule.name, rule.summary);
        assert!(guide.contains(&row), "missing in docs/custom-brushes.md: {row}");
    }
    let parameter = RULES.iter().find(|rule| rule.name == "parameter").unwrap();
    assert!(parameter.summary.contains(&MAX_PARAMETERS.to_string()));
    let cost = RULES.iter().find(|rule| rule.name == "cost").unwrap();
    assert_eq!(
        cost.summary.replace(',', "").split(' ').find_map(|word| word.parse().ok()),
        Some(MAX_OPERATIONS)
    );
}

#[test]
fn its_examples_compile() {
    let guide = guide();
    let examples: Vec<&str> =
        guide.split("```wgsl\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert_eq!(examples.len(), 2);
    for example in examples {
        let brush = compile_custom(example, "example.wgsl").unwrap_or_else(|err| panic!("{err}"));
        assert!(!brush.summary.is_empty());
    }
}

#[test]
fn every_brush_beside_it_compiles_and_is_named_in_it() {
    let guide = guide();
    let mut num_files = 0;
    for entry in fs::read_dir(docs().join("brushes")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(guide.contains(&format!("[{name}](brushes/{name})")), "{name}");
        let brush =
            compile_custom(&fs::read_to_string(&path).unwrap(), name).unwrap_or_else(|err| panic!("{err}"));
        assert!(!brush.parameters.is_empty(), "{name}");
        num_files += 1;
    }
    assert!(num_files >= 2);
}

#[test]
fn the_error_that_it_shows_is_the_one_that_is_made() {
    let text = "// Terraces.\n// @param rounds: f32 = 3 (1 .. 8) \"rounds\"\nfn brush(at: BrushInput) -> f32 {\n    \
                var sum = 0.0;\n\n    for (var i = 0; i < i32(parameters.rounds); i++) {\n        sum += 1.0;\n    }\n    \
                return sum;\n}\n";
    let Err(err @ Error::BrokenBrush { .. }) = compile_custom(text, "terraces.wgsl") else {
        panic!("it compiles")
    };
    let shown: String =
        err.to_string().lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n");
    let without_ends = |text: &str| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    assert!(guide().contains(&without_ends(&shown)), "{shown}");
}
