//! How a shape joins what was selected before, row by row.

use orogeny_field::SelectCombine;

/// Joins a row of what was selected with one of a shape. Values beyond 0..1, which damage or a resampled mask may have, count as the
/// nearest within; NaN counts as nothing.
pub fn row(selected: &mut [f32], shape: &[f32], combine: SelectCombine) {
    let each = |of: fn(f32, f32) -> f32, selected: &mut [f32]| {
        for (selected, shape) in selected.iter_mut().zip(shape) {
            *selected = of(within(*selected), within(*shape));
        }
    };
    match combine {
        SelectCombine::Replace => each(|_, shape| shape, selected),
        SelectCombine::Add => {
            each(|selected, shape| if shape > selected { shape } else { selected }, selected)
        }
        SelectCombine::Subtract => each(|selected, shape| selected * (1.0 - shape), selected),
        SelectCombine::Intersect => each(|selected, shape| selected * shape, selected),
    }
}

fn within(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_joins_what_was_selected() {
        let joined = |combine| {
            let mut selected = [0.0, 0.25, 0.5, 1.0, f32::NAN, -3.0];
            row(&mut selected, &[1.0, 0.5, 0.25, 1.5, 0.5, -0.0], combine);
            selected.map(f32::to_bits)
        };
        let expected = |values: [f32; 6]| values.map(f32::to_bits);
        assert_eq!(joined(SelectCombine::Replace), expected([1.0, 0.5, 0.25, 1.0, 0.5, 0.0]));
        assert_eq!(joined(SelectCombine::Add), expected([1.0, 0.5, 0.5, 1.0, 0.5, 0.0]));
        assert_eq!(joined(SelectCombine::Subtract), expected([0.0, 0.125, 0.375, 0.0, 0.0, 0.0]));
        assert_eq!(joined(SelectCombine::Intersect), expected([0.0, 0.125, 0.125, 1.0, 0.0, 0.0]));
    }
}
