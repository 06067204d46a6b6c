//! Pictures that people have looked at. `cargo xtask golden` draws them anew; look at what changed before it is kept.
//!
//! A picture may differ by rounding: no more than [`MAX_MEAN`] of a channel's 255 in the mean, and [`FAR`] in [`MAX_SHARE_FAR`] of its pixels. One that differs more
//! leaves `NAME.expected.png`, `NAME.actual.png` and `NAME.difference.png` in `target/pictures/`.

use std::io;
use std::path::Path;

use orogeny_engine::{
    Cursor, EntryId, Error, HeightAt, Mode, Operation, Picture, Quiet, Terrain, ViewRequest,
};
use orogeny_tests::{repository, skip};

use crate::views::{difference, draw, frazier, imported, place, settings};

const MAX_MEAN: f64 = 1.0;
const FAR: u8 = 24;
const MAX_SHARE_FAR: f64 = 0.01;

const SIZE: [u32; 2] = [320, 180];

fn decoded(bytes: &[u8]) -> Picture {
    let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut rgb).unwrap();
    assert_eq!(frame.color_type, png::ColorType::Rgb);
    Picture { width_px: frame.width, height_px: frame.height, rgb }
}

/// What is wrong with a picture; `None`: nothing.
fn mismatch(expected: &Picture, actual: &Picture) -> Option<String> {
    if (expected.width_px, expected.height_px) != (actual.width_px, actual.height_px) {
        return Some("it has another size".to_owned());
    }
    let (mean, largest) = difference(&expected.rgb, &actual.rgb);
    let pixels = expected.rgb.chunks_exact(3).zip(actual.rgb.chunks_exact(3));
    let num_far = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > FAR)).count();
    let share = num_far as f64 / (expected.rgb.len() / 3) as f64;
    (mean > MAX_MEAN || share > MAX_SHARE_FAR).then(|| {
        format!(
            "it is off by {mean:.2} in the mean, {largest} at most, {:.2} % of its pixels by more than {FAR}",
            share * 100.0
        )
    })
}

fn compare(name: &str, actual: &Picture) -> Option<String> {
    let golden = repository().join("tests/golden/pictures").join(format!("{name}.png"));
    if std::env::var_os("OROGENY_GOLDEN").is_some_and(|value| value == "write") {
        actual.write(&golden).unwrap();
        return None;
    }
    let Ok(bytes) = std::fs::read(&golden) else {
        return Some(format!("{name}: there is no {}; draw it by `cargo xtask golden`", golden.display()));
    };
    let expected = decoded(&bytes);
    let wrong = mismatch(&expected, actual)?;
    let folder = repository().join("target/pictures");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join(format!("{name}.expected.png")), bytes).unwrap();
    actual.write(&folder.join(format!("{name}.actual.png"))).unwrap();
    if expected.rgb.len() == actual.rgb.len() {
        let rgb =
            expected.rgb.iter().zip(&actual.rgb).map(|(a, b)| a.abs_diff(*b).saturating_mul(8)).collect();
        Picture { rgb, ..expected }.write(&folder.join(format!("{name}.difference.png"))).unwrap();
    }
    Some(format!("{name}: {wrong}; see {}", folder.display()))
}

fn assert_golden(prefix: &str, terrain: &Terrain, views: &[(&str, ViewRequest)]) {
    assert!(!views.is_empty());
    let wrong: Vec<_> = views
        .iter()
        .filter_map(|(name, request)| {
            let drawn = draw(terrain, request);
            assert_eq!(drawn.report.num_missing, 0, "{name}");
            compare(&format!("{prefix}-{name}"), &drawn.picture)
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn near() -> ViewRequest {
    ViewRequest {
        size_px: SIZE,
        eye: place(9_000.0, HeightAt::AboveGround(900.0), 16_500.0),
        target: place(14_500.0, HeightAt::AboveGround(0.0), 11_000.0),
        ..ViewRequest::default()
    }
}

#[test]
fn every_mode() {
    let folder = tempfile::tempdir().unwrap();
    let terrain = frazier(folder.path());
    let views: Vec<_> = Mode::ALL
        .into_iter()
        .filter(|mode| !matches!(mode, Mode::Overlay | Mode::Difference))
        // Coarse enough for edges to be seen.
        .map(|mode| (mode, if mode == Mode::Wireframe { 12.0 } else { 2.0 }))
        .map(|(mode, max_error_px)| (mode.name(), ViewRequest { mode, max_error_px, ..near() }))
        .collect();
    assert_golden("frazier", &terrain, &views);
}

#[test]
fn the_difference_to_an_earlier_entry() {
    let folder = tempfile::tempdir().unwrap();
    let imported = frazier(folder.path());
    let entry = imported.log().unwrap().last().map_or(EntryId::CREATION, |entry| entry.id);
    imported.close().unwrap();
    let path = folder.path().join("real.orogeny");
    let mut terrain = Terrain::open(&path, settings()).unwrap();
    let stroke = |brush: &str, from: [f64; 2], to: [f64; 2]| {
        let text = format!(
            r#"{{"op": "stroke", "brush": {{"type": "{brush}", "radius": 1100, "strength": 160}}, "points": [{from:?}, {to:?}]}}"#
        );
        Operation::from_json_text(&text).unwrap()
    };
    let strokes = [
        stroke("raise", [11_500.0, 11_500.0], [12_500.0, 13_500.0]),
        stroke("lower", [14_500.0, 13_000.0], [15_500.0, 11_000.0]),
    ];
    terrain.apply(&strokes, &mut Quiet).unwrap();
    terrain.close().unwrap();

    let terrain = Terrain::open_to_read(&path, settings()).unwrap();
    let past = Terrain::open_to_read_at(&path, entry, settings()).unwrap();
    let request = ViewRequest { mode: Mode::Difference, ..near() };
    let mut view = terrain.view(SIZE).unwrap();
    assert!(matches!(view.draw(&request, &mut Quiet), Err(Error::NothingToCompare)));
    view.compare_with(&past).unwrap();
    let drawn = view.draw(&request, &mut Quiet).unwrap();
    assert_eq!(drawn.report.num_missing, 0);
    let most_m = drawn.difference_m.unwrap();
    assert!((100.0..2_000.0).contains(&most_m), "{most_m}");
    // Whatever was drawn in between, and with what it found itself given, it is the same picture.
    view.draw(&near(), &mut Quiet).unwrap();
    let given = ViewRequest { range_m: Some([-1.0, most_m]), ..request };
    let again = view.draw(&given, &mut Quiet).unwrap();
    assert!((again.difference_m, &again.picture) == (Some(most_m), &drawn.picture));
    assert_eq!(compare("frazier-difference", &drawn.picture), None);

    // Where the two are the same, everything has the colour in the middle: grey in the light of the sky and of the sun.
    let mut view = past.view(SIZE).unwrap();
    let same = Terrain::open_to_read_at(&path, entry, settings()).unwrap();
    view.compare_with(&same).unwrap();
    let down = ViewRequest {
        eye: place(12_000.0, HeightAt::AboveGround(3_000.0), 12_001.0),
        target: place(12_000.0, HeightAt::AboveGround(0.0), 12_000.0),
        haze: 0.0,
        range_m: None,
        ..given
    };
    let unchanged = view.draw(&down, &mut Quiet).unwrap().picture;
    let far_from_grey = |pixel: &&[u8]| pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 60;
    assert_eq!(unchanged.rgb.chunks_exact(3).filter(far_from_grey).count(), 0);
}

#[test]
fn sun_water_haze_and_material_sets() {
    let folder = tempfile::tempdir().unwrap();
    let terrain = frazier(folder.path());
    let low = ViewRequest { sun_azimuth_degrees: 255.0, sun_altitude_degrees: 8.0, ..near() };
    let water = ViewRequest { water_level_m: Some(1_150.0), ..near() };
    let haze = ViewRequest { haze: 6.0, ..near() };
    let flat = ViewRequest { mode: Mode::Shaded, slope_exaggeration: 4.0, has_shadows: false, ..near() };
    let set = |name: &str| ViewRequest { materials: orogeny_engine::Materials::from_name(name), ..near() };
    let cursor = |x_m: f64, radius_m: f32| Cursor { centre_m: [x_m, 12_000.0], radius_m, hardness: 0.4 };
    let rings = vec![cursor(13_000.0, 900.0), cursor(15_500.0, 500.0)];
    let cursors = ViewRequest { mode: Mode::Shaded, cursors: rings, ..near() };
    let views = [
        ("cursors", cursors),
        ("low-sun", low),
        ("water", water),
        ("haze", haze),
        ("exaggerated", flat),
        ("desert", set("desert")),
        ("volcanic", set("volcanic")),
    ];
    assert_golden("frazier", &terrain, &views);
}

#[test]
fn the_whole_tile_from_far_near_above_and_on_the_ground() {
    let Some(data) = std::env::var_os("OROGENY_DATA") else {
        skip("the_whole_tile_from_far_near_above_and_on_the_ground", "OROGENY_DATA is not set");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let terrain = imported(folder.path(), &Path::new(&data).join("nasadem_n34w119_int16.tif"));
    let view = ViewRequest { size_px: SIZE, ..ViewRequest::default() };
    let near = ViewRequest {
        eye: place(22_000.0, HeightAt::AboveGround(1_500.0), 38_000.0),
        target: place(30_000.0, HeightAt::AboveGround(0.0), 30_000.0),
        ..view.clone()
    };
    let down = ViewRequest {
        eye: place(30_000.0, HeightAt::AboveGround(12_000.0), 30_000.0),
        target: place(30_000.0, HeightAt::AboveGround(0.0), 30_000.0),
        ..view.clone()
    };
    let ground = ViewRequest {
        eye: place(25_000.0, HeightAt::AboveGround(2.0), 33_200.0),
        target: place(24_000.0, HeightAt::AboveGround(100.0), 36_000.0),
        ..view.clone()
    };
    assert_golden("tile", &terrain, &[("far", view), ("near", near), ("down", down), ("ground", ground)]);
}

#[test]
fn a_picture_that_differs_is_told_apart() {
    let picture = |grey: u8| Picture { width_px: 20, height_px: 10, rgb: vec![grey; 600] };
    assert_eq!(mismatch(&picture(100), &picture(101)), None);
    assert!(mismatch(&picture(100), &picture(102)).is_some());
    let mut spotted = picture(100);
    spotted.rgb[..6].fill(130);
    assert_eq!(mismatch(&picture(100), &spotted), None);
    spotted.rgb[..9].fill(130);
    assert!(mismatch(&picture(100), &spotted).is_some());
    assert!(mismatch(&picture(100), &Picture { width_px: 10, height_px: 20, rgb: vec![100; 600] }).is_some());
}
