//! What all brushes share: shape, strength, and how a stroke is laid down.

use super::kind::{Parameter, ParameterKind, number, optional_number, parameter};
use super::noise::NOISE;
use super::{MAX_HEIGHT, MAX_RADIUS_M};
use crate::brush::BrushType;

const ADDITIVE: &[BrushType] =
    &[BrushType::Raise, BrushType::Lower, BrushType::Ledge, BrushType::Roughen, BrushType::Noise];
const BLENDING: &[BrushType] = &[
    BrushType::Level,
    BrushType::SetHeight,
    BrushType::Ramp,
    BrushType::Terrace,
    BrushType::RangeMap,
    BrushType::Stamp,
    BrushType::Clone,
    BrushType::FillPits,
    BrushType::PaintMask,
    BrushType::EraseMask,
    BrushType::FlowMask,
    BrushType::RainMask,
    BrushType::Custom,
];
/// The blending brushes whose instances may build up: a stamp's each have a ground of their own.
const WASHING: &[BrushType] = &[
    BrushType::Level,
    BrushType::SetHeight,
    BrushType::Terrace,
    BrushType::RangeMap,
    BrushType::FillPits,
    BrushType::PaintMask,
    BrushType::EraseMask,
    BrushType::FlowMask,
    BrushType::RainMask,
];

const ERODING: &[BrushType] = &[BrushType::ErodeThermal, BrushType::ErodeFluvial, BrushType::ErodeDroplets];
/// Those that look at neighbours: half of the strength is plenty for one pass.
const FILTERING: &[BrushType] = &[BrushType::Smooth, BrushType::Sharpen, BrushType::Smear];
pub(super) const SMOOTHING: &[BrushType] = &[BrushType::Smooth, BrushType::Sharpen];

/// A factor 0..1 by a factor 0..1.
const FACTOR: ParameterKind = ParameterKind::Curve { x: (0.0, 1.0), y: (0.0, 1.0) };

pub(super) const PARAMETERS: &[Parameter] = &[
    parameter(
        "radius",
        number(f64::MIN_POSITIVE, MAX_RADIUS_M, 50.0),
        "outer radius; nothing changes beyond it",
    )
    .in_unit("m"),
    parameter(
        "falloff",
        optional_number(0.0, MAX_RADIUS_M),
        "width of the slope inside the radius, 0 (a hard edge) to the radius; by default the radius",
    )
    .in_unit("m"),
    parameter(
        "profile",
        ParameterKind::Choice {
            words: &["smooth", "power", "linear", "sphere", "tip", "gauss", "sigmoid", "curve"],
        },
        "shape of the slope",
    ),
    parameter("power", number(0.1, 16.0, 1.0), "exponent of the profile `power`"),
    parameter("steepness", number(0.01, 20.0, 3.0), "steepness of the profile `sigmoid`"),
    parameter(
        "profile_curve",
        FACTOR,
        "weight of the profile `curve`, from the edge (0) to the inside of the slope (1)",
    ),
    parameter(
        "strength",
        number(0.0, MAX_HEIGHT, 10.0),
        "change of the centre line by one straight pass at full pressure; of a fill, the change",
    )
    .in_unit("m")
    .of_brushes(ADDITIVE),
    parameter(
        "strength",
        number(0.0, 1.0, 1.0),
        "share of the way to the target that one straight pass goes",
    )
    .of_brushes(BLENDING),
    parameter("strength", number(0.0, 1.0, 1.0), "share of the stroke's way by which the ground moves")
        .of_brushes(&[BrushType::Grab]),
    parameter(
        "strength",
        number(0.0, 1.0, 0.5),
        "share of the way to what is smoothed or sharpened that one straight pass goes; of `smear`, how much each instance drags along",
    )
    .of_brushes(FILTERING),
    parameter(
        "strength",
        number(0.0, 1.0, 1.0),
        "share of what erosion changes that one straight pass makes of the ground",
    )
    .of_brushes(ERODING),
    parameter(
        "flow",
        number(0.0, 1.0, 1.0),
        "share of the strength that one pass gives; a wash with less than 1 comes nearer to its strength with every pass",
    ),
    parameter(
        "spacing",
        number(1.0 / 32.0, 1.0, 0.25),
        "distance between instances as a fraction of the radius; halved where a pass would ripple",
    ),
    parameter(
        "blending",
        ParameterKind::Choice { words: &["wash", "build_up"] },
        "`wash`: one weight for the whole stroke; `build_up`: going over a place again blends it again",
    )
    .of_brushes(WASHING),
    parameter(
        "blending",
        ParameterKind::Choice { words: &["build_up", "wash"] },
        "`build_up`: each instance works on what those before it left; `wash`: one weight for the whole stroke, on the ground before it",
    )
    .of_brushes(SMOOTHING),
    parameter(
        "blending",
        ParameterKind::Choice { words: &["build_up", "wash"] },
        "`build_up`: going over a place again comes nearer to what erosion makes of the ground before the stroke; `wash`: one weight for the whole stroke",
    )
    .of_brushes(ERODING),
    parameter(
        "airbrush",
        ParameterKind::Flag { default: false },
        "goes on while the pointer rests: `strength` a second; points need times",
    ),
    parameter(
        "pressure",
        ParameterKind::Choice { words: &["strength", "radius", "both", "none", "flow"] },
        "what the pen's pressure scales",
    ),
    parameter(
        "dynamics",
        ParameterKind::Object { parameters: DYNAMICS },
        "curves from pressure and tilt to factors; one from pressure stands in for `pressure`",
    ),
    parameter(
        "jitter",
        ParameterKind::Object { parameters: JITTER },
        "what differs at random from instance to instance",
    ),
    parameter(
        "alpha",
        ParameterKind::Object { parameters: ALPHA },
        "a picture that shapes the weight: PNG or EXR",
    ),
    parameter("mirror", ParameterKind::Object { parameters: MIRROR }, "copies of the stroke"),
    parameter(
        "gate",
        ParameterKind::Object { parameters: GATE },
        "where it may act, by the ground before the stroke",
    ),
];

const DYNAMICS: &[Parameter] = &[
    parameter("pressure_to_radius", FACTOR, "factor of the radius by pressure"),
    parameter("pressure_to_strength", FACTOR, "factor of the strength by pressure"),
    parameter("pressure_to_flow", FACTOR, "factor of the flow by pressure"),
    parameter("tilt_to_radius", FACTOR, "factor of the radius by tilt, 0 upright to 1 flat"),
    parameter("tilt_to_strength", FACTOR, "factor of the strength by tilt"),
    parameter("tilt_to_flow", FACTOR, "factor of the flow by tilt"),
];

const JITTER: &[Parameter] = &[
    parameter(
        "radius",
        number(0.0, 1.0, 0.0),
        "how much smaller an instance may be, as a share of the radius",
    ),
    parameter("position", number(0.0, 4.0, 0.0), "how far its centre may be off, as a share of the radius"),
    parameter("strength", number(0.0, 1.0, 0.0), "how much weaker it may be, as a share of the strength"),
];

const ALPHA: &[Parameter] = &[
    parameter("file", ParameterKind::Text, "the picture; its white is 1, its black 0"),
    parameter(
        "blake3",
        ParameterKind::Text,
        "name of the picture's content, where it is kept with the terrain",
    ),
    parameter("angle", number(-360.0, 360.0, 0.0), "turns it from x towards z").in_unit("°"),
    parameter(
        "rotation",
        ParameterKind::Choice { words: &["fixed", "follow", "random"] },
        "what else turns it: nothing, the stroke's direction, or chance",
    ),
    parameter("mirrored", ParameterKind::Flag { default: false }, "whether left and right change places"),
];

const MIRROR: &[Parameter] = &[
    parameter(
        "kind",
        ParameterKind::Choice { words: &["axis", "point", "radial"] },
        "in the mirror of an axis, through a point, or turned about a point",
    ),
    parameter(
        "centre",
        ParameterKind::Numbers { min: -MAX_RADIUS_M, max: MAX_RADIUS_M, default: &[0.0, 0.0] },
        "the point, or one on the axis",
    )
    .in_unit("m"),
    parameter("angle", number(-360.0, 360.0, 90.0), "of the axis, from x towards z").in_unit("°"),
    parameter("count", ParameterKind::Integer { min: 2, max: 64, default: 6 }, "of `radial`: strokes in all"),
];

const FULL_HEIGHT: (f64, f64) = (-MAX_HEIGHT, MAX_HEIGHT);

macro_rules! band {
    ($low:expr, $high:expr, $unit:literal) => {
        &[
            parameter("min", number($low, $high, $low), "lower end").in_unit($unit),
            parameter("max", number($low, $high, $high), "upper end").in_unit($unit),
            parameter("feather", number(0.0, $high - $low, 0.0), "width of the soft ends, outside the range")
                .in_unit($unit),
        ]
    };
}

/// What a gate looks at; `noise` stands in the middle, where there is one.
macro_rules! gate {
    ($($noise:expr)?) => {
        &[
            parameter("slope", ParameterKind::Object { parameters: band!(0.0, 90.0, "°") }, "steepness"),
            parameter(
                "height",
                ParameterKind::Object { parameters: band!(FULL_HEIGHT.0, FULL_HEIGHT.1, "m") },
                "height",
            ),
            parameter("aspect", ParameterKind::Object { parameters: ASPECT }, "which way the ground falls"),
            parameter(
                "curvature",
                ParameterKind::Object { parameters: band!(-1.0e6, 1.0e6, "1/km") },
                "how the ground bends: positive on crests, negative in hollows",
            ),
            $($noise,)?
            parameter(
                "image",
                ParameterKind::Object { parameters: IMAGE },
                "a picture laid over the world, white 1 and black 0",
            ),
            parameter("selection", ParameterKind::Flag { default: false }, "the terrain's selection"),
            parameter("inverted", ParameterKind::Flag { default: false }, "acts where it otherwise would not"),
        ]
    };
}

pub(crate) const GATE: &[Parameter] =
    gate!(parameter("noise", ParameterKind::Object { parameters: NOISE_GATE }, "a noise, normalised"));

/// A gate without a noise: tables cannot hold themselves.
pub(super) const ROUGHNESS: &[Parameter] = gate!();

const IMAGE: &[Parameter] = &[
    parameter("file", ParameterKind::Text, "the picture: PNG or EXR"),
    parameter("blake3", ParameterKind::Text, "name of its content, where it is kept with the terrain"),
    parameter(
        "region",
        ParameterKind::Numbers { min: -MAX_RADIUS_M, max: MAX_RADIUS_M, default: &[0.0, 0.0, 0.0, 0.0] },
        "where it lies: [x, z, width, depth]",
    )
    .in_unit("m"),
];

const ASPECT: &[Parameter] = &[
    parameter("angle", number(-360.0, 360.0, 0.0), "the way down, from x (east) towards z (south)")
        .in_unit("°"),
    parameter("width", number(0.0, 180.0, 45.0), "how far off it, to either side").in_unit("°"),
    parameter("feather", number(0.0, 180.0, 15.0), "width of the soft ends").in_unit("°"),
];

const NOISE_GATE: &[Parameter] = &[
    parameter("min", number(-100.0, 100.0, 0.0), "lower end"),
    parameter("max", number(-100.0, 100.0, 100.0), "upper end"),
    parameter("feather", number(0.0, 100.0, 0.2), "width of the soft ends, outside the range"),
    parameter(
        "pattern",
        ParameterKind::Object { parameters: NOISE },
        "which noise; the world's coordinates always",
    ),
];
