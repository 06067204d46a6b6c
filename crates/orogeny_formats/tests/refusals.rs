//! Bad paths, options, buffers and heights: a typed error, and nothing changed.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::fs;
use std::path::Path;

use common::{export, import, names};
use orogeny_formats::{
    ByteOrder, Error, ExportOptions, Format, ImportOptions, NodataPolicy, SampleType, create, open,
};

fn read(path: &Path) -> Result<orogeny_formats::Import, Error> {
    open(path, &ImportOptions::default())
}

#[test]
fn paths_that_are_no_file_are_named() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(read(Path::new("")), Err(Error::EmptyPath)));
    let missing = folder.path().join("missing.png");
    match read(&missing) {
        Err(Error::NotFound { path, what: "file" }) => assert_eq!(path, missing),
        other => panic!("{other:?}"),
    }
    assert!(matches!(read(folder.path()), Err(Error::NotAFile { .. })));

    let plain = ExportOptions::default();
    assert!(matches!(create("", &plain, 2, 2), Err(Error::EmptyPath)));
    assert!(matches!(create(folder.path(), &plain, 2, 2), Err(Error::NotAFile { .. })));
    let nowhere = folder.path().join("no/where.png");
    assert!(matches!(create(nowhere, &plain, 2, 2), Err(Error::NotFound { what: "folder", .. })));
    assert!(matches!(create(folder.path().join("a.exr"), &plain, 2, 2), Err(Error::UnknownEnding { .. })));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn headless_files_must_be_explained() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: usize| {
        let path = folder.path().join(name);
        fs::write(&path, vec![0; bytes]).unwrap();
        path
    };
    match read(&file("a.r16", 2 * 3 * 4)) {
        Err(Error::SizeNeeded { bytes: 24, sample_bytes: 2, .. }) => {}
        other => panic!("{other:?}"),
    }
    assert!(matches!(read(&file("odd.r16", 33)), Err(Error::SizeNeeded { .. })));
    assert!(matches!(read(&file("empty.r32", 0)), Err(Error::Size { width: 0, .. })));
    assert!(matches!(read(&file("a.r32", 4 * 25)).unwrap().info().width, 5));

    let raw = file("a.raw", 24);
    for (size, sample, expected) in [
        (None, None, "width, depth and the sample type"),
        (Some((3, 4)), None, "the sample type"),
        (None, Some(SampleType::U16), "width and depth"),
    ] {
        match open(&raw, &ImportOptions { size, sample, ..Default::default() }) {
            Err(Error::RawNeeds { missing, .. }) => assert_eq!(missing, expected),
            other => panic!("{other:?}"),
        }
    }
    let options = ImportOptions { size: Some((3, 5)), sample: Some(SampleType::U16), ..Default::default() };
    assert!(matches!(open(&raw, &options), Err(Error::WrongLength { expected: 30, actual: 24, .. })));
}

#[test]
fn options_out_of_range_or_place_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let png = folder.path().join("a.png");
    export(&png, &ExportOptions::default(), 2, &[0.0; 4]).unwrap();
    let plain = ImportOptions::default();
    for (expected, options) in [
        ("range_m", ImportOptions { range_m: Some((5.0, 5.0)), ..plain.clone() }),
        ("range_m", ImportOptions { range_m: Some((f64::NAN, 5.0)), ..plain.clone() }),
        ("range_m", ImportOptions { range_m: Some((0.0, 1e8)), ..plain.clone() }),
        ("spacing_m", ImportOptions { spacing_m: Some(0.0), ..plain.clone() }),
        ("spacing_m", ImportOptions { spacing_m: Some(f64::INFINITY), ..plain.clone() }),
        ("nodata", ImportOptions { nodata: NodataPolicy::Value(f32::NAN), ..plain.clone() }),
        ("rotate_degrees", ImportOptions { rotate_degrees: 45, ..plain.clone() }),
        ("rotate_degrees", ImportOptions { rotate_degrees: 360, ..plain.clone() }),
        ("max_samples_per_side", ImportOptions { max_samples_per_side: 0, ..plain.clone() }),
        ("max_samples_per_side", ImportOptions { max_samples_per_side: u32::MAX, ..plain.clone() }),
        ("size", ImportOptions { size: Some((2, 2)), ..plain.clone() }),
        ("sample", ImportOptions { sample: Some(SampleType::U16), ..plain.clone() }),
        ("byte_order", ImportOptions { byte_order: Some(ByteOrder::Big), ..plain.clone() }),
    ] {
        match open(&png, &options) {
            Err(Error::Option { option, .. }) => assert_eq!(option, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    let plain = ExportOptions::default();
    for (name, expected, options) in [
        ("b.npy", "range_m", ExportOptions { range_m: Some((0.0, 1.0)), ..plain.clone() }),
        ("b.png", "sample", ExportOptions { sample: Some(SampleType::F32), ..plain.clone() }),
        ("b.png", "byte_order", ExportOptions { byte_order: Some(ByteOrder::Little), ..plain.clone() }),
        ("b.png", "spacing_m", ExportOptions { spacing_m: Some(-1.0), ..plain.clone() }),
    ] {
        match create(folder.path().join(name), &options, 2, 2) {
            Err(Error::Option { option, .. }) => assert_eq!(option, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    for (width, depth) in [(0, 2), (2, 0), ((1 << 20) + 1, 1), (1, u32::MAX)] {
        assert!(matches!(create(folder.path().join("b.png"), &plain, width, depth), Err(Error::Size { .. })));
    }
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn rasters_above_the_side_limit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.tif", "a.npy", "a.r32"] {
        let path = folder.path().join(name);
        export(&path, &ExportOptions::default(), 30, &[1.0; 900]).unwrap();
        let limited = ImportOptions { max_samples_per_side: 29, ..Default::default() };
        assert!(matches!(open(&path, &limited), Err(Error::Size { width: 30, limit: 29, .. })), "{name}");
        assert!(open(&path, &ImportOptions { max_samples_per_side: 30, ..limited }).is_ok(), "{name}");
    }
}

#[test]
fn heights_that_do_not_fit_are_refused_with_the_range_to_give() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    export(&path, &ExportOptions::default(), 2, &[1.0, 2.0]).unwrap();
    let before = fs::read(&path).unwrap();
    let heights_m = [-20.5, 300.25, 1_000.0, 65_535.6];
    let message = export(&path, &ExportOptions::default(), 2, &heights_m).unwrap_err().to_string();
    assert!(message.contains("range -21,65536"), "{message}");
    assert_eq!(fs::read(&path).unwrap(), before, "what was there stays");
    assert_eq!(names(folder.path()), ["a.png"]);

    let given = ExportOptions { range_m: Some((-21.0, 65536.0)), ..Default::default() };
    export(&path, &given, 2, &heights_m).unwrap();
    let narrow = ExportOptions { range_m: Some((0.0, 1000.0)), ..Default::default() };
    assert!(matches!(export(&path, &narrow, 2, &heights_m), Err(Error::HeightsDoNotFit { .. })));

    let flat = export(&path, &ExportOptions::default(), 2, &[-3.0, -3.0]).unwrap_err().to_string();
    assert!(flat.contains("range -3,-2"), "{flat}");
    let raw = ExportOptions { sample: Some(SampleType::I16), ..Default::default() };
    // The least i16 is every other program's void.
    let void = export(&folder.path().join("a.raw"), &raw, 2, &[0.0, -32_768.0]).unwrap_err().to_string();
    assert!(void.contains(".r32"), "{void}");
}

#[test]
fn exports_take_exactly_their_rows() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.r16", "a.r32", "a.tif", "a.npy"] {
        let path = folder.path().join(name);
        let begin = || create(&path, &ExportOptions::default(), 3, 2).unwrap();
        let mut few = begin();
        few.write_rows(&[0.0; 3]).unwrap();
        assert!(matches!(few.finish(), Err(Error::RowCount { expected: 2, actual: 1, .. })), "{name}");
        assert!(matches!(begin().write_rows(&[0.0; 9]), Err(Error::RowCount { .. })), "{name}");
        assert!(
            matches!(begin().write_rows(&[0.0; 4]), Err(Error::Buffer { samples: 4, width: 3 })),
            "{name}"
        );
        match begin().write_rows(&[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]) {
            Err(Error::NotFinite { column: 1, row: 1, .. }) => {}
            other => panic!("{name}: {other:?}"),
        }
        assert!(begin().write_rows(&[f32::INFINITY; 3]).is_err(), "{name}");
        drop(begin());
    }
    assert!(names(folder.path()).is_empty(), "{:?}", names(folder.path()));
}

#[test]
fn buffers_hold_whole_rows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    export(&path, &ExportOptions::default(), 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let mut import = read(&path).unwrap();
    for samples in [0, 2, 4] {
        assert!(matches!(import.read_rows(&mut vec![0.0; samples]), Err(Error::Buffer { .. })));
    }
    let mut rows = [0.0; 9];
    assert_eq!(import.read_rows(&mut rows).unwrap(), 2);
    assert_eq!(rows[..6], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(import.read_rows(&mut rows).unwrap(), 0);
}

#[test]
fn unusable_floats_are_counted_by_their_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.r32");
    let mut values = [1.0_f32; 16];
    (values[3], values[7], values[9], values[12]) =
        (f32::NAN, f32::NEG_INFINITY, 2.0e7, f32::from_bits(0xffc0_0001));
    (values[0], values[1]) = (f32::from_bits(3), -f32::from_bits(3));
    fs::write(&path, values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
    match read(&path) {
        Err(Error::Nodata { count: 4, total: 16, column: 3, row: 0, .. }) => {}
        other => panic!("{other:?}"),
    }
    let options = ImportOptions { nodata: NodataPolicy::Value(5.0), ..Default::default() };
    let (.., heights_m) = import(&path, &options).unwrap();
    assert_eq!((heights_m[3], heights_m[7], heights_m[9], heights_m[12]), (5.0, 5.0, 5.0, 5.0));
    assert_eq!((heights_m[0].to_bits(), heights_m[1].to_bits()), (0, 0), "denormals become +0");

    fs::write(&path, f32::NAN.to_le_bytes().repeat(16)).unwrap();
    let fill = ImportOptions { nodata: NodataPolicy::Fill, ..Default::default() };
    assert!(matches!(open(&path, &fill), Err(Error::AllNodata { .. })));
}

#[test]
fn a_format_can_be_given_where_the_ending_tells_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heights");
    let options = ExportOptions { format: Some(Format::Npy), ..Default::default() };
    export(&path, &options, 2, &[1.0, 2.0]).unwrap();
    assert!(matches!(read(&path), Err(Error::UnknownEnding { .. })));
    let options = ImportOptions { format: Some(Format::Npy), ..Default::default() };
    assert_eq!(import(&path, &options).unwrap(), (2, 1, vec![1.0, 2.0]));
}

#[test]
fn a_file_that_shrinks_while_it_is_read_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.r16");
    fs::write(&path, vec![0; 2 * 300 * 300]).unwrap();
    let mut import = read(&path).unwrap();
    fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(1000).unwrap();
    assert!(matches!(common::read_all(&mut import, 7), Err(Error::Truncated { .. })));
}
