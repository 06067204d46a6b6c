//! Every parameter of every brush: name, unit, range, default and meaning.

mod cloning;
mod drainage;
mod ground;
mod kind;
mod noise;
mod stroke;

pub use kind::{Parameter, ParameterKind};
pub(crate) use stroke::GATE;

use super::BrushType;

/// The largest radius, in metres. A terrain of any size lies within it.
const MAX_RADIUS_M: f64 = 1.0e9;
const MAX_HEIGHT: f64 = crate::MAX_HEIGHT_M as f64;

/// The tables of parameters: those that all brushes share, then those of single types. A name that stands twice has another
/// meaning for other brushes.
pub const PARAMETERS: [&[Parameter]; 6] = [
    stroke::PARAMETERS,
    ground::PARAMETERS,
    drainage::PARAMETERS,
    cloning::PARAMETERS,
    noise::PARAMETERS,
    noise::BY_GROUND,
];

impl Parameter {
    /// The parameters of one brush type, in the table's order.
    pub fn of(brush_type: BrushType) -> impl Iterator<Item = &'static Self> {
        PARAMETERS.into_iter().flatten().filter(move |parameter| parameter.brushes.contains(&brush_type))
    }

    /// The parameter of a brush type with this name.
    #[must_use]
    pub fn find(brush_type: BrushType, name: &str) -> Option<&'static Self> {
        Self::of(brush_type).find(|parameter| parameter.name == name)
    }
}
