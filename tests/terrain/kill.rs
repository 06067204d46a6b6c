//! `SIGKILL` at random moments of painting: everything acknowledged is there, and what is there is what the history says.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::time::Duration;

use orogeny_tests::Random;
use orogeny_tests::child::{child, child_path, is_long, whole_lines};

use crate::painter::{Painter, assert_kept};
use crate::support::create;

/// Kills after which there is a new terrain, so that its history stays short enough to replay.
const KILLS_PER_TERRAIN: usize = 4;

/// Paints until the process is killed.
pub fn paint_without_pause(path: &Path) -> ! {
    let mut painter = Painter::open(path).unwrap();
    loop {
        painter.step().unwrap();
    }
}

/// Runs `test` as a child that paints on a terrain, kills it so long after it opened it, and gives all that it said.
pub fn painted_and_killed(test: &str, path: &Path, delay: Duration) -> Vec<String> {
    let mut process = child(test, path).spawn().unwrap();
    let mut stdout = BufReader::new(process.stdout.take().unwrap());
    let mut output = Vec::new();
    while !output.starts_with(b"ack ") && !output.windows(5).any(|bytes| bytes == b"\nack ") {
        assert!(stdout.read_until(b'\n', &mut output).unwrap() > 0, "{}", String::from_utf8_lossy(&output));
    }
    std::thread::sleep(delay);
    process.kill().unwrap();
    stdout.read_to_end(&mut output).unwrap();
    let status = process.wait().unwrap();
    assert!(status.code().is_none(), "the child ended by itself: {}", String::from_utf8_lossy(&output));
    whole_lines(&output).into_iter().filter(|line| !line.is_empty()).collect()
}

#[test]
fn a_killed_painter_loses_nothing_that_it_acknowledged() {
    if let Some(path) = child_path() {
        paint_without_pause(&path);
    }
    const TEST: &str = "kill::a_killed_painter_loses_nothing_that_it_acknowledged";
    let num_kills = if is_long() { 200 } else { 12 };
    let mut random = Random::new(0x05ee_d001);
    let (mut num_acknowledged, mut num_travels, mut num_replayed, mut num_logs) = (0, 0, 0, 0);
    let mut folder = tempfile::tempdir().unwrap();
    for kill in 0..num_kills {
        if kill % KILLS_PER_TERRAIN == 0 {
            folder = tempfile::tempdir().unwrap();
            create(&folder.path().join("t.orogeny")).close().unwrap();
        }
        let path = folder.path().join("t.orogeny");
        let lines =
            painted_and_killed(TEST, &path, Duration::from_micros(random.within(0.0, 400_000.0) as u64));
        num_logs += usize::from(folder.path().join("t.orogeny-wal").exists());
        let numbers = |word: &str| -> Vec<u32> {
            lines.iter().filter_map(|line| line.strip_prefix(word)?.parse().ok()).collect()
        };
        // The first one is where the terrain stood when it was opened.
        num_acknowledged += numbers("ack ").len() - 1;
        num_travels += numbers("try ").windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
        num_replayed += assert_kept(&path, &lines);
    }
    println!(
        "{num_kills} kills, {num_acknowledged} acknowledged actions, {num_travels} of those tried along the history, \
         {num_replayed} operations replayed, a log left behind {num_logs} times"
    );
    assert!(num_acknowledged > num_kills, "the children were too slow for the test to say anything");
    assert!(num_replayed > num_kills as u64 && num_travels > 0);
    assert!(num_logs > num_kills / 2, "most kills came before any work");
}
