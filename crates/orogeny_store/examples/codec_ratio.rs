//! How small and how fast pages and history deltas become on a real terrain, on one core.
//!
//! `cargo run --release -p orogeny_store --example codec_ratio -- FILE.r16 WIDTH METRES_PER_UNIT`
//!
//! The file holds little-endian 16-bit heights, WIDTH to a row. Measured are its pages as an import stores them, and the
//! deltas of a smooth and of a noisy brush over all of it.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use orogeny_store::codec;

const SIDE: usize = 256;
const REPETITIONS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, width, metres_per_unit] = arguments.as_slice() else {
        return Err("give FILE.r16 WIDTH METRES_PER_UNIT".into());
    };
    let (width, metres_per_unit): (usize, f32) = (width.parse()?, metres_per_unit.parse()?);
    let bytes = std::fs::read(path)?;
    let heights: Vec<f32> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|unit| f32::from(u16::from_le_bytes(*unit)) * metres_per_unit)
        .collect();
    let terrain = pages(&heights, width);
    if terrain.is_empty() {
        return Err(format!("{path} holds no page of {SIDE} x {SIDE} samples at {width} to a row").into());
    }
    measure("terrain", &terrain);
    for (name, roughness_m) in [("smooth stroke", 0.0), ("noisy stroke", 2.0)] {
        let painted: Vec<f32> = heights
            .iter()
            .zip(0_u32..)
            .map(|(height, i)| height + stroke(i as usize % width, i as usize / width, roughness_m, i))
            .collect();
        let after = pages(&painted, width);
        let deltas: Vec<_> = after
            .iter()
            .zip(&terrain)
            .map(|(after, before)| codec::difference(after, Some(before)))
            .collect();
        measure(name, &deltas);
    }
    Ok(())
}

/// A raised band, 200 samples wide, along the diagonal of every 512 samples: more than half of the samples change.
fn stroke(x: usize, z: usize, roughness_m: f32, index: u32) -> f32 {
    let across = ((x + z) % 512) as f32 - 256.0;
    let t = (1.0 - (across / 150.0).abs()).max(0.0);
    let noise = (index.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32 - 0.5;
    t * t * (3.0 - 2.0 * t) * (20.0 + roughness_m * noise)
}

/// The whole pages of a raster, as ordered values.
fn pages(heights: &[f32], width: usize) -> Vec<Vec<u32>> {
    let ordered: Vec<u32> = heights.iter().map(|height| codec::ordered_from_bits(height.to_bits())).collect();
    let rows: Vec<&[u32]> = ordered.chunks_exact(width).collect();
    let mut pages = Vec::new();
    for band in rows.chunks_exact(SIDE) {
        for x in 0..width / SIDE {
            let columns = x * SIDE..(x + 1) * SIDE;
            pages.push(band.iter().filter_map(|row| row.get(columns.clone())).flatten().copied().collect());
        }
    }
    pages
}

#[expect(clippy::print_stdout, reason = "the figures are what this program is for")]
fn measure(name: &str, pages: &[Vec<u32>]) {
    let raw_bytes = pages.len() * SIDE * SIDE * 4;
    let coded: Vec<Vec<u8>> = pages.iter().filter_map(|page| codec::encode(page, SIDE).ok()).collect();
    let coded_bytes: usize = coded.iter().map(Vec::len).sum();
    let decoded =
        coded.iter().filter_map(|bytes| codec::decode(codec::LORENZO_SHUFFLE_ZSTD, bytes, SIDE).ok());
    let is_lossless = decoded.eq(pages.iter().cloned());
    let encode_s = median_seconds(|| {
        for page in pages {
            black_box(codec::encode(black_box(page), SIDE).ok());
        }
    });
    let decode_s = median_seconds(|| {
        for bytes in &coded {
            black_box(codec::decode(codec::LORENZO_SHUFFLE_ZSTD, black_box(bytes), SIDE).ok());
        }
    });
    let megabytes = raw_bytes as f64 / 1e6;
    println!(
        "{name}: {} pages, ratio {:.2}, encode {:.0} MB/s, decode {:.0} MB/s, {}",
        pages.len(),
        raw_bytes as f64 / coded_bytes as f64,
        megabytes / encode_s,
        megabytes / decode_s,
        if is_lossless { "lossless" } else { "NOT LOSSLESS" },
    );
}

fn median_seconds(mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..REPETITIONS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds.get(REPETITIONS / 2).copied().unwrap_or(f64::NAN)
}
