//! Pictures as bitmaps: the values of files that other programs wrote (`tests/fixtures/bitmaps/make.py`), and damage.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::{crc32, names};
use orogeny_formats::{
    Bitmap, Error, ExportOptions, Format, ImportOptions, MAX_BITMAP_SIDE, create, open, read_bitmap,
};

const WIDTH: u32 = 20;
const HEIGHT: u32 = 13;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/bitmaps").join(name)
}

/// Names and bytes of the fixtures of a folder.
fn files(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = folder(name);
    names(&folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

fn input(name: &str) -> Vec<u8> {
    fs::read(folder("inputs").join(name)).unwrap()
}

/// The whole numbers of a channel at a pixel, as `make.py` defines them.
fn whole(channel: u32, x: u32, y: u32) -> u32 {
    (3 * x * x + 7 * y * y + 5 * x * y + 41 * channel) % 1000
}

fn luminance(colours: &[f64]) -> f64 {
    0.2126 * colours[0] + 0.7152 * colours[1] + 0.0722 * colours[2]
}

/// The value of a pixel of the PNG fixture of this kind and of samples of so many bits.
fn png_value(kind: &str, bits: u32, x: u32, y: u32) -> f64 {
    let maximum = (1 << bits) - 1;
    let factor = if bits == 16 { 65 } else { 1 };
    let stored = |channel, x, y| whole(channel, x, y) * factor % (maximum + 1);
    let sample = |channel| f64::from(stored(channel, x, y)) / f64::from(maximum);
    let colour = luminance(&[sample(0), sample(1), sample(2)]);
    let differs = |channel| stored(channel, x, y) != stored(channel, 0, 0);
    let index = f64::from(stored(0, x, y));
    let of_palette = luminance(&[17.0 * index, 255.0 - 9.0 * index, 5.0 * index]) / 255.0;
    match kind {
        "grey" => sample(0),
        "grey_alpha" => sample(0) * sample(1),
        "grey_key" => sample(0) * f64::from(differs(0)),
        "rgb" => colour,
        "rgba" => colour * sample(3),
        "rgb_key" => colour * f64::from(differs(0) || differs(1) || differs(2)),
        "palette" => of_palette,
        "palette_alpha" => of_palette * (250.0 - 13.0 * index) / 255.0,
        other => panic!("no fixture is of kind {other}"),
    }
}

/// The value of a pixel of the EXR fixture with these channels.
fn exr_value(channels: &str, sample: &str, x: u32, y: u32) -> f64 {
    let number = |name: char| {
        let channel = channels.chars().position(|channel| channel == name)?;
        let whole = f64::from(whole(channel as u32, x, y));
        let is_whole = sample == "u32" || (sample == "mixed" && name == 'B');
        Some(if is_whole { whole } else { whole / 8.0 - 12.5 })
    };
    let alpha = number('A').unwrap_or(1.0);
    match (number('Y'), number('R'), number('G'), number('B'), number('Z')) {
        (Some(luminance), ..) => luminance * alpha,
        (_, Some(red), Some(green), Some(blue), _) => luminance(&[red, green, blue]) * alpha,
        (_, Some(only), ..) | (.., Some(only)) => only * alpha,
        _ => alpha,
    }
}

#[test]
fn every_file_of_other_programs_has_its_values() {
    let mut num_read = 0;
    for (name, bytes) in files("inputs") {
        let bitmap = read_bitmap(&bytes, &name).unwrap();
        let parts: Vec<&str> = name.split(['-', '.']).collect();
        let (size, value): (_, &dyn Fn(u32, u32) -> f64) = match parts[0] {
            "png" => ((WIDTH, HEIGHT), &|x, y| png_value(parts[1], parts[2][1..].parse().unwrap(), x, y)),
            "exr" => ((WIDTH, HEIGHT), &|x, y| exr_value(parts[1], parts[2], x, y)),
            _ => ((64, 48), &|x, y| f64::from(x + 2 * y) / 8.0),
        };
        assert_eq!((bitmap.width(), bitmap.height()), size, "{name}");
        let pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
        for ((x, y), &actual) in pixels.zip(bitmap.values()) {
            let expected = value(x, y);
            let error = (f64::from(actual) - expected).abs();
            assert!(error <= 1e-7 * expected.abs().max(1.0), "{name} at {x}, {y}: {actual}, not {expected}");
        }
        num_read += 1;
    }
    assert_eq!(num_read, 59, "fixtures were added or lost: rerun make.py, then count them here");
}

#[test]
fn kinds_that_are_no_bitmap_are_refused() {
    let files = files("refused");
    assert_eq!(files.len(), 9, "fixtures were added or lost: rerun make.py, then count them here");
    for (name, bytes) in files {
        match read_bitmap(&bytes, &name) {
            Err(Error::Unsupported { path, format: Format::Exr, reason }) => {
                assert_eq!(path, Path::new(&name));
                let is_value = ["nan.exr", "infinite.exr", "too_great.exr"].contains(&name.as_str());
                assert_eq!(reason.contains("column 3, row 4"), is_value, "{name}: {reason}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn the_content_tells_the_format_and_errors_tell_the_name() {
    let png = input("png-grey-u8.png");
    assert_eq!(read_bitmap(&png, "disguised.exr").unwrap(), read_bitmap(&png, "a.png").unwrap());
    for bytes in [&b""[..], b"\x89PNG", b"v/1", b"GIF89a"] {
        let err = read_bitmap(bytes, "leaf.png").unwrap_err();
        assert!(matches!(err, Error::UnknownContent { .. }), "{err:?}");
        assert!(err.to_string().starts_with("leaf.png: "), "{err}");
    }
    let err = read_bitmap(&png[..100], "brushes/leaf").unwrap_err();
    assert_eq!(err.to_string(), "brushes/leaf: the PNG file ends too early: it is cut off or damaged");
}

#[test]
fn bitmaps_hold_what_they_say() {
    let bitmap = Bitmap::new(2, 1, vec![0.25, -3.0]).unwrap();
    assert_eq!((bitmap.width(), bitmap.height(), bitmap.values()), (2, 1, &[0.25, -3.0][..]));
    let long = MAX_BITMAP_SIDE + 1;
    for (width, height, values, expected) in [
        (0, 1, vec![], "1 to 4096"),
        (1, 0, vec![], "1 to 4096"),
        (long, 1, vec![0.0; long as usize], "1 to 4096"),
        (u32::MAX, u32::MAX, vec![0.0], "1 to 4096"),
        (2, 2, vec![0.0; 3], "3 values"),
        (2, 1, vec![0.0, f32::NAN], "value 1 is not finite"),
        (1, 1, vec![f32::INFINITY], "value 0 is not finite"),
    ] {
        let err = Bitmap::new(width, height, values).unwrap_err();
        assert!(matches!(err, Error::Bitmap { .. }) && err.to_string().contains(expected), "{err}");
    }
    assert!(Bitmap::new(MAX_BITMAP_SIDE, 1, vec![0.0; MAX_BITMAP_SIDE as usize]).is_ok());
}

#[test]
fn exr_is_no_format_of_heights() {
    let path = folder("inputs").join("exr-Y-f32-none.exr");
    let options = ImportOptions { format: Some(Format::Exr), ..Default::default() };
    assert!(matches!(open(&path, &options), Err(Error::Unsupported { .. })));
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("a.exr");
    let options = ExportOptions { format: Some(Format::Exr), ..Default::default() };
    assert!(matches!(create(&path, &options, 2, 2), Err(Error::Unsupported { .. })));
    assert!(names(temporary.path()).is_empty());
}

/// Reads what may be damaged; a picture that is still one is sound.
fn read_damaged(bytes: &[u8], name: &str) -> Result<Bitmap, Error> {
    let bitmap = read_bitmap(bytes, name)?;
    assert_eq!(bitmap.values().len() as u64, u64::from(bitmap.width()) * u64::from(bitmap.height()));
    let limits = if name.ends_with("png") { 0.0..=1.0 } else { -1e7..=1e7 };
    assert!(bitmap.values().iter().all(|value| limits.contains(value)), "{name}");
    Ok(bitmap)
}

#[test]
fn every_truncation_is_a_typed_error_or_the_same_picture() {
    let mut num_refused = 0;
    for (name, bytes) in files("inputs") {
        let whole = read_damaged(&bytes, &name).unwrap();
        for length in 0..bytes.len() {
            match read_damaged(&bytes[..length], &name) {
                Ok(bitmap) => assert_eq!(bitmap, whole, "{name} cut to {length} of {} bytes", bytes.len()),
                Err(Error::Truncated { .. } | Error::Malformed { .. } | Error::UnknownContent { .. }) => {
                    num_refused += 1
                }
                Err(err) => panic!("{name} cut to {length} of {} bytes: {err:?}", bytes.len()),
            }
        }
    }
    assert!(num_refused > 60_000, "{num_refused} were refused");
}

#[test]
fn damaged_bytes_are_an_error_or_still_a_picture() {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    // Marsaglia's xorshift: the same damage in every run.
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed as usize
    };
    let mut num_refused = 0;
    for (name, bytes) in files("inputs").into_iter().chain(files("refused")) {
        for _ in 0..500 {
            let mut damaged = bytes.clone();
            // Half of the damage is in headers.
            let end = if random() % 2 == 0 { bytes.len() } else { bytes.len().min(450) };
            damaged[random() % end] = random() as u8;
            num_refused += usize::from(read_damaged(&damaged, &name).is_err());
        }
    }
    assert!(num_refused > 10_000, "{num_refused} were refused");
}

/// The header of an EXR file and a table of places; no block follows.
fn exr(flags: u32, window: [i32; 4], compression: u8, tile: u32, channels: &[(&str, u32)]) -> Vec<u8> {
    let mut list = Vec::new();
    for &(name, sampling) in channels {
        list.extend(name.as_bytes());
        // The name's end, f32, and a hint.
        list.extend([0, 2, 0, 0, 0, 0, 0, 0, 0]);
        list.extend([sampling, sampling].map(u32::to_le_bytes).concat());
    }
    list.push(0);
    let mut bytes = b"\x76\x2f\x31\x01".to_vec();
    bytes.extend((2 | flags).to_le_bytes());
    let mut attribute = |name: &[u8], kind: &[u8], value: &[u8]| {
        bytes.extend([name, b"\0", kind, b"\0"].concat());
        bytes.extend((value.len() as u32).to_le_bytes());
        bytes.extend(value);
    };
    attribute(b"channels", b"chlist", &list);
    attribute(b"compression", b"compression", &[compression]);
    attribute(b"dataWindow", b"box2i", &window.map(i32::to_le_bytes).concat());
    attribute(b"tiles", b"tiledesc", &[&tile.to_le_bytes()[..], &tile.to_le_bytes(), &[0]].concat());
    bytes.push(0);
    bytes.extend([0xff; 64]);
    bytes
}

const TILED: u32 = 1 << 9;

#[test]
fn headers_that_promise_too_much_are_refused_unread() {
    let start = Instant::now();
    let refused = |bytes: &[u8]| read_bitmap(bytes, "a").unwrap_err();
    let y = [("Y", 1)];
    for compression in 0..=5 {
        for flags in [0, TILED] {
            // Windows of 2^60 pixels and of more, sides that are none, and one row too many.
            for window in [
                [0, 0, 1 << 30, 1 << 30],
                [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
                [i32::MAX, i32::MAX, i32::MIN, i32::MIN],
                [0, 0, 4096, 0],
                [-4096, 5, 0, 5],
            ] {
                let err = refused(&exr(flags, window, compression, 1, &y));
                assert!(matches!(err, Error::Size { limit: MAX_BITMAP_SIDE, .. }), "{window:?}: {err:?}");
            }
            // The greatest picture, in a file that is too short for it.
            let err = refused(&exr(flags, [0, 0, 4095, 4095], compression, u32::MAX, &y));
            assert!(matches!(err, Error::Truncated { .. }), "{err:?}");
        }
    }
    // A file that is long enough, but whose blocks lie beyond it.
    let mut long = exr(0, [0, 0, 99, 99], 3, 1, &y);
    long.extend([0xff; 1000]);
    assert!(matches!(refused(&long), Error::Truncated { .. }));
    // One tile of more channels than are held at once.
    let many = [("R", 1), ("G", 1), ("B", 1), ("A", 1), ("Z", 1)];
    let mut large = exr(TILED, [0, 0, 4095, 4095], 3, 4096, &many);
    large.extend(vec![0; 300_000]);
    assert!(matches!(refused(&large), Error::Memory { limit: 268_435_456, .. }));

    // PNGs with sides above the limit, and with the greatest ones in a file that is too short for them.
    for (side, is_size_error) in [(4097_u32, true), ((1 << 31) - 1, true), (4096, false)] {
        let mut png = input("png-grey-u16.png");
        png[16..20].copy_from_slice(&side.to_be_bytes());
        png[20..24].copy_from_slice(&side.to_be_bytes());
        let crc = crc32(&png[12..29]);
        png[29..33].copy_from_slice(&crc.to_be_bytes());
        let err = refused(&png);
        assert_eq!(matches!(err, Error::Size { .. }), is_size_error, "{err:?}");
        assert!(is_size_error || matches!(err, Error::Truncated { .. }), "{err:?}");
    }
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn exr_headers_that_cannot_be_followed_are_refused() {
    let (window, y) = ([0, 0, 1, 1], [("Y", 1)]);
    let refused = |bytes: &[u8]| read_bitmap(bytes, "a").unwrap_err();
    // Deep pixels, several parts, a flag and a version that are not known, a compression that is not, subsampling.
    for bytes in [
        exr(1 << 11, window, 0, 1, &y),
        exr(1 << 12, window, 0, 1, &y),
        exr(1 << 13, window, 0, 1, &y),
        exr(1, window, 0, 1, &y),
        exr(0, window, 200, 1, &y),
        exr(0, window, 0, 1, &[("Y", 1), ("BY", 2)]),
    ] {
        assert!(matches!(refused(&bytes), Error::Unsupported { .. }), "{:?}", refused(&bytes));
    }
    // Tiles of no size, no channel, and headers without what is needed or with an attribute of less than no bytes.
    for bytes in [exr(TILED, window, 0, 0, &y), exr(0, window, 0, 1, &[])] {
        assert!(matches!(refused(&bytes), Error::Malformed { .. }), "{:?}", refused(&bytes));
    }
    let sound = exr(0, window, 0, 1, &y);
    for name in [&b"channels"[..], b"compression", b"dataWindow"] {
        let mut bytes = sound.clone();
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap();
        bytes[at] = b'X';
        assert!(matches!(refused(&bytes), Error::Malformed { .. }), "{:?}", refused(&bytes));
    }
    let mut bytes = sound.clone();
    let at = bytes.windows(7).position(|window| window == b"chlist\0").unwrap() + 7;
    bytes[at..at + 4].copy_from_slice(&(-1_i32).to_le_bytes());
    assert!(matches!(refused(&bytes), Error::Malformed { .. }), "{:?}", refused(&bytes));
}

#[test]
fn exr_blocks_must_be_where_the_list_says() {
    // The list of places ends where the first block begins.
    for (name, num_blocks) in [("exr-Y-f16-none.exr", 13), ("exr-Y-f32-zip-tile.exr", 12)] {
        let bytes = input(name);
        let start = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        let list = (0..bytes.len()).find(|&at| start(&bytes, at) == (at + 8 * num_blocks) as u64).unwrap();
        let mut swapped = bytes.clone();
        swapped.copy_within(list..list + 8, list + 8);
        match read_bitmap(&swapped, name) {
            Err(Error::Malformed { reason, .. }) => assert!(reason.contains("block 1"), "{reason}"),
            other => panic!("{name}: {other:?}"),
        }
        for offset in [bytes.len() as u64, u64::MAX] {
            let mut beyond = bytes.clone();
            beyond[list..list + 8].copy_from_slice(&offset.to_le_bytes());
            assert!(matches!(read_bitmap(&beyond, name), Err(Error::Truncated { .. })));
        }
    }
}
