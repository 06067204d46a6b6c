//! From a brush and places to batches: strength, pressure, heights found under the stroke.

use orogeny_field::{
    Blending, Brush, Coverage, Falloff, FieldId, Instance, PageLayout, PointerSample, SampleRect,
    TerrainGrid, WeightMode,
};
use orogeny_pages::{HeightProbe, PageStore};

use crate::plan::{Batch, Pass, Stage};
use crate::sampler::{PlacedSample, StrokeSampler};
use crate::spacing::Spacing;
use crate::{Error, Result};

/// Blending strengths above this build up as this one, whose logarithm is finite.
const MAX_BUILD_UP: f64 = 0.999;

/// The most pages that an instance or a fill may touch: 256 GiB of heights at full resolution.
const MAX_PAGES: u64 = 1 << 20;
/// Pages after which a batch takes no further instance, each counted for each instance: bounds the plan's memory.
const BATCH_PAGES: u64 = 1 << 16;

/// Places after which a batch ends, on the terrain or not: bounds the time between two looks at whether to go on.
const BATCH_PLACES: u32 = 1 << 16;

/// A stroke on its way: takes pointer samples, gives batches.
#[derive(Debug)]
pub struct StrokePlanner {
    brush: Brush,
    grid: TerrainGrid,
    layout: PageLayout,
    field: FieldId,
    seed: u32,
    radius: f64,
    spacing: Spacing,
    sampler: StrokeSampler,
    probe: HeightProbe,
    first_position: Option<[f64; 2]>,
    target_height_m: Option<f32>,
    num_points: usize,
}

impl StrokePlanner {
    /// A stroke with no points yet, on one field of a terrain. `seed` feeds everything random in it.
    ///
    /// # Errors
    /// [`Error::Field`] for a brush with a number that it cannot use.
    pub fn new(
        brush: Brush,
        seed: u32,
        grid: TerrainGrid,
        layout: PageLayout,
        field: FieldId,
    ) -> Result<Self> {
        brush.check()?;
        let radius = brush.radius_m / grid.spacing_m();
        let spacing = Spacing::new(&brush.profile(), radius, brush.spacing);
        let sampler = StrokeSampler::new(spacing.distance, spacing.distance * grid.spacing_m());
        let probe = HeightProbe::new(grid, field);
        let target_height_m = brush.height_m;
        Ok(Self {
            brush,
            grid,
            layout,
            field,
            seed,
            radius,
            spacing,
            sampler,
            probe,
            first_position: None,
            target_height_m,
            num_points: 0,
        })
    }

    /// The next pointer sample.
    ///
    /// # Errors
    /// [`orogeny_field::Error::Point`] for one that cannot be used, [`Error::TooManyInstances`] for one that makes the
    /// stroke too long; the stroke goes on without it.
    pub fn push(&mut self, sample: &PointerSample) -> Result<()> {
        sample.check(&self.grid, self.num_points)?;
        let position = self.grid.sample_from_world(sample.position_m);
        self.sampler.push(position, f64::from(sample.pressure))?;
        self.first_position.get_or_insert(position);
        self.num_points += 1;
        Ok(())
    }

    /// No more samples come.
    pub fn finish(&mut self) {
        self.sampler.finish();
    }

    /// The next batch of at most `max_instances` settled instances; `None` when none is settled. A batch may be empty, where
    /// a stroke runs outside the terrain for long.
    ///
    /// # Errors
    /// [`Error::TooManyInstances`]; [`Error::TooManyPages`] for an absurd radius; [`Error::Pages`] when a height under the
    /// stroke cannot be read.
    pub fn next_batch(&mut self, store: &mut dyn PageStore, max_instances: usize) -> Result<Option<Batch>> {
        let mut instances = Vec::new();
        let mut bounds = Vec::new();
        let (mut num_places, mut num_pages) = (0, 0);
        while instances.len() < max_instances && num_pages < BATCH_PAGES && num_places < BATCH_PLACES {
            let Some(place) = self.sampler.next_place()? else { break };
            num_places += 1;
            let radius = self.scaled_radius(&place);
            if radius < 0.5 {
                continue;
            }
            let bound = bounds_of(place.position, radius).intersection(&self.grid.bounds());
            if bound.is_empty() {
                continue;
            }
            num_pages += checked_num_pages(self.layout, bound)?;
            instances.push(self.instance(store, &place, radius)?);
            bounds.push(bound);
        }
        if num_places == 0 {
            return Ok(None);
        }
        let pass = self.pass(store)?;
        Ok(Some(Batch::new(pass, self.layout, instances, bounds)))
    }

    fn weight_mode(&self) -> WeightMode {
        match (self.brush.brush_type.coverage(), self.brush.blending) {
            (Coverage::Additive, _) => WeightMode::Direct,
            // A dab that never moves is its own wash.
            (Coverage::Blending, _) if !self.sampler.has_moved() => WeightMode::Direct,
            (Coverage::Blending, Blending::BuildUp) => WeightMode::BuildUp,
            (Coverage::Blending, Blending::Wash) => WeightMode::Wash,
        }
    }

    fn scaled_radius(&self, place: &PlacedSample) -> f64 {
        if self.brush.pressure.scales_radius() { self.radius * place.pressure } else { self.radius }
    }

    fn instance(&mut self, store: &mut dyn PageStore, place: &PlacedSample, radius: f64) -> Result<Instance> {
        let strength = if self.brush.pressure.scales_strength() {
            self.brush.strength * place.pressure
        } else {
            self.brush.strength
        };
        // A smaller instance carries a larger share of the pass; one that stands alone, all of it.
        let share =
            if self.sampler.has_moved() { (self.spacing.share * self.radius / radius).min(1.0) } else { 1.0 };
        let stage = Stage::of(self.brush.brush_type);
        let amplitude = match (self.brush.brush_type.coverage(), self.weight_mode()) {
            (Coverage::Additive, _) => stage.sign(&self.brush) * strength * share,
            (Coverage::Blending, WeightMode::BuildUp) => (-strength.min(MAX_BUILD_UP)).ln_1p() * share,
            (Coverage::Blending, _) => strength,
        };
        let reference_height_m = match self.brush.height_m {
            _ if !stage.needs_reference_height() => 0.0,
            Some(height_m) => height_m,
            None => self.probe.height_m(store, place.position)?,
        };
        let cell = place.position.map(f64::floor);
        let [x, z] = place.position;
        let [cell_x, cell_z] = cell;
        Ok(Instance {
            cell: cell.map(|cell| cell as i32),
            fraction: [(x - cell_x) as f32, (z - cell_z) as f32],
            inverse_radius: inverse_rounded_up(radius),
            amplitude: amplitude as f32,
            reference_height_m,
            inverse_radius_m: (1.0 / (radius * self.grid.spacing_m())) as f32,
        })
    }

    fn pass(&mut self, store: &mut dyn PageStore) -> Result<Pass> {
        let stage = Stage::of(self.brush.brush_type);
        let target_height_m = match (self.target_height_m, self.first_position) {
            (Some(height_m), _) => height_m,
            (None, Some(position)) if stage.needs_target_height() => {
                let height_m = self.probe.height_m(store, position)?;
                *self.target_height_m.insert(height_m)
            }
            _ => 0.0,
        };
        Ok(Pass {
            stage,
            weight_mode: self.weight_mode(),
            falloff: Falloff::from(self.brush.profile()),
            field: self.field,
            target_height_m,
            ledge_direction: self.brush.direction,
            level_only: self.brush.only,
            seed: self.seed,
        })
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

/// Plans a brush applied once at full weight to `region`, which is clipped to the terrain.
///
/// # Errors
/// [`Error::Field`] for a brush with a number that it cannot use, and with [`orogeny_field::Error::MissingField`] for `level`
/// and `ledge` without a height: there is no stroke to find it under; [`Error::TooManyPages`] for a region beyond what one
/// operation may change.
pub fn plan_fill(
    brush: &Brush,
    seed: u32,
    grid: &TerrainGrid,
    layout: PageLayout,
    field: FieldId,
    region: SampleRect,
) -> Result<Batch> {
    brush.check()?;
    let stage = Stage::of(brush.brush_type);
    let needs_height = stage.needs_reference_height() || stage.needs_target_height();
    if needs_height && brush.height_m.is_none() {
        let why = "a fill has no stroke whose ground could give it";
        let missing =
            orogeny_field::Error::MissingField { brush: brush.brush_type.name(), field: "height", why };
        return Err(Error::Field(missing));
    }
    let height_m = brush.height_m.unwrap_or_default();
    let pass = Pass {
        stage,
        weight_mode: WeightMode::Direct,
        falloff: Falloff::HARD_EDGE,
        field,
        target_height_m: height_m,
        ledge_direction: brush.direction,
        level_only: brush.only,
        seed,
    };
    let everywhere = Instance {
        cell: [0, 0],
        fraction: [0.0, 0.0],
        inverse_radius: 0.0,
        amplitude: (stage.sign(brush) * brush.strength) as f32,
        reference_height_m: height_m,
        // Finite for the smallest radius too: 0 m above the reference times infinity would be no number.
        inverse_radius_m: (1.0 / brush.radius_m).min(f64::from(f32::MAX)) as f32,
    };
    let region = region.intersection(&grid.bounds());
    checked_num_pages(layout, region)?;
    Ok(Batch::new(pass, layout, vec![everywhere], vec![region]))
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
}
