//! Custom: a kernel that a user wrote. It has no twin on the CPU.

use std::sync::Arc;

use orogeny_field::{Brush, TerrainGrid};
use orogeny_shaders::custom::CustomBrush;

use super::OwnData;
use crate::Result;

/// The shader's stem, the same for all of them.
pub const STEM: &str = "custom/brush";

/// A user's kernel, compiled.
#[derive(Debug, Clone)]
pub struct CustomProgram {
    /// The kernel and its parameters.
    pub brush: CustomBrush,
    /// What tells it from others: a hash of its text.
    pub identity: String,
}

/// A user's kernel with the values of a brush.
#[derive(Debug, Clone)]
pub struct CustomRule {
    /// The kernel.
    pub program: Arc<CustomProgram>,
    parameters: Vec<f32>,
    uniform: CustomUniform,
}

impl PartialEq for CustomRule {
    fn eq(&self, other: &Self) -> bool {
        self.program.identity == other.program.identity
            && self.parameters == other.parameters
            && self.uniform == other.uniform
    }
}

/// The layout is that of `Custom` in `shaders/custom/brush.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CustomUniform {
    /// Metres between samples.
    pub spacing_m: f32,
    /// The brush's, metres.
    pub radius_m: f32,
    /// The stroke's.
    pub seed: u32,
}

impl CustomRule {
    /// A kernel with the values that a brush gives its parameters.
    ///
    /// # Errors
    /// [`orogeny_field::Error::BrushValue`] for a parameter that the kernel does not declare, or a value out of its range.
    pub fn new(program: Arc<CustomProgram>, brush: &Brush, seed: u32, grid: &TerrainGrid) -> Result<Self> {
        let given = brush.custom.as_ref().map(|custom| custom.parameters.as_slice()).unwrap_or_default();
        let declared = &program.brush.parameters;
        let refused = |name: &str, value: f64, limit: String| orogeny_field::Error::BrushValue {
            brush: brush.brush_type.name(),
            field: format!("parameters.{name}"),
            value: value.to_string(),
            limit,
        };
        for (name, value) in given {
            let Some(parameter) = declared.iter().find(|parameter| parameter.name == *name) else {
                let names: Vec<_> = declared.iter().map(|parameter| parameter.name.as_str()).collect();
                let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
                return Err(refused(name, *value, format!("its file declares {names}")).into());
            };
            if !(f64::from(parameter.min)..=f64::from(parameter.max)).contains(value) {
                let limit = format!("it must be within {} to {}", parameter.min, parameter.max);
                return Err(refused(name, *value, limit).into());
            }
        }
        let value =
            |name: &str| given.iter().find(|(known, _)| known == name).map(|(_, value)| *value as f32);
        let parameters =
            declared.iter().map(|parameter| value(&parameter.name).unwrap_or(parameter.default)).collect();
        let uniform =
            CustomUniform { spacing_m: grid.spacing_m() as f32, radius_m: brush.radius_m as f32, seed };
        Ok(Self { program, parameters, uniform })
    }

    /// Operations for one sample and instance at most.
    #[must_use]
    pub fn num_operations(&self) -> u64 {
        self.program.brush.num_operations
    }
}

pub(crate) fn data(rule: &CustomRule) -> OwnData {
    // A kernel without parameters has one that is not used.
    let parameters = if rule.parameters.is_empty() { &[0.0][..] } else { &rule.parameters };
    OwnData {
        uniforms: vec![bytemuck::cast_slice(parameters).to_vec(), bytemuck::bytes_of(&rule.uniform).to_vec()],
        ..OwnData::default()
    }
}
