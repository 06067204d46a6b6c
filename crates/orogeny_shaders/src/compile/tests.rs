//! The whole compiler on small folders, and the helpers that the lints' tests share.

use proptest::prelude::*;

use super::*;
use crate::shader::{BindingKind, Member, Override, ScalarType, Struct};

/// A kernel without mistakes.
pub(crate) const KERNEL: &str = "\
@group(1) @binding(0) var<storage, read_write> heights: array<f32>;
@compute @workgroup_size(8, 4)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    heights[id.x] = 1.0;
}
";

/// A kernel with statements on its fourth line, at column 5, and a result. They can use the value `x`, the vector
/// `v` and the variables `y`, `k` and `a`.
pub(crate) fn kernel(statements: &str, result: &str) -> String {
    format!(
        "@group(1) @binding(0) var<storage, read_write> heights: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    let x = heights[id.x]; let v = vec2<f32>(x, -x); var y = 2.0 * x; var k = id.y; var a = array<f32, 2>(x, y);
    {statements}
    heights[id.x] = {result} + v.x + y + a[k & 1u];
}}
"
    )
}

fn compile(files: &[(&str, &str)]) -> Result<Vec<Shader>> {
    let mut tree = SourceTree::new("shaders");
    for (path, text) in files {
        tree.insert(path, text)?;
    }
    compile_tree(&tree)
}

fn errors_of(files: &[(&str, &str)]) -> Vec<Diagnostic> {
    match compile(files) {
        Ok(_) => Vec::new(),
        Err(Error::Broken { diagnostics }) => diagnostics,
        Err(err) => panic!("{err}"),
    }
}

fn place(diagnostic: &Diagnostic) -> String {
    format!("{}:{}:{}", diagnostic.file, diagnostic.line, diagnostic.column)
}

fn places_of(files: &[(&str, &str)]) -> Vec<String> {
    errors_of(files).iter().map(place).collect()
}

/// The one error of the files: its place and message.
fn only_error_of(files: &[(&str, &str)]) -> (String, String) {
    let errors = errors_of(files);
    let [error] = errors.as_slice() else { panic!("expected one error: {errors:?}") };
    (place(error), error.message.clone())
}

/// The lints that the files break, each with its place. Leaks a little, for the sake of short tests.
pub(crate) fn lints_of(files: &[(&str, &str)]) -> Vec<(&'static str, &'static str)> {
    let is_shared = |error: &Diagnostic| error.lint.is_some();
    let errors = errors_of(files);
    assert!(
        errors.iter().all(is_shared) || errors.iter().any(is_shared),
        "the files break no lint, but do not compile: {errors:?}"
    );
    errors.iter().filter_map(|error| Some((error.lint?, &*place(error).leak()))).collect()
}

fn including(paths: &[&str]) -> String {
    let lines: String = paths.iter().map(|path| format!("#include \"{path}\"\n")).collect();
    format!("{lines}{KERNEL}")
}

#[test]
fn a_good_kernel_is_reflected() {
    let source = format!(
        "override GAIN: f32 = 0.5;\noverride COUNT: u32;\n\
         struct Brush {{ centre: vec3<f32>, radius: f32, axis: vec3<f32>, values: array<vec4<f32>, 2>, last: u32 }}\n\
         struct Totals {{ count: atomic<u32>, values: array<f32> }}\n\
         @group(2) @binding(1) var<storage, read_write> totals: Totals;\n\
         @group(1) @binding(3) var pages: texture_storage_2d_array<r32float, read_write>;\n\
         @group(1) @binding(2) var source: texture_2d<f32>;\n\
         @group(1) @binding(1) var<uniform> brush: Brush;\n{KERNEL}"
    );
    let shaders = compile(&[("brush/raise.wgsl", &source), ("brush/lower.wgsl", KERNEL)]).unwrap();
    assert_eq!(
        shaders.iter().map(|shader| &*shader.stem).collect::<Vec<_>>(),
        ["brush/lower", "brush/raise"]
    );

    let shader = &shaders[1];
    assert_eq!(shader.wgsl, source);
    assert_eq!(*shader.sources, ["brush/raise.wgsl"]);
    assert_eq!((&*shader.entry_point, shader.workgroup_size), ("main", [8, 4, 1]));

    let bindings: Vec<_> =
        shader.bindings.iter().map(|b| (b.group, b.binding, &*b.name, b.kind, b.size_in_bytes)).collect();
    let texture = BindingKind::Texture {
        dimension: crate::TextureDimension::D2,
        sample_type: crate::SampleType::Float,
        multisampled: false,
    };
    let storage_texture = BindingKind::StorageTexture {
        dimension: crate::TextureDimension::D2Array,
        format: "r32float",
        access: crate::TextureAccess::ReadWrite,
    };
    assert_eq!(
        bindings,
        [
            (1, 0, "heights", BindingKind::StorageBuffer { writable: true }, 4),
            (1, 1, "brush", BindingKind::UniformBuffer, 80),
            (1, 2, "source", texture, 0),
            (1, 3, "pages", storage_texture, 0),
            (2, 1, "totals", BindingKind::StorageBuffer { writable: true }, 8),
        ]
    );

    let member = |name: &'static str, offset, size, type_name: &'static str| Member {
        name: name.into(),
        offset,
        size,
        type_name: type_name.into(),
    };
    let brush = Struct {
        name: "Brush".into(),
        size: 80,
        members: vec![
            member("centre", 0, 12, "vec3<f32>"),
            member("radius", 12, 4, "f32"),
            member("axis", 16, 12, "vec3<f32>"),
            member("values", 32, 32, "array<vec4<f32>, 2>"),
            member("last", 64, 4, "u32"),
        ]
        .into(),
    };
    assert_eq!(shader.structs[0], brush);
    assert_eq!(shader.find_struct("Brush"), Some(&brush));
    assert_eq!(shader.find_struct("Totals").map(|item| item.members[1].offset), Some(4));
    assert_eq!(shader.find_struct("Page"), None);
    assert_eq!(
        *shader.overrides,
        [
            Override { name: "COUNT".into(), ty: ScalarType::U32, default: None },
            Override { name: "GAIN".into(), ty: ScalarType::F32, default: Some(0.5) },
        ]
    );
}

#[test]
fn what_the_tables_cannot_say_is_an_error() {
    for (line, place) in
        [("override A: u32 = 1u; override B: u32 = A + 1u;", "1:23"), ("@id(3) override A: u32 = 1u;", "1:8")]
    {
        let source = format!("{line}\n{KERNEL}");
        let (found, _) = only_error_of(&[("brush/raise.wgsl", &source)]);
        assert_eq!(found, format!("shaders/brush/raise.wgsl:{place}"), "{line}");
    }
    let source = format!("override SIDE: u32 = 8u;\n{}", KERNEL.replace("(8, 4)", "(SIDE, 4)"));
    let (_, message) = only_error_of(&[("brush/raise.wgsl", &source)]);
    assert!(message.contains("workgroup size"), "{message}");
}

#[test]
fn an_error_in_an_included_file_is_reported_there_and_once() {
    let lib = "fn half(x: f32) -> f32 {\n    return 0.5 * y;\n}\n";
    let kernel = including(&["lib/half.wgsl"]);
    let files =
        [("lib/half.wgsl", lib), ("brush/a.wgsl", kernel.as_str()), ("brush/b.wgsl", kernel.as_str())];
    let (place, message) = only_error_of(&files);
    assert_eq!(place, "shaders/lib/half.wgsl:2:18");
    assert!(message.contains('y'), "{message}");
}

#[test]
fn a_validation_error_is_reported_at_its_expression() {
    let lib = "fn wrong(x: f32) -> u32 {\n    return x + 1.0;\n}\n";
    let files = [("lib/wrong.wgsl", lib), ("brush/a.wgsl", &*including(&["lib/wrong.wgsl"]))];
    let (place, _) = only_error_of(&files);
    assert!(place.starts_with("shaders/lib/wrong.wgsl:2:12"), "{place}");
}

#[test]
fn errors_of_all_files_are_reported_together() {
    let kernel = including(&["lib/a.wgsl", "lib/b.wgsl"]);
    let other = KERNEL.replace("1.0", "one");
    let files = [
        ("lib/a.wgsl", "const A = ;\n"),
        ("lib/b.wgsl", "\nconst B = ;\n"),
        ("brush/raise.wgsl", kernel.as_str()),
        ("brush/lower.wgsl", other.as_str()),
    ];
    let expected = ["shaders/brush/lower.wgsl:4:21", "shaders/lib/a.wgsl:1:11", "shaders/lib/b.wgsl:2:11"];
    assert_eq!(places_of(&files), expected);
}

#[test]
fn capabilities_that_the_engine_does_not_request_are_refused() {
    let source = format!("var<immediate> gain: f32;\n{KERNEL}");
    let (place, _) = only_error_of(&[("brush/raise.wgsl", &source)]);
    assert!(place.starts_with("shaders/brush/raise.wgsl:1:"), "{place}");
}

#[test]
fn bad_includes_are_reported_at_their_lines() {
    let cases = [
        ("#include \"lib/none.wgsl\"", "there is no"),
        ("#include \"../lib/a.wgsl\"", "leads out"),
        ("#include \"/etc/a.wgsl\"", "leads out"),
        ("#include \"lib/../../a.wgsl\"", "leads out"),
        ("#include \"lib\\a.wgsl\"", "leads out"),
        ("#include \"c:/a.wgsl\"", "leads out"),
        ("#include \"\"", "leads out"),
        ("#include \"brush/lower.wgsl\"", "is an entry point"),
        ("#include lib/a.wgsl", "expected `#include"),
        ("#include \"lib/a.wgsl\" fn", "expected `#include"),
        ("#define A", "expected `#include"),
    ];
    for (line, expected) in cases {
        let source = format!("// head\n  {line}\n{KERNEL}");
        let files = [("brush/raise.wgsl", source.as_str()), ("brush/lower.wgsl", KERNEL)];
        let (place, message) = only_error_of(&files);
        assert_eq!(place, "shaders/brush/raise.wgsl:2:3", "{line}");
        assert!(message.contains(expected), "{line}: {message}");
    }
}

#[test]
fn a_module_cannot_include_a_driver() {
    let files = [
        ("lib/a.wgsl", "#include \"driver/a.wgsl\"\n"),
        ("driver/a.wgsl", "const A = 1u;\n"),
        ("brush/raise.wgsl", &*including(&["driver/a.wgsl", "lib/a.wgsl"])),
    ];
    let (place, message) = only_error_of(&files);
    assert_eq!(place, "shaders/lib/a.wgsl:1:1");
    assert!(message.contains("has bindings"), "{message}");
}

#[test]
fn cycles_are_reported_where_they_close() {
    let files = [
        ("lib/a.wgsl", "#include \"lib/b.wgsl\"\n"),
        ("lib/b.wgsl", "\n#include \"lib/a.wgsl\"\n"),
        ("brush/raise.wgsl", &*including(&["lib/a.wgsl"])),
    ];
    let errors = errors_of(&files);
    let messages: Vec<_> = errors.iter().map(|error| (place(error), error.message.as_str())).collect();
    let from_a = "include cycle: lib/a.wgsl -> lib/b.wgsl -> lib/a.wgsl";
    assert!(messages.contains(&("shaders/lib/b.wgsl:2:1".to_owned(), from_a)), "{messages:?}");

    let files = [("lib/a.wgsl", "#include \"lib/a.wgsl\"\n"), ("brush/a.wgsl", &*including(&["lib/a.wgsl"]))];
    assert_eq!(only_error_of(&files).1, "include cycle: lib/a.wgsl -> lib/a.wgsl");
}

#[test]
fn a_chain_of_includes_has_a_limit() {
    let chain: Vec<_> = (0..64)
        .map(|k| (format!("lib/a{k:02}.wgsl"), format!("#include \"lib/a{:02}.wgsl\"\n", (k + 1) % 64)))
        .collect();
    let kernel = including(&["lib/a00.wgsl"]);
    let mut files: Vec<_> = chain.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    files.push(("brush/raise.wgsl", &kernel));
    assert!(errors_of(&files).iter().any(|error| error.message.contains("deeper than 32")));
}

#[test]
fn includes_in_comments_are_text() {
    let source = format!("// #include \"lib/a.wgsl\"\n/*\n#include \"lib/a.wgsl\"\n*/\n{KERNEL}");
    assert_eq!(*compile(&[("brush/raise.wgsl", &source)]).unwrap()[0].sources, ["brush/raise.wgsl"]);
}

#[test]
fn an_endless_comment_does_not_swallow_the_next_file() {
    let files = [("lib/a.wgsl", "\n /* a\n"), ("brush/raise.wgsl", &*including(&["lib/a.wgsl"]))];
    assert!(places_of(&files).contains(&"shaders/lib/a.wgsl:2:2".to_owned()));
}

#[test]
fn files_must_be_where_they_belong() {
    let (place, message) = only_error_of(&[("brush/raise.wgsl", KERNEL), ("shared.wgsl", "const A = 1u;\n")]);
    assert_eq!(place, "shaders/shared.wgsl:1:1");
    assert!(message.contains("no known folder"), "{message}");
}

#[test]
fn names_are_snake_case() {
    for path in ["brush/Raise.wgsl", "brush/raise-2.wgsl", "brush/2d.wgsl", "brush/.wgsl", "brush/a//b.wgsl"]
    {
        let (_, message) = only_error_of(&[(path, KERNEL)]);
        assert!(message.contains("snake_case"), "{message}");
    }
    assert!(compile(&[("brush/noise/fbm_2.wgsl", KERNEL)]).is_ok());
}

#[test]
fn nothing_to_compile_is_an_error() {
    assert!(matches!(compile(&[]), Err(Error::NoShaders { .. })));
    assert!(matches!(compile(&[("lib/a.wgsl", "const A = 1u;\n")]), Err(Error::NoShaders { .. })));
}

#[test]
fn a_tree_is_bounded() {
    let mut tree = SourceTree::new("shaders");
    let result = tree.insert("lib/a.wgsl", &" ".repeat((16 << 20) + 1));
    assert!(matches!(result, Err(Error::TooLarge { unit: "bytes", .. })));
    for k in 0..4096 {
        tree.insert(&format!("lib/a{k}.wgsl"), "").unwrap();
    }
    assert!(matches!(tree.insert("lib/b.wgsl", ""), Err(Error::TooLarge { unit: "files", .. })));
    tree.insert("lib/a0.wgsl", "// replaced\n").unwrap();
}

#[test]
fn line_ends_and_byte_order_marks_do_not_matter() {
    let windows = format!("\u{feff}{}", KERNEL.replace('\n', "\r\n"));
    assert_eq!(
        compile(&[("brush/a.wgsl", &windows)]).unwrap(),
        compile(&[("brush/a.wgsl", KERNEL)]).unwrap()
    );
}

#[test]
fn an_error_looks_like_one_of_rustc() {
    let source = KERNEL.replace("1.0", "mix(1.0, 2.0, heights[0])");
    let error = compile(&[("brush/raise.wgsl", &source)]).unwrap_err();
    let expected = "\
1 error in the shaders

shaders/brush/raise.wgsl:4:21: error[mix]: `mix` is banned
    4 |     heights[id.x] = mix(1.0, 2.0, heights[0]);
      |                     ^
      = why: WGSL lets a driver compute it as a + w(b - a) or as a(1 - w) + wb, which round differently
      = fix: write a + w * (b - a)
";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn lints_are_sorted_and_say_why() {
    assert!(lint::LINTS.is_sorted_by_key(|lint| lint.name) && !lint::LINTS.is_empty());
    for lint in lint::LINTS {
        for text in [lint.name, lint.summary, lint.why, lint.fix] {
            assert!(!text.is_empty(), "{lint:?}");
        }
    }
}

proptest! {
    /// Every line of the flattened text is the line that the table names, and every line of every file that is
    /// reached, but for the includes, is there exactly once.
    #[test]
    fn the_line_table_is_exact(
        // File k includes some of the files after it, so that there is no cycle.
        includes in prop::collection::vec(prop::collection::vec((0_usize..8, 0_usize..6), 0..4), 8),
        num_lines in prop::collection::vec(0_usize..6, 8),
    ) {
        let mut tree = SourceTree::new("shaders");
        let path = |k: usize| if k == 0 { "brush/a.wgsl".to_owned() } else { format!("lib/a{k}.wgsl") };
        for k in 0..8 {
            let mut lines: Vec<String> = (0..num_lines[k]).map(|n| format!("// {k}, {n}")).collect();
            for &(target, at) in &includes[k] {
                if target > k {
                    lines.insert(at.min(lines.len()), format!("#include \"{}\"", path(target)));
                }
            }
            tree.insert(&path(k), &lines.join("\n")).unwrap();
        }

        let mut diagnostics = Vec::new();
        let flattened = resolve::flatten(&tree, "brush/a.wgsl", &mut diagnostics);
        prop_assert_eq!(diagnostics, []);
        let mut seen = BTreeSet::new();
        let mut flattened_line = 0;
        for text in flattened.wgsl.lines() {
            flattened_line += 1;
            let (source, line) = crate::shader::locate(&flattened.line_runs, flattened_line).unwrap();
            let file = tree.get(&flattened.sources[source as usize]).unwrap();
            prop_assert_eq!(file.lines().nth(line as usize - 1), Some(text));
            prop_assert!(seen.insert((source, line)));
        }
        let num_expected: usize = (flattened.sources.iter())
            .map(|path| tree.get(path).unwrap().lines().filter(|line| !line.starts_with('#')).count())
            .sum();
        prop_assert_eq!(seen.len(), num_expected);
        prop_assert_eq!(crate::shader::locate(&flattened.line_runs, 0), None);
        prop_assert_eq!(crate::shader::locate(&flattened.line_runs, flattened_line + 1), None);
    }
}
