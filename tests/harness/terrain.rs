//! Terrains to paint on.

use orogeny_field::MAX_HEIGHT_M;
use tiff::decoder::{Decoder, DecodingResult};

use crate::{Plane, Random, repository};

/// Where the bundled real terrain lies.
const REAL: &str = "assets/terrain/frazier_1024_int16.tif";

/// Hills of some hundred metres with noise on them, different for each seed.
#[must_use]
pub fn random(width: u32, depth: u32, seed: u64) -> Plane {
    let mut random = Random::new(seed);
    let [base, amplitude] = [random.within(-300.0, 900.0), random.within(20.0, 400.0)];
    let [along_x, along_z] = [random.within(0.01, 0.2), random.within(0.01, 0.2)];
    Plane::from_fn(width, depth, |x, z| {
        let hills = (f64::from(x) * along_x).sin() * (f64::from(z) * along_z).cos();
        (base + amplitude * hills + random.within(-3.0, 3.0)) as f32
    })
}

/// All that a height may be, side by side: the largest either way, the smallest, denormals, zeros, steps between them.
#[must_use]
pub fn extreme(width: u32, depth: u32, seed: u64) -> Plane {
    const HEIGHTS_M: [f32; 14] = [
        MAX_HEIGHT_M,
        -MAX_HEIGHT_M,
        9_999_999.0,
        -9_999_999.0,
        1.0e-30,
        -1.0e-30,
        f32::MIN_POSITIVE,
        -f32::MIN_POSITIVE,
        1.0e-42,
        0.0,
        16_777.217,
        -0.1,
        1.0,
        8_848.86,
    ];
    let mut random = Random::new(seed);
    // Blocks, so that a step is met as well as a plain.
    let blocks: Vec<_> = (0..64).map(|_| random.one_of(&HEIGHTS_M)).collect();
    Plane::from_fn(width, depth, |x, z| {
        if x % 7 == 3 { random.one_of(&HEIGHTS_M) } else { blocks[((x / 9 + z / 5 * 13) % 64) as usize] }
    })
}

/// A part of the bundled real terrain: 16-bit heights of Frazier Mountain, California.
///
/// # Panics
/// Where the file cannot be read: it belongs to the repository.
#[must_use]
pub fn real(width: u32, depth: u32, first_x: u32, first_z: u32) -> Plane {
    let path = repository().join(REAL);
    let file = std::fs::File::open(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let mut decoder = Decoder::new(std::io::BufReader::new(file)).expect("a TIFF");
    let (file_width, file_depth) = decoder.dimensions().expect("a size");
    let DecodingResult::I16(heights) = decoder.read_image().expect("whole") else {
        panic!("{} does not hold 16-bit heights", path.display());
    };
    assert!(first_x + width <= file_width && first_z + depth <= file_depth, "beyond the real terrain");
    Plane::from_fn(width, depth, |x, z| {
        f32::from(heights[((first_z + z) * file_width + first_x + x) as usize])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::is_storable_height;

    #[test]
    fn all_heights_are_storable_and_differ_by_seed() {
        for terrain in [random, extreme] {
            let [first, again, other] = [1, 1, 2].map(|seed| terrain(50, 40, seed));
            assert!(first.samples().iter().all(|height| is_storable_height(*height)));
            assert_eq!(first, again);
            assert_ne!(first, other);
        }
    }

    #[test]
    fn the_extreme_terrain_has_both_limits_and_denormals() {
        let plane = extreme(100, 100, 1);
        for wanted in [MAX_HEIGHT_M, -MAX_HEIGHT_M, 1.0e-30, 1.0e-42] {
            assert!(plane.samples().contains(&wanted), "{wanted}");
        }
    }

    #[test]
    fn the_real_terrain_is_a_mountain() {
        let plane = real(1024, 1024, 0, 0);
        let lowest = plane.samples().iter().copied().fold(f32::INFINITY, f32::min);
        let highest = plane.samples().iter().copied().fold(f32::NEG_INFINITY, f32::max);
        assert!(lowest > 0.0 && highest > lowest + 500.0, "{lowest} to {highest}");
        assert_eq!(real(10, 5, 300, 400).at(9, 4), plane.at(309, 404));
    }
}
