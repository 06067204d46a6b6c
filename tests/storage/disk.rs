//! A disk in memory, which holds for certain only what was synced.
//!
//! What is assumed of it is what POSIX promises and no more: a sync of a file settles its content, a sync of the folder
//! settles which names there are and what they stand for. Anything else may have reached the disk or not, one change
//! without the other, a write in part. The bytes beside a write stay as they are, which SQLite assumes too.

use std::collections::BTreeMap;
use std::path::Path;

use crate::strace_log::{Change, Event};
use crate::support::Seeded;

/// Files by name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// What a name stands for, or that it stands for nothing, since it was last made or removed.
#[derive(Debug, Clone, Default)]
struct Generation {
    /// What is on disk whatever happens; `None` where that is no file.
    durable: Option<Vec<u8>>,
    /// Writes and changes of length that were not synced.
    pending: Vec<Change>,
}

/// A name: what it certainly stood for at some time, and what it was made to stand for since. One of these is there.
#[derive(Debug, Clone)]
struct File {
    certain: Generation,
    newer: Vec<Generation>,
}

#[derive(Debug, Clone)]
pub struct Disk {
    files: BTreeMap<String, File>,
}

/// What becomes of the writes to a file that were not synced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    KeepAll,
    DropAll,
    /// Those up to one are kept, the last of them in part.
    KeepFirst,
    /// Each may be kept or not, a later one without an earlier one.
    KeepSome,
    /// As before, and sectors of each may be kept or not.
    Tear,
}

const LOSSES: [Loss; 5] = [Loss::KeepAll, Loss::DropAll, Loss::KeepFirst, Loss::KeepSome, Loss::Tear];

/// What a disk writes at a time.
const SECTORS: [usize; 2] = [512, 4096];

impl Disk {
    /// On which `files` are safe.
    pub fn new(files: Files) -> Self {
        Self { files: files.into_iter().map(|(name, bytes)| (name, File::new(Some(bytes)))).collect() }
    }

    pub fn take(&mut self, event: &Event) {
        match event {
            Event::Change { file, change } => self.file(file).take(change),
            Event::Sync { file } => self.file(file).now().settle(),
            Event::SyncFolder => self.files.values_mut().for_each(File::settle_name),
            Event::Acknowledge(_) => {}
        }
    }

    fn file(&mut self, name: &str) -> &mut File {
        self.files.entry(name.to_owned()).or_insert_with(|| File::new(None))
    }

    /// How many changes are not yet safe.
    pub fn num_pending(&self) -> usize {
        let num_of_file =
            |file: &File| file.newer.len() + file.newer.last().unwrap_or(&file.certain).pending.len();
        self.files.values().map(num_of_file).sum()
    }

    /// Everything as it was written.
    pub fn undisturbed(&self) -> Files {
        self.contents(|file| file.newer.last().unwrap_or(&file.certain).all())
    }

    /// What is certain to be there.
    pub fn certain(&self) -> Files {
        self.contents(|file| file.certain.durable.clone())
    }

    /// One of the states in which the disk may be when the power comes back.
    pub fn after_power_loss(&self, random: &mut Seeded) -> Files {
        self.contents(|file| {
            let newest = random.below(file.newer.len() as u64 + 1) as usize;
            let generation = newest.checked_sub(1).map_or(&file.certain, |index| &file.newer[index]);
            keep_some(generation.durable.clone(), &generation.pending, random)
        })
    }

    fn contents(&self, mut content: impl FnMut(&File) -> Option<Vec<u8>>) -> Files {
        self.files.iter().filter_map(|(name, file)| Some((name.clone(), content(file)?))).collect()
    }
}

impl File {
    fn new(durable: Option<Vec<u8>>) -> Self {
        Self { certain: Generation { durable, pending: Vec::new() }, newer: Vec::new() }
    }

    fn now(&mut self) -> &mut Generation {
        self.newer.last_mut().unwrap_or(&mut self.certain)
    }

    fn take(&mut self, change: &Change) {
        match change {
            Change::Create => self.newer.push(Generation { durable: Some(Vec::new()), pending: Vec::new() }),
            Change::Remove => self.newer.push(Generation::default()),
            Change::Write { .. } | Change::Truncate { .. } => self.now().pending.push(change.clone()),
        }
    }

    fn settle_name(&mut self) {
        if let Some(newest) = self.newer.pop() {
            self.newer.clear();
            self.certain = newest;
        }
    }
}

impl Generation {
    fn settle(&mut self) {
        self.durable = self.all();
        self.pending.clear();
    }

    fn all(&self) -> Option<Vec<u8>> {
        self.pending.iter().fold(self.durable.clone(), apply)
    }
}

fn keep_some(mut content: Option<Vec<u8>>, changes: &[Change], random: &mut Seeded) -> Option<Vec<u8>> {
    let loss = LOSSES[random.below(LOSSES.len() as u64) as usize];
    let sector = SECTORS[random.below(SECTORS.len() as u64) as usize];
    let last = random.below(changes.len() as u64 + 1) as usize;
    for (index, change) in changes.iter().enumerate() {
        let (is_kept, is_torn) = match loss {
            Loss::KeepAll => (true, false),
            Loss::DropAll => (false, false),
            Loss::KeepFirst => (index <= last, index == last),
            Loss::KeepSome => (random.below(2) == 0, false),
            Loss::Tear => (random.below(2) == 0, true),
        };
        match change {
            Change::Write { offset, bytes } if is_kept && is_torn => {
                for (offset, bytes) in sectors(*offset, bytes, sector) {
                    if random.below(2) == 0 {
                        content = apply(content, &Change::Write { offset, bytes: bytes.to_vec() });
                    }
                }
            }
            _ if is_kept => content = apply(content, change),
            _ => {}
        }
    }
    content
}

/// Cuts a write at the borders of sectors.
fn sectors(offset: usize, bytes: &[u8], sector: usize) -> Vec<(usize, &[u8])> {
    let mut parts = Vec::new();
    let (mut offset, mut rest) = (offset, bytes);
    while !rest.is_empty() {
        let (part, after) = rest.split_at((sector - offset % sector).min(rest.len()));
        parts.push((offset, part));
        offset += part.len();
        rest = after;
    }
    parts
}

fn apply(content: Option<Vec<u8>>, change: &Change) -> Option<Vec<u8>> {
    match change {
        // These begin a generation instead.
        Change::Create | Change::Remove => content,
        Change::Truncate { length } => content.map(|mut bytes| {
            bytes.resize(*length, 0);
            bytes
        }),
        Change::Write { offset, bytes: written } => content.map(|mut bytes| {
            let end = offset + written.len();
            let length = bytes.len().max(end);
            bytes.resize(length, 0);
            bytes[*offset..end].copy_from_slice(written);
            bytes
        }),
    }
}

/// Puts files into a fresh folder.
pub fn lay_out(files: &Files) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(Path::new(name)), bytes).unwrap();
    }
    folder
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(change: Change) -> Event {
        Event::Change { file: "t".to_owned(), change }
    }

    fn write(offset: usize, bytes: &[u8]) -> Event {
        event(Change::Write { offset, bytes: bytes.to_vec() })
    }

    fn states(disk: &Disk) -> Vec<Option<Vec<u8>>> {
        let mut random = Seeded(1);
        let mut states: Vec<_> =
            (0..1000).map(|_| disk.after_power_loss(&mut random).get("t").cloned()).collect();
        states.sort();
        states.dedup();
        states
    }

    #[test]
    fn what_was_synced_stays_and_the_rest_may_be_there_or_not() {
        let mut disk = Disk::new(Files::from([("t".to_owned(), b"....".to_vec())]));
        disk.take(&write(0, b"a"));
        disk.take(&Event::Sync { file: "t".to_owned() });
        assert_eq!(states(&disk), [Some(b"a...".to_vec())]);
        disk.take(&write(1, b"b"));
        disk.take(&write(2, b"c"));
        let expected = [b"a...", b"a.c.", b"ab..", b"abc."].map(|bytes| Some(bytes.to_vec()));
        assert_eq!(states(&disk), expected);
        assert_eq!(disk.certain()["t"], b"a...");
        assert_eq!(disk.undisturbed()["t"], b"abc.");
    }

    #[test]
    fn a_file_that_was_removed_may_come_back() {
        let mut disk = Disk::new(Files::from([("t".to_owned(), b"old".to_vec())]));
        disk.take(&event(Change::Remove));
        assert_eq!(states(&disk), [None, Some(b"old".to_vec())]);
        disk.take(&event(Change::Create));
        disk.take(&write(0, b"n"));
        let expected = [None, Some(b"".to_vec()), Some(b"n".to_vec()), Some(b"old".to_vec())];
        assert_eq!(states(&disk), expected);
        disk.take(&Event::Sync { file: "t".to_owned() });
        assert_eq!(states(&disk), [None, Some(b"n".to_vec()), Some(b"old".to_vec())]);
        assert_eq!(disk.certain()["t"], b"old");
        disk.take(&Event::SyncFolder);
        assert_eq!(states(&disk), [Some(b"n".to_vec())]);
    }

    #[test]
    fn writes_are_torn_at_the_borders_of_sectors() {
        let bytes = [1; 1000];
        let lengths: Vec<_> =
            sectors(500, &bytes, 512).into_iter().map(|(offset, part)| (offset, part.len())).collect();
        assert_eq!(lengths, [(500, 12), (512, 512), (1024, 476)]);
        let mut disk = Disk::new(Files::from([("t".to_owned(), vec![0; 1500])]));
        disk.take(&write(500, &bytes));
        assert!(
            states(&disk)
                .iter()
                .flatten()
                .any(|state| state[500] == 0 && state[512] == 1 && state[1024] == 0)
        );
    }
}
