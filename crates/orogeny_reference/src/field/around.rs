//! The eight neighbours of a sample, in the order in which they are asked everywhere: north, east, south, west, then
//! north-east, south-east, south-west, north-west. The first of equals wins.

/// Steps along a row and from row to row, in order.
const STEPS: [[isize; 2]; 8] = [[0, -1], [1, 0], [0, 1], [-1, 0], [1, -1], [1, 1], [-1, 1], [-1, -1]];

/// One over the distance to each neighbour, in samples.
pub(super) const INVERSE_DISTANCES: [f32; 8] = {
    const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;
    [1.0, 1.0, 1.0, 1.0, DIAGONAL, DIAGONAL, DIAGONAL, DIAGONAL]
};

/// From a sample's place to those of its neighbours, in rows of `width` samples.
pub(super) fn offsets(width: usize) -> [isize; 8] {
    STEPS.map(|[x, z]| z * width.cast_signed() + x)
}

/// The direction back.
pub(super) const fn opposite(direction: u8) -> u8 {
    direction ^ 2
}

/// A value, or `otherwise` where there is none.
#[inline(always)]
pub(super) fn at<T: Copy>(values: &[T], place: usize, otherwise: T) -> T {
    values.get(place).copied().unwrap_or(otherwise)
}

/// Changes a value where there is one.
#[inline(always)]
pub(super) fn put<T>(values: &mut [T], place: usize, value: T) {
    if let Some(there) = values.get_mut(place) {
        *there = value;
    }
}

/// Writes for each sample that is not on the border what `value_of` makes of its height and those of its neighbours.
#[inline(always)]
pub(super) fn map_inside<T>(
    heights: &[f32],
    width: usize,
    values: &mut [T],
    value_of: impl Fn(f32, [f32; 8]) -> T,
) {
    let inner = width.saturating_sub(2);
    let three_rows = heights.windows(3 * width.max(1)).step_by(width.max(1));
    let rows = values.chunks_exact_mut(width.max(1)).skip(1);
    for (three, values) in three_rows.zip(rows) {
        let part = |row: usize, first: usize| {
            let first = row * width + first;
            three.get(first..first + inner).unwrap_or(&[])
        };
        let (north_west, north, north_east) = (part(0, 0), part(0, 1), part(0, 2));
        let (west, centre, east) = (part(1, 0), part(1, 1), part(1, 2));
        let (south_west, south, south_east) = (part(2, 0), part(2, 1), part(2, 2));
        let straight = north.iter().zip(east).zip(south.iter().zip(west));
        let diagonal = north_east.iter().zip(south_east).zip(south_west.iter().zip(north_west));
        let samples = centre.iter().zip(straight.zip(diagonal));
        for (value, (centre, (((n, e), (s, w)), ((ne, se), (sw, nw))))) in
            values.iter_mut().skip(1).zip(samples)
        {
            *value = value_of(*centre, [*n, *e, *s, *w, *ne, *se, *sw, *nw]);
        }
    }
}
