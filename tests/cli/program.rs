//! The program, a folder to work in, and what came of a command.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// The program under test, which cargo builds with the tests.
pub fn binary() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_orogeny"))
}

/// A folder of its own, in which the program runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The heights in a `.r32`.
    pub fn heights(&self, name: &str) -> Vec<f32> {
        let bytes = self.read(name);
        let (samples, rest) = bytes.as_chunks();
        assert!(rest.is_empty(), "{name} holds no whole samples");
        samples.iter().map(|sample| f32::from_le_bytes(*sample)).collect()
    }

    /// Every file in it with its bytes.
    pub fn state(&self) -> BTreeMap<String, Vec<u8>> {
        let files = std::fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap());
        files
            .map(|file| {
                (file.file_name().into_string().unwrap(), std::fs::read(file.path()).unwrap_or_default())
            })
            .collect()
    }

    /// The program with arguments separated by spaces, on the CPU back end unless they say otherwise.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(binary());
        command.current_dir(self.0.path()).args(line.split_whitespace()).stdin(Stdio::null());
        // Whoever runs the tests may have presets of their own.
        command.env("OROGENY_PRESETS", self.path("presets"));
        if !line.contains("--adapter") {
            command.args(["--adapter", "cpu"]);
        }
        command
    }

    /// Runs the program.
    pub fn run(&self, line: &str) -> Ran {
        Ran::from(self.command(line).output().unwrap())
    }

    /// Runs the program, which must succeed, and gives what it reported.
    pub fn succeed(&self, line: &str) -> Value {
        let ran = self.run(&format!("{line} --json"));
        assert_eq!(ran.code, Some(0), "{line}: {ran:?}");
        serde_json::from_str(&ran.stdout).unwrap_or_else(|err| panic!("{line}: {err}: {}", ran.stdout))
    }

    /// Applies operations to a terrain, which must succeed, and gives what was reported.
    pub fn apply(&self, terrain: &str, options: &str, operations: &Value) -> Value {
        self.write("recipe.json", serde_json::json!({ "operations": operations }).to_string());
        self.succeed(&format!("apply {terrain} recipe.json {options}"))
    }

    /// The heights of a terrain, as an export has them.
    pub fn heights_of(&self, terrain: &str) -> Vec<f32> {
        self.succeed(&format!("export {terrain} out.r32"));
        self.heights("out.r32")
    }

    /// Runs the program, which must fail with a message that holds all `words`, and must change nothing.
    pub fn fail(&self, line: &str, words: &[&str]) {
        let before = self.state();
        let ran = self.run(line);
        ran.assert_failed(line, words);
        self.assert_state(&before, line);
    }

    /// As [`fail`](Self::fail), with something to read on standard input.
    pub fn fail_with_stdin(&self, line: &str, input: &str, words: &[&str]) {
        let before = self.state();
        let mut command = self.command(line);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        Ran::from(child.wait_with_output().unwrap()).assert_failed(line, words);
        self.assert_state(&before, line);
    }

    /// Nothing has changed since.
    pub fn assert_state(&self, before: &BTreeMap<String, Vec<u8>>, what: &str) {
        let after = self.state();
        assert!(
            before.keys().eq(after.keys()),
            "{what}: there were {:?}, there are {:?}",
            before.keys(),
            after.keys()
        );
        let changed: Vec<_> = before.iter().filter(|(name, bytes)| after[*name] != **bytes).collect();
        assert!(
            changed.is_empty(),
            "{what} changed {:?}",
            changed.iter().map(|(name, _)| name).collect::<Vec<_>>()
        );
    }
}

/// What came of a command.
#[derive(Debug)]
pub struct Ran {
    /// `None` where a signal ended it.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Ran {
    /// Exit code 1 or 2, nothing reported, and a message that holds all `words`.
    pub fn assert_failed(&self, what: &str, words: &[&str]) {
        assert!(matches!(self.code, Some(1 | 2)), "{what}: {self:?}");
        assert_eq!(self.stdout, "", "{what}");
        assert!(self.stderr.contains("error: "), "{what}: {self:?}");
        for word in words {
            assert!(self.stderr.contains(word), "{what}: `{word}` is not in {}", self.stderr);
        }
    }
}

mod tester {
    //! The checks above can fail.

    use super::*;

    #[test]
    #[should_panic(expected = "changed")]
    fn a_changed_byte_is_seen() {
        let folder = Folder::new();
        folder.write("a", "1");
        let before = folder.state();
        folder.write("a", "2");
        folder.assert_state(&before, "writing");
    }

    #[test]
    #[should_panic(expected = "there are")]
    fn a_file_left_behind_is_seen() {
        let folder = Folder::new();
        let before = folder.state();
        folder.write("a", "");
        folder.assert_state(&before, "writing");
    }

    #[test]
    #[should_panic(expected = "is not in")]
    fn a_message_that_does_not_name_the_thing_is_seen() {
        let ran = Ran { code: Some(1), stdout: String::new(), stderr: "error: no\n".to_owned() };
        ran.assert_failed("it", &["the thing"]);
    }

    #[test]
    #[should_panic(expected = "code: Some(0)")]
    fn success_is_no_failure() {
        let ran = Ran { code: Some(0), stdout: String::new(), stderr: "error: the thing\n".to_owned() };
        ran.assert_failed("it", &["the thing"]);
    }
}
