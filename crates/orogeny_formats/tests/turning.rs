//! Rasters that are turned and mirrored as they are read: every bit of the same heights, elsewhere.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::path::Path;

use common::{assert_same, export, import};
use orogeny_formats::{ExportOptions, Flip, ImportOptions, NodataPolicy, open};
use proptest::prelude::*;

/// What a file of these heights is read as.
fn read(
    folder: &Path,
    (width, heights_m): (u32, &[f32]),
    rotate_degrees: u16,
    flip: Flip,
) -> (u32, Vec<f32>) {
    let path = folder.join("a.npy");
    export(&path, &ExportOptions::default(), width, heights_m).unwrap();
    let options = ImportOptions { rotate_degrees, flip, ..ImportOptions::default() };
    let (width, depth, read) = import(&path, &options).unwrap();
    assert_eq!(read.len(), width as usize * depth as usize);
    (width, read)
}

/// A quarter clockwise of an array, as a sheet of paper is turned.
fn quarter((width, heights_m): (u32, Vec<f32>)) -> (u32, Vec<f32>) {
    let depth = heights_m.len() as u32 / width;
    let at = |x: u32, z: u32| heights_m[(z * width + x) as usize];
    (depth, (0..width).flat_map(|x| (0..depth).rev().map(move |z| (x, z))).map(|(x, z)| at(x, z)).collect())
}

fn flipped((width, heights_m): (u32, Vec<f32>), flip: Flip) -> (u32, Vec<f32>) {
    let rows = heights_m.chunks(width as usize).map(<[f32]>::to_vec);
    let mut rows: Vec<_> = rows.collect();
    if matches!(flip, Flip::EastWest | Flip::Both) {
        rows.iter_mut().for_each(|row| row.reverse());
    }
    if matches!(flip, Flip::NorthSouth | Flip::Both) {
        rows.reverse();
    }
    (width, rows.concat())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_file_is_the_turned_array(
        (width, heights_m) in (1_u32..40, 1_usize..40).prop_flat_map(|(width, depth)| {
            (Just(width), prop::collection::vec(-9000.0_f32..9000.0, width as usize * depth))
        }),
        quarters in 0_u16..4,
        flip in prop::sample::select(Flip::ALL.to_vec()),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let (read_width, read) = read(folder.path(), (width, &heights_m), 90 * quarters, flip);
        let turned = (0..quarters).fold((width, heights_m), |raster, _| quarter(raster));
        let (expected_width, expected) = flipped(turned, flip);
        prop_assert_eq!(read_width, expected_width);
        assert_same("turned", &read, &expected);
    }

    #[test]
    fn four_quarters_and_two_mirrors_are_nothing(
        (width, heights_m) in (1_u32..30, 1_usize..30).prop_flat_map(|(width, depth)| {
            (Just(width), prop::collection::vec(-9000.0_f32..9000.0, width as usize * depth))
        }),
        flip in prop::sample::select(Flip::ALL.to_vec()),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut raster = (width, heights_m.clone());
        for _ in 0..4 {
            raster = read(folder.path(), (raster.0, &raster.1), 90, Flip::None);
        }
        prop_assert_eq!(raster.0, width);
        assert_same("four quarters", &raster.1, &heights_m);
        for _ in 0..2 {
            raster = read(folder.path(), (raster.0, &raster.1), 0, flip);
        }
        assert_same("two mirrors", &raster.1, &heights_m);
    }
}

/// Samples without a height are found where the file has them, and what replaces them goes along.
#[test]
fn what_is_filled_in_is_turned_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.r32");
    let mut heights_m = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0];
    heights_m[2] = f32::NAN;
    std::fs::write(&path, heights_m.map(f32::to_le_bytes).concat()).unwrap();
    let options = ImportOptions { size: Some((3, 2)), rotate_degrees: 270, ..ImportOptions::default() };
    let err = open(&path, &options).unwrap_err().to_string();
    assert!(err.contains("column 2, row 0"), "{err}");
    let filled = ImportOptions { nodata: NodataPolicy::Value(9.0), ..options };
    let (width, depth, read) = import(&path, &filled).unwrap();
    assert_eq!((width, depth, read), (2, 3, vec![9.0, 6.0, 2.0, 5.0, 1.0, 4.0]));
}

/// As JSON, what was read before it could be turned is the same as what is not turned.
#[test]
fn options_that_turn_nothing_say_nothing_of_it() {
    let plain = serde_json::to_string(&ImportOptions::default()).unwrap();
    assert!(!plain.contains("rotate") && !plain.contains("flip"), "{plain}");
    let options = ImportOptions { rotate_degrees: 90, flip: Flip::NorthSouth, ..ImportOptions::default() };
    let text = serde_json::to_string(&options).unwrap();
    assert!(text.contains(r#""rotate":90"#) && text.contains(r#""flip":"north_south""#), "{text}");
    assert_eq!(serde_json::from_str::<ImportOptions>(&text).unwrap(), options);
    assert_eq!(serde_json::from_str::<ImportOptions>(&plain).unwrap(), ImportOptions::default());
}
