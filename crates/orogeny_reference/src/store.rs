//! What happens to a height on its way back: clamped to what a terrain holds, denormals and NaN to +0, clampings counted.

use orogeny_field::{LevelOnly, is_storable_height, sanitized_height};

/// Replaces each height of a row by what `new_height` makes of it and the amount at its sample, and gives the number of
/// heights that could not be stored as they were. `new_height` gets the sample's place in the row too.
#[inline(always)]
pub fn update_row(
    heights: &mut [f32],
    amounts: &[f32],
    mut new_height: impl FnMut(usize, f32, f32) -> f32,
) -> u32 {
    let mut num_clamped = 0;
    for (place, (height, amount)) in heights.iter_mut().zip(amounts).enumerate() {
        let new = new_height(place, *height, *amount);
        num_clamped += u32::from(!is_storable_height(new));
        *height = sanitized_height(new);
    }
    num_clamped
}

/// `a + w (b - a)`, in this order everywhere: `mix` differs by driver.
#[inline(always)]
#[must_use]
pub fn lerp(a: f32, b: f32, w: f32) -> f32 {
    a + w * (b - a)
}

/// A height pulled to a goal by an amount, 0..1: by 1 to the goal itself. What is between two heights never leaves them,
/// however it is rounded.
#[inline(always)]
#[must_use]
pub fn pulled(height: f32, goal: f32, amount: f32) -> f32 {
    let between = lerp(height, goal, amount).max(height.min(goal)).min(height.max(goal));
    if amount == 1.0 { goal } else { between }
}

/// What a height may be pulled to where it may only go one way.
#[inline(always)]
#[must_use]
pub fn goal_of(goal: f32, height: f32, only: LevelOnly) -> f32 {
    match only {
        LevelOnly::Both => goal,
        LevelOnly::Cut => goal.min(height),
        LevelOnly::Fill => goal.max(height),
    }
}

/// Keeps a row of a mask within 0..1, whatever a brush for heights made of it.
pub fn clamp_mask(mask: &mut [f32]) {
    for value in mask {
        *value = value.clamp(0.0, 1.0);
    }
}
