//! Tiles, as they are and in a zip made here.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use common::{assert_same, export, import};
use orogeny_formats::{Error, ExportOptions, ImportOptions, NodataPolicy, open};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const SIDE: u32 = 1201;

fn heights() -> Vec<f32> {
    (0..SIDE * SIDE).map(|n| ((n % SIDE) * 3 + (n / SIDE) * 2) as f32 - 400.0).collect()
}

fn tile() -> Vec<u8> {
    heights().iter().flat_map(|height_m| (*height_m as i16).to_be_bytes()).collect()
}

fn as_is() -> ImportOptions {
    ImportOptions { spacing_m: Some(90.0), ..Default::default() }
}

fn zip_of(folder: &Path, name: &str, entries: &[(&str, &[u8])]) -> PathBuf {
    let path = folder.join(name);
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    for (name, bytes) in entries {
        zip.start_file(*name, SimpleFileOptions::default().compression_method(CompressionMethod::Deflated))
            .unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    path
}

#[test]
fn a_tile_is_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("N34W119.hgt");
    export(&path, &ExportOptions::default(), SIDE, &heights()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), tile(), "big-endian, north row first");
    let (width, depth, read) = import(&path, &as_is()).unwrap();
    assert_eq!((width, depth), (SIDE, SIDE));
    assert_same("tile", &read, &heights());
}

#[test]
fn a_tile_in_a_zip_is_the_same_tile() {
    let folder = tempfile::tempdir().unwrap();
    let path = zip_of(folder.path(), "x.zip", &[("read me.txt", b"hello"), ("tiles/N34W119.hgt", &tile())]);
    assert_same("zipped tile", &import(&path, &as_is()).unwrap().2, &heights());
    let import = open(&path, &ImportOptions::default()).unwrap();
    let info = import.info();
    // 76.53 m of longitude and 92.44 m of latitude between samples at 34.5 degrees, by the handbooks' series.
    assert!((info.spacing_m.unwrap() - 76.53).abs() < 0.01, "{:?}", info.spacing_m);
    assert_eq!((info.width, info.depth), (SIDE, 1450));
    assert_eq!(info.georeference.unwrap().origin, (-119.0, 35.0));
    assert!(info.notices.iter().any(|notice| notice.contains("resampled")));
}

#[test]
fn a_tile_without_a_place_needs_a_spacing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tile.hgt");
    fs::write(&path, tile()).unwrap();
    assert!(matches!(open(&path, &ImportOptions::default()), Err(Error::LocationNeeded { .. })));
    assert_eq!(open(&path, &as_is()).unwrap().info().spacing_m, Some(90.0));
}

#[test]
fn voids_are_no_heights() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("N34W119.hgt");
    let mut bytes = tile();
    for sample in [5 * 1201 + 7, 5 * 1201 + 8, 900 * 1201] {
        bytes[sample * 2..][..2].copy_from_slice(&i16::MIN.to_be_bytes());
    }
    fs::write(&path, bytes).unwrap();
    match open(&path, &ImportOptions::default()) {
        Err(Error::Nodata { count: 3, column: 7, row: 5, .. }) => {}
        other => panic!("{other:?}"),
    }
    let filled = import(&path, &ImportOptions { nodata: NodataPolicy::Fill, ..as_is() }).unwrap().2;
    let worst_m = filled.iter().zip(heights()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst_m < 2.0, "three holes in a plane, filled {worst_m} m from it");
}

#[test]
fn zips_that_are_not_one_tile_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let bomb = vec![0; 100_000_000];
    for (name, entries) in [
        ("none.zip", vec![("a.txt", &b"x"[..])]),
        ("two.zip", vec![("N34W119.hgt", &tile()[..]), ("N35W119.hgt", &tile()[..])]),
        ("short.zip", vec![("N34W119.hgt", &tile()[..100])]),
        ("bomb.zip", vec![("N34W119.hgt", &bomb[..])]),
        ("empty.zip", vec![]),
    ] {
        let path = zip_of(folder.path(), name, &entries);
        let err = open(&path, &as_is()).unwrap_err();
        assert!(matches!(err, Error::Malformed { .. }), "{name}: {err}");
    }
}

#[test]
fn a_zip_that_lies_of_its_size_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = zip_of(folder.path(), "N34W119.hgt.zip", &[("N34W119.hgt", &vec![7; 5_000_000])]);
    let mut bytes = fs::read(&path).unwrap();
    let (actual, claimed) = (5_000_000_u32.to_le_bytes(), (SIDE * SIDE * 2).to_le_bytes());
    let mut num_replaced = 0;
    for at in 0..bytes.len() - 4 {
        if bytes[at..at + 4] == actual {
            bytes[at..at + 4].copy_from_slice(&claimed);
            num_replaced += 1;
        }
    }
    assert!(num_replaced >= 1);
    fs::write(&path, bytes).unwrap();
    assert!(open(&path, &as_is()).is_err());
}

#[test]
fn only_whole_tiles_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("N00E000.hgt");
    let err = export(&path, &ExportOptions::default(), 20, &[1.0; 400]).unwrap_err();
    assert!(matches!(err, Error::Unsupported { .. }), "{err}");
    let mut high = heights();
    high[17] = 40_000.0;
    let err = export(&path, &ExportOptions::default(), SIDE, &high).unwrap_err();
    assert!(matches!(err, Error::HeightsDoNotFit { .. }), "{err}");
    assert!(common::names(folder.path()).is_empty());
}
