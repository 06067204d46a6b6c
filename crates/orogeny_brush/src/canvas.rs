//! What a brush is applied to, and with what.

use std::sync::Arc;

use orogeny_field::{Bitmap, FieldId, PageLayout, TerrainGrid};

use crate::filter::cloning::CloneGround;
use crate::kernels::custom::CustomProgram;

/// What is painted on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Canvas {
    /// The terrain.
    pub grid: TerrainGrid,
    /// How its planes are cut.
    pub layout: PageLayout,
    /// The field whose pages are changed.
    pub field: FieldId,
    /// Whether that is a mask or a selection, whose values stay within 0..1.
    pub is_mask: bool,
    /// The heights that gates look at.
    pub heights: FieldId,
    /// The selection that gates look at.
    pub selection: FieldId,
}

impl Canvas {
    /// A field of heights, and no selection.
    #[must_use]
    pub const fn heights(grid: TerrainGrid, layout: PageLayout, field: FieldId) -> Self {
        // No field has this number: it reads as its constant.
        Self { grid, layout, field, is_mask: false, heights: field, selection: FieldId(u32::MAX) }
    }
}

/// Data from outside that a brush names.
#[derive(Debug, Clone, Default)]
pub struct Resources {
    /// The picture of its alpha.
    pub alpha: Option<Arc<Bitmap>>,
    /// The kernel that its user wrote.
    pub custom: Option<Arc<CustomProgram>>,
    /// The ground that it clones.
    pub clone_ground: Option<CloneGround>,
    /// The picture of its gate.
    pub gate_image: Option<Arc<Bitmap>>,
    /// The picture of its ground's hardness.
    pub hardness_image: Option<Arc<Bitmap>>,
    /// The picture of its noise's roughness.
    pub roughness_image: Option<Arc<Bitmap>>,
}
