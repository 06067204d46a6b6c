//! Custom brushes as a whole, and the helpers that the rules' tests share.

mod evaluate;
mod hostile;
mod library;

use super::*;

/// The brushes of the users' guide, which are files of their own.
pub(in crate::custom) const EXAMPLES: [(&str, &str); 2] = [
    ("crater.wgsl", include_str!("../../../../../docs/brushes/crater.wgsl")),
    ("strata.wgsl", include_str!("../../../../../docs/brushes/strata.wgsl")),
];

/// A brush with statements on its second line, and a result.
pub(in crate::custom) fn brush(statements: &str, result: &str) -> String {
    format!("fn brush(at: BrushInput) -> f32 {{\n{statements}\nreturn at.height_m + f32({result});\n}}\n")
}

#[track_caller]
pub(in crate::custom) fn compiled(text: &str) -> CustomBrush {
    compile_custom(text, "test.wgsl").unwrap_or_else(|err| panic!("{err}"))
}

#[track_caller]
pub(in crate::custom) fn errors_of(text: &str) -> Vec<Diagnostic> {
    match compile_custom(text, "test.wgsl") {
        Ok(_) => Vec::new(),
        Err(Error::BrokenBrush { file, diagnostics }) => {
            assert_eq!(file, "test.wgsl");
            for diagnostic in &diagnostics {
                assert_eq!(diagnostic.file, "test.wgsl", "{diagnostic}");
            }
            diagnostics
        }
        Err(err) => panic!("{err}"),
    }
}

/// The rules that a text breaks, each with its line; all of its errors are of rules.
#[track_caller]
pub(in crate::custom) fn rules_of(text: &str) -> Vec<(&'static str, u32)> {
    let errors = errors_of(text);
    let is_rule = |error: &Diagnostic| error.lint.is_some();
    assert!(errors.iter().all(is_rule), "{errors:?}");
    errors.iter().filter_map(|error| Some((error.lint?, error.line))).collect()
}

#[test]
fn a_brush_is_a_kernel_like_the_others() {
    let text = "// Lifts.\n// @param share: f32 = 0.5 (0 .. 1) \"how much\"\n\
                fn brush(at: BrushInput) -> f32 { return at.height_m + parameters.share * at.weight; }\n";
    let shader = compiled(text).shader;
    let raise = crate::shader("brush/raise").unwrap();
    assert_eq!((&*shader.stem, &*shader.entry_point), ("custom/brush", "main"));
    assert_eq!((shader.workgroup_size, &shader.overrides), (raise.workgroup_size, &raise.overrides));
    assert_eq!(shader.bindings[..11], raise.bindings[..]);
    let own: Vec<_> =
        shader.bindings[11..].iter().map(|b| (b.group, b.binding, &*b.name, b.size_in_bytes)).collect();
    assert_eq!(own, [(1, 11, "parameters", 4), (1, 12, "custom", 12)]);
}

#[test]
fn the_stand_ins_are_a_brush_too() {
    let embedded = crate::shader("custom/brush").unwrap();
    let text = "fn brush(at: BrushInput) -> f32 { return at.height_m + at.weight * parameters.unused; }\n";
    assert_eq!(compiled(text).shader.bindings, embedded.bindings);
}

#[test]
fn lines_of_the_kernel_lead_to_the_users_file() {
    let text = format!("// One.\n{}", brush("let heights = at.weight;", "heights"));
    let shader = compile_custom(&text, "my/brush file.wgsl").unwrap().shader;
    let mut seen = Vec::new();
    for (index, line) in shader.wgsl.lines().enumerate() {
        let origin = shader.original_location(index as u32 + 1).unwrap();
        if origin.file == "my/brush file.wgsl" {
            seen.push((origin.line, line));
        }
    }
    let original: Vec<_> = text.lines().collect();
    assert_eq!(seen.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    for (line, renamed) in seen {
        assert_eq!(renamed.replace("fn apply", "fn brush"), original[line as usize - 1]);
    }
}

#[test]
fn errors_of_wgsl_are_at_their_place() {
    for (statement, column, expected) in [
        ("let x = at.wait;", 12, "wait"),
        ("  let x = ;", 11, "expected"),
        ("let x: u32 = at.weight;", 5, "u32"),
        ("parameters.unused = 1.0;", 1, ""),
    ] {
        let errors = errors_of(&brush(statement, "1.0"));
        let [error] = errors.as_slice() else { panic!("{statement}: {errors:?}") };
        assert_eq!((error.line, error.column, error.lint), (2, column, None), "{statement}: {error}");
        assert!(error.message.contains(expected), "{statement}: {}", error.message);
    }
}

#[test]
fn an_error_looks_like_one_of_the_shaders() {
    let error = compile_custom("// x\n@compute fn main() {}\n", "bad.wgsl").unwrap_err();
    let expected = "\
1 error in bad.wgsl

bad.wgsl:2:1: error[attribute]: an attribute, `@compute`
    2 | @compute fn main() {}
      | ^
      = why: bindings and entry points are the engine's, and a brush is one file that means the same everywhere
      = fix: take what the brush needs from `at`, `parameters` and the library, and put all functions into this file
";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn all_errors_of_a_stage_come_together() {
    let text = "@a var<private> x: f32;\n// @param a: u32 = 1 (0 .. 2) \"m\"\nconst noise = 1;\n";
    assert_eq!(rules_of(text), [("attribute", 1), ("declaration", 1), ("parameter", 2), ("declaration", 3)]);
    let text = brush("while true { } workgroupBarrier();", "1.0")
        .replace("-> f32", "-> i32")
        .replace("f32(1.0)", "1.0");
    assert!(!errors_of(&text).is_empty());
}

#[test]
fn a_file_of_another_system_compiles_the_same() {
    let text = brush("let x = at.weight;", "x");
    let windows = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_eq!(compiled(&windows), compiled(&text));
}

#[test]
fn an_endless_comment_is_an_error_where_it_starts() {
    let errors = errors_of("\n /* a");
    assert_eq!((errors.len(), errors[0].line, errors[0].column), (1, 2, 2));
}

#[test]
fn rules_are_sorted_and_say_why() {
    assert!(RULES.is_sorted_by_key(|rule| rule.name) && !RULES.is_empty());
    for rule in RULES {
        for text in [rule.name, rule.summary, rule.why, rule.fix] {
            assert!(!text.is_empty(), "{rule:?}");
        }
    }
}

#[test]
fn the_examples_compile_with_room_to_spare() {
    for (file, text) in EXAMPLES {
        let brush = compile_custom(text, file).unwrap_or_else(|err| panic!("{err}"));
        assert!(!brush.summary.is_empty() && brush.parameters.len() >= 3, "{file}");
        assert!(brush.num_operations < MAX_OPERATIONS / 2, "{file}: {}", brush.num_operations);
    }
}
