//! What is written is read back: to the bit where a format holds f32, within half a step where it does not.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::path::Path;

use common::{assert_same, export, import};
use orogeny_formats::{ByteOrder, ExportOptions, ImportOptions, SampleType, Sidecar, open};
use proptest::prelude::*;

fn any_height_m() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -12_000.0_f32..9_000.0,
        1 => -1.0e7_f32..1.0e7,
        1 => prop::sample::select(vec![0.0, 1.0e7, -1.0e7, f32::MIN_POSITIVE]),
    ]
}

/// Width and heights of a raster whose heights come from `height_m`.
fn raster(height_m: impl Strategy<Value = f32> + Clone + 'static) -> impl Strategy<Value = (u32, Vec<f32>)> {
    (1_u32..40, 1_usize..40).prop_flat_map(move |(width, depth)| {
        (Just(width), prop::collection::vec(height_m.clone(), width as usize * depth))
    })
}

fn depth_of(width: u32, heights_m: &[f32]) -> u32 {
    u32::try_from(heights_m.len()).unwrap() / width
}

fn round_trip(
    path: &Path,
    export_options: &ExportOptions,
    import_options: &ImportOptions,
    width: u32,
    heights_m: &[f32],
) -> Vec<f32> {
    export(path, export_options, width, heights_m).unwrap();
    let (read_width, read_depth, read) = import(path, import_options).unwrap();
    assert_eq!((read_width, read_depth), (width, depth_of(width, heights_m)));
    read
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn formats_of_f32_keep_every_bit((width, heights_m) in raster(any_height_m().boxed()), big: bool) {
        let folder = tempfile::tempdir().unwrap();
        let size = Some((width, depth_of(width, &heights_m)));
        let byte_order = Some(if big { ByteOrder::Big } else { ByteOrder::Little });
        let sample = Some(SampleType::F32);
        for (name, export_options, import_options) in [
            ("a.npy", ExportOptions::default(), ImportOptions::default()),
            ("a.tif", ExportOptions::default(), ImportOptions::default()),
            (
                "a.r32",
                ExportOptions { byte_order, ..Default::default() },
                ImportOptions { byte_order, size, ..Default::default() },
            ),
            (
                "a.raw",
                ExportOptions { byte_order, sample, ..Default::default() },
                ImportOptions { byte_order, sample, size, ..Default::default() },
            ),
        ] {
            let read = round_trip(&folder.path().join(name), &export_options, &import_options, width, &heights_m);
            assert_same(name, &read, &heights_m);
        }
    }

    #[test]
    fn whole_metres_survive_integer_formats((width, heights_m) in raster((0_u16..=255).prop_map(f32::from).boxed())) {
        let folder = tempfile::tempdir().unwrap();
        let size = Some((width, depth_of(width, &heights_m)));
        for (name, sample, size) in [
            ("a.png", SampleType::U8, None),
            ("b.png", SampleType::U16, None),
            ("a.r16", SampleType::U16, size),
            ("a.raw", SampleType::U8, size),
            ("b.raw", SampleType::U16, size),
            ("c.raw", SampleType::I16, size),
        ] {
            let import_sample = name.ends_with("raw").then_some(sample);
            let export_options = ExportOptions { sample: Some(sample), ..Default::default() };
            let import_options = ImportOptions { sample: import_sample, size, ..Default::default() };
            let read = round_trip(&folder.path().join(name), &export_options, &import_options, width, &heights_m);
            assert_same(name, &read, &heights_m);
        }
    }

    #[test]
    fn ranged_formats_keep_heights_within_half_a_step((width, heights_m) in raster((-400.0_f32..8_000.0).boxed())) {
        let folder = tempfile::tempdir().unwrap();
        let (low, high) = (-400.0, 8_000.0);
        for (name, sample) in [("a.png", SampleType::U8), ("b.png", SampleType::U16), ("a.r16", SampleType::U16)] {
            let path = folder.path().join(name);
            let size = name.ends_with("r16").then(|| (width, depth_of(width, &heights_m)));
            let export_options = ExportOptions { sample: Some(sample), range_m: Some((low, high)), ..Default::default() };
            let import_options = ImportOptions { size, range_m: Some((low, high)), ..Default::default() };
            let read = round_trip(&path, &export_options, &import_options, width, &heights_m);
            let half_a_step_m = (high - low) / f64::from(sample.range_maximum().unwrap()) / 2.0;
            for (read, height_m) in read.iter().zip(&heights_m) {
                // A millimetre for the last place of an f32.
                prop_assert!((f64::from(*read) - f64::from(*height_m)).abs() <= half_a_step_m + 1e-3);
            }
            prop_assert_eq!(Sidecar::of(&path).unwrap().range_m, (low, high));
        }
    }
}

#[test]
fn a_spacing_survives_tiff() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    export(&path, &ExportOptions { spacing_m: Some(0.75), ..Default::default() }, 5, &[1.0; 15]).unwrap();
    let import = open(&path, &ImportOptions::default()).unwrap();
    assert_eq!(import.info().spacing_m, Some(0.75));
    let georeference = import.info().georeference.unwrap();
    assert_eq!((georeference.epsg, georeference.origin, georeference.is_point), (None, (0.0, 0.0), true));
}

#[test]
fn a_sidecar_is_told_of_but_not_obeyed_and_does_not_outlive_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let ranged = ExportOptions { range_m: Some((10.0, 20.0)), ..Default::default() };
    export(&path, &ranged, 2, &[10.0, 20.0, 15.0, 12.0]).unwrap();
    let mut import = open(&path, &ImportOptions::default()).unwrap();
    let notices = import.info().notices.join("; ");
    assert!(notices.contains("a.png.json") && notices.contains("10,20"), "{notices}");
    assert_eq!(common::read_all(&mut import, 1).unwrap()[..2], [0.0, 65535.0]);

    export(&path, &ExportOptions::default(), 2, &[10.0, 20.0, 15.0, 12.0]).unwrap();
    assert_eq!(common::names(folder.path()), ["a.png"]);

    // A file of another program is not ours to remove.
    std::fs::write(folder.path().join("a.png.json"), "{\"mine\": true}").unwrap();
    export(&path, &ExportOptions::default(), 2, &[10.0, 20.0, 15.0, 12.0]).unwrap();
    assert_eq!(common::names(folder.path()), ["a.png", "a.png.json"]);
}

#[test]
fn many_strips_and_wide_rows_survive_tiff() {
    let folder = tempfile::tempdir().unwrap();
    for (width, depth) in [(70_000_u32, 3_u32), (257, 2_000), (1, 70_000)] {
        let heights_m: Vec<f32> = (0..width * depth).map(|n| (n % 7919) as f32 * 0.25).collect();
        let path = folder.path().join(format!("{width}.tif"));
        let read = round_trip(&path, &ExportOptions::default(), &ImportOptions::default(), width, &heights_m);
        assert_same("tiff", &read, &heights_m);
    }
}

#[test]
fn rounding_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let notices = export(&folder.path().join("a.png"), &ExportOptions::default(), 2, &[1.0, 2.25]).unwrap();
    assert!(notices.iter().any(|notice| notice.contains("at most 0.250000 m")), "{notices:?}");
    assert!(
        export(&folder.path().join("b.png"), &ExportOptions::default(), 2, &[1.0, 2.0]).unwrap().is_empty()
    );
}
