//! Stacks worked out plainly: whole planes of one level, layer after layer, in `f64`, by the table of blends and by what the types of
//! layers and masks say of themselves.
//!
//! Nothing of it is the engine's but the stored pages. What a brush makes comes from the CPU executor on one page as large as the
//! terrain. What lies below a layer is given to it: that it was right is for whoever gives it to show.

mod blur;
mod brush;
mod gate;
mod place;
mod pyramid;
mod sheet;

pub use gate::{Ground, let_through};
pub use sheet::Sheet;

use orogeny_engine::{Layer, LayerReference, TerrainGrid};
use orogeny_field::{
    Blend, FieldId, LayerContent, LayerTransform, MAX_HEIGHT_M, MaskCombine, MaskSource, MaskTerm, PageKey,
};
use orogeny_store::{FieldKind, Store};

/// Places at which a curve's values are looked up, between which it is straight.
const CURVE_PLACES: f64 = 255.0;

/// A terrain at one level.
pub struct Plain<'a> {
    pub store: &'a Store,
    pub layers: &'a [Layer],
    pub level: u8,
}

impl Plain<'_> {
    /// What all visible layers come to, from the bottom.
    pub fn composite(&self) -> Sheet {
        self.lowest(self.layers.len())
    }

    /// What all visible layers below one come to.
    pub fn below(&self, layer: &Layer) -> Sheet {
        self.lowest(self.layers.iter().position(|other| other.id == layer.id).unwrap())
    }

    fn lowest(&self, count: usize) -> Sheet {
        let is_seen = |layer: &&Layer| layer.content != LayerContent::Group && self.is_visible(layer);
        let seen = self.layers[..count].iter().filter(is_seen);
        seen.fold(self.constant(0.0), |below, layer| self.joined(layer, &below))
    }

    /// Whether a layer counts.
    pub fn is_visible(&self, layer: &Layer) -> bool {
        self.with_groups(layer).iter().all(|layer| layer.visible)
    }

    /// The samples of the level.
    pub fn grid(&self) -> TerrainGrid {
        let bounds = self.store.grid().bounds_at(self.level);
        let spacing_m = self.store.grid().spacing_m() * f64::from(1_u32 << self.level);
        TerrainGrid::new(bounds.width().into(), bounds.depth().into(), spacing_m).unwrap()
    }

    fn with_groups<'b>(&'b self, layer: &'b Layer) -> Vec<&'b Layer> {
        let mut chain = vec![layer];
        while let Some(group) = chain.last().unwrap().group {
            chain.push(self.layers.iter().find(|layer| layer.id == group).unwrap());
        }
        chain
    }

    /// What a layer makes of what is below it.
    pub fn joined(&self, layer: &Layer, below: &Sheet) -> Sheet {
        let heights = self.content(layer, below);
        let mut weights = self.masks(layer, below);
        for layer in self.with_groups(layer) {
            weights = weights.times(&self.constant(layer.opacity));
        }
        // What was kept of an effect is a difference.
        let blend = if layer.content.is_kept() { Blend::Add } else { layer.blend };
        join(below, &heights, &weights, blend)
    }

    /// What a layer alone is made of.
    pub fn content(&self, layer: &Layer, below: &Sheet) -> Sheet {
        let nowhere = LayerTransform::default();
        match &layer.content {
            LayerContent::Heights => self.placed(layer.heights, layer.constant_m, &layer.transform),
            LayerContent::Effect(_) if layer.content.is_kept() => {
                self.placed(layer.heights, layer.constant_m, &nowhere)
            }
            LayerContent::Procedural(procedure) => {
                let flat = self.constant(0.0);
                brush::brushed(self, procedure, &flat).unwrap_or(flat)
            }
            LayerContent::Effect(procedure) => {
                brush::brushed(self, procedure, below).unwrap_or_else(|| below.clone())
            }
            LayerContent::Group => panic!("a group has no heights"),
        }
    }

    /// How much a layer counts by its mask and those of its groups.
    pub fn masks(&self, layer: &Layer, below: &Sheet) -> Sheet {
        let masks = self.with_groups(layer).into_iter().map(|layer| self.own_mask(layer, below));
        masks.fold(self.constant(1.0), |weights, mask| weights.times(&mask))
    }

    fn own_mask(&self, layer: &Layer, below: &Sheet) -> Sheet {
        let mut mask = self.painted_mask(layer);
        for term in &layer.mask_terms {
            let values = self.term(term, below);
            mask = combined(&mask, &values, term.combine);
        }
        mask
    }

    /// A layer's mask moves with its heights.
    fn painted_mask(&self, layer: &Layer) -> Sheet {
        let Some(field) = layer.mask else { return self.constant(1.0) };
        let transform = LayerTransform { height_scale: 1.0, ..layer.transform };
        self.placed(field, layer.mask_constant, &transform)
    }

    fn term(&self, term: &MaskTerm, below: &Sheet) -> Sheet {
        let other = |reference: &LayerReference| {
            let LayerReference::Id(id) = reference else { panic!("{reference:?} is no id") };
            self.layers.iter().find(|layer| layer.id == *id).unwrap()
        };
        let values = match &term.source {
            MaskSource::Gate(gate) => gate::values(self, gate, below),
            MaskSource::Heights { layer, low, high } => {
                let layer = other(layer);
                let heights = self.placed(layer.heights, layer.constant_m, &layer.transform);
                heights
                    .map(1.0 / (high - low).abs(), |height| ((height - low) / (high - low)).clamp(0.0, 1.0))
            }
            MaskSource::Mask(layer) => self.painted_mask(other(layer)),
        };
        let values = blur::blurred(&values, term.blur_m / self.grid().spacing_m());
        let values = values.map(1.0, |value| value.clamp(0.0, 1.0));
        let values = if term.is_inverted { values.map(1.0, |value| 1.0 - value) } else { values };
        let Some(curve) = &term.curve else { return values };
        let value = |place: f64| curve.value(place / CURVE_PLACES);
        // A monotone cubic is at most three times as steep as the chords on both sides.
        let chords =
            curve.points().windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        let steepness = 3.0 * chords.fold(0.0, |steepest: f64, slope| steepest.max(slope.abs()));
        values.map(steepness, |share| {
            let place = (share * CURVE_PLACES).floor();
            let after = share * CURVE_PLACES - place;
            (value(place) + after * (value(place + 1.0) - value(place))).clamp(0.0, 1.0)
        })
    }

    fn selection(&self) -> Sheet {
        let mut fields = self.store.fields().iter();
        match fields.find(|(_, field)| field.kind == FieldKind::Selection) {
            Some((field, _)) => self.stored(*field, 0.0, self.level),
            None => self.constant(0.0),
        }
    }

    fn placed(&self, field: FieldId, constant: f32, transform: &LayerTransform) -> Sheet {
        if transform.is_identity() {
            return self.stored(field, constant, self.level);
        }
        place::placed(self, transform, f64::from(constant), |level| self.stored(field, constant, level))
    }

    /// A field at a level, from its pages.
    fn stored(&self, field: FieldId, constant: f32, level: u8) -> Sheet {
        let bounds = self.store.grid().bounds_at(level);
        let mut sheet = Sheet::constant(bounds.width() as usize, bounds.depth() as usize, constant.into());
        let layout = self.store.layout();
        for (x, z) in layout.pages_in(bounds) {
            let key = PageKey { field, level, z, x };
            let Some(page) = self.store.load_page(&key).unwrap() else { continue };
            let origin = layout.page_rect(&key);
            let inside = origin.intersection(&bounds);
            for z in inside.z0..inside.z1 {
                let (x0, x1) = (inside.x0.abs_diff(origin.x0), inside.x1.abs_diff(origin.x0));
                let row = page.row(z.abs_diff(origin.z0), x0, x1).unwrap();
                for (x, value) in (inside.x0..inside.x1).zip(row) {
                    *sheet.at_mut(x, z) = f64::from(*value);
                }
            }
        }
        sheet
    }

    fn constant(&self, value: f32) -> Sheet {
        let grid = self.grid();
        Sheet::constant(grid.width() as usize, grid.depth() as usize, value.into())
    }
}

fn combined(mask: &Sheet, term: &Sheet, combine: MaskCombine) -> Sheet {
    match combine {
        MaskCombine::Multiply => mask.times(term),
        MaskCombine::Add => mask.zip(term, |mask, term| (mask + term).min(1.0)).off_by_both(mask, term),
        MaskCombine::Subtract => mask.zip(term, |mask, term| (mask - term).max(0.0)).off_by_both(mask, term),
        MaskCombine::Max => mask.zip(term, f64::max).off_by(mask.off.max(term.off)),
        MaskCombine::Min => mask.zip(term, f64::min).off_by(mask.off.max(term.off)),
    }
}

/// A layer joined to what is below it, as the table of blends has it.
pub fn join(below: &Sheet, heights: &Sheet, weights: &Sheet, blend: Blend) -> Sheet {
    let is_whole = weights.off == 0.0 && weights.values.iter().all(|weight| *weight == 1.0);
    let joined = match blend {
        Blend::Add | Blend::Subtract => {
            let sign = if blend == Blend::Add { 1.0 } else { -1.0 };
            let by_weight = weights.off * heights.largest() + weights.largest() * heights.off;
            below.zip3(heights, weights, |c, h, w| c + sign * w * h).off_by(below.off + by_weight)
        }
        Blend::Laplacian => pyramid::blended(below, heights, weights),
        _ => {
            let goal = match blend {
                Blend::Max => below.zip(heights, f64::max).off_by(below.off.max(heights.off)),
                Blend::Min => below.zip(heights, f64::min).off_by(below.off.max(heights.off)),
                Blend::Multiply => below.zip(heights, |c, h| height(c * h)).off_by_both_times(below, heights),
                _ => heights.clone(),
            };
            let apart = below.zip(&goal, |c, goal| goal - c).largest();
            // A weight of 1 gives the goal itself.
            let pulled = |c: f64, goal: f64, w: f64| if w == 1.0 { goal } else { c + w * (goal - c) };
            below.zip3(&goal, weights, pulled).off_by(below.off.max(goal.off) + weights.off * apart)
        }
    };
    // The engine rounds each product and each sum, this once.
    let is_exact = is_whole && joined.off == 0.0 && blend != Blend::Laplacian;
    let rounding = if is_exact { 0.0 } else { sheet::ulps(4.0, below.largest().max(heights.largest())) };
    let off = joined.off + rounding;
    let mut rounded = joined;
    rounded.values.iter_mut().for_each(|value| *value = height(*value));
    rounded.off_by(off)
}

/// A height as a terrain has it.
fn height(height_m: f64) -> f64 {
    let height_m = height_m as f32;
    if height_m.is_subnormal() { 0.0 } else { f64::from(height_m.clamp(-MAX_HEIGHT_M, MAX_HEIGHT_M)) + 0.0 }
}
