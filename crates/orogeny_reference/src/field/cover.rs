//! Where there is anything to be copied: within the source, and within what is selected of it.

use orogeny_field::Place;

use super::between::Ground;

/// One row: 1 at places from the source's first sample to its last, else 0. Times the selection there, 0..1.
pub fn row(
    target: &mut [f32],
    selection: Option<&Ground<'_>>,
    columns: &[Place],
    row: Place,
    [width, depth]: [u32; 2],
) {
    let is_within = |cell: i32, fraction: f32, num_samples: u32| {
        let last = num_samples.saturating_sub(1).cast_signed();
        cell >= 0 && (cell < last || (cell == last && fraction == 0.0))
    };
    for (target, column) in target.iter_mut().zip(columns) {
        let ([x, z], [share_x, share_z]) = Place::sum(*column, row);
        let is_covered = is_within(x, share_x, width) && is_within(z, share_z, depth);
        *target = match selection {
            _ if !is_covered => 0.0,
            None => 1.0,
            Some(selection) => selection.between([x, z], [share_x, share_z]),
        };
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
        row(&mut found, None, &columns, placement.row(1), [5, 2]);
        // At 2 m and on, in steps of 0.75 m, up to 4 m beyond.
        let expected = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(found, expected.map(|covered: f32| covered));
        row(&mut found, None, &columns, placement.row(2), [5, 2]);
        assert_eq!(found, [0.0; 12], "beyond the last row");
    }
}
