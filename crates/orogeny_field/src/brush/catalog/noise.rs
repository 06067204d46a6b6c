//! Noise: of the brush `noise`, and of gates.

use super::MAX_RADIUS_M;
use super::kind::{Parameter, ParameterKind, number, optional_number, parameter};
use super::stroke::ROUGHNESS;
use crate::brush::BrushType;
use crate::noise::MAX_OCTAVES;

const TURBULENCES: &[&str] =
    &["fbm", "billowy", "ridged", "quilez", "erosive", "jordan", "heterogeneous", "multiplicative", "hybrid"];

const fn octaves(default: u32) -> ParameterKind {
    ParameterKind::Integer { min: 1, max: MAX_OCTAVES, default }
}

/// -1..1 to about -1..1.
const SIGNED: ParameterKind = ParameterKind::Curve { x: (-1.0, 1.0), y: (-4.0, 4.0) };

/// What a noise has by the ground, which that of a gate has not.
pub(super) const BY_GROUND: &[Parameter] = &[of_noise(parameter(
    "roughness",
    ParameterKind::Object { parameters: ROUGHNESS },
    "how rough it is where: a gate, whose weight multiplies that of each octave once more than that of the one before",
))];

/// A noise by itself.
pub(super) const NOISE: &[Parameter] = PARAMETERS;

/// Of the brush: what it does not share with others.
pub(super) const PARAMETERS: &[Parameter] = &[
    of_noise(parameter(
        "basis",
        ParameterKind::Choice { words: &["gradient", "value", "worley", "simplex", "simplex3d", "sparse"] },
        "what one octave is made of",
    )),
    of_noise(parameter("turbulence", ParameterKind::Choice { words: TURBULENCES }, "how octaves are summed")),
    of_noise(
        parameter("feature_size", number(1.0e-3, MAX_RADIUS_M, 100.0), "size of the largest features")
            .in_unit("m"),
    ),
    of_noise(parameter(
        "octaves",
        octaves(8),
        "how many at most; those shorter than two samples are left out",
    )),
    of_noise(parameter(
        "lacunarity",
        number(1.1, 4.0, 1.92),
        "ratio of the frequencies of successive octaves",
    )),
    of_noise(parameter(
        "hurst",
        number(0.0, 1.0, 0.85),
        "smoothness: an octave weighs lacunarity^-hurst of the one before",
    )),
    of_noise(parameter("gain", optional_number(0.0, 1.0), "that weight itself, instead of `hurst`")),
    of_noise(parameter(
        "seed",
        ParameterKind::Integer { min: 0, max: u32::MAX, default: 0 },
        "which of all noises",
    )),
    of_noise(parameter(
        "seeding",
        ParameterKind::Choice { words: &["world", "instance", "stroke", "random"] },
        "`world`: fixed to the ground; `instance`: goes with the brush; `stroke`: new for each stroke; `random`: for each instance",
    )),
    of_noise(parameter(
        "normalize",
        ParameterKind::Normalization,
        "scales the sum to about -1..1, or 0..1 for turbulences that are not about 0",
    )),
    of_noise(parameter(
        "worley_weights",
        ParameterKind::Numbers { min: -4.0, max: 4.0, default: &[1.0, 0.0, 0.0, 0.0] },
        "of `worley`: weights of the distances to the nearest four points",
    )),
    of_noise(parameter(
        "slice",
        number(-1.0e6, 1.0e6, 0.0),
        "of `simplex3d`: where it is cut, in feature sizes",
    )),
    of_noise(parameter(
        "elevation",
        number(-2.0, 4.0, 0.7),
        "of `heterogeneous`, `multiplicative` and `hybrid`: added to each octave",
    )),
    of_noise(parameter("transfer", SIGNED, "what each octave, -1 to 1, is turned into before it is summed")),
    of_noise(parameter("curve", SIGNED, "what the normalised sum, -1 to 1, is turned into")),
    of_noise(parameter(
        "distortion",
        ParameterKind::Object { parameters: DISTORTION },
        "two noises that move the place",
    )),
    of_noise(parameter(
        "stretch",
        ParameterKind::Object { parameters: STRETCH },
        "longer features along a direction",
    )),
    of_noise(
        parameter(
            "offset",
            ParameterKind::Numbers { min: -MAX_RADIUS_M, max: MAX_RADIUS_M, default: &[0.0, 0.0] },
            "where the pattern begins",
        )
        .in_unit("m"),
    ),
    of_noise(
        parameter("rotation", number(-360.0, 360.0, 0.0), "turns the pattern from x towards z").in_unit("°"),
    ),
];

const fn of_noise(parameter: Parameter) -> Parameter {
    parameter.of_brushes(&[BrushType::Noise])
}

const DISTORTION: &[Parameter] = &[
    parameter("turbulence", ParameterKind::Choice { words: TURBULENCES }, "how octaves are summed"),
    parameter("octaves", octaves(4), "how many at most"),
    parameter("weight", number(-16.0, 16.0, 0.3), "how far places are moved, in feature sizes"),
    parameter("lacunarity", number(1.1, 4.0, 1.92), "ratio of the frequencies of successive octaves"),
    parameter("hurst", number(0.0, 1.0, 0.85), "smoothness"),
    parameter(
        "gain",
        optional_number(0.0, 1.0),
        "weight of an octave by that of the one before, instead of `hurst`",
    ),
];

const STRETCH: &[Parameter] = &[
    parameter("angle", number(-360.0, 360.0, 0.0), "from x towards z, or from the stroke's direction")
        .in_unit("°"),
    parameter(
        "follow",
        ParameterKind::Flag { default: false },
        "whether the angle is from the stroke's direction",
    ),
    parameter("factor", number(1.0, 64.0, 3.0), "how many times longer"),
];
