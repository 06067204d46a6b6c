//! Another ground, laid on the terrain: moved, turned, enlarged, mirrored.

use orogeny_field::Place;

use super::between::Ground;

/// One row: at each column's place the source's height, times a scale, plus an offset in metres.
pub fn row(
    target: &mut [f32],
    source: &Ground<'_>,
    columns: &[Place],
    row: Place,
    [scale, offset_m]: [f32; 2],
) {
    for (target, column) in target.iter_mut().zip(columns) {
        let (cell, fraction) = Place::sum(*column, row);
        *target = source.between(cell, fraction) * scale + offset_m;
    }
}
