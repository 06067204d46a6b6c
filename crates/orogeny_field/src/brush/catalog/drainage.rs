//! What the brushes that work on a whole region at once have: droplets, filled pits, masks of flow.

use super::MAX_HEIGHT;
use super::kind::{Parameter, ParameterKind, number, optional_number, parameter};
use crate::brush::BrushType;
use crate::{MAX_DROPLET_RADIUS, MAX_DROPLET_STEPS};

const DROPLETS: &[BrushType] = &[BrushType::ErodeDroplets];
const FILL_PITS: &[BrushType] = &[BrushType::FillPits];
const RAIN_MASK: &[BrushType] = &[BrushType::RainMask];
const FLOW_MASK: &[BrushType] = &[BrushType::FlowMask];

/// The smallest area that a mask tells apart, in m²: 2^-10, which `f32` holds as it is.
const MIN_AREA_M2: f64 = 0.000_976_562_5;
const MAX_AREA_M2: f64 = 1.0e18;

pub(super) const PARAMETERS: &[Parameter] = &[
    parameter("droplets", number(0.0, 64.0, 1.0), "how many, for each sample of the region").of_brushes(DROPLETS),
    parameter("inertia", number(0.0, 0.99, 0.1), "how much of its way a droplet keeps where the slope leads elsewhere")
        .of_brushes(DROPLETS),
    parameter(
        "capacity",
        number(0.0, 64.0, 0.2),
        "how much rock a droplet holds, by its slope, speed and water, in spacings of the samples",
    )
    .of_brushes(DROPLETS),
    parameter("erosion", number(0.0, 1.0, 0.1), "share of what it could still hold that it takes up at a step")
        .of_brushes(DROPLETS),
    parameter("deposition", number(0.0, 1.0, 0.1), "share of what it holds too much that it lays down at a step")
        .of_brushes(DROPLETS),
    parameter("min_slope", number(0.0, 45.0, 0.5), "level ground counts as so steep").in_unit("°").of_brushes(DROPLETS),
    parameter("evaporation", number(0.0, 0.5, 0.02), "share of its water that evaporates at a step").of_brushes(DROPLETS),
    parameter("gravity", number(0.0, 100.0, 4.0), "how much faster a slope makes it").of_brushes(DROPLETS),
    parameter(
        "erosion_radius",
        ParameterKind::Integer { min: 1, max: MAX_DROPLET_RADIUS, default: 3 },
        "how far it takes up rock to its sides, in samples",
    )
    .of_brushes(DROPLETS),
    parameter(
        "max_steps",
        ParameterKind::Integer { min: 1, max: MAX_DROPLET_STEPS, default: 64 },
        "how far it runs at most, in samples",
    )
    .of_brushes(DROPLETS),
    parameter(
        "slope",
        number(0.0, 1000.0, 0.0),
        "how far each raised sample lies above the one that it drains to, at least; 0 makes filled pits level",
    )
    .in_unit("m")
    .of_brushes(FILL_PITS),
    parameter("max_depth", optional_number(0.0, 2.0 * MAX_HEIGHT), "deeper pits stay; by default all are filled")
        .in_unit("m")
        .of_brushes(FILL_PITS),
    parameter(
        "routing",
        ParameterKind::Choice { words: &["steepest", "shared"] },
        "`steepest`: all water to the lowest neighbour, lines of one sample; `shared`: to all that are lower, wide and soft",
    )
    .of_brushes(FLOW_MASK),
    parameter(
        "exponent",
        number(0.0, 100.0, 1.1),
        "of `shared`: the larger, the more goes to the steepest",
    )
    .of_brushes(FLOW_MASK),
    parameter("from", number(MIN_AREA_M2, MAX_AREA_M2, 1.0e4), "where no more than this area drains, the mask is 0")
        .in_unit("m²")
        .of_brushes(FLOW_MASK),
    parameter("to", number(MIN_AREA_M2, MAX_AREA_M2, 1.0e7), "where this area drains or more, the mask is 1")
        .in_unit("m²")
        .of_brushes(FLOW_MASK),
    parameter(
        "shows",
        ParameterKind::Choice { words: &["water", "sediment", "deposits", "wear"] },
        "how deep water stands; how much rock it carries; how much ground it laid down, or took away",
    )
    .of_brushes(RAIN_MASK),
    parameter("from", number(0.0, MAX_HEIGHT, 0.0), "where there is no more of it than this, the mask is 0")
        .in_unit("m")
        .of_brushes(RAIN_MASK),
    parameter("to", number(0.0, MAX_HEIGHT, 1.0), "where there is this much of it or more, the mask is 1")
        .in_unit("m")
        .of_brushes(RAIN_MASK),
];
