//! How long a source file and how big any file may be, and words that no file holds.

use std::path::{Path, PathBuf};

use crate::{assert_none, root};

/// Lines of a Rust file above which it is cut into several.
const MAX_RUST_LINES: usize = 600;

/// Bytes above which a file burdens every clone.
const MAX_BYTES: u64 = 300_000;

/// Files that may be bigger, each with the reason.
const BIG_FILES: [(&str, &str); 1] = [(
    "assets/terrain/frazier_1024_int16.tif",
    "the terrain of the demo, which must work without a download",
)];

/// Words that no file holds, each with the reason. They are cut in two so that this file does not hold them.
const FORBIDDEN: [(&str, &str); 4] = [
    (concat!("/wo", "rk/"), "a path of one machine"),
    (concat!("..", "/shared"), "a folder outside the repository"),
    (concat!("TO", "DO"), "an open end: finish it, or write an issue"),
    (concat!("FIX", "ME"), "an open end: finish it, or write an issue"),
];

/// Files that may hold one of them.
const MAY_HOLD: [(&str, &str); 1] = [(".ci/run", concat!("..", "/shared"))]; // tells the tests where real terrains lie

/// What a folder tree breaks of the rules above.
fn problems_of(root: &Path, big_files: &[(&str, &str)]) -> Vec<String> {
    let mut files = Vec::new();
    collect(root, root, &ignored(root), &mut files);
    let mut problems: Vec<_> =
        files.iter().flat_map(|file| problems_of_file(root, file, big_files)).collect();
    if !files.iter().any(|file| file.ends_with(".rs")) {
        problems.push("there is no Rust file at all".to_owned());
    }
    let gone = big_files.iter().filter(|(name, _)| !files.iter().any(|file| file == name));
    problems.extend(gone.map(|(name, _)| format!("{name} may be big, but is not there")));
    problems
}

fn problems_of_file(root: &Path, file: &str, big_files: &[(&str, &str)]) -> Vec<String> {
    let bytes = std::fs::read(root.join(file)).unwrap();
    let mut problems = Vec::new();
    let num_bytes = bytes.len() as u64;
    if num_bytes > MAX_BYTES && !big_files.iter().any(|(name, _)| *name == file) {
        problems.push(format!("{file} has {num_bytes} bytes, more than {MAX_BYTES}"));
    }
    let Ok(text) = String::from_utf8(bytes) else { return problems };
    let num_lines = text.lines().count();
    if file.ends_with(".rs") && num_lines > MAX_RUST_LINES {
        problems.push(format!("{file} has {num_lines} lines, more than {MAX_RUST_LINES}"));
    }
    for (word, reason) in FORBIDDEN {
        if !MAY_HOLD.contains(&(file, word)) {
            let lines = text.lines().enumerate().filter(|(_, line)| line.contains(word));
            problems.extend(lines.map(|(index, _)| format!("{file}:{} holds `{word}`: {reason}", index + 1)));
        }
    }
    problems
}

/// The names in the root's `.gitignore`; it holds nothing but folders of the root.
fn ignored(root: &Path) -> Vec<PathBuf> {
    let text = std::fs::read_to_string(root.join(".gitignore")).unwrap_or_default();
    let names = text.lines().filter_map(|line| line.trim().strip_prefix('/'));
    names.chain([".git"]).map(|name| root.join(name.trim_end_matches('/'))).collect()
}

fn collect(root: &Path, folder: &Path, ignored: &[PathBuf], files: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let path = entry.path();
        let kind = entry.file_type().unwrap();
        if ignored.contains(&path) {
            continue;
        }
        if kind.is_dir() {
            collect(root, &path, ignored, files);
        } else if kind.is_file() {
            files.push(path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/"));
        }
    }
    files.sort();
}

#[test]
fn the_repository_keeps_the_rules() {
    assert_none(&problems_of(&root(), &BIG_FILES));
}

mod bad_trees {
    //! The check finds what it is there to find.

    use super::*;

    fn problems(files: &[(&str, &str)], big_files: &[(&str, &str)]) -> Vec<String> {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        problems_of(root.path(), big_files)
    }

    const GOOD: (&str, &str) = ("src/lib.rs", "//! Good.\n");

    #[test]
    fn a_good_tree_passes() {
        let limit = "\n".repeat(MAX_RUST_LINES);
        assert_none(&problems(&[GOOD, ("src/long.rs", &limit), ("notes.md", &"\n".repeat(1000))], &[]));
    }

    #[test]
    fn a_long_source_file() {
        let long = "\n".repeat(MAX_RUST_LINES + 1);
        assert_eq!(problems(&[("src/long.rs", &long)], &[]), ["src/long.rs has 601 lines, more than 600"]);
    }

    #[test]
    fn a_big_file_unless_it_is_named_and_there() {
        let big = "x".repeat(300_001);
        assert_eq!(problems(&[GOOD, ("a.tif", &big)], &[]), ["a.tif has 300001 bytes, more than 300000"]);
        assert_none(&problems(&[GOOD, ("a.tif", &big)], &[("a.tif", "needed")]));
        assert_eq!(problems(&[GOOD], &[("a.tif", "needed")]), ["a.tif may be big, but is not there"]);
    }

    #[test]
    fn a_forbidden_word_with_its_line_unless_it_is_allowed_there() {
        for (word, reason) in FORBIDDEN {
            let text = format!("first\n// see {word}x\n");
            assert_eq!(
                problems(&[GOOD, ("a.toml", &text)], &[]),
                [format!("a.toml:2 holds `{word}`: {reason}")]
            );
        }
        for (file, word) in MAY_HOLD {
            assert_none(&problems(&[GOOD, (file, word)], &[]));
        }
    }

    #[test]
    fn what_git_ignores_is_left_alone_at_the_root_only() {
        let bad = FORBIDDEN[0].0;
        let ignore = (".gitignore", "/target\n/out/\n");
        assert_none(&problems(&[GOOD, ignore, ("target/a", bad), ("out/b/c", bad), (".git/d", bad)], &[]));
        assert_eq!(problems(&[GOOD, ignore, ("src/out/a", bad)], &[]).len(), 1);
    }

    #[test]
    fn no_source_file_is_a_failure() {
        assert_eq!(problems(&[("a.md", "")], &[]), ["there is no Rust file at all"]);
    }
}
