//! Memory stays within the budget: the peak of a process, as the system counts it, against what the program says it may
//! take. Printed with `--nocapture`.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "the figures are to be seen")]

use std::fs::File;
use std::io::{BufReader, BufWriter, Read as _, Write as _};
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::program::{Folder, Ran};

const MIB: u64 = 1 << 20;

/// Threads that code and paint, the same on every machine: each takes up to 4 MiB of its own, which is not counted.
const THREADS: &str = "4";

/// What the program takes beside pages, whatever the budget: SQLite's own caches (16 MiB a connection), what the store
/// remembers of decoded pages (24 MiB) where the budget is too small to hold it, rows of a raster (16 MiB), the batches that
/// are coded at once (8 MiB of pages, as they come, as they were and as they are written), and the threads' own.
const BASE_BYTES: u64 = 104 * MIB;

/// Runs the program, which must succeed, and gives what it reported and the most memory it ever had, in bytes. The system
/// keeps the peak, so only one of its last moment could be missed, when the work is done.
fn peak_of(folder: &Folder, line: &str) -> (Value, u64) {
    let mut command = folder.command(&format!("{line} --json --threads {THREADS}"));
    command.env("RAYON_NUM_THREADS", THREADS);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak_in_bytes = 0;
    while child.try_wait().unwrap().is_none() {
        // A process that has just ended has no such line.
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        peak_in_bytes = peak_in_bytes.max(peak.map_or(0, |peak| peak.trim().parse::<u64>().unwrap() << 10));
        std::thread::sleep(Duration::from_micros(200));
    }
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(0), "{line}: {ran:?}");
    (serde_json::from_str(&ran.stdout).unwrap(), peak_in_bytes)
}

/// As [`peak_of`], for something that takes so little time that it may end unseen, and may be done again.
fn idle_peak_of(folder: &Folder, line: &str) -> u64 {
    let peaks = (0..20).map(|_| peak_of(folder, line).1);
    let peak_in_bytes = peaks.filter(|peak_in_bytes| *peak_in_bytes > 0).take(5).max();
    peak_in_bytes.unwrap_or_else(|| panic!("{line}: its memory was never seen"))
}

/// The height of a sample of the rasters: no row or column like another.
fn height_m(x: u32, z: u32) -> f32 {
    let noise = x.wrapping_mul(2_654_435_761).wrapping_add(z.wrapping_mul(40_503)) >> 26;
    ((x * 7 + z * 13) % 1000) as f32 * 0.25 + noise as f32 * 0.015_625
}

fn row_of(width: u32, z: u32) -> Vec<u8> {
    (0..width).flat_map(|x| height_m(x, z).to_le_bytes()).collect()
}

/// Imports a raster of so many samples with a small budget and exports it again; nothing of it is ever whole in memory.
fn assert_streams(width: u32, depth: u32) {
    let folder = Folder::new();
    let mut raster = BufWriter::new(File::create(folder.path("in.r32")).unwrap());
    (0..depth).for_each(|z| raster.write_all(&row_of(width, z)).unwrap());
    raster.into_inner().unwrap();

    folder.succeed("new idle.orogeny --size 64x64 --spacing 1");
    let idle_in_bytes = idle_peak_of(&folder, "info idle.orogeny");
    let budget = 8 * MIB;
    let pages_in_bytes = u64::from(width.div_ceil(256)) * u64::from(depth.div_ceil(256)) * 256 * 256 * 4;
    for line in [
        format!("import in.r32 t.orogeny --size {width}x{depth} --spacing 1 --page-budget 8"),
        "export t.orogeny out.r32 --page-budget 8".to_owned(),
    ] {
        let (_, peak_in_bytes) = peak_of(&folder, &line);
        assert!(peak_in_bytes > idle_in_bytes, "{line}: its memory was never seen");
        let grown_in_bytes = peak_in_bytes - idle_in_bytes;
        println!(
            "{width} x {depth}, {} MiB of pages: {line}: {} MiB over {} MiB",
            pages_in_bytes / MIB,
            grown_in_bytes / MIB,
            idle_in_bytes / MIB
        );
        assert!(grown_in_bytes <= budget + BASE_BYTES, "{line}: {} MiB", grown_in_bytes / MIB);
        assert!(pages_in_bytes > budget + BASE_BYTES, "it would have fitted");
    }
    let mut out = BufReader::new(File::open(folder.path("out.r32")).unwrap());
    let mut row = vec![0; width as usize * 4];
    for z in 0..depth {
        out.read_exact(&mut row).unwrap();
        assert!(row == row_of(width, z), "row {z} came back otherwise");
    }
    assert_eq!(out.read(&mut row).unwrap(), 0);
}

#[test]
fn a_raster_larger_than_the_budget_goes_through_in_pieces() {
    assert_streams(8192, 6144);
}

#[test]
fn a_very_wide_raster_goes_through_in_pieces() {
    assert_streams(262_144, 64);
}

/// Paints more than the budget holds; the growth over a tiny operation on the same terrain is the budget's, and a quarter
/// more at most: for what is on its way between threads, coded or decoded, which is not counted.
fn assert_painting_keeps_to(budget_in_mib: u64, side: u32, operation: &str) {
    let folder = Folder::new();
    folder.succeed(&format!("new t.orogeny --size {side}x{side} --spacing 1"));
    let tiny = r#"{"op": "stroke", "brush": {"type": "raise", "radius": 9}, "points": [[50, 50]]}"#;
    for (name, operation) in [("tiny", tiny), ("large", operation)] {
        folder.write(&format!("{name}.json"), format!(r#"{{"operations": [{operation}]}}"#));
    }
    let apply =
        |name: &str| peak_of(&folder, &format!("apply t.orogeny {name}.json --page-budget {budget_in_mib}"));
    let (_, idle_in_bytes) = apply("tiny");
    let (report, peak_in_bytes) = apply("large");
    let budget_in_bytes = budget_in_mib * MIB;
    let memory = &report["memory"];
    let counted = ["pages_in_bytes", "store_in_bytes"].map(|field| memory[field].as_u64().unwrap());
    let painted_in_bytes = report["operations"][0]["num_pages"].as_u64().unwrap() * 256 * 256 * 4;
    let grown_in_bytes = peak_in_bytes - idle_in_bytes;
    println!(
        "budget {budget_in_mib} MiB, {} MiB painted: grown by {} MiB over {} MiB; counted at the end: {} MiB of pages, {} MiB \
         of the store; {operation}",
        painted_in_bytes / MIB,
        grown_in_bytes / MIB,
        idle_in_bytes / MIB,
        counted[0] / MIB,
        counted[1] / MIB
    );
    assert_eq!(memory["budget_in_bytes"], budget_in_bytes);
    assert!(painted_in_bytes > budget_in_bytes + budget_in_bytes / 4, "it would have fitted");
    assert!(counted.iter().sum::<u64>() <= budget_in_bytes, "{memory}");
    assert!(counted.iter().sum::<u64>() > budget_in_bytes / 4, "{memory}: hardly anything is counted");
    assert!(grown_in_bytes <= budget_in_bytes + budget_in_bytes / 4, "{} MiB", grown_in_bytes / MIB);
}

#[test]
fn painting_takes_what_is_counted_and_little_more() {
    let fill = r#"{"op": "fill", "brush": {"type": "raise", "strength": 5}}"#;
    assert_painting_keeps_to(256, 10_240, fill);
}

#[test]
fn strokes_and_noise_of_any_size_keep_to_the_budget_too() {
    const TEST: &str = "cli::memory::strokes_and_noise_of_any_size_keep_to_the_budget_too";
    if std::env::var_os("OROGENY_TEST_LONG").is_none() {
        return orogeny_tests::skip(TEST, "it paints gigabytes: set OROGENY_TEST_LONG");
    }
    for operation in [
        r#"{"op": "stroke", "brush": {"type": "raise", "radius": 8000, "strength": 200}, "points": [[8192, 8192]]}"#,
        r#"{"op": "stroke", "brush": {"type": "set_height", "radius": 8000, "height": 70}, "points": [[8000, 8192], [8392, 8192]]}"#,
        r#"{"op": "fill", "brush": {"type": "raise", "strength": 5}}"#,
        r#"{"op": "fill", "brush": {"type": "roughen", "strength": 5}}"#,
    ] {
        assert_painting_keeps_to(512, 16_384, operation);
    }
}
