//! What `clone` has beside what all brushes have.

use super::kind::{Parameter, ParameterKind, number, optional_number, parameter};
use super::{MAX_HEIGHT, MAX_RADIUS_M};
use crate::brush::{BrushType, MAX_PYRAMID_LEVELS};
use crate::{MAX_SPACING_M, MIN_SPACING_M};

const CLONE: &[BrushType] = &[BrushType::Clone];

pub(super) const PARAMETERS: &[Parameter] = &[
    parameter("source", ParameterKind::Object { parameters: SOURCE }, "where the ground comes from; needed")
        .of_brushes(CLONE),
    parameter(
        "blend",
        ParameterKind::Choice { words: &["laplacian", "feathered", "mean_shifted", "plain"] },
        "`laplacian`: each scale over its own distance, with no seam; `feathered`: by the falloff; `mean_shifted`: so too, raised or lowered to the ground's mean; `plain`: as it is, with a hard edge",
    )
    .of_brushes(CLONE),
    parameter(
        "levels",
        ParameterKind::Integer { min: 0, max: MAX_PYRAMID_LEVELS, default: 0 },
        "of `laplacian`: levels of the pyramid; 0: until the shorter side of what is painted is at most 8 samples, or 10",
    )
    .of_brushes(CLONE),
    parameter(
        "level_weights",
        ParameterKind::NumberList { min: 0.0, max: 1.0, max_count: MAX_PYRAMID_LEVELS as usize + 1 },
        "of `laplacian`: how much of each level comes from the source, the finest first; by default all of it",
    )
    .of_brushes(CLONE),
];

const PLACE: ParameterKind =
    ParameterKind::Numbers { min: -MAX_RADIUS_M, max: MAX_RADIUS_M, default: &[0.0, 0.0] };

const SOURCE: &[Parameter] = &[
    parameter(
        "region",
        ParameterKind::NumberList { min: -MAX_RADIUS_M, max: MAX_RADIUS_M, max_count: 4 },
        "the part of it that is copied, [x, z, width, depth]; by default all of it",
    )
    .in_unit("m"),
    parameter("feather", number(0.0, MAX_RADIUS_M, 0.0), "over how much that part begins at its edges")
        .in_unit("m"),
    parameter("at", PLACE, "a place [x, z] on the source; by default the middle of `region`").in_unit("m"),
    parameter(
        "alignment",
        ParameterKind::Choice { words: &["stroke", "aligned", "fixed"] },
        "where that place comes to lie: at each stroke's first point; at `to`, for all strokes; at each instance's centre",
    ),
    parameter("to", PLACE, "of `aligned`, and of fills: where, [x, z]").in_unit("m"),
    parameter("layer", ParameterKind::Layer, "another layer of the terrain"),
    parameter("file", ParameterKind::Text, "a terrain, or a raster of any format that can be imported"),
    parameter("blake3", ParameterKind::Text, "name of its content, where it is kept with the terrain"),
    parameter(
        "spacing",
        optional_number(MIN_SPACING_M, MAX_SPACING_M),
        "of a file: distance of its samples; by default what it says, else the terrain's",
    )
    .in_unit("m"),
    parameter(
        "range",
        ParameterKind::NumberList { min: -MAX_HEIGHT, max: MAX_HEIGHT, max_count: 2 },
        "of a file of 8 or 16 bits: heights of its lowest and its highest value [low, high]",
    )
    .in_unit("m"),
    parameter("rotation", number(-360.0, 360.0, 0.0), "turns it from x towards z").in_unit("°"),
    parameter("scale", number(1.0 / 64.0, 64.0, 1.0), "how much larger it becomes"),
    parameter("mirrored", ParameterKind::Flag { default: false }, "whether left and right change places"),
    parameter("height_scale", number(-1000.0, 1000.0, 1.0), "what its heights are multiplied by"),
    parameter("height_offset", number(-MAX_HEIGHT, MAX_HEIGHT, 0.0), "what is added to them then")
        .in_unit("m"),
    parameter(
        "selection",
        ParameterKind::Flag { default: false },
        "only what the terrain's selection holds there is copied",
    ),
];
