//! Heights moved by a distance that is the same everywhere, bilinear between samples.

use multiversion::multiversion;

/// One row from the two around the place that it comes from, each beginning at the sample at or before the first value's
/// place and one longer than the row; `fraction` is how far after those samples the place lies, 0..1 along x and z.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], north: &[f32], south: &[f32], fraction: [f32; 2]) {
    let [x, z] = fraction;
    let west = north.iter().zip(south);
    let east = north.iter().zip(south).skip(1);
    for ((target, (north_west, south_west)), (north_east, south_east)) in
        target.iter_mut().zip(west).zip(east)
    {
        let north = north_west + x * (north_east - north_west);
        let south = south_west + x * (south_east - south_west);
        *target = north + z * (south - north);
    }
}
