//! What strace writes, as a plain list of what happened to the files of one folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::strace_call::{Call, number, path_of_descriptor, path_of_string};

/// What happens to one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Change {
    Create,
    Write { offset: usize, bytes: Vec<u8> },
    Truncate { length: usize },
    Remove,
}

/// What a process did, in the order in which it was done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    Change {
        file: String,
        change: Change,
    },
    Sync {
        file: String,
    },
    /// Names that came and went are on disk.
    SyncFolder,
    /// A line in which the process says that something is done.
    Acknowledge(String),
}

/// Everything that a log says.
#[derive(Debug, Default)]
pub struct Log {
    pub events: Vec<Event>,
    /// How often the thread that writes to the folder made each call, whatever on: strace places faults by this count.
    pub num_calls: BTreeMap<String, usize>,
    /// Calls on the folder or its files that failed, with the file; an empty name stands for the folder.
    pub failed: Vec<(String, String)>,
}

/// Where the next read or write of an open file goes.
struct Position {
    at: usize,
    is_append: bool,
}

/// Reads a log line by line.
struct Reader {
    folder: PathBuf,
    log: Log,
    /// The files there are, to tell a file that is made from one that is opened, with their lengths.
    lengths: BTreeMap<String, usize>,
    positions: BTreeMap<String, Position>,
    /// Calls that other threads interrupted in the log, by thread.
    unfinished: BTreeMap<String, String>,
    /// The part of a line of output that has no end yet.
    output: Vec<u8>,
    num_calls: BTreeMap<(String, String), usize>,
    /// The threads that write to the folder.
    writers: BTreeSet<String>,
}

/// Reads a log of `strace -f -y -xx`. `lengths` are the files that were in `folder` before.
///
/// # Errors
/// The first line that is not understood, with the reason: nothing that touches the folder is left out in silence.
pub fn parse(text: &str, folder: &Path, lengths: BTreeMap<String, usize>) -> Result<Log, String> {
    let mut reader = Reader {
        folder: folder.to_owned(),
        log: Log::default(),
        lengths,
        positions: BTreeMap::new(),
        unfinished: BTreeMap::new(),
        output: Vec::new(),
        num_calls: BTreeMap::new(),
        writers: BTreeSet::new(),
    };
    for line in text.lines() {
        reader.line(line).map_err(|reason| {
            let start: String = line.chars().take(300).collect();
            format!("{reason}, in this line of strace: {start}")
        })?;
    }
    if reader.writers.len() > 1 {
        return Err(format!(
            "threads {:?} write to the terrain, but strace counts by thread",
            reader.writers
        ));
    }
    let by_writer = reader.num_calls.into_iter().filter(|((thread, _), _)| reader.writers.contains(thread));
    let num_calls = by_writer.map(|((_, call), count)| (call, count)).collect();
    Ok(Log { num_calls, ..reader.log })
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let (thread, rest) = line.split_once(' ').ok_or("there is no thread number")?;
        thread.parse::<u32>().map_err(|_| "there is no thread number")?;
        let rest = rest.trim_start();
        if rest.starts_with("+++") || rest.starts_with("---") {
            return Ok(());
        }
        if let Some(start) = rest.strip_suffix("<unfinished ...>") {
            return match self.unfinished.insert(thread.to_owned(), start.trim_end().to_owned()) {
                None => Ok(()),
                Some(_) => Err("two calls of one thread at a time".to_owned()),
            };
        }
        let Some(resumed) = rest.strip_prefix("<... ") else { return self.call(thread, rest) };
        let start = self.unfinished.remove(thread).ok_or("nothing was interrupted that could go on")?;
        let (name, end) = resumed.split_once(" resumed>").ok_or("a call goes on without a name")?;
        if !start.starts_with(&format!("{name}(")) {
            return Err(format!("`{start}` goes on as another call"));
        }
        self.call(thread, &format!("{start}{end}"))
    }

    fn call(&mut self, thread: &str, text: &str) -> Result<(), String> {
        let call = Call::parse(text)?;
        *self.num_calls.entry((thread.to_owned(), call.name.to_owned())).or_default() += 1;
        let named = match call.name {
            "unlink" => path_of_string(call.argument(0)?)?,
            "unlinkat" => path_of_string(call.argument(1)?)?,
            "openat" if !call.has_failed() => path_of_descriptor(call.result)?,
            "openat" => path_of_string(call.argument(1)?)?,
            _ => match call.arguments.first() {
                Some(first) => path_of_descriptor(first)?,
                None => None,
            },
        };
        if call.name == "write" && call.argument(0)?.starts_with("1<") && !call.has_failed() {
            return self.output(&call);
        }
        let Some(path) = named else { return Ok(()) };
        let file = if path == self.folder {
            String::new()
        } else if path.parent() == Some(&self.folder) {
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        } else {
            return Ok(());
        };
        // The process was killed in it.
        if call.result == "?" {
            return Ok(());
        }
        if call.has_failed() {
            self.log.failed.push((call.name.to_owned(), file));
            return Ok(());
        }
        // SQLite's index of its log: mapped, never synced, made anew after a crash.
        if file.ends_with("-shm") {
            return Ok(());
        }
        if matches!(
            call.name,
            "pwrite64" | "write" | "ftruncate" | "fsync" | "fdatasync" | "unlink" | "unlinkat"
        ) {
            self.writers.insert(thread.to_owned());
        }
        self.call_on(&call, file)
    }

    fn output(&mut self, call: &Call<'_>) -> Result<(), String> {
        self.output.extend(call.written_bytes()?);
        while let Some(end) = self.output.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.output.drain(..=end).collect();
            if let Some(what) = String::from_utf8_lossy(&line).trim_end().strip_prefix("ack ") {
                self.log.events.push(Event::Acknowledge(what.to_owned()));
            }
        }
        Ok(())
    }

    /// A call that succeeded on a file of the folder, or on the folder itself.
    fn call_on(&mut self, call: &Call<'_>, file: String) -> Result<(), String> {
        let descriptor = |text: &str| text.split('<').next().unwrap_or_default().to_owned();
        match (call.name, file.as_str()) {
            ("openat", "") | ("close" | "read" | "lseek", "") => {}
            ("fsync" | "fdatasync", "") => self.log.events.push(Event::SyncFolder),
            (_, "") => return Err("an unknown call on the folder".to_owned()),
            ("openat", _) => {
                let flags: Vec<&str> = call.argument(2)?.split('|').collect();
                let is_append = flags.contains(&"O_APPEND");
                self.positions.insert(descriptor(call.result), Position { at: 0, is_append });
                if flags.contains(&"O_CREAT") && !self.lengths.contains_key(&file) {
                    self.change(file, Change::Create)?;
                } else if flags.contains(&"O_TRUNC") {
                    self.change(file, Change::Truncate { length: 0 })?;
                }
            }
            ("close", _) => {
                self.positions.remove(&descriptor(call.argument(0)?));
            }
            ("read", _) => self.position(call)?.at += call.returned()?,
            ("lseek", _) => self.position(call)?.at = call.returned()?,
            ("pwrite64", _) => {
                let offset = number(call.argument(3)?)?;
                self.change(file, Change::Write { offset, bytes: call.written_bytes()? })?;
            }
            ("write", _) => {
                let bytes = call.written_bytes()?;
                let length = self.lengths.get(&file).copied().unwrap_or_default();
                let position = self.position(call)?;
                let offset = if position.is_append { length } else { position.at };
                position.at = offset + bytes.len();
                self.change(file, Change::Write { offset, bytes })?;
            }
            ("ftruncate", _) => {
                let length = number(call.argument(1)?)?;
                self.change(file, Change::Truncate { length })?;
            }
            ("fsync" | "fdatasync", _) => self.log.events.push(Event::Sync { file }),
            ("unlink" | "unlinkat", _) => self.change(file, Change::Remove)?,
            (name, _) => return Err(format!("what {name} does to a file is not modelled")),
        }
        Ok(())
    }

    fn position(&mut self, call: &Call<'_>) -> Result<&mut Position, String> {
        let descriptor = call.argument(0)?.split('<').next().unwrap_or_default();
        self.positions.get_mut(descriptor).ok_or_else(|| "a file that nobody opened".to_owned())
    }

    fn change(&mut self, file: String, change: Change) -> Result<(), String> {
        match &change {
            Change::Create => drop(self.lengths.insert(file.clone(), 0)),
            Change::Remove => drop(self.lengths.remove(&file)),
            Change::Write { .. } | Change::Truncate { .. } => {
                let length = self.lengths.get_mut(&file).ok_or("a file that there is not")?;
                *length = match &change {
                    Change::Write { offset, bytes } => (*length).max(offset + bytes.len()),
                    Change::Truncate { length } => *length,
                    Change::Create | Change::Remove => *length,
                };
            }
        }
        self.log.events.push(Event::Change { file, change });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hex(text: &str) -> String {
        text.bytes().map(|byte| format!("\\x{byte:02x}")).collect()
    }

    /// Makes a log readable: `[..]` stands for the text in it, in hexadecimal.
    fn log(lines: &[&str]) -> Result<Log, String> {
        let text = lines.join("\n");
        let mut parts = text.split('[');
        let mut coded = parts.next().unwrap().to_owned();
        for part in parts {
            let (text, rest) = part.split_once(']').unwrap();
            coded += &hex(text);
            coded += rest;
        }
        parse(&coded, Path::new("/d"), BTreeMap::from([("t".to_owned(), 10)]))
    }

    fn change(file: &str, change: Change) -> Event {
        Event::Change { file: file.to_owned(), change }
    }

    fn write(file: &str, offset: usize, text: &str) -> Event {
        change(file, Change::Write { offset, bytes: text.as_bytes().to_owned() })
    }

    #[test]
    fn writes_syncs_and_acknowledgements_come_in_their_order() {
        let log = log(&[
            r#"7 openat(AT_FDCWD<[/]>, "[/d/t]", O_RDWR|O_CREAT|O_CLOEXEC, 0644) = 3<[/d/t]>"#,
            r#"7 openat(AT_FDCWD<[/]>, "[/d/t-wal]", O_RDWR|O_CREAT, 0644) = 4<[/d/t-wal]>"#,
            r#"7 pwrite64(4<[/d/t-wal]>, "[abc]", 3, 512) = 2"#,
            r#"7 pwrite64(5<[/d/t-shm]>, "[a]", 1, 0) = 1"#,
            r#"7 pwrite64(6<[/elsewhere/t]>, "[a]", 1, 0) = 1"#,
            r#"7 fsync(4<[/d/t-wal]>) = 0"#,
            r#"7 fdatasync(8<[/d]>) = 0"#,
            r#"7 write(1<pipe:8>, "[ack st]", 6) = 6"#,
            r#"7 write(1<pipe:8>, "[ep 1]\x0a[not this]", 13) = 13"#,
            r#"7 ftruncate(3<[/d/t]>, 4) = 0"#,
            r#"7 unlink("[/d/t-wal]") = 0"#,
            r#"7 unlinkat(AT_FDCWD<[/]>, "[/d/none]", 0) = -1 ENOENT (No such file or directory)"#,
            "7 +++ exited with 0 +++",
        ])
        .unwrap();
        let expected = [
            change("t-wal", Change::Create),
            write("t-wal", 512, "ab"),
            Event::Sync { file: "t-wal".to_owned() },
            Event::SyncFolder,
            Event::Acknowledge("step 1".to_owned()),
            change("t", Change::Truncate { length: 4 }),
            change("t-wal", Change::Remove),
        ];
        assert_eq!(log.events, expected);
        assert_eq!(log.num_calls.get("pwrite64"), Some(&3));
        assert_eq!(log.failed, [("unlinkat".to_owned(), "none".to_owned())]);
    }

    #[test]
    fn a_plain_write_goes_where_the_file_stands() {
        let log = log(&[
            r#"7 openat(AT_FDCWD<[/]>, "[/d/t]", O_RDWR) = 3<[/d/t]>"#,
            r#"7 write(3<[/d/t]>, "[ab]", 2) = 2"#,
            r#"7 read(3<[/d/t]>, "[xyz]", 3) = 3"#,
            r#"7 write(3<[/d/t]>, "[c]", 1) = 1"#,
            r#"7 lseek(3<[/d/t]>, 1, SEEK_SET) = 1"#,
            r#"7 write(3<[/d/t]>, "[d]", 1) = 1"#,
            r#"7 close(3<[/d/t]>) = 0"#,
            r#"7 openat(AT_FDCWD<[/]>, "[/d/t]", O_WRONLY|O_APPEND) = 3<[/d/t]>"#,
            r#"7 write(3<[/d/t]>, "[e]", 1) = 1"#,
            r#"7 openat(AT_FDCWD<[/]>, "[/d/t]", O_WRONLY|O_CREAT|O_TRUNC, 0644) = 4<[/d/t]>"#,
        ])
        .unwrap();
        let expected = [
            write("t", 0, "ab"),
            write("t", 5, "c"),
            write("t", 1, "d"),
            write("t", 10, "e"),
            change("t", Change::Truncate { length: 0 }),
        ];
        assert_eq!(log.events, expected);
    }

    #[test]
    fn an_interrupted_call_counts_when_it_returns() {
        let log = log(&[
            r#"7 pwrite64(3<[/d/t]>, "[ab]", 2, 0 <unfinished ...>"#,
            "8 close(9<[/x]> <unfinished ...>",
            "7 <... pwrite64 resumed>)           = 2",
            "8 <... close resumed>)              = 0",
            "7 fsync(3<[/d/t]> <unfinished ...>",
            "7 <... fsync resumed>)              = ?",
            "7 +++ killed by SIGKILL +++",
        ])
        .unwrap();
        assert_eq!(log.events, [write("t", 0, "ab")]);
        assert_eq!(log.num_calls.get("fsync"), Some(&1));
        assert_eq!(log.num_calls.get("close"), None);
    }

    #[test]
    fn what_is_injected_is_listed_and_a_removed_file_is_gone() {
        let log = log(&[
            "7 fsync(3<[/d/t]>) = -1 EIO (Input/output error) (INJECTED)",
            r#"7 pwrite64(3<[/d/t]>(deleted), "[ab]", 2, 0) = 2"#,
            "7 close(3<[/d/t]>(deleted)) = 0",
        ])
        .unwrap();
        assert_eq!(log.events, []);
        assert_eq!(log.failed, [("fsync".to_owned(), "t".to_owned())]);
    }

    #[test]
    fn nothing_that_is_not_understood_is_passed_over() {
        let lines = [
            "fsync(3<[/d/t]>) = 0",
            "7 strace: something",
            "7 fsync(3<[/d/t]>",
            "7 <... fsync resumed>) = 0",
            r#"7 pwrite64(3<[/d/t]>, "[ab]"..., 2, 0) = 2"#,
            r#"7 pwrite64(3<[/d/t]>, "[ab]", 3, 0) = 3"#,
            r#"7 pwrite64(3<[/d/t]>, "ab", 2, 0) = 2"#,
            r#"7 pwrite64(3<[/d/t]>, "[ab]", 2, x) = 2"#,
            r#"7 pwrite64(3<[/d/new]>, "[ab]", 2, 0) = 2"#,
            r#"7 write(3<[/d/t]>, "[ab]", 2) = 2"#,
            "7 pwritev(3<[/d/t]>, {}, 1, 0) = 2",
            "7 fallocate(3<[/d/t]>, 0, 0, 9) = 0",
        ];
        for line in lines {
            assert!(log(&[line]).is_err(), "{line}");
        }
        let two_writers = ["7 fsync(3<[/d/t]>) = 0", "8 fsync(3<[/d/t]>) = 0"];
        assert!(log(&two_writers).unwrap_err().contains("strace counts by thread"));
    }
}
