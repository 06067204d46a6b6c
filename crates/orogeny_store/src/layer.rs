//! Layers as the store keeps them.

use orogeny_field::{FieldId, check_height};

use crate::{Error, Result};

/// The longest layer name, in bytes of UTF-8.
pub const MAX_LAYER_NAME_BYTES: usize = 255;

/// What a field's samples mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FieldKind {
    /// Heights of a layer, in metres.
    Heights,
    /// How much of a layer counts where, 0..1.
    Mask,
    /// What is selected, 0..1.
    Selection,
}

impl FieldKind {
    const ALL: [Self; 3] = [Self::Heights, Self::Mask, Self::Selection];

    /// As the `kind` column has it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Heights => "heights",
            Self::Mask => "mask",
            Self::Selection => "selection",
        }
    }

    pub(crate) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A sampled plane of the terrain.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Field {
    /// What its samples mean.
    pub kind: FieldKind,
    /// What they are where it has no page.
    pub constant: f32,
}

/// How a layer's heights join those below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Blend {
    /// The sum of both.
    #[default]
    Add,
    /// What is below, less the layer.
    Subtract,
    /// The higher of the two.
    Max,
    /// The lower of the two.
    Min,
    /// The product of both.
    Multiply,
    /// The layer alone.
    Replace,
    /// Both, band by band of their Laplacian pyramids.
    Laplacian,
}

/// An entry of the layer stack.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Never used twice in a terrain, not even after the layer was undone.
    pub id: u32,
    /// Place in the stack, from 0 at the bottom.
    pub position: u32,
    /// What the user calls it.
    pub name: String,
    /// The field that holds its heights.
    pub heights: FieldId,
    /// Its height wherever it has no page, in metres. The field's, so it is not part of the layer's own record.
    #[serde(skip)]
    pub constant_m: f32,
    /// The field that holds its mask; `None`: it counts everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<FieldId>,
    /// Whether it counts.
    pub visible: bool,
    /// How much it counts, 0..1.
    pub opacity: f32,
    /// How it joins the layers below.
    pub blend: Blend,
}

impl Layer {
    /// As the file has it: JSON.
    pub(crate) fn to_state(&self) -> Result<String> {
        serde_json::to_string(self).map_err(|err| Error::Operation { detail: err.to_string() })
    }
}

/// A layer to be made: visible, opaque, added to what is below, on top of the stack.
#[derive(Debug, Clone, PartialEq)]
pub struct NewLayer {
    /// What the user calls it: 1 to [`MAX_LAYER_NAME_BYTES`] bytes.
    pub name: String,
    /// Its height before anything is painted, in metres within ±1e7.
    pub constant_m: f32,
}

impl NewLayer {
    /// Checks name and constant; a denormal constant, and -0, becomes +0.
    pub(crate) fn checked(&self) -> Result<Self> {
        check_name(&self.name)?;
        let constant_m = check_height(&format!("the layer `{}`", self.name), self.constant_m)?;
        Ok(Self { name: self.name.clone(), constant_m })
    }
}

/// Refuses names that are empty or too long.
pub(crate) fn check_name(name: &str) -> Result<()> {
    let length = name.len();
    if (1..=MAX_LAYER_NAME_BYTES).contains(&length) {
        Ok(())
    } else {
        Err(Error::LayerName { length, limit: MAX_LAYER_NAME_BYTES })
    }
}
