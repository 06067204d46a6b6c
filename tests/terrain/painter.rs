//! The child that paints without pause, and what it must leave behind.
//!
//! It says `try N` before it goes to entry N of the history, by a stroke or along the history, and `ack N` when entry N is
//! known to be on disk: after a flush, after an undo or jump, or when the next stroke was accepted, which waits for it.

use std::collections::BTreeMap;
use std::path::Path;

use orogeny_engine::{EntryId, Operation, Quiet, Result, Terrain};
use orogeny_tests::Random;
use orogeny_tests::child::acknowledge;

use crate::support::{assert_is_replay, assert_whole, head, settings, stroke};

pub struct Painter {
    terrain: Terrain,
    /// The last number given out.
    last: u32,
    /// A stroke that was accepted and is not known to be on disk.
    on_its_way: Option<u32>,
}

impl Painter {
    pub fn open(path: &Path) -> Result<Self> {
        let terrain = Terrain::open(path, settings())?;
        let log = terrain.log()?;
        acknowledge(&head(&log).to_string());
        Ok(Self { terrain, last: log.last().map_or(0, |entry| entry.id.0), on_its_way: None })
    }

    /// One stroke, and now and then a flush or a way along the history.
    pub fn step(&mut self) -> Result<()> {
        let number = self.last + 1;
        announce(number);
        let applied = self.terrain.submit(&[stroke(number)], &mut Quiet)?;
        assert_eq!(applied[0].entry, EntryId(number));
        self.last = number;
        if let Some(earlier) = self.on_its_way.replace(number) {
            acknowledge(&earlier.to_string());
        }
        match number % 13 {
            2 | 10 => self.flush(),
            4 => self.undo(1 + number % 3),
            7 => {
                self.undo(2)?;
                self.travel(number, |terrain| terrain.redo(2))
            }
            12 => {
                let target = Random::new(number.into()).bits() % u64::from(number + 1);
                self.travel(target as u32, |terrain| terrain.jump(EntryId(target as u32)))
            }
            _ => Ok(()),
        }
    }

    /// Begins again where the terrain stands after an error.
    pub fn look_again(&mut self) -> Result<()> {
        self.on_its_way = None;
        self.last = self.terrain.log()?.last().map_or(0, |entry| entry.id.0);
        Ok(())
    }

    pub fn flush(&mut self) -> Result<()> {
        self.terrain.flush()?;
        if let Some(number) = self.on_its_way.take() {
            acknowledge(&number.to_string());
        }
        Ok(())
    }

    fn undo(&mut self, count: u32) -> Result<()> {
        self.flush()?;
        let log = self.terrain.log()?;
        let parents: BTreeMap<u32, u32> = log.iter().map(|entry| (entry.id.0, entry.parent.0)).collect();
        let target = (0..count).fold(head(&log), |at, _| parents.get(&at).copied().unwrap_or(0));
        self.travel(target, |terrain| terrain.undo(count))
    }

    fn travel<T>(&mut self, target: u32, travel: impl FnOnce(&mut Terrain) -> Result<T>) -> Result<()> {
        self.flush()?;
        announce(target);
        travel(&mut self.terrain)?;
        acknowledge(&target.to_string());
        Ok(())
    }
}

fn announce(target: u32) {
    println!("try {target}");
}

/// Where a terrain may stand after these lines of its child: at what it last acknowledged, or at what it tried since.
pub fn possible_heads(lines: &[String]) -> Vec<u32> {
    let number = |line: &String, word: &str| line.strip_prefix(word)?.parse::<u32>().ok();
    let last_ack = lines.iter().rposition(|line| line.starts_with("ack ")).unwrap();
    let acknowledged = number(&lines[last_ack], "ack ").unwrap();
    // A stroke is acknowledged when the next one was tried already.
    let tried = lines[..last_ack].iter().rposition(|line| number(line, "try ") == Some(acknowledged));
    let since = &lines[tried.unwrap_or(0)..];
    std::iter::once(acknowledged).chain(since.iter().filter_map(|line| number(line, "try "))).collect()
}

/// Checks a terrain whose child ended: it is whole, holds what was acknowledged, stands where it may, and is what its
/// history says. Gives the operations that show.
pub fn assert_kept(path: &Path, lines: &[String]) -> u64 {
    assert_whole(path);
    let terrain = Terrain::open(path, settings()).unwrap();
    let log = assert_history_is_of_strokes(&terrain);
    for number in lines.iter().filter_map(|line| line.strip_prefix("ack ")) {
        let number: u32 = number.parse().unwrap();
        assert!(number == 0 || log.contains(&number), "{number} was acknowledged and is lost: {lines:?}");
    }
    let found = head(&terrain.log().unwrap());
    let possible = possible_heads(lines);
    assert!(possible.contains(&found), "it stands at {found}, not at one of {possible:?}: {lines:?}");
    assert_is_replay(&terrain, path)
}

/// Every entry is the stroke of its number, and none is missing. Gives the numbers.
pub fn assert_history_is_of_strokes(terrain: &Terrain) -> Vec<u32> {
    let layer = terrain.layers().unwrap()[0].id;
    let log = terrain.log().unwrap();
    for (entry, number) in log.iter().zip(1..) {
        assert_eq!(entry.id.0, number);
        let Operation::Brush(stroke) = stroke(number) else { panic!("a stroke is a brush") };
        assert_eq!(entry.operation_json, stroke.to_recorded_json(layer).unwrap());
    }
    log.iter().map(|entry| entry.id.0).collect()
}
