//! What is written is what other programs were seen to read.
//!
//! `tests/fixtures/formats/exports` holds files of this exporter that `check_exports.py`, beside it, read with Pillow,
//! tifffile, GDAL and NumPy. Here they are written again and must be the same bytes. Where they are not, for a codec
//! packs differently or the exporter was changed, write them anew with `OROGENY_BLESS=1 cargo test -p orogeny_formats
//! --test exports`, run `check_exports.py`, and keep both.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::fs;
use std::path::Path;

use common::{WIDTH, export, fixtures, heights, names};
use orogeny_formats::{ByteOrder, ExportOptions, SampleType};

fn write_all(folder: &Path) {
    let plain = ExportOptions::default();
    let ranged = ExportOptions { range_m: Some((-50.0, 150.0)), spacing_m: Some(2.5), ..plain.clone() };
    let raw = |sample, byte_order| ExportOptions {
        sample: Some(sample),
        byte_order: Some(byte_order),
        ..plain.clone()
    };
    for (name, sample, options) in [
        ("png-u16.png", "u16", plain.clone()),
        ("png-u8.png", "u8", ExportOptions { sample: Some(SampleType::U8), ..plain.clone() }),
        ("png-f32-ranged.png", "f32", ranged.clone()),
        ("r16-u16.r16", "u16", plain.clone()),
        ("r16-f32-ranged.r16", "f32", ranged),
        ("r32-f32.r32", "f32", plain.clone()),
        ("raw-i16-big.raw", "i16", raw(SampleType::I16, ByteOrder::Big)),
        ("raw-f32-little.raw", "f32", raw(SampleType::F32, ByteOrder::Little)),
        ("tiff-f32.tif", "f32", plain.clone()),
        ("tiff-f32-spaced.tif", "f32", ExportOptions { spacing_m: Some(2.5), ..plain.clone() }),
        ("npy-f32.npy", "f32", plain),
    ] {
        export(&folder.join(name), &options, WIDTH, &heights(sample)).unwrap();
    }
    // Enough rows for several strips.
    let wide: Vec<f32> =
        (0..1000 * 300_u32).map(|n| (n / 1000) as f32 / 4.0 + (n % 1000) as f32 * 2.0).collect();
    export(&folder.join("tiff-plane-1000x300.tif"), &ExportOptions::default(), 1000, &wide).unwrap();
}

#[test]
fn exports_are_the_bytes_that_other_programs_read() {
    let kept = fixtures().join("exports");
    if std::env::var_os("OROGENY_BLESS").is_some() {
        fs::create_dir_all(&kept).unwrap();
        write_all(&kept);
        panic!("written anew: now run {}/check_exports.py", fixtures().display());
    }
    let folder = tempfile::tempdir().unwrap();
    write_all(folder.path());
    assert_eq!(names(folder.path()), names(&kept));
    assert_eq!(names(&kept).len(), 14, "twelve files and two sidecars");
    for name in names(&kept) {
        let same = fs::read(folder.path().join(&name)).unwrap() == fs::read(kept.join(&name)).unwrap();
        assert!(same, "{name} is not the file that was checked: see the head of tests/exports.rs");
    }
}
