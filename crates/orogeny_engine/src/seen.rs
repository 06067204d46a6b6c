//! The terrain as it is seen up to a layer, for brushes to look at and to work on.
//!
//! A layer that adds to what is below it holds the difference only. A brush that looks at heights, to smooth them, to level
//! them, to erode them, means those that are seen; so it is given them as though they were a field of the terrain, and of what it
//! makes of them the layer keeps the difference: with what is below `B`, how much the layer counts `w`, and `C'` what
//! the brush made, `(C' - B) / w`.

use std::collections::BTreeSet;

use orogeny_brush::Spill;
use orogeny_field::{
    Blend, BrushType, FieldId, LayerContent, Page, PageKey, PageLayout, Plane, TerrainGrid, sanitized_height,
};
use orogeny_store::{Layer, Recording};

use crate::Result;
use crate::composite::{self, Compositor, Look, Node, RecordingPages};

/// What is seen, as a field; no terrain has one of this number.
pub(crate) const SEEN: FieldId = FieldId(u32::MAX - 5);

/// Where a layer counts for less than this, nothing that is painted on it would be seen for what it is: its heights stay.
const MIN_WEIGHT: f32 = 0.05;

/// What is seen before an operation, and what the operation has made of it so far.
pub(crate) struct Seen<'a> {
    grid: TerrainGrid,
    layout: PageLayout,
    compositor: &'a mut Compositor,
    nodes: Vec<Node>,
    /// The field that keeps what is painted on the last of the nodes.
    heights: FieldId,
    /// Pages as the brush made them: what the layer keeps of them would not come to the same bits.
    made: Spill,
    asked_for: BTreeSet<PageKey>,
}

impl<'a> Seen<'a> {
    /// What is seen up to a layer, whether that is hidden or not; of the selection, all of it. `None` where that is what the layer's own field
    /// holds.
    pub(crate) fn of(
        layer: &Layer,
        is_of_all: bool,
        grid: TerrainGrid,
        compositor: &'a mut Compositor,
        recording: &mut Recording<'_>,
    ) -> Result<Option<Self>> {
        let layers = recording.layers().to_vec();
        let mut pages = RecordingPages::before(recording)?;
        let all = compositor.nodes(&layers, &mut pages)?;
        let nodes = if is_of_all {
            all.to_vec()
        } else {
            let place = |id: u32| layers.iter().position(|layer| layer.id == id);
            let mut nodes: Vec<Node> =
                all.iter().take_while(|node| place(node.id) < place(layer.id)).cloned().collect();
            if layer.content == LayerContent::Heights {
                nodes.push(composite::node(&layers, layer, &mut pages)?);
            }
            nodes
        };
        let is_own = matches!(nodes.as_slice(), [only] if only.is_field(layer.heights));
        let layout = recording.layout()?;
        let made = Spill::new(layout);
        let (heights, asked_for) = (layer.heights, BTreeSet::new());
        Ok((!is_own).then_some(Self { grid, layout, compositor, nodes, heights, made, asked_for }))
    }

    /// The pages that were asked for: an executor has them under keys that mean something else next time.
    pub(crate) fn into_asked_for(self) -> Vec<PageKey> {
        self.asked_for.into_iter().collect()
    }

    /// A page as it was before the operation.
    pub(crate) fn load_before(&mut self, key: &PageKey, recording: &mut Recording<'_>) -> Result<Page> {
        self.asked_for.insert(*key);
        self.page(key, recording, |compositor, look, nodes, rect| compositor.heights(look, nodes, rect))
    }

    /// A page as the operation has made it so far.
    pub(crate) fn load(&mut self, key: &PageKey, recording: &mut Recording<'_>) -> Result<Page> {
        match self.made.take(key)? {
            Some(page) => {
                self.made.put(*key, &page)?;
                Ok(page)
            }
            None => self.load_before(key, recording),
        }
    }

    /// Keeps pages that the brush made, and gives what the layer keeps of them.
    pub(crate) fn save(
        &mut self,
        pages: Vec<(PageKey, Page)>,
        recording: &mut Recording<'_>,
    ) -> Result<Vec<(PageKey, Page)>> {
        let mut kept = Vec::with_capacity(pages.len());
        for (key, made) in pages {
            let before = self.load_before(&key, recording)?;
            let below = self.page(&key, recording, |compositor, look, nodes, rect| {
                let (_, below) = nodes.split_last().unzip();
                compositor.heights(look, below.unwrap_or_default(), rect)
            })?;
            let weights =
                self.page(&key, recording, |compositor, look, nodes, rect| match nodes.split_last() {
                    Some((node, below)) => compositor.layer_weights(look, below, node, rect),
                    None => Ok(Plane::constant(rect, 1.0)),
                })?;
            let own = PageKey { field: self.heights, ..key };
            let mut heights = self.page(&key, recording, |_, look, nodes, rect| match nodes.last() {
                Some(node) => node.stored_heights(look, rect),
                None => Ok(Plane::constant(rect, 0.0)),
            })?;
            let samples = made
                .samples()
                .iter()
                .zip(before.samples())
                .zip(below.samples().iter().zip(weights.samples()));
            for (height, ((made, before), (below, weight))) in heights.samples_mut().iter_mut().zip(samples) {
                // Where the brush did nothing, the layer keeps its bits.
                if made.to_bits() != before.to_bits() && *weight >= MIN_WEIGHT {
                    *height = sanitized_height((made - below) / weight);
                }
            }
            self.made.put(key, &made)?;
            kept.push((own, heights));
        }
        Ok(kept)
    }

    fn page(
        &mut self,
        key: &PageKey,
        recording: &mut Recording<'_>,
        work_out: impl FnOnce(&mut Compositor, &mut Look<'_>, &[Node], orogeny_field::SampleRect) -> Result<Plane>,
    ) -> Result<Page> {
        let page_rect = self.layout.page_rect(key);
        let mut pages = RecordingPages::before(recording)?;
        let mut look = Look::new(self.grid, 0, &mut pages)?;
        let rect = page_rect.intersection(&self.grid.bounds());
        let plane = work_out(self.compositor, &mut look, &self.nodes, rect)?;
        Ok(composite::page_of(&plane, self.layout, page_rect, 0.0))
    }
}

/// Whether a brush changes heights by what they are. Others add the same to whatever is there.
pub(crate) const fn works_on_heights(brush_type: BrushType) -> bool {
    !matches!(brush_type, BrushType::Raise | BrushType::Lower | BrushType::Roughen | BrushType::Noise)
}

/// Whether what a brush makes of what is seen can be kept by a layer.
pub(crate) fn keeps_difference(layer: &Layer) -> bool {
    layer.content == LayerContent::Heights && layer.blend == Blend::Add
}
