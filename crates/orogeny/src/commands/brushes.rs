//! `brushes`: every brush with its parameters.

use std::fmt;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use orogeny_engine::{
    BrushDescription, BrushType, Parameter, ParameterKind, ProfileRipple, brush_descriptions, brush_schema,
};
use serde::Serialize;
use serde_json::Value;

use crate::session::Session;

/// What `brushes` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// One brush alone
    #[arg(value_parser = PossibleValuesParser::new(BrushType::ALL.map(BrushType::name)).try_map(named))]
    name: Option<BrushType>,
}

fn named(name: String) -> Result<BrushType, String> {
    BrushType::from_name(&name).ok_or_else(|| format!("there is no brush `{name}`"))
}

/// Serialises as JSON Schemas, and as how evenly straight passes come out.
#[derive(Debug, Serialize)]
struct Report {
    brushes: Vec<Value>,
    ripple: Vec<ProfileRipple>,
    #[serde(skip)]
    descriptions: Vec<BrushDescription>,
}

/// Lists the brushes.
///
/// # Errors
/// When standard output cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let is_asked_for = |description: &BrushDescription| {
        arguments.name.is_none_or(|brush_type| brush_type == description.brush_type)
    };
    let descriptions: Vec<_> = brush_descriptions().into_iter().filter(is_asked_for).collect();
    let brushes = descriptions.iter().map(|description| brush_schema(description.brush_type)).collect();
    session.output().report(&Report { brushes, ripple: ProfileRipple::all(), descriptions })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for BrushDescription { brush_type, parameters } in &self.descriptions {
            writeln!(f, "{}: {}", brush_type.name(), brush_type.summary())?;
            writeln!(f, "    {:<14} {:<9} meaning (what it takes)", "parameter", "default")?;
            for parameter in parameters {
                write_parameter(f, parameter, 0)?;
            }
            writeln!(f)?;
        }
        writeln!(f, "How far the centre line of a straight pass is off `strength`, at the default spacing:")?;
        for ProfileRipple { profile, falloff_ratio, spacing, ripple } in &self.ripple {
            writeln!(
                f,
                "    {profile:<10} falloff {falloff_ratio:<4} of the radius: {:.2} %, an instance every {spacing} radii",
                100.0 * ripple
            )?;
        }
        Ok(())
    }
}

/// Writes a parameter and, further to the right, those of the object that it takes.
fn write_parameter(f: &mut fmt::Formatter<'_>, parameter: &Parameter, depth: usize) -> fmt::Result {
    let (values, default) = values_and_default(parameter);
    let indent = " ".repeat(4 + 2 * depth);
    let width = 14_usize.saturating_sub(2 * depth);
    writeln!(f, "{indent}{:<width$} {default:<9} {} ({values})", parameter.name, parameter.meaning)?;
    if let ParameterKind::Object { parameters } | ParameterKind::List { parameters, .. } = parameter.kind {
        // A gate's noise has the parameters of the brush `noise`.
        if parameter.name == "pattern" {
            return Ok(());
        }
        for parameter in parameters {
            write_parameter(f, parameter, depth + 1)?;
        }
    }
    Ok(())
}

/// What a parameter takes, and what it is where it is not given.
fn values_and_default(parameter: &Parameter) -> (String, String) {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let none = || "-".to_owned();
    match parameter.kind {
        ParameterKind::Number { min, max, default } => {
            // The smallest positive number stands for "above 0".
            let lowest = if min == f64::MIN_POSITIVE { "above 0".to_owned() } else { number(min) };
            let default = default.map_or_else(none, |default| format!("{}{unit}", number(default)));
            (format!("{lowest} to {}{unit}", number(max)), default)
        }
        ParameterKind::Integer { min, max, default } => {
            (format!("{min} to {max}, whole"), default.to_string())
        }
        ParameterKind::Choice { words } => {
            (words.join(", "), words.first().copied().unwrap_or_default().to_owned())
        }
        ParameterKind::Flag { default } => ("true, false".to_owned(), default.to_string()),
        ParameterKind::Numbers { min, max, default } => {
            let numbers: Vec<_> = default.iter().map(|value| number(*value)).collect();
            let range = format!("{} numbers, each {} to {}{unit}", default.len(), number(min), number(max));
            (range, numbers.join(", "))
        }
        ParameterKind::NumberList { min, max, max_count } => {
            let (low, high) = (number(min), number(max));
            (format!("up to {max_count} numbers, each {low} to {high}{unit}"), none())
        }
        ParameterKind::Layer => ("a layer's name or id".to_owned(), none()),
        ParameterKind::Curve { x: (left, right), y: (low, high) } => {
            (format!("points [[x, y], …], x from {left} to {right}, y within {low} to {high}"), none())
        }
        ParameterKind::Text => ("a name".to_owned(), none()),
        ParameterKind::List { parameters, max } => {
            let names: Vec<_> = parameters.iter().map(|parameter| parameter.name).collect();
            (format!("a list of at most {max} objects: {}", names.join(", ")), none())
        }
        ParameterKind::Object { parameters } => {
            let names: Vec<_> = parameters.iter().map(|parameter| parameter.name).collect();
            let names = if parameter.name == "pattern" {
                "as the brush `noise`".to_owned()
            } else {
                names.join(", ")
            };
            (format!("an object: {names}"), none())
        }
        ParameterKind::Values => {
            ("an object of numbers, by the names that the file declares".to_owned(), none())
        }
        ParameterKind::Normalization => ("true, false, [offset, scale]".to_owned(), "true".to_owned()),
    }
}

/// Large numbers as powers of ten.
fn number(value: f64) -> String {
    if value.abs() >= 1.0e6 { format!("{value:e}") } else { value.to_string() }
}
