//! A disk in memory, which holds for certain only what was synced.
//!
//! What is assumed of it is what file systems in use keep to. A sync of a file settles its content and everything that
//! came to pass under its name; a sync of the folder settles which names there are. Anything else may have reached the
//! disk or not, one change without the other, a write in part; the bytes beside a write stay as they are.

use std::collections::BTreeMap;
use std::path::Path;

use crate::strace_log::{Change, Event};
use crate::support::Seeded;

/// Files by name.
pub type Files = BTreeMap<String, Vec<u8>>;

#[derive(Debug, Clone, Default)]
struct File {
    /// What is on disk whatever happens; `None` where that is no file.
    durable: Option<Vec<u8>>,
    pending: Vec<Change>,
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
        let safe = |(name, bytes)| (name, File { durable: Some(bytes), pending: Vec::new() });
        Self { files: files.into_iter().map(safe).collect() }
    }

    pub fn take(&mut self, event: &Event) {
        match event {
            Event::Change { file, change } => {
                self.files.entry(file.clone()).or_default().pending.push(change.clone());
            }
            Event::Sync { file } => self.files.entry(file.clone()).or_default().settle(),
            Event::SyncFolder => self.files.values_mut().for_each(File::settle_name),
            Event::Acknowledge(_) => {}
        }
    }

    /// How many changes are not yet safe.
    pub fn num_pending(&self) -> usize {
        self.files.values().map(|file| file.pending.len()).sum()
    }

    /// Everything as it was written.
    pub fn undisturbed(&self) -> Files {
        self.contents(|file| file.after(file.pending.iter()))
    }

    /// What is certain to be there.
    pub fn certain(&self) -> Files {
        self.contents(|file| file.durable.clone())
    }

    /// One of the states in which the disk may be when the power comes back.
    pub fn after_power_loss(&self, random: &mut Seeded) -> Files {
        self.contents(|file| file.after_power_loss(random))
    }

    fn contents(&self, mut content: impl FnMut(&File) -> Option<Vec<u8>>) -> Files {
        self.files.iter().filter_map(|(name, file)| Some((name.clone(), content(file)?))).collect()
    }
}

impl File {
    fn settle(&mut self) {
        self.durable = self.after(self.pending.iter());
        self.pending.clear();
    }

    /// The last change of whether there is a file is on disk; what was written to it since is not.
    fn settle_name(&mut self) {
        let is_of_the_name = |change: &Change| matches!(change, Change::Create | Change::Remove);
        if let Some(last) = self.pending.iter().rposition(is_of_the_name) {
            self.durable = self.after(self.pending.iter().take(last + 1));
            self.pending.drain(..=last);
        }
    }

    fn after<'a>(&self, changes: impl Iterator<Item = &'a Change>) -> Option<Vec<u8>> {
        changes.fold(self.durable.clone(), |content, change| apply(content, change))
    }

    fn after_power_loss(&self, random: &mut Seeded) -> Option<Vec<u8>> {
        // Each change of the name starts something of which nothing before is left, if it happened at all. If it did
        // not, nothing that was done to the file behind it can be seen either.
        let mut content = self.durable.clone();
        let mut rest = self.pending.as_slice();
        loop {
            let is_of_the_name = |change: &Change| matches!(change, Change::Create | Change::Remove);
            let end = rest.iter().position(is_of_the_name).unwrap_or(rest.len());
            let (changes, after) = rest.split_at(end);
            let Some((change_of_name, after)) = after.split_first() else {
                return keep_some(content, changes, random);
            };
            if random.below(2) == 0 {
                return keep_some(content, changes, random);
            }
            content = apply(content, change_of_name);
            rest = after;
        }
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
        Change::Create => Some(Vec::new()),
        Change::Remove => None,
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
        disk.take(&Event::SyncFolder);
        assert_eq!(states(&disk), [Some(b"".to_vec()), Some(b"n".to_vec())]);
        disk.take(&Event::Sync { file: "t".to_owned() });
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
