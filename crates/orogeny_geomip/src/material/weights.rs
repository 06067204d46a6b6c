//! How much each layer shows at a place. A shader must agree with this.
//!
//! All of it is `f32` arithmetic with neither transcendental functions nor branches.
//!
//! 1. A layer's *rule* is the product of its ramps of height, slope and curvature, and its mask: `r`. A layer whose rule is 0 has no weight.
//! 2. Noise `n` of -1..1 moves its borders where it fades: `r' = clamp(r + amount n 4 r (1 - r), 0, 1)`.
//! 3. Its *cover* is `w = strength · patch(n) · r'`. That of the base is 1.
//! 4. Each layer covers those before it by `w`: `c_i = w_i Π_{j>i} (1 - w_j)`. These sum to 1, and the last has priority.
//! 5. Reliefs of heights `h` reach through each other. `H = Σ c_j h_j` is the height of the whole;
//!    `b_i = c_i max(0, 1 + (h_i - H) / blend_depth)`, divided by their sum, which is 1 or more. What is higher than the whole gains. Where
//!    reliefs are alike, as far away, `b_i` is `c_i`, so that borders there are as soft as rules make them. Unlike a blend that looks for the
//!    highest layer, it does not jump where a layer begins.
//! 6. Weights are `c_i + blend_contrast (b_i - c_i)`.

use super::{LayerRule, MAX_LAYERS, SetRule};

/// The ground at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Its height, metres.
    pub height_m: f32,
    /// Its slope as rise over run, 0 or more.
    pub slope_tangent: f32,
    /// Its curvature, 1/m: above 0 on ridges, below 0 in hollows.
    pub curvature: f32,
}

/// What a layer has of its own at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerInput {
    /// Its noise, -1..1: [`layer_noise`](super::layer_noise).
    pub noise: f32,
    /// Its mask, 0..1; 1 where it has none.
    pub mask: f32,
    /// The height of its texture's relief, 0..1.
    pub texture_height: f32,
}

impl Default for LayerInput {
    fn default() -> Self {
        Self { noise: 0.0, mask: 1.0, texture_height: 0.5 }
    }
}

/// 0 up to 0, 1 from 1 on, smooth between.
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn ramp([rise, per_rise, fall, per_fall]: [f32; 4], x: f32) -> f32 {
    smooth((x - rise) * per_rise) * (1.0 - smooth((x - fall) * per_fall))
}

impl LayerRule {
    /// How much the layer covers what is below it, 0..1: steps 1 to 3 of [`weights`].
    #[must_use]
    pub fn cover(&self, ground: Ground, input: LayerInput) -> f32 {
        let rule = ramp(self.height_m, ground.height_m)
            * ramp(self.slope_tangent, ground.slope_tangent)
            * ramp(self.curvature, ground.curvature)
            * input.mask.clamp(0.0, 1.0);
        let [_, amount, patch_from, patch_per] = self.noise;
        let [strength, ..] = self.look;
        let moved = (rule + amount * input.noise * 4.0 * rule * (1.0 - rule)).clamp(0.0, 1.0);
        strength * smooth((input.noise - patch_from) * patch_per) * moved
    }
}

/// How much of each layer shows at a place: 0 or more each, 1 in sum; 0 for those that there are not.
///
/// # The formula
///
/// 1. `r_i`: the product of the layer's ramps ([`LayerRule`]) and its mask.
/// 2. `r'_i = clamp(r_i + amount_i n_i 4 r_i (1 - r_i), 0, 1)`, with its noise `n_i`.
/// 3. `w_i = strength_i · smooth((n_i - patch_i) · per_patch_i) · r'_i`; `w_0 = 1` for the base.
/// 4. `c_i = w_i Π_{j>i} (1 - w_j)`.
/// 5. `b_i = c_i max(0, 1 + (h_i - H) / blend_depth)` with `H = Σ c_j h_j`, divided by their sum.
/// 6. `c_i + blend_contrast (b_i - c_i)`.
///
/// A layer without an input has the default one; those beyond [`MAX_LAYERS`] are left out.
#[must_use]
pub fn weights(
    layers: &[LayerRule],
    set: &SetRule,
    ground: Ground,
    inputs: &[LayerInput],
) -> [f32; MAX_LAYERS] {
    let count = layers.len().min(MAX_LAYERS);
    let mut weights = [0.0; MAX_LAYERS];
    // From the top down: what the layers above leave.
    let mut left = 1.0;
    for (index, (weight, rule)) in weights.iter_mut().zip(layers).enumerate().take(count).rev() {
        let cover = match index {
            0 => 1.0,
            _ => rule.cover(ground, inputs.get(index).copied().unwrap_or_default()),
        };
        *weight = cover * left;
        left *= 1.0 - cover;
    }

    let heights: [f32; MAX_LAYERS] = std::array::from_fn(|index| {
        inputs.get(index).copied().unwrap_or_default().texture_height.clamp(0.0, 1.0)
    });
    let whole: f32 = weights.iter().zip(heights).map(|(weight, height)| weight * height).sum();
    let mut blended = [0.0_f32; MAX_LAYERS];
    let mut sum = 0.0;
    for (blended, (weight, height)) in blended.iter_mut().zip(weights.iter().zip(heights)) {
        *blended = weight * (1.0 + (height - whole) / set.blend_depth).max(0.0);
        sum += *blended;
    }
    // Without the `max` the sum would be 1: there is something to divide by wherever there is a layer.
    let share = if sum > 0.0 { 1.0 / sum } else { 0.0 };
    for (weight, blended) in weights.iter_mut().zip(blended) {
        *weight += set.blend_contrast * (blended * share - *weight);
    }
    weights
}

#[cfg(test)]
mod tests;
