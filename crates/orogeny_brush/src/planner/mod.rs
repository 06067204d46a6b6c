//! From a brush and places to batches: strength, pressure, copies, heights found under the stroke.

mod cloning;
mod fill;
mod grab;
mod mean;
mod prepared;
mod ramp;

use std::collections::VecDeque;

use orogeny_field::{
    AlphaRotation, Blending, Brush, BrushType, CloneBlend, Coverage, Falloff, Footprint, Instance,
    PageLayout, PointerSample, SampleRect, WeightMode,
};
use orogeny_pages::{HeightProbe, PageStore};

use crate::canvas::{Canvas, Resources};
use crate::dynamics::Touch;
use crate::filter::{Filter, region};
use crate::frames::Frames;
use crate::kernels::{Rule, Stage};
use crate::plan::{Batch, Pass};
use crate::sampler::{Pen, PlacedSample, StrokeSampler};
use crate::spacing::Spacing;
use crate::symmetry::{self, Image};
use crate::{Error, Result};
use cloning::Gathered;
use prepared::Plan;

pub use fill::plan_fill;

/// Blending strengths above this build up as this one, whose logarithm is finite.
const MAX_BUILD_UP: f64 = 0.999;

/// The most pages that an instance or a fill may touch: 256 GiB of heights at full resolution.
pub const MAX_PAGES: u64 = 1 << 20;
/// Pages after which a batch takes no further instance, each counted for each instance: bounds the plan's memory.
const BATCH_PAGES: u64 = 1 << 16;

/// Places after which a batch ends, on the terrain or not: bounds the time between two looks at whether to go on.
const BATCH_PLACES: u32 = 1 << 16;

/// A stroke on its way: takes pointer samples, gives batches.
#[derive(Debug)]
pub struct StrokePlanner {
    plan: Plan,
    images: Vec<Image>,
    radius: f64,
    spacing: Spacing,
    sampler: StrokeSampler,
    probe: HeightProbe,
    first_position: Option<[f64; 2]>,
    last_position: Option<[f64; 2]>,
    pass: Option<Pass>,
    frames: Option<Frames>,
    num_points: usize,
    /// Of what has one batch, once the stroke has ended: whether it was given.
    is_given: bool,
    /// Of a clone: what was planned so far, for each image.
    gathered: Vec<Gathered>,
    /// Of brushes whose instances each work on what those before them left: batches of one that were not asked for yet.
    waiting: VecDeque<Batch>,
    /// Where the last instance was placed, in samples.
    previous_place: Option<[f64; 2]>,
}

impl StrokePlanner {
    /// A stroke with no points yet. `seed` feeds everything random in it.
    ///
    /// # Errors
    /// [`Error::Field`] for a brush with a number that it cannot use, or whose data is not in `resources`.
    pub fn new(brush: &Brush, seed: u32, canvas: Canvas, resources: Resources) -> Result<Self> {
        let plan = Plan::new(brush, seed, canvas, resources)?;
        let grid = canvas.grid;
        let radius = brush.radius_m / grid.spacing_m();
        let spacing = Spacing::new(&brush.profile(), radius, brush.spacing);
        let sampler = StrokeSampler::new(spacing.distance, spacing.distance * grid.spacing_m());
        Ok(Self {
            images: symmetry::images(brush.symmetry.as_ref(), &grid),
            radius,
            spacing,
            sampler: if brush.is_airbrush { sampler.as_airbrush() } else { sampler },
            probe: HeightProbe::new(grid, canvas.field),
            first_position: None,
            last_position: None,
            pass: None,
            frames: None,
            num_points: 0,
            is_given: false,
            gathered: Vec::new(),
            waiting: VecDeque::new(),
            previous_place: None,
            plan,
        })
    }

    /// The next pointer sample.
    ///
    /// # Errors
    /// [`orogeny_field::Error::Point`] for one that cannot be used, [`Error::TooManyInstances`] for one that makes the
    /// stroke too long; the stroke goes on without it.
    pub fn push(&mut self, sample: &PointerSample) -> Result<()> {
        let grid = &self.plan.canvas.grid;
        sample.check(grid, self.num_points)?;
        let position = grid.sample_from_world(sample.position_m);
        let pen = Pen { pressure: f64::from(sample.pressure), tilt: f64::from(sample.tilt_deg) / 90.0 };
        if self.first_position.is_none() {
            self.frames = self.plan.frames(position)?;
        }
        self.sampler.push(position, pen, sample.time_s)?;
        self.first_position.get_or_insert(position);
        self.last_position = Some(position);
        self.num_points += 1;
        Ok(())
    }

    /// No more samples come.
    pub fn finish(&mut self) {
        self.sampler.finish();
    }

    /// The next batch of at most `max_instances` settled instances and the copies of the last of them; `None` when none is
    /// settled. A batch may be empty, where a stroke runs outside the terrain for long.
    ///
    /// # Errors
    /// [`Error::TooManyInstances`]; [`Error::TooManyPages`] for an absurd radius; [`Error::Pages`] when a height under the
    /// stroke cannot be read; [`Error::Field`] for a ramp that leads nowhere.
    pub fn next_batch(&mut self, store: &mut dyn PageStore, max_instances: usize) -> Result<Option<Batch>> {
        if Stage::of(self.plan.brush.brush_type) == Stage::Ramp {
            return self.ramp(store);
        }
        if self.plan.brush.brush_type == BrushType::Grab {
            return self.grab();
        }
        if let Some(batch) = self.waiting.pop_front() {
            return Ok(Some(batch));
        }
        let is_sequential = crate::filter::is_sequential(&self.plan.brush);
        let waits = crate::filter::waits_for_end(self.plan.brush.brush_type);
        if waits && !self.sampler.is_finished() {
            return Ok(None);
        }
        let max_instances = match (is_sequential, waits) {
            (true, _) => 1,
            (_, true) => usize::MAX,
            _ => max_instances,
        };
        let mut images = Vec::new();
        let mut instances = Vec::new();
        let mut bounds = Vec::new();
        let (mut num_places, mut num_pages) = (0, 0);
        while instances.len() < max_instances && num_pages < BATCH_PAGES && num_places < BATCH_PLACES {
            let Some(place) = self.sampler.next_place()? else { break };
            num_places += 1;
            let previous = self.previous_place.replace(place.position);
            let touch = Touch::of(&self.plan.brush, self.plan.seed, &place);
            let radius = self.radius * touch.radius;
            if radius < 0.5 {
                continue;
            }
            let [x, z] = place.position;
            let [off_x, off_z] = touch.offset;
            let centre = [x + off_x * self.radius, z + off_z * self.radius];
            for (image, position) in symmetry::places(&self.images, centre) {
                let bound = bounds_of(position, radius).intersection(&self.plan.canvas.grid.bounds());
                if bound.is_empty() {
                    continue;
                }
                num_pages += checked_num_pages(self.plan.canvas.layout, bound)?;
                instances.push(self.instance(store, &place, &touch, &image, position, radius)?);
                bounds.push(bound);
                let [from_x, from_z] = previous.unwrap_or(place.position);
                let [to_x, to_z] = place.position;
                images.push((image, image.way([to_x - from_x, to_z - from_z]), centre));
            }
        }
        if num_places == 0 {
            return if self.gathers() { self.gathered_batch(store) } else { Ok(None) };
        }
        if self.gathers() {
            // Copies of what works on a whole region are instances like any others, in the stroke's order.
            let is_one = region::is_region_wide(self.plan.brush.brush_type);
            let image = |(image, ..): (Image, _, _)| if is_one { Image::IDENTITY } else { image };
            return Ok(Some(self.gather(instances, bounds, images.into_iter().map(image))));
        }
        let pass = self.pass(store)?;
        if is_sequential {
            let layout = self.plan.canvas.layout;
            for ((instance, bound), (image, way, centre)) in instances.into_iter().zip(bounds).zip(images) {
                let mut pass = pass.clone();
                match self.plan.brush.brush_type {
                    BrushType::Smear => pass.rule = Rule::Filter(Filter::drag(&self.plan.canvas.grid, way)),
                    BrushType::Clone => pass.rule = Rule::Filter(self.fixed_clone(&image, centre)?),
                    _ => {}
                }
                self.waiting.push_back(Batch::new(pass, layout, vec![instance], vec![bound]));
            }
            let none = || Batch::new(pass, layout, Vec::new(), Vec::new());
            return Ok(Some(self.waiting.pop_front().unwrap_or_else(none)));
        }
        let frames = self.frames.as_mut().map(Frames::take).unwrap_or_default();
        Ok(Some(Batch::new(pass, self.plan.canvas.layout, instances, bounds).with_frames(frames)))
    }

    /// Whether instances carry a share of a pass each, rather than one all of it.
    const fn is_pass(&self) -> bool {
        self.sampler.has_moved() || self.plan.brush.is_airbrush
    }

    fn weight_mode(&self) -> WeightMode {
        let brush = &self.plan.brush;
        match (brush.brush_type.coverage(), brush.blending) {
            (Coverage::Additive, _) => WeightMode::Direct,
            (Coverage::Blending, _) if Stage::of(brush.brush_type).has_goal_of_instance() => {
                WeightMode::Direct
            }
            // A clone that is gathered is one wash, of however many instances.
            (Coverage::Blending, _) if brush.brush_type == BrushType::Clone && self.gathers() => {
                WeightMode::Wash
            }
            // Each instance drags along, or copies onto, what the one before it left.
            (Coverage::Blending, _) if matches!(brush.brush_type, BrushType::Smear | BrushType::Clone) => {
                WeightMode::Direct
            }
            // A dab that never moves is its own wash.
            (Coverage::Blending, _) if !self.is_pass() => WeightMode::Direct,
            (Coverage::Blending, Blending::BuildUp) => WeightMode::BuildUp,
            (Coverage::Blending, Blending::Wash) => WeightMode::Wash,
            (Coverage::Blending, Blending::Each) => WeightMode::Direct,
        }
    }

    fn instance(
        &mut self,
        store: &mut dyn PageStore,
        place: &PlacedSample,
        touch: &Touch,
        image: &Image,
        position: [f64; 2],
        radius: f64,
    ) -> Result<Instance> {
        let brush = &self.plan.brush;
        let strength = brush.strength * touch.strength;
        // A smaller instance carries a larger share of the pass; one that stands alone, all of it; one that rests, its time's.
        let share = match place.rested_s {
            Some(rested_s) => rested_s,
            None if self.is_pass() => (self.spacing.share * self.radius / radius).min(1.0),
            None => 1.0,
        };
        let stage = Stage::of(brush.brush_type);
        let mode = self.weight_mode();
        let amplitude = match (brush.brush_type.coverage(), mode) {
            (Coverage::Additive, _) => stage.sign(brush) * strength * touch.flow * share,
            (Coverage::Blending, WeightMode::BuildUp) => {
                (-(strength * touch.flow).min(MAX_BUILD_UP)).ln_1p() * share
            }
            (Coverage::Blending, WeightMode::Wash) => strength,
            // One that rests acts by its time, as the others of an airbrush do.
            (Coverage::Blending, WeightMode::Direct) => {
                strength * touch.flow * place.rested_s.map_or(1.0, |_| share)
            }
        };
        let flow = if touch.flow < 1.0 { 1.0 - (1.0 - touch.flow).powf(share) } else { 1.0 };
        let reference_height_m = match brush.height_m {
            _ if !stage.needs_reference_height() => 0.0,
            Some(height_m) => height_m,
            None => self.probe.height_m(store, position)?,
        };
        let (axis, mirror) = self.alpha_axis(place, touch, image);
        let mut instance = Instance {
            amplitude: amplitude as f32,
            reference_height_m,
            axis,
            mirror,
            flow: flow as f32,
            ..placed(position, radius, self.plan.canvas.grid.spacing_m())
        };
        if let Some(frames) = &mut self.frames {
            frames.assign(&mut instance, place.index, position, image.way(place.direction));
        }
        Ok(instance)
    }

    /// Which way an instance's bitmap lies, and -1 where its left and right change places.
    fn alpha_axis(&self, place: &PlacedSample, touch: &Touch, image: &Image) -> ([f32; 2], f32) {
        let Some(alpha) = &self.plan.brush.alpha else { return ([1.0, 0.0], 1.0) };
        let [x, z] = place.direction;
        let turned = match alpha.rotation {
            AlphaRotation::Fixed => 0.0,
            AlphaRotation::Follow => z.atan2(x),
            AlphaRotation::Random => touch.angle,
        };
        let (sin, cos) = (alpha.angle_deg.to_radians() + turned).sin_cos();
        let mirror = if alpha.is_mirrored { -1.0 } else { 1.0 };
        let [x, z] = image.way([cos, sin]).map(|part| part as f32);
        // In a mirror the picture's other axis turns over; it does so too when the first one and the picture do.
        if image.is_reflection { ([-x, -z], -mirror) } else { ([x, z], mirror) }
    }

    /// The brush's profile as kernels take it.
    fn falloff(&self) -> Falloff {
        let brush = &self.plan.brush;
        if brush.brush_type == BrushType::Clone && brush.cloning.blend == CloneBlend::Plain {
            return Falloff::HARD_EDGE;
        }
        Falloff::from(brush.profile())
    }

    /// What is the same for all batches, found out with the first.
    fn pass(&mut self, store: &mut dyn PageStore) -> Result<Pass> {
        if let Some(pass) = &self.pass {
            return Ok(pass.clone());
        }
        let stage = Stage::of(self.plan.brush.brush_type);
        let target_height_m = match (self.plan.brush.height_m, self.first_position) {
            (Some(height_m), _) => height_m,
            (None, Some(position)) if stage.needs_target_height() => self.probe.height_m(store, position)?,
            _ => 0.0,
        };
        let anchor = self.first_position.unwrap_or_default();
        let footprint = Footprint {
            falloff: self.falloff(),
            weight_mode: self.weight_mode(),
            // A stamp's picture is its height, not its weight.
            alpha: self.plan.resources.alpha.clone().filter(|_| stage != Stage::Stamp),
            is_segment: stage == Stage::Ramp,
        };
        let rule = self.plan.rule(target_height_m, anchor, self.frames.as_ref())?;
        Ok(self.pass.insert(self.plan.pass(rule, footprint)).clone())
    }
}

/// An instance at a place, of a radius in samples, that does nothing yet.
fn placed(position: [f64; 2], radius: f64, spacing_m: f64) -> Instance {
    let [x, z] = position;
    let cell = position.map(f64::floor);
    let [cell_x, cell_z] = cell;
    Instance {
        cell: cell.map(|cell| cell as i32),
        fraction: [(x - cell_x) as f32, (z - cell_z) as f32],
        inverse_radius: inverse_rounded_up(radius),
        inverse_radius_m: (1.0 / (radius * spacing_m)) as f32,
        ..Instance::EVERYWHERE
    }
}

/// `1 / radius`, no smaller than it is, so that a sample at the radius has `r >= 1` and a weight of exactly 0.
fn inverse_rounded_up(radius: f64) -> f32 {
    let nearest = (1.0 / radius) as f32;
    if f64::from(nearest) < 1.0 / radius { nearest.next_up() } else { nearest }
}

/// The samples strictly within `radius` samples of a centre, as a rectangle. Casts saturate, which clipping makes right.
fn bounds_of([x, z]: [f64; 2], radius: f64) -> SampleRect {
    let first = |centre: f64| (centre - radius).ceil() as i32;
    let end = |centre: f64| ((centre + radius).floor() as i32).saturating_add(1);
    SampleRect::new(first(x), first(z), end(x), end(z))
}

fn checked_num_pages(layout: PageLayout, rect: SampleRect) -> Result<u64> {
    let num_pages = layout.num_pages_in(rect);
    if num_pages > MAX_PAGES {
        return Err(Error::TooManyPages { num_pages, limit: MAX_PAGES });
    }
    Ok(num_pages)
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_reference::falloff;

    #[test]
    fn a_sample_at_the_radius_has_no_weight() {
        for radius in 1..=2000 {
            let r = radius as f32 * inverse_rounded_up(f64::from(radius));
            assert!(r >= 1.0, "{radius}");
            assert_eq!(falloff::weight(r, &Falloff::HARD_EDGE), 0.0, "{radius}");
        }
    }

    #[test]
    fn a_noise_that_cannot_be_seen_is_refused_with_every_sample_and_paints_nothing() {
        let noise = orogeny_field::noise::Noise { feature_size_m: 1.0, ..Default::default() };
        let brush = Brush { noise, ..Brush::new(BrushType::Noise, 20.0, 5.0) };
        let grid = orogeny_field::TerrainGrid::new(64, 64, 1.0).unwrap();
        let layout = PageLayout::new(64).unwrap();
        let canvas = Canvas::heights(grid, layout, orogeny_field::FieldId(0));
        let mut planner = StrokePlanner::new(&brush, 0, canvas, Resources::default()).unwrap();
        for x_m in [10.0, 30.0] {
            let err = planner.push(&PointerSample::at(x_m, 10.0)).unwrap_err().to_string();
            assert!(err.contains("feature_size"), "{err}");
        }
        planner.finish();
        let mut pages = orogeny_pages::MemoryPages::new(layout, 0.0);
        assert!(planner.next_batch(&mut pages, 10).unwrap().is_none());
    }
}
