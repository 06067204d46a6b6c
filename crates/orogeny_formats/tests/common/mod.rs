//! Where the fixtures are, what they hold, and comparisons that fail where they should.

#![allow(dead_code, reason = "every test file uses some of it")]
#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

use std::fs;
use std::path::{Path, PathBuf};

use orogeny_formats::{ExportOptions, Import, ImportOptions, Result, create, open};

/// Samples of every small fixture.
pub const WIDTH: u32 = 20;
pub const DEPTH: u32 = 13;

/// `tests/fixtures/formats` of the workspace.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/formats")
}

/// The heights of the fixtures with this sample type, as `make.py` defines them.
pub fn heights(sample: &str) -> Vec<f32> {
    let whole = (0..DEPTH).flat_map(|z| (0..WIDTH).map(move |x| (3 * x * x + 7 * z * z + 5 * x * z) % 1000));
    let height_m = |whole: u32| match sample {
        "u8" => (whole % 256) as f32,
        "u16" | "u32" => whole as f32,
        "i8" => (whole % 256) as f32 - 128.0,
        "i16" | "i32" => whole as f32 - 200.0,
        "f32" | "f64" => whole as f32 / 8.0 - 12.5,
        other => panic!("no fixture has samples of {other}"),
    };
    whole.map(height_m).collect()
}

/// All that is left of an import, read `rows_at_once` rows at a time.
pub fn read_all(import: &mut Import, rows_at_once: usize) -> Result<Vec<f32>> {
    let width = import.info().width as usize;
    let mut heights_m = Vec::new();
    let mut rows = vec![f32::NAN; width * rows_at_once];
    loop {
        match import.read_rows(&mut rows)? {
            0 => return Ok(heights_m),
            num_rows => heights_m.extend_from_slice(&rows[..num_rows * width]),
        }
    }
}

/// A file's size and heights.
pub fn import(path: &Path, options: &ImportOptions) -> Result<(u32, u32, Vec<f32>)> {
    let mut import = open(path, options)?;
    let heights_m = read_all(&mut import, 3)?;
    Ok((import.info().width, import.info().depth, heights_m))
}

/// Writes a file; what it says of what it did.
pub fn export(path: &Path, options: &ExportOptions, width: u32, heights_m: &[f32]) -> Result<Vec<String>> {
    let depth = u32::try_from(heights_m.len() / width as usize).unwrap();
    let mut export = create(path, options, width, depth)?;
    // In pieces of one and of two rows, as a caller may.
    for (index, rows) in heights_m.chunks(3 * width as usize).enumerate() {
        let split = (1 + index % 2) * width as usize;
        let (first, second) = rows.split_at(split.min(rows.len()));
        export.write_rows(first)?;
        export.write_rows(second)?;
    }
    Ok(export.finish()?.notices)
}

/// The names of what is in a folder, in order.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Panics with the first place where two rasters' bits differ.
pub fn assert_same(what: &str, actual: &[f32], expected: &[f32]) {
    assert_eq!(actual.len(), expected.len(), "{what}: number of samples");
    let differs =
        actual.iter().zip(expected).position(|(actual, expected)| actual.to_bits() != expected.to_bits());
    if let Some(index) = differs {
        panic!("{what}: sample {index} is {}, not {}", actual[index], expected[index]);
    }
}

/// The checksum of PNG chunks.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    })
}

mod tests {
    use super::assert_same;

    #[test]
    #[should_panic(expected = "sample 1 is")]
    fn one_different_sample_is_seen() {
        assert_same("rasters", &[1.0, 2.0, 3.0], &[1.0, 2.000_000_2, 3.0]);
    }

    #[test]
    #[should_panic(expected = "number of samples")]
    fn a_missing_sample_is_seen() {
        assert_same("rasters", &[1.0], &[1.0, 1.0]);
    }
}
