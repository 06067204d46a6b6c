//! The companion of a terrain that is open for writing: `NAME.orogeny-head`.
//!
//! It does two things. A lock on it keeps a second writer out, who reads in it who holds it. And it remembers, outside the
//! database and its log, what the last acknowledged commit was: SQLite takes a log that lost its tail for a shorter one,
//! without a word; a terrain that is behind this record has lost something that was on disk.
//!
//! | bytes | content |
//! | --- | --- |
//! | 0..48, 4096..4144 | two slots, written in turn, so that a torn write leaves the other one: magic, sequence, hash of the `document` row, checksum of these |
//! | 8192.. | JSON: who has the terrain open |
//!
//! A clean close removes the file. It stays while a log does: after a kill, and when someone still reads the terrain.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use crate::checksum::{Checksum, RowHasher};
use crate::database::{companion, has_log};
use crate::error::Holder;
use crate::{Error, Result, format};

const MAGIC: [u8; 8] = *b"OROGHEAD";
/// Each slot in a block of its own: a block is what a disk writes at once.
const SLOT_OFFSETS: [u64; 2] = [0, 4096];
const HOLDER_OFFSET: u64 = 8192;
/// More than any holder writes; more is not read.
const MAX_HOLDER_BYTES: u64 = 4096;
/// Attempts to lock a file that others keep removing under us.
const MAX_LOCK_ATTEMPTS: u32 = 100;

/// The last commit that was on disk when it was acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LastCommit {
    /// Number of the commit, from 1.
    pub(crate) sequence: u64,
    /// Checksum of the `document` row that it left.
    pub(crate) hash: Checksum,
}

/// A slot as it lies in the file.
type Slot = [u8; 8 + 8 + 16 + 16];

/// The record, locked for this writer.
#[derive(Debug)]
pub(crate) struct Head {
    file: File,
    terrain: PathBuf,
    next_slot: usize,
    /// The record may be evidence of something lost: it stays.
    is_evidence: bool,
}

impl Head {
    /// Locks a terrain for writing, and gives the commit that the last writer acknowledged, should it not have closed the
    /// terrain.
    pub(crate) fn lock(terrain: &Path) -> Result<(Self, Option<LastCommit>)> {
        let path = companion(terrain, format::HEAD_SUFFIX);
        let failed = |err: &std::io::Error| Error::from_io(terrain, err);
        let mut file = locked(terrain, &path)?;
        let last = last_commit(&mut file).map_err(|err| failed(&err))?;
        let holder = Holder::this_process();
        let text = serde_json::to_vec(&holder).unwrap_or_default();
        let write = |file: &mut File| {
            if last.is_none() {
                // Both slots get their blocks now, so that no commit needs new space for its record.
                file.set_len(0)?;
                file.write_all(&vec![0; HOLDER_OFFSET as usize])?;
            }
            file.set_len(HOLDER_OFFSET)?;
            file.seek(SeekFrom::Start(HOLDER_OFFSET))?;
            file.write_all(&text)?;
            file.sync_all()?;
            sync_folder(&path)
        };
        write(&mut file).map_err(|err| failed(&err))?;
        let next_slot = last.map_or(0, |(slot, _)| 1 - slot);
        Ok((
            Self { file, terrain: terrain.to_owned(), next_slot, is_evidence: last.is_some() },
            last.map(|(_, commit)| commit),
        ))
    }

    /// What was last acknowledged, for those who only read; `None` where no writer left a record.
    pub(crate) fn read(terrain: &Path) -> Result<Option<LastCommit>> {
        match File::open(companion(terrain, format::HEAD_SUFFIX)) {
            Ok(mut file) => {
                let last = last_commit(&mut file).map_err(|err| Error::from_io(terrain, &err))?;
                Ok(last.map(|(_, commit)| commit))
            }
            // No record, or none for us: the terrain itself still has its checksums.
            Err(_) => Ok(None),
        }
    }

    /// The terrain holds all that the record says: it may go with the log.
    pub(crate) const fn nothing_is_lost(&mut self) {
        self.is_evidence = false;
    }

    /// Forgets what was acknowledged: what was lost of it is known and accepted.
    pub(crate) fn forget(&mut self) -> std::io::Result<()> {
        for offset in SLOT_OFFSETS {
            self.file.seek(SeekFrom::Start(offset))?;
            self.file.write_all(&Slot::from([0; 48]))?;
        }
        self.file.sync_data()
    }

    /// Notes a commit that is on disk; when this returns, so is the note.
    pub(crate) fn record(&mut self, commit: &LastCommit) -> std::io::Result<()> {
        let offset = SLOT_OFFSETS.get(self.next_slot).copied().unwrap_or_default();
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.write_all(&slot(commit))?;
        self.file.sync_data()?;
        self.next_slot = 1 - self.next_slot;
        Ok(())
    }
}

impl Drop for Head {
    /// The end of a writer. Where a log is left, so is the record: it belongs to it.
    fn drop(&mut self) {
        if !self.is_evidence && !has_log(&self.terrain) {
            // While it is locked, so that no one else can have taken it over. Should it stay, it does no harm: it names a
            // commit that the terrain holds.
            std::fs::remove_file(companion(&self.terrain, format::HEAD_SUFFIX)).ok();
        }
    }
}

fn locked(terrain: &Path, path: &Path) -> Result<File> {
    for _ in 0..MAX_LOCK_ATTEMPTS {
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = opened.map_err(|err| Error::from_io(terrain, &err))?;
        match file.try_lock() {
            Ok(()) if is_still_there(&file, path) => return Ok(file),
            // Whoever had it removed it between our opening and locking it.
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let path = terrain.to_owned();
                return Err(Error::Busy { path, holder: holder(&mut file) });
            }
            Err(TryLockError::Error(err)) => return Err(Error::from_io(terrain, &err)),
        }
    }
    Err(Error::Busy { path: terrain.to_owned(), holder: None })
}

/// Whether the path still leads to the file. Elsewhere than on Unix there is no asking; a name whose file is to be removed
/// cannot be opened there.
#[cfg(unix)]
fn is_still_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(ours), Ok(there)) => place(ours) == place(there),
        _ => false,
    }
}

#[cfg(not(unix))]
const fn is_still_there(_file: &File, _path: &Path) -> bool {
    true
}

/// Makes the name of a new file durable, where folders can be synced.
fn sync_folder(path: &Path) -> std::io::Result<()> {
    if cfg!(unix)
        && let Some(folder) = path.parent()
    {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

fn holder(file: &mut File) -> Option<Holder> {
    let mut text = Vec::new();
    file.seek(SeekFrom::Start(HOLDER_OFFSET)).ok()?;
    file.take(MAX_HOLDER_BYTES).read_to_end(&mut text).ok()?;
    serde_json::from_slice(&text).ok()
}

/// The newest whole slot, and which one it is.
fn last_commit(file: &mut File) -> std::io::Result<Option<(usize, LastCommit)>> {
    let mut newest: Option<(usize, LastCommit)> = None;
    for (index, offset) in SLOT_OFFSETS.into_iter().enumerate() {
        let mut bytes = Slot::from([0; 48]);
        file.seek(SeekFrom::Start(offset))?;
        match file.read_exact(&mut bytes) {
            Ok(()) => {}
            Err(err) if err.kind() == std::io::ErrorKind::UnexpectedEof => continue,
            Err(err) => return Err(err),
        }
        if let Some(commit) = commit_in(&bytes)
            && newest.is_none_or(|(_, newest)| commit.sequence > newest.sequence)
        {
            newest = Some((index, commit));
        }
    }
    Ok(newest)
}

fn slot(commit: &LastCommit) -> Slot {
    let mut slot = [0; 48];
    let checksum = checksum(commit);
    let parts: [&[u8]; 4] = [&MAGIC, &commit.sequence.to_le_bytes(), &commit.hash, &checksum];
    for (to, from) in slot.iter_mut().zip(parts.into_iter().flatten()) {
        *to = *from;
    }
    slot
}

fn commit_in(slot: &Slot) -> Option<LastCommit> {
    let (magic, rest) = slot.split_first_chunk::<8>()?;
    let (sequence, rest) = rest.split_first_chunk::<8>()?;
    let (hash, rest) = rest.split_first_chunk::<16>()?;
    let commit = LastCommit { sequence: u64::from_le_bytes(*sequence), hash: *hash };
    (*magic == MAGIC && rest == checksum(&commit)).then_some(commit)
}

fn checksum(commit: &LastCommit) -> Checksum {
    RowHasher::new("head").number(commit.sequence.cast_signed()).bytes(&commit.hash).finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commit(sequence: u64) -> LastCommit {
        LastCommit { sequence, hash: [sequence as u8; 16] }
    }

    /// A terrain whose writer was killed after these commits: its log is there.
    fn left_behind(folder: &Path, commits: std::ops::RangeInclusive<u64>) -> PathBuf {
        let terrain = folder.join("t.orogeny");
        std::fs::write(companion(&terrain, "-wal"), "log").unwrap();
        let (mut head, last) = Head::lock(&terrain).unwrap();
        assert_eq!(last, None);
        for sequence in commits {
            head.record(&commit(sequence)).unwrap();
            assert_eq!(Head::read(&terrain).unwrap(), Some(commit(sequence)));
        }
        terrain
    }

    #[test]
    fn the_record_stays_with_a_log_and_goes_without_one() {
        let folder = tempfile::tempdir().unwrap();
        let terrain = left_behind(folder.path(), 1..=5);
        // Whoever does not get as far as comparing them leaves the record.
        drop(Head::lock(&terrain).unwrap());
        let (mut head, last) = Head::lock(&terrain).unwrap();
        assert_eq!(last, Some(commit(5)));
        head.nothing_is_lost();
        head.record(&commit(6)).unwrap();
        assert_eq!(Head::read(&terrain).unwrap(), Some(commit(6)));
        std::fs::remove_file(companion(&terrain, "-wal")).unwrap();
        drop(head);
        assert_eq!(Head::read(&terrain).unwrap(), None);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_torn_slot_leaves_the_one_before() {
        let folder = tempfile::tempdir().unwrap();
        let terrain = left_behind(folder.path(), 1..=2);
        let path = companion(&terrain, format::HEAD_SUFFIX);
        let whole = std::fs::read(&path).unwrap();
        for at in [4096, 4105, 4120, 4143] {
            let mut torn = whole.clone();
            torn[at] ^= 1;
            std::fs::write(&path, torn).unwrap();
            assert_eq!(Head::read(&terrain).unwrap(), Some(commit(1)), "byte {at}");
        }
        std::fs::write(&path, &whole[..40]).unwrap();
        assert_eq!(Head::read(&terrain).unwrap(), None);
    }

    #[test]
    fn a_second_writer_learns_who_is_first() {
        let folder = tempfile::tempdir().unwrap();
        let terrain = folder.path().join("t.orogeny");
        let (_head, _) = Head::lock(&terrain).unwrap();
        let Err(Error::Busy { holder: Some(holder), .. }) = Head::lock(&terrain) else {
            panic!("not refused")
        };
        assert_eq!(holder.process, std::process::id());
    }
}
