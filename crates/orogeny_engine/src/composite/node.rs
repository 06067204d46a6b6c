//! A layer as it counts: with all groups that it is in, and all that it is made of at hand.

use std::sync::Arc;

use orogeny_brush::Resources;
use orogeny_field::{
    Bitmap, Blend, Brush, CurveTable, DataSource, FieldId, Gate, LayerContent, LayerReference,
    LayerTransform, MaskCombine, MaskSource, MaskTerm, Plane, Procedure, SampleRect,
};
use orogeny_reference::field::compose;
use orogeny_store::Layer;

use super::content::stored;
use super::{FieldPages, Look};
use crate::{Error, Result, resources};

/// Groups that lie in one another, at most; also ends a chain that damage closed to a ring.
pub(crate) const MAX_GROUP_DEPTH: usize = 16;

/// A stored field as it lies on the terrain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stored {
    pub(crate) field: FieldId,
    /// Its value where it has no page.
    pub(crate) constant: f32,
    pub(crate) transform: LayerTransform,
}

/// A brush with all data from outside that it names.
#[derive(Debug, Clone)]
pub(crate) struct Live {
    pub(crate) brush: Brush,
    pub(crate) seed: u32,
    pub(crate) resources: Resources,
}

/// What a layer is made of.
#[derive(Debug, Clone)]
pub(crate) enum Content {
    /// Heights.
    Heights(Stored),
    /// The difference that an effect made to what was below when it was worked out.
    Kept(Stored),
    /// What a brush makes of flat ground.
    Procedural(Live),
    /// What a brush makes of what is below.
    Effect(Live),
}

/// What a term of a mask is worked out from.
#[derive(Debug, Clone)]
pub(crate) enum TermSource {
    Gate {
        gate: Box<Gate>,
        image: Option<Arc<Bitmap>>,
    },
    Heights {
        heights: Stored,
        low: f64,
        high: f64,
    },
    /// `None`: it counts everywhere.
    Mask(Option<Stored>),
}

#[derive(Debug, Clone)]
pub(crate) struct Term {
    pub(crate) source: TermSource,
    pub(crate) blur_m: f64,
    pub(crate) is_inverted: bool,
    pub(crate) curve: Option<Box<CurveTable>>,
    pub(crate) combine: MaskCombine,
}

/// The mask of a layer or of a group: terms after what is painted, which is 1 everywhere for none.
#[derive(Debug, Clone)]
pub(crate) struct Mask {
    pub(crate) painted: Option<Stored>,
    pub(crate) terms: Vec<Term>,
}

/// A visible layer.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) id: u32,
    pub(crate) content: Content,
    pub(crate) blend: Blend,
    pub(crate) opacity: f32,
    /// Its own, and those of its groups.
    pub(crate) masks: Vec<Mask>,
    /// All layers that it is made of, without what does not count: it is the same as long as they are.
    basis: Vec<Layer>,
}

impl Node {
    /// Whether it comes to the same as another one.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.basis == other.basis
    }

    /// Whether what it comes to depends on samples around, or takes long: it is worked out in pages, which are kept.
    pub(crate) fn is_barrier(&self) -> bool {
        let looks_below = match &self.content {
            Content::Heights(_) | Content::Kept(_) => false,
            Content::Procedural(live) => live.looks_at_terrain(),
            Content::Effect(_) => true,
        };
        looks_below || self.blend == Blend::Laplacian || !self.has_painted_masks_only()
    }

    /// Whether its masks are stored, all of them.
    pub(crate) fn has_painted_masks_only(&self) -> bool {
        self.masks.iter().all(|mask| mask.terms.is_empty())
    }

    /// Whether it counts the same everywhere.
    pub(crate) fn is_unmasked(&self) -> bool {
        self.masks.is_empty()
    }

    /// Whether what it comes to is the same wherever none of its fields has a page.
    pub(crate) fn is_constant_without_pages(&self) -> bool {
        let is_stored = matches!(self.content, Content::Heights(_) | Content::Kept(_));
        is_stored && !self.is_barrier() && self.fields().all(|stored| stored.transform.is_identity())
    }

    /// Joins it, where none of its fields has a page, to a height below it. Nothing where that differs from place to place.
    pub(crate) fn join_constant(&self, height_m: &mut [f32; 1]) {
        let (Content::Heights(heights) | Content::Kept(heights), true) =
            (&self.content, self.is_constant_without_pages())
        else {
            return;
        };
        let masks = self.masks.iter().filter_map(|mask| mask.painted.as_ref());
        let weight = masks.fold(1.0, |weight, mask| weight * mask.constant) * self.opacity;
        compose::row(height_m, &[heights.constant], &[weight], self.blend);
    }

    /// As it is with an opacity of 1.
    pub(crate) fn opaque(&self) -> Self {
        Self { opacity: 1.0, ..self.clone() }
    }

    /// Whether it is a field as it is, and counts fully everywhere.
    pub(crate) fn is_field(&self, field: FieldId) -> bool {
        let is_it = matches!(&self.content, Content::Heights(heights) if heights.field == field);
        is_it
            && self.blend == Blend::Add
            && self.opacity == 1.0
            && self.is_unmasked()
            && self.is_constant_without_pages()
    }

    /// Of a layer of heights, these, where they lie.
    pub(crate) fn stored_heights(&self, look: &mut Look<'_>, rect: SampleRect) -> Result<Plane> {
        match &self.content {
            Content::Heights(heights) | Content::Kept(heights) => stored(look, heights, rect),
            Content::Procedural(_) | Content::Effect(_) => Ok(Plane::constant(rect, 0.0)),
        }
    }

    /// All stored fields that it is made of.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &Stored> {
        let content = match &self.content {
            Content::Heights(stored) | Content::Kept(stored) => Some(stored),
            Content::Procedural(_) | Content::Effect(_) => None,
        };
        let masks = self.masks.iter().flat_map(|mask| {
            mask.painted.iter().chain(mask.terms.iter().filter_map(|term| match &term.source {
                TermSource::Heights { heights, .. } => Some(heights),
                TermSource::Mask(mask) => mask.as_ref(),
                TermSource::Gate { .. } => None,
            }))
        });
        content.into_iter().chain(masks)
    }

    /// Whether it looks at the terrain's selection.
    pub(crate) fn looks_at_selection(&self) -> bool {
        let of_brush = match &self.content {
            Content::Procedural(live) | Content::Effect(live) => live.gates().any(|gate| gate.selection),
            Content::Heights(_) | Content::Kept(_) => false,
        };
        let is_gate = |term: &Term| matches!(&term.source, TermSource::Gate { gate, .. } if gate.selection);
        of_brush || self.masks.iter().flat_map(|mask| &mask.terms).any(is_gate)
    }
}

impl Live {
    /// Whether its brush looks at heights that it does not change, or at the selection.
    fn looks_at_terrain(&self) -> bool {
        self.gates().any(|gate| gate.needs_heights() || gate.selection)
    }

    fn gates(&self) -> impl Iterator<Item = &Gate> {
        let gates = [&self.brush.gate, &self.brush.hardness, &self.brush.noise.roughness];
        gates.into_iter().flatten().map(|gate| &**gate)
    }

    /// With the data that the terrain keeps of it.
    pub(crate) fn new(procedure: &Procedure, pages: &mut dyn FieldPages) -> Result<Self> {
        let brush = &procedure.brush;
        let mut resources = Resources::default();
        let gates = [
            (&mut resources.gate_image, &brush.gate),
            (&mut resources.hardness_image, &brush.hardness),
            (&mut resources.roughness_image, &brush.noise.roughness),
        ];
        for (image, gate) in gates {
            *image = gate.as_deref().and_then(|gate| image_of(gate, pages).transpose()).transpose()?;
        }
        if let Some(custom) = &brush.custom {
            let (bytes, name) = kept(&custom.source, pages)?;
            resources.custom = Some(Arc::new(resources::compile(bytes, &name, name.clone())?));
        }
        Ok(Self { brush: orogeny_brush::resolved(brush), seed: procedure.seed, resources })
    }
}

/// The picture of a gate, which the terrain keeps.
pub(crate) fn image_of(gate: &Gate, pages: &mut dyn FieldPages) -> Result<Option<Arc<Bitmap>>> {
    let Some(image) = &gate.image else { return Ok(None) };
    let (bytes, name) = kept(&image.source, pages)?;
    let picture = orogeny_formats::read_bitmap(&bytes, &name)?;
    Ok(Some(Arc::new(Bitmap::new(picture.width(), picture.height(), picture.into_values())?)))
}

/// Data that a layer names by its content.
fn kept(source: &DataSource, pages: &mut dyn FieldPages) -> Result<(Vec<u8>, String)> {
    let DataSource::Blake3(name) = source else {
        return Err(Error::Operation {
            place: "a layer of the terrain".to_owned(),
            detail: "it names a file, and not data that the terrain keeps".to_owned(),
        });
    };
    Ok((pages.blob(resources::hash_of(name)?)?, name.clone()))
}

/// The visible layers from the bottom, each with the groups that it is in.
pub(crate) fn nodes(layers: &[Layer], pages: &mut dyn FieldPages) -> Result<Vec<Node>> {
    let is_counted = |layer: &&Layer| layer.content != LayerContent::Group && is_visible(layers, layer);
    layers.iter().filter(is_counted).map(|layer| node(layers, layer, pages)).collect()
}

/// The layer and the groups that it is in, from the inside.
pub(crate) fn with_groups<'a>(layers: &'a [Layer], layer: &'a Layer) -> impl Iterator<Item = &'a Layer> {
    let group_of = |layer: &&Layer| {
        let id = layer.group?;
        layers.iter().find(|group| group.id == id)
    };
    std::iter::successors(Some(layer), group_of).take(MAX_GROUP_DEPTH + 1)
}

fn is_visible(layers: &[Layer], layer: &Layer) -> bool {
    with_groups(layers, layer).all(|layer| layer.visible)
}

/// A layer as it counts.
pub(crate) fn node(layers: &[Layer], layer: &Layer, pages: &mut dyn FieldPages) -> Result<Node> {
    let mut basis: Vec<Layer> = with_groups(layers, layer).cloned().collect();
    let mut masks = Vec::new();
    for masked in with_groups(layers, layer) {
        if masked.mask.is_some() || !masked.mask_terms.is_empty() {
            let mut terms = Vec::with_capacity(masked.mask_terms.len());
            for given in &masked.mask_terms {
                terms.push(term(layers, given, &mut basis, pages)?);
            }
            masks.push(Mask { painted: painted_mask(masked), terms });
        }
    }
    let heights = Stored { field: layer.heights, constant: layer.constant_m, transform: layer.transform };
    let content = match &layer.content {
        LayerContent::Effect(_) if layer.content.is_kept() => {
            Content::Kept(Stored { transform: LayerTransform::default(), ..heights })
        }
        LayerContent::Effect(procedure) => Content::Effect(Live::new(procedure, pages)?),
        LayerContent::Procedural(procedure) => Content::Procedural(Live::new(procedure, pages)?),
        LayerContent::Heights | LayerContent::Group => Content::Heights(heights),
    };
    // A difference is added, whatever is to become of what it was made from.
    let blend = if layer.content.is_kept() { Blend::Add } else { layer.blend };
    let opacity = with_groups(layers, layer).map(|layer| layer.opacity).product();
    for layer in &mut basis {
        (layer.name, layer.position, layer.locked) = (String::new(), 0, false);
    }
    Ok(Node { id: layer.id, content, blend, opacity, masks, basis })
}

/// The terrain's selection as it lies.
pub(crate) fn selection(field: FieldId) -> Stored {
    Stored { field, constant: 0.0, transform: LayerTransform::default() }
}

/// What is painted of a layer's mask.
pub(crate) fn painted_mask(layer: &Layer) -> Option<Stored> {
    let field = layer.mask?;
    // Of a layer that is made of no heights there is nothing that could have been moved.
    let moves = layer.content == LayerContent::Heights;
    let transform = if moves { layer.transform } else { LayerTransform::default() };
    Some(Stored {
        field,
        constant: layer.mask_constant,
        transform: LayerTransform { height_scale: 1.0, ..transform },
    })
}

fn term(
    layers: &[Layer],
    given: &MaskTerm,
    basis: &mut Vec<Layer>,
    pages: &mut dyn FieldPages,
) -> Result<Term> {
    let mut other = |reference: &LayerReference| {
        let layer = crate::terrain::find_layer(layers, Some(reference))?;
        basis.push(layer.clone());
        Ok::<_, Error>(layer)
    };
    let source = match &given.source {
        MaskSource::Gate(gate) => TermSource::Gate { gate: gate.clone(), image: image_of(gate, pages)? },
        MaskSource::Heights { layer, low, high } => {
            let layer = other(layer)?;
            let heights =
                Stored { field: layer.heights, constant: layer.constant_m, transform: layer.transform };
            TermSource::Heights { heights, low: *low, high: *high }
        }
        MaskSource::Mask(layer) => TermSource::Mask(painted_mask(other(layer)?)),
    };
    Ok(Term {
        source,
        blur_m: given.blur_m,
        is_inverted: given.is_inverted,
        curve: given.curve.as_ref().map(|curve| Box::new(curve.table(0.0, 1.0))),
        combine: given.combine,
    })
}
