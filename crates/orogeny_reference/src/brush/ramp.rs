//! `lerp(H, T, A)` towards a slope between two places: `T` goes from one height to the other along the way between them, evenly
//! or with a level beginning and end.

use multiversion::multiversion;
use orogeny_field::{Instance, LevelOnly, RampAlong};

use crate::amounts::{along_segment, offset};
use crate::store::{goal_of, lerp, update_row};

/// Pulls the samples `first_x ..` of row `z` towards the slope of the instance's segment by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(
    heights: &mut [f32],
    amounts: &[f32],
    [first_x, z]: [i32; 2],
    instance: &Instance,
    along: RampAlong,
    only: LevelOnly,
) -> u32 {
    let is_smooth = along == RampAlong::Smooth;
    update_row(heights, amounts, |place, height, amount| {
        let way = along_segment(offset(first_x.wrapping_add(place as i32), z, instance), instance);
        let share = if is_smooth { way * way * (3.0 - 2.0 * way) } else { way };
        let slope = lerp(instance.reference_height_m, instance.end_height_m, share);
        lerp(height, goal_of(slope, height, only), amount)
    })
}
