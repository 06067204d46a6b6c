//! Pages copied from field to field, and what a layer shows baked into its heights.

use orogeny_field::{
    Blend, FieldId, LayerContent, LayerReference, LayerTransform, Page, PageKey, Plane, SampleRect,
};
use orogeny_store::{Field, FieldKind, Layer};

use super::{Stack, refused};
use crate::Result;
use crate::composite::{self, Compositor, Look, Node, RecordingPages};
use crate::operation::CollapseLayer;
use crate::progress::report;

/// Pages that are copied or worked out at once.
const PAGES_AT_ONCE: usize = 32;
/// The most pages that are baked at once: as many as one operation of a brush may change.
const MAX_BAKED_PAGES: u64 = 1 << 20;

impl Stack<'_, '_, '_> {
    /// Hands over pages, and notes them as changed.
    pub(super) fn write(&mut self, pages: Vec<(PageKey, Page)>) -> Result<()> {
        self.written.extend(pages.iter().map(|(key, _)| *key));
        Ok(self.recording.write_pages(pages)?)
    }

    /// Copies all pages of a field to one that has none, and changes them on their way.
    pub(super) fn copy_changed(
        &mut self,
        from: FieldId,
        to: FieldId,
        change: impl Fn(&mut Page),
    ) -> Result<usize> {
        let keys = self.recording.page_keys(from)?;
        for (keys, done) in keys.chunks(PAGES_AT_ONCE).zip((0_u64..).step_by(PAGES_AT_ONCE)) {
            let mut pages = Vec::with_capacity(keys.len());
            for key in keys {
                if let Some(page) = self.recording.load_page(key)? {
                    let mut page = (*page).clone();
                    change(&mut page);
                    pages.push((PageKey { field: to, ..*key }, page));
                }
            }
            self.write(pages)?;
            report(self.site.observer, "copying", done + keys.len() as u64, 0)?;
        }
        Ok(keys.len())
    }

    pub(super) fn copy_field(&mut self, from: FieldId, to: FieldId) -> Result<()> {
        self.copy_changed(from, to, |_| {}).map(drop)
    }

    pub(super) fn new_field(&mut self, kind: FieldKind, constant: f32) -> Result<FieldId> {
        let field = Field { kind, constant };
        Ok(self.recording.with_transaction(move |transaction| transaction.add_field(field))?)
    }

    pub(super) fn copy_of_mask(&mut self, mask: FieldId, constant: f32) -> Result<FieldId> {
        let copy = self.new_field(FieldKind::Mask, constant)?;
        self.copy_field(mask, copy)?;
        Ok(copy)
    }

    /// Bakes what a layer shows into heights of its own.
    pub(super) fn collapse(&mut self, collapse: &CollapseLayer) -> Result<()> {
        let layer = self.layer(&collapse.layer)?;
        self.refuse_locked(&layer)?;
        if collapse.below {
            return self.collapse_below(&layer);
        }
        if layer.content == LayerContent::Group {
            return Err(refused(&layer, "collapsed", "it is a group: collapse its layers".to_owned()));
        }
        if layer.content == LayerContent::Heights && layer.transform.is_identity() {
            let why = "it is made of heights that lie where they are".to_owned();
            return Err(refused(&layer, "collapsed", why));
        }
        let layers = self.recording.layers().to_vec();
        let mut pages = RecordingPages::new(self.recording)?;
        let nodes = self.site.compositor.nodes(&layers, &mut pages)?;
        let node = composite::node(&layers, &layer, &mut pages)?;
        let below = nodes.get(..num_below(&layers, &nodes, layer.id)).unwrap_or_default();
        let mut baked = Layer {
            content: LayerContent::Heights,
            transform: LayerTransform::default(),
            blend: node.blend,
            made_of: None,
            ..layer.clone()
        };
        if !layer.content.is_kept() {
            baked.constant_m = layer.constant_m * layer.transform.height_scale as f32;
            baked.heights = self.new_field(FieldKind::Heights, baked.constant_m)?;
            self.bake(baked.heights, baked.constant_m, |compositor, look, rect| {
                compositor.layer_heights(look, below, &node, rect)
            })?;
        }
        if let Some(painted) =
            composite::painted_mask(&layer).filter(|painted| !painted.transform.is_identity())
        {
            let field = self.new_field(FieldKind::Mask, painted.constant)?;
            self.bake(field, painted.constant, |_, look, rect| composite::stored(look, &painted, rect))?;
            baked.mask = Some(field);
        }
        Ok(self.recording.set_layer(baked)?)
    }

    /// Bakes what a layer and all that is visible below it come to into the layer, which is the only one of them then.
    fn collapse_below(&mut self, layer: &Layer) -> Result<()> {
        let layers = self.recording.layers().to_vec();
        let mut pages = RecordingPages::new(self.recording)?;
        let nodes = self.site.compositor.nodes(&layers, &mut pages)?;
        let members = super::order::with_members(&layers, layer.id);
        let Some(last) = nodes.iter().rposition(|node| members.contains(&node.id)) else {
            return Err(refused(layer, "collapsed", "it is hidden".to_owned()));
        };
        let joined = nodes.get(..=last).unwrap_or_default();
        let is_joined = |id: u32| id == layer.id || joined.iter().any(|node| node.id == id);
        for other in &layers {
            if is_joined(other.id) {
                self.refuse_locked(other)?;
            }
            if !is_joined(other.id)
                && let Some(seen) = layers.iter().find(|seen| is_joined(seen.id) && looks_at(other, seen.id))
            {
                let why = format!("the mask of `{}` looks at `{}`: change that first", other.name, seen.name);
                return Err(refused(layer, "collapsed", why));
            }
        }
        let mut constant_m = [0.0];
        if joined.iter().all(Node::is_constant_without_pages) {
            joined.iter().for_each(|node| node.join_constant(&mut constant_m));
        }
        let [constant_m] = constant_m;
        let heights = self.new_field(FieldKind::Heights, constant_m)?;
        self.bake(heights, constant_m, |compositor, look, rect| compositor.heights(look, joined, rect))?;
        let lowest = joined.first().map_or(layer.id, |node| node.id);
        self.put_above(&[layer.id], super::order::below(&layers, lowest))?;
        for node in joined.iter().filter(|node| node.id != layer.id) {
            self.recording.remove_layer(node.id)?;
        }
        // What is hidden in a group that becomes a layer.
        for other in layers.iter().filter(|other| other.group == Some(layer.id) && !is_joined(other.id)) {
            let other = self.layer(&LayerReference::Id(other.id))?;
            self.recording.set_layer(Layer { group: layer.group, ..other })?;
        }
        // It is no group any more: what was hidden in it is in none.
        for hidden in self.recording.layers().to_vec() {
            if hidden.group == Some(layer.id) {
                self.recording.set_layer(Layer { group: None, ..hidden })?;
            }
        }
        let position = self.layer(&LayerReference::Id(layer.id))?.position;
        self.recording.set_layer(Layer {
            id: layer.id,
            position,
            name: layer.name.clone(),
            content: LayerContent::Heights,
            heights,
            constant_m,
            mask: None,
            mask_constant: 0.0,
            mask_terms: Vec::new(),
            visible: true,
            locked: false,
            opacity: 1.0,
            blend: Blend::Add,
            transform: LayerTransform::default(),
            group: None,
            made_of: None,
            made_mask: None,
        })?;
        self.remove_emptied_groups(&layers)
    }

    /// Takes the groups away of which nothing is left and that no mask looks at, and then those that these were in.
    fn remove_emptied_groups(&mut self, before: &[Layer]) -> Result<()> {
        let has_members = |layers: &[Layer], id: u32| layers.iter().any(|layer| layer.group == Some(id));
        loop {
            let layers = self.recording.layers();
            let is_emptied = |group: &&Layer| {
                let is_group = group.content == LayerContent::Group;
                let is_left = layers.iter().any(|other| looks_at(other, group.id));
                is_group && has_members(before, group.id) && !has_members(layers, group.id) && !is_left
            };
            let Some(emptied) = layers.iter().find(is_emptied).map(|group| group.id) else { return Ok(()) };
            self.recording.remove_layer(emptied)?;
        }
    }

    /// Writes what is worked out of the whole terrain, page by page, to a field that has none, where it is not its constant.
    fn bake(
        &mut self,
        field: FieldId,
        constant: f32,
        mut work_out: impl FnMut(&mut Compositor, &mut Look<'_>, SampleRect) -> Result<Plane>,
    ) -> Result<()> {
        let (layout, bounds) = (self.site.layout, self.site.grid.bounds());
        let num_pages = layout.num_pages_in(bounds);
        if num_pages > MAX_BAKED_PAGES {
            return Err(orogeny_brush::Error::TooManyPages { num_pages, limit: MAX_BAKED_PAGES }.into());
        }
        let mut num_done = 0;
        let mut baked = Vec::new();
        for (x, z) in layout.pages_in(bounds) {
            let key = PageKey::full_resolution(field, x, z);
            let page_rect = layout.page_rect(&key);
            let mut pages = RecordingPages::new(self.recording)?;
            let mut look = Look::new(self.site.grid, 0, &mut pages)?;
            let plane = work_out(self.site.compositor, &mut look, page_rect.intersection(&bounds))?;
            if plane.samples().iter().any(|sample| sample.to_bits() != constant.to_bits()) {
                baked.push((key, composite::page_of(&plane, layout, page_rect, constant)));
            }
            num_done += 1;
            if baked.len() >= PAGES_AT_ONCE {
                self.write(std::mem::take(&mut baked))?;
            }
            report(self.site.observer, "baking", num_done, num_pages)?;
        }
        self.write(baked)
    }
}

fn looks_at(layer: &Layer, id: u32) -> bool {
    layer.mask_terms.iter().any(|term| term.source.layer() == Some(&LayerReference::Id(id)))
}

/// How many of the nodes lie below a layer.
pub(super) fn num_below(layers: &[Layer], nodes: &[Node], id: u32) -> usize {
    let place = |id: u32| layers.iter().position(|layer| layer.id == id);
    nodes.iter().take_while(|node| place(node.id) < place(id)).count()
}
