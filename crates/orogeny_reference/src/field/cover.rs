//! Where there is anything to be copied: within the source, and within what is selected of it.

use multiversion::multiversion;
use orogeny_field::{Part, Place};

use super::between::Ground;
use super::padded::smaller;

/// One row: 1 at places within the source's part, else 0; near its edges, by its feather, what lies between. Times the
/// selection there, 0..1.
pub fn row(target: &mut [f32], selection: Option<&Ground<'_>>, columns: &[Place], row: Place, part: &Part) {
    part_row(target, columns, row, part);
    let Some(selection) = selection else { return };
    for (target, column) in target.iter_mut().zip(columns).filter(|(target, _)| **target > 0.0) {
        let (cell, fraction) = Place::sum(*column, row);
        *target *= selection.between(cell, fraction);
    }
}

/// What the part and its edges leave, with no regard to what is selected.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn part_row(target: &mut [f32], columns: &[Place], row: Place, part: &Part) {
    let ([first_x, first_z], [last_x, last_z]) = (part.first, part.last);
    let is_hard = part.inverse_feather == 0.0;
    for (target, column) in target.iter_mut().zip(columns) {
        let ([x, z], [share_x, share_z]) = Place::sum(*column, row);
        let from_west = x.wrapping_sub(first_x) as f32 + share_x;
        let from_north = z.wrapping_sub(first_z) as f32 + share_z;
        let from_east = last_x.wrapping_sub(x) as f32 - share_x;
        let from_south = last_z.wrapping_sub(z) as f32 - share_z;
        let inside = smaller(smaller(from_west, from_east), smaller(from_north, from_south));
        let t = (inside * part.inverse_feather).clamp(0.0, 1.0);
        let edge = if is_hard { 1.0 } else { t * t * (3.0 - 2.0 * t) };
        *target = if inside < 0.0 { 0.0 } else { edge };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::{Placement, Placing};

    #[test]
    fn a_source_covers_its_samples_and_nothing_else() {
        let placing = Placing {
            at_m: [0.0, 0.0],
            to_m: [2.0, 0.0],
            rotation_deg: 0.0,
            scale: 1.0,
            is_mirrored: false,
            source_spacing_m: 1.0,
            spacing_m: 0.75,
        };
        let placement = Placement::new(&placing);
        let columns: Vec<_> = (0..12).map(|x| placement.column(x)).collect();
        let mut found = [f32::NAN; 12];
        let part = Part { first: [0, 0], last: [4, 1], inverse_feather: 0.0, padding: 0 };
        row(&mut found, None, &columns, placement.row(1), &part);
        // At 2 m and on, in steps of 0.75 m, up to 4 m beyond.
        let expected = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(found, expected.map(|covered: f32| covered));
        row(&mut found, None, &columns, placement.row(2), &part);
        assert_eq!(found, [0.0; 12], "beyond the last row");
        // A feather of two samples: half of it after one.
        let feathered = Part { last: [4, 9], inverse_feather: 0.5, ..part };
        let columns: Vec<_> = (0..5).map(|x| Place { cell: [x, 4], fraction: [0.0, 0.0] }).collect();
        let nothing = Place { cell: [0, 0], fraction: [0.0, 0.0] };
        let mut found = [f32::NAN; 5];
        row(&mut found, None, &columns, nothing, &feathered);
        assert_eq!(found, [0.0, 0.5, 1.0, 0.5, 0.0]);
    }
}
