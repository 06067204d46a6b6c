//! The compiler on the real `shaders/` folder: as it is embedded, and with one mistake in a copy of it.

#![expect(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, which clippy does not take for tests"
)]

use std::fs;
use std::path::{Path, PathBuf};

use orogeny_shaders::{Diagnostic, Error, LINTS, SHADERS, compile_dir, shader};
use proptest::prelude::*;
use tempfile::TempDir;

const KERNEL: &str = "@compute @workgroup_size(1) fn main() {}\n";

fn shaders_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders")
}

/// A copy of the folder, in a temporary folder that lives as long as the first value.
fn copy_of_shaders() -> (TempDir, PathBuf) {
    fn copy(from: &Path, to: &Path) {
        fs::create_dir(to).unwrap();
        for entry in fs::read_dir(from).unwrap() {
            let entry = entry.unwrap();
            let target = to.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                copy(&entry.path(), &target);
            } else {
                fs::copy(entry.path(), target).unwrap();
            }
        }
    }
    let temporary = TempDir::new().unwrap();
    let root = temporary.path().join("shaders");
    copy(&shaders_folder(), &root);
    (temporary, root)
}

fn errors_of(root: &Path) -> Vec<Diagnostic> {
    match compile_dir(root) {
        Err(Error::Broken { diagnostics }) => diagnostics,
        other => panic!("expected errors in the shaders: {other:?}"),
    }
}

fn shared_files() -> Vec<String> {
    let mut files: Vec<String> = (SHADERS.iter().flat_map(|shader| shader.sources.iter()))
        .filter(|path| path.starts_with("lib/") || path.starts_with("driver/"))
        .map(ToString::to_string)
        .collect();
    files.sort();
    files.dedup();
    assert!(!files.is_empty());
    files
}

#[test]
fn what_is_embedded_is_what_the_folder_compiles_to() {
    assert_eq!(compile_dir(&shaders_folder()).unwrap(), SHADERS);
}

#[test]
fn every_shader_is_found_by_its_stem() {
    assert!(!SHADERS.is_empty());
    for expected in SHADERS {
        assert_eq!(shader(&expected.stem), Some(expected));
    }
    assert_eq!(shader("brush/no_such_brush"), None);
}

#[test]
fn every_line_of_every_shader_is_the_line_it_came_from() {
    for shader in SHADERS {
        let mut num_lines = 0;
        for text in shader.wgsl.lines() {
            num_lines += 1;
            let origin = shader.original_location(num_lines).unwrap();
            let file = fs::read_to_string(shaders_folder().join(origin.file)).unwrap();
            assert_eq!(file.lines().nth(origin.line as usize - 1), Some(text), "{}:{num_lines}", shader.stem);
        }
        assert_eq!(shader.original_location(0), None);
        assert_eq!(shader.original_location(num_lines + 1), None);
    }
}

#[test]
fn a_copy_without_mistakes_compiles_to_the_same() {
    let (_temporary, root) = copy_of_shaders();
    assert_eq!(compile_dir(&root).unwrap(), SHADERS);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_mistake_in_a_shared_file_is_reported_at_its_line(
        file in any::<prop::sample::Index>(),
        line in any::<prop::sample::Index>(),
    ) {
        let (_temporary, root) = copy_of_shaders();
        let files = shared_files();
        let path = file.get(&files);
        let text = fs::read_to_string(root.join(path)).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        let at = line.index(lines.len() + 1);
        // No token of WGSL, so the parser stops here wherever it stands; inside a block comment it would be text.
        let before = lines[..at].join("\n");
        prop_assume!(before.matches("/*").count() == before.matches("*/").count());
        lines.insert(at, "  $");
        fs::write(root.join(path), lines.join("\n")).unwrap();

        let errors = errors_of(&root);
        let places: Vec<_> = errors.iter().map(|error| (error.file.clone(), error.line, error.column)).collect();
        prop_assert_eq!(places, [(format!("shaders/{path}"), at as u32 + 1, 3)]);
    }
}

#[test]
fn mistakes_in_two_files_are_both_reported() {
    let (_temporary, root) = copy_of_shaders();
    for shader in SHADERS {
        let path = root.join(format!("{}.wgsl", shader.stem));
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, format!("$\n{text}")).unwrap();
    }
    let files: Vec<String> = errors_of(&root).into_iter().map(|error| error.file).collect();
    let expected: Vec<String> =
        SHADERS.iter().map(|shader| format!("shaders/{}.wgsl", shader.stem)).collect();
    assert_eq!(files, expected);
}

#[test]
fn a_shared_file_that_nothing_includes_any_more_is_reported() {
    let (_temporary, root) = copy_of_shaders();
    fs::write(root.join("lib/no_one_needs_this.wgsl"), "const A = 1u;\n").unwrap();
    let errors = errors_of(&root);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(
        (errors[0].file.as_str(), errors[0].lint),
        ("shaders/lib/no_one_needs_this.wgsl", Some("orphan"))
    );
}

#[test]
fn bytes_that_are_not_text_are_reported_where_they_are() {
    let temporary = TempDir::new().unwrap();
    let root = temporary.path().join("shaders");
    fs::create_dir_all(root.join("brush")).unwrap();
    let mut bytes = b"// ok\n// ab".to_vec();
    bytes.extend([0xff, b'\n']);
    bytes.extend(KERNEL.as_bytes());
    fs::write(root.join("brush/raise.wgsl"), bytes).unwrap();
    let errors = errors_of(&root);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!((errors[0].line, errors[0].column), (2, 6));
    assert!(errors[0].message.contains("UTF-8"), "{}", errors[0].message);
}

#[test]
fn other_files_and_hidden_ones_are_left_alone() {
    let temporary = TempDir::new().unwrap();
    let root = temporary.path().join("shaders");
    fs::create_dir_all(root.join("brush/.cache")).unwrap();
    fs::write(root.join("brush/raise.wgsl"), KERNEL).unwrap();
    fs::write(root.join("brush/.raise.wgsl"), "$").unwrap();
    fs::write(root.join("brush/.cache/raise.wgsl"), "$").unwrap();
    fs::write(root.join("README.md"), "$").unwrap();
    assert_eq!(compile_dir(&root).unwrap().len(), 1);
}

#[test]
fn a_folder_without_shaders_is_an_error() {
    let temporary = TempDir::new().unwrap();
    assert!(matches!(compile_dir(temporary.path()), Err(Error::NoShaders { .. })));
    let missing = temporary.path().join("none");
    match compile_dir(&missing) {
        Err(Error::Read { path, .. }) => assert_eq!(path, missing),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_readme_names_every_lint() {
    let readme = fs::read_to_string(shaders_folder().join("README.md")).unwrap().replace('`', "");
    for lint in LINTS {
        let row = format!("| {} | {} |", lint.name, lint.summary.replace('`', ""));
        assert!(readme.contains(&row), "missing in shaders/README.md: {row}");
    }
}
