//! Files that other programs wrote are read to the last bit. `tests/fixtures/formats/make.py` makes them.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::path::PathBuf;

use common::{DEPTH, WIDTH, assert_same, fixtures, heights, import, names};
use orogeny_formats::{
    ByteOrder, Error, Georeference, ImportOptions, NodataPolicy, SampleType, metres_per_degree_of_latitude,
    metres_per_degree_of_longitude, open,
};

fn input(name: &str) -> PathBuf {
    fixtures().join("inputs").join(name)
}

/// What must be said of a fixture to read its samples as they are.
fn options_for(name: &str) -> ImportOptions {
    let mut options = ImportOptions { spacing_m: Some(30.0), ..Default::default() };
    if let Some(rest) = name.strip_prefix("raw-") {
        options.size = Some((WIDTH, DEPTH));
        options.sample = Some(match rest.split('-').next() {
            Some("u8") => SampleType::U8,
            Some("u16") => SampleType::U16,
            Some("i16") => SampleType::I16,
            _ => SampleType::F32,
        });
        options.byte_order = Some(if rest.contains("big") { ByteOrder::Big } else { ByteOrder::Little });
    }
    options
}

#[test]
fn every_file_of_other_programs_has_its_heights() {
    let mut num_read = 0;
    for name in names(&fixtures().join("inputs")) {
        if name.starts_with("nodata-") || name.contains("-feet") {
            continue; // below
        }
        let (width, depth, actual) = import(&input(&name), &options_for(&name)).unwrap();
        assert_eq!((width, depth), (WIDTH, DEPTH), "{name}");
        assert_same(&name, &actual, &heights(name.split(['-', '.']).nth(1).unwrap()));
        num_read += 1;
    }
    assert_eq!(num_read, 89, "fixtures were added or lost: rerun make.py, then count them here");
}

#[test]
fn kinds_that_are_no_heightfield_are_refused() {
    let names = names(&fixtures().join("refused"));
    assert_eq!(names.len(), 16, "fixtures were added or lost: rerun make.py, then count them here");
    for name in names {
        match open(fixtures().join("refused").join(&name), &ImportOptions::default()) {
            Err(Error::Unsupported { path, .. }) => assert!(path.ends_with(&name)),
            // Records are no sample type, so their header is not one that is known.
            Err(Error::Malformed { reason, .. }) if name == "records.npy" => {
                assert!(reason.contains("records"))
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn projected_rasters_have_their_spacing_and_place() {
    for (name, is_point) in [("geotiff-i16-utm-area.tif", false), ("geotiff-i16-utm-point.tif", true)] {
        let import = open(input(name), &ImportOptions::default()).unwrap();
        let info = import.info();
        assert_eq!((info.spacing_m, info.sample), (Some(30.0), SampleType::I16), "{name}");
        assert!(info.notices.is_empty(), "{name}: {:?}", info.notices);
        let expected = Georeference {
            epsg: Some(32611),
            origin: (400_015.0, 3_799_985.0),
            pixel: (30.0, 30.0),
            is_geographic: false,
            is_point,
        };
        assert_eq!(info.georeference, Some(expected), "{name}");
    }
    let bigtiff =
        open(input("geotiff-f32-utm-tile-deflate-p3-bigtiff.tif"), &ImportOptions::default()).unwrap();
    assert_eq!(bigtiff.info().spacing_m, Some(30.0));
}

#[test]
fn a_spacing_in_feet_becomes_metres() {
    let path = input("geotiff-i16-us-feet.tif");
    let import = open(&path, &ImportOptions::default()).unwrap();
    assert!((import.info().spacing_m.unwrap() - 100.0 * 1200.0 / 3937.0).abs() < 1e-9);
    assert_eq!(import.info().georeference.unwrap().epsg, Some(2229));
    let (.., actual) = common::import(&path, &ImportOptions::default()).unwrap();
    assert_same("heights in metres stay", &actual, &heights("i16"));
}

#[test]
fn degrees_and_oblong_pixels_are_resampled_and_said_so() {
    let degrees = open(input("geotiff-f32-degrees.tif"), &ImportOptions::default()).unwrap();
    let info = degrees.info();
    // The middle row's latitude: pixels are areas.
    let latitude = 34.0 + f64::from(DEPTH) / 3600.0 / 2.0;
    let (x_m, z_m) =
        (metres_per_degree_of_longitude(latitude) / 3600.0, metres_per_degree_of_latitude(latitude) / 3600.0);
    assert!((info.spacing_m.unwrap() - x_m).abs() < 1e-9, "{:?}", info.spacing_m);
    assert_eq!((info.width, info.depth), (WIDTH, (12.0 * z_m / x_m).floor() as u32 + 1));
    assert!(info.georeference.unwrap().is_geographic);
    assert!(
        info.notices.iter().any(|notice| notice.contains("resampled from 20 x 13")),
        "{:?}",
        info.notices
    );

    let (width, depth, actual) = import(&input("geotiff-f32-oblong.tif"), &ImportOptions::default()).unwrap();
    assert_eq!((width, depth), (20, 19));
    let expected = heights("f32");
    // Every third row of 20 m falls on every second of 30 m.
    for pair in 0..7 {
        assert_same(
            "rows that fall on rows",
            &actual[pair * 3 * 20..][..20],
            &expected[pair * 2 * 20..][..20],
        );
    }
}

#[test]
fn a_spacing_given_takes_samples_as_they_are_and_says_so() {
    for name in ["geotiff-f32-degrees.tif", "geotiff-f32-oblong.tif"] {
        let options = ImportOptions { spacing_m: Some(25.0), ..Default::default() };
        let import = open(input(name), &options).unwrap();
        assert_eq!((import.info().width, import.info().depth), (WIDTH, DEPTH));
        assert_eq!(import.info().spacing_m, Some(25.0));
        assert!(import.info().notices.iter().any(|notice| notice.contains("as they are")), "{name}");
    }
}

#[test]
fn nodata_is_refused_with_its_count_and_place() {
    for (name, expected) in [
        ("nodata-i16.tif", (12, 9, 4)),
        ("nodata-f32.tif", (2, 3, 0)),
        ("nodata-f32-sparse.tif", (4 * 13, 16, 0)),
    ] {
        match open(input(name), &ImportOptions::default()) {
            Err(Error::Nodata { count, total: 260, column, row, .. }) => {
                assert_eq!((count, column, row), expected, "{name}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn nodata_gets_the_height_given_and_nothing_else_changes() {
    let options = ImportOptions { nodata: NodataPolicy::Value(-3.5), ..Default::default() };
    let (.., actual) = import(&input("nodata-i16.tif"), &options).unwrap();
    let mut expected = heights("i16");
    for (z, x) in (4..7).flat_map(|z| (9..13).map(move |x| (z, x))) {
        expected[z * 20 + x] = -3.5;
    }
    assert_same("nodata-i16.tif", &actual, &expected);
}

#[test]
fn filled_holes_lie_between_their_surroundings_and_repeat() {
    let options = ImportOptions { nodata: NodataPolicy::Fill, ..Default::default() };
    for name in ["nodata-i16.tif", "nodata-f32.tif", "nodata-f32-sparse.tif"] {
        let (.., first) = import(&input(name), &options).unwrap();
        let (.., second) = import(&input(name), &options).unwrap();
        assert_same(name, &first, &second);
        let whole = heights(name.split(['-', '.']).nth(1).unwrap());
        let (low, high) =
            whole.iter().fold((f32::MAX, f32::MIN), |(low, high), h| (low.min(*h), high.max(*h)));
        let num_same = first.iter().zip(&whole).filter(|(actual, whole)| actual == whole).count();
        assert!(first.iter().all(|height_m| (low..=high).contains(height_m)), "{name}");
        assert!(num_same >= 260 - 52, "{name}: {num_same} samples stayed");
    }
    let notices = open(input("nodata-i16.tif"), &options).unwrap().info().notices.clone();
    assert!(notices.iter().any(|notice| notice.contains("12 samples (4.6 %)")), "{notices:?}");
}

#[test]
fn filling_keeps_to_the_memory_limit() {
    let options =
        ImportOptions { nodata: NodataPolicy::Fill, memory_limit_bytes: 1000, ..Default::default() };
    match open(input("nodata-i16.tif"), &options) {
        Err(Error::Memory { limit: 1000, needed, .. }) => assert!(needed > 1000),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_left_out_is_said() {
    let import = open(input("tiff-i16-two-images.tif"), &ImportOptions::default()).unwrap();
    assert!(import.info().notices.iter().any(|notice| notice.contains("first image")));
}

#[test]
fn a_range_maps_pictures_to_metres() {
    let options = ImportOptions { range_m: Some((-100.0, 6_453.5)), ..Default::default() };
    let (.., actual) = import(&input("png-u16.png"), &options).unwrap();
    let expected: Vec<f32> = heights("u16").iter().map(|value| value / 10.0 - 100.0).collect();
    assert!(actual.iter().zip(&expected).all(|(actual, expected)| (actual - expected).abs() < 1e-4));
    assert_ne!(actual[1], heights("u16")[1], "the range did something");
}
