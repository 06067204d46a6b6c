//! The next level of a field: the `[1 2 1]² / 16` mean centred on every second sample.

use multiversion::multiversion;
use orogeny_field::sanitized_height;

/// Samples that are made at once, from columns that are summed before.
const LANES: usize = 64;

/// One row of the next level from the three rows around its own. Sample `i` of `above` is centred on sample `2 i + 1` of
/// the rows, so they are one longer than twice as long; what lies beyond the terrain is the caller's to fill with the
/// sample on the edge.
///
/// Opposite neighbours are added first: so a constant comes back exactly, whatever its bits, and mirroring the rows mirrors
/// the result.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(above: &mut [f32], north: &[f32], centre: &[f32], south: &[f32]) {
    let mut columns = [0.0; 2 * LANES + 1];
    for (part, above) in above.chunks_mut(LANES).enumerate() {
        let rows = [north, centre, south].map(|row| row.get(2 * LANES * part..).unwrap_or_default());
        let [north, centre, south] = rows;
        for (column, ((north, centre), south)) in columns.iter_mut().zip(north.iter().zip(centre).zip(south))
        {
            *column = (north + south) + (centre + centre);
        }
        // Even and odd ones apart, so that the sums are of values side by side.
        let (mut even, mut odd) = ([0.0; LANES + 1], [0.0; LANES]);
        for ((even, odd), [west, middle]) in even.iter_mut().zip(&mut odd).zip(columns.as_chunks::<2>().0) {
            (*even, *odd) = (*west, *middle);
        }
        if let (Some(even), Some(column)) = (even.last_mut(), columns.last()) {
            *even = *column;
        }
        let mut means = [0.0; LANES];
        if let (Some(west), Some(east)) = (even.first_chunk::<LANES>(), even.last_chunk::<LANES>()) {
            for (((mean, west), middle), east) in means.iter_mut().zip(west).zip(&odd).zip(east) {
                *mean = sanitized_height(((west + east) + (middle + middle)) * 0.0625);
            }
        }
        for (above, mean) in above.iter_mut().zip(means) {
            *above = mean;
        }
    }
}

/// How far the surface between two rows of the next level is, at most, from a row of samples midway between them: of the two triangles of each
/// cell, from its first sample to its last. With one row twice, from the row of samples that it lies on. Sample `i` of the rows lies on sample `2 i` of
/// `below`, which is at most twice as long; beyond the last one the surface goes on as it is there.
#[must_use]
pub fn row_error(north: &[f32], south: &[f32], below: &[f32]) -> f32 {
    let next = south.iter().skip(1).chain(south.last());
    let cells = north.iter().zip(south).zip(next).zip(below.chunks(2));
    cells.fold(0.0, |error: f32, (((north, south), next), below)| {
        let off = |surface: f32, height: Option<&f32>| height.map_or(0.0, |height| (surface - height).abs());
        let on_column = off(0.5 * (north + south), below.first());
        error.max(on_column).max(off(0.5 * (north + next), below.get(1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_sample_is_the_mean_around_its_own() {
        let (north, centre, south) = ([1.0, 2.0, 3.0, 4.0, 5.0], [10.0; 5], [-1.0, 0.0, 1.0, 0.0, -1.0]);
        let mut above = [f32::NAN; 2];
        row(&mut above, &north, &centre, &south);
        // (1 + 2*2 + 3 + 2*(10 + 2*10 + 10) - 1 + 0 + 1) / 16, and the same two samples on.
        assert_eq!(above, [(8.0 + 80.0 + 0.0) / 16.0, (16.0 + 80.0 + 0.0) / 16.0]);
    }

    #[test]
    fn a_constant_comes_back_bit_for_bit() {
        for bits in [0x3f80_0001_u32, 0x4b18_967f, 0xcb18_9680, 0x0080_0000, 0x4248_f5c3] {
            let constant = [f32::from_bits(bits); 7];
            let mut above = [f32::NAN; 3];
            row(&mut above, &constant, &constant, &constant);
            assert_eq!(above.map(f32::to_bits), [bits; 3]);
        }
    }

    #[test]
    fn a_row_s_error_is_that_of_the_triangles_above_it() {
        let (north, south) = ([0.0, 4.0, 8.0], [2.0, 6.0, 10.0]);
        // Midway between: on the columns 1, 5, 9; on the diagonals 3, 7; beyond the last one as there.
        assert_eq!(row_error(&north, &south, &[1.0, 3.0, 5.0, 7.0, 9.0, 9.0]), 0.0);
        for (place, off) in [(0, 0.5), (1, -0.75), (4, 2.0), (5, 1.0)] {
            let mut below = [1.0, 3.0, 5.0, 7.0, 9.0, 9.0];
            below[place] += off;
            assert_eq!(row_error(&north, &south, &below), off.abs(), "{place}");
        }
        assert_eq!(row_error(&north, &north, &[0.0, 2.0, 4.0, 6.0, 8.0]), 0.0);
        assert_eq!(row_error(&north, &north, &[0.0, 2.0, 4.0, 6.5, 8.0]), 0.5);
    }

    #[test]
    fn what_is_no_height_does_not_come_out() {
        let mut above = [f32::NAN; 1];
        row(&mut above, &[1.0e-45; 3], &[1.0e-45; 3], &[1.0e-45; 3]);
        assert_eq!(above[0].to_bits(), 0);
    }
}
