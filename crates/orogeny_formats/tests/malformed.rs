//! Damaged and hostile files: a typed error and bounded work, never a panic.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::{DEPTH, WIDTH, crc32, fixtures, import, names};
use orogeny_formats::{Error, Format, ImportOptions, NodataPolicy, SampleType, open};
use proptest::prelude::*;

/// A few files of every format, with what must be said to read them.
fn corpus() -> Vec<(PathBuf, ImportOptions)> {
    let inputs = [
        "png-u8.png",
        "png-u16.png",
        "png-u16-adam7.png",
        "tiff-i16-strip-none-p1.tif",
        "tiff-i16-strip-none-p1-bigendian.tif",
        "tiff-f32-strip-lzw-p3.tif",
        "tiff-f32-tile-deflate-p2.tif",
        "tiff-f32-tile-deflate-p3-bigendian.tif",
        "tiff-f32-tile-lzw-p3-bigtiff.tif",
        "tiff-i16-strip-packbits-p1.tif",
        "geotiff-f32-degrees.tif",
        "geotiff-f32-utm-tile-deflate-p3-bigtiff.tif",
        "npy-f32-c.npy",
        "npy-i16-fortran.npy",
        "npy-f32-version3.npy",
        "raw-u16-little.raw",
    ];
    let exports = ["tiff-f32-spaced.tif", "png-f32-ranged.png", "r32-f32.r32"];
    let inputs = inputs.into_iter().map(|name| fixtures().join("inputs").join(name));
    let exports = exports.into_iter().map(|name| fixtures().join("exports").join(name));
    inputs.chain(exports).map(|path| (path.clone(), options_for(&path))).collect()
}

fn options_for(path: &Path) -> ImportOptions {
    let mut options = ImportOptions { nodata: NodataPolicy::Value(0.0), ..Default::default() };
    let ending = path.extension().and_then(|ending| ending.to_str());
    if matches!(ending, Some("raw" | "r32")) {
        options.size = Some((WIDTH, DEPTH));
    }
    if ending == Some("raw") {
        options.sample = Some(SampleType::U16);
    }
    options
}

/// Opens and reads a file whose bytes are these.
fn read_bytes(folder: &Path, original: &Path, options: &ImportOptions, bytes: &[u8]) -> Result<(), Error> {
    let path = folder.join(original.file_name().unwrap());
    fs::write(&path, bytes).unwrap();
    let (width, depth, heights_m) = import(&path, options)?;
    assert_eq!(heights_m.len() as u64, u64::from(width) * u64::from(depth));
    assert!(heights_m.iter().all(|height_m| height_m.is_finite() && height_m.abs() <= 1e7));
    Ok(())
}

#[test]
fn every_truncation_is_a_typed_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut num_tried = 0;
    for (original, options) in corpus() {
        let bytes = fs::read(&original).unwrap();
        read_bytes(folder.path(), &original, &options, &bytes).unwrap();
        for length in 0..bytes.len() {
            match read_bytes(folder.path(), &original, &options, &bytes[..length]) {
                Err(
                    Error::Truncated { .. }
                    | Error::Malformed { .. }
                    | Error::WrongLength { .. }
                    | Error::SizeNeeded { .. },
                ) => num_tried += 1,
                other => panic!("{} cut to {length} of {} bytes: {other:?}", original.display(), bytes.len()),
            }
        }
    }
    assert!(num_tried > 10_000, "{num_tried} truncations");
}

#[test]
fn every_damaged_byte_is_an_error_or_still_heights() {
    let folder = tempfile::tempdir().unwrap();
    let mut num_refused = 0;
    for (original, options) in corpus() {
        let bytes = fs::read(&original).unwrap();
        for index in 0..bytes.len() {
            for flip in [0xff, 1 << (index % 8)] {
                let mut damaged = bytes.clone();
                damaged[index] ^= flip;
                num_refused += usize::from(read_bytes(folder.path(), &original, &options, &damaged).is_err());
            }
        }
    }
    assert!(num_refused > 1_000, "{num_refused} were refused");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn scrambled_files_never_panic(
        which: prop::sample::Index,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<[u8; 4]>()), 1..8),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let corpus = corpus();
        let (original, options) = which.get(&corpus);
        let mut bytes = fs::read(original).unwrap();
        for (at, value) in edits {
            let at = at.index(bytes.len().min(400) - 4);
            bytes[at..at + 4].copy_from_slice(&value);
        }
        let _ = read_bytes(folder.path(), original, options, &bytes);
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.tif", "a.npy", "N00E000.hgt", "a.zip", "a.r16", "a.r32"] {
            let _ = read_bytes(folder.path(), Path::new(name), &ImportOptions::default(), &bytes);
        }
    }
}

/// A little-endian classic TIFF with these tags: number, type, count, value.
fn tiff(tags: &[(u16, u16, u32, u32)], data: &[u8]) -> Vec<u8> {
    let mut bytes = b"II\x2a\0".to_vec();
    bytes.extend((8 + data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.extend((tags.len() as u16).to_le_bytes());
    for &(tag, kind, count, value) in tags {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
    bytes
}

#[test]
fn headers_that_promise_too_much_are_refused_unread() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        open(&path, &ImportOptions::default()).unwrap_err()
    };

    // A PNG of 2^20 x 2^20 samples in 60 bytes, and one of 2^31 a side.
    let original = fs::read(fixtures().join("inputs/png-u16.png")).unwrap();
    for (side, is_size_error) in [(1_u32 << 20, false), ((1 << 31) - 1, true)] {
        let mut png = original.clone();
        png[16..20].copy_from_slice(&side.to_be_bytes());
        png[20..24].copy_from_slice(&side.to_be_bytes());
        let crc = crc32(&png[12..29]);
        png[29..33].copy_from_slice(&crc.to_be_bytes());
        let err = refused("big.png", &png);
        assert_eq!(matches!(err, Error::Size { .. }), is_size_error, "{err}");
        assert!(is_size_error || matches!(err, Error::Truncated { .. }), "{err}");
    }

    // Arrays of 4 TiB, and of more than a number holds.
    for (shape, is_size_error) in [
        ("1048576, 1048576", false),
        ("18446744073709551615, 2", true),
        ("99999999999999999999999, 2", false),
    ] {
        let dictionary = format!("{{'descr': '<f4', 'fortran_order': True, 'shape': ({shape}), }}\n");
        let mut npy = b"\x93NUMPY\x01\0".to_vec();
        npy.extend((dictionary.len() as u16).to_le_bytes());
        npy.extend(dictionary.as_bytes());
        assert_eq!(matches!(refused("big.npy", &npy), Error::Size { .. }), is_size_error, "{shape}");
    }
    let mut npy = b"\x93NUMPY\x02\0".to_vec();
    npy.extend(u32::MAX.to_le_bytes());
    assert!(matches!(refused("long.npy", &npy), Error::Malformed { .. }));

    let sides = |width, depth| [(256, 4, 1, width), (257, 4, 1, depth)];
    let grey16 = [(258, 3, 1, 16), (262, 3, 1, 1), (277, 3, 1, 1)];
    let strips = [(259, 3, 1, 8), (273, 4, 1, 8), (278, 4, 1, u32::MAX), (279, 4, 1, 64)];
    let of = |parts: &[&[(u16, u16, u32, u32)]]| {
        let mut tags = parts.concat();
        tags.sort_unstable();
        tiff(&tags, &[0; 64])
    };
    // 2^20 x 2^20 samples in 64 deflated bytes, more samples than are read at all, none at all.
    assert!(matches!(
        refused("a.tif", &of(&[&sides(1 << 20, 1 << 20), &grey16, &strips])),
        Error::Malformed { .. }
    ));
    assert!(matches!(refused("a.tif", &of(&[&sides(u32::MAX, 2), &grey16, &strips])), Error::Size { .. }));
    assert!(matches!(refused("a.tif", &of(&[&sides(0, 2), &grey16, &strips])), Error::Size { .. }));
    // Tiles wider than the world, a tag of four thousand million values, and a strip beyond the file.
    let tiles = [(259, 3, 1, 1), (322, 4, 1, u32::MAX), (323, 4, 1, 16), (324, 4, 1, 8), (325, 4, 1, 64)];
    assert!(matches!(refused("a.tif", &of(&[&sides(8, 4), &grey16, &tiles])), Error::Malformed { .. }));
    let many = [(259, 3, 1, 1), (273, 4, u32::MAX, 8), (278, 4, 1, 1), (279, 4, u32::MAX, 8)];
    let err = refused("a.tif", &of(&[&sides(8, 4), &grey16, &many]));
    assert!(err.to_string().contains("claims 4294967295 values"), "{err}");
    let beyond = [(259, 3, 1, 1), (273, 4, 1, 4_000_000_000), (278, 4, 1, 4), (279, 4, 1, 64)];
    assert!(matches!(refused("a.tif", &of(&[&sides(8, 4), &grey16, &beyond])), Error::Truncated { .. }));
    // The same bytes named as one strip are fine, so it is those tags that were refused.
    let sound = [(259, 3, 1, 1), (273, 4, 1, 8), (278, 4, 1, 4), (279, 4, 1, 64)];
    let path = folder.path().join("sound.tif");
    fs::write(&path, of(&[&sides(8, 4), &grey16, &sound])).unwrap();
    assert_eq!(import(&path, &ImportOptions::default()).unwrap(), (8, 4, vec![0.0; 32]));
}

#[test]
fn a_pixel_scale_in_no_named_unit_needs_a_spacing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let mut data = vec![0; 64];
    data.extend([2.0_f64, 2.0, 0.0].map(f64::to_le_bytes).concat());
    let keys = |model: u16, unit: u16| [[1, 1, 0, 2], [1024, 0, 1, model], [3076, 0, 1, unit]].concat();
    for (model, unit, expected) in [
        (0, 9001, "a unit it does not name"),
        (1, 9036, "an unknown unit"),
        // Degrees, but no tie point that says at which latitude.
        (2, 9001, "in degrees"),
    ] {
        let mut data = data.clone();
        data.extend(keys(model, unit).into_iter().flat_map(u16::to_le_bytes));
        let tags = [
            (256, 4, 1, 8),
            (257, 4, 1, 4),
            (258, 3, 1, 16),
            (259, 3, 1, 1),
            (262, 3, 1, 1),
            (273, 4, 1, 8),
            (277, 3, 1, 1),
            (278, 4, 1, 4),
            (279, 4, 1, 64),
            (33550, 12, 3, 8 + 64),
            (34735, 3, 12, 8 + 64 + 24),
        ];
        fs::write(&path, tiff(&tags, &data)).unwrap();
        match open(&path, &ImportOptions::default()) {
            Err(Error::LocationNeeded { what, .. }) => assert!(what.contains(expected), "{what}"),
            other => panic!("{expected}: {other:?}"),
        }
        let given = ImportOptions { spacing_m: Some(3.0), ..Default::default() };
        assert_eq!(open(&path, &given).unwrap().info().spacing_m, Some(3.0));
    }
}

#[test]
fn strips_that_share_their_bytes_are_refused() {
    // A small file whose many strips all name the same bytes would be long work for little.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.tif");
    let mut data = vec![0; 64];
    for offset_or_length in [8_u32, 64] {
        data.extend(offset_or_length.to_le_bytes().repeat(50));
    }
    let tags = [
        (256, 4, 1, 8),
        (257, 4, 1, 200),
        (258, 3, 1, 16),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (273, 4, 50, 8 + 64),
        (277, 3, 1, 1),
        (278, 4, 1, 4),
        (279, 4, 50, 8 + 64 + 200),
    ];
    fs::write(&path, tiff(&tags, &data)).unwrap();
    match open(&path, &ImportOptions::default()) {
        Err(Error::Malformed { format: Format::Tiff, reason, .. }) => {
            assert!(reason.contains("overlap"), "{reason}")
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn work_that_cannot_stream_keeps_to_the_memory_limit() {
    for name in
        ["png-u16-adam7.png", "npy-f32-fortran.npy", "tiff-f32-tile-lzw-p1.tif", "tiff-i16-strip-lzw-p1.tif"]
    {
        let path = fixtures().join("inputs").join(name);
        let limited = ImportOptions { memory_limit_bytes: 100, ..Default::default() };
        assert!(matches!(open(&path, &limited), Err(Error::Memory { limit: 100, .. })), "{name}");
    }
    // What streams needs none of it.
    for name in ["png-u16.png", "npy-f32-c.npy", "tiff-i16-strip-none-p1.tif"] {
        let path = fixtures().join("inputs").join(name);
        let limited = ImportOptions { memory_limit_bytes: 100, ..Default::default() };
        assert!(open(&path, &limited).is_ok(), "{name}");
    }
}

#[test]
fn the_corpus_is_whole() {
    for (path, _) in corpus() {
        let folder = path.parent().unwrap();
        assert!(
            names(folder).contains(&path.file_name().unwrap().to_str().unwrap().to_owned()),
            "{}",
            path.display()
        );
    }
}
