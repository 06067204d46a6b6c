//! A layer's mask painted anew: everywhere, nowhere, where something is selected; inverted; faded.

use orogeny_field::{LayerContent, LayerReference, Procedure};
use orogeny_store::{FieldKind, Layer, MadeMask};

use super::{Stack, check_share, refused};
use crate::apply::paint;
use crate::hand::Known;
use crate::operation::{BrushOperation, MaskFrom, SetMask};
use crate::{Result, Target};

impl Stack<'_, '_, '_> {
    /// Changes what is painted of a mask, into a field of its own, and the terms after it.
    pub(super) fn set_mask(&mut self, set: &SetMask) -> Result<()> {
        let mut layer = self.layer(&set.layer)?;
        self.refuse_locked(&layer)?;
        check_share(&layer.name, "scale", set.scale)?;
        if let Some(terms) = &set.terms {
            layer.mask_terms.clone_from(terms);
        }
        if set.from == MaskFrom::Selection
            && layer.content == LayerContent::Heights
            && !layer.transform.is_identity()
        {
            let why = "its mask lies where it was moved to: collapse it first".to_owned();
            return Err(refused(&layer, "masked by the selection", why));
        }
        if let Some(brush) = &set.brush {
            let (invert, scale) = (set.invert, set.scale);
            self.recording.set_layer(layer.clone())?;
            return self.make_mask(&layer, brush, invert, scale);
        }
        let (from, constant) = match set.from {
            MaskFrom::Keep => (layer.mask, if layer.mask.is_some() { layer.mask_constant } else { 1.0 }),
            MaskFrom::All => (None, 1.0),
            MaskFrom::Nothing => (None, 0.0),
            MaskFrom::Selection => (self.recording.known_selection()?, 0.0),
        };
        // Of what was never painted only the constant counts: a replay need not have the field of a selection that was undone.
        let from = match from {
            Some(field) if self.recording.page_keys(field)?.is_empty() => None,
            from => from,
        };
        let changed = |value: f32| if set.invert { 1.0 - value } else { value } * set.scale;
        let is_kept = set.from == MaskFrom::Keep && !set.invert && set.scale == 1.0;
        if !is_kept {
            layer.made_mask = None;
            let constant = changed(constant);
            layer.mask = match from {
                // It counts everywhere, as without one.
                None if constant == 1.0 => None,
                None => Some(self.new_field(FieldKind::Mask, constant)?),
                Some(from) => {
                    let to = self.new_field(FieldKind::Mask, constant)?;
                    self.copy_changed(from, to, |page| {
                        page.samples_mut().iter_mut().for_each(|value| *value = changed(*value));
                    })?;
                    Some(to)
                }
            };
        }
        Ok(self.recording.set_layer(layer)?)
    }

    /// Paints a mask by a brush, over one that counts nowhere, and notes how.
    pub(super) fn make_mask(
        &mut self,
        layer: &Layer,
        brush: &Procedure,
        invert: bool,
        scale: f32,
    ) -> Result<()> {
        let layer = self.layer(&LayerReference::Id(layer.id))?;
        self.refuse_locked(&layer)?;
        let painted = self.new_field(FieldKind::Mask, 0.0)?;
        self.recording.set_layer(Layer { mask: Some(painted), mask_constant: 0.0, ..layer.clone() })?;
        let fill = BrushOperation::Fill {
            layer: Some(LayerReference::Id(layer.id)),
            target: Target::Mask,
            brush: (*brush.brush).clone(),
            seed: brush.seed,
            region_m: None,
        };
        self.written.extend(paint(&fill, &mut Known(None), self.site, self.recording)?.pages);
        let changed = |value: f32| if invert { 1.0 - value } else { value } * scale;
        let mut mask = painted;
        if invert || scale != 1.0 {
            mask = self.new_field(FieldKind::Mask, changed(0.0))?;
            self.copy_changed(painted, mask, |page| {
                page.samples_mut().iter_mut().for_each(|value| *value = changed(*value));
            })?;
        }
        let made_of = self.made_of(&layer, self.site.grid.bounds())?;
        let made_mask = Some(MadeMask { brush: brush.clone(), invert, scale, made_of });
        let mask_constant = changed(0.0);
        Ok(self.recording.set_layer(Layer { mask: Some(mask), mask_constant, made_mask, ..layer })?)
    }
}

/// Refuses brushes that do not paint masks by themselves.
pub(super) fn check_brush(layer: &Layer, procedure: &Procedure) -> Result<()> {
    let brush = &procedure.brush;
    brush.check()?;
    if brush.brush_type.is_for_masks() && brush.alpha.is_none() {
        return Ok(());
    }
    let why =
        format!("`{}` is no brush for masks, or has a bitmap that needs a stroke", brush.brush_type.name());
    Err(refused(layer, "masked", why))
}
