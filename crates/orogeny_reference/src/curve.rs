//! A user's curve, read from its table.

use orogeny_field::{CURVE_TABLE_LENGTH, CurveTable};

use crate::noise::Real;

/// The value of a table at `x`, linear between entries, and its slope there.
#[inline(always)]
pub fn look_up<T: Real>(table: &CurveTable, x: T) -> (T, T) {
    let last = T::of((CURVE_TABLE_LENGTH - 1) as f64);
    let per_unit = T::of(f64::from(table.entries_per_unit));
    let raw = (x - T::of(f64::from(table.low))) * per_unit;
    let place = raw.most(T::of(0.0)).least(last);
    let entry = place.floor().least(last - T::of(1.0));
    let index = entry.wrapped() as usize;
    let at = |index: usize| T::of(f64::from(table.values.get(index).copied().unwrap_or_default()));
    let (low, high) = (at(index), at(index + 1));
    let is_inside = raw >= T::of(0.0) && raw <= last;
    let slope = if is_inside { (high - low) * per_unit } else { T::of(0.0) };
    (low + (place - entry) * (high - low), slope)
}
