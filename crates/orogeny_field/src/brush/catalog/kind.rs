//! What a parameter is.

use crate::brush::BrushType;

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
    /// A whole number within a closed range.
    Integer {
        /// Smallest.
        min: u32,
        /// Largest.
        max: u32,
        /// Where it is not given.
        default: u32,
    },
    /// One of a few words.
    Choice {
        /// The words, the first is the default.
        words: &'static [&'static str],
    },
    /// `true` or `false`.
    Flag {
        /// Where it is not given.
        default: bool,
    },
    /// A list of numbers of fixed length, each within a closed range.
    Numbers {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
        /// Where it is not given; also says how many.
        default: &'static [f64],
    },
    /// A list of any numbers up to a count, each within a closed range.
    NumberList {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
        /// How many at most.
        max_count: usize,
    },
    /// A layer: its name, or its id.
    Layer,
    /// Control points `[[x, y], …]`, x rising.
    Curve {
        /// Ends of the x that count.
        x: (f64, f64),
        /// Ends of what y may be.
        y: (f64, f64),
    },
    /// A name.
    Text,
    /// An object with parameters of its own.
    Object {
        /// Them.
        parameters: &'static [Parameter],
    },
    /// A list of objects with parameters of their own.
    List {
        /// Them.
        parameters: &'static [Parameter],
        /// How many at most.
        max: usize,
    },
    /// `true`, `false`, or `[offset, scale]`.
    Normalization,
    /// An object of numbers under any names.
    Values,
}

/// A parameter of one or more brushes, or of an object in one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// The JSON field.
    pub name: &'static str,
    /// `m`, `°` or the like; empty for numbers without a unit.
    pub unit: &'static str,
    /// What it takes.
    pub kind: ParameterKind,
    /// What it does.
    pub meaning: &'static str,
    /// The brushes that have it.
    pub brushes: &'static [BrushType],
}

impl Parameter {
    /// The same parameter with a unit.
    pub(super) const fn in_unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// The same parameter for some brushes only.
    pub(super) const fn of_brushes(mut self, brushes: &'static [BrushType]) -> Self {
        self.brushes = brushes;
        self
    }
}

/// A parameter of all brushes, without a unit.
pub(super) const fn parameter(name: &'static str, kind: ParameterKind, meaning: &'static str) -> Parameter {
    Parameter { name, unit: "", kind, meaning, brushes: &BrushType::ALL }
}

pub(super) const fn number(min: f64, max: f64, default: f64) -> ParameterKind {
    ParameterKind::Number { min, max, default: Some(default) }
}

pub(super) const fn optional_number(min: f64, max: f64) -> ParameterKind {
    ParameterKind::Number { min, max, default: None }
}
