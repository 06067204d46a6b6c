//! A brush with all that does not depend on where it is applied.

use std::sync::Arc;

use orogeny_field::{
    Bitmap, Brush, BrushType, Footprint, Gate, HeightRange, Instance, Placement, SampleRect, TerraceSteps,
    WeightMode,
};

use crate::canvas::{Canvas, Resources};
use crate::filter::cloning::Laid;
use crate::filter::{CloneGround, Filter, region};
use crate::frames::Frames;
use crate::gate::GatePlan;
use crate::kernels::custom::CustomRule;
use crate::kernels::{Rule, Stage};
use crate::plan::{Batch, Pass};
use crate::resolved::resolved;
use crate::symmetry::Image;
use crate::{Error, Result};

/// What strokes and fills have in common.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) brush: Brush,
    pub(super) seed: u32,
    pub(super) canvas: Canvas,
    pub(super) resources: Resources,
    pub(super) gate: Option<Arc<GatePlan>>,
    roughness: Option<Arc<GatePlan>>,
    hardness: Option<Arc<GatePlan>>,
    custom: Option<CustomRule>,
}

impl Plan {
    pub(super) fn new(brush: &Brush, seed: u32, canvas: Canvas, resources: Resources) -> Result<Self> {
        brush.check()?;
        if brush.alpha.is_some() && resources.alpha.is_none() {
            let why = "its picture was not loaded";
            return Err(missing(brush, "alpha", why));
        }
        let custom = match (brush.brush_type, &resources.custom) {
            (BrushType::Custom, Some(program)) => {
                Some(CustomRule::new(Arc::clone(program), brush, seed, &canvas.grid)?)
            }
            (BrushType::Custom, None) => return Err(missing(brush, "file", "its kernel was not loaded")),
            _ => None,
        };
        if brush.brush_type == BrushType::Clone && resources.clone_ground.is_none() {
            return Err(missing(brush, "source", "the ground that it clones was not loaded"));
        }
        let brush = resolved(brush);
        let plan = |gate: Option<&Gate>, image: Option<&Arc<Bitmap>>| -> Result<Option<Arc<GatePlan>>> {
            let Some(gate) = gate else { return Ok(None) };
            if gate.image.is_some() && image.is_none() {
                return Err(missing(&brush, "image", "its picture was not loaded"));
            }
            let Canvas { grid, heights, selection, .. } = canvas;
            Ok(Some(Arc::new(GatePlan::new(gate, grid, heights, selection, image.cloned())?)))
        };
        let gate = plan(brush.gate.as_deref(), resources.gate_image.as_ref())?;
        let is_noise = brush.brush_type == BrushType::Noise;
        let roughness = brush.noise.roughness.as_deref().filter(|_| is_noise);
        let roughness = plan(roughness, resources.roughness_image.as_ref())?;
        let hardness = plan(brush.hardness.as_deref(), resources.hardness_image.as_ref())?;
        Ok(Self { brush, seed, canvas, resources, gate, roughness, hardness, custom })
    }

    /// What the kernel does; `anchor` is the stroke's first point, in samples.
    ///
    /// # Errors
    /// [`Error::Field`] for a brush whose data is not there.
    pub(super) fn rule(
        &self,
        target_height_m: f32,
        anchor: [f64; 2],
        frames: Option<&Frames>,
    ) -> Result<Rule> {
        let brush = &self.brush;
        Ok(match Stage::of(brush.brush_type) {
            Stage::Raise => Rule::Raise,
            Stage::Ledge => Rule::Ledge(brush.direction),
            Stage::Level => Rule::Level { target_height_m, only: brush.only },
            Stage::Ramp => Rule::Ramp { along: brush.along, only: brush.only },
            Stage::Roughen => Rule::Roughen { seed: self.seed },
            Stage::Noise => match frames {
                Some(frames) => Rule::Noise(Arc::clone(frames.kernel())),
                None => return Err(missing(brush, "points", "a noise has its place by the first")),
            },
            Stage::Blend => match Filter::of(brush, &self.canvas, self.hardness.as_ref())? {
                Some(filter) => Rule::Filter(filter),
                // Each instance has a filter of its own, the whole stroke has one at its end, or it is that of a region.
                None => Rule::Filter(Filter::drag(&self.canvas.grid, [0.0; 2])),
            },
            Stage::Terrace => {
                let anchor = anchor.map(|place| place.round() as i32);
                Rule::Terrace(TerraceSteps::new(&brush.terrace, self.canvas.grid.spacing_m(), anchor))
            }
            Stage::RangeMap => Rule::RangeMap(HeightRange::from(&brush.range_map)),
            Stage::Stamp => match &self.resources.alpha {
                Some(bitmap) => Rule::Stamp {
                    scale_m: brush.stamp.scale_m as f32,
                    mode: brush.stamp.mode,
                    bitmap: Arc::clone(bitmap),
                },
                None => return Err(missing(brush, "alpha", "its picture was not loaded")),
            },
            Stage::Custom => match &self.custom {
                Some(custom) => Rule::Custom(custom.clone()),
                None => return Err(missing(brush, "file", "its kernel was not loaded")),
            },
            Stage::Mask => Rule::Mask {
                value: if brush.brush_type == BrushType::EraseMask { 0.0 } else { brush.mask_value as f32 },
            },
        })
    }

    /// The ground that it clones as it comes to lie, in an image of the terrain: its place at `to_m`.
    pub(super) fn laid(&self, to_m: [f64; 2], image: &Image) -> Result<Laid<'_>> {
        let source = &self.brush.cloning.source;
        let Some(ground) = &self.resources.clone_ground else {
            return Err(missing(&self.brush, "source", "the ground that it clones was not loaded"));
        };
        let spacing_m = self.canvas.grid.spacing_m();
        let source_spacing_m = match ground {
            CloneGround::Field(_) => spacing_m,
            CloneGround::Raster { spacing_m, .. } => *spacing_m,
        };
        let placement = Placement::new(&source.placing(to_m, source_spacing_m, spacing_m));
        let inverse = image.inverse();
        Ok(Laid {
            region: source.region_m.map(|region_m| samples_in(region_m, source_spacing_m)),
            feather: source.feather_m / source_spacing_m,
            ground,
            placement: if *image == Image::IDENTITY {
                placement
            } else {
                placement.after(|place| inverse.place(place))
            },
            heights: [source.height_scale as f32, source.height_offset_m as f32],
            selection: source.is_selected_only.then_some(self.canvas.selection),
        })
    }

    /// What a brush that works on a whole region at once makes of one; `None` for any other.
    pub(super) fn of_region(&self, rect: SampleRect) -> Result<Option<Filter>> {
        region::filter(&self.brush, self.seed, &self.canvas, rect)
    }

    pub(super) fn frames(&self, anchor: [f64; 2]) -> Result<Option<Frames>> {
        if self.brush.brush_type != BrushType::Noise {
            return Ok(None);
        }
        let spacing_m = self.canvas.grid.spacing_m();
        let anchor_m = anchor.map(|place| place * spacing_m);
        Frames::new(&self.brush.noise, self.seed, &self.canvas.grid, anchor_m).map(Some)
    }

    /// The one batch of what is made at a stroke's end: the ground within `bounds` becomes what a filter makes of it, as far
    /// as a gate lets it.
    pub(super) fn settled(
        &self,
        filter: Filter,
        mut bounds: Vec<SampleRect>,
        gate: Option<Arc<GatePlan>>,
    ) -> Batch {
        bounds.retain(|bound| !bound.is_empty());
        // Where two of them meet it becomes that once.
        let weight_mode = if bounds.len() > 1 { WeightMode::Wash } else { WeightMode::Direct };
        let footprint = Footprint { weight_mode, ..Footprint::EVERYWHERE };
        let pass = Pass { gate, ..self.pass(Rule::Filter(filter), footprint) };
        Batch::new(pass, self.canvas.layout, vec![Instance::EVERYWHERE; bounds.len()], bounds)
    }

    pub(super) fn pass(&self, rule: Rule, footprint: Footprint) -> Pass {
        Pass {
            rule,
            footprint,
            field: self.canvas.field,
            is_mask: self.canvas.is_mask,
            gate: self.gate.clone(),
            roughness: self.roughness.clone(),
        }
    }
}

pub(super) fn missing(brush: &Brush, field: &'static str, why: &'static str) -> Error {
    orogeny_field::Error::MissingField { brush: brush.brush_type.name(), field, why }.into()
}

/// The samples of a region of a source: as those of a terrain, but not cut at its border.
fn samples_in([x, z, width, depth]: [f64; 4], spacing_m: f64) -> SampleRect {
    let sample = |place_m: f64| (place_m / spacing_m - 1.0e-6).ceil() as i32;
    SampleRect::new(sample(x), sample(z), sample(x + width), sample(z + depth))
}
