//! A set for one terrain.

use super::layer::Range;
use super::{LayerNoise, LayerRule, MaterialLayer, MaterialSet, NO_MASK, SetRule};
use crate::{Error, Result};

/// How far away an open side of a ramp is.
const FAR: f32 = 1.0e30;
/// The narrowest fade, in the unit of what fades: narrower ones are this wide.
const MIN_FADE: f64 = 1.0e-4;
/// The steepest slope that has a tangent of use, degrees.
const STEEPEST_DEGREES: f64 = 89.9;
/// How wide the edge of a patch is, in the noise's -1..1.
const PATCH_EDGE: f64 = 0.9;
/// The least height that a terrain counts as having, metres: on level ground shares would mean nothing.
const MIN_RANGE_M: f64 = 1.0;

/// What a set comes to for one terrain.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedSet {
    /// A rule for each layer, the lowest first.
    pub layers: Vec<LayerRule>,
    /// The rule of the whole.
    pub set: SetRule,
    /// The masks that layers ask for, each once.
    pub masks: Vec<String>,
}

impl MaterialSet {
    /// The set's rules for a terrain whose heights are from `low_m` to `high_m`. One that is lower than 1 m counts as 1 m high.
    ///
    /// # Errors
    /// Those of [`Self::check`]; [`Error::HeightRange`] for limits that are not finite, or the higher first.
    pub fn resolved(&self, low_m: f32, high_m: f32) -> Result<ResolvedSet> {
        self.check()?;
        if !(low_m.is_finite() && high_m.is_finite() && low_m <= high_m) {
            return Err(Error::HeightRange { low_m, high_m });
        }
        let low_m = f64::from(low_m);
        let range_m = (f64::from(high_m) - low_m).max(MIN_RANGE_M);
        let mut masks = Vec::new();
        let layers = self.layers.iter().map(|layer| layer.rule(low_m, range_m, &mut masks)).collect();
        let set = SetRule {
            blend_depth: self.blend_depth as f32,
            blend_contrast: self.blend_contrast as f32,
            macro_per_m: (1.0 / self.macro_variation.feature_m) as f32,
            macro_amount: self.macro_variation.amount as f32,
        };
        Ok(ResolvedSet { layers, set, masks })
    }
}

impl MaterialLayer {
    fn rule(&self, low_m: f64, range_m: f64, masks: &mut Vec<String>) -> LayerRule {
        let height_m = match self.height_share {
            Some([from, to]) => {
                // All of a terrain lies between its lowest and its highest ground.
                let inner = [from.filter(|share| *share > 0.0), to.filter(|share| *share < 1.0)];
                let limits = inner.map(|limit| limit.map(|share| low_m + share * range_m));
                ramp(limits, self.height_fade_share * range_m)
            }
            None => ramp(self.height_m.unwrap_or_default(), self.height_fade_m),
        };
        LayerRule {
            height_m,
            slope_tangent: slope_ramp(self.slope_degrees.unwrap_or_default(), self.slope_fade_degrees),
            curvature: ramp(self.curvature.unwrap_or_default(), self.curvature_fade),
            noise: self.noise.map_or([0.0, 0.0, -FAR, 1.0], |noise| noise.numbers()),
            look: [self.strength as f32, (1.0 / self.tile_m()) as f32, 0.0, 0.0],
            ids: [self.noise.map_or(0, |noise| noise.seed), self.mask_place(masks), 0, 0],
        }
    }

    fn mask_place(&self, masks: &mut Vec<String>) -> u32 {
        let Some(mask) = &self.mask else { return NO_MASK };
        let place = masks.iter().position(|known| known == mask).unwrap_or(masks.len());
        if place == masks.len() {
            masks.push(mask.clone());
        }
        // There are no more masks than layers.
        place as u32
    }
}

impl LayerNoise {
    fn numbers(&self) -> [f32; 4] {
        let features_per_m = (1.0 / self.feature_m) as f32;
        let [from, per_width] = if self.coverage >= 1.0 {
            [-FAR, 1.0]
        } else {
            // Half a patch's edge on either side of the value above which the wanted share lies; none lies beyond 1.
            let edge = 1.0 - 2.0 * self.coverage;
            let middle = if self.coverage <= 0.0 { 1.0 + PATCH_EDGE } else { edge };
            [(middle - 0.5 * PATCH_EDGE) as f32, (1.0 / PATCH_EDGE) as f32]
        };
        [features_per_m, self.amount as f32, from, per_width]
    }
}

/// The ramp between two limits: half way up on each.
fn ramp([from, to]: Range, fade: f64) -> [f32; 4] {
    let fade = fade.max(MIN_FADE);
    let [rise, per_rise] = from.map_or([-FAR, 1.0], |limit| edge(limit - 0.5 * fade, limit + 0.5 * fade));
    let [fall, per_fall] = to.map_or([FAR, 1.0], |limit| edge(limit - 0.5 * fade, limit + 0.5 * fade));
    [rise, per_rise, fall, per_fall]
}

/// The same of slopes: limits and fade in degrees, the ramp in tangents. No ground is less than level or more than upright.
fn slope_ramp([from, to]: Range, fade_degrees: f64) -> [f32; 4] {
    let half = 0.5 * fade_degrees.max(MIN_FADE);
    let tangent = |degrees: f64| degrees.clamp(-STEEPEST_DEGREES, STEEPEST_DEGREES).to_radians().tan();
    let side = |limit: f64| {
        let (start, end) = (tangent(limit - half), tangent(limit + half));
        edge(start, end.max(start + MIN_FADE))
    };
    let [rise, per_rise] = from.filter(|degrees| *degrees > 0.0).map_or([-FAR, 1.0], side);
    let [fall, per_fall] = to.filter(|degrees| *degrees < STEEPEST_DEGREES).map_or([FAR, 1.0], side);
    [rise, per_rise, fall, per_fall]
}

fn edge(start: f64, end: f64) -> [f32; 2] {
    [start as f32, (1.0 / (end - start)) as f32]
}
