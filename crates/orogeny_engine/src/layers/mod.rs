//! Changes of the layer stack. `order` is where layers lie, pure; `copy` copies and bakes pages; `mask` paints masks anew; `keep`
//! works out effects that are kept.

mod copy;
mod keep;
mod mask;
mod order;

use orogeny_field::{LayerContent, LayerReference, MAX_MASK_TERMS, MaskSource, MaskTerm, PageKey};
use orogeny_store::{Layer, NewLayer, Recording};

pub(crate) use keep::is_stale;

use crate::apply::Site;
use crate::composite::{self, with_groups};
use crate::operation::{
    AddLayer, DuplicateLayer, LayerOperation, MoveLayer, RefreshLayer, RemoveLayer, SetLayer, SetMask,
};
use crate::terrain::find_layer;
use crate::{Error, Result, resources};

/// The most layers of a terrain.
const MAX_LAYERS: usize = 256;

/// What an operation on layers works with.
pub(crate) struct Stack<'a, 'site, 'recorder> {
    pub(crate) site: &'a mut Site<'site>,
    pub(crate) recording: &'a mut Recording<'recorder>,
    /// Pages that were changed.
    pub(crate) written: Vec<PageKey>,
}

/// What it came to.
pub(crate) struct Changed {
    /// The operation as it is recorded.
    pub(crate) recorded: LayerOperation,
    /// The layer that it made.
    pub(crate) made_layer: Option<u32>,
}

impl Stack<'_, '_, '_> {
    /// Does an operation.
    ///
    /// # Errors
    /// [`Error::UnknownLayer`], [`Error::LayerNameTaken`], [`Error::LayerRefused`], [`Error::LayerLocked`] and the like; the recording is
    /// then to be dropped.
    pub(crate) fn apply(&mut self, operation: &LayerOperation) -> Result<Changed> {
        let mut operation = operation.clone();
        self.resolve(&mut operation)?;
        let made_layer = match &mut operation {
            LayerOperation::AddLayer(add) => {
                let made = self.add(add)?;
                add.id = Some(made);
                Some(made)
            }
            LayerOperation::SetLayer(set) => self.set(set).map(|()| None)?,
            LayerOperation::MoveLayer(to) => self.move_layer(to).map(|()| None)?,
            LayerOperation::RemoveLayer(remove) => self.remove(remove).map(|()| None)?,
            LayerOperation::DuplicateLayer(duplicate) => {
                let made = self.duplicate(duplicate)?;
                duplicate.id = Some(made);
                Some(made)
            }
            LayerOperation::CollapseLayer(collapse) => self.collapse(collapse).map(|()| None)?,
            LayerOperation::SetMask(set) => self.set_mask(set).map(|()| None)?,
            LayerOperation::RefreshLayer(RefreshLayer { layer }) => {
                let layer = self.layer(layer)?;
                self.refresh_all(&layer).map(|()| None)?
            }
        };
        Ok(Changed { recorded: operation, made_layer })
    }

    /// Names layers by their ids, and keeps data from outside.
    fn resolve(&mut self, operation: &mut LayerOperation) -> Result<()> {
        let layers = self.recording.layers();
        for reference in operation.layers_mut() {
            *reference = LayerReference::Id(find_layer(layers, Some(reference))?.id);
        }
        if let LayerOperation::SetMask(SetMask { layer, brush: Some(procedure), .. }) = operation {
            let layer = find_layer(self.recording.layers(), Some(layer))?;
            mask::check_brush(layer, procedure)?;
            let (brush, _) = resources::load(&procedure.brush, self.recording)?;
            *procedure.brush = orogeny_brush::resolved(&brush);
        }
        let (content, terms): (_, &mut [MaskTerm]) = match operation {
            LayerOperation::AddLayer(AddLayer { content, mask, .. }) => (Some(content), mask),
            LayerOperation::SetLayer(SetLayer { content, .. }) => (content.as_mut(), &mut []),
            LayerOperation::SetMask(set) => (None, set.terms.as_deref_mut().unwrap_or_default()),
            _ => return Ok(()),
        };
        if let Some(content) = content {
            content.check()?;
            if let Some(procedure) = content.procedure_mut() {
                let (brush, resources) = resources::load(&procedure.brush, self.recording)?;
                *procedure.brush = orogeny_brush::resolved(&brush);
                composite::check(self.site.grid, self.site.layout, procedure, resources, self.site.executor)?;
            }
        }
        if terms.len() > MAX_MASK_TERMS {
            let (field, value, high) = ("mask", terms.len() as f64, MAX_MASK_TERMS as f64);
            return Err(orogeny_field::Error::LayerValue { field, value, low: 0.0, high }.into());
        }
        for term in terms {
            term.check()?;
            composite::check_term(self.site.grid, term)?;
            match &mut term.source {
                MaskSource::Gate(gate) => {
                    resources::keep_image(gate, self.recording)?;
                    orogeny_brush::resolve_gate(gate);
                }
                MaskSource::Heights { layer, .. } => {
                    let layer = find_layer(self.recording.layers(), Some(layer))?;
                    if layer.content != LayerContent::Heights {
                        let why =
                            "a mask is made of the heights of a layer that is made of heights".to_owned();
                        return Err(refused(layer, "looked at by a mask", why));
                    }
                }
                MaskSource::Mask(_) => {}
            }
        }
        Ok(())
    }

    fn layer(&self, reference: &LayerReference) -> Result<Layer> {
        find_layer(self.recording.layers(), Some(reference)).cloned()
    }

    fn refuse_taken(&self, name: &str) -> Result<()> {
        if self.recording.layers().iter().any(|layer| layer.name == name) {
            return Err(Error::LayerNameTaken { name: name.to_owned() });
        }
        Ok(())
    }

    /// Makes a layer of a name that no other one has.
    fn make(&mut self, name: &str, constant_m: f32) -> Result<Layer> {
        self.refuse_taken(name)?;
        if self.recording.layers().len() >= MAX_LAYERS {
            return Err(Error::TooManyLayers { limit: MAX_LAYERS });
        }
        Ok(self.recording.add_layer(NewLayer { name: name.to_owned(), constant_m })?)
    }

    fn add(&mut self, add: &AddLayer) -> Result<u32> {
        check_share(&add.name, "opacity", add.opacity)?;
        add.transform.check()?;
        check_transform(&add.name, &add.content, &add.transform)?;
        if add.content != LayerContent::Heights && add.height != 0.0 {
            let (name, why) = (add.name.clone(), "it is not made of heights".to_owned());
            return Err(Error::LayerRefused { name, done: "given a `height`", why });
        }
        let group = self.group(add.group.as_ref())?;
        let made = self.make(&add.name, add.height)?;
        let layer = Layer {
            content: add.content.clone(),
            mask_terms: add.mask.clone(),
            visible: add.visible,
            locked: add.locked,
            opacity: add.opacity,
            blend: add.blend.unwrap_or(add.content.usual_blend()),
            transform: add.transform,
            group: group.as_ref().map(|group| group.id),
            ..made
        };
        self.recording.set_layer(layer.clone())?;
        let above = match (&add.above, &group) {
            (Some(above), _) => Some(self.layer(above)?.id),
            // At the top of its group, which its own row is.
            (None, Some(group)) => order::below(self.recording.layers(), group.id),
            (None, None) => order::below(self.recording.layers(), layer.id),
        };
        self.put_above(&[layer.id], above)?;
        if layer.content.is_kept() && !add.deferred {
            self.refresh(&layer)?;
        }
        Ok(layer.id)
    }

    fn set(&mut self, set: &SetLayer) -> Result<()> {
        let before = self.layer(&set.layer)?;
        let mut layer = before.clone();
        if let Some(name) = &set.name
            && *name != layer.name
        {
            self.refuse_taken(name)?;
            layer.name.clone_from(name);
        }
        if let Some(opacity) = set.opacity {
            check_share(&layer.name, "opacity", opacity)?;
            layer.opacity = opacity;
        }
        if let Some(content) = &set.content {
            if content.name() != layer.content.name() {
                let why = format!("its type is `{}`: add a layer of the other one", layer.content.name());
                return Err(refused(&layer, "made of something else", why));
            }
            layer.content = content.clone();
        }
        if let Some(transform) = set.transform {
            transform.check()?;
            check_transform(&layer.name, &layer.content, &transform)?;
            layer.transform = transform;
        }
        layer.visible = set.visible.unwrap_or(layer.visible);
        layer.locked = set.locked.unwrap_or(layer.locked);
        layer.blend = set.blend.unwrap_or(layer.blend);
        if layer.content != before.content || layer.transform != before.transform {
            self.refuse_locked(&before)?;
        }
        self.recording.set_layer(layer.clone())?;
        if layer.content.is_kept() && layer.content != before.content && !set.deferred {
            self.refresh(&layer)?;
        }
        Ok(())
    }

    fn move_layer(&mut self, to: &MoveLayer) -> Result<()> {
        let layer = self.layer(&to.layer)?;
        let group = self.group(to.group.as_ref())?;
        let moved = order::with_members(self.recording.layers(), layer.id);
        let is_own = |id: u32| moved.contains(&id);
        if group.as_ref().is_some_and(|group| is_own(group.id)) {
            return Err(refused(&layer, "moved", "a group cannot lie in itself".to_owned()));
        }
        if let Some(group) = &group {
            let layers = self.recording.layers();
            let depth = |layer: &Layer| with_groups(layers, layer).count();
            let members = layers.iter().filter(|member| is_own(member.id));
            let within = members.map(depth).max().unwrap_or_default() - depth(&layer);
            if depth(group) + within + 1 > composite::MAX_GROUP_DEPTH {
                let why = format!("groups lie in one another up to {} deep", composite::MAX_GROUP_DEPTH);
                return Err(refused(&layer, "moved", why));
            }
        }
        let above = to.above.as_ref().map(|above| self.layer(above)).transpose()?;
        if let Some(above) = above.as_ref().filter(|above| is_own(above.id)) {
            let why = format!("it, or the group that it is, has `{}` in it", above.name);
            return Err(refused(&layer, "moved", why));
        }
        self.recording.set_layer(Layer { group: group.map(|group| group.id), ..layer })?;
        self.put_above(&moved, above.map(|above| above.id))
    }

    fn remove(&mut self, remove: &RemoveLayer) -> Result<()> {
        let layer = self.layer(&remove.layer)?;
        let mut removed = vec![layer.id];
        if remove.members {
            removed = order::with_members(self.recording.layers(), layer.id);
        }
        for id in &removed {
            self.refuse_locked(&self.layer(&LayerReference::Id(*id))?)?;
        }
        let is_left = |other: &&Layer| other.content != LayerContent::Group && !removed.contains(&other.id);
        if self.recording.layers().iter().find(is_left).is_none() {
            return Err(refused(&layer, "removed", "a terrain has at least one layer".to_owned()));
        }
        for other in self.recording.layers().to_vec() {
            let is_looked_at = |term: &MaskTerm| matches!(term.source.layer(), Some(LayerReference::Id(id)) if removed.contains(id));
            if removed.contains(&other.id) {
                continue;
            }
            if other.mask_terms.iter().any(is_looked_at) {
                let why = format!("the mask of `{}` looks at it: change that first", other.name);
                return Err(refused(&layer, "removed", why));
            }
            if other.group == Some(layer.id) {
                self.recording.set_layer(Layer { group: layer.group, ..other })?;
            }
        }
        for id in removed {
            self.recording.remove_layer(id)?;
        }
        Ok(())
    }

    fn duplicate(&mut self, duplicate: &DuplicateLayer) -> Result<u32> {
        let layer = self.layer(&duplicate.layer)?;
        if layer.content == LayerContent::Group {
            return Err(refused(&layer, "copied", "it is a group: copy its layers".to_owned()));
        }
        let name =
            duplicate.name.clone().unwrap_or_else(|| order::copy_name(self.recording.layers(), &layer.name));
        let made = self.make(&name, layer.constant_m)?;
        let mut copy = Layer {
            id: made.id,
            position: made.position,
            name,
            heights: made.heights,
            mask: None,
            locked: false,
            ..layer.clone()
        };
        self.copy_field(layer.heights, made.heights)?;
        if let Some(mask) = layer.mask {
            copy.mask = Some(self.copy_of_mask(mask, layer.mask_constant)?);
        }
        self.recording.set_layer(copy.clone())?;
        self.put_above(&[copy.id], Some(layer.id))?;
        Ok(copy.id)
    }

    fn group(&self, reference: Option<&LayerReference>) -> Result<Option<Layer>> {
        let Some(reference) = reference else { return Ok(None) };
        let group = self.layer(reference)?;
        if group.content != LayerContent::Group {
            let why = "it is no group: add one, with the content `group`".to_owned();
            return Err(refused(&group, "given layers", why));
        }
        let depth = with_groups(self.recording.layers(), &group).count();
        if depth > composite::MAX_GROUP_DEPTH - 1 {
            let why = format!("groups lie in one another up to {} deep", composite::MAX_GROUP_DEPTH);
            return Err(refused(&group, "given layers", why));
        }
        Ok(Some(group))
    }

    /// Puts layers, in their order, above another one, or below all.
    fn put_above(&mut self, moved: &[u32], above: Option<u32>) -> Result<()> {
        let layers = self.recording.layers().to_vec();
        let order = order::put_above(&layers, moved, above);
        for (position, id) in (0..).zip(order) {
            if let Some(layer) = layers.iter().find(|layer| layer.id == id && layer.position != position) {
                self.recording.set_layer(Layer { position, ..layer.clone() })?;
            }
        }
        Ok(())
    }

    fn refuse_locked(&self, layer: &Layer) -> Result<()> {
        refuse_locked(self.recording.layers(), layer)
    }
}

/// Refuses a layer that is locked, or in a group that is.
pub(crate) fn refuse_locked(layers: &[Layer], layer: &Layer) -> Result<()> {
    match with_groups(layers, layer).find(|layer| layer.locked) {
        Some(locked) => Err(Error::LayerLocked { name: locked.name.clone() }),
        None => Ok(()),
    }
}

pub(crate) fn refused(layer: &Layer, done: &'static str, why: String) -> Error {
    Error::LayerRefused { name: layer.name.clone(), done, why }
}

fn check_share(name: &str, field: &'static str, value: f32) -> Result<()> {
    if (0.0..=1.0).contains(&value) {
        Ok(())
    } else {
        Err(Error::LayerShare { name: name.to_owned(), field, value })
    }
}

fn check_transform(
    name: &str,
    content: &LayerContent,
    transform: &orogeny_field::LayerTransform,
) -> Result<()> {
    if transform.is_identity() || *content == LayerContent::Heights {
        return Ok(());
    }
    let why = match content {
        LayerContent::Procedural(_) => {
            "it has no heights of its own: change its brush, a noise by `offset`, `rotation` and `feature_size`"
        }
        LayerContent::Effect(_) => "it has no heights of its own, and works where its mask is",
        _ => "it is a group: move its layers",
    };
    Err(Error::LayerRefused { name: name.to_owned(), done: "moved, turned or enlarged", why: why.to_owned() })
}
