//! Child processes under strace: every write and sync of theirs in a list, and faults at single system calls.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use crate::script::num_steps;
use crate::strace_log::{Event, Log, parse};
use crate::support::{acknowledged, as_child, child_arguments, skip};

/// Every call that changes a file, moves in it or makes it durable. What of these a terrain does not use fails the
/// reading of the log, so that nothing changes a file unseen.
const CALLS: &str = "trace=openat,open,creat,close,read,lseek,write,writev,pwrite64,pwritev,pwritev2,ftruncate,\
    truncate,fallocate,copy_file_range,sendfile,fsync,fdatasync,sync_file_range,unlink,unlinkat,rename,renameat,\
    renameat2,link,linkat";

/// Paths and bytes in hexadecimal, and all of the bytes. Not `--seccomp-bpf`: with it no signal is injected.
const OPTIONS: [&str; 6] = ["-f", "-q", "-y", "-xx", "-s", "1048576"];

/// A child that was run under strace to its end.
pub struct Traced {
    pub log: Log,
    /// What it acknowledged.
    pub lines: Vec<String>,
    pub output: Output,
}

/// Whether processes can be traced here. Says so and counts it where they cannot: then a test has nothing to do.
pub fn is_possible(what: &str) -> bool {
    let output = Command::new("strace")
        .args(OPTIONS)
        .args(["-o", "/dev/null", "-e", CALLS, "-e", "inject=fsync:error=EIO:when=1", "true"])
        .output();
    let reason = match output {
        Ok(output) if output.status.success() => return true,
        Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        Err(err) => format!("strace: {err}"),
    };
    skip(&format!("{what}: no process can be traced ({reason})"));
    false
}

/// Runs `test` as a child that works on the terrain `path`; `fault` is what strace injects.
pub fn run(test: &str, path: &Path, fault: Option<&str>) -> Traced {
    let folder = path.parent().unwrap().canonicalize().unwrap();
    let lengths: BTreeMap<String, usize> =
        files(&folder).into_iter().map(|(name, b)| (name, b.len())).collect();
    let scratch = tempfile::tempdir().unwrap();
    let log_path = scratch.path().join("log");
    let mut command = Command::new("strace");
    command.args(OPTIONS).arg("-o").arg(&log_path).args(["-e", CALLS]);
    if let Some(fault) = fault {
        command.args(["-e", fault]);
    }
    command.arg(std::env::current_exe().unwrap()).args(child_arguments(test));
    let output = as_child(&mut command, &folder.join(path.file_name().unwrap())).output().unwrap();
    let text = std::fs::read_to_string(&log_path).unwrap();
    let log = parse(&text, &folder, lengths).unwrap_or_else(|err| panic!("{err}"));
    let lines = acknowledged(&output.stdout);
    // The order between a sync and an acknowledgement is the log's, so it must have them all.
    let in_log: Vec<_> = log
        .events
        .iter()
        .filter_map(|event| if let Event::Acknowledge(line) = event { Some(line.clone()) } else { None })
        .collect();
    assert_eq!(in_log, lines, "{}", String::from_utf8_lossy(&output.stderr));
    Traced { log, lines, output }
}

/// A run in which nothing fails.
pub fn run_undisturbed(test: &str, path: &Path, expected_steps: usize) -> Traced {
    let traced = run(test, path, None);
    assert!(traced.output.status.success(), "{}", String::from_utf8_lossy(&traced.output.stderr));
    assert_eq!(num_steps(&traced.lines), expected_steps, "{:?}", traced.lines);
    traced
}

/// The files of a folder and what is in them.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).unwrap()))
        .collect()
}
