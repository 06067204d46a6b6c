//! What a thumbnail shows of a preset: a stroke, a dab or a fill, over which ground.

use orogeny_field::noise::{Noise, Turbulence};
use orogeny_field::{Brush, BrushType, MAX_HEIGHT_M, PointerSample, Stroke};
use serde::{Deserialize, Serialize};

use crate::Operation;
use crate::Target;
use crate::operation::BrushOperation;

/// How the brush is applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleKind {
    /// A gentle S from west to east.
    #[default]
    Stroke,
    /// Once, in the middle.
    Dab,
    /// Everywhere.
    Fill,
}

/// What it is applied to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleGround {
    /// A plain.
    Flat,
    /// A few hills, always the same.
    Hills,
    /// The same hills with crests and gullies, for brushes that work on detail.
    Rough,
}

/// What a preset's thumbnail shows.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// How the brush is applied.
    #[serde(default)]
    pub kind: SampleKind,
    /// What it is applied to; `None`: flat ground, or hills where the brush does nothing to flat ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground: Option<SampleGround>,
    /// The height of the ground, or of the foot of its hills, in metres.
    #[serde(default)]
    pub height_m: f32,
}

/// How far a stroke's curve swings to each side, and where it begins and ends, as shares of the ground.
const SWING: f64 = 0.13;
const ENDS: [f64; 2] = [0.17, 0.83];
const NUM_POINTS: u32 = 17;

/// The hills: where, how wide and how high, as shares of the ground.
const HILLS: [([f64; 2], f64, f64); 7] = [
    ([0.22, 0.30], 0.34, 0.10),
    ([0.62, 0.22], 0.30, 0.13),
    ([0.86, 0.55], 0.26, 0.08),
    ([0.40, 0.58], 0.24, 0.07),
    ([0.14, 0.78], 0.28, 0.06),
    ([0.66, 0.82], 0.30, 0.09),
    ([0.46, 0.40], 0.16, 0.04),
];

/// How wide and how high the crests of rough hills are, as shares of the ground.
const ROUGH_FEATURE: f64 = 0.3;
const ROUGH_HEIGHT: f64 = 0.03;

impl Sample {
    /// What is wrong with it, for people.
    pub(super) fn check(&self) -> Result<(), String> {
        // Hills, and what the brush adds to them, must fit above it.
        let limit_m = 0.5 * MAX_HEIGHT_M;
        match self.height_m.abs() <= limit_m {
            true => Ok(()),
            false => Err(format!(
                "`height_m` = {} of its sample cannot be used: it must be within ±{limit_m} m",
                self.height_m
            )),
        }
    }

    /// How many radii of the brush the ground is wide.
    pub(super) const fn width_in_radii(&self) -> f64 {
        match self.kind {
            SampleKind::Stroke | SampleKind::Fill => 6.0,
            SampleKind::Dab => 2.6,
        }
    }

    /// What is painted, on ground of `side_m` a side.
    pub(super) fn operation(&self, brush: Brush, side_m: f64) -> Operation {
        let points = match self.kind {
            SampleKind::Stroke => curve(side_m),
            SampleKind::Dab => vec![PointerSample::at(0.5 * side_m, 0.5 * side_m)],
            SampleKind::Fill => {
                return fill(brush);
            }
        };
        stroke(brush, points)
    }
}

fn stroke(brush: Brush, points: Vec<PointerSample>) -> Operation {
    let stroke = Stroke { brush, seed: 1, points };
    Operation::Brush(BrushOperation::Stroke { layer: None, target: Target::Seen, stroke })
}

fn fill(brush: Brush) -> Operation {
    let target = Target::Seen;
    Operation::Brush(BrushOperation::Fill { layer: None, target, brush, seed: 1, region_m: None })
}

/// A gentle S.
fn curve(side_m: f64) -> Vec<PointerSample> {
    let [start, end] = ENDS;
    let point = |index: u32| {
        let share = f64::from(index) / f64::from(NUM_POINTS - 1);
        let swing = -SWING * (std::f64::consts::TAU * share).sin();
        PointerSample::at(side_m * (start + share * (end - start)), side_m * (0.5 + swing))
    };
    (0..NUM_POINTS).map(point).collect()
}

/// What makes rough hills of flat ground.
pub(super) fn rough_hills(side_m: f64) -> Vec<Operation> {
    let noise = Noise {
        turbulence: Turbulence::Ridged,
        feature_size_m: ROUGH_FEATURE * side_m,
        octaves: 4,
        ..Noise::default()
    };
    let strength_m = (ROUGH_HEIGHT * side_m).min(0.1 * f64::from(MAX_HEIGHT_M));
    let brush = Brush { noise, ..Brush::new(BrushType::Noise, 1.0, strength_m) };
    hills(side_m).into_iter().chain([fill(brush)]).collect()
}

/// What makes hills of flat ground.
pub(super) fn hills(side_m: f64) -> Vec<Operation> {
    let hill = |([x, z], width, height): ([f64; 2], f64, f64)| {
        let strength_m = (height * side_m).min(0.1 * f64::from(MAX_HEIGHT_M));
        let brush = Brush::new(BrushType::Raise, width * side_m, strength_m);
        stroke(brush, vec![PointerSample::at(x * side_m, z * side_m)])
    };
    HILLS.into_iter().map(hill).collect()
}
