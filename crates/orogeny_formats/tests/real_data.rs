//! Elevation data as it is handed out, where the folder named by `OROGENY_DATA` has it.
//!
//! The files are too large to keep here: SRTM and NASADEM tiles and what GDAL made of them. Without the folder every
//! test says in one line that it was skipped, so that a run shows how many were.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{assert_same, import, read_all};
use orogeny_formats::{Error, ImportOptions, NodataPolicy, SampleType, open};

/// Tests that were skipped so far in this run.
static NUM_SKIPPED: AtomicUsize = AtomicUsize::new(0);

/// The file, or none after saying so where no folder is named. A folder without the file is a failure.
fn data(test: &str, name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("OROGENY_DATA") else {
        let num_skipped = NUM_SKIPPED.fetch_add(1, Ordering::Relaxed) + 1;
        let line = format!(
            "SKIPPED ({num_skipped}): real data, {test}: needs {name}, set OROGENY_DATA to its folder\n"
        );
        // Not by a macro: the harness would hide what a passing test prints.
        std::io::stderr().write_all(line.as_bytes()).unwrap();
        return None;
    };
    let path = PathBuf::from(folder).join(name);
    assert!(path.is_file(), "OROGENY_DATA is set, but {} is not there", path.display());
    Some(path)
}

fn as_is() -> ImportOptions {
    ImportOptions { spacing_m: Some(30.0), ..Default::default() }
}

fn range(heights_m: &[f32]) -> (f32, f32) {
    heights_m.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), h| (low.min(*h), high.max(*h)))
}

fn mean(heights_m: &[f32]) -> f64 {
    heights_m.iter().map(|h| f64::from(*h)).sum::<f64>() / heights_m.len() as f64
}

#[test]
fn a_tile_is_the_same_in_a_zip_and_in_a_geotiff() {
    let Some(zip) = data("zip and geotiff", "N34W119.hgt.zip") else { return };
    let Some(tiff) = data("zip and geotiff", "nasadem_n34w119_int16.tif") else { return };
    let (width, depth, zip) = import(&zip, &as_is()).unwrap();
    assert_eq!((width, depth, range(&zip)), (3601, 3601, (-17.0, 2446.0)));
    assert!((mean(&zip) - 735.40).abs() < 0.005);
    assert_same("tile", &import(&tiff, &as_is()).unwrap().2, &zip);

    let Some(crop) = data("zip and geotiff", "frazier_1024_int16.tif") else { return };
    let (width, depth, crop) = import(&crop, &as_is()).unwrap();
    assert_eq!((width, depth), (1024, 1024));
    let corner: Vec<f32> = zip.chunks_exact(3601).take(1024).flat_map(|row| row[..1024].to_vec()).collect();
    assert_same("north-west corner", &crop, &corner);
}

#[test]
fn a_tile_in_degrees_becomes_square_metres_that_agree_between_formats() {
    let Some(zip) = data("resampling", "N34W119.hgt.zip") else { return };
    let Some(tiff) = data("resampling", "nasadem_n34w119_int16.tif") else { return };
    let mut from_zip = open(&zip, &ImportOptions::default()).unwrap();
    let mut from_tiff = open(&tiff, &ImportOptions::default()).unwrap();
    assert_eq!((from_zip.info().width, from_zip.info().depth), (3601, 4349));
    assert!((from_zip.info().spacing_m.unwrap() - 25.51).abs() < 0.01);
    assert_eq!(from_tiff.info().georeference.unwrap().epsg, Some(4326));
    let (near, far) = (from_zip.info().georeference.unwrap(), from_tiff.info().georeference.unwrap());
    assert!((near.origin.0 - far.origin.0).abs() < 1e-9 && (near.origin.1 - far.origin.1).abs() < 1e-9);

    let (from_zip, from_tiff) = (read_all(&mut from_zip, 64).unwrap(), read_all(&mut from_tiff, 64).unwrap());
    let worst_m = from_zip.iter().zip(&from_tiff).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst_m < 0.01, "{worst_m} m between the two");
    let (low, high) = range(&from_zip);
    assert!(low >= -17.0 && high <= 2446.0, "no overshoot: {low} to {high}");
    assert!((mean(&from_zip) - 735.40).abs() < 0.5);
}

#[test]
fn voids_of_the_first_srtm_are_counted_and_filled() {
    let Some(path) = data("voids", "mt_everest_srtm3.tif") else { return };
    match open(&path, &as_is()) {
        Err(Error::Nodata { count: 130_953, total, .. }) => assert_eq!(total, 1201 * 1201),
        other => panic!("{other:?}"),
    }
    let options = ImportOptions { nodata: NodataPolicy::Fill, ..as_is() };
    let (.., filled) = import(&path, &options).unwrap();
    let (low, high) = range(&filled);
    assert!(low >= 192.0 && high <= 8642.01, "{low} to {high}");
    let marked = import(&path, &ImportOptions { nodata: NodataPolicy::Value(-1.0), ..as_is() }).unwrap().2;
    let there: Vec<f32> = marked.iter().copied().filter(|&h| h != -1.0).collect();
    assert_eq!((there.len(), range(&there)), (1201 * 1201 - 130_953, (192.0, 8642.0)));
    assert!((mean(&there) - 2378.96).abs() < 0.01);
    // No height that was there moved.
    assert!(marked.iter().zip(&filled).all(|(marked, filled)| *marked == -1.0 || marked == filled));
}

#[test]
fn small_tiles_have_their_heights() {
    let Some(washington) = data("small tiles", "N44W072.hgt") else { return };
    let (width, depth, heights_m) = import(&washington, &as_is()).unwrap();
    assert_eq!((width, depth, range(&heights_m)), (1201, 1201, (115.0, 1908.0)));
    assert_eq!(heights_m[876 * 1201 + 835], 1908.0, "Mount Washington");

    let Some(pico) = data("small tiles", "N38W029.SRTMGL3.hgt.zip") else { return };
    let (.., heights_m) = import(&pico, &as_is()).unwrap();
    assert_eq!(range(&heights_m), (-4.0, 2304.0));
    assert_eq!(
        open(&pico, &ImportOptions::default()).unwrap().info().georeference.unwrap().origin,
        (-29.0, 39.0)
    );
}

#[test]
fn projected_tiles_have_their_spacing() {
    for (name, size, spacing_m, epsg, expected) in [
        ("bigtujunga.tif", (1197, 643), 30.0, 32611, (315.0, 2295.0)),
        ("grandcanyon.tif", (512, 512), 76.4, 3857, (479.0, 2347.0)),
    ] {
        let Some(path) = data("projected tiles", name) else { return };
        let mut import = open(&path, &ImportOptions::default()).unwrap();
        let info = import.info().clone();
        assert_eq!((info.width, info.depth), size, "{name}: {:?}", info.notices);
        assert!((info.spacing_m.unwrap() - spacing_m).abs() < 0.05, "{name}: {:?}", info.spacing_m);
        assert_eq!((info.georeference.unwrap().epsg, info.sample), (Some(epsg), SampleType::I16), "{name}");
        assert_eq!(info.notices.iter().any(|notice| notice.contains("Web Mercator")), epsg == 3857);
        assert_eq!(range(&read_all(&mut import, 17).unwrap()), expected, "{name}");
    }
}

#[test]
fn headless_samples_and_pictures_agree_with_the_tile_they_were_cut_from() {
    let Some(r16) = data("headless", "mtwashington_1025.r16") else { return };
    let Some(png) = data("headless", "mtwashington_1025_16bit.png") else { return };
    let Some(tile) = data("headless", "N44W072.hgt") else { return };
    // A sample is a 32nd of a metre.
    let options = ImportOptions { range_m: Some((0.0, 65535.0 / 32.0)), ..Default::default() };
    let (width, depth, r16) = import(&r16, &options).unwrap();
    assert_eq!((width, depth), (1025, 1025));
    assert_same("picture", &import(&png, &options).unwrap().2, &r16);
    let (.., tile) = import(&tile, &as_is()).unwrap();
    let cut: Vec<f32> = tile.chunks_exact(1201).skip(176).flat_map(|row| row[176..].to_vec()).collect();
    assert_same("cut", &r16, &cut);
}
