//! A layer's mask painted anew: everywhere, nowhere, where something is selected; inverted; faded.

use orogeny_field::LayerContent;
use orogeny_store::{FieldKind, Layer};

use super::{Stack, check_share, refused};
use crate::Result;
use crate::operation::{MaskFrom, SetMask};

impl Stack<'_, '_> {
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
        Ok(self.recording.set_layer(Layer { ..layer })?)
    }
}
