//! What single brush types have.

use super::kind::{Parameter, ParameterKind, number, optional_number, parameter};
use super::stroke::{GATE, SMOOTHING};
use super::{MAX_HEIGHT, MAX_RADIUS_M};
use crate::brush::BrushType;
use crate::{MAX_ROCK_LAYERS, MAX_TALUS_ANGLE_DEG, MAX_THERMAL_RATE};

pub(super) const PARAMETERS: &[Parameter] = &[
    parameter(
        "height",
        optional_number(-MAX_HEIGHT, MAX_HEIGHT),
        "target height; by default the height under the stroke's first point; a fill needs it",
    )
    .in_unit("m")
    .of_brushes(&[BrushType::Level]),
    parameter("height", optional_number(-MAX_HEIGHT, MAX_HEIGHT), "target height; needed")
        .in_unit("m")
        .of_brushes(&[BrushType::SetHeight]),
    parameter(
        "height",
        optional_number(-MAX_HEIGHT, MAX_HEIGHT),
        "reference height; by default the ground at each instance's centre; a fill needs it",
    )
    .in_unit("m")
    .of_brushes(&[BrushType::Ledge]),
    parameter(
        "height",
        optional_number(-MAX_HEIGHT, MAX_HEIGHT),
        "height that black stands for; by default the ground at each instance's centre",
    )
    .in_unit("m")
    .of_brushes(&[BrushType::Stamp]),
    parameter(
        "height",
        optional_number(-MAX_HEIGHT, MAX_HEIGHT),
        "height of the beginning; by default the ground under the stroke's first point",
    )
    .in_unit("m")
    .of_brushes(&[BrushType::Ramp]),
    parameter(
        "end_height",
        optional_number(-MAX_HEIGHT, MAX_HEIGHT),
        "height of the end; by default the ground under the stroke's last point",
    )
    .in_unit("m")
    .of_brushes(&[BrushType::Ramp]),
    parameter("along", ParameterKind::Choice { words: &["linear", "smooth"] }, "the ramp's profile along its way")
        .of_brushes(&[BrushType::Ramp]),
    parameter(
        "direction",
        ParameterKind::Choice { words: &["raise", "lower"] },
        "`raise`: lower ground comes up; `lower`: higher ground goes down",
    )
    .of_brushes(&[BrushType::Ledge]),
    parameter(
        "only",
        ParameterKind::Choice { words: &["both", "cut", "fill"] },
        "which way the ground may move: `cut` down, `fill` up",
    )
    .of_brushes(&[BrushType::Level, BrushType::Ramp]),
    parameter("method", ParameterKind::Choice { words: &["gaussian", "lattice"] }, "by a Gaussian, or by a B-spline over a lattice of samples")
        .of_brushes(&[BrushType::Smooth]),
    parameter(
        "width",
        optional_number(1.0e-3, MAX_RADIUS_M),
        "standard deviation of the Gaussian, or distance of the lattice's samples; at most 512 samples; by default an eighth of the radius, or as much",
    )
    .in_unit("m")
    .of_brushes(SMOOTHING),
    parameter("gain", number(0.0, 16.0, 1.0), "how far the ground is moved, by its distance from what is smoothed")
        .of_brushes(&[BrushType::Sharpen]),
    parameter(
        "hardness",
        ParameterKind::Object { parameters: GATE },
        "how hard the ground is where, 0 to 1, by the ground before the stroke: where it is 1 nothing is taken",
    )
    .of_brushes(HARD),
    parameter("iterations", ParameterKind::Integer { min: 1, max: 1000, default: 50 }, "how long it slides; each takes it a sample further")
        .of_brushes(THERMAL),
    parameter("talus_angle", TALUS_ANGLE, "the steepest slope that holds").in_unit("°").of_brushes(THERMAL),
    parameter("rate", RATE, "how much of what is too steep slides in two iterations").of_brushes(THERMAL),
    parameter(
        "layers",
        ParameterKind::List { parameters: LAYER, max: MAX_ROCK_LAYERS - 1 },
        "rock that is different from a height upward, the lowest first; what is below has the brush's `talus_angle` and `rate`",
    )
    .of_brushes(THERMAL),
    parameter("iterations", ParameterKind::Integer { min: 1, max: 600, default: 150 }, "how long it rains")
        .of_brushes(FLUVIAL),
    parameter("rain", number(0.0, 1.0, 0.01), "rain everywhere").in_unit("m/s").of_brushes(FLUVIAL),
    parameter("evaporation", number(0.0, 10.0, 0.02), "share of the water that evaporates").in_unit("1/s").of_brushes(FLUVIAL),
    parameter("capacity", number(0.0, 10.0, 0.5), "how much rock water holds, by its velocity and the slope")
        .in_unit("s/m")
        .of_brushes(FLUVIAL),
    parameter("dissolving", number(0.0, 100.0, 0.1), "share of what water could still hold that it takes up")
        .in_unit("1/s")
        .of_brushes(FLUVIAL),
    parameter("deposition", number(0.0, 100.0, 0.1), "share of what water holds too much that it lays down")
        .in_unit("1/s")
        .of_brushes(FLUVIAL),
    parameter("min_slope", number(0.0, 45.0, 3.0), "level ground counts as so steep").in_unit("°").of_brushes(FLUVIAL),
    parameter("friction", number(0.0, 100.0, 0.5), "share of the flow that is lost").in_unit("1/s").of_brushes(FLUVIAL),
    parameter("step", number(1.0e-3, MAX_HEIGHT, 10.0), "height of a step").in_unit("m").of_brushes(TERRACE),
    parameter("sharpness", number(0.0, 1.0, 0.7), "0 leaves the ground as it is, 1 makes walls").of_brushes(TERRACE),
    parameter("tilt", number(0.0, 60.0, 0.0), "tilt of the steps against the horizontal").in_unit("°").of_brushes(TERRACE),
    parameter("tilt_direction", number(-360.0, 360.0, 0.0), "the way down their tilt, from x towards z")
        .in_unit("°")
        .of_brushes(TERRACE),
    parameter("low", number(-MAX_HEIGHT, MAX_HEIGHT, 0.0), "lower end of the range").in_unit("m").of_brushes(RANGE_MAP),
    parameter("high", number(-MAX_HEIGHT, MAX_HEIGHT, 1000.0), "upper end of the range, above the lower")
        .in_unit("m")
        .of_brushes(RANGE_MAP),
    parameter("mapping", ParameterKind::Choice { words: &["bias", "gain", "curve"] }, "how heights are spread over the range")
        .of_brushes(RANGE_MAP),
    parameter("bias", number(0.01, 0.99, 0.3), "of `bias`: under 0.5 lowers the middle, above raises it")
        .of_brushes(RANGE_MAP),
    parameter("gain", number(0.01, 0.99, 0.7), "of `gain`: under 0.5 flattens the middle, above steepens it")
        .of_brushes(RANGE_MAP),
    parameter(
        "map_curve",
        ParameterKind::Curve { x: (0.0, 1.0), y: (0.0, 1.0) },
        "of `curve`: from low (0) to high (1)",
    )
    .of_brushes(RANGE_MAP),
    parameter("scale", number(-MAX_HEIGHT, MAX_HEIGHT, 100.0), "metres that white in the picture stands for")
        .in_unit("m")
        .of_brushes(STAMP),
    parameter(
        "mode",
        ParameterKind::Choice { words: &["add", "replace", "max", "min"] },
        "`add`: laid on the ground; `replace`: the ground becomes it; `max`, `min`: the higher, the lower of both",
    )
    .of_brushes(STAMP),
    parameter("file", ParameterKind::Text, "the WGSL file").of_brushes(CUSTOM),
    parameter("blake3", ParameterKind::Text, "name of its content, where it is kept with the terrain").of_brushes(CUSTOM),
    parameter("parameters", ParameterKind::Values, "values of the parameters that the file declares").of_brushes(CUSTOM),
    parameter(
        "blending",
        ParameterKind::Choice { words: &["each", "wash", "build_up"] },
        "`each`: every instance acts with its whole weight; `wash`: one weight for the whole stroke; `build_up`: a share each",
    )
    .of_brushes(CUSTOM),
    parameter("value", number(0.0, 1.0, 1.0), "what is painted").of_brushes(&[BrushType::PaintMask]),
];

const TALUS_ANGLE: ParameterKind = number(0.0, MAX_TALUS_ANGLE_DEG, 35.0);
const RATE: ParameterKind = number(0.0, MAX_THERMAL_RATE, MAX_THERMAL_RATE);
const LAYER: &[Parameter] = &[
    parameter("from", number(-MAX_HEIGHT, MAX_HEIGHT, 0.0), "where it begins").in_unit("m"),
    parameter("talus_angle", TALUS_ANGLE, "the steepest slope of it that holds").in_unit("°"),
    parameter("rate", RATE, "how much of what is too steep slides in two iterations"),
];
const HARD: &[BrushType] = &[BrushType::ErodeThermal, BrushType::ErodeFluvial, BrushType::RainMask];
const THERMAL: &[BrushType] = &[BrushType::ErodeThermal];
const FLUVIAL: &[BrushType] = &[BrushType::ErodeFluvial, BrushType::RainMask];
const TERRACE: &[BrushType] = &[BrushType::Terrace];
const RANGE_MAP: &[BrushType] = &[BrushType::RangeMap];
const CUSTOM: &[BrushType] = &[BrushType::Custom];
const STAMP: &[BrushType] = &[BrushType::Stamp];
