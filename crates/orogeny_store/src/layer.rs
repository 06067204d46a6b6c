//! Layers as the store keeps them.

use orogeny_field::{Blend, FieldId, LayerContent, LayerTransform, MaskTerm, Procedure, check_height};

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
    /// What it is made of.
    #[serde(default, skip_serializing_if = "is_heights")]
    pub content: LayerContent,
    /// The field that holds its heights; of a layer that is not made of heights, what was kept of it.
    pub heights: FieldId,
    /// Its height wherever it has no page, in metres. The field's, so it is not part of the layer's own record.
    #[serde(skip)]
    pub constant_m: f32,
    /// The field that holds its mask; `None`: it counts everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<FieldId>,
    /// How much it counts where its mask has no page. The field's, as `constant_m` is.
    #[serde(skip)]
    pub mask_constant: f32,
    /// Where it counts besides that, worked out from what lies below; in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mask_terms: Vec<MaskTerm>,
    /// Whether it counts.
    pub visible: bool,
    /// Whether it is protected from being painted on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
    /// How much it counts, 0..1.
    pub opacity: f32,
    /// How it joins the layers below.
    pub blend: Blend,
    /// Where its heights lie.
    #[serde(default, skip_serializing_if = "LayerTransform::is_identity")]
    pub transform: LayerTransform,
    /// The group that it is in, by that layer's id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<u32>,
    /// Of an effect that is kept: what it was made of, so that a change of that can be seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_of: Option<MadeOf>,
    /// Of a mask that a brush made: how, so that it can be made anew.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_mask: Option<MadeMask>,
}

/// A painted mask that a brush made, and how.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MadeMask {
    /// The brush, as a fill of the whole terrain.
    pub brush: Procedure,
    /// Whether it was inverted then.
    pub invert: bool,
    /// What it was multiplied by then.
    pub scale: f32,
    /// What it was made of.
    pub made_of: MadeOf,
}

/// What an effect that is kept was made of.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MadeOf {
    /// The entry of the history that made it: what was changed later it does not show.
    pub entry: u32,
    /// The samples that it was made for, `[x0, z0, x1, z1]`, the far edges outside.
    pub region: [i32; 4],
    /// The hash of its brush, and of all layers below with their settings.
    pub layers: String,
}

fn is_heights(content: &LayerContent) -> bool {
    *content == LayerContent::Heights
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
