//! A killed painter whose log then loses its end, or has it overwritten: nothing is lost in silence.

use std::path::{Path, PathBuf};
use std::time::Duration;

use orogeny_engine::{Error, Terrain};
use orogeny_store::Error as StoreError;
use orogeny_tests::Random;
use orogeny_tests::child::{child_path, is_long};

use crate::kill::{paint_without_pause, painted_and_killed};
use crate::painter::{assert_history_is_of_strokes, assert_kept};
use crate::support::{assert_is_replay, assert_whole, create, settings};

/// What becomes of the end of the log.
#[derive(Debug, Clone, Copy)]
enum Tear {
    /// So many bytes are cut off.
    Cut(usize),
    /// So many bytes are rubbish.
    Rubbish(usize),
    /// So many bytes of rubbish follow: nothing is lost.
    More(usize),
}

impl Tear {
    /// One of each kind, and one that leaves nothing.
    fn of(log: usize, random: &mut Random) -> [Self; 6] {
        // As often a few bytes as a few commits.
        let mut length = || ((log as f64).powf(random.within(0.1, 1.0)) as usize).clamp(1, log);
        [
            Self::Cut(length()),
            Self::Cut(length()),
            Self::Rubbish(length()),
            Self::Rubbish(length()),
            Self::More(length()),
            Self::Cut(log),
        ]
    }

    fn tear(self, log: &mut Vec<u8>, random: &mut Random) {
        match self {
            Self::Cut(length) => log.truncate(log.len() - length),
            Self::Rubbish(length) => {
                let start = log.len() - length;
                log[start..].fill_with(|| random.bits() as u8);
            }
            Self::More(length) => log.extend((0..length).map(|_| random.bits() as u8)),
        }
    }
}

/// A copy of a terrain and its companions, its log torn.
fn torn_copy(path: &Path, tear: Tear, random: &mut Random) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(path.parent().unwrap()).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    let log = folder.path().join("t.orogeny-wal");
    let mut bytes = std::fs::read(&log).unwrap();
    tear.tear(&mut bytes, random);
    std::fs::write(&log, bytes).unwrap();
    let copy = folder.path().join("t.orogeny");
    (folder, copy)
}

/// Checks what a torn log left. Gives how many commits it cost.
fn assert_nothing_is_lost_in_silence(path: &Path, lines: &[String]) -> u64 {
    let (found, acknowledged) = match Terrain::open(path, settings()) {
        Ok(terrain) => {
            drop(terrain);
            assert_kept(path, lines);
            return 0;
        }
        Err(Error::Store(StoreError::LostCommits { found, acknowledged, .. })) => (found, acknowledged),
        Err(err) => panic!("{err}"),
    };
    assert!(found < acknowledged);
    // Refusing it changed nothing, and the check says that and no more.
    let report = Terrain::check(path).unwrap();
    let [StoreError::LostCommits { found: f, acknowledged: a, .. }] = report.problems.as_slice() else {
        panic!("{:#?}", report.problems);
    };
    assert_eq!((*f, *a), (found, acknowledged));
    let repaired = Terrain::repair(path).unwrap();
    assert_eq!(repaired.lost_commits, Some((found, acknowledged)));
    assert!(repaired.pages_from_history.is_empty() && repaired.lost_pages.is_empty());
    assert_whole(path);
    let mut terrain = Terrain::open(path, settings()).unwrap();
    let log = assert_history_is_of_strokes(&terrain);
    assert_is_replay(&terrain, path);
    // It goes on from there.
    let next = log.len() as u32 + 1;
    crate::support::apply(&mut terrain, &[crate::support::stroke(next)]);
    assert_is_replay(&terrain, path);
    acknowledged - found
}

#[test]
fn a_log_that_lost_its_end_is_seen_and_repaired() {
    if let Some(path) = child_path() {
        paint_without_pause(&path);
    }
    const TEST: &str = "torn::a_log_that_lost_its_end_is_seen_and_repaired";
    let num_kills = if is_long() { 50 } else { 2 };
    let mut random = Random::new(0x05ee_d002);
    let (mut num_tears, mut num_whole, mut num_lost_commits) = (0, 0, 0);
    for _ in 0..num_kills {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.orogeny");
        create(&path).close().unwrap();
        let delay = Duration::from_micros(random.within(100_000.0, 400_000.0) as u64);
        let lines = painted_and_killed(TEST, &path, delay);
        let log = std::fs::metadata(folder.path().join("t.orogeny-wal")).unwrap().len() as usize;
        for tear in Tear::of(log, &mut random) {
            let (_folder, copy) = torn_copy(&path, tear, &mut random);
            let num_lost = assert_nothing_is_lost_in_silence(&copy, &lines);
            assert!(num_lost == 0 || !matches!(tear, Tear::More(_)), "{tear:?} cost {num_lost} commits");
            num_tears += 1;
            num_whole += usize::from(num_lost == 0);
            num_lost_commits += num_lost;
        }
    }
    println!("{num_tears} torn logs, {num_whole} without a loss, {num_lost_commits} commits lost and named");
    assert!(num_whole >= num_kills && num_whole < num_tears && num_lost_commits > 0);
}
