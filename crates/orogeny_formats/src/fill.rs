//! Filling holes smoothly from around them.
//!
//! A pyramid of means over the samples that are there, halved until every cell has one, gives each hole a first
//! guess: the next coarser level, interpolated. At every level the guess is then relaxed towards the membrane that
//! hangs in the hole's rim (Laplace's equation, red and black in turn). The order of the work is fixed, so the result
//! is the same bits every time; and as every step is a mean, a filled height lies between the least and the greatest
//! height of the raster.

/// Relaxations per level. Coarser levels have settled the long waves, so few are left to do.
const SWEEPS: usize = 24;

/// Bytes that [`fill`] holds for a raster of `samples`, `holes` of them missing.
pub(crate) fn memory_bytes(samples: u64, holes: u64) -> u64 {
    // Heights, all coarser levels of them, and the places of the holes at every level.
    let pyramid = samples.saturating_mul(4).saturating_mul(4) / 3;
    pyramid.saturating_add(holes.saturating_mul(16).saturating_mul(4) / 3)
}

/// Replaces every NaN of rows of `width` heights. If all are NaN, nothing changes.
pub(crate) fn fill(heights_m: &mut [f32], width: usize) {
    let depth = heights_m.len().checked_div(width).unwrap_or(0);
    let holes = Holes::of(heights_m, width);
    let holes_everywhere = holes.len() == heights_m.len();
    if holes.len() == 0 || (holes_everywhere && heights_m.len() <= 1) {
        return;
    }
    let mut coarse = halved(heights_m, width, depth);
    let coarse_width = width.div_ceil(2);
    fill(&mut coarse, coarse_width);
    interpolate(heights_m, width, &coarse, coarse_width, &holes);
    for _ in 0..SWEEPS {
        relax(heights_m, width, depth, &holes.red);
        relax(heights_m, width, depth, &holes.black);
    }
}

/// Where samples are missing, by the colour of a chessboard: a cell's four neighbours have the other.
struct Holes {
    red: Vec<usize>,
    black: Vec<usize>,
}

impl Holes {
    fn of(heights_m: &[f32], width: usize) -> Self {
        let holes =
            heights_m.iter().enumerate().filter(|(_, height_m)| height_m.is_nan()).map(|(index, _)| index);
        let (red, black) = holes.partition(|index| (index % width + index / width).is_multiple_of(2));
        Self { red, black }
    }

    fn len(&self) -> usize {
        self.red.len() + self.black.len()
    }
}

/// The mean of what is there in each 2 × 2 cells; NaN where nothing is.
#[expect(clippy::indexing_slicing, reason = "rows and columns run within width and depth")]
#[expect(clippy::cast_possible_truncation, reason = "heights are f32")]
fn halved(heights_m: &[f32], width: usize, depth: usize) -> Vec<f32> {
    let mut coarse = Vec::with_capacity(width.div_ceil(2) * depth.div_ceil(2));
    for row in (0..depth).step_by(2) {
        for column in (0..width).step_by(2) {
            let (mut sum, mut count) = (0.0_f64, 0.0_f64);
            for row in row..(row + 2).min(depth) {
                for height_m in &heights_m[row * width + column..row * width + (column + 2).min(width)] {
                    if !height_m.is_nan() {
                        sum += f64::from(*height_m);
                        count += 1.0;
                    }
                }
            }
            coarse.push((sum / count) as f32);
        }
    }
    coarse
}

/// Gives every hole the bilinear height of the coarser level at its place.
#[expect(
    clippy::indexing_slicing,
    reason = "a cell's parent and the clamped neighbours of that are within the level"
)]
fn interpolate(heights_m: &mut [f32], width: usize, coarse: &[f32], coarse_width: usize, holes: &Holes) {
    let coarse_depth = coarse.len() / coarse_width;
    // A cell's centre lies a quarter of a coarse cell from its parent's, towards the neighbour on its own side.
    let neighbour = |index: usize, limit: usize| {
        let parent = index / 2;
        let towards =
            if index.is_multiple_of(2) { parent.saturating_sub(1) } else { (parent + 1).min(limit - 1) };
        (parent, towards)
    };
    for &hole in holes.red.iter().chain(&holes.black) {
        let (x, near_x) = neighbour(hole % width, coarse_width);
        let (z, near_z) = neighbour(hole / width, coarse_depth);
        let along = |z: usize| 0.75 * coarse[z * coarse_width + x] + 0.25 * coarse[z * coarse_width + near_x];
        heights_m[hole] = 0.75 * along(z) + 0.25 * along(near_z);
    }
}

/// Gives every cell named the mean of its neighbours.
#[expect(clippy::indexing_slicing, reason = "neighbours are taken only where they are within the raster")]
fn relax(heights_m: &mut [f32], width: usize, depth: usize, cells: &[usize]) {
    for &cell in cells {
        let (column, row) = (cell % width, cell / width);
        let neighbours = [
            (column > 0).then(|| cell - 1),
            (column + 1 < width).then(|| cell + 1),
            (row > 0).then(|| cell - width),
            (row + 1 < depth).then(|| cell + width),
        ];
        let (mut sum, mut count) = (0.0, 0.0);
        for neighbour in neighbours.into_iter().flatten() {
            sum += heights_m[neighbour];
            count += 1.0;
        }
        if count > 0.0 {
            heights_m[cell] = sum / count;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIDE: usize = 64;

    fn raster(height_m: impl Fn(usize, usize) -> f32, is_hole: impl Fn(usize, usize) -> bool) -> Vec<f32> {
        (0..SIDE * SIDE)
            .map(|index| (index % SIDE, index / SIDE))
            .map(|(x, z)| if is_hole(x, z) { f32::NAN } else { height_m(x, z) })
            .collect()
    }

    #[test]
    fn a_hole_in_a_plane_becomes_the_plane() {
        let plane = |x: usize, z: usize| 10.0 * x as f32 - 4.0 * z as f32;
        let mut heights_m = raster(plane, |x, z| (20..44).contains(&x) && (17..40).contains(&z));
        fill(&mut heights_m, SIDE);
        let worst_m = (0..SIDE * SIDE)
            .map(|index| (heights_m[index] - plane(index % SIDE, index / SIDE)).abs())
            .fold(0.0, f32::max);
        // The plane falls 240 m across the hole.
        assert!(worst_m < 2.0, "{worst_m} m from the plane");
    }

    #[test]
    fn samples_that_are_there_stay_and_the_result_repeats_bit_for_bit() {
        let height_m = |x: usize, z: usize| ((x * 31 + z * 17) % 97) as f32;
        let is_hole = |x: usize, z: usize| (x * z).is_multiple_of(5) && x != z;
        let (mut first, mut second) = (raster(height_m, is_hole), raster(height_m, is_hole));
        fill(&mut first, SIDE);
        fill(&mut second, SIDE);
        assert_eq!(
            first.iter().map(|h| h.to_bits()).collect::<Vec<_>>(),
            second.iter().map(|h| h.to_bits()).collect::<Vec<_>>()
        );
        for (index, &filled) in first.iter().enumerate() {
            let (x, z) = (index % SIDE, index / SIDE);
            assert!(is_hole(x, z) || filled == height_m(x, z));
        }
    }

    #[test]
    fn a_guess_leans_to_the_side_its_cell_is_on() {
        let mut heights_m = [0.0, 0.0, f32::NAN, f32::NAN, 0.0, f32::NAN];
        let holes = Holes::of(&heights_m, 6);
        interpolate(&mut heights_m, 6, &[0.0, 4.0, 8.0], 3, &holes);
        assert_eq!(heights_m, [0.0, 0.0, 3.0, 5.0, 0.0, 8.0]);
    }

    #[test]
    fn one_sample_fills_everything_and_none_fills_nothing() {
        let mut one = raster(|_, _| 7.0, |x, z| (x, z) != (50, 3));
        fill(&mut one, SIDE);
        assert!(one.iter().all(|&height_m| height_m == 7.0));
        let mut none = vec![f32::NAN; 15];
        fill(&mut none, 5);
        assert!(none.iter().all(|height_m| height_m.is_nan()));
    }

    proptest! {
        #[test]
        fn filled_heights_lie_between_those_around(
            width in 1_usize..40,
            cells in prop::collection::vec(prop::option::of(-500.0_f32..9000.0), 1..800),
        ) {
            let whole = cells.len() - cells.len() % width;
            prop_assume!(whole > 0 && cells[..whole].iter().any(Option::is_some));
            let known = cells[..whole].iter().flatten();
            let low = known.clone().fold(f32::INFINITY, |a, &b| a.min(b));
            let high = known.fold(f32::NEG_INFINITY, |a, &b| a.max(b));
            let mut heights_m: Vec<f32> = cells[..whole].iter().map(|cell| cell.unwrap_or(f32::NAN)).collect();
            fill(&mut heights_m, width);
            // Means of f32 may round past the ends by a last place.
            let margin = 1e-3;
            prop_assert!(heights_m.iter().all(|&h| h >= low - margin && h <= high + margin));
        }
    }
}
