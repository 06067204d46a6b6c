//! Every parameter of every brush: name, unit, range, default and meaning.

use super::BrushType;

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// A number within a closed range.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
        /// Where it is not given. `None`: see the parameter's meaning.
        default: Option<f64>,
    },
    /// One of a few words.
    Choice {
        /// The words, the first is the default.
        words: &'static [&'static str],
    },
}

/// A parameter of one or more brushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// The JSON field.
    pub name: &'static str,
    /// `m`, or empty for numbers without a unit.
    pub unit: &'static str,
    /// What it takes.
    pub kind: ParameterKind,
    /// What it does.
    pub meaning: &'static str,
    /// The brushes that have it.
    pub brushes: &'static [BrushType],
}

const ALL: &[BrushType] = &BrushType::ALL;
const ADDITIVE: &[BrushType] = &[BrushType::Raise, BrushType::Lower, BrushType::Ledge, BrushType::Roughen];
const BLENDING: &[BrushType] = &[BrushType::Level, BrushType::SetHeight];

/// The largest radius, in metres. A terrain of any size lies within it.
const MAX_RADIUS_M: f64 = 1.0e9;
const MAX_HEIGHT: f64 = crate::MAX_HEIGHT_M as f64;

const fn number(min: f64, max: f64, default: f64) -> ParameterKind {
    ParameterKind::Number { min, max, default: Some(default) }
}

/// The table of parameters. A name that stands twice has another meaning for other brushes.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "radius",
        unit: "m",
        kind: number(f64::MIN_POSITIVE, MAX_RADIUS_M, 50.0),
        meaning: "outer radius; nothing changes beyond it",
        brushes: ALL,
    },
    Parameter {
        name: "falloff",
        unit: "m",
        kind: ParameterKind::Number { min: 0.0, max: MAX_RADIUS_M, default: None },
        meaning: "width of the slope inside the radius, 0 (a hard edge) to the radius; by default the radius",
        brushes: ALL,
    },
    Parameter {
        name: "profile",
        unit: "",
        kind: ParameterKind::Choice {
            words: &["smooth", "power", "linear", "sphere", "tip", "gauss", "sigmoid"],
        },
        meaning: "shape of the slope",
        brushes: ALL,
    },
    Parameter {
        name: "power",
        unit: "",
        kind: number(0.1, 16.0, 1.0),
        meaning: "exponent of the profile `power`",
        brushes: ALL,
    },
    Parameter {
        name: "steepness",
        unit: "",
        kind: number(0.01, 20.0, 3.0),
        meaning: "steepness of the profile `sigmoid`",
        brushes: ALL,
    },
    Parameter {
        name: "strength",
        unit: "m",
        kind: number(0.0, MAX_HEIGHT, 10.0),
        meaning: "change of the centre line by one straight pass at full pressure; of a fill, the change",
        brushes: ADDITIVE,
    },
    Parameter {
        name: "strength",
        unit: "",
        kind: number(0.0, 1.0, 1.0),
        meaning: "share of the way to the target that one straight pass goes",
        brushes: BLENDING,
    },
    Parameter {
        name: "spacing",
        unit: "",
        kind: number(1.0 / 32.0, 1.0, 0.25),
        meaning: "distance between instances as a fraction of the radius; halved where a pass would ripple",
        brushes: ALL,
    },
    Parameter {
        name: "pressure",
        unit: "",
        kind: ParameterKind::Choice { words: &["strength", "radius", "both", "none"] },
        meaning: "what the pen's pressure scales",
        brushes: ALL,
    },
    Parameter {
        name: "blending",
        unit: "",
        kind: ParameterKind::Choice { words: &["wash", "build_up"] },
        meaning: "`wash`: one weight for the whole stroke; `build_up`: going over a place again blends it again",
        brushes: BLENDING,
    },
    Parameter {
        name: "height",
        unit: "m",
        kind: ParameterKind::Number { min: -MAX_HEIGHT, max: MAX_HEIGHT, default: None },
        meaning: "target height; by default the height under the stroke's first point; a fill needs it",
        brushes: &[BrushType::Level],
    },
    Parameter {
        name: "height",
        unit: "m",
        kind: ParameterKind::Number { min: -MAX_HEIGHT, max: MAX_HEIGHT, default: None },
        meaning: "target height; needed",
        brushes: &[BrushType::SetHeight],
    },
    Parameter {
        name: "height",
        unit: "m",
        kind: ParameterKind::Number { min: -MAX_HEIGHT, max: MAX_HEIGHT, default: None },
        meaning: "reference height; by default the ground at each instance's centre; a fill needs it",
        brushes: &[BrushType::Ledge],
    },
    Parameter {
        name: "direction",
        unit: "",
        kind: ParameterKind::Choice { words: &["raise", "lower"] },
        meaning: "`raise`: lower ground comes up; `lower`: higher ground goes down",
        brushes: &[BrushType::Ledge],
    },
    Parameter {
        name: "only",
        unit: "",
        kind: ParameterKind::Choice { words: &["both", "cut", "fill"] },
        meaning: "which way the ground may move: `cut` down, `fill` up",
        brushes: &[BrushType::Level],
    },
];

impl Parameter {
    /// The parameters of one brush type, in the table's order.
    pub fn of(brush_type: BrushType) -> impl Iterator<Item = &'static Self> {
        PARAMETERS.iter().filter(move |parameter| parameter.brushes.contains(&brush_type))
    }

    /// The parameter of a brush type with this name.
    #[must_use]
    pub fn find(brush_type: BrushType, name: &str) -> Option<&'static Self> {
        Self::of(brush_type).find(|parameter| parameter.name == name)
    }
}
